use super::super::tests::random;
use super::super::{FacetPairLaw, FacetPress, Partner, ReferenceFacet, press, stress_of_moment};
use super::*;
use crate::SymmetricTensor;
use crate::tensor::identity;

const LAW: FacetPairLaw<f64> = FacetPairLaw { gives_way: 0.5, ..super::super::tests::LAW };

/// A facet of a cube, or a strip, that looks along y to `side`.
fn facet(planar: bool, side: f64, curvature: f64) -> ReferenceFacet<f64> {
    let across = [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, if planar { 0.0 } else { 1.0 }]];
    let y = 0.5 * side;
    let flat = if planar {
        ReferenceFacet::strip([0.5 * side, y, 0.0], [-0.5 * side, y, 0.0])
    } else {
        let around = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let corners = around.map(|[x, z]| if side > 0.0 { [z, y, x] } else { [x, y, z] });
        ReferenceFacet::flat(corners, [0.0, side, 0.0])
    };
    let bent = |share: f64| if planar { 0.0 } else { share * curvature };
    let curvature = SymmetricTensor { xx: curvature, zz: bent(0.6), xz: bent(0.3), ..SymmetricTensor::zero() };
    // Off the middle of its cell, as a part of a face.
    let moved = |p: Vector<f64>| [p[0] + 0.1, p[1], if planar { p[2] } else { p[2] - 0.05 }];
    ReferenceFacet { across, corners: flat.corners.map(moved), middle: moved(flat.middle), ..flat }.curved(curvature)
}

/// A cell with a facet, and the shifts of its sides.
#[derive(Clone, Copy)]
struct Cell {
    x: Vector<f64>,
    f: Tensor<f64>,
    shifts: OnSides<f64>,
    facet: ReferenceFacet<f64>,
}

impl Cell {
    fn random(state: &mut u64, planar: bool, facet: ReferenceFacet<f64>) -> Self {
        let within = if planar { 2 } else { 3 };
        let (mut f, mut shifts) = (identity(), OnSides::zero());
        for a in 0..within {
            for b in 0..within {
                f[a][b] += 0.2 * random(state);
                // Rows are of axes; that of the facet's own has nothing to do with it.
                shifts.low[a][b] = 0.15 * random(state);
                shifts.high[a][b] = 0.15 * random(state);
            }
        }
        Self { x: [0.0; 3], f, shifts, facet }
    }

    fn edges(&self, forces: &EdgeForces<f64>) -> OnCell<f64> {
        forces.on_cell(&self.now(), &self.facet, &self.f, &self.shifts)
    }

    fn now(&self) -> Facet<f64> {
        Facet::now(self.x, &self.f, &self.facet).shifted(&self.facet, &self.f, &self.shifts)
    }
}

fn pressed(a: &Cell, b: &Cell) -> FacetPress<f64> {
    press(&a.now(), &b.now(), Partner::Facet, &LAW)
}

