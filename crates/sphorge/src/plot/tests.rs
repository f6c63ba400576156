//! Pictures of runs written by hand.

use super::*;
use crate::{
    Particles,
    output::{FrameHeader, RunDirectory, SeriesEntry, write_frame_file, write_series},
    particles::Column,
};
use std::{fs, path::Path};

/// Few pixels, where it does not matter what they show.
const COARSE: Paper = Paper { dpi: 20, width: None };

/// A quarter of the pixels, which take a quarter of the time.
const HALF: Paper = Paper { dpi: 50, width: None };

/// A run of two frames of a 20 by 10 lattice; pressure grows with x, from -1 to 1 GPa.
fn run(folder: &Path, dimensions: usize) -> RunDirectory {
    let run = RunDirectory::create(&folder.join("run"), false).unwrap();
    let mut particles = Particles::new(200);
    for i in 0..200 {
        particles.position[i] = [1e-3 * (i % 20) as f64, 1e-3 * (i / 20) as f64, 1e-4 * i as f64];
        particles.pressure[i] = 1e9 * ((i % 20) as f64 / 9.5 - 1.0);
        particles.velocity[i] = [3.0, 4.0, 0.0];
    }
    let fields = ["body", "pressure", "velocity", "stress"].map(str::to_owned);
    let mut entries = Vec::new();
    for (k, time) in [0.0, 1e-5].into_iter().enumerate() {
        let header = FrameHeader { time, step: k as u64, dimensions, body_spacing: vec![1e-3] };
        let file = RunDirectory::frame_name(k, false);
        write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
        entries.push(SeriesEntry { time, file });
    }
    write_series(&run, &entries).unwrap();
    run
}

fn pixels(path: &Path) -> tiny_skia::Pixmap {
    tiny_skia::Pixmap::load_png(path).unwrap()
}

fn count(picture: &tiny_skia::Pixmap, [r, g, b]: [u8; 3]) -> usize {
    picture.pixels().iter().filter(|p| (p.red(), p.green(), p.blue()) == (r, g, b)).count()
}

#[test]
fn particles_have_the_colours_of_the_bar() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let to = folder.path().join("new/folder/p.png");
    let picture = FieldPicture { size: Some((800, 500)), paper: HALF, ..FieldPicture::new("pressure") };
    plot_field(&run, &picture, &to).unwrap();
    let drawn = pixels(&to);
    assert_eq!((drawn.width(), drawn.height()), (400, 250));
    // Both signs: diverging, the ends at the two ends of the lattice.
    for end in [0.0, 1.0] {
        assert!(count(&drawn, ColorMap::Diverging.color(end)) > 125);
    }
    // Beyond a given range the ends of the map stand for everything.
    let picture = FieldPicture { range: Some((5e9, 6e9)), color_map: Some(ColorMap::Viridis), ..picture };
    plot_field(&run, &picture, &to).unwrap();
    assert!(count(&pixels(&to), ColorMap::Viridis.color(0.0)) > 5_000);
}

#[test]
fn outliers_do_not_stretch_the_bar() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunDirectory::create(&folder.path().join("run"), false).unwrap();
    let mut particles = Particles::new(1000);
    for i in 0..1000 {
        particles.position[i] = [1e-3 * (i % 40) as f64, 1e-3 * (i / 40) as f64, 0.0];
        particles.plastic_strain[i] = if i < 500 { 0.0 } else { 1.0 };
    }
    particles.plastic_strain[7] = 50.0;
    let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3] };
    let file = RunDirectory::frame_name(0, false);
    write_frame_file(&run.path().join(&file), &header, &particles, &["plastic_strain".to_owned()]).unwrap();
    write_series(&run, &[SeriesEntry { time: 0.0, file }]).unwrap();
    let to = folder.path().join("p.png");
    plot_field(&run, &FieldPicture { paper: HALF, ..FieldPicture::new("plastic_strain") }, &to).unwrap();
    // Half of the particles have the last colour, not the one at 1/50.
    let drawn = pixels(&to);
    assert!(count(&drawn, ColorMap::Viridis.color(1.0)) > 25_000);
    assert!(count(&drawn, ColorMap::Viridis.color(0.02)) < 1_250);
}

#[test]
fn a_problem_in_one_dimension_is_a_curve_for_each_frame() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 1);
    let to = folder.path().join("p.png");
    let frames = vec![FrameChoice::First, FrameChoice::Last];
    plot_field(&run, &FieldPicture { frames, size: Some((900, 500)), ..FieldPicture::new("pressure") }, &to).unwrap();
    let drawn = pixels(&to);
    assert_eq!((drawn.width(), drawn.height()), (900, 500));
    // The second curve covers the first; both are in the legend.
    assert!(count(&drawn, color::LINES[0]) > 20 && count(&drawn, color::LINES[1]) > 200);
}

#[test]
fn walls_of_one_dimension_stand_across_the_curve() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 1);
    let wall = |name: &str, point: &str, normal: i32, velocity: &str| {
        format!(
            "[[wall]]\nname = \"{name}\"\nplane = {{ point = [\"{point}\"], normal = [{normal}] }}\n\
             velocity = [\"{velocity}\"]\n"
        )
    };
    let deck =
        "dimensions = \"1d\"\n[particles]\nspacing = \"1 mm\"\n[time]\nend = \"1 us\"\n[[body]]\nname = \"bar\"\n\
                material = \"armco-iron\"\nshape = { box = { min = [\"0 mm\"], max = [\"20 mm\"] } }\n"
            .to_owned();
    let stands = wall("stands", "22 mm", -1, "0 m/s");
    let moves = wall("moves", "-2 mm", 1, "100 m/s");
    fs::write(run.deck(), deck + &stands + &moves + &wall("far", "-200 mm", 1, "0 m/s")).unwrap();
    let frames = vec![FrameChoice::First, FrameChoice::Last];
    let picture = FieldPicture { frames, size: Some((900, 500)), ..FieldPicture::new("pressure") };
    let drawn = |picture: &FieldPicture| {
        let page = field::draw_line(&seen(&run, picture), picture, "A bar between walls").unwrap();
        let mut places = Vec::new();
        for item in &page.items {
            let page::Item::Line { points, width: 2.5, .. } = item else { continue };
            assert!(points[0].0 == points[1].0 && (points[1].1 - points[0].1).abs() > 200.0, "{points:?}");
            places.push(points[0].0);
        }
        places
    };
    // One stands; the other is drawn where it was at either time, 1 mm apart.
    let places = drawn(&picture);
    let [stands, first, last] = places[..] else { panic!("{places:?}") };
    assert!(((last - first) / (stands - first) - 1.0 / 24.0).abs() < 1e-9, "{places:?}");
    assert_eq!(drawn(&FieldPicture { window: Some([(0.0, 0.01), (0.0, 0.0)]), ..picture }), [0.0; 0]);
}

