//! A simulation that is saved and loaded goes on as if nothing had happened, to the last bit.

mod resumed;
mod spoiled;

use super::setup::simulation;
use sphorge::{
    engine::{
        Column, FieldSource, Simulation,
        persist::{Archive, ArchiveError},
    },
    particles::FIELDS,
};
use std::collections::BTreeMap;

/// A block that hits the end of a bar, yields and turns; the other end of the bar stays alone.
const STRIKE: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
time = { end = "20 us" }

[numerics]
viscosity = { alpha = 1.0, beta = 2.0 }
xsph = 0.3

[material.iron]
base = "armco-iron"
conductivity = "80 kW/(m K)"

[[body]]
name = "bar"
material = "iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["36 mm", "5 mm"] } }
velocity = ["0 m/s", "0 m/s"]

[[body]]
name = "hammer"
material = "iron"
temperature = "80 degC"
shape = { box = { min = ["1 mm", "5 mm"], max = ["9 mm", "11 mm"] } }
velocity = ["-60 m/s", "-250 m/s"]
spin = { rate = "2000 rad/s" }
"#;

/// Walls that push and rub while they change their velocity, and a region driven along one axis.
const WALLS: &str = r#"
[[wall]]
name = "lid"
plane = { point = ["0 mm", "11.2 mm"], normal = [0, -1] }
velocity = ["20 m/s", [["0 us", "-350 m/s"], ["1 us", "-300 m/s"], ["9 us", "-200 m/s"]]]
contact = { penalty = { stiffness = 1.0, damping = 0.3, friction = 0.25 } }

[[wall]]
name = "side"
plane = { point = ["-0.2 mm", "0 mm"], normal = [1, 0] }
velocity = [[["0 us", "50 m/s"], ["5 us", "200 m/s"]], "0 m/s"]

[[region]]
name = "foot"
shape = { box = { min = ["0 mm", "0 mm"], max = ["36 mm", "2 mm"] } }

[[motion]]
region = "foot"
velocity = [[["0 us", "0 m/s"], ["2 us", "50 m/s"], ["9 us", "-20 m/s"]], "free"]
"#;

const HEAT: &str = r#"
[[region]]
name = "foot"
shape = { box = { min = ["0 mm", "0 mm"], max = ["36 mm", "2 mm"] } }

[thermal]
boundary = [
    { name = "air", convection = { coefficient = "500 W/(m^2 K)", ambient = "500 K" } },
    { name = "floor", region = "foot", hold = "10 degC" },
]
"#;

