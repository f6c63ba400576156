//! Bars in finite elements: what `reference/finite-elements/taylor_bar.py` found of them.

use super::bar_outline::Line;
use serde::Deserialize;

/// A bar on a rigid wall without friction.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct BarInElements {
    body: String,
    /// m/s
    speed: f64,
    friction: f64,
    /// Whether the wall lets go of the foot.
    lets_go: bool,
    /// Coarse to fine.
    meshes: Vec<Mesh>,
}

/// What one mesh says.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Mesh {
    /// Across the radius and along the bar.
    pub(super) elements: [u32; 2],
    /// Over the first one.
    pub(super) length: f64,
    /// Over the first one.
    pub(super) foot_diameter: f64,
    pub(super) plastic_strain: f64,
    /// K
    pub(super) temperature: f64,
    below_side: Vec<BelowSide>,
    /// Of those meshes alone that were run since the script has it.
    #[serde(default)]
    about_axis: Vec<AboutAxis>,
}

/// The line of material that was so deep below the side at first, at heights from the wall to the top.
#[derive(Clone, Debug, Deserialize)]
struct BelowSide {
    /// As a share of the radius.
    depth: f64,
    height_mm: Vec<f64>,
    radius_mm: Vec<f64>,
}

/// The material that the four particles about the axis at the foot stand for.
#[derive(Clone, Debug, Deserialize)]
struct AboutAxis {
    /// Half a particle, as a share of the radius.
    depth: f64,
    /// Mean over it.
    plastic_strain: f64,
}

impl Mesh {
    /// Length and foot over the first ones, largest strain.
    pub(super) fn numbers(&self) -> [f64; 3] {
        [self.length, self.foot_diameter, self.plastic_strain]
    }

    /// Mean plastic strain of the material of the particles about the axis at the foot, of so many across.
    pub(super) fn strain_about_axis(&self, across: u32) -> Option<f64> {
        let depth = 1.0 / f64::from(across);
        self.about_axis.iter().find(|of| (of.depth / depth - 1.0).abs() < 1e-9).map(|of| of.plastic_strain)
    }

    /// Where the material is, m, in which the outermost of so many particles across are.
    pub(super) fn outermost_ring(&self, across: u32) -> Option<Line> {
        let depth = 1.0 / f64::from(across);
        let line = self.below_side.iter().find(|line| (line.depth / depth - 1.0).abs() < 1e-9)?;
        Some(
            line.height_mm.iter().zip(&line.radius_mm).map(|(height, radius)| [1e-3 * height, 1e-3 * radius]).collect(),
        )
    }
}

impl BarInElements {
    /// The finest mesh, and what the next coarser one deviates from it, as shares of its [`Mesh::numbers`].
    pub(super) fn finest(&self) -> Option<(&Mesh, [f64; 3])> {
        let [.., coarser, finest] = &self.meshes[..] else { return None };
        let (coarse, fine) = (coarser.numbers(), finest.numbers());
        Some((finest, std::array::from_fn(|k| coarse[k] / fine[k] - 1.0)))
    }

    /// Diameter of the foot over the first one that the last two meshes are on their way to, as 1 over the number of elements along the bar.
    pub(super) fn limit_of_foot(&self) -> Option<f64> {
        let [.., coarser, finest] = &self.meshes[..] else { return None };
        let [few, many] = [coarser, finest].map(|mesh| f64::from(mesh.elements[1]));
        Some((many * finest.foot_diameter - few * coarser.foot_diameter) / (many - few))
    }

    /// The finest mesh of elements that are no smaller than so many particles across.
    pub(super) fn as_large_as_particles(&self, across: u32) -> Option<&Mesh> {
        self.meshes.iter().rfind(|mesh| 2 * mesh.elements[0] <= across)
    }
}

/// The bar of this name at this speed, m/s, on a wall that holds its foot or lets it go.
pub(super) fn bar_in_elements(body: &str, speed: f64, lets_go: bool) -> Option<BarInElements> {
    #[derive(Deserialize)]
    struct Written {
        cases: Vec<BarInElements>,
    }
    let text = include_str!("../../../reference/finite-elements/taylor_bar.json");
    // A file of ours: a test reads it.
    let written: Written = serde_json::from_str(text).ok()?;
    let asked = |of: &BarInElements| of.body == body && of.speed == speed && of.lets_go == lets_go;
    written.cases.into_iter().find(|of| asked(of) && of.friction == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_mesh_of_the_wall_that_holds_is_read() {
        let bar = bar_in_elements("copper-bar", 190.0, false).unwrap();
        let (mesh, coarser) = bar.finest().unwrap();
        assert_eq!(mesh.elements, [24, 168]);
        assert!((mesh.length - 0.682_9).abs() < 1e-4 && (mesh.temperature - 521.6).abs() < 0.1);
        assert!((coarser[1] + 0.003_8).abs() < 1e-4);
        // That of the two coarser meshes is the same to three places.
        assert!((bar.limit_of_foot().unwrap() - 1.919_9).abs() < 1e-4);
        // Of 24 particles across, the outermost are within half of one of the foot, at the wall.
        assert!((mesh.outermost_ring(24).unwrap()[0][1] / 3.81e-3 - mesh.foot_diameter + 0.041).abs() < 1e-3);
        assert!(mesh.outermost_ring(23).is_none());
        assert!(bar_in_elements("copper-bar", 191.0, false).is_none());
        let on_wall = bar_in_elements("copper-bar", 190.0, true).unwrap();
        assert_eq!(on_wall.finest().unwrap().0.elements, [24, 168]);
        let as_large = [9, 12, 24].map(|across| on_wall.as_large_as_particles(across).map(|mesh| mesh.elements));
        assert_eq!(as_large, [None, Some([5, 35]), Some([12, 84])]);
    }

    #[test]
    fn the_material_of_a_particle_at_the_axis_has_less_strain_than_the_element_there() {
        let bar = bar_in_elements("copper-bar", 300.0, false).unwrap();
        let [.., coarser, finest] = &bar.meshes[..] else { panic!("two meshes") };
        // It has converged, unlike the largest of an element, and the more is averaged over the less it is.
        assert!(coarser.plastic_strain / finest.plastic_strain < 0.97);
        for (across, most) in [(24, finest.plastic_strain), (12, finest.strain_about_axis(24).unwrap())] {
            let [coarse, fine] = [coarser, finest].map(|mesh| mesh.strain_about_axis(across).unwrap());
            assert!(fine < most && (coarse / fine - 1.0).abs() < 0.005, "{across}: {coarse} {fine}");
        }
        assert!(finest.strain_about_axis(13).is_none());
    }
}