#[test]
fn a_single_particle_without_size_is_drawn_or_refused_but_never_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    for (k, dimensions) in [1, 2, 3].into_iter().enumerate() {
        let run = RunDirectory::create(&folder.path().join(k.to_string()), false).unwrap();
        let header = FrameHeader { time: 0.0, step: 0, dimensions, body_spacing: vec![] };
        let file = RunDirectory::frame_name(0, false);
        write_frame_file(&run.path().join(&file), &header, &Particles::new(1), &["pressure".to_owned()]).unwrap();
        write_series(&run, &[SeriesEntry { time: 0.0, file }]).unwrap();
        let picture = FieldPicture { paper: COARSE, ..FieldPicture::new("pressure") };
        plot_field(&run, &picture, &folder.path().join("p.png")).unwrap();
    }
}

#[test]
fn several_frames_views_components_and_sections_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 3);
    let to = folder.path().join("p.png");
    let frames = vec![FrameChoice::First, FrameChoice::Index(1), FrameChoice::Time(2e-6)];
    for view in [None, Some(View::Xy), Some(View::Xz), Some(View::Yz)] {
        let picture = FieldPicture {
            frames: frames.clone(),
            view,
            section: Some(Section::Middle),
            paper: COARSE,
            ..FieldPicture::new("stress.xx")
        };
        plot_field(&run, &picture, &to).unwrap();
        assert!(pixels(&to).pixels().iter().any(|p| p.red() != p.green()), "{view:?}");
    }
}

#[test]
fn a_norm_is_the_length_of_the_vector() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("velocity")).unwrap();
    assert_eq!((scene.extent.extremes, scene.unit, scene.label.as_str()), ((5.0, 5.0), "m/s", "velocity (magnitude)"));
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("velocity.y")).unwrap();
    assert_eq!((scene.extent.extremes, scene.label.as_str()), ((4.0, 4.0), "velocity y"));
    // Pressure alone: the norm of -p I is sqrt(3) p.
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("stress")).unwrap();
    assert!((scene.extent.extremes.1 - 3f64.sqrt() * 1e9).abs() < 1e3);
}

#[test]
fn what_is_not_there_is_an_error_that_says_what_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let to = folder.path().join("p.png");
    for field in ["temperature", "velocity.q", "pressure.x"] {
        let error = plot_field(&run, &FieldPicture::new(field), &to).unwrap_err();
        let PlotError::Field { available, .. } = error else { panic!("{error}") };
        assert_eq!(available, "body, pressure, velocity, stress, displacement, speed, triaxiality");
    }
    for (field, question) in
        [("presure", "did you mean `pressure`? "), ("stress.q", ""), ("Velocity.x", "did you mean `velocity`? ")]
    {
        let error = plot_field(&run, &FieldPicture::new(field), &to).unwrap_err();
        let PlotError::Field { near, .. } = error else { panic!("{error}") };
        assert_eq!(near, question);
    }
    let late = FieldPicture { frames: vec![FrameChoice::Index(2)], ..FieldPicture::new("pressure") };
    let told = plot_field(&run, &late, &to).unwrap_err().to_string();
    assert!(told.ends_with("the run has frames 0 to 1"), "{told}");
    let tiny = FieldPicture { size: Some((100, 100)), ..FieldPicture::new("pressure") };
    assert!(matches!(plot_field(&run, &tiny, &to), Err(PlotError::Size { .. })));
    assert!(matches!(plot_columns(&run, &["time".into()], Paper::default(), &to), Err(PlotError::Output(_))));
    fs::write(run.series(), "<VTKFile><Collection/></VTKFile>").unwrap();
    assert!(matches!(plot_field(&run, &FieldPicture::new("pressure"), &to), Err(PlotError::Output(_))));
    assert!(!to.exists());
}

#[test]
fn usual_pictures_are_made_from_what_a_run_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    fs::write(run.history(), "time,kinetic_energy,energy_drift\n0,1,0\n1e-6,0.5,1e-9\n").unwrap();
    let names: Vec<_> = plot_run(&run, COARSE, PictureFormat::Png, &run.plots())
        .unwrap()
        .iter()
        .map(|file| file.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["pressure-last.png", "velocity-last.png", "pressure-before-after.png", "history-energy.png"]);
    plot_columns(&run, &["kinetic_energy".into()], Paper::default(), &folder.path().join("c.png")).unwrap();
    let error =
        plot_columns(&run, &["potential_energy".into()], Paper::default(), &folder.path().join("c.png")).unwrap_err();
    assert!(matches!(error, PlotError::Column { .. }));
    let slip =
        plot_columns(&run, &["kinetic_enery".into()], Paper::default(), &folder.path().join("c.png")).unwrap_err();
    let help = miette::Diagnostic::help(&slip).unwrap().to_string();
    assert!(help.starts_with("did you mean `kinetic_energy`? the history has: time, "), "{help}");
}

#[test]
fn frames_are_chosen_by_word_number_or_time() {
    for (text, choice) in [
        ("first", FrameChoice::First),
        ("last", FrameChoice::Last),
        ("12", FrameChoice::Index(12)),
        ("6e-5", FrameChoice::Time(6e-5)),
        ("12 us", FrameChoice::Time(1.2e-5)),
        ("0.5", FrameChoice::Time(0.5)),
    ] {
        assert_eq!(text.parse(), Ok(choice));
    }
    for negative in ["-1", "-2 us", "-0.5"] {
        let error = negative.parse::<FrameChoice>().unwrap_err();
        assert!(error.contains("count from zero"), "{negative}: {error}");
    }
    assert!("soon".parse::<FrameChoice>().is_err() && "inf".parse::<FrameChoice>().is_err());
    let error = "12 mm".parse::<FrameChoice>().unwrap_err();
    assert!(error.contains("found a length") && error.contains("60 us"), "{error}");
}

