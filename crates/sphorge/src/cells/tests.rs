//! Cells of lattices and rings that are deformed, torn and mirrored.

use super::*;

const SIDE: usize = 5;
/// Stretched to twice along x and sheared.
const F: [[f64; 3]; 3] = [[2.0, 0.5, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.7]];

fn cube() -> [[f64; 3]; 8] {
    std::array::from_fn(|k: usize| std::array::from_fn(|a| (k >> a & 1) as f64 - 0.5))
}

fn at(x: usize, y: usize, z: usize) -> usize {
    x + SIDE * (y + SIDE * z)
}

fn lattice() -> Vec<[f64; 3]> {
    (0..SIDE.pow(3)).map(|i| [i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)].map(|x| x as f64)).collect()
}

fn joined(start: &[[f64; 3]], bodies: &[f32]) -> JoinedCells {
    JoinedCells::new(start, &vec![cube(); start.len()], bodies, 3, &[])
}

fn deformed(start: &[[f64; 3]], f: [[f64; 3]; 3]) -> (Vec<[f64; 3]>, Vec<f32>) {
    let now = start.iter().map(|p| std::array::from_fn(|a| (0..3).map(|b| f[a][b] * p[b]).sum())).collect();
    (now, start.iter().flat_map(|_| f.as_flattened().iter().map(|x| *x as f32)).collect())
}

#[test]
fn cells_of_a_lattice_share_their_corners_and_its_faces_are_the_surface() {
    let start = lattice();
    let cells = joined(&start, &vec![0.0; start.len()]);
    assert_eq!((cells.nodes(), cells.surface.len()), ((SIDE + 1).pow(3), 6 * SIDE * SIDE));
    assert!(cells.surface.contains(&(6 * at(0, 2, 2) as u32)) && cells.fillers.is_empty());
    let (now, gradient) = deformed(&start, F);
    let nodes = cells.at(&now, &Deformation::whole(gradient.clone()));
    assert!(nodes.parted.is_empty());
    // A homogeneous deformation takes all corners with it.
    for (corner, node) in cells.of.iter().enumerate() {
        let initial = plus(start[corner / 8], cube()[corner % 8]);
        let exact: [f64; 3] = std::array::from_fn(|a| (0..3).map(|b| F[a][b] * initial[b]).sum());
        assert!(length(minus(nodes.places[*node as usize], exact)) < 1e-6, "{corner}");
    }
}

