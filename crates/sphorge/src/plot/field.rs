//! Pictures of particles: of frames side by side, of each frame by itself, and moving.

use super::{
    FieldPicture, FrameChoice, PlotError,
    chart::{Chart, Curve, page},
    color_bar::Colors,
    field_page::{Layout, draw},
    mark::Mark,
    page::Page,
    save::save_animation,
    scene::{Extent, Panel, Scene, Source, meets},
    title::{run_title, title_of},
    walls::PlacedWall,
};
use crate::output::RunDirectory;
use std::path::{Path, PathBuf};

/// Draws a picture of particles to a PNG or SVG file, as its name ends.
///
/// # Errors
/// [`PlotError::Field`] if a frame does not have the field, [`PlotError::Empty`] if there is nothing to see,
/// [`PlotError::Format`] for another name, [`PlotError::Output`] if frames cannot be read or the picture cannot be written.
pub fn plot_field(run: &RunDirectory, picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    draw_runs(&[("", run)], picture, to)
}

/// Draws the same picture of several runs, under the given names, at one scale of lengths and colours: side by side, or where each has
/// several frames, a row for each run.
///
/// # Errors
/// As [`plot_field`]; [`PlotError::Empty`] without a run.
pub fn plot_field_of_runs(runs: &[(String, RunDirectory)], picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    let runs: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    draw_runs(&runs, picture, to)
}

/// Draws each frame of a picture by itself, all at one scale of lengths and colours, to the file that `name` gives for its
/// number. All frames of the run where the picture names none. Returns the files.
///
/// # Errors
/// As [`plot_field`].
pub fn plot_each_frame(
    run: &RunDirectory,
    picture: &FieldPicture,
    name: impl Fn(usize) -> PathBuf,
) -> Result<Vec<PathBuf>, PlotError> {
    let mut film = Film::open(run, picture)?;
    let mut files = Vec::new();
    for (number, file) in film.frames.clone() {
        files.push(name(number));
        film.page(&file)?.save(&files[files.len() - 1])?;
    }
    Ok(files)
}

/// Draws the frames of a picture, or all frames of the run where it names none, one after the other as an animated PNG that runs
/// for some `seconds` and starts again.
///
/// # Errors
/// As [`plot_field`].
pub fn animate_field(run: &RunDirectory, picture: &FieldPicture, seconds: f64, to: &Path) -> Result<(), PlotError> {
    let mut film = Film::open(run, picture)?;
    let frames = film.frames.clone();
    let each = seconds / frames.len().max(1) as f64;
    save_animation(frames.iter().map(|(_, file)| film.page(file)), each, to)
}

fn draw_runs(runs: &[(&str, &RunDirectory)], picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    let scene = Scene::read(runs, picture)?;
    let title = picture.title.clone().unwrap_or_else(|| title_of(runs));
    let page = if scene.look.line { draw_line(&scene, picture, &title)? } else { particles(&scene, picture, &title)? };
    page.save(to)
}

pub(super) fn particles(scene: &Scene, picture: &FieldPicture, title: &str) -> Result<Page, PlotError> {
    let colors = Colors::new(scene, picture);
    draw(scene, &colors, &Layout::new(scene, picture, title, &colors)?)
}

/// Distance between the cells of neighbours on a line, over their spacing, from which on material has come apart.
const APART: f64 = 0.75;

/// Places and values along a line, with a gap where another body begins or material has come apart.
fn joined(marks: &[Mark]) -> Vec<(f64, f64)> {
    let mut marks: Vec<&Mark> = marks.iter().collect();
    marks.sort_by(|a, b| a.right.total_cmp(&b.right));
    let mut points = Vec::with_capacity(marks.len());
    for (k, mark) in marks.iter().enumerate() {
        if let Some(before) = k.checked_sub(1).map(|k| marks[k]) {
            let open = (mark.right + mark.reach(0).0) - (before.right + before.reach(0).1);
            if before.body != mark.body || open > APART * before.spacing.max(mark.spacing) {
                points.push((0.5 * (before.right + mark.right), f64::NAN));
            }
        }
        points.push((mark.right, mark.value));
    }
    points
}

