use super::*;
use crate::{
    engine::ENGINES,
    particles::Column,
    run::{RunOptions, Silent, execute},
};
use std::sync::atomic::AtomicBool;

/// Points of a lattice of spacing 1 mm and `count` by `count` by `count`, 2 g each, with the velocities of a rigid body of that spin.
fn block(count: [usize; 3], spin: [f64; 3], velocity: [f64; 3]) -> Vec<(f64, [f64; 3], [f64; 3])> {
    let middle = count.map(|n| 0.5 * (n as f64 - 1.0));
    let all = (0..count[0]).flat_map(|i| (0..count[1]).flat_map(move |j| (0..count[2]).map(move |k| [i, j, k])));
    let point = |of: [usize; 3]| {
        let x = [0, 1, 2].map(|a| 1e-3 * (of[a] as f64 - middle[a]));
        let turned = [0, 1, 2].map(|a| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            velocity[a] + spin[b] * x[c] - spin[c] * x[b]
        });
        (2e-3, [0, 1, 2].map(|a| x[a] + [0.5, -0.25, 2.0][a]), turned)
    };
    all.map(point).collect()
}

fn near(a: [f64; 3], b: [f64; 3], within: f64) {
    assert!([0, 1, 2].iter().all(|&k| (a[k] - b[k]).abs() <= within), "{a:?} is not {b:?}");
}

#[test]
fn a_rigid_box_has_its_mass_velocity_spin_and_edges() {
    let (spin, velocity) = ([30.0, -400.0, 1000.0], [10.0, -20.0, 150.0]);
    let points = block([5, 9, 3], spin, velocity);
    let fragment = Fragment::of("plate", 3, 1e-3, points.iter().copied());
    assert_eq!((fragment.body.as_str(), fragment.particles), ("plate", 135));
    assert!((fragment.mass - 0.27).abs() < 1e-12);
    near(fragment.position, [0.5, -0.25, 2.0], 1e-12);
    near(fragment.velocity, velocity, 1e-9);
    near(fragment.spin, spin, 1e-4);
    near(fragment.size, [9e-3, 5e-3, 3e-3], 1e-12);
}

#[test]
fn rows_and_single_particles_have_no_spin_of_their_own() {
    // A row along x spins about y and z alone.
    let row = Fragment::of("wire", 3, 1e-3, block([4, 1, 1], [50.0, 7.0, -9.0], [0.0; 3]).into_iter());
    near(row.spin, [0.0, 7.0, -9.0], 1e-6);
    near(row.size, [4e-3, 1e-3, 1e-3], 1e-12);
    let one = Fragment::of("dust", 2, 1e-3, block([1, 1, 1], [5.0; 3], [1.0, 2.0, 0.0]).into_iter());
    assert_eq!(one.spin, [0.0; 3]);
    near(one.size, [1e-3, 1e-3, 0.0], 1e-12);
    // In a plane about its normal.
    let sheet = Fragment::of("sheet", 2, 1e-3, block([6, 2, 1], [0.0, 0.0, -80.0], [3.0, 0.0, 0.0]).into_iter());
    near(sheet.spin, [0.0, 0.0, -80.0], 1e-6);
    near(sheet.size, [6e-3, 2e-3, 0.0], 1e-12);
}

/// Two bars of which each comes apart in the middle: by hand, in the frame that a run of one step has written.
const DECK: &str = r#"
dimensions = "plane-strain"
time = { end = "1 us", max-steps = 1 }
particles = { spacing = "1 mm" }
output = { frames = 1 }

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = [0, 0], max = ["20 mm", "4 mm"] } }
velocity = ["5 m/s", 0]

[[body]]
name = "other"
material = "ofhc-copper"
shape = { box = { min = [0, "40 mm"], max = ["6 mm", "44 mm"] } }
"#;

