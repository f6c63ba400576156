use super::*;
use crate::model::{Arrangement, Lattice, Operation, Transform};
use std::f64::consts::PI;

fn shape(solid: Solid) -> Shape {
    Shape { solid, transform: Transform::default() }
}

fn composed(operation: Operation, parts: Vec<Shape>) -> Shape {
    shape(Solid::Composed { operation, parts: parts.into() })
}

fn ball(radius: f64) -> Shape {
    shape(Solid::Ball { centre: [0.0; 3], radius, inner_radius: 0.0 })
}

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Shape {
    shape(Solid::Box { min, max })
}

const PLANES: [SymmetryPlane; 2] =
    [SymmetryPlane { axis: 0, position: 0.0, side: 1.0 }, SymmetryPlane { axis: 1, position: 0.0, side: 1.0 }];

/// Facets of a shape filled at a spacing of one, with their places in space.
fn facets(
    shape: &Shape,
    dimensions: Dimensions,
    arrangement: Arrangement,
    symmetry: &[SymmetryPlane],
) -> Vec<ReferenceFacet<f64>> {
    let lattice = Lattice { arrangement, placement: LatticePlacement::CellCentres };
    let pattern = Pattern { dimensions, spacing: 1.0, density: 1.0, lattice };
    let near = Near { space: Space { dimensions, symmetry, periodic: &[None; 3] }, pattern, shape, thickness: 1.0 };
    let mut all = ReferenceFacets::empty(vec![1.0]);
    all.add_body(&near);
    let mut placed = Vec::new();
    let mut id = 0;
    pattern.for_each_site(shape, |site, _| {
        placed.extend(all.of(id).iter().map(|CellFacet { facet, .. }| ReferenceFacet {
            corners: facet.corners.map(|corner| std::array::from_fn(|k| corner[k] + site[k])),
            middle: std::array::from_fn(|k| facet.middle[k] + site[k]),
            ..*facet
        }));
        id += 1;
    });
    placed
}

fn total(facets: &[ReferenceFacet<f64>]) -> f64 {
    facets.iter().map(ReferenceFacet::area).sum()
}

fn trace(facet: &ReferenceFacet<f64>) -> f64 {
    facet.curvature.xx + facet.curvature.yy + facet.curvature.zz
}

fn is_flat(facet: &ReferenceFacet<f64>) -> bool {
    facet.curvature == SymmetricTensor::zero()
}

#[test]
fn faces_of_a_box_lie_where_the_deck_says() {
    // 10.3 by 4.6 spacings are 10 by 5 cells; the lattice is 0.15 short at either end of one edge and 0.2 over at those of the other.
    let all = facets(&cuboid([1.0, 2.0, 0.0], [11.3, 6.6, 0.0]), Dimensions::PlaneStrain, Arrangement::Square, &[]);
    assert_eq!(all.len(), 2 * (10 + 5));
    assert!((total(&all) - 2.0 * (10.3 + 4.6)).abs() < 1e-12);
    for facet in &all {
        let axis = usize::from(facet.normal[0] == 0.0);
        let face = [[1.0, 2.0], [11.3, 6.6]][usize::from(facet.normal[axis] > 0.0)][axis];
        assert!(facet.corners[..2].iter().chain([&facet.middle]).all(|p| (p[axis] - face).abs() < 1e-12), "{facet:?}");
    }
    let all = facets(&cuboid([0.0; 3], [3.2, 4.0, 2.9]), Dimensions::Three, Arrangement::Square, &[]);
    assert_eq!(all.len(), 2 * (12 + 12 + 9));
    assert!((total(&all) - 2.0 * (3.2 * 4.0 + 4.0 * 2.9 + 2.9 * 3.2)).abs() < 1e-12);
    let line = facets(&cuboid([0.0; 3], [5.3, 0.0, 0.0]), Dimensions::One, Arrangement::Square, &[]);
    let ends: Vec<_> = line.iter().map(|facet| (facet.middle[0], facet.normal[0])).collect();
    assert!(ends.len() == 2 && ends[0] == (0.0, -1.0) && (ends[1].0 - 5.3).abs() < 1e-12, "{ends:?}");
}

