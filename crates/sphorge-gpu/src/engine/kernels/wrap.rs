//! Wraps particles that have left a periodic cell to its other end.

use super::images::split;
use crate::engine::columns::{Recording, WriteColumns, groups, recording};
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// Before a search, because lists and images are those of positions within the cell, however many cells away particles
/// are.
pub(in crate::engine) fn wrap(model: &Model, count: usize) -> Result<Option<Recording>, KernelFault> {
    if model.periodic.iter().all(Option::is_none) {
        return Ok(None);
    }
    let kernel = recording("wrap", count, |bind, i| {
        let place = groups::Place::write(bind).position;
        let zero = Recorded::zero();
        for (axis, (low, high)) in model.periodic.iter().enumerate().filter_map(|(a, of)| of.map(|of| (a, of))) {
            let (far, period) = (place.axis(axis).double(i), Double::of(high - low));
            let from = |at: Double, end: f64| {
                let [end, rest] = split(end);
                (at.high - end) + (at.low - rest)
            };
            // Number of cells, rounded towards zero: in single precision the last may be one too many or too few.
            let gone = from(far, low) / period.high;
            let cells = Index::floor(gone.abs()).number();
            let at = far - period * Double::from(Recorded::select_lt(gone, zero, -cells, cells));
            let (up, down) = (at + period, at - period);
            let choose = |from: Recorded, then: Double, otherwise: Double| Double {
                high: Recorded::select_lt(from, zero, then.high, otherwise.high),
                low: Recorded::select_lt(from, zero, then.low, otherwise.low),
            };
            let inside = choose(from(at, low), up, at);
            let inside = choose(from(at, high), inside, down);
            place.axis(axis).set(i, [inside.high, inside.low]);
        }
    })?;
    Ok(Some(kernel))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Evaluation;
    use sphorge_deck::{decks, load_text};

    #[test]
    fn particles_are_wrapped_over_any_number_of_periods() {
        let deck = decks::find("taylor-plate").unwrap();
        let cell = ("periodic".to_owned(), "{ x = [\"-3.8 mm\", \"3.8 mm\"] }".to_owned());
        let model = load_text(deck.name, deck.text, &[cell]).unwrap().model;
        let (low, high) = model.periodic[0].unwrap();
        let cells = [-3000.2, -7.0 + 1e-9, -1.7, -1e-9, 0.0, 0.4, 1.0 - 1e-9, 1.0 + 1e-9, 2.5, 9.0 - 1e-9, 40.3];
        let places: Vec<f64> = cells.iter().map(|cell| low + cell * (high - low)).collect();
        let count = places.len();
        let kernel = wrap(&model, count).unwrap().unwrap();
        let mut place = vec![0.25f32; 6 * count];
        for (i, x) in places.iter().enumerate() {
            (place[i], place[3 * count + i]) = (*x as f32, (x - f64::from(*x as f32)) as f32);
        }
        let mut buffers = [place];
        Evaluation::default().run(&kernel.kernel, &mut buffers, count as u32);
        for (i, x) in places.iter().enumerate() {
            let [expected, found] = [
                low + (x - low).rem_euclid(high - low),
                f64::from(buffers[0][i]) + f64::from(buffers[0][3 * count + i]),
            ];
            assert!((found - expected).abs() < 1e-14 * (1.0 + x.abs()), "{x}: {found} {expected}");
            // Other axes are open.
            assert_eq!(buffers[0][count + i], 0.25);
        }
    }
}