const GRAVITY: &str = r#"gravity = ["0 m/s^2", "-1e6 m/s^2"]"#;
const SYMMETRY: &str = r#"symmetry = [{ axis = "x" }, { axis = "y" }]"#;
/// So long that the end of the bar away from the hammer is away from its images, too.
const PERIODIC: &str = r#"periodic = { x = ["0 mm", "60 mm"] }"#;
const LONG: (&str, &str) = ("body.0.shape.box.max", r#"["60 mm", "5 mm"]"#);
const PENALTY: &str = "contact = { penalty = { friction = 0.2 } }";

/// Changes of a deck: paths and values.
type Changes<'a> = &'a [(&'a str, &'a str)];

/// What a deck can have beside its strategy.
#[derive(Clone, Copy, Debug)]
struct Feature {
    name: &'static str,
    /// Text before [`STRIKE`], and behind it.
    before: &'static str,
    behind: &'static str,
    changes: Changes<'static>,
}

impl Feature {
    const fn new(name: &'static str, before: &'static str, behind: &'static str, changes: Changes<'static>) -> Self {
        Self { name, before, behind, changes }
    }

    fn deck(&self) -> String {
        format!("{}\n{STRIKE}{}", self.before, self.behind)
    }
}

const MLS: (&str, &str) = ("numerics.mls-interval", "7");

const FEATURES: &[Feature] = &[
    Feature::new("plain", "", "", &[]),
    Feature::new("walls", GRAVITY, WALLS, &[]),
    Feature::new("penalty", PENALTY, "", &[]),
    Feature::new("conduction", "", HEAT, &[]),
    // The flow of heat is summed anew every fifty steps.
    Feature::new("slow conduction", "", HEAT, &[("material.iron.conductivity", "80 W/(m K)")]),
    Feature::new("penalty and heat", PENALTY, HEAT, &[MLS]),
    Feature::new("symmetry", SYMMETRY, HEAT, &[MLS, ("numerics.artificial-stress", "true")]),
    Feature::new("periodic", PERIODIC, HEAT, &[LONG, MLS]),
    Feature::new("penalty across a periodic end", PERIODIC, "", &[LONG, ("contact", "penalty")]),
    Feature::new("follow-density", "", "", &[("numerics.smoothing-length", "follow-density")]),
    // Both bodies break where they meet.
    Feature::new(
        "damage",
        "",
        "",
        &[
            ("material.iron.damage", "{ johnson-cook = { D1 = 0.002, D2 = 0.02, D3 = -1.5 } }"),
            ("material.iron.fracture-energy", "\"1 kJ/m^2\""),
        ],
    ),
    Feature::new("corrected", "", "", &[("numerics.gradient-correction", "linear")]),
    // Several times as far as the kernel reaches.
    Feature::new(
        "flight",
        "",
        "",
        &[
            ("body.bar.velocity", r#"["3000 m/s", "-900 m/s"]"#),
            ("body.hammer.velocity", r#"["2940 m/s", "-1150 m/s"]"#),
        ],
    ),
];

const EVERY_STEP: &str = "every-step";
const SKIN: &str = "{ skin = { fraction = 0.1 } }";
const GUARDED: &str = "{ adaptive = { plastic-strain-threshold = 1e-5, strain-bound = 5e-4 } }";
const ACCUMULATING: &str = "{ adaptive = { plastic-strain-threshold = 1e-4, accumulate = true } }";
const PUBLISHED: &str = "{ adaptive = { plastic-strain-threshold = 1e-5, guard = \"none\" } }";
const LAGRANGIAN: &str = "total-lagrangian";
const FROZEN: &str = "{ total-lagrangian = { form = \"frozen\" } }";

const SEARCHES: [&str; 7] = [EVERY_STEP, SKIN, GUARDED, ACCUMULATING, PUBLISHED, LAGRANGIAN, FROZEN];

/// Values by name.
type Values = BTreeMap<String, Vec<u8>>;

/// Takes every value.
#[derive(Default)]
struct Saving(Values);

impl Archive for Saving {
    fn is_saving(&self) -> bool {
        true
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        assert!(self.0.insert(name.to_owned(), bytes).is_none(), "`{name}` is saved twice");
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        Err(ArchiveError::Missing(name.to_owned()))
    }
}

/// Gives values as a rule says.
struct Loading<F>(F);

impl<F: FnMut(&str) -> Option<Vec<u8>>> Archive for Loading<F> {
    fn is_saving(&self) -> bool {
        false
    }
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.0(name).ok_or_else(|| ArchiveError::Missing(name.to_owned()))
    }
}

fn values_of(simulation: &mut Simulation) -> Values {
    let mut saving = Saving::default();
    simulation.persist(&mut saving).unwrap();
    saving.0
}

/// All that can be asked of a simulation, to the bit, and all that it saves.
struct Picture {
    /// Fields by `id`.
    fields: BTreeMap<&'static str, Vec<u64>>,
    /// Time, steps, neighbours, ledger: numbers are printed with all the digits that tell them apart.
    account: String,
    saved: Values,
}

impl Picture {
    fn of(simulation: &mut Simulation) -> Self {
        let bits = |column: &Column<'_>| {
            let width = column.kind().width();
            (0..column.len() * width).map(|k| column.component(k / width, k % width).to_bits()).collect()
        };
        // A model without a law that has such a history has no such field.
        let fields = FIELDS.iter().filter_map(|f| simulation.read(f.name).ok().map(|column| (f.name, bits(&column))));
        let fields = fields.collect();
        let ledger = simulation.ledger().unwrap();
        let neighbors = simulation.mean_neighbors();
        let account = format!("{:?} {} {neighbors:?} {ledger:?}", simulation.time(), simulation.steps());
        let mut saved = values_of(simulation);
        saved.retain(|name, _| !name.starts_with("seconds"));
        Self { fields, account, saved }
    }

    /// Names of what can be asked and differs.
    fn visible_differences(&self, other: &Self) -> Vec<String> {
        let fields = self.fields.iter().filter(|(name, bits)| other.fields.get(*name) != Some(bits));
        let mut differing: Vec<String> = fields.map(|(name, _)| (*name).to_owned()).collect();
        if self.account != other.account {
            differing.push(format!("account {} and {}", self.account, other.account));
        }
        differing
    }

    /// Names of everything that differs.
    fn differences(&self, other: &Self) -> Vec<String> {
        assert_eq!(self.fields.len(), other.fields.len());
        assert!(self.saved.keys().eq(other.saved.keys()));
        let saved = self.saved.iter().filter(|(name, bytes)| other.saved.get(*name) != Some(bytes));
        let mut differing = self.visible_differences(other);
        differing.extend(saved.map(|(name, _)| name.clone()));
        differing
    }
}

fn start(deck: &str, search: &str, changes: Changes<'_>) -> Simulation {
    simulation(deck, &[&[("search", search)], changes].concat())
}