#[test]
fn facets_are_convex() {
    let at = |x: f64, y: f64| [x, y, 0.0];
    let up = [0.0, 0.0, 1.0];
    // One that is stays as it is, either way round, triangles and straight corners among them.
    for quad in [
        [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        [at(0.0, 1.0), at(1.0, 1.0), at(1.0, 0.0), at(0.0, 0.0)],
        [at(0.0, 0.0), at(1.0, 0.0), at(0.3, 1.0), at(0.3, 1.0)],
        [at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0), at(0.0, 1.0)],
    ] {
        assert_eq!(convex(quad, up), quad);
    }
    // A corner behind the diagonal goes; sides that cross are turned round.
    for (quad, area) in [
        ([at(0.0, 0.0), at(1.0, 0.0), at(0.2, 0.2), at(0.0, 1.0)], 0.5),
        ([at(0.0, 0.0), at(1.0, 1.0), at(1.0, 0.9), at(0.0, 0.95)], 0.5 * (0.95 + 0.1)),
        ([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)], 1.0),
    ] {
        let hull = convex(quad, up);
        let found = ReferenceFacet::flat(hull, up).area().abs();
        assert!((found - area).abs() < 1e-12, "{hull:?}: {found}");
    }
    // A cone filled with cubes has such faces where it meets the cylinder behind it.
    let pin = shape(Solid::Revolution {
        from: [0.0; 3],
        axis: [0.0, 0.0, 1.0],
        profile: vec![[10.0, 4.5], [12.0, 5.2], [26.0, 5.2]],
    });
    for facet in facets(&pin, Dimensions::Three, Arrangement::Square, &[]) {
        let turns = [0, 1, 2, 3].map(|k| {
            let way = |from: usize, to: usize| -> Vector<f64> {
                std::array::from_fn(|a| facet.corners[to % 4][a] - facet.corners[from % 4][a])
            };
            dot(cross(way(k, k + 1), way(k + 1, k + 2)), facet.normal)
        });
        assert!(turns.iter().all(|turn| *turn > -1e-6), "{facet:?}");
    }
}

/// Length of the free edges of facets.
fn free_length(all: &[ReferenceFacet<f64>]) -> f64 {
    let length = |facet: &ReferenceFacet<f64>, k: usize| {
        let (from, to) = (facet.corners[k], facet.corners[(k + 1) % 4]);
        (0..3).map(|a| (to[a] - from[a]).powi(2)).sum::<f64>().sqrt()
    };
    all.iter().flat_map(|facet| (0..4).map(move |k| facet.free[k] * length(facet, k))).sum()
}

#[test]
fn edges_are_free_where_the_body_has_an_edge() {
    // Of a box each edge is that of two faces; where a plane of symmetry is, there is none.
    let whole = cuboid([0.0; 3], [2.0, 3.0, 4.0]);
    let (three, square) = (Dimensions::Three, Arrangement::Square);
    let length = free_length(&facets(&whole, three, square, &[]));
    assert!((length - 8.0 * (2.0 + 3.0 + 4.0)).abs() < 1e-9, "{length}");
    let length = free_length(&facets(&whole, three, square, &PLANES[..1]));
    assert!((length - (8.0 * 2.0 + 4.0 * (3.0 + 4.0))).abs() < 1e-9, "{length}");
    // A strip is a unit thick; the inner edge of an angle is no edge at which it ends.
    let angle = composed(Operation::Union, vec![cuboid([0.0; 3], [6.0, 2.0, 0.0]), cuboid([0.0; 3], [2.0, 6.0, 0.0])]);
    let length = free_length(&facets(&angle, Dimensions::PlaneStrain, square, &[]));
    assert!((length - 10.0).abs() < 1e-9, "{length}");
    // A ball has none, however it is filled; a rod those of its ends.
    assert_eq!(free_length(&facets(&ball(6.0), three, square, &[])), 0.0);
    let rod = shape(Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 4.0], radius: 5.0, inner_radius: 0.0 });
    for arrangement in [Arrangement::Rings, square] {
        let length = free_length(&facets(&rod, three, arrangement, &[])) / (4.0 * 2.0 * PI * 5.0);
        assert!((0.9..1.1).contains(&length), "{arrangement:?}: {length}");
    }
}

