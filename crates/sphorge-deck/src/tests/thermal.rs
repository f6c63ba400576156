//! Contact between bodies and heat: what is read, what is refused.

use super::super::*;
use super::changed;
use sphorge_engine::model::*;

const BOUNDARIES: &str = r#"
[thermal]
mechanics = false

[[thermal.boundary]]
name = "air"
convection = { coefficient = "50 W/(m^2 K)", ambient = "20 degC" }

[[thermal.boundary]]
name = "lamp"
body = "bar"
flux = "2 kW/m^2"

[[thermal.boundary]]
name = "foot"
region = "low"
hold = 300

[[region]]
name = "low"
shape = { box = { min = ["-4 mm", "0 mm"], max = ["4 mm", "1 mm"] } }
"#;

#[test]
fn contact_and_heat_are_read() {
    let deck = changed("search =", "contact = { penalty = { friction = 0.2 } }\nsearch =") + BOUNDARIES;
    let model = load_text("deck", &deck, &[]).unwrap().model;
    let BodyContact::Penalty(strength) = model.contact else { panic!("{:?}", model.contact) };
    assert_eq!((strength.stiffness, strength.damping, strength.friction), (1.0, 0.3, 0.2));
    assert!(model.thermal.conduction && !model.thermal.mechanics);
    let kinds: Vec<_> = model.thermal.boundaries.iter().map(|b| (b.name.as_str(), b.body, b.region, b.kind)).collect();
    assert_eq!(
        kinds,
        [
            ("air", None, None, HeatBoundaryKind::Convection { coefficient: 50.0, ambient: 293.15 }),
            ("lamp", Some(0), None, HeatBoundaryKind::Flux(2000.0)),
            ("foot", None, Some(0), HeatBoundaryKind::HeldTemperature(300.0)),
        ]
    );
    let plain = load_text("deck", &changed("smoothing = 1.2", "smoothing = 1.20"), &[]);
    assert!(plain.is_ok_and(|s| s.model.contact == BodyContact::Sph && s.model.thermal == Thermal::default()));
}

/// Code and text of the first fault of a deck.
#[track_caller]
fn refused(deck: &str) -> (String, String) {
    let Err(report) = load_text("deck", deck, &[]) else { panic!("no fault is found") };
    let problem = &report.problems()[0];
    (problem.code().to_owned(), format!("{problem} {}", problem.help().unwrap_or_default()))
}

#[test]
fn faults_of_contact_and_heat_are_told() {
    let deck = changed("smoothing = 1.2", "smoothing = 1.20");
    let with = |more: &str| refused(&format!("{deck}{more}"));
    for (more, code, words) in [
        ("[contact]\npenalty = { friction = -1 }", "out-of-range", "zero or above"),
        ("[contact]\npenalty = { damping = 2 }", "out-of-range", "between 0 and 1"),
        ("[contact]\n", "exactly-one", "a contact needs `penalty`"),
        ("[[thermal.boundary]]\nname = \"a\"", "exactly-one", "a heat boundary needs one of `hold`"),
        ("[[thermal.boundary]]\nname = \"a\"\nhold = 300\nflux = 3", "exactly-one", "only one of `hold`"),
        (
            "[[thermal.boundary]]\nname = \"a\"\nhold = 300\nnormal = [0, 1]",
            "conflict",
            "keeps particles at a temperature, not faces",
        ),
        (
            "[[thermal.boundary]]\nname = \"a\"\nflux = 3\nnormal = [0, 0]",
            "out-of-range",
            "the normal has no direction",
        ),
        ("[[thermal.boundary]]\nname = \"a\"\nhold = \"-300 degC\"", "out-of-range", "absolute zero or above"),
        ("[[thermal.boundary]]\nname = \"a\"\nflux = \"3 W/m\"", "wrong-quantity", "heat flux"),
        ("[[thermal.boundary]]\nname = \"a\"\nbody = \"car\"\nflux = 3", "unknown-name", "`bar`"),
        ("[thermal]\nconduction = false\nmechanics = false", "conflict", "no heat flows"),
        (
            "[[thermal.boundary]]\nname = \"a\"\nflux = 3\n[[thermal.boundary]]\nname = \"a\"\nflux = 4",
            "duplicate-name",
            "two heat boundaries",
        ),
    ] {
        let (found, text) = with(more);
        assert_eq!(found, code, "{more}: {text}");
        assert!(text.contains(words), "{more}: {text}");
    }
    // What conducts needs a capacity, and bodies that stand still need to conduct.
    let mine = |constants: &str| {
        format!(
            "{}[material.mine]\ndensity = 1000\nyoung-modulus = 1e9\npoisson-ratio = 0.3\nstrength = \"elastic\"\n{constants}\n",
            changed("\"armco-iron\"", "\"mine\"")
        )
    };
    let (code, text) = refused(&(mine("") + "[thermal]\n"));
    assert!(code == "missing-constant" && text.contains("`specific-heat`, and conduction needs it"), "{text}");
    let (code, text) = refused(&(mine("specific-heat = 500") + "[thermal]\nmechanics = false\n"));
    assert!(code == "missing-constant" && text.contains("no material conducts"), "{text}");
}