#[test]
fn a_run_has_the_fragments_of_its_bodies_with_masses_of_its_deck() {
    let folder = tempfile::tempdir().unwrap();
    let setup = crate::deck::load_text("bars", DECK, &[]).unwrap();
    let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
    execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap();
    let run = RunDirectory::open(&options.directory).unwrap();
    let of = |frame: Option<FrameChoice>, bodies: &[&str]| {
        let bodies = bodies.iter().map(|name| (*name).to_owned()).collect();
        fragments(&run, frame, &FragmentOptions { bodies, ..FragmentOptions::default() })
    };
    let first = &of(Some(FrameChoice::First), &[]).unwrap()[0];
    assert_eq!((first.frame, first.fragments.len()), (0, 2));
    let bar = &first.fragments[0];
    assert!(bar.body == "bar" && (bar.mass - 7890.0 * 80e-6).abs() < 1e-9, "{bar:?}");
    near(bar.velocity, [5.0, 0.0, 0.0], 1e-6);
    near(bar.size, [20e-3, 4e-3, 0.0], 1e-9);
    assert!(first.loose.iter().all(|loose| loose.particles == 0 && loose.mass == 0.0));
    assert_eq!(of(None, &["other"]).unwrap().len(), read_series(&run).unwrap().len());
    assert!(of(Some(FrameChoice::Last), &["other"]).unwrap()[0].fragments[0].body == "other");
    assert!(matches!(of(None, &["bra"]), Err(FragmentError::Choice(_))));
    assert!(matches!(of(Some(FrameChoice::Index(99)), &[]), Err(FragmentError::Choice(_))));
    let odd =
        |link: f64, least: u64| fragments(&run, None, &FragmentOptions { link, least, ..FragmentOptions::default() });
    assert!([(0.0, 1), (f64::NAN, 1), (11.0, 1), (1.5, 0)].iter().all(|&(link, least)| odd(link, least).is_err()));
    // Too few particles are no fragment.
    let small = &odd(1.5, 25).unwrap()[0];
    assert_eq!((small.fragments.len(), small.loose[1].particles), (1, 24));
    assert!((small.loose[1].mass - first.fragments[1].mass).abs() < 1e-9);
}

#[test]
fn severed_particles_part_fragments_in_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let setup = crate::deck::load_text(
        "bars",
        DECK,
        &[("output.fields", "[\"velocity\", \"integrity\"]")].map(|(k, v)| (k.into(), v.into())),
    );
    let setup = setup.unwrap();
    let path = folder.path().join("frame.vtp");
    let mut particles = setup.particles.clone();
    let severed = |x: &[f64; 3]| (9.0e-3..11.0e-3).contains(&x[0]) && x[1] < 10e-3;
    let integrity: Vec<f64> = particles.position.iter().map(|x| f64::from(u8::from(!severed(x)))).collect();
    particles.set_column("integrity", &Column::Scalar(integrity.into()));
    let fields = ["body", "velocity", "integrity"].map(str::to_owned);
    let mut file = std::fs::File::create(&path).unwrap();
    let header = crate::output::FrameHeader { time: 2e-6, step: 1, dimensions: 2, body_spacing: vec![1e-3, 1e-3] };
    crate::output::FrameWriter::new(&setup.model).write(&mut file, &header, &particles, &fields).unwrap();
    let mut frame = FrameFile::open(&path).unwrap();
    let whole = || Whole {
        mass: particles.mass.clone(),
        body: particles.body.clone(),
        periodic: [None; 3],
        knows_deformation: true,
    };
    let table = of_frame(3, &mut frame, &whole(), &FragmentOptions::default()).unwrap();
    let sizes: Vec<_> = table.fragments.iter().map(|of| (of.body.as_str(), of.particles)).collect();
    assert_eq!(sizes, [("bar", 36), ("bar", 36), ("other", 24)]);
    assert_eq!((table.loose[0].particles, table.loose[1].particles), (8, 0));
    assert!((table.loose[0].mass - 8.0 * 7890.0 * 1e-6).abs() < 1e-12);
    let text = table.text(1);
    assert!(text.starts_with("frame 3 at 2 us\n") && text.contains("2 lighter fragments, "), "{text}");
    assert!(
        text.contains("bar: 8 particles, 0.06312 kg/m, are part of no fragment; their mean velocity is (5, 0) m/s"),
        "{text}"
    );
    assert!(table.notes.len() == 1 && table.notes[0].contains("no field `deformation_gradient`"), "{:?}", table.notes);
    assert!(text.contains(" (5, 0) ") && text.contains(" 0 rad/s ") && text.contains("9 mm x 4 mm"), "{text}");
    // Head, fragments, and what is part of none, with which mass and momentum add up.
    let csv = FragmentTable::csv(&[table]);
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.len() == 5 && lines[0][5] == "mass (kg/m)" && lines[4][2..4] == ["", "bar"], "{csv}");
    let of_bar = |value: fn(&[&str]) -> f64| {
        lines[1..].iter().filter(|line| line[3] == "bar").map(|line| value(line)).sum::<f64>()
    };
    assert!((of_bar(|line| line[5].parse().unwrap()) - 80.0 * 7890.0 * 1e-6).abs() < 1e-12, "{csv}");
    let momentum = of_bar(|line| line[5].parse::<f64>().unwrap() * line[9].parse::<f64>().unwrap());
    assert!((momentum - 5.0 * 80.0 * 7890.0 * 1e-6).abs() < 1e-9, "{csv}");
    // Without the velocity there is nothing to say.
    let mut file = std::fs::File::create(&path).unwrap();
    crate::output::FrameWriter::new(&setup.model).write(&mut file, &header, &particles, &fields[..1]).unwrap();
    let mut frame = FrameFile::open(&path).unwrap();
    let none = of_frame(3, &mut frame, &whole(), &FragmentOptions::default());
    assert!(matches!(none, Err(FragmentError::Field { name: "velocity" })), "{none:?}");
}