/// A problem of one dimension is a curve over x for each frame.
pub(super) fn draw_line(scene: &Scene, picture: &FieldPicture, title: &str) -> Result<Page, PlotError> {
    let curve = |panel: &Panel| {
        let mut points = joined(&panel.marks);
        if let Some([(low, high), _]) = picture.window {
            points.retain(|(x, _)| (low..=high).contains(x));
        }
        Curve { name: panel.heading(), points, marked: false }
    };
    let curves: Vec<_> = scene.panels.iter().map(curve).collect();
    let title = match &curves[..] {
        [only] => format!("{title},  {}", only.name),
        _ => title.to_owned(),
    };
    let (quantity, unit) = (scene.label.clone(), scene.unit.to_owned());
    // Those that are near the particles, once where they do not move.
    let (low, high) = scene.extent.window[0];
    let off = 1e-9 * (high - low);
    let is_near = |wall: &PlacedWall| wall.across().is_some_and(|x| (low - off..=high + off).contains(&x));
    let mut walls: Vec<PlacedWall> = Vec::new();
    for wall in scene.panels.iter().flat_map(|panel| &panel.walls).filter(|wall| is_near(wall)) {
        if !walls.contains(wall) {
            walls.push(*wall);
        }
    }
    let chart = Chart { along: ("x".to_owned(), "m".to_owned()), quantity, unit, curves, limits: picture.range, walls };
    page(&[chart], 1, &title, picture.size, picture.paper)
}

/// Frames of a run, seen one after the other at one scale.
struct Film {
    source: Source,
    picture: FieldPicture,
    title: String,
    extent: Option<Extent>,
    /// Number and file.
    frames: Vec<(usize, PathBuf)>,
    /// The page of the first frame that was drawn, which is that of all.
    layout: Option<Layout>,
}

impl Film {
    /// Looks at all frames for what they have in common: no more than one of them is in memory at a time.
    fn open(run: &RunDirectory, picture: &FieldPicture) -> Result<Self, PlotError> {
        let source = Source::open("", run, picture)?;
        let mut frames: Vec<_> = source.series.iter().map(|(_, file)| file.clone()).enumerate().collect();
        if !picture.frames.is_empty() {
            let chosen = picture.frames.iter().map(|choice: &FrameChoice| choice.pick(&source.series));
            let chosen = chosen.collect::<Result<Vec<_>, _>>()?;
            frames.retain(|(_, file)| chosen.contains(&file.as_path()));
        }
        let mut extents = Vec::new();
        let mut cut = Ok(());
        for (k, (_, file)) in frames.iter().enumerate() {
            let panel = source.panel(file, picture)?.panel;
            extents.extend(panel.extent());
            // A plane that one frame meets is one to be seen.
            if k == 0 || cut.is_err() {
                cut = meets([&panel]);
            }
        }
        cut?;
        let title = picture.title.clone().unwrap_or_else(|| run_title(run));
        let extent = Extent::of(&extents);
        Ok(Self { source, picture: picture.clone(), title, extent, frames, layout: None })
    }

    fn page(&mut self, file: &Path) -> Result<Page, PlotError> {
        let panel = self.source.panel(file, &self.picture)?;
        let scene = Scene { frames: 1, ..Scene::of(vec![panel], self.extent, &self.picture)? };
        if scene.look.line {
            let range = self.picture.range.or(self.extent.map(|extent| extent.extremes));
            let picture = FieldPicture { range, ..self.picture.clone() };
            let page = draw_line(&scene, &picture, &self.title)?;
            self.picture.size.get_or_insert((page.width.round() as u32, page.height.round() as u32));
            return Ok(page);
        }
        let colors = Colors::new(&scene, &self.picture);
        let layout = match self.layout.take() {
            Some(layout) => layout,
            None => Layout::new(&scene, &self.picture, &self.title, &colors)?,
        };
        draw(&scene, &colors, self.layout.insert(layout))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_where_another_body_begins_and_where_material_has_come_apart() {
        let mark = |(right, body): (f64, u16)| Mark {
            right,
            up: 0.0,
            towards: 0.0,
            spacing: 1.0,
            value: 10.0 * right,
            light: 1.0,
            body,
            cell: None,
        };
        // Stretched by 1.7 between the first two, apart between the next, and another body that touches.
        let marks = [(5.3, 1), (0.0, 0), (1.7, 0), (4.3, 0), (6.3, 1)].map(mark);
        let points = joined(&marks);
        let values: Vec<Option<f64>> = points.iter().map(|(_, y)| y.is_finite().then_some(*y)).collect();
        assert_eq!(values, [Some(0.0), Some(17.0), None, Some(43.0), None, Some(53.0), Some(63.0)]);
        assert_eq!((points[2].0, points[4].0), (3.0, 4.8));
    }
}
