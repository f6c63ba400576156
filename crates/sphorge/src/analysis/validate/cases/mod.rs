//! The cases, one file each.

mod elastic_bar;
mod elastic_plastic_piston;
mod high_shear;
mod oscillating_plate;
mod penetration;
mod plate_impact;
mod rotating_rod;
mod taylor_bar;
mod taylor_plate;

use super::Case;

/// Every case, in the order they are shown in.
pub const CASES: &[Case] = &[
    taylor_plate::CASE,
    taylor_bar::CASE,
    high_shear::CASE,
    penetration::CASE,
    plate_impact::CASE,
    elastic_plastic_piston::CASE,
    elastic_bar::CASE,
    oscillating_plate::CASE,
    rotating_rod::CASE,
];
