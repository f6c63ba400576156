//! Pictures of runs written by hand.

use super::*;
use crate::{
    Particles,
    output::{FrameHeader, RunDirectory, SeriesEntry, write_frame_file, write_series},
};
use std::{fs, path::Path};

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
        let file = RunDirectory::frame_name(k);
        write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
        entries.push(SeriesEntry { time, file });
    }
    write_series(&run.series(), &entries).unwrap();
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
    let picture = FieldPicture { size: Some((800, 500)), ..FieldPicture::new("pressure") };
    plot_field(&run, &picture, &to).unwrap();
    let drawn = pixels(&to);
    assert_eq!((drawn.width(), drawn.height()), (800, 500));
    // Both signs: diverging, the ends at the two ends of the lattice.
    for end in [0.0, 1.0] {
        assert!(count(&drawn, ColorMap::Diverging.color(end)) > 500);
    }
    // Beyond a given range the ends of the map stand for everything.
    let picture = FieldPicture { range: Some((5e9, 6e9)), color_map: Some(ColorMap::Viridis), ..picture };
    plot_field(&run, &picture, &to).unwrap();
    assert!(count(&pixels(&to), ColorMap::Viridis.color(0.0)) > 20_000);
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
    let file = RunDirectory::frame_name(0);
    write_frame_file(&run.path().join(&file), &header, &particles, &["plastic_strain".to_owned()]).unwrap();
    write_series(&run.series(), &[SeriesEntry { time: 0.0, file }]).unwrap();
    let to = folder.path().join("p.png");
    plot_field(&run, &FieldPicture::new("plastic_strain"), &to).unwrap();
    // Half of the particles have the last colour, not the one at 1/50.
    let drawn = pixels(&to);
    assert!(count(&drawn, ColorMap::Viridis.color(1.0)) > 100_000);
    assert!(count(&drawn, ColorMap::Viridis.color(0.02)) < 5_000);
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
fn a_single_particle_without_size_is_drawn_or_refused_but_never_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    for (k, dimensions) in [1, 2, 3].into_iter().enumerate() {
        let run = RunDirectory::create(&folder.path().join(k.to_string()), false).unwrap();
        let header = FrameHeader { time: 0.0, step: 0, dimensions, body_spacing: vec![] };
        let file = RunDirectory::frame_name(0);
        write_frame_file(&run.path().join(&file), &header, &Particles::new(1), &["pressure".to_owned()]).unwrap();
        write_series(&run.series(), &[SeriesEntry { time: 0.0, file }]).unwrap();
        plot_field(&run, &FieldPicture::new("pressure"), &folder.path().join("p.png")).unwrap();
    }
}

#[test]
fn several_frames_views_components_and_sections_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 3);
    let to = folder.path().join("p.png");
    let frames = vec![FrameChoice::First, FrameChoice::Index(1), FrameChoice::Time(2e-6)];
    for view in [None, Some(View::Xy), Some(View::Xz), Some(View::Yz)] {
        let picture = FieldPicture { frames: frames.clone(), view, section: true, ..FieldPicture::new("stress.xx") };
        plot_field(&run, &picture, &to).unwrap();
        assert!(pixels(&to).pixels().iter().any(|p| p.red() != p.green()), "{view:?}");
    }
}

#[test]
fn a_norm_is_the_length_of_the_vector() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("velocity")).unwrap();
    assert_eq!((scene.extremes, scene.unit, scene.label.as_str()), ((5.0, 5.0), "m/s", "magnitude of velocity"));
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("velocity.y")).unwrap();
    assert_eq!((scene.extremes, scene.label.as_str()), ((4.0, 4.0), "velocity y"));
    // Pressure alone: the norm of -p I is sqrt(3) p.
    let scene = scene::Scene::read(&[("", &run)], &FieldPicture::new("stress")).unwrap();
    assert!((scene.extremes.1 - 3f64.sqrt() * 1e9).abs() < 1e3);
}

