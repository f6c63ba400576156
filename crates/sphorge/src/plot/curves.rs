//! Curves of numbers that no run has written, such as a measure over a key that was varied.

use super::{
    Paper, PlotError,
    chart::{Chart, Curve, page},
};
use std::path::Path;

/// Curves of one quantity over another.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesPicture {
    /// Title of the page.
    pub title: String,
    /// Name and SI unit along the page.
    pub along: (String, String),
    /// Name and SI unit of the upright axis.
    pub quantity: (String, String),
    /// Name and points, SI, of each curve.
    pub curves: Vec<(String, Vec<(f64, f64)>)>,
    /// The same of what is drawn as hollow squares at the points.
    pub points: Vec<(String, Vec<(f64, f64)>)>,
    /// Size and fineness.
    pub paper: Paper,
}

impl CurvesPicture {
    /// Draws them to a PNG or SVG file.
    ///
    /// # Errors
    /// [`PlotError::Empty`] if there is no point, otherwise as [`super::plot_history`].
    pub fn save(&self, to: &Path) -> Result<(), PlotError> {
        let curve = |marked: bool| {
            move |(name, points): &(String, Vec<(f64, f64)>)| Curve {
                name: name.clone(),
                points: points.clone(),
                marked,
            }
        };
        let chart = Chart {
            along: self.along.clone(),
            quantity: self.quantity.0.clone(),
            unit: self.quantity.1.clone(),
            curves: self.curves.iter().map(curve(false)).chain(self.points.iter().map(curve(true))).collect(),
            limits: None,
            walls: Vec::new(),
        };
        if !chart.has_values() {
            return Err(PlotError::Empty { reason: format!("`{}` has no values", self.quantity.0) });
        }
        page(&[chart], 1, &self.title, None, self.paper)?.save(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_drawn_and_none_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let picture = |points: &[(f64, f64)]| CurvesPicture {
            title: "A sweep".into(),
            along: ("spacing".into(), "m".into()),
            quantity: ("height".into(), "m".into()),
            curves: vec![("search = skin".into(), points.to_vec())],
            points: Vec::new(),
            paper: Paper::default(),
        };
        let to = folder.path().join("new/height.svg");
        picture(&[(1e-3, 0.02), (2e-3, 0.021)]).save(&to).unwrap();
        let text = std::fs::read_to_string(&to).unwrap();
        assert!(text.contains("<svg") && text.contains("</svg>"));
        let empty = picture(&[]).save(&folder.path().join("none.svg"));
        assert!(matches!(empty, Err(PlotError::Empty { .. })));
    }
}
