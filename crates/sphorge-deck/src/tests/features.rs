//! Every part of a deck arrives in the model with its values.

use super::super::*;
use super::{FLAVOUR, changed};
use sphorge_engine::model::*;
use sphorge_physics::{
    hourglass::Counted,
    kernel::Kernel,
    pair::{EnergySplit, PairForm},
    return_mapping::ReturnRule,
};

const THREE: &str = r#"
dimensions = "3d"
gravity = [0, 0, "-9.81 m/s^2"]
search = { skin = { fraction = 0.2 } }

[particles]
spacing = "1 mm"
smoothing = 1.3
placement = "on-faces"

[numerics]
kernel = "wendland-c2"
integrator = "predictor-corrector"
precision = "double"
pair-form = "density-weighted"
gradient-correction = "linear"
viscosity = { alpha = 0.2, beta = 4, balsara = true }
artificial-stress = { epsilon = 0.2, exponent = 6 }
xsph = 0.5
mls-interval = 20
energy-split = "symmetric"
smoothing-length = { follow-density = { factor = 1.5 } }

[time]
end = "2 ms"
courant = 0.2
max-step = "1 us"
fixed-step = "0.5 us"
stop-kinetic-fraction = 0.01
max-steps = 12

[output]
frame-interval = "0.1 ms"
history-interval = "1 us"
fields = ["stress", "speed"]

[material.tube]
base = "steel-fraser"
density = "8 g/cm^3"
return-rule = "benz-asphaug"
strength = { bilinear = { yield-stress = "350 MPa", tangent-modulus = "2 GPa" } }

[[body]]
name = "rod"
material = "tube"
shape = { cylinder = { from = [0, 0, 0], to = [0, 0, "20 mm"], radius = "4 mm" }, shift = ["1 mm", 0, 0] }
temperature = "100 degC"
spacing = "2 mm"
smoothing = 1.4
placement = "cell-centres"

[[body]]
name = "ball"
material = "armco-iron"
shape = { sphere = { centre = [0, 0, "30 mm"], radius = "5 mm" } }

[[region]]
name = "foot"
body = "rod"
shape = { box = { min = ["-9 mm", "-9 mm", 0], max = ["9 mm", "9 mm", "4 mm"] } }

[[motion]]
region = "foot"
velocity = [0, "free", [["0 ms", "0 m/s"], ["5 ms", "1 m/s"]]]

[[wall]]
name = "lid"
plane = { point = [0, 0, "40 mm"], normal = [0, 0, -2] }
velocity = [0, 0, [["0 s", "-1 m/s"], ["1 ms", "0 m/s"]]]
contact = { penalty = { stiffness = 2, damping = 0.3, friction = 0.4 } }

[[symmetry]]
axis = "y"
at = "-20 mm"

[periodic]
x = ["-20 mm", "20 mm"]

[[measure]]
name = "spread"
diameter = { region = "foot", axis = "z" }

[[measure]]
name = "shear"
minimum = { field = "stress", component = "xy", over-time = true, window = { min = [0, 0, 0], max = [1, 1, 2] } }

[[measure]]
name = "front"
front-speed = { field = "pressure", axis = "z", level = "5 GPa", side = "negative", during = ["1 us", "3 us"] }

[[measure]]
name = "probe"
value = { body = "ball", field = "velocity", component = "z", point = [0, 0, "30 mm"] }

[[measure]]
name = "swing"
period = { field = "position", component = "y" }

[[tracer]]
name = "tip"
point = [0, 0, "20 mm"]
body = "rod"

[[tracer]]
name = "gauge"
point = [0, 0, "5 mm"]
fixed = true
fields = ["pressure", "stress"]

[[section]]
name = "middle"
point = [0, 0, "10 mm"]
normal = [0, 3, 4]
body = "rod"

[[measure]]
name = "rebound"
reversal-time = { axis = "z" }
"#;

fn model(text: &str) -> Model {
    match load_text("deck", text, &[]) {
        Ok(setup) => setup.model,
        Err(report) => panic!("{:?}", report.problems()),
    }
}

