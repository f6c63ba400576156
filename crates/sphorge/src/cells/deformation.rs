//! How the cells of a frame are deformed, and which of them hold to no other.

use crate::output::{FrameFile, OutputError};
use crate::particles::DEFORMATION_GRADIENT;

const UNDEFORMED: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The deformation of the cells of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Deformation {
    /// Gradients, nine numbers each.
    pub(super) gradient: Vec<f32>,
    /// Whether each is severed, and so holds to no other; empty where none is.
    pub(super) severed: Vec<bool>,
}

impl Deformation {
    /// Of a frame that has the deformation gradient. That of a particle without integrity is one of debris that flies apart, as long as the way it went:
    /// it is drawn as it was at the start, and joined to nobody.
    pub(crate) fn read(frame: &mut FrameFile) -> Result<Option<Self>, OutputError> {
        let Some(gradient) = frame.column(DEFORMATION_GRADIENT)?.filter(|of| of.width == 9) else { return Ok(None) };
        let mut gradient = gradient.values;
        let integrity = frame.column("integrity")?.map(|column| column.values).unwrap_or_default();
        let severed: Vec<bool> = integrity.iter().map(|integrity| *integrity <= 0.0).collect();
        let (cells, _) = gradient.as_chunks_mut::<9>();
        cells.iter_mut().zip(&severed).filter(|(_, severed)| **severed).for_each(|(f, _)| *f = UNDEFORMED);
        let severed = if severed.contains(&true) { severed } else { Vec::new() };
        Ok(Some(Self { gradient, severed }))
    }

    /// Of cells that all hold to others.
    #[cfg(test)]
    pub(crate) fn whole(gradient: Vec<f32>) -> Self {
        Self { gradient, severed: Vec::new() }
    }

    pub(super) fn is_severed(&self, cell: u32) -> bool {
        self.severed.get(cell as usize).is_some_and(|severed| *severed)
    }

    /// The gradient of a cell.
    pub(super) fn of(&self, cell: u32) -> [[f64; 3]; 3] {
        let f = &self.gradient[9 * cell as usize..][..9];
        std::array::from_fn(|a| std::array::from_fn(|b| f64::from(f[3 * a + b])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        output::{FrameHeader, FrameWriter},
        particles::{Column, Particles},
    };

    #[test]
    fn what_has_no_integrity_is_undeformed_and_severed_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtp");
        let stretched = |stretch: f64| [[1.0, stretch, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]];
        let mut particles = Particles::new(4);
        particles.deformation = [9.0, 9.0, 1.5, 1e6].map(stretched).to_vec();
        let mut read = |fields: &[&str], integrity: [f64; 4]| {
            particles.set_column("integrity", &Column::Scalar(integrity.to_vec().into()));
            let header = FrameHeader { time: 0.0, step: 0, dimensions: 3, body_spacing: vec![1e-3] };
            let fields: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
            let mut file = std::fs::File::create(&path).unwrap();
            FrameWriter::default().write(&mut file, &header, &particles, &fields).unwrap();
            let deformation = Deformation::read(&mut FrameFile::open(&path).unwrap()).unwrap();
            deformation.map(|of| ([0, 1, 2, 3].map(|i| of.gradient[9 * i + 1]), of.severed))
        };
        // A neck that has some integrity is drawn out.
        let (both, torn) = ([DEFORMATION_GRADIENT, "integrity"], [0.1, 0.0, 0.0, 0.0]);
        assert_eq!(read(&both, torn), Some(([9.0, 0.0, 0.0, 0.0], vec![false, true, true, true])));
        let as_it_is = Some(([9.0, 9.0, 1.5, 1e6], Vec::new()));
        assert_eq!((read(&both, [1.0; 4]), read(&both[..1], torn)), (as_it_is.clone(), as_it_is));
        assert_eq!(read(&both[1..], torn), None);
    }
}
