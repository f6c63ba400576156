//! The cases, one file each.

mod bar_elements;
mod bar_outline;
mod bullet;
mod convecting_block;
mod crack_energy;
mod disc_on_plate;
mod elastic_bar;
mod elastic_plastic_piston;
mod failure_strains;
mod heat_slab;
mod heat_solutions;
mod high_shear;
mod homogeneous;
mod iron_plate;
mod notched_bars;
mod oscillating_plate;
mod penetration;
mod plate_impact;
mod pulled;
mod rotating_rod;
mod rubber_rings;
mod spall;
mod taylor_bar;
mod taylor_bar_42crmo4;
mod taylor_bars;
mod taylor_fracture;
mod taylor_plate;
mod tensile;
mod two_materials;
mod weldox_tension;

use super::Case;

/// Every case, in the order they are shown in.
pub const CASES: &[Case] = &[
    iron_plate::CASE,
    taylor_plate::CASE,
    taylor_bar::CASE,
    taylor_bar_42crmo4::CASE,
    taylor_bars::CASE,
    high_shear::CASE,
    penetration::CASE,
    disc_on_plate::CASE,
    tensile::CASE,
    pulled::CASE,
    bullet::CASE,
    plate_impact::CASE,
    elastic_plastic_piston::CASE,
    homogeneous::CASE,
    elastic_bar::CASE,
    oscillating_plate::CASE,
    rubber_rings::CASE,
    rotating_rod::CASE,
    heat_slab::CASE,
    two_materials::CASE,
    convecting_block::CASE,
    failure_strains::CASE,
    weldox_tension::CASE,
    notched_bars::CASE,
    spall::CASE,
    taylor_fracture::CASE,
    crack_energy::CASE,
];
