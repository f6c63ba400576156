//! A reduction as bytes, for a process to tell others what all of them are asked for.

use super::{Quantity, Reduction, Suspicion};
use crate::model::{Extremum, ParticleSelection};
use crate::persist::Fixed;
use sphorge_physics::Vector;

/// What a reduction consists of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReductionMessage {
    kind: u8,
    selection: ParticleSelection,
    field: String,
    component: Option<usize>,
    axis: usize,
    numbers: [f64; 7],
}

/// All but the name of the field: kind and component; body and region of the selection; its window; axis and numbers.
type Header = ((u8, Option<usize>), ((Option<usize>, Option<usize>), (Option<Window>, (usize, [f64; 7]))));
type Window = (Vector<f64>, Vector<f64>);

impl ReductionMessage {
    /// The message of a reduction that each process takes of its own particles, in turn; none of others.
    pub fn of(reduction: &Reduction<'_>) -> Option<Self> {
        let mut message = Self::default();
        let mut take = |kind: u8, of: Option<&ParticleSelection>, quantity: Option<Quantity<'_>>| {
            message.kind = kind;
            message.selection = of.cloned().unwrap_or_default();
            if let Some(Quantity { field, component }) = quantity {
                (message.field, message.component) = (field.to_owned(), component);
            }
        };
        match *reduction {
            Reduction::Extent { of, axis } => {
                take(0, Some(of), None);
                message.axis = axis;
            }
            Reduction::Diameter { of, axis } => {
                take(1, Some(of), None);
                message.axis = axis;
            }
            Reduction::Extremum { of, quantity, extremum } => {
                let kind = match extremum {
                    Extremum::Maximum => 2,
                    Extremum::Minimum => 3,
                };
                take(kind, Some(of), Some(quantity));
            }
            Reduction::Mean { of, quantity } => take(4, Some(of), Some(quantity)),
            Reduction::Interpolation { of, quantity, point } => {
                take(5, Some(of), Some(quantity));
                message.numbers[..3].copy_from_slice(&point);
            }
            Reduction::Slabs { of, quantity, axis, direction } => {
                take(6, Some(of), Some(quantity));
                (message.axis, message.numbers[0]) = (axis, direction);
            }
            Reduction::Nearest { point, body } => {
                take(7, Some(&ParticleSelection { body, ..ParticleSelection::default() }), None);
                message.numbers[..3].copy_from_slice(&point);
            }
            Reduction::OfParticle { id, quantity } => {
                take(8, None, Some(quantity));
                message.numbers[0] = f64::from(id);
            }
            Reduction::Suspects(suspicion) => {
                let (kind, limit) = match suspicion {
                    Suspicion::Cold(limit) => (9, limit),
                    Suspicion::Hot(limit) => (10, limit),
                    Suspicion::Compressed(limit) => (11, limit),
                    Suspicion::Expanded(limit) => (12, limit),
                    Suspicion::Away { limit, .. } => (13, limit),
                    Suspicion::Behind { limit, breaks } => (if breaks { 17 } else { 14 }, limit),
                    Suspicion::Lonely => (15, 0.0),
                    Suspicion::MissingHeat(limit) => (16, limit),
                    Suspicion::Apart | Suspicion::Paired | Suspicion::Torn | Suspicion::Inside { .. } => return None,
                };
                take(kind, None, None);
                message.numbers[6] = limit;
                if let Suspicion::Away { low, high, .. } = suspicion {
                    message.numbers[..3].copy_from_slice(&low);
                    message.numbers[3..6].copy_from_slice(&high);
                }
            }
            Reduction::SectionForce(_) => return None,
        }
        Some(message)
    }

    /// The reduction it is of.
    pub fn reduction(&self) -> Option<Reduction<'_>> {
        let (of, axis) = (&self.selection, self.axis);
        let quantity = Quantity { field: &self.field, component: self.component };
        let [x, y, z, u, v, w, limit] = self.numbers;
        let suspicion = match self.kind {
            0 => return Some(Reduction::Extent { of, axis }),
            1 => return Some(Reduction::Diameter { of, axis }),
            2 => return Some(Reduction::Extremum { of, quantity, extremum: Extremum::Maximum }),
            3 => return Some(Reduction::Extremum { of, quantity, extremum: Extremum::Minimum }),
            4 => return Some(Reduction::Mean { of, quantity }),
            5 => return Some(Reduction::Interpolation { of, quantity, point: [x, y, z] }),
            6 => return Some(Reduction::Slabs { of, quantity, axis, direction: x }),
            7 => return Some(Reduction::Nearest { point: [x, y, z], body: of.body }),
            8 => return Some(Reduction::OfParticle { id: x as u32, quantity }),
            9 => Suspicion::Cold(limit),
            10 => Suspicion::Hot(limit),
            11 => Suspicion::Compressed(limit),
            12 => Suspicion::Expanded(limit),
            13 => Suspicion::Away { low: [x, y, z], high: [u, v, w], limit },
            14 | 17 => Suspicion::Behind { limit, breaks: self.kind == 17 },
            15 => Suspicion::Lonely,
            16 => Suspicion::MissingHeat(limit),
            _ => return None,
        };
        Some(Reduction::Suspects(suspicion))
    }

    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let ParticleSelection { body, region, window } = self.selection;
        let header: Header = ((self.kind, self.component), ((body, region), (window, (self.axis, self.numbers))));
        let mut bytes = Vec::new();
        header.write(&mut bytes);
        bytes.extend_from_slice(self.field.as_bytes());
        bytes
    }

    /// What [`Self::to_bytes`] has written.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let ((kind, component), ((body, region), (window, (axis, numbers)))) =
            Header::read(bytes.get(..Header::SIZE)?)?;
        let selection = ParticleSelection { body, region, window };
        let field = std::str::from_utf8(&bytes[Header::SIZE..]).ok()?.to_owned();
        Some(Self { kind, selection, field, component, axis, numbers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_is_what_is_asked() {
        let window = Some(([f64::NEG_INFINITY, 1.0, 2.0], [3.0, f64::INFINITY, 4.0]));
        let of = &ParticleSelection { body: Some(2), region: Some(5), window };
        let quantity = Quantity { field: "velocity", component: Some(1) };
        let (low, high) = ([-1.0, f64::NEG_INFINITY, 0.1], [1.0, 2.0, f64::INFINITY]);
        let asked = [
            Reduction::Extent { of, axis: 1 },
            Reduction::Diameter { of, axis: 2 },
            Reduction::Extremum { of, quantity, extremum: Extremum::Maximum },
            Reduction::Extremum { of, quantity, extremum: Extremum::Minimum },
            Reduction::Mean { of, quantity: Quantity { field: "speed", component: None } },
            Reduction::Interpolation { of, quantity, point: [0.1, -0.2, 0.3] },
            Reduction::Slabs { of, quantity, axis: 1, direction: -1.0 },
            Reduction::Nearest { point: [0.1, -0.2, 0.3], body: Some(1) },
            Reduction::Nearest { point: [0.0; 3], body: None },
            Reduction::OfParticle { id: u32::MAX, quantity },
            Reduction::Suspects(Suspicion::Cold(-1e-3)),
            Reduction::Suspects(Suspicion::Hot(1.5)),
            Reduction::Suspects(Suspicion::MissingHeat(1.25)),
            Reduction::Suspects(Suspicion::Compressed(0.9)),
            Reduction::Suspects(Suspicion::Expanded(0.3)),
            Reduction::Suspects(Suspicion::Away { low, high, limit: 0.7 }),
            Reduction::Suspects(Suspicion::Behind { limit: 0.2, breaks: false }),
            Reduction::Suspects(Suspicion::Behind { limit: 0.3, breaks: true }),
            Reduction::Suspects(Suspicion::Lonely),
        ];
        for reduction in asked {
            let bytes = ReductionMessage::of(&reduction).unwrap().to_bytes();
            let told = ReductionMessage::read(&bytes).unwrap();
            assert_eq!(format!("{:?}", told.reduction().unwrap()), format!("{reduction:?}"));
        }
        assert_eq!(ReductionMessage::read(&[0; 20]), None);
        for whole in
            [Suspicion::Apart, Suspicion::Paired, Suspicion::Torn, Suspicion::Inside { faces: true, breaks: false }]
        {
            assert_eq!(ReductionMessage::of(&Reduction::Suspects(whole)), None);
        }
    }
}
