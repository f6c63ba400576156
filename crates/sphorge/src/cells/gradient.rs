//! The deformation gradients by which cells are drawn.

use crate::output::{FrameColumn, FrameFile, OutputError};
use crate::particles::DEFORMATION_GRADIENT;

/// A cell that bears nothing any more is drawn by its deformation gradient up to this stretch.
const WIDEST: f32 = 2.0;

const UNDEFORMED: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The deformation gradients of a frame, if it has them. Of a particle without integrity the gradient is that of debris that flies apart, and its cell
/// would cover the picture: from a stretch of [`WIDEST`] on it is drawn as it was at the start.
pub(crate) fn drawn_gradients(frame: &mut FrameFile) -> Result<Option<FrameColumn>, OutputError> {
    let Some(mut gradient) = frame.column(DEFORMATION_GRADIENT)?.filter(|of| of.width == 9) else { return Ok(None) };
    let Some(integrity) = frame.column("integrity")? else { return Ok(Some(gradient)) };
    let (cells, _) = gradient.values.as_chunks_mut::<9>();
    for (f, _) in cells.iter_mut().zip(integrity.values).filter(|(_, integrity)| *integrity <= 0.0) {
        // The images of the edges of a cell are the columns.
        let edge = |k: usize| f[k].hypot(f[k + 3]).hypot(f[k + 6]);
        if (0..3).any(|k| edge(k) > WIDEST) {
            *f = UNDEFORMED;
        }
    }
    Ok(Some(gradient))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        output::{FrameHeader, FrameWriter},
        particles::{Column, Particles},
    };

    #[test]
    fn debris_that_is_drawn_out_is_drawn_undeformed_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtp");
        let stretched = |stretch: f64| [[1.0, stretch, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]];
        let mut particles = Particles::new(4);
        particles.deformation = [9.0, 9.0, 1.5, 1e6].map(stretched).to_vec();
        particles.set_column("integrity", &Column::Scalar(vec![0.1, 0.0, 0.0, 0.0].into()));
        let header = FrameHeader { time: 0.0, step: 0, dimensions: 3, body_spacing: vec![1e-3] };
        let write = |fields: &[&str]| {
            let fields: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
            let mut file = std::fs::File::create(&path).unwrap();
            FrameWriter::default().write(&mut file, &header, &particles, &fields).unwrap();
            let drawn = drawn_gradients(&mut FrameFile::open(&path).unwrap()).unwrap();
            drawn.map(|drawn| [0, 1, 2, 3].map(|i| drawn.values[9 * i + 1]))
        };
        // A neck that has some integrity is drawn out, and a severed cell that is hardly stretched as well.
        assert_eq!(write(&[DEFORMATION_GRADIENT, "integrity"]), Some([9.0, 0.0, 1.5, 0.0]));
        assert_eq!(write(&[DEFORMATION_GRADIENT]), Some([9.0, 9.0, 1.5, 1e6]));
        assert_eq!(write(&["integrity"]), None);
    }
}
