//! Shapes and lattices of decks, and what is said of those that make no sense.

use super::super::*;
use sphorge_engine::geometry::MAX_PARTICLES;
use sphorge_engine::model::*;

fn deck(dimensions: &str, shape: &str) -> String {
    format!(
        "dimensions = \"{dimensions}\"\n[particles]\nspacing = \"10 mm\"\n[time]\nend = \"1 ms\"\n\
         [[body]]\nname = \"bar\"\nmaterial = \"steel-fraser\"\nshape = {shape}\n"
    )
}

#[track_caller]
fn setup(text: &str) -> Setup {
    load_text("deck", text, &[]).unwrap_or_else(|report| panic!("{:?}", report.problems()))
}

/// Checks kind, marked text and message of the only fault.
#[track_caller]
fn told(text: &str, code: &str, marked: &str, message: &str) {
    let Err(report) = load_text("deck", text, &[]) else { panic!("no fault is found in\n{text}") };
    assert_eq!(report.problems().len(), 1, "{:?}", report.problems());
    let problem = &report.problems()[0];
    assert_eq!(problem.code(), code, "{problem}");
    assert_eq!(&text[problem.labels()[0].0.clone()], marked, "{problem}");
    assert!(problem.to_string().contains(message), "{problem}");
}

const SPECIMEN: &str = r#"{ revolution = { axis = [1, 0, 0], profile = [
    ["0 mm", "75 mm"], ["200 mm", "75 mm"], ["225 mm", "50 mm"], ["275 mm", "50 mm"], ["300 mm", "75 mm"], ["500 mm", "75 mm"],
] } }"#;

#[test]
fn a_tensile_specimen_is_one_shape() {
    let setup = setup(&deck("3d", SPECIMEN));
    let volume = setup.model.bodies[0].shape.volume(Dimensions::Three);
    let exact = std::f64::consts::PI
        * (2.0 * 0.2 * 0.075f64.powi(2)
            + 0.05 * 0.05f64.powi(2)
            + 2.0 * 0.025 / 3.0 * (0.075f64.powi(2) + 0.075 * 0.05 + 0.05f64.powi(2)));
    assert!(volume.is_exact && (volume.size / exact - 1.0).abs() < 1e-12);
    assert!((setup.particles.len() as f64 * 1e-6 / exact - 1.0).abs() < 0.03, "{}", setup.particles.len());
}

#[test]
fn a_bullet_is_one_shape_by_nose_length_or_head_radius() {
    let bullet = |nose: &str| {
        deck(
            "3d",
            &format!("{{ ogive = {{ from = [0, 0, 0], to = [0, 0, \"261 mm\"], radius = \"30 mm\", {nose} }} }}"),
        )
    };
    let Solid::Ogive { nose_length, .. } = setup(&bullet("head-radius = \"135 mm\"")).model.bodies[0].shape.solid
    else {
        panic!("an ogive")
    };
    // sqrt(30 (270 - 30)).
    assert!((nose_length - 84.8528137e-3).abs() < 1e-9);
    assert!(setup(&bullet("nose-length = \"60 mm\"")).particles.len() > 500);
    told(&bullet("nose-length = \"20 mm\""), "out-of-range", "\"20 mm\"", "blunter than a hemisphere");
    told(
        &bullet("nose-length = \"300 mm\""),
        "out-of-range",
        "\"300 mm\"",
        "the nose is 300.0000 mm long, the whole bar 261.0000 mm",
    );
    told(
        &bullet("nose-length = 0.1, head-radius = 0.1"),
        "exactly-one",
        "\"30 mm\"",
        "only one of `nose-length` or `head-radius`",
    );
}

#[test]
fn shapes_are_composed_nested_and_turned() {
    let plate = r#"{ difference = [
        { union = [ { box = { min = [0, 0], max = [0.4, 0.2] } }, { disc = { centre = [0.4, 0.1], radius = 0.1 } } ] },
        { disc = { centre = [0, 0], radius = "50 mm" }, shift = [0.2, 0.1] },
    ], rotate = { angle = "90 deg" } }"#;
    let setup = setup(&deck("plane-strain", plate));
    // 40 x 20 cells and half a disc less a disc.
    let expected = 800.0 + 0.5 * std::f64::consts::PI * 100.0 - std::f64::consts::PI * 25.0;
    assert!((setup.particles.len() as f64 / expected - 1.0).abs() < 0.02, "{}", setup.particles.len());
    assert!(setup.particles.position.iter().all(|x| x[0] < 0.0 && x[0] > -0.2 && x[1] > 0.0 && x[1] < 0.5));
    let volume = setup.model.bodies[0].shape.volume(Dimensions::PlaneStrain);
    assert!(!volume.is_exact && (volume.size / (expected * 1e-4) - 1.0).abs() < 1e-3);
}

