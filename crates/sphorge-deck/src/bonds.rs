//! Bodies that end near a symmetry plane, but not at it: sums take their images for a part of them; and planes at which none ends.

use crate::placement::millimetres;
use sphorge_engine::Particles;
use sphorge_engine::model::Model;

/// Deviation from half a spacing up to which a first layer stands at the plane, in spacings.
const AT_PLANE: f64 = 0.02;

/// Gap between a body and a plane of symmetry up to which a particle and its image are neighbours, m.
pub(crate) fn reach(model: &Model, body: usize) -> f64 {
    let body = &model.bodies[body];
    // They stand half a spacing and the gap from the plane on both sides.
    0.5 * (model.numerics.kernel.support() * body.smoothing_length - body.spacing)
}

/// One sentence for each body and symmetry plane with a gap between them that sums reach across; not of those (index of the body, of the plane)
/// that another note is about. And one for each plane that no body ends at, or moves to or from along its normal: bodies are whole there that were meant as halves.
pub(crate) fn notes(model: &Model, particles: &Particles, is_known: impl Fn(usize, usize) -> bool) -> Vec<String> {
    let mut notes = Vec::new();
    for (number, plane) in model.symmetry.iter().enumerate() {
        let mut nearest = vec![f64::INFINITY; model.bodies.len()];
        let mut stays = model.gravity[plane.axis] == 0.0 && model.motions.is_empty();
        for ((x, v), &body) in particles.position.iter().zip(&particles.velocity).zip(&particles.body) {
            stays &= v[plane.axis] == 0.0;
            let depth = (x[plane.axis] - plane.position) * plane.side;
            nearest[body as usize] = nearest[body as usize].min(depth);
        }
        let gaps = nearest.iter().enumerate().map(|(k, depth)| (k, depth - 0.5 * model.bodies[k].spacing));
        let closest = gaps.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(k, gap)| stays && *gap >= reach(model, *k));
        if let Some((k, gap)) = closest {
            notes.push(format!(
                "no body ends at the symmetry plane across {axis} at {axis} = {}, and none moves to it: `{}` starts {} from it and is a whole body; if it is meant as half of one, let it end at the plane (`at`)",
                millimetres(plane.position),
                model.bodies[k].name,
                millimetres(gap),
                axis = ["x", "y", "z"][plane.axis],
            ));
        }
        for (k, depth) in nearest.into_iter().enumerate() {
            let (body, reach) = (&model.bodies[k], reach(model, k));
            let gap = depth - 0.5 * body.spacing;
            if gap > AT_PLANE * body.spacing && gap < reach && !is_known(k, number) {
                notes.push(format!(
                    "body `{}` starts {} from the symmetry plane across {} and is bound to its image there, as bodies are up to {} from it: let it end at the plane, or start it farther away",
                    body.name,
                    millimetres(gap),
                    ["x", "y", "z"][plane.axis],
                    millimetres(reach)
                ));
            }
        }
    }
    notes
}

#[cfg(test)]
mod tests {
    use crate::load_text;

    fn notes(gap: &str, changes: &[(&str, &str)]) -> Vec<String> {
        let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"10 us\" }\n\
                    [[body]]\nname = \"a\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, 0], max = [\"6 mm\", \"6 mm\"] }, shift = [\"GAP\", 0] }\n\
                    velocity = [5, 0]\n[[symmetry]]\naxis = \"x\"\n"
            .replace("GAP", gap);
        let changes: Vec<_> = changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        load_text("gap", &deck, &changes).unwrap_or_else(|report| panic!("{report}")).all_notes()
    }

    #[test]
    fn a_body_within_reach_of_its_image_is_bound_to_it() {
        for gap in ["0.0400 mm", "0.2000 mm", "0.5500 mm"] {
            let notes = notes(gap, &[]);
            let text = format!(
                "`a` starts {gap} from the symmetry plane across x and is bound to its image there, as bodies are up to 0.6000 mm"
            );
            assert!(notes.len() == 1 && notes[0].contains(&text), "{gap}: {notes:?}");
        }
        // At the plane it is meant, and it is held back there.
        assert_eq!(notes("0 mm", &[]), [""; 0]);
        // Beyond it is free.
        let free = notes("0.65 mm", &[]);
        assert!(free.len() == 1 && free[0].contains("meets nothing"), "{free:?}");
        // At rest across it, a whole body beside a plane that nothing comes to.
        let whole = [("body.a.velocity", "[0, 5]")];
        let beside = notes("2 mm", &whole);
        let text =
            "no body ends at the symmetry plane across x at x = 0.0000 mm, and none moves to it: `a` starts 2.0000 mm";
        assert!(beside.iter().filter(|note| note.contains(text)).count() == 1, "{beside:?}");
        assert!(!notes("0 mm", &whole).iter().any(|note| note.contains("no body ends")));
        assert!(!notes("2 mm", &[("body.a.velocity", "[-5, 0]")]).iter().any(|note| note.contains("no body ends")));
        // The reach is that of the kernel.
        assert!(notes("0.65 mm", &[("particles.smoothing", "1.3")])[0].contains("up to 0.8000 mm"));
    }
}
