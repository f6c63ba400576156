//! Fields that pictures compute from what frames always have.

use super::PlotError;
use crate::output::{FrameColumn, FrameFile};

/// A field that a frame need not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Derived {
    /// From the positions in the first frame.
    Displacement,
    /// From the velocity.
    Speed,
    /// From the stress.
    Triaxiality,
}

impl Derived {
    const ALL: [(Self, &'static str, Option<&'static str>); 3] = [
        (Self::Displacement, "displacement", None),
        (Self::Speed, "speed", Some("velocity")),
        (Self::Triaxiality, "triaxiality", Some("stress")),
    ];

    fn can(frame: &FrameFile, name: &str, of: Option<&str>) -> bool {
        let has = |name: &str| frame.arrays().iter().any(|array| array.name == name);
        !has(name) && of.is_none_or(has)
    }

    /// The field of that name, if a frame does not have it, but what it is computed from.
    pub(crate) fn of(name: &str, frame: &FrameFile) -> Option<Self> {
        let named = Self::ALL.into_iter().find(|(_, own, of)| *own == name && Self::can(frame, name, *of));
        named.map(|(field, ..)| field)
    }

    /// Names of those that can be computed for a frame.
    pub(crate) fn all(frame: &FrameFile) -> impl Iterator<Item = String> {
        let those = Self::ALL.into_iter().filter(|(_, name, of)| Self::can(frame, name, *of));
        those.map(|(_, name, _)| name.to_owned())
    }

    pub(crate) fn components(self) -> &'static [&'static str] {
        match self {
            Self::Displacement => &["X", "Y", "Z"],
            Self::Speed | Self::Triaxiality => &[],
        }
    }

    /// Its values; `start` reads where particles were in the first frame.
    pub(crate) fn column(
        self,
        frame: &mut FrameFile,
        start: impl Fn() -> Result<Vec<[f64; 3]>, PlotError>,
    ) -> Result<Option<FrameColumn>, PlotError> {
        let of_rows = |column: Option<FrameColumn>, value: fn(&[f32]) -> f64| {
            let column = column?;
            let values = column.values.chunks_exact(column.width.max(1)).map(|row| value(row) as f32).collect();
            Some(FrameColumn { width: 1, values })
        };
        Ok(match self {
            Self::Displacement => {
                let (now, then) = (frame.positions()?, start()?);
                if now.len() != then.len() {
                    let reason = "the first frame has another number of particles".to_owned();
                    return Err(PlotError::Empty { reason });
                }
                let way = now.iter().zip(&then).flat_map(|(now, then)| [0, 1, 2].map(|a| (now[a] - then[a]) as f32));
                Some(FrameColumn { width: 3, values: way.collect() })
            }
            Self::Speed => {
                of_rows(frame.column("velocity")?, |v| v.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt())
            }
            Self::Triaxiality => of_rows(frame.column("stress")?, triaxiality),
        })
    }
}

/// Mean over von Mises stress of components xx, yy, zz, xy, yz, xz; zero without von Mises stress.
fn triaxiality(stress: &[f32]) -> f64 {
    let [xx, yy, zz, xy, yz, xz] = std::array::from_fn(|k| stress.get(k).copied().map_or(0.0, f64::from));
    let mean = (xx + yy + zz) / 3.0;
    let normal: f64 = [xx, yy, zz].iter().map(|s| (s - mean).powi(2)).sum();
    let von_mises = (1.5 * (normal + 2.0 * (xy * xy + yz * yz + xz * xz))).sqrt();
    if von_mises > 0.0 { mean / von_mises } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triaxiality_of_tension_is_a_third_and_of_shear_nothing() {
        assert!((triaxiality(&[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]) - 1.0 / 3.0).abs() < 1e-12);
        assert!((triaxiality(&[-6.0, -6.0, -6.0, 0.0, 0.0, 2.0]) + 6.0 / 12f64.sqrt()).abs() < 1e-12);
        assert_eq!(triaxiality(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]), 0.0);
        assert_eq!(triaxiality(&[0.0; 6]), 0.0);
    }
}