#[test]
fn polygons_and_rings_in_the_plane() {
    let triangle = "{ polygon = { corners = [[0, 0], [0.4, 0], [0, 0.2]] } }";
    let particles = setup(&deck("plane-strain", triangle)).particles.len();
    assert!((particles as f64 / 400.0 - 1.0).abs() < 0.05, "{particles}");
    let ring = "{ disc = { centre = [0, 0], radius = 0.4, inner-radius = 0.3 } }\nlattice = \"rings\"";
    let particles = setup(&deck("plane-strain", ring)).particles;
    let mass: f64 = particles.mass.iter().sum();
    assert!((mass / (7850.0 * std::f64::consts::PI * 0.07) - 1.0).abs() < 1e-12);
    // 3.5 spacings from the middle to either wall: ten rings, the innermost 5 mm from the hole.
    let nearest = particles.position.iter().map(|x| x[0].hypot(x[1])).fold(1.0, f64::min);
    assert!((nearest - 0.305).abs() < 1e-12);
}

#[test]
fn shapes_that_make_no_sense_say_why() {
    let profile = |points: &str| deck("3d", &format!("{{ revolution = {{ axis = [1, 0, 0], profile = {points} }} }}"));
    told(&profile("[[0, 1], [2, 1], [1, 1]]"), "bad-profile", "[1, 1]", "cannot turn back");
    told(&profile("[[0, 1], [2, -1]]"), "bad-profile", "[2, -1]", "cannot be negative");
    told(&profile("[[0, 1]]"), "bad-profile", "[0, 1]", "at least two points");
    told(&profile("[[0, 1], [0, 2]]"), "bad-profile", "[0, 2]", "has no length");
    told(&profile("[[0, 0], [1, 0]]"), "bad-profile", "[1, 0]", "has no width");
    told(&profile("[[0, 1], [1, 0, 0]]"), "wrong-length", "[1, 0, 0]", "an axial distance and a radius");
    let polygon = |corners: &str| deck("plane-strain", &format!("{{ polygon = {{ corners = {corners} }} }}"));
    told(&polygon("[[0, 0], [1, 1], [1, 0], [0, 1]]"), "bad-polygon", "[1, 0]", "crosses itself");
    told(&polygon("[[0, 0], [1, 1]]"), "bad-polygon", "[0, 0]", "at least three corners, this one 2");
    told(&polygon("[[0, 0], [1, 1], [2, 2]]"), "bad-polygon", "[0, 0]", "has no area");
    let ring = deck("plane-strain", "{ disc = { centre = [0, 0], radius = 0.4, inner-radius = 0.5 } }");
    told(&ring, "out-of-range", "0.5", "as wide as the shape");
    told(&deck("3d", "{ polygon = { corners = [[0, 0]] } }"), "wrong-dimensions", "[0, 0]", "there is no polygon");
    told(&deck("3d", "{ union = [] }"), "empty-shape", "\"bar\"", "at least one part");
    let part = "{ union = [{ sphere = { centre = [0, 0, 0], radius = 1 } }, { shift = [1, 0, 0] }] }";
    told(&deck("3d", part), "exactly-one", "{ shift = [1, 0, 0] }", "a shape needs one of");
    let apart = "{ intersection = [{ sphere = { centre = [0, 0, 0], radius = 0.1 } }, { sphere = { centre = [1, 0, 0], radius = 0.1 } }] }";
    told(&deck("3d", apart), "empty-body", "\"bar\"", "contains no particles");
}

