//! One file that holds the page and what it shows, for a paper or a mail.

use super::{
    ViewError, ViewSettings,
    array::{Array, HEAD},
    error::{bytes, time},
    history::thinned,
    nodes::cell_bytes,
    packed::{compressed, packed},
    parts::{json_in_page, page_with_parts},
    run::{BODY, POSITION, ViewedRun},
    serve::Opening,
};
use crate::{
    output::{Durability, OutputError, write_file},
    particles::DEFORMATION_GRADIENT,
    plot::{Mirror, default_fields},
};
use base64::{Engine, engine::general_purpose::STANDARD};
use serde::Serialize;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Rows of a history in a single page.
const MOST_ROWS: usize = 250;
/// Frames that a single page has at most of a run.
const MOST_FRAMES: usize = 400;

/// What a single page has, and what was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct SinglePage {
    /// Bytes of the file.
    pub bytes: usize,
    /// What was left out or rounded, in words.
    pub left_out: Vec<String>,
    /// What cannot be read of the runs and so is not in the page, in words.
    pub damaged: Vec<String>,
}

/// The numbers of a single page: where each is among the bytes.
#[derive(Clone, Debug, Serialize)]
struct Entry {
    run: usize,
    /// Number of the frame in the page.
    frame: usize,
    name: String,
    at: usize,
    length: usize,
    head: [f64; HEAD],
    ranges: Vec<(f64, f64)>,
}

/// Bytes that are not rounded.
#[derive(Clone, Debug, Serialize)]
struct Plain {
    run: usize,
    name: String,
    at: usize,
    length: usize,
}

#[derive(Clone, Debug, Default)]
struct Packing {
    bytes: Vec<u8>,
    arrays: Vec<Entry>,
    plain: Vec<Plain>,
}

impl Packing {
    fn add(&mut self, packed: &[u8]) -> (usize, usize) {
        let at = self.bytes.len();
        self.bytes.extend_from_slice(packed);
        (at, packed.len())
    }

    fn add_plain(&mut self, run: usize, name: &str, raw: &[u8]) {
        let (at, length) = self.add(&compressed(raw));
        self.plain.push(Plain { run, name: name.to_owned(), at, length });
    }

    fn add_array(&mut self, run: usize, frame: usize, name: &str, array: &Array) {
        let packed = packed(array, name == BODY);
        let (at, length) = self.add(&packed.bytes);
        self.arrays.push(Entry {
            run,
            frame,
            name: name.to_owned(),
            at,
            length,
            head: array.head,
            ranges: packed.ranges,
        });
    }
}

/// A run, and what of it goes into the page.
struct Chosen<'a> {
    run: &'a ViewedRun,
    times: Vec<f64>,
    /// Arrays of each frame.
    names: Vec<String>,
    /// Arrays that do not change.
    fixed: Vec<String>,
    has_cells: bool,
    fields_left_out: usize,
}

/// Writes one file that shows runs, of at most so many bytes. Fields are those of the settings, or of the standard pictures; frames are left out until
/// it is small enough. Missing folders are made. A file that is there is replaced only with `overwrite`.
///
/// # Errors
/// As [`super::Viewer::open`]; [`ViewError::Exists`] or [`ViewError::NoFile`] where it may not be written, before anything is
/// read; [`ViewError::Size`] if not even one frame of each run fits, [`ViewError::Output`] if the file cannot be written.
pub fn save_single_page(
    folders: &[PathBuf],
    settings: &ViewSettings,
    most: usize,
    to: &Path,
    overwrite: bool,
) -> Result<SinglePage, ViewError> {
    check_target(to, overwrite)?;
    let runs = ViewedRun::open_all(folders)?;
    settings.check(&runs)?;
    let chosen = runs.iter().map(|run| Chosen::new(run, settings)).collect::<Result<Vec<_>, _>>()?;
    let opening = Opening::new(&runs, settings);
    let damaged: Vec<String> = runs.iter().flat_map(ViewedRun::damage).collect();
    let written = |frames: &[usize]| -> Result<(String, Vec<String>), ViewError> {
        let left_out = left_out(&chosen, frames);
        let told = [&damaged[..], &left_out].concat();
        let page = page(&runs, settings.mirror, &chosen, frames, &opening, &pack(&chosen, frames)?, &told)?;
        Ok((page, left_out))
    };
    let frames: Vec<usize> = chosen.iter().map(|_| 1).collect();
    let (mut page, mut left_out) = written(&frames)?;
    if page.len() > most {
        return Err(ViewError::Size { need: bytes(page.len()), most: bytes(most) });
    }
    // What another frame of each run takes tells how many fit; half more are tried first.
    let own = page_with_parts("").len();
    let of = |most: usize| -> Vec<usize> { chosen.iter().map(|run| run.times.len().clamp(1, most)).collect() };
    let each = written(&of(2))?.0.len().saturating_sub(page.len()).max(1);
    let fit = 2 + 3 * (most - page.len()) / (2 * each);
    let mut next = of(fit.min(MOST_FRAMES));
    while next != frames {
        let tried = written(&next)?;
        if tried.0.len() <= most {
            (page, left_out) = tried;
            break;
        }
        let share = 0.97 * most.saturating_sub(own) as f64 / (tried.0.len() - own) as f64;
        let fewer = |count: &usize| ((*count as f64 * share) as usize).min(count.saturating_sub(1)).max(1);
        next = next.iter().map(fewer).collect();
    }
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).map_err(|source| OutputError::Write { path: to.into(), source })?;
    }
    write_file(to, Durability::Process, |out| out.write_all(page.as_bytes()))?;
    Ok(SinglePage { bytes: page.len(), left_out, damaged })
}