#[test]
fn the_courant_number_is_that_of_the_form_unless_it_is_given() {
    let courant = |overrides: &[(&str, &str)]| {
        let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let plate = crate::decks::find("iron-plate").unwrap().text;
        load_text("iron-plate", plate, &overrides).unwrap_or_else(|report| panic!("{report}")).model.time.courant
    };
    assert_eq!(courant(&[]), 0.45);
    for method in ["updated-lagrangian", "patino", "fraser"] {
        assert_eq!(courant(&[("method", method)]), 0.3, "{method}");
    }
    // Its own form goes before that of the method.
    assert_eq!(courant(&[("method", "patino"), ("search", "total-lagrangian")]), 0.45);
    assert_eq!(courant(&[("search", "skin")]), 0.3);
    // Gradients that are exact at faces are stiffer there: a foot tears at 0.45.
    let quadratic = ("search", "{ total-lagrangian = { faces = \"quadratic\" } }");
    assert_eq!(courant(&[quadratic]), 0.3);
    assert_eq!(courant(&[("time.courant", "0.2")]), 0.2);
    let water = [
        ("body.bar.material", "\"water\""),
        ("material.water.density", "\"1 g/cm^3\""),
        (
            "material.water.equation-of-state",
            "{ mie-gruneisen = { sound-speed = \"1500 m/s\", shock-slope = 1.9, gruneisen = 0.1 } }",
        ),
        ("material.water.strength", "\"none\""),
    ];
    assert_eq!(courant(&water), 0.3);
    assert_eq!(courant(&[&water[..], &[("time.courant", "0.4")]].concat()), 0.4);
}

/// A flyer and a target as thick as they are high.
const PLATES: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
time = { end = "20 us" }
[[body]]
name = "flyer"
material = "copper-shock"
shape = { box = { min = ["0 mm", "0 mm"], max = ["4 mm", "4 mm"] } }
velocity = ["100 m/s", "0 m/s"]
[[body]]
name = "target"
material = "copper-shock"
shape = { box = { min = ["4 mm", "0 mm"], max = ["8 mm", "4 mm"] } }
"#;