#[test]
fn lattices_that_do_not_fit_the_shape_say_so() {
    let block = "{ box = { min = [0, 0], max = [0.1, 0.1] } }\nlattice = \"rings\"";
    told(&deck("plane-strain", block), "wrong-lattice", "\"rings\"", "rings fill a `disc`");
    let faces = "{ box = { min = [0, 0], max = [0.1, 0.1] } }\nlattice = \"hexagonal\"\nplacement = \"on-faces\"";
    told(&deck("plane-strain", faces), "wrong-lattice", "\"on-faces\"", "only the square lattice");
}

fn table(content: &str, keys: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bar.csv"), content).unwrap();
    let path = folder.path().join("deck.toml");
    std::fs::write(
        &path,
        deck(
            "plane-strain",
            &format!("{{ table = {{ file = \"bar.csv\"{keys} }}, rotate = {{ angle = \"90 deg\" }} }}"),
        ),
    )
    .unwrap();
    (folder, path)
}

#[test]
fn particles_come_from_a_file_with_units() {
    let content = "# exported\nX, y, vx, vy, mass, colour\n1, 2, 3, 0, 5, red\n\n21, 2, 0, 0, 6, blue\n";
    let (_folder, path) = table(content, ", length-unit = \"cm\", velocity-unit = \"km/s\", mass-unit = \"g/mm\"");
    let text = std::fs::read_to_string(&path).unwrap().replace("material", "velocity = [0, 7]\nmaterial");
    std::fs::write(&path, text).unwrap();
    let setup = load(&path, &[], MAX_PARTICLES).unwrap_or_else(|report| panic!("{:?}", report.problems()));
    let p = &setup.particles;
    // Turned by a quarter, and the velocity of the body added.
    assert!((p.position[0][0] + 0.02).abs() < 1e-15 && (p.position[1][1] - 0.21).abs() < 1e-15);
    assert!(p.velocity[0][0].abs() < 1e-9 && (p.velocity[0][1] - 3007.0).abs() < 1e-9);
    assert!((p.mass[0] - 5.0).abs() < 1e-12 && (p.mass[1] - 6.0).abs() < 1e-12);
    // The deck as run finds the file from anywhere.
    assert!(super::super::load_text("again", &setup.deck_text, &[]).is_ok(), "{}", setup.deck_text);
    let (_folder, path) = table("x,y,volume\n0,0,1e-4\n1,0,2e-4\n", "");
    let p = load(&path, &[], MAX_PARTICLES).unwrap().particles;
    assert!((p.mass[1] - 2e-4 * 7850.0).abs() < 1e-12);
    let (_folder, path) = table("x,y\n0,0\n", "");
    assert!((load(&path, &[], MAX_PARTICLES).unwrap().particles.mass[0] - 0.785).abs() < 1e-12);
}

#[test]
fn particles_of_a_file_that_are_one_or_outweigh_all_others_are_told() {
    let notes = |content: &str| {
        let (_folder, path) = table(content, "");
        let short = std::fs::read_to_string(&path).unwrap().replace("end = \"1 ms\"", "end = \"1 ms\"\nmax-steps = 1");
        std::fs::write(&path, short).unwrap();
        load(&path, &[], MAX_PARTICLES).unwrap_or_else(|report| panic!("{:?}", report.problems())).notes
    };
    let told = notes("x,y\n0,0\n0.01,0\n0.010000000001,0\n");
    assert!(told.len() == 1 && told[0].contains("two particles are 1.0e-12 m apart at ("), "{told:?}");
    let told = notes("x,y,mass\n0,0,0.001\n1,0,0.002\n2,0,1000\n");
    assert!(told.iter().any(|note| note.contains("masses from 1.000e-3 to 1.000e3 kg/m;")), "{told:?}");
    assert_eq!(notes("x,y,mass\n0,0,0.7\n0.01,0,0.8\n0.02,0,0.785\n"), [""; 0]);
}