#[test]
fn a_ball_of_cubes_is_round() {
    for (radius, tolerance) in [(5.0, 0.015), (10.0, 0.004)] {
        let all = facets(&ball(radius), Dimensions::Three, Arrangement::Square, &[]);
        let share = total(&all) / (4.0 * PI * radius * radius);
        assert!((share - 1.0).abs() < tolerance, "{share}");
        for facet in &all {
            // The tangent plane at the middle, with the corners half a spacing to either side of it.
            assert!((dot(facet.middle, facet.normal) - radius).abs() < 1e-9, "{facet:?}");
            assert!(facet.corners.iter().all(|p| (dot(*p, facet.normal) - radius).abs() < 1e-9), "{facet:?}");
            assert!((trace(facet) - 2.0 / radius).abs() < 1e-12);
        }
    }
    // An eighth beside planes has no facets in them, and those beside them belong to the sphere.
    let eighth = composed(Operation::Intersection, vec![ball(10.0), cuboid([0.0; 3], [20.0; 3])]);
    let third = SymmetryPlane { axis: 2, position: 0.0, side: 1.0 };
    let all = facets(&eighth, Dimensions::Three, Arrangement::Square, &[PLANES[0], PLANES[1], third]);
    let share = total(&all) / (0.5 * PI * 100.0);
    assert!((share - 1.0).abs() < 0.004, "{share}");
    assert!(all.iter().all(|facet| (dot(facet.middle, facet.normal) - 10.0).abs() < 1e-9));
}

#[test]
fn rings_are_round_inside_and_outside() {
    let ring = shape(Solid::Ball { centre: [0.0; 3], radius: 6.0, inner_radius: 3.0 });
    let all = facets(&ring, Dimensions::PlaneStrain, Arrangement::Rings, &[]);
    let (inside, outside): (Vec<_>, Vec<_>) =
        all.iter().copied().partition(|facet: &ReferenceFacet<f64>| dot(facet.middle, facet.normal) < 0.0);
    assert_eq!(inside.len() + outside.len(), all.len());
    for (facets, radius, sign) in [(inside, 3.0, -1.0), (outside, 6.0, 1.0)] {
        for facet in facets {
            let above = |p: &Vector<f64>| dot(*p, facet.normal) - sign * radius;
            assert!(facet.corners.iter().chain([&facet.middle]).all(|p| above(p).abs() < 1e-12));
            assert!((trace(&facet) - sign / radius).abs() < 1e-12, "{facet:?}");
        }
    }
    // A quarter beside planes, and a quarter alone, which has two more sides.
    let quarter = composed(Operation::Intersection, vec![ring, cuboid([0.0; 3], [9.0; 3])]);
    let beside = facets(&quarter, Dimensions::PlaneStrain, Arrangement::Rings, &PLANES);
    assert_eq!(4 * beside.len(), all.len());
    let alone = facets(&quarter, Dimensions::PlaneStrain, Arrangement::Rings, &[]);
    assert_eq!(alone.len(), beside.len() + 2 * 3);
    let flat: f64 = alone.iter().filter(|f| is_flat(f)).map(ReferenceFacet::area).sum();
    assert!((flat - 6.0).abs() < 1e-9, "{flat}");
}

#[test]
fn a_tube_of_slices_has_flat_ends_and_round_sides() {
    let tube = shape(Solid::Cylinder { from: [0.0; 3], to: [3.0, 4.0, 0.0], radius: 4.0, inner_radius: 2.0 });
    for arrangement in [Arrangement::Rings, Arrangement::Square] {
        let all = facets(&tube, Dimensions::Three, arrangement, &[]);
        let along = |f: &ReferenceFacet<f64>| (0.6 * f.normal[0] + 0.8 * f.normal[1]).abs();
        let (ends, sides): (Vec<_>, Vec<_>) = all.iter().copied().partition(|f| along(f) > 0.5);
        assert!(ends.iter().all(|f| (along(f) - 1.0).abs() < 1e-12 && is_flat(f)));
        assert!(sides.iter().all(|f| along(f) < 1e-12));
        let of = |some: Vec<ReferenceFacet<f64>>| some.iter().map(ReferenceFacet::area).sum::<f64>();
        let (ends, sides) = (of(ends) / (2.0 * PI * 12.0), of(sides) / (2.0 * PI * 6.0 * 5.0));
        assert!((ends - 1.0).abs() < 0.03 && (sides - 1.0).abs() < 0.02, "{arrangement:?}: {ends} {sides}");
    }
}