/// A plate of 20 by 2 mm with a hole of 4 mm, flight along -y.
const PERFORATED: &str = "dimensions = \"plane-strain\"\n[particles]\nspacing = \"1 mm\"\n[time]\nend = 1\n\
    [[body]]\nname = \"plate\"\nmaterial = \"armco-iron\"\n\
    shape = { box = { min = [\"-10 mm\", \"-1 mm\"], max = [\"10 mm\", \"1 mm\"] } }\n\
    [[measure]]\nname = \"hole\"\ncrater-diameter = { body = \"plate\", axis = \"y\", side = \"negative\" }\n";

#[test]
fn measures_are_lines_on_the_particles() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunDirectory::create(&folder.path().join("run"), false).unwrap();
    let mut particles = Particles::new(32);
    for i in 0..32 {
        let x = if i % 16 < 8 { -9.5 + (i % 16) as f64 } else { -5.5 + (i % 16) as f64 };
        particles.position[i] = [1e-3 * x, if i < 16 { -0.5e-3 } else { 0.5e-3 }, 0.0];
    }
    let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3] };
    let file = RunDirectory::frame_name(0, false);
    let fields = ["body".to_owned(), "pressure".to_owned()];
    write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
    write_series(&run, &[SeriesEntry { time: 0.0, file }]).unwrap();
    let to = folder.path().join("p.png");
    let picture = FieldPicture { measures: true, size: Some((900, 400)), ..FieldPicture::new("pressure") };
    assert!(matches!(plot_field(&run, &picture, &to), Err(PlotError::Deck(_))));
    fs::write(
        run.deck(),
        PERFORATED.replace(
            "crater-diameter = { body = \"plate\", axis = \"y\", side = \"negative\" }",
            "extent = { axis = \"x\" }",
        ),
    )
    .unwrap();
    assert!(matches!(plot_field(&run, &picture, &to), Err(PlotError::Empty { .. })));
    fs::write(run.deck(), PERFORATED).unwrap();
    let texts = |picture: &FieldPicture| {
        let page = field::particles(&seen(&run, picture), picture, "t").unwrap();
        page.texts().map(|text| text.text.clone()).collect::<Vec<_>>()
    };
    assert!(texts(&picture).contains(&"hole 4 mm".to_owned()), "{:?}", texts(&picture));
    assert!(!texts(&FieldPicture { measures: false, ..picture }).iter().any(|text| text.contains("hole")));
}

#[test]
fn runs_stand_side_by_side_at_one_scale() {
    let folder = tempfile::tempdir().unwrap();
    let runs: Vec<_> = ["a", "b"].map(|name| (name.to_owned(), run(&folder.path().join(name), 2))).into();
    let picture = FieldPicture { frames: vec![FrameChoice::First, FrameChoice::Last], ..FieldPicture::new("pressure") };
    let borrowed: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    let scene = scene::Scene::read(&borrowed, &picture).unwrap();
    let names: Vec<_> = scene.panels.iter().map(|panel| (panel.name.as_str(), panel.time)).collect();
    assert_eq!(names, [("a", 0.0), ("a", 1e-5), ("b", 0.0), ("b", 1e-5)]);
    let to = folder.path().join("p.png");
    plot_field_of_runs(&runs, &FieldPicture { size: Some((900, 700)), paper: HALF, ..picture }, &to).unwrap();
    // Each of the four panels shows the particle of the largest value.
    let drawn = pixels(&to);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let quarter = |p: &usize| (p % 450 < 225) == (x == 0) && (p / 450 < 175) == (y == 0);
        let [r, g, b] = ColorMap::Diverging.color(1.0);
        let color = |p: &tiny_skia::PremultipliedColorU8| (p.red(), p.green(), p.blue()) == (r, g, b);
        let found = drawn.pixels().iter().enumerate().filter(|(k, p)| quarter(k) && color(p)).count();
        assert!(found > 12, "{x} {y}: {found}");
    }
}

#[test]
fn a_field_that_is_one_or_zero_has_a_key_and_a_share() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunDirectory::create(&folder.path().join("run"), false).unwrap();
    let mut particles = Particles::new(400);
    for i in 0..400 {
        particles.position[i] = [1e-3 * (i % 20) as f64, 1e-3 * (i / 20) as f64, 0.0];
        particles.adapted[i] = u32::from(i >= 300);
    }
    let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3] };
    let file = RunDirectory::frame_name(0, false);
    write_frame_file(&run.path().join(&file), &header, &particles, &["adapted".to_owned()]).unwrap();
    write_series(&run, &[SeriesEntry { time: 0.0, file }]).unwrap();
    let picture = FieldPicture { paper: HALF, ..FieldPicture::new("adapted") };
    let scene = scene::Scene::read(&[("", &run)], &picture).unwrap();
    assert_eq!((scene.panels[0].mean, scene.flag), (0.25, Some(["kept", "searched"])));
    let to = folder.path().join("p.png");
    plot_field(&run, &picture, &to).unwrap();
    let drawn = pixels(&to);
    let (kept, searched) = (count(&drawn, [176, 190, 204]), count(&drawn, [213, 94, 0]));
    assert!((2.0..4.0).contains(&(kept as f64 / searched as f64)), "{kept} {searched}");
}

#[test]
fn runs_overlay_with_points_of_others() {
    let folder = tempfile::tempdir().unwrap();
    let beside = vec![("elements".to_owned(), vec![(0.0, 1.0), (1.0, 2.0)])];
    let to = folder.path().join("p.png");
    plot_overlay(&[], "strain", &beside, Paper::default(), &to).unwrap();
    // Squares have soft edges.
    let drawn = pixels(&to);
    let near = |p: &&tiny_skia::PremultipliedColorU8| {
        let [r, g, b] = color::LINES[0];
        p.red().abs_diff(r) < 90 && p.green().abs_diff(g) < 60 && p.blue().abs_diff(b) < 60
    };
    let found = drawn.pixels().iter().filter(near).count();
    assert!((30..200).contains(&found), "{found}");
    assert!(matches!(plot_overlay(&[], "strain", &[], Paper::default(), &to), Err(PlotError::Empty { .. })));
}

/// A deck of a quarter of a block that is 4 mm wide, 4 mm high and 8 mm deep, with planes of symmetry at x = 0 and y = 0.
const QUARTER: &str = "dimensions = \"3d\"\n[particles]\nspacing = \"1 mm\"\n[time]\nend = \"1 us\"\n\
    [[body]]\nname = \"block\"\nmaterial = \"armco-iron\"\n\
    shape = { box = { min = [\"0 mm\", \"0 mm\", \"0 mm\"], max = [\"2 mm\", \"2 mm\", \"8 mm\"] } }\n\
    [[symmetry]]\naxis = \"x\"\n[[symmetry]]\naxis = \"y\"\n\
    [[wall]]\nname = \"anvil\"\nplane = { point = [\"0 mm\", \"0 mm\", \"-1 mm\"], normal = [0, 0, 1] }\n\
    velocity = [\"0 m/s\", \"0 m/s\", \"100 m/s\"]\n";

