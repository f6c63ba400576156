//! Shocks in bodies whose pressure law is made for small changes of density.

use crate::impacts::{Impact, each_impact};
use sphorge_engine::model::Model;
use sphorge_physics::eos::EquationOfState;

/// Particle velocity behind a shock over the sound speed from which on the linear law is told to be wrong there.
const STRONG: f64 = 0.1;
/// The same from which on no law holds, which is told of the body.
const FASTEST: f64 = 10.0;
/// Speed of sound below which a material is none that shocks are of interest in, or has a slip that is told, m/s.
const SLOW: f64 = 500.0;
/// Slopes `S` of `Us = c_0 + S Up`: of metals, and about that of the linear law, whose shocks run at `c_0 sqrt(rho/rho_0)`.
const OF_METALS: f64 = 1.5;
const OF_LINEAR: f64 = 0.5;

/// A note for each material that is hit too hard for it.
pub(crate) fn notes(model: &Model) -> Vec<String> {
    let law = |body: usize| &model.materials[model.bodies[body].material].equation_of_state;
    let impedance =
        |body: usize| model.materials[model.bodies[body].material].density * law(body).reference_sound_speed();
    // By material: the body, its speed and that of what is behind the shock over the sound speed.
    let mut hardest: Vec<Option<(usize, f64, f64)>> = vec![None; model.materials.len()];
    each_impact(model, &mut |Impact { body, other, normal, .. }| {
        let mut hit = |body: usize, against: Option<usize>| {
            let share = against.map_or(1.0, |other| impedance(other) / (impedance(body) + impedance(other)));
            let behind = share * normal / law(body).reference_sound_speed();
            let known = &mut hardest[model.bodies[body].material];
            let is_linear = matches!(law(body), EquationOfState::Linear(_)) && law(body).reference_sound_speed() > SLOW;
            if is_linear && known.is_none_or(|(.., most)| behind > most) {
                *known = Some((body, normal, behind));
            }
        };
        hit(body, other);
        other.into_iter().for_each(|other| hit(other, Some(body)));
    });
    let strong = hardest.into_iter().flatten().filter(|(.., behind)| (STRONG..FASTEST).contains(behind));
    strong
        .map(|(body, speed, behind)| {
            let body = &model.bodies[body];
            let missing = 1.0 - (1.0 + OF_LINEAR * behind) / (1.0 + OF_METALS * behind);
            format!(
                "body `{}` meets what it strikes at {speed:.0} m/s, and the pressure law of its material `{}` is linear: it does not stiffen in shocks, so that \
                 their pressures are about {:.0} % too low; give the material a Mie-Gruneisen law, as in `equation-of-state = {{ mie-gruneisen = \
                 {{ sound-speed = \"4570 m/s\", shock-slope = 1.49, gruneisen = 2.0 }} }}` for steel",
                body.name,
                model.materials[body.material].name,
                100.0 * missing
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::{decks, load_text};

    fn notes(speed: &str, law: &str, more: &str) -> Vec<String> {
        let deck = format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"20 us\" }}\n[material.m]\ndensity = \"7850 kg/m^3\"\n\
             shear-modulus = \"80 GPa\"\nequation-of-state = {law}\nstrength = {{ perfectly-plastic = {{ yield-stress = \"0.5 GPa\" }} }}\n\
             [[body]]\nname = \"bar\"\nmaterial = \"m\"\nshape = {{ box = {{ min = [0, 0], max = [\"6 mm\", \"12 mm\"] }} }}\n\
             velocity = [\"0 m/s\", \"{speed} m/s\"]\n{more}"
        );
        let notes = load_text("bar", &deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).all_notes();
        notes.into_iter().filter(|note| note.contains("does not stiffen")).collect()
    }

    const LINEAR: &str = "{ linear = { sound-speed = \"4570 m/s\" } }";
    const WALL: &str = "[[wall]]\nname = \"anvil\"\nplane = { point = [0, 0], normal = [0, 1] }\n";
    const BLOCK: &str = "[[body]]\nname = \"block\"\nmaterial = \"m\"\nshape = { box = { min = [\"-6 mm\", \"-12 mm\"], max = [\"12 mm\", \"0 mm\"] } }\n";

    #[test]
    fn strong_shocks_by_the_linear_law_are_told() {
        // Against a wall all of the speed is behind the shock, against its like half of it.
        assert!(notes("-440", LINEAR, WALL).is_empty());
        let told = notes("-470", LINEAR, WALL);
        // 1 - 1.0514/1.1543.
        assert!(
            told.len() == 1 && told[0].contains("`bar` meets") && told[0].contains("about 9 % too low"),
            "{told:?}"
        );
        assert!(notes("-880", LINEAR, BLOCK).is_empty());
        assert_eq!(notes("-940", LINEAR, BLOCK).len(), 1);
        let hugoniot = "{ mie-gruneisen = { sound-speed = \"4570 m/s\", shock-slope = 1.49, gruneisen = 2.0 } }";
        assert!(notes("-2000", hugoniot, WALL).is_empty());
        // What flies away meets nothing.
        assert!(notes("2000", LINEAR, WALL).is_empty());
    }

    #[test]
    fn shipped_decks_are_not_hit_too_hard_for_it() {
        for deck in decks::DECKS {
            let setup = load_text(deck.name, deck.text, &[]).unwrap();
            assert_eq!(super::notes(&setup.model), [""; 0], "{}", deck.name);
        }
    }
}