#[test]
fn slices_of_rings_leave_no_gaps_at_their_ends() {
    let rod = shape(Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 3.0], radius: 6.0, inner_radius: 0.0 });
    let all = facets(&rod, Dimensions::Three, Arrangement::Rings, &[]);
    let end: Vec<_> = all.iter().filter(|f| f.normal[2] > 0.5).collect();
    // A quarter beside planes has a quarter of them, at the axis too.
    for arrangement in [Arrangement::Rings, Arrangement::Square] {
        let cut = cuboid([0.0; 3], [9.0, 9.0, 3.0]);
        let quarter = composed(Operation::Intersection, vec![rod.clone(), cut]);
        let beside = facets(&quarter, Dimensions::Three, arrangement, &PLANES);
        let whole = facets(&rod, Dimensions::Three, arrangement, &[]);
        assert_eq!(4 * beside.len(), whole.len());
        assert!((4.0 * total(&beside) / total(&whole) - 1.0).abs() < 1e-9, "{arrangement:?}");
    }
    // Each ring has its area, also the four sectors about the axis.
    for ring in 0..6 {
        let (inner, outer) = (f64::from(ring), f64::from(ring + 1));
        let of_ring = end.iter().filter(|f| {
            let r = f.middle[0].hypot(f.middle[1]);
            inner < r && r < outer
        });
        let share = of_ring.map(|f| f.area()).sum::<f64>() / (PI * (outer * outer - inner * inner));
        // Straight edges of the outermost do not go beyond the shape.
        let most = if ring == 5 { 0.02 } else { 0.01 };
        assert!((share - 1.0).abs() < most, "ring {ring}: {share}");
    }
}

#[test]
fn a_hole_in_a_plate_bends_inwards() {
    let disc = shape(Solid::Ball { centre: [8.0, 8.0, 0.0], radius: 4.0, inner_radius: 0.0 });
    let plate = composed(Operation::Difference, vec![cuboid([0.0; 3], [16.0, 16.0, 0.0]), disc]);
    let all = facets(&plate, Dimensions::PlaneStrain, Arrangement::Square, &[]);
    let (round, flat): (Vec<_>, Vec<_>) = all.iter().copied().partition(|f| !is_flat(f));
    assert!((flat.iter().map(ReferenceFacet::area).sum::<f64>() - 64.0).abs() < 1e-9);
    let share = round.iter().map(ReferenceFacet::area).sum::<f64>() / (8.0 * PI);
    assert!((share - 1.0).abs() < 0.01, "{share}");
    assert!(round.iter().all(|f| (trace(f) + 0.25).abs() < 1e-12));
}

#[test]
fn rows_of_a_hexagonal_lattice_leave_no_gaps_in_a_face() {
    let all = facets(&cuboid([0.0; 3], [20.0, 12.0, 0.0]), Dimensions::PlaneStrain, Arrangement::Hexagonal, &[]);
    let share = total(&all) / 64.0;
    assert!((share - 1.0).abs() < 0.02, "{share}");
}

/// What is beside the cells of a shape filled at a spacing of one, with the places of their particles.
fn beside(
    shape: &Shape,
    dimensions: Dimensions,
    arrangement: Arrangement,
    symmetry: &[SymmetryPlane],
    periodic: &[Option<(f64, f64)>; 3],
) -> Vec<(Vector<f64>, Beside, Vec<CellFacet>)> {
    let lattice = Lattice { arrangement, placement: LatticePlacement::CellCentres };
    let pattern = Pattern { dimensions, spacing: 1.0, density: 1.0, lattice };
    let mut all = ReferenceFacets::empty(vec![1.0]);
    all.add_body(&Near { space: Space { dimensions, symmetry, periodic }, pattern, shape, thickness: 1.0 });
    let (mut found, mut id) = (Vec::new(), 0);
    pattern.for_each_site(shape, |site, _| {
        assert_eq!(all.beside(id).is_some(), !all.of(id).is_empty());
        found.extend(all.beside(id).map(|beside| (site, *beside, all.of(id).to_vec())));
        id += 1;
    });
    assert_eq!(all.beside(id), None);
    found
}