/// The quarter at times 0 and 5 us: velocity along y grows with y from 0.5 to 1.5 m/s.
fn quarter(folder: &Path) -> RunDirectory {
    let run = RunDirectory::create(&folder.join("quarter"), false).unwrap();
    let mut particles = Particles::new(32);
    for i in 0..32 {
        let [x, y, z] = [i % 2, i / 2 % 2, i / 4].map(|k| 0.5 + k as f64);
        particles.position[i] = [1e-3 * x, 1e-3 * y, 1e-3 * z];
        particles.velocity[i] = [0.0, y, 0.0];
    }
    let fields = ["body", "velocity", "plastic_strain"].map(str::to_owned);
    let mut entries = Vec::new();
    for (k, time) in [0.0, 5e-6].into_iter().enumerate() {
        let header = FrameHeader { time, step: k as u64, dimensions: 3, body_spacing: vec![1e-3] };
        let file = RunDirectory::frame_name(k, false);
        write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
        entries.push(SeriesEntry { time, file });
    }
    write_series(&run, &entries).unwrap();
    fs::write(run.deck(), QUARTER).unwrap();
    run
}

fn seen(run: &RunDirectory, picture: &FieldPicture) -> scene::Scene {
    scene::Scene::read(&[("", run)], picture).unwrap()
}

#[test]
fn a_section_goes_through_the_plane_of_symmetry() {
    let folder = tempfile::tempdir().unwrap();
    let run = quarter(folder.path());
    let from_front =
        FieldPicture { view: Some(View::Xz), section: Some(Section::Middle), ..FieldPicture::new("velocity.y") };
    let scene = seen(&run, &from_front);
    // Towards the eye is -y: all of the quarter is behind its plane of symmetry, and its first layer shows.
    let panel = &scene.panels[0];
    let nearest = panel.marks.iter().map(|mark| mark.towards).fold(f64::NEG_INFINITY, f64::max);
    assert!((nearest + 0.5e-3).abs() < 1e-12 && panel.marks.len() == 32 && panel.count == 32);
    assert!(panel.marks.iter().all(|mark| mark.value > 0.0));
    // From the other side, +x, the quarter is before its plane: its image behind it is seen.
    let scene = seen(&run, &FieldPicture { view: Some(View::Yz), ..from_front.clone() });
    let nearest = scene.panels[0].marks.iter().map(|mark| mark.towards).fold(f64::NEG_INFINITY, f64::max);
    assert!((nearest + 0.5e-3).abs() < 1e-12 && scene.panels[0].marks.len() == 32);
    // From a corner, a long body is cut along its length.
    let scene = seen(&run, &FieldPicture { view: Some(View::Corner { up: Some(1) }), ..from_front.clone() });
    assert_eq!(scene.panels[0].marks.len(), 32);
    // Without a plane of symmetry it goes through the middle.
    let fine = from_front.clone();
    fs::write(run.deck(), QUARTER.replace("[[symmetry]]\naxis = \"y\"\n", "")).unwrap();
    assert_eq!(seen(&run, &fine).panels[0].marks.len(), 16);
}

#[test]
fn a_quarter_is_shown_whole_with_the_signs_of_its_images() {
    let folder = tempfile::tempdir().unwrap();
    let run = quarter(folder.path());
    let whole = FieldPicture { mirror: Some(Mirror::Halving), ..FieldPicture::new("velocity.y") };
    let scene = seen(&run, &whole);
    assert_eq!((scene.panels[0].marks.len(), scene.panels[0].count), (128, 32));
    assert_eq!(scene.extent.extremes, (-1.5, 1.5));
    let cut = seen(&run, &FieldPicture { section: Some(Section::Middle), view: Some(View::Xz), ..whole.clone() });
    assert_eq!((cut.panels[0].marks.len(), cut.panels[0].count), (64, 32));
    // Seen from +x only images are left: they count as the particles they are of.
    let cut = seen(&run, &FieldPicture { section: Some(Section::Middle), view: Some(View::Yz), ..whole.clone() });
    assert_eq!((cut.panels[0].marks.len(), cut.panels[0].count), (64, 32));
    fs::write(run.deck(), QUARTER.replace("[[symmetry]]\naxis = \"x\"\n[[symmetry]]\naxis = \"y\"\n", "")).unwrap();
    assert!(matches!(plot_field(&run, &whole, &folder.path().join("p.png")), Err(PlotError::Mirror { .. })));
}

#[test]
fn walls_of_the_deck_stand_in_the_picture_where_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let run = quarter(folder.path());
    let frames = vec![FrameChoice::First, FrameChoice::Last];
    let picture = FieldPicture { frames, view: Some(View::Xz), ..FieldPicture::new("velocity") };
    let scene = seen(&run, &picture);
    let heights = scene.panels.iter().map(|panel| match panel.walls[..] {
        [walls::PlacedWall::Line { point, normal: [0.0, 1.0] }] => point[1],
        ref other => panic!("{other:?}"),
    });
    // 100 m/s for 5 us.
    assert!(heights.zip([-1e-3, -0.5e-3]).all(|(found, expected)| (found - expected).abs() < 1e-12));
    assert!((scene.extent.window[1].0 + 1e-3).abs() < 1e-12, "the picture reaches the wall");
    let corner = seen(&run, &FieldPicture { view: None, ..picture });
    assert!(corner.panels.iter().all(|panel| panel.walls.len() == 1 && panel.walls[0].is_behind()));
    // A deck that cannot be read takes the walls, not the picture.
    fs::write(run.deck(), "nonsense").unwrap();
    assert!(seen(&run, &FieldPicture::new("velocity")).panels[0].walls.is_empty());
}

