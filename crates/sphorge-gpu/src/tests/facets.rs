//! The contact of facets as functions of an array of numbers.

use sphorge_physics::facet::{
    Facet, FacetImpact, FacetPairLaw, FacetSlip, FrictionShare, Partner, ReferenceFacet, SlipDrive, friction_force,
    press, slip_after,
};
use sphorge_physics::tensor::identity;
use sphorge_physics::{Elementary, SymmetricTensor, Tensor};

const LAW: FacetPairLaw<f64> = FacetPairLaw {
    stiffness: 2.0,
    damping: 0.3,
    friction: 0.3,
    tangential_stiffness: 1.0,
    gives_way: 0.0,
    coincidence: 0.0,
};

/// The square face of a unit cube around its owner that looks along y to `side`, of a surface with a curvature along x.
fn square<T: Elementary>(side: f64, curvature: T) -> ReferenceFacet<T> {
    let (h, y) = (0.5, 0.5 * side);
    let corners = [[-h, y, side * h], [h, y, side * h], [h, y, -side * h], [-h, y, -side * h]];
    let normal = [0.0, side, 0.0].map(T::of);
    let mut facet = ReferenceFacet::flat(corners.map(|corner| corner.map(T::of)), normal);
    facet.curvature = SymmetricTensor { xx: curvature, ..SymmetricTensor::zero() };
    // A cube alone ends at every edge: pairs beside each other lap.
    facet.free = [T::one(); 4];
    facet
}

fn deformed<T: Elementary>(x: &[T]) -> Tensor<T> {
    let mut f = identity();
    for (k, c) in f.as_flattened_mut().iter_mut().enumerate() {
        *c += x[k];
    }
    f
}

/// How far arguments of [`pair`] and [`slip`] go: the owner of the first, deformations of both, curvatures of both, velocity and slip.
pub(super) const RANGES: [(f32, f32); 28] = {
    let f = (-0.3, 0.3);
    let mut all = [f; 28];
    (all[0], all[1], all[2]) = ((-0.8, 0.8), (0.2, 1.05), (-0.8, 0.8));
    (all[21], all[22]) = ((-0.2, 0.2), (-0.2, 0.2));
    all
};

fn facets<T: Elementary>(x: &[T]) -> [Facet<T>; 2] {
    let owner = [x[0], x[1], x[2]];
    let positive = |c: T| c.max(T::zero());
    let a = Facet::now(owner, &deformed(&x[3..12]), &square(-1.0, positive(x[21])));
    // Half of them are in the middle of a face.
    let free = [T::select_lt(x[20], T::zero(), T::zero(), T::one()); 4];
    let b = ReferenceFacet { free, ..square(1.0, positive(x[22])) };
    [a, Facet::now([T::zero(); 3], &deformed(&x[12..21]), &b)]
}

/// Half of the pairs give way.
fn law<T: Elementary>(x: &[T]) -> FacetPairLaw<T> {
    let [never, ever] = [LAW, LAW.giving_way(FacetImpact::default(), 1.0)].map(|law| T::of(law.gives_way));
    FacetPairLaw { gives_way: T::select_lt(x[19], T::zero(), never, ever), ..LAW.cast() }
}

/// Energy, force and moments of a pair, also with a plane.
pub(super) fn pair<T: Elementary>(x: &[T]) -> Vec<T> {
    let ([a, b], law) = (facets(x), law(x));
    let plane = a.foot_on_plane([0.0, 0.4, 0.0].map(T::of), [0.0, 1.0, 0.0].map(T::of));
    let mut results = Vec::new();
    for (other, partner) in [(&b, Partner::Facet), (&plane, Partner::Plane)] {
        let p = press(&a, other, partner, &law);
        results.extend([p.energy, p.normal_force, p.area, p.stiffness]);
        for part in [p.force, p.normal, p.centre_a, p.centre_b] {
            results.extend(part);
        }
        for part in [p.moment_a, p.moment_b] {
            results.extend(part.into_iter().flatten());
        }
    }
    results
}

/// Friction and damping of a pair.
pub(super) fn slip<T: Elementary>(x: &[T]) -> Vec<T> {
    let ([a, b], law) = (facets(x), law(x));
    let still = [[T::zero(); 3]; 3];
    let mut p = press(&a, &b, Partner::Facet, &law);
    let velocity = p.velocity([x[23], x[24], x[25]], &deformed(&x[12..21]), [T::zero(); 3], &still);
    let (force, heat) = p.damping(&law, velocity);
    let mut drive = SlipDrive::none();
    drive.add(&FrictionShare::of(&p, &law, velocity, false));
    let before = FacetSlip { slip: [x[26], x[27]], stiffness: T::of(0.4) };
    let (after, rubbed) = slip_after(&before, &a, &drive, T::of(0.1));
    p.add_at_centre(friction_force(&p, &law, after.vector(&a), [T::zero(); 3], false));
    let mut results = vec![heat, rubbed, after.energy(), after.stiffness];
    results.extend(force.into_iter().chain(p.force).chain(after.slip));
    results.extend(p.moment_a.into_iter().chain(p.moment_b).flatten());
    results
}