#[test]
fn cells_whose_gradients_differ_meet_all_the_same() {
    let start = lattice();
    let cells = joined(&start, &vec![0.0; start.len()]);
    let (mut now, mut gradient) = deformed(&start, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // Each has a size of its own, and is pushed aside.
    for i in 0..start.len() {
        let by = 0.15 * (i as f64).sin();
        (0..3).for_each(|a| gradient[9 * i + 4 * a] += by as f32);
        now[i][i % 3] += 0.1 * (i as f64).cos();
    }
    let corners = cells.corners(&now, &cells.at(&now, &Deformation::whole(gradient.clone())));
    let place = |i: usize, k: usize| plus(now[i], corners[i][k].map(f64::from));
    let (a, b) = (at(1, 2, 2), at(2, 2, 2));
    for (high, low) in [(1, 0), (3, 2), (5, 4), (7, 6)] {
        assert!(length(minus(place(a, high), place(b, low))) < 1e-6);
    }
    // The node is where its eight cells put it on average.
    let around: Vec<usize> = (0..8).map(|k: usize| at(2 - (k & 1), 2 - (k >> 1 & 1), 2 - (k >> 2))).collect();
    let own = |(k, i): (usize, &usize)| -> [f64; 3] {
        std::array::from_fn(|x| now[*i][x] + f64::from(gradient[9 * i + 4 * x]) * cube()[k][x])
    };
    let mean = around.iter().enumerate().map(own).fold([0.0; 3], plus).map(|x| x / 8.0);
    assert!(length(minus(place(around[0], 0), mean)) < 1e-6);
}

#[test]
fn a_crack_opens_and_what_is_lost_takes_nobody_with_it() {
    let start = lattice();
    let cells = joined(&start, &vec![0.0; start.len()]);
    let (mut now, gradient) = deformed(&start, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for (p, before) in now.iter_mut().zip(&start) {
        p[2] += if before[2] > 2.5 { 2.0 } else { 0.0 };
    }
    let nodes = cells.at(&now, &Deformation::whole(gradient.clone()));
    let plane = (SIDE + 1).pow(2);
    assert_eq!((nodes.places.len(), nodes.parted.len()), (cells.nodes() + plane, 8 * SIDE * SIDE));
    let corners = cells.corners(&now, &cells.at(&now, &Deformation::whole(gradient.clone())));
    assert!((corners[at(1, 1, 2)][7][2] - 0.5).abs() < 1e-6 && (corners[at(1, 1, 3)][0][2] + 0.5).abs() < 1e-6);
    // One particle is nowhere.
    let lost = at(1, 1, 1);
    now[lost] = [f64::NAN; 3];
    let corners = cells.corners(&now, &cells.at(&now, &Deformation::whole(gradient.clone())));
    let is_finite = |i: usize| corners[i].as_flattened().iter().all(|x| x.is_finite());
    assert!(!is_finite(lost) && (0..start.len()).filter(|i| *i != lost).all(is_finite));
}

/// Deformation of cells of which some are severed.
fn severed(gradient: Vec<f32>, count: usize, cells: &[usize]) -> Deformation {
    Deformation { gradient, severed: (0..count).map(|i| cells.contains(&i)).collect() }
}

#[test]
fn a_severed_cell_holds_to_nobody_however_near_they_are() {
    let start = lattice();
    let plane = SymmetryPlane { axis: 0, position: -0.5, side: 1.0 };
    let cells = JoinedCells::new(&start, &vec![cube(); start.len()], &vec![0.0; start.len()], 3, &[plane]);
    let (mut now, gradient) = deformed(&start, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let (lost, neighbour) = (at(0, 2, 2), at(1, 2, 2));
    now[lost] = plus(now[lost], [0.2, 0.1, 0.0]);
    let nodes = cells.at(&now, &severed(gradient, start.len(), &[lost]));
    let corners = cells.corners(&now, &nodes);
    for k in 0..8 {
        // It is as it was, also where it was in a plane of symmetry, and the others do not follow it.
        assert!(length(minus(corners[lost][k].map(f64::from), cube()[k])) < 1e-6, "{k}");
        assert!(length(minus(corners[neighbour][k].map(f64::from), cube()[k])) < 1e-6, "{k}");
    }
    let outside = cells.outside(&nodes, |_| true);
    assert_eq!(outside.sides[lost], 0b11_1111);
    let held = |cell: usize| outside.faces.iter().find(|f| f.cell as usize == cell && f.face == 0).map(|f| f.held);
    assert_eq!((held(lost), held(at(0, 0, 2))), (Some(0), Some(1)));
}

#[test]
fn a_cell_is_no_longer_than_what_is_beside_it_lets_it_be() {
    let start = lattice();
    let cells = joined(&start, &vec![0.0; start.len()]);
    let middle = at(2, 2, 2);
    let long = |now: &[[f64; 3]], deformation: &Deformation, cell: usize| {
        let drawn = cells.supported(now, deformation).of(cell as u32);
        [0, 1, 2].map(|k| length([drawn[0][k], drawn[1][k], drawn[2][k]]))
    };
    // Metal that is drawn out with its neighbours is as long as it is.
    let (now, gradient) = deformed(&start, [[10.0, 0.5, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]]);
    let whole = Deformation::whole(gradient.clone());
    assert_eq!(cells.supported(&now, &whole), whole);
    // One that has nobody along x is not; across it is as it was.
    let alone = severed(gradient.clone(), start.len(), &[at(1, 2, 2), at(3, 2, 2)]);
    let [x, y, z] = long(&now, &alone, middle);
    assert!((x - 2.0).abs() < 1e-6 && (y - 0.34f64.sqrt()).abs() < 1e-6 && (z - 0.3).abs() < 1e-6, "{x} {y} {z}");
    // Between neighbours who stayed it is not, either; one who went with it is enough.
    let mut near = now.clone();
    near[at(1, 2, 2)] = plus(near[middle], [-3.0, 0.0, 0.0]);
    near[at(3, 2, 2)] = plus(near[middle], [f64::NAN, 0.0, 0.0]);
    assert!((long(&near, &whole, middle)[0] - 4.5).abs() < 1e-6);
    for elsewhere in [[25.0, 0.0, 0.0], [-5.0, 0.0, 0.0], [4.0, 10.0, 0.0]] {
        near[at(3, 2, 2)] = plus(near[middle], elsewhere);
        assert!((long(&near, &whole, middle)[0] - 4.5).abs() < 1e-6, "{elsewhere:?}");
    }
    near[at(3, 2, 2)] = plus(near[middle], [10.0, 0.0, 0.0]);
    assert!((long(&near, &whole, middle)[0] - 10.0).abs() < 1e-6);
    // In a plane there is no third axis, and of a row nobody is missed beside it.
    let square: [[f64; 3]; 8] = std::array::from_fn(|k: usize| [cube()[k][0], cube()[k][1], 0.0]);
    let row = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let cells = JoinedCells::new(&row, &[square; 3], &[0.0; 3], 2, &[]);
    let gradient = [9.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 1.0].repeat(3);
    let drawn = cells.supported(&row, &severed(gradient, 3, &[0, 2])).gradient;
    assert_eq!(drawn[9..18], [2.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn debris_of_a_round_bar_is_joined_by_no_sliver() {
    let (cells, start) = cylinder(false);
    let gradient: Vec<f32> = (0..9 * start.len()).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
    let far: Vec<usize> = (0..start.len()).filter(|i| i % 3 == 0).collect();
    let mut now = start.clone();
    for &i in &far {
        now[i] = plus(now[i], [0.02 * (i as f64).sin(), 0.02 * (i as f64).cos(), 0.05]);
    }
    // By their distance alone, and severed: a sliver between rings stays with the cells that it is between.
    for deformation in [Deformation::whole(gradient.clone()), severed(gradient, start.len(), &far)] {
        let nodes = cells.at(&now, &deformation);
        assert!(!nodes.torn.is_empty() && nodes.torn.len() < cells.fillers.len());
        for face in cells.outside(&nodes, |_| true).faces {
            let corners = face.nodes.map(|node| nodes.places[node as usize]);
            let size = corners.iter().map(|p| length(minus(*p, corners[0]))).fold(0.0, f64::max);
            assert!(size < 3e-3, "{face:?}: {size}");
        }
    }
}

#[test]
fn bodies_share_no_corners() {
    let start = lattice();
    let bodies: Vec<f32> = start.iter().map(|p| if p[0] > 1.5 { 1.0 } else { 0.0 }).collect();
    let cells = joined(&start, &bodies);
    assert_eq!(cells.nodes(), (SIDE + 1).pow(3) + (SIDE + 1).pow(2));
    assert_eq!(cells.surface.len(), 8 * SIDE * SIDE);
}

#[test]
fn corners_in_a_plane_of_symmetry_stay_there() {
    let start = lattice();
    let plane = SymmetryPlane { axis: 0, position: -0.5, side: 1.0 };
    let cells = JoinedCells::new(&start, &vec![cube(); start.len()], &vec![0.0; start.len()], 3, &[plane]);
    let (now, mut gradient) = deformed(&start, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    gradient.iter_mut().step_by(9).for_each(|x| *x = 1.2);
    let corners = cells.corners(&now, &cells.at(&now, &Deformation::whole(gradient.clone())));
    assert!((corners[at(0, 2, 2)][0][0] + 0.5).abs() < 1e-6 && (corners[at(4, 2, 2)][1][0] - 0.6).abs() < 1e-6);
}

#[test]
fn between_an_edge_and_finer_cells_along_it_is_a_filler() {
    // In a plane: one cell of twice the width below two others whose common corner is a little above its edge.
    let square = |w: f64, h: f64| -> [[f64; 3]; 8] {
        std::array::from_fn(|k: usize| [w * ((k & 1) as f64 - 0.5), h * ((k >> 1 & 1) as f64 - 0.5), 0.0])
    };
    let mut corners = vec![square(2.0, 1.0), square(1.0, 1.0), square(1.0, 1.0)];
    (corners[1][1][1], corners[2][0][1]) = (-0.4, -0.4);
    let start = [[0.0, 0.0, 0.0], [-0.5, 1.0, 0.0], [0.5, 1.0, 0.0]];
    let cells = JoinedCells::new(&start, &corners, &[0.0; 3], 2, &[]);
    let [of_coarse, left, right] = [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]].map(|k| k.map(|k: usize| cells.of[k]));
    assert_eq!((left[1], left[0]), (right[0], of_coarse[2]));
    assert_eq!(cells.fillers, [[0, of_coarse[2], left[1], of_coarse[3]]]);
    // A severed one has no sliver beside it.
    let undeformed: Vec<f32> = (0..27).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
    let torn = |cells_severed: &[usize]| cells.at(&start, &severed(undeformed.clone(), 3, cells_severed)).torn;
    assert_eq!((torn(&[]), torn(&[0])), (vec![], vec![0]));
    // The coarse cell is heard where the finer ones meet.
    let gradient: Vec<f32> = (0..27).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
    let mut now = start;
    now[0][0] += 0.3;
    let corners = cells.corners(&now, &cells.at(&now, &Deformation::whole(gradient.clone())));
    assert!((corners[1][1][0] - 0.6).abs() < 1e-6, "{:?}", corners[1]);
}

/// The cells of a cylinder along z, five spacings of a millimetre in radius, whole or a quarter of it.
pub(crate) fn cylinder(is_quarter: bool) -> (JoinedCells, Vec<[f64; 3]>) {
    let rod = "{ cylinder = { from = [0, 0, 0], to = [0, 0, \"4 mm\"], radius = \"5 mm\" } }";
    let quarter = "{ box = { min = [0, 0, 0], max = [\"9 mm\", \"9 mm\", \"9 mm\"] } }";
    let shape = if is_quarter { format!("{{ intersection = [{rod}, {quarter}] }}") } else { rod.to_owned() };
    let symmetry = if is_quarter { "symmetry = [{ axis = \"x\" }, { axis = \"y\" }]\n" } else { "" };
    let deck = format!(
        "dimensions = \"3d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n{symmetry}[[body]]\nname = \"rod\"\nmaterial = \"armco-iron\"\nshape = {shape}\n"
    );
    let model = crate::deck::load_text("cylinder", &deck, &[]).unwrap().model;
    let start = crate::geometry::fill(&model, 1e6).unwrap().position;
    let corners = crate::geometry::cell_corners(&model);
    let cells = JoinedCells::new(&start, &corners, &vec![0.0; start.len()], 3, &model.symmetry);
    (cells, start)
}

/// Whether a triangle seen along z has a point.
fn covers([p, q, r]: [[f64; 3]; 3], [x, y]: [f64; 2]) -> bool {
    let side = |a: [f64; 3], b: [f64; 3]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    let sides = [side(p, q), side(q, r), side(r, p)];
    sides.iter().all(|s| *s >= -1e-15) || sides.iter().all(|s| *s <= 1e-15)
}

#[test]
fn the_end_of_a_round_bar_has_no_holes() {
    for is_quarter in [false, true] {
        let (cells, start) = cylinder(is_quarter);
        let gradient: Vec<f32> = (0..9 * start.len()).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
        let nodes = cells.at(&start, &Deformation::whole(gradient.clone()));
        let outside = cells.outside(&nodes, |_| true);
        let top: Vec<[[f64; 3]; 4]> = outside
            .faces
            .iter()
            .map(|face| face.nodes.map(|node| nodes.places[node as usize]))
            .filter(|places| places.iter().all(|p| (p[2] - 4e-3).abs() < 1e-9))
            .collect();
        let mut holes = Vec::new();
        for k in 0..4000 {
            // Evenly over the disc: the golden angle.
            let (radius, angle) = (4.7e-3 * (f64::from(k) / 4000.0).sqrt(), 2.399_963_229_7 * f64::from(k));
            let mut at = [radius * angle.cos(), radius * angle.sin()];
            if is_quarter {
                at = at.map(f64::abs);
            }
            if !top.iter().any(|[p, q, r, s]| covers([*p, *q, *r], at) || covers([*p, *r, *s], at)) {
                holes.push(at.map(|x| (1e5 * x).round() / 100.0));
            }
        }
        assert!(holes.is_empty(), "quarter: {is_quarter}, {} holes: {:?}", holes.len(), &holes[..holes.len().min(40)]);
    }
}

#[test]
fn no_face_inside_a_round_bar_is_outside() {
    for is_quarter in [false, true] {
        let (cells, start) = cylinder(is_quarter);
        let gradient: Vec<f32> = (0..9 * start.len()).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
        let nodes = cells.at(&start, &Deformation::whole(gradient.clone()));
        let mut inside = Vec::new();
        for face in cells.outside(&nodes, |_| true).faces.iter().filter(|face| !face.is_filler) {
            let places = face.nodes.map(|node| nodes.places[node as usize]);
            let [x, y, z]: [f64; 3] = std::array::from_fn(|a| places.iter().map(|p| p[a]).sum::<f64>() / 4.0);
            let is_held = is_quarter && (x < 1e-6 || y < 1e-6);
            if x.hypot(y) < 4.5e-3 && z > 1e-6 && z < 4e-3 - 1e-6 && !is_held {
                inside.push((face.cell, face.face, [x, y, z].map(|x| (1e5 * x).round() / 100.0)));
            }
        }
        assert!(inside.is_empty(), "quarter: {is_quarter}, {}: {:?}", inside.len(), &inside[..inside.len().min(20)]);
    }
}

#[test]
fn edges_at_the_end_of_a_round_bar_meet_others_wherever_rings_do() {
    let (cells, start) = cylinder(false);
    let gradient: Vec<f32> = (0..9 * start.len()).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
    let nodes = cells.at(&start, &Deformation::whole(gradient.clone()));
    let place = |node: u32| nodes.places[node as usize];
    let mut meets = std::collections::HashMap::<[u32; 2], usize>::new();
    for face in cells.outside(&nodes, |_| true).faces {
        if face.nodes.iter().any(|node| (place(*node)[2] - 4e-3).abs() > 1e-9) {
            continue;
        }
        let corners = if face.is_filler { 3 } else { 4 };
        for k in 0..corners {
            let (a, b) = (face.nodes[k], face.nodes[(k + 1) % corners]);
            *meets.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    // However the end is deformed, no edge is open but those of the rim.
    let is_rim = |node: u32| place(node)[0].hypot(place(node)[1]) > 4.8e-3;
    // Wedges end in an edge without length at the axis.
    let is_edge = |a: u32, b: u32| length(minus(place(a), place(b))) > 1e-9 && !(is_rim(a) && is_rim(b));
    let open = meets.iter().filter(|([a, b], count)| *count % 2 == 1 && is_edge(*a, *b));
    let open: Vec<_> = open.map(|(edge, _)| edge.map(|node| place(node).map(|x| (1e5 * x).round() / 100.0))).collect();
    assert!(open.is_empty(), "{}: {:?}", open.len(), &open[..open.len().min(8)]);
}