#[test]
fn no_text_of_a_picture_of_particles_leaves_the_page_or_covers_another() {
    let folder = tempfile::tempdir().unwrap();
    let (flat, deep) = (run(&folder.path().join("flat"), 2), quarter(folder.path()));
    let title = "A title of a run that goes on and on until it fits no page, with_a_word_that_is_longer_than_the_narrowest_page_of_all";
    let frames = [vec![FrameChoice::Last], vec![FrameChoice::First, FrameChoice::Last, FrameChoice::Last]];
    // Axes that begin and end with a number, 0 and 10 mm: neighbours have theirs side by side.
    let side = 10e-3 / 1.08;
    let to_the_edge = Some([(0.04 * side, 1.04 * side); 2]);
    let slim = Some([(0.0, 1e-4), (0.0, 2e-2)]);
    for (run, field) in [(&flat, "pressure"), (&flat, "velocity"), (&deep, "velocity.y"), (&deep, "plastic_strain")] {
        for (frames, view) in frames.iter().zip([None, Some(View::Xz)]) {
            for (window, range) in [(None, None), (slim, Some((0.1, 0.100_001))), (to_the_edge, None)] {
                for width in [None, Some(0.085), Some(0.099), Some(0.2)] {
                    // Particles on few pixels: texts are what counts.
                    let paper = Paper { dpi: 10, width };
                    let frames = frames.clone();
                    let picture = FieldPicture { frames, view, window, range, paper, ..FieldPicture::new(field) };
                    let page = field::particles(&seen(run, &picture), &picture, title).unwrap();
                    let faults = page::misplaced(&page);
                    assert!(faults.is_empty(), "{field} {view:?} {window:?} {width:?}: {faults:#?}");
                }
            }
        }
    }
}

#[test]
fn one_value_everywhere_is_said_and_leaves_shape_to_be_seen() {
    let folder = tempfile::tempdir().unwrap();
    let run = quarter(folder.path());
    let picture = FieldPicture { paper: COARSE, ..FieldPicture::new("plastic_strain") };
    let page = field::particles(&seen(&run, &picture), &picture, "t").unwrap();
    let texts: Vec<_> = page.texts().map(|text| text.text.as_str()).collect();
    assert!(texts.contains(&"0 everywhere") && texts.contains(&"plastic strain"), "{texts:?}");
    let to = folder.path().join("p.png");
    plot_field(&run, &picture, &to).unwrap();
    let mut shades: Vec<_> = pixels(&to).pixels().iter().map(|p| p.green()).collect();
    shades.sort_unstable();
    shades.dedup();
    assert!(shades.len() > 40, "{} shades", shades.len());
    // A range that is asked for is a bar.
    let picture = FieldPicture { range: Some((0.0, 1.0)), ..picture };
    let page = field::particles(&seen(&run, &picture), &picture, "t").unwrap();
    assert!(!page.texts().any(|text| text.text.contains("everywhere")));
}

#[test]
fn frames_by_themselves_and_moving_have_one_page_and_scale() {
    let folder = tempfile::tempdir().unwrap();
    for dimensions in [1, 2] {
        let run = run(&folder.path().join(dimensions.to_string()), dimensions);
        let picture = FieldPicture { frames: Vec::new(), paper: COARSE, ..FieldPicture::new("pressure") };
        let to = folder.path().join("moving.png");
        animate_field(&run, &picture, 1.0, &to).unwrap();
        let reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(&to).unwrap())).read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 2);
        let name = |k: usize| folder.path().join(format!("{dimensions}-{k}.svg"));
        assert_eq!(plot_each_frame(&run, &picture, name).unwrap(), [name(0), name(1)]);
        let size = |k: usize| {
            let text = fs::read_to_string(name(k)).unwrap();
            let document = roxmltree::Document::parse(&text).unwrap();
            document.root_element().attribute("viewBox").unwrap().to_owned()
        };
        assert_eq!(size(0), size(1));
        // Frames of other places and values than the last: axes and colours are still the same for all.
        let numbers = |k: usize| {
            let text = fs::read_to_string(name(k)).unwrap();
            let document = roxmltree::Document::parse(&text).unwrap();
            let texts = document.descendants().filter(|node| node.has_tag_name("text"));
            texts
                .map(|node| node.text().unwrap_or_default().to_owned())
                .filter(|text| !text.contains("particles"))
                .collect::<Vec<_>>()
        };
        let header = FrameHeader { time: 0.0, step: 0, dimensions, body_spacing: vec![1e-3] };
        let mut other = Particles::new(2);
        other.position[1] = [1e-3, 0.0, 0.0];
        let first = run.path().join(RunDirectory::frame_name(0, false));
        write_frame_file(&first, &header, &other, &["pressure".to_owned()]).unwrap();
        plot_each_frame(&run, &picture, name).unwrap();
        if dimensions == 2 {
            assert!(numbers(0) == numbers(1) && numbers(0).len() > 10, "{:?} {:?}", numbers(0), numbers(1));
        }
        let picture = FieldPicture { frames: vec![FrameChoice::Last], ..picture };
        assert_eq!(plot_each_frame(&run, &picture, name).unwrap(), [name(1)]);
    }
}

#[test]
fn curves_of_several_runs_share_a_chart_for_each_column() {
    let folder = tempfile::tempdir().unwrap();
    let runs: Vec<_> = ["a", "b"]
        .map(|name| {
            let run = run(&folder.path().join(name), 2);
            fs::write(run.history(), "time,height,width\n0,1,2\n1e-6,0.5,3\n").unwrap();
            (name.to_owned(), run)
        })
        .into();
    let borrowed: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    let columns = ["height", "width"].map(str::to_owned);
    let charts = ColumnsPicture { columns: columns.to_vec(), ..ColumnsPicture::default() }.charts(&borrowed).unwrap();
    let found: Vec<_> = charts
        .iter()
        .map(|chart| {
            (chart.quantity.as_str(), chart.curves.iter().map(|curve| curve.name.as_str()).collect::<Vec<_>>())
        })
        .collect();
    assert_eq!(found, [("height", vec!["a", "b"]), ("width", vec!["a", "b"])]);
    let to = folder.path().join("c.svg");
    plot_columns_of_runs(&runs, &columns, Paper { dpi: 100, width: Some(0.085) }, &to).unwrap();
    assert!(fs::read_to_string(&to).unwrap().contains("width=\"3.3465in\""));
    let missing = plot_columns_of_runs(&runs, &["depth".to_owned()], Paper::default(), &to);
    assert!(matches!(missing, Err(PlotError::Column { .. })));
}

