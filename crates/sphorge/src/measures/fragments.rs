//! Fragments of a body.

use crate::{
    fragments::Cloud,
    model::{FragmentQuantity, Model},
    particles::Particles,
};
use sphorge_physics::tensor::Tensor;

/// What hangs together of a body.
#[derive(Debug)]
pub(super) struct Fragments {
    /// Masses of the fragments, heaviest first, kg.
    masses: Vec<f64>,
    /// Mass of the body, kg.
    whole: f64,
}

impl Fragments {
    /// Of a body: its particles with integrity, joined up to `link` of its spacings, at least `least` of them.
    pub(super) fn of(
        model: &Model,
        particles: &Particles,
        deformation: Option<&[Tensor<f64>]>,
        body: usize,
        link: f64,
        least: u64,
    ) -> Self {
        let is_of_body = |i: usize| particles.body[i] as usize == body;
        let integrity = particles.column("integrity");
        let is_part = |i: usize| is_of_body(i) && integrity.as_ref().is_none_or(|of| of.component(i, 0) > 0.0);
        let cloud = Cloud {
            dimensions: model.dimensions.count(),
            position: &particles.position,
            deformation,
            link: link * model.bodies[body].spacing,
            periodic: model.periodic,
        };
        let joined = cloud.joined(is_part);
        let (mut mass, mut size) = (vec![0.0; particles.len()], vec![0u64; particles.len()]);
        for of in joined {
            mass[of.root] += particles.mass[of.particle];
            size[of.root] += 1;
        }
        let fragments = mass.into_iter().zip(size).filter(|(_, size)| *size >= least.max(1));
        let mut masses: Vec<f64> = fragments.map(|(mass, _)| mass).collect();
        masses.sort_by(|a, b| b.total_cmp(a));
        let whole = (0..particles.len()).filter(|&i| is_of_body(i)).map(|i| particles.mass[i]).sum();
        Self { masses, whole }
    }

    /// Number, or a mass, kg; zero where there is no such fragment.
    pub(super) fn quantity(&self, quantity: FragmentQuantity) -> f64 {
        let mass = |k: usize| self.masses.get(k).copied().unwrap_or(0.0);
        match quantity {
            FragmentQuantity::Number => self.masses.len() as f64,
            FragmentQuantity::Largest => mass(0),
            FragmentQuantity::Second => mass(1),
            FragmentQuantity::Loose => (self.whole - self.masses.iter().sum::<f64>()).max(0.0),
        }
    }
}