#[test]
fn viscosity_of_shocks_acts_where_bodies_meet_fast_unless_the_deck_gives_viscosity() {
    let shocks = |text: &str, overrides: &[(&str, &str)]| {
        let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        load_text("plates", text, &overrides)
            .unwrap_or_else(|report| panic!("{report:?}"))
            .model
            .numerics
            .viscosity_of_shocks
    };
    let velocity = "body.flyer.velocity";
    // Copper has 3940 m/s: 0.115 and 0.125 of it are 453 and 493 m/s, 0.12 is 473.
    assert_eq!(shocks(PLATES, &[(velocity, "[\"450 m/s\", 0]")]), 0.0);
    assert_eq!(shocks(PLATES, &[(velocity, "[\"500 m/s\", 0]")]), 1.0);
    assert!((shocks(PLATES, &[(velocity, "[\"472.8 m/s\", 0]")]) - 0.5).abs() < 1e-9);
    let fast = (velocity, "[\"0 m/s\", \"1 km/s\"]");
    assert_eq!(shocks(PLATES, &[fast]), 1.0);
    // In any frame.
    let along = ("body.target.velocity", "[\"0 m/s\", \"1 km/s\"]");
    assert_eq!(shocks(PLATES, &[fast, along]), 0.0);
    for given in ["numerics.viscosity.alpha", "numerics.viscosity.beta", "numerics.viscosity.shocks"] {
        assert_eq!(
            shocks(PLATES, &[fast, (given, "0.25")]),
            if given.ends_with("shocks") { 0.25 } else { 0.0 },
            "{given}"
        );
    }
    assert_eq!(shocks(PLATES, &[fast, ("numerics.viscosity", "false")]), 0.0);
    assert_eq!(shocks(PLATES, &[fast, ("numerics.viscosity", "true")]), 1.0);
    assert_eq!(shocks(PLATES, &[fast, ("method", "updated-lagrangian")]), 0.0);
    // What is rigid counts as it is approached: the same velocity along a wall is none.
    let alone = PLATES.split("[[body]]\nname = \"target\"").next().unwrap();
    let wall = "[[wall]]\nname = \"w\"\nplane = { point = [\"-9 mm\", 0], normal = [1, 0] }\n";
    for rest in [wall, "[[symmetry]]\naxis = \"x\"\n"] {
        let deck = format!("{alone}{rest}");
        assert_eq!(shocks(&deck, &[fast]), 0.0, "{rest}");
        assert_eq!(shocks(&deck, &[(velocity, "[\"-1 km/s\", 0]")]), 1.0, "{rest}");
        assert_eq!(shocks(&deck, &[(velocity, "[\"1 km/s\", 0]")]), 0.0, "{rest}");
    }
    let driven = "[[region]]\nname = \"end\"\nshape = { box = { min = [\"0 mm\", \"0 mm\"], max = [\"1 mm\", \"4 mm\"] } }\n\
                  [[motion]]\nregion = \"end\"\nvelocity = [\"1 km/s\", \"0 m/s\"]\n";
    assert_eq!(shocks(&format!("{alone}{driven}"), &[]), 1.0);

    // A clamp that holds a body where it does not move strikes nothing, whatever the rest of it does.
    let swings = "velocity-profile = { along = \"x\", amplitude = [0, \"600 m/s\"], rows = [[\"0 mm\", 0.0], [\"4 mm\", 1.0]] }\n";
    let rests = alone.replace("velocity = [\"100 m/s\", \"0 m/s\"]\n", swings);
    assert_eq!(shocks(&format!("{rests}{}", driven.replace("1 km/s", "0 m/s")), &[]), 0.0);
    // Whoever gives another one is told what it leaves out, and how to say that it is meant.
    let notes = |more: &[(&str, &str)]| {
        let overrides: Vec<_> =
            [&[fast][..], more].concat().iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        load_text("plates", PLATES, &overrides).unwrap().notes
    };
    let told = |notes: &[String]| notes.iter().filter(|note| note.contains("add `shocks = 1`")).count();
    let (alpha, none) = (("numerics.viscosity.alpha", "0.1"), ("numerics.viscosity.shocks", "0"));
    assert_eq!((told(&notes(&[alpha])), told(&notes(&[alpha, none])), told(&notes(&[]))), (1, 0, 0));
    assert_eq!(told(&notes(&[("numerics.viscosity", "false")])), 0);
    assert_eq!(told(&notes(&[("numerics.viscosity", "{ alpha = 0, beta = 0 }")])), 0);
    assert_eq!(told(&notes(&[alpha, (velocity, "[\"100 m/s\", 0]")])), 0);
    // Plates have it from 0.01 and 0.015 of the sound speed on, 39 and 59 m/s: what is twice as wide as thick.
    let slow = (velocity, "[\"100 m/s\", 0]");
    let plates = |text: &str, more: &[(&str, &str)]| shocks(text, &[&[slow][..], more].concat());
    let tall =
        PLATES.replace("\"4 mm\", \"4 mm\"", "\"4 mm\", \"8 mm\"").replace("\"8 mm\", \"4 mm\"", "\"8 mm\", \"8 mm\"");
    assert_eq!((plates(PLATES, &[]), plates(&tall, &[])), (0.0, 1.0));
    // By and by: of 1.75 times as much half of it.
    let between = tall.replace("\"8 mm\"]", "\"7 mm\"]");
    assert!((plates(&between, &[]) - 0.5).abs() < 1e-9);
    assert_eq!(shocks(&tall, &[(velocity, "[\"39 m/s\", 0]")]), 0.0);
    assert!((shocks(&tall, &[(velocity, "[\"49.25 m/s\", 0]")]) - 0.5).abs() < 1e-9);
    // Along the other axis they are thick, and a narrow flyer makes no plane wave.
    assert_eq!(shocks(&tall, &[(velocity, "[0, \"100 m/s\"]")]), 0.0);
    let narrow = PLATES.replace("\"8 mm\", \"4 mm\"", "\"8 mm\", \"40 mm\"");
    assert_eq!(plates(&narrow, &[]), 0.0);
    // Behind one plane of symmetry is the other half; between two, and around a period, there is no end.
    let plane = "[[symmetry]]\naxis = \"y\"\n";
    let other = "[[symmetry]]\naxis = \"y\"\nat = \"4 mm\"\nside = \"negative\"\n";
    assert_eq!(plates(&format!("{PLATES}{plane}"), &[]), 1.0);
    let thick = PLATES
        .replace("\"4 mm\", \"4 mm\"", "\"20 mm\", \"4 mm\"")
        .replace("[\"4 mm\", \"0 mm\"]", "[\"20 mm\", \"0 mm\"]")
        .replace("\"8 mm\", \"4 mm\"", "\"40 mm\", \"4 mm\"");
    assert_eq!(plates(&format!("{thick}{plane}"), &[]), 0.0);
    assert_eq!(plates(&format!("{thick}{plane}{other}"), &[]), 1.0);
    // Beside the velocity along the normal, one along the face changes nothing; nor does what moves away, passes by, or comes after the end.
    assert_eq!(shocks(&tall, &[(velocity, "[\"100 m/s\", \"300 m/s\"]")]), 1.0);
    assert_eq!(shocks(&tall, &[(velocity, "[\"-1 km/s\", 0]")]), 0.0);
    let far = |x: &str, y: &str| {
        format!(
            "{tall}[[body]]\nname = \"far\"\nmaterial = \"copper-shock\"\nvelocity = [\"-1 km/s\", 0]\n\
             shape = {{ box = {{ min = [\"{x}\", \"{y}\"], max = [\"{x} + 2 mm\", \"{y} + 9 mm\"] }} }}\n"
        )
        .replace("30 mm + 2 mm", "32 mm")
        .replace("15 mm + 2 mm", "17 mm")
        .replace("0 mm + 9 mm", "9 mm")
        .replace("12 mm + 9 mm", "21 mm")
    };
    let rest = (velocity, "[0, 0]");
    for (x, y, share) in [("15 mm", "0 mm", 1.0), ("15 mm", "12 mm", 0.0), ("30 mm", "0 mm", 0.0)] {
        assert_eq!(shocks(&far(x, y), &[rest]), share, "{x} {y}");
    }
    // What breaks has it in fast impacts alone.
    assert_eq!(plates(&tall, &[("material.copper-shock.spall-pressure", "\"1 GPa\"")]), 0.0);
    // A wall that a plate strikes flat.
    let alone = tall.split("[[body]]\nname = \"target\"").next().unwrap();
    let wall = "[[wall]]\nname = \"w\"\nplane = { point = [\"5 mm\", 0], normal = [-1, 0] }\n";
    assert_eq!(plates(&format!("{alone}{wall}"), &[]), 1.0);
    let alone = thick.split("[[body]]\nname = \"target\"").next().unwrap();
    let wall = wall.replace("5 mm", "21 mm");
    let period = "[periodic]\ny = [\"0 mm\", \"4 mm\"]\n";
    assert_eq!((plates(&format!("{alone}{wall}"), &[]), plates(&format!("{alone}{wall}{period}"), &[])), (0.0, 1.0));
}