#[test]
fn shifted_facets_keep_the_derivative_of_the_energy() {
    for (planar, curvatures) in [(true, [0.0, 0.0]), (false, [0.0, 0.0]), (true, [0.3, -0.2]), (false, [0.3, -0.2])] {
        let within = if planar { 2 } else { 3 };
        let (mut state, mut worst, mut count) = (7, 0.0f64, 0);
        for _ in 0..300 {
            let mut a = Cell::random(&mut state, planar, facet(planar, -1.0, curvatures[0]));
            let b = Cell::random(&mut state, planar, facet(planar, 1.0, curvatures[1]));
            let z = if planar { 0.0 } else { 0.4 * random(&mut state) };
            a.x = [0.5 * random(&mut state), 0.9 + 0.2 * random(&mut state), z];
            let got = pressed(&a, &b);
            if got.energy < 1e-4 {
                continue;
            }
            count += 1;
            let size = dot(got.force, got.force).sqrt();
            let difference = |change: &dyn Fn(&mut [Cell; 2], f64)| {
                let energy = |by: f64| {
                    let mut cells = [a, b];
                    change(&mut cells, by);
                    pressed(&cells[0], &cells[1]).energy
                };
                (energy(1e-6) - energy(-1e-6)) / 2e-6
            };
            let edges = [a.edges(&got.edges_a), b.edges(&got.edges_b)];
            let moments = [plus(&got.moment_a, 1.0, &edges[0].moment), plus(&got.moment_b, 1.0, &edges[1].moment)];
            let stress = [stress_of_moment(&moments[0], &a.f), stress_of_moment(&moments[1], &b.f)];
            let sides = edges.map(|of| of.sides);
            for k in 0..2 {
                let sign = [1.0, -1.0][k];
                for i in 0..within {
                    let mut misfits = vec![difference(&|cells, by| cells[k].x[i] += by) + sign * got.force[i]];
                    for j in 0..within {
                        misfits.push(difference(&|cells, by| cells[k].f[i][j] += by) + stress[k][i][j]);
                        misfits.push(difference(&|cells, by| cells[k].shifts.low[i][j] += by) + sides[k].low[i][j]);
                        misfits.push(difference(&|cells, by| cells[k].shifts.high[i][j] += by) + sides[k].high[i][j]);
                    }
                    worst = misfits.into_iter().fold(worst, |most, misfit| most.max(misfit.abs() / size));
                }
            }
        }
        assert!(worst < 1e-6 && count > 40, "{planar} {curvatures:?}: {worst:e} of {count}");
    }
}

/// A row of cells that look along y to `side`, every second one moved along it by so much and the others back.
fn row(side: f64, y: f64, moved: f64, shared: bool) -> Vec<Cell> {
    let x = |k: i32| f64::from(k) + if k % 2 == 0 { moved } else { -moved };
    let cell = |k: i32| {
        let mut shifts = OnSides::zero();
        if shared {
            shifts.low[0] = SharedEdge::of([x(k - 1) - x(k), 0.0, 0.0], &identity(), [-1.0, 0.0, 0.0]).shift();
            shifts.high[0] = SharedEdge::of([x(k + 1) - x(k), 0.0, 0.0], &identity(), [1.0, 0.0, 0.0]).shift();
        }
        let h = 0.5 * side;
        let strip = ReferenceFacet::strip([h, h, 0.0], [-h, h, 0.0]);
        let facet = ReferenceFacet { across: [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], ..strip };
        Cell { x: [x(k), y, 0.0], f: identity(), shifts, facet }
    };
    (0..9).map(cell).collect()
}

#[test]
fn neighbours_that_move_in_pairs_against_those_of_the_other_body_gain_little() {
    let energy = |moved: f64, shared: bool| -> f64 {
        let (above, below) = (row(-1.0, 0.8, moved, shared), row(1.0, 0.0, -moved, shared));
        // Those in the middle, which have others beside them.
        let own = above[1..8].iter();
        own.flat_map(|a| below.iter().map(move |b| pressed(a, b).energy)).sum()
    };
    let still = energy(0.0, true);
    assert!((energy(0.0, false) / still - 1.0).abs() < 1e-12);
    for moved in [1e-6f64, 0.01, 0.1, 0.2] {
        // Edges are shifted by a little less than all of it.
        let left = 2.0 * moved * (1.0 - 1.0 / (1.0 + (2.0 * moved).powi(4)).sqrt().sqrt());
        let of_edges =
            4.0 * firmer(SharedEdge::of([1.0 + 2.0 * moved, 0.0, 0.0], &identity(), [1.0, 0.0, 0.0]).shift()[0])[0];
        let with = energy(moved, true) / still / (1.0 + of_edges);
        assert!(with <= 1.0 + 1e-9 && with > 1.0 - left - 1e-9, "{moved}: {with}");
        // Half of the ends meet none: four times as much of each cell.
        assert!(
            (energy(moved, false) / still - 1.0 + 2.0 * moved).abs() < 0.3 * moved,
            "{moved}: {}",
            energy(moved, false) / still
        );
    }
}

