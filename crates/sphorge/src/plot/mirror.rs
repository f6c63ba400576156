//! Images of particles in the planes of symmetry of a deck.

use super::{PlotError, cell::Corners};
use crate::model::{Model, SymmetryPlane};

const AXES: [&str; 3] = ["x", "y", "z"];

/// In which planes of symmetry images are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mirror {
    /// Those that halve bodies. A plane towards which a body flies at the start stands for a rigid wall without friction, and is none of them.
    #[default]
    Halving,
    /// Those across these axes.
    Across([bool; 3]),
}

impl std::str::FromStr for Mirror {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut across = [false; 3];
        for name in text.split(',') {
            let axis = AXES.iter().position(|axis| *axis == name.trim());
            *axis.and_then(|axis| across.get_mut(axis)).ok_or("write the axes that planes are across: `x`, `x,y`")? =
                true;
        }
        Ok(Self::Across(across))
    }
}

/// The planes of symmetry of a deck in which images are shown if they are, with their numbers: those that are named, else those that halve bodies.
///
/// # Errors
/// [`PlotError::Mirror`] where the deck has none of the kind that is asked for.
pub(crate) fn mirrored(model: Option<&Model>, asked: Option<Mirror>) -> Result<Vec<(usize, SymmetryPlane)>, PlotError> {
    let all = model.map_or(&[][..], |model| &model.symmetry[..]);
    let there = || {
        let names = AXES.iter().enumerate().filter(|(axis, _)| all.iter().any(|plane| plane.axis == *axis));
        names.map(|(_, name)| *name).collect::<Vec<_>>().join(",")
    };
    let is_wall = |plane: &SymmetryPlane| model.is_some_and(|model| is_hit(model, plane));
    let is_chosen = |plane: &SymmetryPlane| match asked.unwrap_or_default() {
        Mirror::Halving => !is_wall(plane),
        Mirror::Across(axes) => axes[plane.axis],
    };
    let refused = |reason: String| Err(PlotError::Mirror { reason });
    match asked {
        Some(_) if all.is_empty() => return refused("the deck has no plane of symmetry".to_owned()),
        Some(Mirror::Halving) if all.iter().all(is_wall) => {
            let axes = there();
            return refused(format!(
                "no plane of symmetry halves a body: bodies fly towards those across {axes}, which stand for walls; `--mirror={axes}` names them"
            ));
        }
        Some(Mirror::Across(axes)) => {
            let lacks = |axis: &usize| axes[*axis] && all.iter().all(|plane| plane.axis != *axis);
            if let Some(axis) = (0..3).find(lacks) {
                let (axis, there) = (AXES[axis], there());
                return refused(format!("the deck has no plane of symmetry across {axis}, but across {there}"));
            }
        }
        Some(Mirror::Halving) | None => {}
    }
    Ok(all.iter().copied().enumerate().filter(|(_, plane)| is_chosen(plane)).collect())
}

/// Whether a body flies towards a plane at the start.
fn is_hit(model: &Model, plane: &SymmetryPlane) -> bool {
    model.bodies.iter().any(|body| plane.side * body.velocity[plane.axis] < 0.0)
}

/// A particle of a frame, m, with the value it is coloured by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) position: [f64; 3],
    pub(super) value: f64,
    pub(super) spacing: f64,
    pub(super) body: u16,
    /// Corners of the deformed cell from the particle, m.
    pub(super) cell: Option<Corners<f32>>,
}

/// Adds the images of all particles in a plane. `component` names the axes of the component that is shown, as in `xy`: a
/// component changes its sign with every one that is normal to the plane.
pub(super) fn mirror(samples: &mut Vec<Sample>, plane: &SymmetryPlane, component: &str) {
    let axis = ['x', 'y', 'z'].get(plane.axis).copied().unwrap_or('x');
    let turned = component.to_lowercase().matches(axis).count() % 2 == 1;
    let images: Vec<_> = samples
        .iter()
        .map(|sample| {
            let mut image = *sample;
            image.position[plane.axis] = 2.0 * plane.position - sample.position[plane.axis];
            for corner in image.cell.iter_mut().flatten() {
                corner[plane.axis] = -corner[plane.axis];
            }
            image.value = if turned { -sample.value } else { sample.value };
            image
        })
        .collect();
    samples.extend(images);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_stand_behind_the_plane_with_the_sign_of_their_component() {
        let plane = SymmetryPlane { axis: 1, position: 2.0, side: 1.0 };
        for (component, sign) in [("", 1.0), ("x", 1.0), ("y", -1.0), ("XY", -1.0), ("yy", 1.0), ("xz", 1.0)] {
            let sample = |y: f64, value: f64, corner: f32| Sample {
                position: [5.0, y, 7.0],
                value,
                spacing: 1.0,
                body: 2,
                cell: Some([[0.5, corner, 0.25]; 8]),
            };
            let mut samples = vec![sample(3.0, 4.0, 0.75)];
            mirror(&mut samples, &plane, component);
            assert_eq!(samples[1], sample(1.0, 4.0 * sign, -0.75));
        }
    }

    fn planes(asked: Option<Mirror>, symmetry: &[&str], velocity: &str) -> Result<Vec<usize>, String> {
        let list: Vec<_> = symmetry.iter().map(|axis| format!("{{ axis = \"{axis}\" }}")).collect();
        let deck = format!(
            "dimensions = \"3d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\nsymmetry = [{}]\n[[body]]\nname = \"b\"\n\
             material = \"armco-iron\"\nshape = {{ box = {{ min = [0, 0, 0], max = [\"2 mm\", \"2 mm\", \"4 mm\"] }} }}\nvelocity = {velocity}\n",
            list.join(", ")
        );
        let model = crate::deck::load_text("halves", &deck, &[]).unwrap().model;
        let found = mirrored(Some(&model), asked).map_err(|error| error.to_string())?;
        assert!(found.iter().all(|(number, plane)| model.symmetry[*number] == *plane));
        Ok(found.into_iter().map(|(_, plane)| plane.axis).collect())
    }

    #[test]
    fn a_plane_that_a_body_hits_stands_for_a_wall_unless_it_is_named() {
        let (all, hits) = (&["x", "y", "z"][..], "[0, 0, -100]");
        for asked in [None, Some(Mirror::Halving)] {
            assert_eq!(planes(asked, all, hits), Ok(vec![0, 1]));
            // Away from it, it halves what is pulled.
            assert_eq!(planes(asked, all, "[0, 0, 100]"), Ok(vec![0, 1, 2]));
        }
        assert_eq!(planes("x, z".parse().ok(), all, hits), Ok(vec![0, 2]));
        assert_eq!(planes(None, &["z"], hits), Ok(vec![]));
        let refused = |asked: &str, symmetry: &[&str]| planes(asked.parse().ok(), symmetry, hits).unwrap_err();
        assert!(refused("y", &["x", "z"]).ends_with("no plane of symmetry across y, but across x,z"));
        let alone = planes(Some(Mirror::Halving), &["z"], hits).unwrap_err();
        assert!(alone.ends_with("which stand for walls; `--mirror=z` names them"), "{alone}");
        assert!(["", "w", "x y", "x,"].iter().all(|bad| bad.parse::<Mirror>().is_err()));
    }
}