#[test]
fn what_is_not_there_is_an_error_that_says_what_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    let to = folder.path().join("p.png");
    for field in ["temperature", "velocity.q", "pressure.x"] {
        let error = plot_field(&run, &FieldPicture::new(field), &to).unwrap_err();
        let PlotError::Field { available, .. } = error else { panic!("{error}") };
        assert_eq!(available, "body, pressure, velocity, stress");
    }
    let late = FieldPicture { frames: vec![FrameChoice::Index(2)], ..FieldPicture::new("pressure") };
    assert!(matches!(plot_field(&run, &late, &to), Err(PlotError::Empty { .. })));
    let tiny = FieldPicture { size: Some((100, 100)), ..FieldPicture::new("pressure") };
    assert!(matches!(plot_field(&run, &tiny, &to), Err(PlotError::Size { .. })));
    assert!(matches!(plot_columns(&run, &["time".into()], &to), Err(PlotError::Output(_))));
    fs::write(run.series(), "<VTKFile><Collection/></VTKFile>").unwrap();
    assert!(matches!(plot_field(&run, &FieldPicture::new("pressure"), &to), Err(PlotError::Output(_))));
    assert!(!to.exists());
}

#[test]
fn usual_pictures_are_made_from_what_a_run_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), 2);
    fs::write(run.history(), "time,kinetic_energy,energy_drift\n0,1,0\n1e-6,0.5,1e-9\n").unwrap();
    let names: Vec<_> =
        plot_run(&run).unwrap().iter().map(|file| file.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    assert_eq!(names, ["pressure-last.png", "velocity-last.png", "pressure-before-after.png", "history-energy.png"]);
    plot_columns(&run, &["kinetic_energy".into()], &folder.path().join("c.png")).unwrap();
    let error = plot_columns(&run, &["potential_energy".into()], &folder.path().join("c.png")).unwrap_err();
    assert!(matches!(error, PlotError::Column { .. }));
}

#[test]
fn frames_are_chosen_by_word_number_or_time() {
    for (text, choice) in [
        ("first", FrameChoice::First),
        ("last", FrameChoice::Last),
        ("12", FrameChoice::Index(12)),
        ("6e-5", FrameChoice::Time(6e-5)),
        ("0.5", FrameChoice::Time(0.5)),
    ] {
        assert_eq!(text.parse(), Ok(choice));
    }
    assert!("soon".parse::<FrameChoice>().is_err() && "inf".parse::<FrameChoice>().is_err());
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
    let file = RunDirectory::frame_name(0);
    let fields = ["body".to_owned(), "pressure".to_owned()];
    write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
    write_series(&run.series(), &[SeriesEntry { time: 0.0, file }]).unwrap();
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
    plot_field(&run, &picture, &to).unwrap();
    let with = count(&pixels(&to), canvas::INK);
    plot_field(&run, &FieldPicture { measures: false, ..picture }, &to).unwrap();
    // A line over 4 of 20 mm of about 700 pixels, half hidden by smoothing, its ends, its leader and a label.
    let without = count(&pixels(&to), canvas::INK);
    assert!(with > 140 + without, "{with} {without}");
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
    plot_field_of_runs(&runs, &FieldPicture { size: Some((900, 700)), ..picture }, &to).unwrap();
    // Each of the four panels shows the particle of the largest value.
    let drawn = pixels(&to);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let quarter = |p: &usize| (p % 900 < 450) == (x == 0) && (p / 900 < 350) == (y == 0);
        let [r, g, b] = ColorMap::Diverging.color(1.0);
        let color = |p: &tiny_skia::PremultipliedColorU8| (p.red(), p.green(), p.blue()) == (r, g, b);
        let found = drawn.pixels().iter().enumerate().filter(|(k, p)| quarter(k) && color(p)).count();
        assert!(found > 50, "{x} {y}: {found}");
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
    let file = RunDirectory::frame_name(0);
    write_frame_file(&run.path().join(&file), &header, &particles, &["adapted".to_owned()]).unwrap();
    write_series(&run.series(), &[SeriesEntry { time: 0.0, file }]).unwrap();
    let picture = FieldPicture::new("adapted");
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
    plot_overlay(&[], "strain", &beside, &to).unwrap();
    // Squares have soft edges.
    let drawn = pixels(&to);
    let near = |p: &&tiny_skia::PremultipliedColorU8| {
        let [r, g, b] = color::LINES[0];
        p.red().abs_diff(r) < 90 && p.green().abs_diff(g) < 60 && p.blue().abs_diff(b) < 60
    };
    let found = drawn.pixels().iter().filter(near).count();
    assert!((30..200).contains(&found), "{found}");
    assert!(matches!(plot_overlay(&[], "strain", &[], &to), Err(PlotError::Empty { .. })));
}