#[test]
fn bodies_and_what_lies_over_periodic_ends_are_those_of_the_deck() {
    // A bar that lies over the end of the cell, moving and turning about its middle, beside a bar that goes all around; frames say no more than they must.
    let folder = tempfile::tempdir().unwrap();
    let deck = DECK.replace(
        "output = { frames = 1 }",
        "output = { frames = 1, fields = [\"velocity\"] }\nmethod = \"updated-lagrangian\"\nperiodic = { x = [0, \"20 mm\"] }",
    );
    let setup = crate::deck::load_text("bars", &deck, &[]).unwrap();
    let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
    execute(setup.clone(), ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap();
    let run = RunDirectory::open(&options.directory).unwrap();
    let again = FragmentOptions { bodies: vec!["other".into(), "bar".into(), "other".into()], ..Default::default() };
    let table = &fragments(&run, Some(FrameChoice::First), &again).unwrap()[0];
    let sizes: Vec<_> = table.fragments.iter().map(|of| (of.body.as_str(), of.particles)).collect();
    assert_eq!((sizes, table.loose.len()), (vec![("bar", 80), ("other", 24)], 2));
    assert!(table.notes.len() == 1 && table.mass_unit == "kg/m", "{:?}", table.notes);
    // The same with a spin, in frames as a run would write them.
    let mut particles = setup.particles.clone();
    let middle = [18.5e-3, 42e-3];
    for i in (0..particles.len()).filter(|&i| particles.body[i] == 1) {
        let x = particles.position[i];
        let way = [x[0] - 3e-3, x[1] - middle[1]];
        particles.velocity[i] = [-1000.0 * way[1] + 7.0, 1000.0 * way[0], 0.0];
        let along = middle[0] + way[0];
        particles.position[i][0] = if along >= 20e-3 { along - 20e-3 } else { along };
    }
    let path = folder.path().join("frame.vtp");
    let mut file = std::fs::File::create(&path).unwrap();
    let header = crate::output::FrameHeader { time: 2e-6, step: 1, dimensions: 2, body_spacing: vec![1e-3, 1e-3] };
    let fields = ["velocity".to_owned()];
    crate::output::FrameWriter::new(&setup.model).write(&mut file, &header, &particles, &fields).unwrap();
    let mut frame = FrameFile::open(&path).unwrap();
    let whole = Whole::of(&run, Some(&setup.model), &mut frame).unwrap();
    let table = of_frame(0, &mut frame, &whole, &FragmentOptions::default()).unwrap();
    let [bar, other] = &table.fragments[..] else { panic!("{table:?}") };
    near(bar.velocity, [5.0, 0.0, 0.0], 1e-6);
    near(bar.spin, [0.0; 3], 1e-12);
    near(other.velocity, [7.0, 0.0, 0.0], 1e-4);
    near(other.spin, [0.0, 0.0, 1000.0], 1e-2);
    near(other.position, [18.5e-3, 42e-3, 0.0], 1e-7);
    near(other.size, [6e-3, 4e-3, 0.0], 1e-7);
}