#[test]
fn linear_viscosity_of_all_waves_is_a_choice_of_the_total_lagrangian_form() {
    let given = |method: &str| {
        let overrides =
            [("numerics.viscosity.all-waves".to_owned(), "true".to_owned()), ("method".to_owned(), method.to_owned())];
        load_text("plates", PLATES, &overrides).unwrap_or_else(|report| panic!("{report}"))
    };
    let total = given("total-lagrangian");
    assert!(total.model.numerics.viscosity_of_all_waves);
    let updated = given("updated-lagrangian");
    assert!(!updated.model.numerics.viscosity_of_all_waves);
    assert!(updated.notes.iter().any(|note| note.contains("viscosity.all-waves")), "{:?}", updated.notes);
}

#[test]
fn numerics_time_and_output_arrive() {
    let model = model(THREE);
    let wanted = Numerics {
        kernel: Kernel::WendlandC2,
        integrator: Integrator::PredictorCorrector,
        precision: Precision::Double,
        pair_form: PairForm::DensityWeighted,
        gradient_correction: GradientCorrection::Linear,
        viscosity_alpha: 0.2,
        viscosity_beta: 4.0,
        viscosity_of_shocks: 0.0,
        viscosity_of_all_waves: false,
        balsara: true,
        artificial_stress: Some(ArtificialStress { epsilon: 0.2, exponent: 6 }),
        xsph: 0.5,
        mls_interval: Some(20),
        energy_split: EnergySplit::Symmetric,
        temperature: TemperatureSource::PlasticWork,
        smoothing_length: SmoothingLength::FollowDensity { factor: 1.5 },
    };
    assert_eq!(model.numerics, wanted);
    let time = TimeControl {
        end: 2e-3,
        courant: 0.2,
        max_step: Some(1e-6),
        fixed_step: Some(0.5e-6),
        step_control: None,
        stop_kinetic_fraction: Some(0.01),
        max_steps: Some(12),
    };
    assert_eq!(model.time, time);
    assert_eq!((model.output.frame_interval, model.output.history_interval), (1e-4, 1e-6));
    assert_eq!(model.output.fields, ["stress", "speed"]);
    assert_eq!((model.search, model.gravity), (Search::Skin { fraction: 0.2 }, [0.0, 0.0, -9.81]));
}

