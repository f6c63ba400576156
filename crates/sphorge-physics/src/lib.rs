//! Laws of smoothed-particle solid mechanics, each a pure function of numbers.
//!
//! No allocation, no arrays of particles, no input or output. Every law is generic over [`Real`] (arithmetic that also
//! exists for SIMD lanes) or [`Scalar`] (one number, with comparison and elementary functions).
//!
//! Conventions: Cauchy stress is positive in tension, pressure positive in compression, `sigma = S - p I`;
//! `x_ij = x_i - x_j`, `v_ij = v_i - v_j`; `L = grad v`, `L_ab = dv_a / dx_b`; SI units.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod dimension;
pub mod eos;
pub mod flow;
pub mod kernel;
pub mod parameter;
pub mod real;
pub mod return_mapping;
pub mod stress;
pub mod tensor;

pub use dimension::Dimension;
pub use real::{Real, Scalar};
pub use tensor::{SymmetricTensor, Tensor, Vector};