/// A block of ten by ten particles a millimetre apart in two bodies, stretched four times along x and as much thinner, whose frames have the
/// deformation gradient or not.
fn stretched(folder: &Path, fields: &[&str]) -> RunDirectory {
    let run = RunDirectory::create(folder, false).unwrap();
    let body = |name: &str, low: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"armco-iron\"\n\
             shape = {{ box = {{ min = [0, \"{low} mm\"], max = [\"10 mm\", \"{} mm\"] }} }}\n",
            low + 5
        )
    };
    let head = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 us\" }\n";
    fs::write(run.deck(), format!("{head}{}{}", body("lower", 0), body("upper", 5))).unwrap();
    let mut particles = Particles::new(100);
    particles.deformation = vec![[[4.0, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 1.0]]; 100];
    for i in 0..100 {
        let [x, y] = [(i % 10) as f64 + 0.5, (i / 10) as f64 + 0.5];
        particles.position[i] = [4e-3 * x, 0.25e-3 * y, 0.0];
        particles.body[i] = u32::from(i >= 50);
    }
    let fields: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
    let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3, 1e-3] };
    let bodies = ["lower", "upper"].map(|name| crate::output::FrameBody { name: name.into(), material: "iron".into() });
    let writer = crate::output::FrameWriter { bodies: bodies.into(), is_compressed: true };
    let file = RunDirectory::frame_name(0, false);
    let mut content = std::io::Cursor::new(Vec::new());
    writer.write(&mut content, &header, &particles, &fields).unwrap();
    fs::create_dir_all(run.path().join("fields")).unwrap();
    fs::write(run.path().join(&file), content.into_inner()).unwrap();
    write_series(&run, &[SeriesEntry { time: 0.0, file }]).unwrap();
    run
}

#[test]
fn stretched_metal_is_drawn_whole_and_no_larger_than_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("p.png");
    // Most of the white on the page is around the block: what changes is the paper seen between its particles.
    let covered = |name: &str, fields: &[&str]| {
        let run = stretched(&folder.path().join(name), fields);
        let window = Some([(0.0, 0.04), (0.0, 0.0025)]);
        let picture = FieldPicture { window, size: Some((900, 300)), ..FieldPicture::new("body") };
        plot_field(&run, &picture, &to).unwrap();
        let page = field::particles(&seen(&run, &picture), &picture, "t").unwrap();
        let image = page.items.iter().find_map(|item| match item {
            page::Item::Image(image) if image.columns > 300 => Some(image.clone()),
            _ => None,
        });
        let image = image.unwrap();
        let opaque = image.pixels.iter().filter(|pixel| pixel[3] > 127).count();
        opaque as f64 / image.pixels.len() as f64
    };
    let whole = covered("known", &["body", "deformation_gradient"]);
    let balls = covered("unknown", &["body"]);
    // The window has a rim of 4 % of its width: 2.5 of 5.7 mm are the block, 40 of 43.2 mm.
    let exact = 2.5 / 5.7 * 40.0 / 43.2;
    // The outline adds two thirds of a pixel on either side; what fills gaps would add 0.4 mm if it were left.
    assert!((whole - exact).abs() < 0.08 * exact, "{whole} {exact}");
    assert!(balls < 0.8 * exact, "{balls} {exact}");
}

#[test]
fn bodies_are_named_in_a_key_of_their_colours() {
    let folder = tempfile::tempdir().unwrap();
    let run = stretched(&folder.path().join("run"), &["body", "deformation_gradient"]);
    let picture = FieldPicture::new("body");
    let page = field::particles(&seen(&run, &picture), &picture, "t").unwrap();
    let texts: Vec<_> = page.texts().map(|text| text.text.as_str()).collect();
    assert!(texts.contains(&"body") && texts.contains(&"lower") && texts.contains(&"upper"), "{texts:?}");
    let fills = page.items.iter().filter_map(|item| match item {
        page::Item::Polygon { color, .. } => Some(*color),
        _ => None,
    });
    let colors: Vec<_> = fills.collect();
    assert!(colors.contains(&color_bar::SINGLE_COLOR) && colors.len() == 2 && colors[0] != colors[1], "{colors:?}");
    // Those that are left out have no name either.
    let alone = FieldPicture { bodies: vec!["upper".to_owned()], ..picture.clone() };
    let page = field::particles(&seen(&run, &alone), &alone, "t").unwrap();
    let texts: Vec<_> = page.texts().map(|text| text.text.as_str()).collect();
    assert!(texts.contains(&"upper") && !texts.contains(&"lower"), "{texts:?}");
    // Half of the block has one, half the other.
    let to = folder.path().join("p.png");
    plot_field(&run, &picture, &to).unwrap();
    let drawn = pixels(&to);
    let [lower, upper] = [colors[0], colors[1]].map(|color| count(&drawn, color));
    assert!(lower > 5000 && upper.abs_diff(lower) < lower / 5, "{lower} {upper}");
}

#[test]
fn particles_are_chosen_by_conditions_and_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let condition = |field: &str, is_above, bound| Condition { field: field.to_owned(), is_above, bound };
    let of = |conditions: Vec<Condition>| {
        scene::Scene::read(&[("", &run)], &FieldPicture { conditions, ..FieldPicture::new("pressure") })
    };
    let scene = of(vec![condition("pressure", true, 0.0)]).unwrap();
    assert_eq!((scene.panels[0].count, scene.extent.extremes.0 > 0.0), (100, true));
    // Of several all hold; a field need not be the one that is drawn, and a vector counts by its norm.
    let both = vec![condition("pressure", true, 0.0), condition("pressure", false, 0.5e9)];
    assert_eq!(of(both).unwrap().panels[0].count, 50);
    assert_eq!(of(vec![condition("velocity", true, 4.9)]).unwrap().panels[0].count, 200);
    let none = of(vec![condition("velocity.x", true, 3.1)]).unwrap_err();
    assert!(none.to_string().contains("no particle meets the conditions"), "{none}");
    assert!(matches!(of(vec![condition("strain", true, 0.0)]).unwrap_err(), PlotError::Field { .. }));
    let bodies = vec!["plate".to_owned()];
    let error = scene::Scene::read(&[("", &run)], &FieldPicture { bodies, ..FieldPicture::new("pressure") });
    assert!(matches!(error.unwrap_err(), PlotError::Body { .. }));
}

