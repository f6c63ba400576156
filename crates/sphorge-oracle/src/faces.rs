//! What sums of particles at faces have too much for quadratic fields, and the transpose of it, term by term.

use super::Oracle;
use super::pairs::{Image, minus};
use sphorge_physics::face_gradient::{
    FitNeighbor, ThirdOrder, contraction, fit, is_at_face, second_moment, weight_in_fit,
};
use sphorge_physics::{Tensor, Vector, tensor};

/// A particle at a face: `K_i`, and `q_ij` of each neighbour.
pub(crate) struct Face {
    i: usize,
    k: ThirdOrder,
    neighbors: Vec<(usize, Image, Vector<f64>)>,
}

/// Sums and stresses where there are faces.
#[derive(Default)]
pub(crate) struct Faces {
    pub(crate) of: Vec<Face>,
    /// What has been taken from the deformation gradients of the sums.
    pub(crate) excess: Vec<Tensor<f64>>,
    /// Sums of the middle of the step, and what is taken from them, 1/s.
    pub(crate) linear: Vec<Tensor<f64>>,
    pub(crate) taken: Vec<Tensor<f64>>,
    /// Energy that particles have of the stresses of others, W/kg.
    pub(crate) power: Vec<f64>,
}

/// A neighbour, as an image, its `X_j - X_i` (m), its slope (1/m) and its distance over the smoothing length.
type Slope = (usize, Image, Vector<f64>, Vector<f64>, f64);

impl Oracle {
    /// Finds the faces in the configuration of the sums.
    pub(crate) fn find_faces_of_sums(&mut self, at: &[Vector<f64>]) {
        if !self.model.formulation.is_quadratic_at_faces() {
            return;
        }
        let slopes = |i: usize| -> Vec<Slope> {
            let of = self.pairs(i, at).filter(|n| n.r < self.model.numerics.kernel.support() * n.h);
            of.map(|n| {
                let slope = super::pairs::apply(&self.correction[i], n.x.map(|x| self.initial_volume[n.j] * n.f * x));
                (n.j, n.image, n.x.map(|x| -x), slope, n.r / n.h)
            })
            .collect()
        };
        let slopes = self.each(slopes);
        let d = self.dimension.count();
        let is_exact = self.each(|i| {
            let sum = |a: usize, b: usize| slopes[i].iter().map(|(_, _, x, slope, _)| x[a] * slope[b]).sum::<f64>();
            (0..d).all(|a| (0..d).all(|b| (sum(a, b) - f64::from(u8::from(a == b))).abs() < 1e-3))
        });
        let moments = self.each(|i| second_moment(slopes[i].iter().map(|(_, _, x, slope, _)| (*x, *slope))));
        let support = self.model.numerics.kernel.support();
        let face = |i: usize| {
            let is_whole = is_exact[i] && !self.has_come_apart[self.p.body[i] as usize];
            if !is_whole || !is_at_face(&moments[i], self.p.smoothing_length[i]) {
                return None;
            }
            let told: Vec<_> = slopes[i].iter().filter(|(j, ..)| is_exact[*j]).collect();
            let weighted: Vec<_> = told.iter().map(|(_, _, x, _, q)| (*x, weight_in_fit(*q, support))).collect();
            let fitted = fit(&weighted, self.dimension)?;
            let seen: Vec<_> = told.iter().map(|(j, image, ..)| image.third_order(&moments[*j])).collect();
            let of = told.iter().zip(&fitted).zip(&seen);
            let of = of.map(|(((_, _, x, ..), q), moment)| FitNeighbor { x: *x, q: *q, moment });
            let k = contraction(&moments[i], of, self.dimension);
            Some(Face { i, k, neighbors: told.iter().zip(fitted).map(|((j, image, ..), q)| (*j, *image, q)).collect() })
        };
        let of = (0..self.p.len()).filter_map(face).collect();
        let none = || vec![tensor::zero(); self.p.len()];
        self.faces = Faces {
            of,
            linear: none(),
            taken: none(),
            power: vec![0.0; self.p.len()],
            ..std::mem::take(&mut self.faces)
        };
        self.faces.excess.resize(self.p.len(), tensor::zero());
    }

    /// What is taken from these sums, `E_ab = sum_cd K_bcd sum_j (G_j - G_i)_ac q_d`.
    pub(crate) fn taken_at_faces(&self, sums: &[Tensor<f64>]) -> Vec<Tensor<f64>> {
        let mut taken = vec![tensor::zero(); sums.len()];
        for Face { i, k, neighbors } in &self.faces.of {
            for (j, image, q) in neighbors {
                let other = image.tensor(&sums[*j]);
                for (a, c) in (0..9).map(|n| (n / 3, n % 3)) {
                    for (b, e) in (0..9).map(|n| (n / 3, n % 3)) {
                        taken[*i][a][b] += k[b][c][e] * (other[a][c] - sums[*i][a][c]) * q[e];
                    }
                }
            }
        }
        taken
    }

    /// The stresses that work on the sums, of stresses that work on what is left of them.
    pub(crate) fn transposed_at_faces(&mut self, stress: Vec<Tensor<f64>>) -> Vec<Tensor<f64>> {
        let work = |a: &Tensor<f64>, b: &Tensor<f64>| (0..9).map(|n| a[n / 3][n % 3] * b[n / 3][n % 3]).sum::<f64>();
        let mut of_sums = stress.clone();
        for Face { i, k, neighbors } in &self.faces.of {
            for (j, image, q) in neighbors {
                let mut along = tensor::zero();
                for (a, c) in (0..9).map(|n| (n / 3, n % 3)) {
                    for (b, e) in (0..9).map(|n| (n / 3, n % 3)) {
                        along[a][c] += stress[*i][a][b] * k[b][c][e] * q[e];
                    }
                }
                let share = -self.initial_volume[*i] / self.initial_volume[*j];
                of_sums[*i] = tensor::plus(&of_sums[*i], 1.0, &along);
                of_sums[*j] = tensor::plus(&of_sums[*j], share, &image.tensor(&along));
            }
        }
        for (i, (of_sum, own)) in of_sums.iter().zip(&stress).enumerate() {
            let more = [0, 1, 2].map(|a| minus(of_sum[a], own[a]));
            let power = -work(own, &self.faces.taken[i]) - work(&more, &self.faces.linear[i]);
            self.faces.power[i] = power * self.initial_volume[i] / self.p.mass[i];
        }
        of_sums
    }

    /// Sums without what is taken at faces.
    pub(crate) fn without_excess(&self, sums: Vec<Tensor<f64>>) -> Vec<Tensor<f64>> {
        let taken = self.taken_at_faces(&sums);
        sums.iter().zip(&taken).map(|(sum, taken)| [0, 1, 2].map(|a| minus(sum[a], taken[a]))).collect()
    }
}