#[test]
fn a_file_whose_particles_are_all_neighbours_is_refused() {
    // The spacing is 10 mm: two particles along a line, four to a cell.
    let grid = |pitch: f64| -> String {
        let at = |k: usize| (k as f64 + 0.5) * pitch;
        let rows = (0..100).map(|k| format!("{},{}\n", at(k % 10), at(k / 10)));
        std::iter::once("x,y\n".to_owned()).chain(rows).collect()
    };
    let (_folder, path) = table(&grid(0.0051), "");
    assert!(load(&path, &[], MAX_PARTICLES).is_ok());
    let (_folder, path) = table(&grid(5.1), ", length-unit = \"mm\"");
    assert!(load(&path, &[], MAX_PARTICLES).is_ok());
    let (_folder, path) = table(&grid(5.1), ", length-unit = \"um\"");
    let Err(report) = load(&path, &[], MAX_PARTICLES) else { panic!("100 particles in a cell") };
    let [problem] = report.problems() else { panic!("{:?}", report.problems()) };
    assert_eq!(problem.code(), "crowded-particles");
    assert!(format!("{:?}", problem.labels()).contains("100 of them within one spacing"), "{problem:?}");
}

#[test]
fn what_is_wrong_with_a_file_of_particles_names_line_and_column() {
    let told = |content: &str, keys: &str, messages: &[&str]| {
        let (_folder, path) = table(content, keys);
        let Err(report) = load(&path, &[], MAX_PARTICLES) else { panic!("no fault is found in\n{content}") };
        let found: Vec<String> = report.problems().iter().map(ToString::to_string).collect();
        assert_eq!(found, messages, "{:?}", report.problems());
        assert!(report.problems().iter().all(|p| p.line() == Some(9)));
    };
    told("x,y\n0,1\n0,nan\n", "", &["`bar.csv`, line 3, column `y`: `nan` is not a finite number"]);
    told("x,y\n0,1\n0,1e300\n", "", &["`bar.csv`, line 3, column `y`: `1e300` is too large to compute with"]);
    told("x,z\n0,1\n", "", &["`bar.csv`, line 1: no column `y`; it names `x` and `z`"]);
    told(
        "x,y\none,1\n,2\n",
        "",
        &["`bar.csv`, line 2, column `x`: `one` is not a number", "`bar.csv`, line 3, column `x`: `` is not a number"],
    );
    told("x,y,mass\n0,1,0\n", "", &["`bar.csv`, line 2, column `mass`: `0` must be above zero"]);
    told("x,y\n0,1\n0\n", "", &["`bar.csv`, line 3: 1 cell, where line 1 names 2"]);
    told("x,y\n0,1\n1,1\n-0,1\n", "", &["`bar.csv`, lines 2 and 4 put two particles in the same place"]);
    told("x,y\n", "", &["`bar.csv` contains no particles"]);
    told("x,y,mass,volume\n0,0,1,1\n", "", &["`bar.csv`, line 1: both `mass` and `volume`; one determines the other"]);
    told("x,y\n0,0\n", ", length-unit = \"kg\"", &["expected a length (m), found a mass in `kg`"]);
    let (_folder, path) = table(&format!("x,y\n{}", "a,1\n".repeat(9)), "");
    let Err(report) = load(&path, &[], MAX_PARTICLES) else { panic!("nine faults") };
    assert_eq!((report.problems().len(), report.problems()[4].help()), (5, Some("and 4 more in this file")));
    let text = std::fs::read_to_string(&path).unwrap().replace("bar.csv", "rod.csv");
    std::fs::write(&path, text).unwrap();
    assert!(load(&path, &[], MAX_PARTICLES).err().unwrap().to_string().starts_with("`rod.csv` cannot be read"));
    let part = "{ union = [{ table = { file = \"bar.csv\" } }] }";
    super::shapes::told(&deck("3d", part), "table-as-part", "\"bar.csv\"", "part of another shape");
}

#[test]
fn angles_of_more_than_a_turn_without_a_unit_are_told() {
    let notes = |angle: &str| {
        let deck = format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n[[body]]\nname = \"bar\"\n\
             material = \"ofhc-copper\"\nvelocity = [1, 0]\n\
             shape = {{ box = {{ min = [0, 0], max = [\"6 mm\", \"8 mm\"] }}, rotate = {{ angle = {angle}, about = [0, 0] }} }}\n"
        );
        load_text("bar", &deck, &[]).unwrap_or_else(|report| panic!("{report}")).notes
    };
    for (angle, is_told) in [("30", true), ("-90", true), ("6.2", false), ("\"30 deg\"", false), ("\"7 rad\"", false)] {
        let told =
            notes(angle).iter().any(|note| note.contains("rad, more than a turn") && note.starts_with("line 8: "));
        assert_eq!(told, is_told, "{angle}: {:?}", notes(angle));
    }
}