/// A block of 20 by 10 cells with a region of one layer at its left end.
fn block(boundary: &str, law: &str, mechanics: bool) -> String {
    format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"5 mm\" }}\ntime = {{ end = \"1 s\" }}\nthermal = {{ mechanics = {mechanics}, \
         boundary = [{{ name = \"hot\", flux = \"10 kW/m^2\", {boundary} }}] }}\nregion = [{{ name = \"end\", shape = {{ box = {{ min = [-1, -1], \
         max = [\"5 mm\", 1] }} }} }}, {{ name = \"middle\", shape = {{ box = {{ min = [\"20 mm\", \"20 mm\"], max = [\"40 mm\", \"30 mm\"] }} }} }}]\n\
         [material.m]\ndensity = 1000\npoisson-ratio = 0.3\nspecific-heat = 500\nconductivity = 300\nstrength = \"elastic\"\n{law}\n[[body]]\nname = \
         \"block\"\nmaterial = \"m\"\nshape = {{ box = {{ min = [0, 0], max = [\"100 mm\", \"50 mm\"] }} }}\n"
    )
}

const LINEAR: &str = "young-modulus = 200e9";

/// Without those on the regions that a deck does not use.
fn notes(deck: &str) -> Vec<String> {
    let notes = load_text("block", deck, &[]).unwrap_or_else(|report| panic!("{report}")).notes;
    notes.into_iter().filter(|note| !note.contains("names region")).collect()
}

#[test]
fn what_the_side_faces_of_a_region_take_is_told() {
    let told = notes(&block("region = \"end\"", LINEAR, false));
    assert!(
        told.len() == 1
            && told[0].contains("of region `end`: 50.0000 mm towards -x, 5.0000 mm towards -y, 5.0000 mm towards +y")
            && told[0].contains("`normal = [-1, 0]`"),
        "{told:?}"
    );
    for named in ["region = \"end\", normal = [-1, 0]", "body = \"block\""] {
        assert_eq!(notes(&block(named, LINEAR, false)), [""; 0], "{named}");
    }
}

#[test]
fn a_boundary_that_names_no_face_is_refused() {
    for nothing in ["region = \"end\", normal = [1, 0]", "region = \"middle\", normal = [-1, 0]"] {
        let (code, text) = refused(&block(nothing, LINEAR, false));
        assert!(code == "no-face" && text.contains("looks along its `normal`"), "{code} {text}");
    }
}

#[test]
fn heat_that_does_not_expand_is_told() {
    let named = "body = \"block\"";
    let told = notes(&block(named, LINEAR, true));
    // K = 200e9/(3 (1 - 0.6)) = 166.67 GPa: 3 K/(1000 500) = 1e6 K.
    assert!(
        told.len() == 1 && told[0].contains("law `linear`") && told[0].contains("1.0000e6 K times alpha"),
        "{told:?}"
    );
    assert_eq!(notes(&block(named, LINEAR, false)), [""; 0]);
    let gruneisen = "shear-modulus = 8e10\nequation-of-state = { mie-gruneisen = { sound-speed = 12000, shock-slope = 1.5, gruneisen = 2 } }";
    assert!(notes(&block(named, gruneisen, true)).iter().all(|note| !note.contains("expand")));
}

/// Two blocks, of which the first conducts and the second has these constants more.
fn two_blocks(constants: &str, boundaries: &str) -> Vec<String> {
    let block = |name: &str, low: u32, high: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"{name}\"\nvelocity = [1, 0]\nshape = {{ box = {{ min = [\"{low} mm\", 0], max = [\"{high} mm\", \
             \"50 mm\"] }} }}\n[material.{name}]\ndensity = 1000\nyoung-modulus = 200e9\npoisson-ratio = 0.3\nspecific-heat = 500\nstrength = \
             \"elastic\"\n"
        )
    };
    let deck = format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"5 mm\" }}\ntime = {{ end = \"1 ms\" }}\n[thermal]\n{boundaries}{}conductivity = \
         80\n{}{constants}\n",
        block("copper", 0, 50),
        block("wool", 60, 110)
    );
    notes(&deck).into_iter().filter(|note| note.contains("conductivity")).collect()
}

