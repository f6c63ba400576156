//! Laws of smoothed-particle solid mechanics, each a pure function of numbers.
//!
//! No allocation, no arrays of particles, no input or output. Every law is generic over [`Real`] (arithmetic that also
//! exists for SIMD lanes), [`Elementary`] (one number with elementary functions, in memory or on a graphics card) or [`Scalar`] (one
//! number in memory, which can be compared).
//!
//! Conventions: Cauchy stress is positive in tension, pressure positive in compression, `sigma = S - p I`;
//! `x_ij = x_i - x_j`, `v_ij = v_i - v_j`; `L = grad v`, `L_ab = dv_a / dx_b`; SI units.
//!
//! Two papers are followed, and their misprints corrected where they stand:
//! - *Fraser*: K. Fraser, Adaptive smoothed particle hydrodynamics neighbor search algorithm for large plastic deformation
//!   computational solid mechanics.
//! - *Patiño et al.*: E. A. Patiño, R. Reyes, D. A. García, A. F. Sarmiento, J. M. Arroyo, D. A. Garzón, Implementation of the
//!   smoothed particle hydrodynamics method to solve plastic deformation in metals.
#![cfg_attr(not(any(feature = "std", test)), no_std)]

pub mod artificial_stress;
pub mod audit;
pub mod conduction;
pub mod contact;
pub mod damage;
pub mod dimension;
pub mod eos;
pub mod face_gradient;
pub mod facet;
pub mod flow;
pub mod gradient_correction;
pub mod heat;
pub mod history;
pub mod hourglass;
pub mod hyperelastic;
pub mod integrity;
pub mod kernel;
pub mod kick;
pub mod moving_least_squares;
pub mod pair;
pub mod parameter;
pub mod real;
pub mod return_mapping;
pub mod section;
pub mod step_control;
pub mod stress;
pub mod surface;
pub mod tensile_part;
pub mod tensor;
pub mod thin;
pub mod time_step;
pub mod total_lagrangian;
pub mod viscosity;
pub mod wall;
pub mod xsph;

#[cfg(test)]
mod test_cloud;

pub use dimension::Dimension;
pub use real::{Elementary, Numbers, Real, Scalar};
pub use tensor::{SymmetricTensor, Tensor, Vector};