#[test]
fn cells_at_the_surface_know_those_beside_them() {
    let plate = cuboid([0.0; 3], [4.0, 3.0, 0.0]);
    let all = beside(&plate, Dimensions::PlaneStrain, Arrangement::Square, &[], &[None; 3]);
    assert_eq!(all.len(), 10);
    for (site, beside, facets) in &all {
        for side in 0..4 {
            let step = if side % 2 == 0 { -1.0 } else { 1.0 };
            let mut there = *site;
            there[side / 2] += step;
            let has_facets = all.iter().any(|(other, ..)| (0..3).all(|a| (other[a] - there[a]).abs() < 1e-9));
            assert_eq!(beside.way(side).is_some(), has_facets, "{site:?} {side}");
            if has_facets {
                assert_eq!(usize::from(beside.facing[side]), side ^ 1);
            }
        }
        for CellFacet { side, facet } in facets {
            let (own, along) = (usize::from(*side) / 2, 1 - usize::from(*side) / 2);
            assert_eq!(facet.across[own], [0.0; 3]);
            let expected =
                if beside.way(2 * along).is_some() || beside.way(2 * along + 1).is_some() { 1.0 } else { 0.0 };
            assert!((facet.across[along][along] - expected).abs() < 1e-9, "{site:?} {side} {:?}", facet.across);
        }
    }
    // What is at a symmetry plane has its own image beside it, whose side looks back; at a periodic end what is at the other.
    let half = beside(&plate, Dimensions::PlaneStrain, Arrangement::Square, &PLANES[..1], &[None; 3]);
    let at_plane: Vec<_> = half.iter().filter(|(site, ..)| site[0] < 1.0).collect();
    assert!(at_plane.iter().all(|(_, beside, _)| beside.way(0) == Some([-1.0, 0.0, 0.0]) && beside.facing[0] == 0));
    assert_eq!(at_plane.len(), 2);
    let endless = [Some((0.0, 4.0)), None, None];
    let strip = beside(&plate, Dimensions::PlaneStrain, Arrangement::Square, &[], &endless);
    let at_end: Vec<_> = strip.iter().filter(|(site, ..)| site[0] < 1.0).collect();
    assert!(at_end.iter().all(|(_, beside, _)| beside.way(0).is_some() && beside.facing[0] == 1), "{at_end:?}");
}

#[test]
fn cells_of_rings_lie_beside_each_other_along_them() {
    for arrangement in [Arrangement::Rings, Arrangement::Square] {
        let all = beside(&ball(6.0), Dimensions::PlaneStrain, arrangement, &[], &[None; 3]);
        let outer: Vec<_> = all.iter().filter(|(site, ..)| site[0].hypot(site[1]) > 5.0).collect();
        for (site, beside, facets) in outer {
            if arrangement == Arrangement::Rings {
                assert!(beside.way(2).is_some() && beside.way(3).is_some(), "{site:?}");
                assert_eq!((beside.facing[2], beside.facing[3]), (3, 2));
                // Along the surface, one over the way to the next.
                let across = facets[0].facet.across[1];
                let radius = site[0].hypot(site[1]);
                assert!(
                    dot(across, *site).abs() < 1e-9 && (dot(across, across).sqrt() - 1.0).abs() < 0.2,
                    "{radius} {across:?}"
                );
            }
        }
    }
}

#[test]
fn cells_that_lie_beside_others_have_those_beside_them() {
    // In some of these rings a cell expects one of the next ring where that does not expect it.
    let mut count = 0;
    for radius in [7.0, 9.5, 24.0, 24.4, 31.0] {
        for planes in [&PLANES[..0], &PLANES[..1], &PLANES[..]] {
            let low = |axis: usize| if planes.iter().any(|plane| plane.axis == axis) { 0.0 } else { -40.0 };
            let part = cuboid([low(0), low(1), 0.0], [40.0, 40.0, 1.0]);
            // At the ends of a slice all cells have facets.
            let slice = shape(Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 1.0], radius, inner_radius: 0.0 });
            let shape = composed(Operation::Intersection, vec![slice, part]);
            let all = beside(&shape, Dimensions::Three, Arrangement::Rings, planes, &[None; 3]);
            for (site, of, _) in &all {
                for (side, way) in (0..4).filter_map(|side| Some((side, of.way(side)?))) {
                    let near =
                        |a: Vector<f64>, b: Vector<f64>| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>() < 0.02;
                    let image = |place: Vector<f64>| -> Vector<f64> {
                        std::array::from_fn(|k| {
                            if planes.iter().any(|plane| plane.axis == k) { place[k].abs() } else { place[k] }
                        })
                    };
                    let there = std::array::from_fn(|k| site[k] + way[k]);
                    let facing = usize::from(of.facing[side]);
                    let back = all.iter().find(|(other, ..)| near(*other, there) || near(*other, image(there)));
                    let (other, other_of, _) = back.unwrap();
                    let home = other_of.way(facing).unwrap();
                    let home = std::array::from_fn(|k| other[k] + home[k]);
                    assert!(near(home, *site) || near(image(home), *site), "{site:?} {side}");
                    assert_eq!(usize::from(other_of.facing[facing]), side);
                    count += 1;
                }
            }
        }
    }
    assert!(count > 2000, "{count}");
}