#[test]
fn a_material_that_heat_does_not_enter_is_told() {
    let air = |of: &str| {
        format!("[[thermal.boundary]]\nname = \"air\"\n{of}convection = {{ coefficient = 500, ambient = 300 }}\n")
    };
    let (all, copper, wool) = (air(""), air("body = \"copper\"\n"), air("body = \"wool\"\n"));
    for (boundaries, words) in [
        ("", "`wool` has no `conductivity`: no heat flows between its particles"),
        (copper.as_str(), "`wool` has no `conductivity`: no heat flows between its particles"),
        (all.as_str(), "`wool` has no `conductivity`: no heat flows into its bodies through heat boundary `air`;"),
        (wool.as_str(), "`wool` has no `conductivity`: no heat flows into its bodies through heat boundary `air`;"),
    ] {
        let told = two_blocks("", boundaries);
        assert!(told.len() == 1 && told[0].contains(words), "{boundaries}: {told:?}");
        assert_eq!(two_blocks("conductivity = 0.04", boundaries), [""; 0], "{boundaries}");
        // One that is stated is meant, but not where a boundary is to heat it.
        let told = two_blocks("conductivity = 0", boundaries);
        assert_eq!(told.len(), usize::from(boundaries == wool), "{boundaries}: {told:?}");
        assert!(told.iter().all(|note| note.contains("has a `conductivity` of zero: no heat flows into")), "{told:?}");
    }
}

#[test]
fn spacings_that_may_be_in_millimetres_are_told() {
    let notes = |spacing: &str| {
        let deck = format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = {spacing} }}\ntime = {{ end = 1, max-steps = 1 }}\n[[body]]\nname = \"b\"\n\
             material = \"ofhc-copper\"\nvelocity = [1, 0]\nshape = {{ box = {{ min = [0, 0], max = [6, 6] }} }}\n"
        );
        load_text("deck", &deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).notes.join("\n")
    };
    for spacing in ["1", "\"1\"", "0.5"] {
        let told = notes(spacing);
        let (number, rest) = (spacing.trim_matches('"'), "m, since a number without a unit is in SI");
        let words = format!("line 2: `spacing = {spacing}` is {number} {rest}");
        assert!(told.contains(&words) && told.contains(&format!("write \"{number} mm\"")), "{told}");
    }
    assert!(!notes("\"1 m\"").contains("since a number"), "{}", notes("\"1 m\""));
}

#[test]
fn temperatures_that_may_be_in_degrees_celsius_are_told() {
    let deck = |body: &str, ambient: &str, constants: &str| {
        format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"5 mm\" }}\ntime = {{ end = \"1 ms\" }}\nwarnings = {{ cold = 100 }}\n\
             [[thermal.boundary]]\nname = \"air\"\nconvection = {{ coefficient = 500, ambient = {ambient} }}\n[[body]]\nname = \"bar\"\nmaterial \
             = \"ofhc-copper\"\ntemperature={body}\nvelocity = [1, 0]\nshape = {{ box = {{ min = [0, 0], max = [\"50 mm\", \"50 mm\"] }} \
             }}\n[material.ofhc-copper]\n{constants}\n"
        )
    };
    let told = |deck: &str| -> Vec<String> {
        notes(deck).into_iter().filter(|note| note.contains("since a number without a unit is in SI")).collect()
    };
    let celsius = told(&deck("20", "\"0\"", "strength = { johnson-cook = { reference-temperature = 25.0 } }"));
    let words = [
        "line 7: `ambient = \"0\"` is 0 K, ",
        "line 11: `temperature=20` is 20 K, since a number without a unit is in SI: write \"20 degC\" or \"20 K\"",
        "line 15: `reference-temperature = 25.0` is 25 K, ",
    ];
    assert_eq!(celsius.len(), words.len(), "{celsius:?}");
    assert!(celsius.iter().zip(words).all(|(note, words)| note.starts_with(words)), "{celsius:?}");
    for (body, ambient) in [("293", "300.0"), ("\"20 degC\"", "\"20 K\""), ("150", "\"150\"")] {
        assert_eq!(told(&deck(body, ambient, "")), [""; 0], "{body} {ambient}");
    }
}