#[test]
fn the_sides_of_a_cell_carry_all_that_its_edges_pull_by() {
    // Moved as a whole, edges pull by their force; about the owner by their moment.
    let mut state = 3;
    let cell = Cell::random(&mut state, false, facet(false, 1.0, 0.0));
    let force = within_plane([0.3, -0.2, 0.5], cell.now().normal);
    let pull = Pull { force, moment: [[0.0; 3]; 3] };
    let sides = pull.on_sides(&cell.facet, &cell.f);
    for axis in [0, 2] {
        for a in 0..3 {
            let whole = sides.low[axis][a] + sides.high[axis][a];
            assert!((whole - force[a]).abs() < 1e-14, "{whole} {}", force[a]);
            // The middle is a tenth of the width from that of the cell.
            let apart = sides.high[axis][a] - sides.low[axis][a];
            assert!((apart - 2.0 * cell.facet.middle[axis] * force[a]).abs() < 1e-14);
        }
    }
    assert_eq!((sides.low[1], sides.high[1]), ([0.0; 3], [0.0; 3]));
}

#[test]
fn edges_follow_the_next_cell_up_to_half_a_cell() {
    let stretched = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let edge = |to: Vector<f64>| SharedEdge::of(to, &stretched, [1.0, 0.0, 0.0]);
    // Half of what the next one is farther than carried, over the fourth root of 1 + (0.1/0.5)^4.
    let by_hand = 0.1 / 1.0016f64.sqrt().sqrt();
    assert!((edge([2.2, 0.0, 0.0]).shift()[0] - by_hand).abs() < 1e-15);
    assert!((edge([50.0, 0.0, 0.0]).shift()[0] - 0.5).abs() < 1e-3);
    let moment = moment_of_edge([3.0, 0.0, 0.0], &stretched, [1.0, 0.0, 0.0]);
    assert_eq!(moment[0], [-3.0, 0.0, 0.0]);
    let (to, change) = ([2.3, 0.4, -0.2], [0.3, -0.7, 0.5]);
    let moved = |by: f64| edge([0, 1, 2].map(|a| to[a] + 2.0 * by * change[a])).shift();
    let tangent = edge(to).tangent(change);
    for a in 0..3 {
        let difference = (moved(1e-6)[a] - moved(-1e-6)[a]) / 2e-6;
        assert!((difference - tangent[a]).abs() < 1e-9, "{a}: {difference} {}", tangent[a]);
    }
}

#[test]
fn stretched_edges_make_the_contact_firmer_and_let_go() {
    // Half of 400 times the square of a hundredth, over 1 + 1/9; at ten times where it yields a hundredth and first.
    let [energy, slope, stiffness] = firmer(0.01f64);
    assert!((energy - 0.02 / (10.0 / 9.0)).abs() < 1e-15 && (slope - 4.0 * 0.81).abs() < 1e-14);
    assert!((stiffness - 324.0).abs() < 1e-12);
    assert!((firmer(0.3f64)[1] - 120.0 / (101.0 * 101.0)).abs() < 1e-14);
    for stretch in [1e-3, 0.02, 0.1] {
        let difference = (firmer(stretch + 1e-7)[0] - firmer(stretch - 1e-7)[0]) / 2e-7;
        assert!((difference / firmer(stretch)[1] - 1.0).abs() < 1e-6, "{stretch}: {difference}");
    }
    // An edge that is carried to twice its width is stretched by half as much.
    let planar = facet(true, 1.0, 0.0);
    let wide = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut shifts = OnSides::zero();
    shifts.high[0] = [0.02, 0.3, 0.0];
    let now = Facet::now([0.0; 3], &wide, &planar).shifted(&planar, &wide, &shifts);
    assert!((now.misfit - energy).abs() < 1e-15, "{}", now.misfit);
    let springs = springs(&planar, &wide, &shifts, 5.0);
    assert!((springs.sides.high[0][0] + 5.0 * slope / 2.0).abs() < 1e-12, "{springs:?}");
    assert!((springs.stiffness - 0.5 * 5.0 * (stiffness + 400.0) / 4.0).abs() < 1e-10, "{springs:?}");
}