#[test]
fn bodies_and_materials_arrive() {
    let model = model(THREE);
    let (rod, ball) = (&model.bodies[0], &model.bodies[1]);
    assert_eq!((rod.spacing, ball.spacing), (2e-3, 1e-3));
    assert!((rod.smoothing_length - 2.8e-3).abs() < 1e-18 && (ball.smoothing_length - 1.3e-3).abs() < 1e-18);
    assert_eq!(
        (rod.lattice.placement, ball.lattice.placement),
        (LatticePlacement::CellCentres, LatticePlacement::OnFaces)
    );
    assert_eq!((rod.temperature, ball.temperature), (373.15, 293.15));
    assert_eq!(rod.shape.transform.translation, [1e-3, 0.0, 0.0]);
    let steel = &model.materials[rod.material];
    assert_eq!((steel.density, steel.return_rule, steel.flow_law.key()), (8000.0, ReturnRule::BenzAsphaug, "bilinear"));
    // E and nu come from the base: G = E / (2 (1 + nu)).
    assert!((steel.shear_modulus - 210e9 / 2.6).abs() < 1.0);
}

#[test]
fn boundaries_arrive() {
    let model = model(THREE);
    let WallSurface::Plane { point, normal } = model.walls[0].surface else { panic!("a plane") };
    assert_eq!((point, normal), ([0.0, 0.0, 0.04], [0.0, 0.0, -1.0]));
    assert_eq!(model.walls[0].velocity[2].points, [(0.0, -1.0), (1e-3, 0.0)]);
    let WallContact::Penalty { stiffness, damping, friction, at_facets } = model.walls[0].contact else {
        panic!("penalty")
    };
    assert_eq!((stiffness, damping, friction, at_facets), (2.0, 0.3, 0.4, false));
    assert_eq!(model.symmetry, [SymmetryPlane { axis: 1, position: -0.02, side: 1.0 }]);
    assert_eq!(model.periodic, [Some((-0.02, 0.02)), None, None]);
    let axes = &model.motions[0].axes;
    assert_eq!((axes[0].clone(), axes[1].clone()), (MotionAxis::Velocity(TimeTable::constant(0.0)), MotionAxis::Free));
    assert_eq!(axes[2], MotionAxis::Velocity(TimeTable { points: vec![(0.0, 0.0), (5e-3, 1.0)] }));
}

#[test]
fn measures_arrive() {
    let model = model(THREE);
    let kind = |name: &str| model.measures.iter().find(|m| m.name == name).unwrap().kind.clone();
    let probe = ParticleSelection::default();
    let foot = ParticleSelection { region: Some(0), ..ParticleSelection::default() };
    assert_eq!(kind("spread"), MeasureKind::Diameter { selection: foot, axis: 2 });
    let shear = MeasureKind::Extreme {
        selection: ParticleSelection { window: Some(([0.0; 3], [1.0, 1.0, 2.0])), ..ParticleSelection::default() },
        field: "stress".to_owned(),
        component: Some(3),
        extremum: Extremum::Minimum,
        over_time: true,
    };
    assert_eq!(kind("shear"), shear);
    let front = MeasureKind::FrontSpeed {
        selection: probe.clone(),
        field: "pressure".to_owned(),
        component: None,
        axis: 2,
        level: 5e9,
        direction: -1.0,
        window: (1e-6, 3e-6),
    };
    assert_eq!(kind("front"), front);
    let ball = ParticleSelection { body: Some(1), ..ParticleSelection::default() };
    let point = [0.0, 0.0, 0.03];
    assert_eq!(
        kind("probe"),
        MeasureKind::Value { selection: ball, field: "velocity".to_owned(), component: Some(2), point }
    );
    assert_eq!(
        kind("swing"),
        MeasureKind::Period { selection: probe.clone(), field: "position".to_owned(), component: Some(1) }
    );
    assert_eq!(kind("rebound"), MeasureKind::ReversalTime { selection: probe, axis: 2 });
}