/// Whether a page may be written there.
fn check_target(to: &Path, overwrite: bool) -> Result<(), ViewError> {
    match fs::metadata(to) {
        Ok(found) if !found.is_file() => Err(ViewError::NoFile { path: to.to_owned() }),
        Ok(_) if !overwrite => Err(ViewError::Exists { path: to.to_owned() }),
        _ => Ok(()),
    }
}

impl<'a> Chosen<'a> {
    fn new(run: &'a ViewedRun, settings: &ViewSettings) -> Result<Self, ViewError> {
        let times: Vec<f64> = run.series()?.iter().map(|(time, _)| *time).collect();
        let (_, frame) = run.frame(times.len().saturating_sub(1))?;
        let known = run.fields(&frame);
        let has = |name: &str| known.iter().any(|field| field.name == name);
        let fields: Vec<String> = match &settings.fields[..] {
            [] => {
                let usual = default_fields(run.model()?.as_deref(), has);
                usual.into_iter().map(str::to_owned).collect()
            }
            named => named.to_vec(),
        };
        let fields_left_out = known.iter().filter(|field| field.name != BODY && !fields.contains(&field.name)).count();
        let mut names = vec![POSITION.to_owned()];
        let has_cells = has(DEFORMATION_GRADIENT) && run.cells()?.count > 0;
        names.extend(fields.into_iter().filter(|name| name != BODY));
        let fixed = if has(BODY) { vec![BODY.to_owned()] } else { Vec::new() };
        Ok(Self { run, times, names, fixed, has_cells, fields_left_out })
    }

    /// Which frames of the run are those of the page.
    fn frames(&self, count: usize) -> Vec<usize> {
        thinned(self.times.len(), count).collect()
    }
}

/// Packs so many frames of each run.
fn pack(chosen: &[Chosen], counts: &[usize]) -> Result<Packing, ViewError> {
    let mut packing = Packing::default();
    for (number, (run, count)) in chosen.iter().zip(counts).enumerate() {
        if run.has_cells {
            packing.add_plain(number, "cells", &cell_bytes(&*run.run.cells()?));
        }
        for (k, frame) in run.frames(*count).into_iter().enumerate() {
            for name in run.names.iter().chain(run.fixed.iter().filter(|_| k == 0)) {
                packing.add_array(number, k, name, &run.run.array(frame, name)?);
            }
            if run.has_cells {
                let nodes = run.run.nodes(frame)?;
                packing.add_array(number, k, "nodes", &nodes.places);
                packing.add_plain(number, &format!("parted/{k}"), &nodes.parted_bytes());
                packing.add_plain(number, &format!("torn/{k}"), &nodes.torn_bytes());
            }
        }
        let columns = run.run.describe(None).columns.len();
        for column in 0..columns {
            let values = run.run.column(column, MOST_ROWS)?;
            let raw: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
            packing.add_plain(number, &format!("history/{column}"), &raw);
        }
    }
    Ok(packing)
}

/// What a reader has to know.
fn left_out(chosen: &[Chosen], frames: &[usize]) -> Vec<String> {
    let mut words = Vec::new();
    for (run, count) in chosen.iter().zip(frames) {
        let all = run.times.len();
        let name = &run.run.name;
        if *count < all {
            let kept = run.frames(*count);
            let apart = kept.windows(2).map(|pair| run.times[pair[1]] - run.times[pair[0]]).fold(0.0, f64::max);
            let apart = if apart > 0.0 { format!(", at most {} apart", time(apart)) } else { String::new() };
            words.push(format!("`{name}`: {count} of {all} frames{apart}"));
        }
        if run.fields_left_out > 0 {
            words.push(format!("`{name}`: {} other fields of the run are left out", run.fields_left_out));
        }
    }
    words.push("numbers of particles are rounded to 1/65534 of their range in each frame".to_owned());
    words
}

/// The text of the page.
fn page(
    runs: &[ViewedRun],
    mirror: Option<Mirror>,
    chosen: &[Chosen],
    frames: &[usize],
    opening: &Opening,
    packing: &Packing,
    left_out: &[String],
) -> Result<String, ViewError> {
    let described: Vec<_> = runs
        .iter()
        .zip(chosen.iter().zip(frames))
        .map(|(run, (chosen, count))| {
            let kept = chosen.frames(*count);
            run.describe(mirror).of_frames(&kept, &chosen.names)
        })
        .collect();
    #[derive(Serialize)]
    struct Data<'a> {
        opening: &'a Opening,
        runs: &'a [super::description::Description],
        arrays: &'a [Entry],
        plain: &'a [Plain],
        left_out: &'a [String],
    }
    let data = Data { opening, runs: &described, arrays: &packing.arrays, plain: &packing.plain, left_out };
    let json =
        serde_json::to_string(&data).map_err(|error| crate::plot::PlotError::Encode { reason: error.to_string() })?;
    let bytes = STANDARD.encode(&packing.bytes);
    Ok(page_with_parts(&format!(
        "<script type=\"application/json\" id=\"data\">{}</script>\n<script type=\"text/plain\" id=\"bytes\">{bytes}</script>\n",
        json_in_page(&json)
    )))
}