#[test]
fn what_frames_lack_is_computed_from_what_they_have() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    // The last frame has gone 3 mm along x and 4 mm along y, and has no stress but pressure.
    let mut particles = Particles::new(200);
    for i in 0..200 {
        particles.position[i] = [1e-3 * (i % 20) as f64 + 3e-3, 1e-3 * (i / 20) as f64 + 4e-3, 1e-4 * i as f64];
        particles.deviator[i].xx = 2e6;
        (particles.deviator[i].yy, particles.deviator[i].zz) = (-1e6, -1e6);
        particles.pressure[i] = -1e6;
    }
    let header = FrameHeader { time: 1e-5, step: 1, dimensions: 2, body_spacing: vec![1e-3] };
    let fields = ["body", "stress"].map(str::to_owned);
    write_frame_file(&run.path().join(RunDirectory::frame_name(1, false)), &header, &particles, &fields).unwrap();
    for (field, value, unit) in
        [("displacement", 5e-3, "m"), ("displacement.y", 4e-3, "m"), ("triaxiality", 1.0 / 3.0, "")]
    {
        let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new(field)).unwrap();
        let (low, high) = scene.extent.extremes;
        assert!((low / value - 1.0).abs() < 1e-6 && (high / value - 1.0).abs() < 1e-6, "{field} {low} {high}");
        assert_eq!(scene.unit, unit);
    }
}

#[test]
fn a_section_leaves_the_side_of_the_eye_out_and_cuts_cells() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 3);
    let count = |section: Section, view: View| {
        let picture = FieldPicture { section: Some(section), view: Some(view), ..FieldPicture::new("pressure") };
        scene::Scene::read(&[("", &run)], &picture).unwrap().panels[0].count
    };
    // Columns at 0 to 19 mm: ten of them are left of 9.5 mm.
    let across = |x: f64, point: f64| Section::Across { normal: [x, 0.0, 0.0], point: Some([point, 0.0, 0.0]) };
    let from = |x: f64| View::From { direction: [x, 0.2, 0.1], up: Some(1) };
    assert_eq!(count(across(1.0, 9.5e-3), from(1.0)), 100);
    assert_eq!(count(across(-5.0, 4.5e-3), from(1.0)), 50);
    assert_eq!(count(across(1.0, 4.5e-3), from(-1.0)), 150);
    assert_eq!(count(across(1.0, 19.4e-3), from(1.0)), 200);
    // Beside the body, on either side.
    for (x, point) in [(1.0, 20.5e-3), (-1.0, 60e-3), (1.0, -0.6e-3)] {
        let picture = FieldPicture { section: Some(across(x, point)), ..FieldPicture::new("pressure") };
        let error = plot_field(&run, &picture, &folder.path().join("p.png")).unwrap_err();
        assert!(error.to_string().ends_with("(x), and the bodies are between −500 µm and 19.5 mm"), "{error}");
        let animated = animate_field(&run, &picture, 1.0, &folder.path().join("p.png")).unwrap_err();
        assert_eq!(animated.to_string(), error.to_string());
    }
}

#[test]
fn a_picture_of_some_of_the_particles_says_of_how_many() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 3);
    let told = |picture: FieldPicture| {
        let page = field::particles(&seen(&run, &picture), &picture, "t").unwrap();
        page.texts().map(|text| text.text.replace('\u{a0}', " ")).find(|text| text.contains("particles")).unwrap()
    };
    let all = FieldPicture::new("pressure");
    let half = Section::Across { normal: [1.0, 0.0, 0.0], point: Some([9.5e-3, 0.0, 0.0]) };
    let view = Some(View::From { direction: [1.0, 0.2, 0.1], up: Some(1) });
    assert!(told(all.clone()).ends_with(",  200 particles"), "{}", told(all.clone()));
    let cut = told(FieldPicture { section: Some(half), view, ..all });
    assert!(cut.ends_with(",  100 of 200 particles"), "{cut}");
}

#[test]
fn standard_pictures_of_heat_alone_are_of_the_temperature() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let mut particles = Particles::new(4);
    (0..4).for_each(|i| particles.position[i] = [1e-3 * i as f64, 0.0, 0.0]);
    let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3] };
    let fields = ["plastic_strain", "pressure", "temperature", "velocity"].map(str::to_owned);
    for k in 0..2 {
        write_frame_file(&run.path().join(RunDirectory::frame_name(k, false)), &header, &particles, &fields).unwrap();
    }
    fs::write(run.history(), "time\n0\n").unwrap();
    let drawn = |thermal: &str| {
        let deck = format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n{thermal}\n\
             [material.ofhc-copper]\nconductivity = 400\n[[body]]\nname = \"b\"\nmaterial = \"ofhc-copper\"\n\
             shape = {{ box = {{ min = [0, 0], max = [\"4 mm\", \"1 mm\"] }} }}\n"
        );
        fs::write(run.deck(), deck).unwrap();
        let files = plot_run(&run, COARSE, PictureFormat::Png, &folder.path().join("plots")).unwrap();
        files.iter().map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(drawn("thermal = { mechanics = false }"), ["temperature-last", "temperature-before-after"]);
    assert_eq!(drawn("")[0], "plastic_strain-last");
}

#[test]
fn standard_pictures_of_what_breaks_show_its_damage_or_else_its_integrity() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    fs::write(run.history(), "time\n0\n").unwrap();
    let mut particles = Particles::new(4);
    (0..4).for_each(|i| particles.position[i] = [1e-3 * i as f64, 0.0, 0.0]);
    for name in ["damage", "integrity"] {
        particles.set_column(name, &Column::Scalar(vec![0.0, 0.25, 0.5, 1.0].into()));
    }
    let drawn = |broken: &[&str]| {
        let header = FrameHeader { time: 0.0, step: 0, dimensions: 2, body_spacing: vec![1e-3] };
        let fields: Vec<String> = ["velocity"].iter().chain(broken).map(|name| (*name).to_owned()).collect();
        for k in 0..2 {
            let file = run.path().join(RunDirectory::frame_name(k, false));
            write_frame_file(&file, &header, &particles, &fields).unwrap();
        }
        let files = plot_run(&run, COARSE, PictureFormat::Png, &folder.path().join("plots")).unwrap();
        let names = files.iter().map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned());
        names.collect::<Vec<_>>()
    };
    assert_eq!(drawn(&["integrity", "damage"]), ["velocity-last", "damage-last", "velocity-before-after"]);
    assert_eq!(drawn(&["integrity"]), ["velocity-last", "integrity-last", "velocity-before-after"]);
}

