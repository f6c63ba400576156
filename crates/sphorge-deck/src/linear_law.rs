//! Shocks in bodies whose pressure law is made for small changes of density.

use crate::impacts::{Impact, each_impact};
use sphorge_engine::model::Model;
use sphorge_physics::eos::EquationOfState;

/// Share of the pressure that is missing from which on the linear law is told to be wrong.
const MISSING: f64 = 0.087;
/// Speed over that of sound from which on no law holds, which is told of the body.
const FASTEST: f64 = 10.0;
/// Speed of sound below which a material is none that shocks are of interest in, or has a slip that is told, m/s.
const SLOW: f64 = 500.0;
/// Slopes `S` of `Us = c_0 + S Up`: of metals, and about that of the linear law, whose shocks run at `c_0 sqrt(rho/rho_0)`.
const OF_METALS: f64 = 1.5;
const OF_LINEAR: f64 = 0.5;

/// What meets: density (kg/m^3) and sound speed (m/s) at rest, and whether its pressure law is the linear one.
#[derive(Clone, Copy)]
struct Side {
    density: f64,
    sound: f64,
    is_linear: bool,
}

impl Side {
    /// Pressure of a shock with this velocity behind it, Pa, with the slope of the law of the side or of metals.
    fn pressure(self, behind: f64, as_metal: bool) -> f64 {
        let slope = if self.is_linear && !as_metal { OF_LINEAR } else { OF_METALS };
        self.density * behind * (self.sound + slope * behind)
    }
}

/// Pressure between two that meet at a speed, Pa: that at which both velocities behind the shocks add up to it. Something rigid stops all of it.
fn pressure(own: Side, other: Option<Side>, speed: f64, as_metal: bool) -> f64 {
    let Some(other) = other else { return own.pressure(speed, as_metal) };
    let (mut low, mut high) = (0.0, speed);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if own.pressure(middle, as_metal) < other.pressure(speed - middle, as_metal) {
            low = middle
        } else {
            high = middle
        }
    }
    own.pressure(low, as_metal)
}

/// The impact of a body of the linear law that misses most.
#[derive(Clone, Copy)]
struct Found {
    body: usize,
    other: Option<usize>,
    /// m/s.
    speed: f64,
    /// Share of the pressure.
    missing: f64,
}

/// A note for each material that is hit too hard for it, on the impact that misses most.
pub(crate) fn notes(model: &Model) -> Vec<String> {
    let side = |body: usize| {
        let material = &model.materials[model.bodies[body].material];
        let law = &material.equation_of_state;
        let sound = law.reference_sound_speed();
        Side { density: material.density, sound, is_linear: matches!(law, EquationOfState::Linear(_)) && sound > SLOW }
    };
    let mut worst: Vec<Option<Found>> = vec![None; model.materials.len()];
    each_impact(model, &mut |Impact { body, other, normal, .. }| {
        let (own, against) = (side(body), other.map(side));
        let missing = 1.0 - pressure(own, against, normal, false) / pressure(own, against, normal, true);
        let slower = against.map_or(own.sound, |other| other.sound.min(own.sound));
        let linear = [Some(body), other].into_iter().flatten().find(|body| side(*body).is_linear);
        if let Some(linear) = linear.filter(|_| missing > MISSING && normal < FASTEST * slower) {
            let known = &mut worst[model.bodies[linear].material];
            if known.is_none_or(|known| missing > known.missing) {
                let other = if linear == body { other } else { Some(body) };
                *known = Some(Found { body: linear, other, speed: normal, missing });
            }
        }
    });
    let told = worst.into_iter().flatten().map(|Found { body, other, speed, missing }| {
        let what = other.map_or("what it strikes".to_owned(), |other| format!("`{}`", model.bodies[other].name));
        let (body, sound) = (&model.bodies[body], side(body).sound);
        format!(
            "body `{}` meets {what} at {speed:.0} m/s, and the pressure law of its material `{}` is linear: it does not stiffen in shocks, so that \
             the pressure there is about {:.0} % too low; give the material `equation-of-state = {{ mie-gruneisen = {{ sound-speed = \"{sound:.0} m/s\", \
             shock-slope = ..., gruneisen = ... }} }}` with its own constants: steel has 1.49 and 2.0",
            body.name,
            model.materials[body.material].name,
            100.0 * missing
        )
    });
    told.collect()
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
            told.len() == 1 && told[0].contains("`bar` meets what it strikes") && told[0].contains("about 9 % too low"),
            "{told:?}"
        );
        assert!(notes("-880", LINEAR, BLOCK).is_empty());
        let told = notes("-940", LINEAR, BLOCK);
        assert!(told.len() == 1 && told[0].contains("`bar` meets `block` at 940 m/s"), "{told:?}");
        // By exact relations steel of the linear law on aluminium of its own shocks is 4.0 % off at 2 km/s.
        let aluminium = "[material.al]\nbase = \"2024-t351-aluminium\"\n";
        let on_aluminium = BLOCK.replace("material = \"m\"", "material = \"al\"");
        assert!(notes("-2000", LINEAR, &format!("{on_aluminium}{aluminium}")).is_empty());
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