#[test]
fn tracers_and_sections_arrive() {
    let model = model(THREE);
    let usual = ["position", "velocity", "pressure", "von_mises_stress", "plastic_strain", "temperature"];
    let tip = Tracer {
        name: "tip".into(),
        point: [0.0, 0.0, 0.02],
        body: Some(0),
        is_fixed: false,
        fields: usual.map(String::from).to_vec(),
    };
    let fields = vec!["pressure".to_owned(), "stress".to_owned()];
    let gauge = Tracer { name: "gauge".into(), point: [0.0, 0.0, 0.005], body: None, is_fixed: true, fields };
    assert_eq!(model.tracers, [tip, gauge]);
    let middle = Section { name: "middle".into(), point: [0.0, 0.0, 0.01], normal: [0.0, 0.6, 0.8], body: Some(0) };
    assert_eq!(model.sections, [middle]);
}

#[test]
fn one_dimension_and_a_segment_in_the_plane() {
    let one = "dimensions = \"1d\"\n[particles]\nspacing = 0.1\n[time]\nend = 1\n\
               [[body]]\nname = \"flyer\"\nmaterial = \"copper-shock\"\nshape = { box = { min = [0], max = [1] } }\nvelocity = [500]\n";
    let setup = load_text("deck", one, &[]).unwrap();
    assert_eq!((setup.particles.len(), setup.particles.velocity[9]), (10, [500.0, 0.0, 0.0]));
    assert!((setup.particles.mass[0] - 893.0).abs() < 1e-9);
    assert_eq!(setup.model.materials[0].shear_modulus, 0.0);
    assert!(!setup.model.materials[0].heats());
    let segment = super::changed(
        "plane = { point = [\"0 mm\", \"0 mm\"], normal = [0, 1] }",
        "segment = { from = [-1, 0], to = [1, 0] }",
    );
    let WallSurface::Segment { from, to } = model(&segment).walls[0].surface else { panic!("a segment") };
    assert_eq!((from, to), ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
}

#[test]
fn temperature_from_energy_needs_a_specific_heat() {
    let deck = super::changed("[time]", "[numerics]\ntemperature = \"energy\"\n[time]");
    assert_eq!(model(&deck).numerics.temperature, TemperatureSource::Energy);
    let without = deck.replace("\"armco-iron\"", "\"copper-shock\"");
    let Err(report) = load_text("deck", &without, &[]) else { panic!("no specific heat") };
    assert!(report.to_string().contains("has no `specific-heat`"), "{report}");
}

#[test]
fn the_diameter_of_a_disc_in_the_plane_is_across_z() {
    let measure = |kind: &str, axis: &str| {
        changed("extent = { body = \"bar\", axis = \"y\" }", &format!("{kind} = {{ axis = \"{axis}\" }}"))
    };
    for (axis, index) in [("x", 0), ("y", 1), ("z", 2)] {
        let diameter = MeasureKind::Diameter { selection: ParticleSelection::default(), axis: index };
        assert_eq!(model(&measure("diameter", axis)).measures[0].kind, diameter);
    }
    let Err(report) = load_text("deck", &measure("extent", "z"), &[]) else { panic!("the plane has no z") };
    assert_eq!(report.to_string(), "the deck is plane strain: there is no z axis");
}

/// The plate with a whole number of spacings.
fn fitted(deck: &str) -> String {
    deck.replace("3.8 mm", "3.75 mm").replace("25.46 mm", "25.5 mm")
}

#[test]
fn gradients_at_faces_choose_the_strength_of_the_springs() {
    for (keys, expected) in [
        ("faces = \"linear\"", (FaceGradients::Linear, 1.25, Counted::LINEAR)),
        ("faces = \"quadratic\"", (FaceGradients::Quadratic, 0.4, Counted::QUADRATIC)),
        ("faces = \"quadratic\", hourglass = 1.0", (FaceGradients::Quadratic, 1.0, Counted::QUADRATIC)),
    ] {
        let search = format!("search = {{ total-lagrangian = {{ {keys} }} }}");
        let deck = fitted(&changed("search = \"every-step\"", &search).replace("\"armco-iron\"", "\"ofhc-copper\""));
        let formulation = load_text("taylor", &deck, &[]).unwrap().model.formulation;
        let Formulation::TotalLagrangian { hourglass, faces, .. } = formulation else { panic!("{formulation:?}") };
        assert_eq!((faces, hourglass, faces.counted()), expected, "{keys}");
    }
}

#[test]
fn what_the_total_lagrangian_form_does_without_is_taken_out_once_and_told() {
    let deck = changed(
        "search = \"every-step\"",
        "search = \"total-lagrangian\"\nnumerics = { artificial-stress = true, xsph = 0.5, mls-interval = 20, pair-form = \"mixed\" }\n#",
    );
    let deck = fitted(&deck.replace("\"armco-iron\"", "\"ofhc-copper\""));
    let setup = load_text("taylor", &deck, &[]).unwrap();
    let (numerics, plain) = (&setup.model.numerics, load_text("taylor", FLAVOUR, &[]).unwrap().model.numerics);
    assert_eq!(*numerics, Numerics { viscosity_alpha: 0.1, viscosity_beta: 10.0, ..plain });
    assert_eq!(
        setup.model.formulation,
        Formulation::TotalLagrangian {
            hourglass: 1.25,
            faces: FaceGradients::Linear,
            renewal: Some(16.0),
            self_contact: true
        }
    );
    assert_eq!(
        setup.notes,
        [
            "the total Lagrangian form does not use `numerics.artificial-stress`, `numerics.xsph`, `numerics.mls-interval`, `numerics.pair-form`"
        ]
    );
    let other = deck.replace("total-lagrangian", "every-step");
    assert!(load_text("taylor", &other, &[]).unwrap().notes.is_empty());
}

#[test]
fn doubtful_materials_are_told_and_run() {
    let notes = |deck: &str| {
        let setup = load_text("taylor", &fitted(deck), &[]).unwrap();
        [setup.catalogue_notes, setup.notes].concat()
    };
    // Bulk modulus and shear modulus of the papers' iron do not belong together; once for each material.
    let twice = FLAVOUR.to_owned()
        + "[[body]]\nname = \"other\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [1, 0], max = [1.0102, 0.0102] } }\n";
    for deck in [FLAVOUR, &twice] {
        let told = notes(deck);
        assert!(told.len() == 1 && told[0].starts_with("material `armco-iron`: its pressure law"), "{told:?}");
    }
    let meant = changed("[time]", "[material.armco-iron]\npoisson-ratio = 0.2\n[time]");
    assert_eq!(notes(&meant), Vec::<String>::new());
    // Johnson-Cook without a specific heat is isothermal.
    let iron = "[material.iron]\ndensity = 7850\nyoung-modulus = \"211 GPa\"\npoisson-ratio = 0.29\n\
                [material.iron.strength.johnson-cook]\nA = \"175 MPa\"\nB = \"380 MPa\"\nn = 0.32\nC = 0.06\nm = 0.55\n\
                melting-temperature = \"1811 K\"\n[time]";
    let deck = changed("[time]", iron).replace("\"armco-iron\"", "\"iron\"");
    let setup = load_text("taylor", &fitted(&deck), &[]).unwrap();
    assert!(!setup.model.materials[0].heats());
    assert!(setup.notes.len() == 1 && setup.notes[0].contains("has no `specific-heat`: its temperature is constant"));
    let meant = deck.replace("density = 7850", "density = 7850\ntaylor-quinney = 0");
    assert_eq!(notes(&meant), Vec::<String>::new());
}

#[test]
fn a_run_tells_of_what_its_deck_has_changed_and_not_of_published_constants() {
    let is_of_ratio = |notes: &[String]| notes.len() == 1 && notes[0].contains("Poisson's ratio");
    let plate = crate::decks::find("iron-plate").unwrap().text;
    let shipped = load_text("iron-plate", plate, &[]).unwrap();
    assert_eq!(shipped.notes, [""; 0]);
    assert!(is_of_ratio(&shipped.catalogue_notes), "{:?}", shipped.catalogue_notes);
    let doubts = crate::material::find("armco-iron").unwrap().doubts;
    assert_eq!(doubts, shipped.catalogue_notes);
    // Where the deck has a hand in the constants, they are its own.
    let denser = ("material.armco-iron.density".to_owned(), "7900 kg/m3".to_owned());
    let changed = load_text("iron-plate", plate, &[denser]).unwrap();
    assert!(is_of_ratio(&changed.notes) && changed.catalogue_notes.is_empty(), "{:?}", changed.notes);
}

#[test]
fn walls_push_at_facets_what_they_meet_slowly() {
    let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 us\" }\n[[body]]\nname = \"block\"\nmaterial = \"steel\"\n\
                shape = { box = { min = [0, 0], max = [\"8 mm\", \"8 mm\"] } }\nvelocity = [\"90 m/s\", \"-5 m/s\"]\n\
                [[wall]]\nname = \"floor\"\nplane = { point = [0, 0], normal = [0, 1] }\n\
                [material.steel]\ndensity = 7850\nyoung-modulus = \"210 GPa\"\npoisson-ratio = 0.3\nstrength = { perfectly-plastic = { yield-stress = \"300 MPa\" } }\n";
    let at_facets = |replaced: &[(&str, &str)]| {
        let text = replaced.iter().fold(deck.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        load_text("walls", &text, &[]).unwrap().model.meets_walls_at_facets()
    };
    // It yields at 300 MPa / sqrt(7850 kg/m^3 210 GPa), 7.39 m/s.
    assert!(at_facets(&[]) && at_facets(&[("-5 m/s", "-7.3 m/s")]) && !at_facets(&[("-5 m/s", "-7.5 m/s")]));
    // Hot metal yields at less.
    let johnson_cook = "strength = { johnson-cook = { A = \"300 MPa\", B = 0, n = 1, C = 0, m = 1, melting-temperature = \"1800 K\" } }\nspecific-heat = 450";
    let hot = |temperature: &str| {
        let body = format!("\"-5 m/s\"]\ntemperature = \"{temperature}\"");
        at_facets(&[
            ("\"-5 m/s\"]", &body),
            ("strength = { perfectly-plastic = { yield-stress = \"300 MPa\" } }", johnson_cook),
        ])
    };
    assert!(hot("300 K") && !hot("1000 K"));
    // What flies away, and a wall that comes; along itself it may move.
    assert!(at_facets(&[("-5 m/s", "90 m/s")]));
    let moving = |velocity: &str| format!("normal = [0, 1] }}\nvelocity = {velocity}");
    let wall = |velocity: &str| at_facets(&[("normal = [0, 1] }", &moving(velocity))]);
    assert!(
        wall("[\"90 m/s\", \"2 m/s\"]")
            && wall("[0, \"-90 m/s\"]")
            && !wall("[0, [[\"0 s\", \"0 m/s\"], [\"1 us\", \"3 m/s\"]]]")
    );
    // Metal that never yields, may break or has no strength.
    let strength = "strength = { perfectly-plastic = { yield-stress = \"300 MPa\" } }";
    assert!(at_facets(&[("-5 m/s", "-90 m/s"), (strength, "strength = \"elastic\"")]));
    assert!(!at_facets(&[(strength, &format!("{strength}\nspall-pressure = \"2 GPa\""))]));
    assert!(!at_facets(&[(strength, "strength = \"none\"")]));
    // The deck decides.
    let particles = "normal = [0, 1] }\ncontact = { penalty = { surfaces = \"particles\" } }";
    assert!(!at_facets(&[("normal = [0, 1] }", particles)]));
}