#[test]
fn a_section_along_the_plane_of_a_problem_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("p.png");
    let runs = [1, 2, 3].map(|dimensions| run(&folder.path().join(dimensions.to_string()), dimensions));
    let cut = |dimensions: usize, section: Section, frames: Vec<FrameChoice>| {
        let run = &runs[dimensions - 1];
        let picture = FieldPicture { section: Some(section), frames, paper: COARSE, ..FieldPicture::new("pressure") };
        let moving = animate_field(run, &picture, 1.0, &to);
        (matches!(plot_field(run, &picture, &to), Err(PlotError::FlatSection)), moving.is_err())
    };
    let across = |normal: [f64; 3]| Section::Across { normal, point: None };
    let both = || vec![FrameChoice::First, FrameChoice::Last];
    for dimensions in [1, 2] {
        assert_eq!(cut(dimensions, Section::Middle, both()), (true, true), "{dimensions}");
    }
    assert_eq!(cut(2, across([0.0, 0.0, 2.0]), both()), (true, true));
    assert_eq!(cut(2, across([1.0, 0.0, 0.0]), both()), (false, false));
    assert_eq!(cut(3, Section::Middle, both()), (false, false));
}

/// Two bodies of six by six by three particles a millimetre apart on top of each other, the upper one pushed a quarter of a millimetre into the lower one.
/// Particles and their gradients are a little beside where a smooth field has them.
fn pressed(folder: &Path) -> RunDirectory {
    let run = RunDirectory::create(folder, false).unwrap();
    let body = |name: &str, low: u32| {
        let (low, high) = (format!("[0, 0, \"{low} mm\"]"), format!("[\"6 mm\", \"6 mm\", \"{} mm\"]", low + 3));
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"armco-iron\"\nshape = {{ box = {{ min = {low}, max = {high} }} }}\n"
        )
    };
    let head = "dimensions = \"3d\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 us\" }\n";
    fs::write(run.deck(), format!("{head}{}{}", body("lower", 0), body("upper", 3))).unwrap();
    let bodies = ["lower", "upper"].map(|name| crate::output::FrameBody { name: name.into(), material: "iron".into() });
    let writer = crate::output::FrameWriter { bodies: bodies.into(), is_compressed: true };
    let fields = ["body", "deformation_gradient", "plastic_strain"].map(str::to_owned);
    fs::create_dir_all(run.path().join("fields")).unwrap();
    let mut entries = Vec::new();
    let filled = crate::geometry::fill(&crate::deck::load_model(&run.deck()).unwrap(), 1e6).unwrap();
    let mut particles = Particles::new(filled.position.len());
    (particles.position, particles.body) = (filled.position, filled.body);
    for k in 0..2 {
        particles.deformation = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; particles.position.len()];
        for i in 0..particles.position.len() {
            if k == 0 {
                continue;
            }
            particles.position[i][2] -= if particles.body[i] == 1 { 0.25e-3 } else { 0.0 };
            for a in 0..3 {
                let beside = (12.9 * (3 * i + a) as f64).sin();
                particles.position[i][a] += 0.06e-3 * beside;
                particles.deformation[i][a][(a + 1) % 3] += 0.08 * beside;
            }
        }
        let (time, file) = (1e-6 * k as f64, RunDirectory::frame_name(k, false));
        let header = FrameHeader { time, step: k as u64, dimensions: 3, body_spacing: vec![1e-3, 1e-3] };
        let mut content = std::io::Cursor::new(Vec::new());
        writer.write(&mut content, &header, &particles, &fields).unwrap();
        fs::write(run.path().join(&file), content.into_inner()).unwrap();
        entries.push(SeriesEntry { time, file });
    }
    write_series(&run, &entries).unwrap();
    run
}

/// The particles of a picture, and pixels of its image of a millimetre.
fn drawn(run: &RunDirectory, picture: &FieldPicture) -> (page::Image, f64) {
    let scene = seen(run, picture);
    let [(left, right), _] = scene.extent.window;
    let page = field::particles(&scene, picture, "t").unwrap();
    let images = page.items.iter().filter_map(|item| match item {
        page::Item::Image(image) => Some(image.clone()),
        _ => None,
    });
    let image = images.max_by_key(|image| image.pixels.len()).unwrap();
    let wide = 1e3 * (right - left) * 1.08;
    let pixels = image.columns as f64 / wide;
    (image, pixels)
}

#[test]
fn a_section_has_the_colours_of_the_bar_alone() {
    let folder = tempfile::tempdir().unwrap();
    let run = pressed(&folder.path().join("run"));
    // Between layers, within one, and in one that is nearly at the faces of cells.
    for place in [3.0e-3, 2.5e-3, 2.97e-3, 3.04e-3] {
        let section = Section::Across { normal: [0.0, 1.0, 0.0], point: Some([0.0, place, 0.0]) };
        let of = |field: &str, bodies: &[&str]| FieldPicture {
            view: Some(View::Xz),
            section: Some(section),
            bodies: bodies.iter().map(|name| (*name).to_owned()).collect(),
            window: Some([(0.5e-3, 5.5e-3), (0.5e-3, 5.0e-3)]),
            size: Some((600, 600)),
            range: (field != "body").then_some((0.0, 1.0)),
            ..FieldPicture::new(field)
        };
        // One body with one value has one colour wherever it is cut.
        let (image, fine) = drawn(&run, &of("plastic_strain", &["lower"]));
        let rows = image.pixels.chunks_exact(image.columns);
        let lowest = rows.rev().take((2.0 * fine) as usize);
        let colors: std::collections::HashSet<[u8; 4]> = lowest.flatten().copied().collect();
        assert_eq!(colors.len(), 1, "{place}: {colors:?}");
        // Where bodies overlap the one ends where the other begins, at one height.
        let (image, fine) = drawn(&run, &of("body", &[]));
        let [lower, upper] = [0, 1].map(|k| {
            let [r, g, b] = color_bar::body_color(k);
            [r, g, b, 255]
        });
        let heights: Vec<(usize, usize)> = (0..image.columns)
            .map(|x| {
                let column: Vec<[u8; 4]> = (0..image.rows).map(|y| image.pixels[y * image.columns + x]).collect();
                let last = column.iter().rposition(|color| *color == upper).unwrap();
                (last, column.iter().position(|color| *color == lower).unwrap())
            })
            .collect();
        assert!(
            heights.iter().all(|(last, first)| last < first),
            "{place}: one body pokes into the other: {heights:?}"
        );
        let (highest, deepest) =
            heights.iter().fold((usize::MAX, 0), |(low, high), (last, _)| (low.min(*last), high.max(*last)));
        assert!(((deepest - highest) as f64) < 0.3 * fine, "{place}: {highest} to {deepest}, {fine}");
    }
}
