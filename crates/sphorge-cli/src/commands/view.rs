//! `sphorge view`: runs in a browser.

use crate::{
    browser,
    commands::picture_arguments::{
        ColorArgument, parse_mirror, parse_range, parse_section, refuse_ends_of_ranges_as_folders,
        refuse_planes_as_folders,
    },
    failure::{Ending, Failure, Outcome, of_output},
    terminal,
};
use clap::Args;
use sphorge::{
    plot::{FrameChoice, Mirror, Section, View},
    view::{ViewError, ViewSettings, Viewer, save_single_page},
};
use std::{
    path::{Path, PathBuf},
    thread,
};

/// Arguments of `view`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge view out/iron-plate
  sphorge view out/iron-plate out/coarse --field pressure
  sphorge view out/taylor-bar --field plastic_strain --section --frame \"20 us\"
  sphorge view out/iron-plate -o page.html
  sphorge view out/penetration -o page.html --field velocity --most \"5 MB\"
  sphorge run iron-plate --view

The page is served by this program, to this machine alone, at an address that
nobody can guess; nothing in the folders is written. Frames of a run that goes
on appear by themselves. Ctrl-C ends the program. On another machine, forward
the port: ssh -L 8000:127.0.0.1:8000 HOST sphorge view out/run --port 8000 --no-open

With -o, one file is written that shows the runs without this program: for a
paper or a mail. Frames are left out until it is small enough.")]
pub(crate) struct ViewArguments {
    /// Run folders, of finished runs or of runs that go on; several are shown side by side
    #[arg(value_name = "DIR", required = true)]
    directories: Vec<PathBuf>,
    /// Field to show first, or a component such as `stress.xy`; with -o, repeat it for all fields that the file has [default: as in the standard pictures of `plot`]
    #[arg(long = "field", value_name = "FIELD")]
    fields: Vec<String>,
    /// Frame to show first: `first`, `last`, a number, or a time such as "12 us" [default: last]
    #[arg(long, value_name = "FRAME", allow_hyphen_values = true)]
    frame: Option<FrameChoice>,
    /// Direction of view, as of `plot` [default: the plane of a plane problem, otherwise corner]
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    view: Option<View>,
    /// Cut the bodies and show the inside, as of `plot`: in the middle, or along a plane such as --section="x at 3 mm"
    #[arg(long, value_name = "PLANE", num_args = 0..=1, require_equals = true, default_missing_value = "middle", value_parser = parse_section)]
    section: Option<Section>,
    /// Show this body alone; can be repeated
    #[arg(long = "body", value_name = "NAME")]
    bodies: Vec<String>,
    /// Add the images in the deck's symmetry planes, as of `plot`: those that halve bodies, or the planes that are named: --mirror=x,y
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "halving", value_parser = parse_mirror)]
    mirror: Option<Mirror>,
    /// Values at the ends of the colour bar of the field that is shown first [default: automatic, of all frames]
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true)]
    range: Option<String>,
    /// Colour map [default: automatic]
    #[arg(long, value_name = "COLOURS")]
    colors: Option<ColorArgument>,
    /// Column of history.csv to draw under the particles; can be repeated [default: the measures]
    #[arg(long = "column", value_name = "COLUMN")]
    columns: Vec<String>,
    /// Port of this machine at which the page is served [default: one that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, conflicts_with = "output")]
    port: u16,
    /// Print the address and open no browser
    #[arg(long, conflicts_with = "output")]
    no_open: bool,
    /// Write one file that shows the runs by itself
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Largest size of that file, such as "5 MB"
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "10 MB", requires = "output")]
    most: Size,
    /// Replace that file if it is there
    #[arg(long, requires = "output")]
    overwrite: bool,
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size(usize);

fn parse_size(text: &str) -> Result<Size, String> {
    let bad = || "write a size such as `500 kB`, `10 MB` or `1 GB`".to_owned();
    let at = text.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(bad)?;
    let factor = match text[at..].trim() {
        "kB" | "KB" => 1e3,
        "MB" => 1e6,
        "GB" => 1e9,
        _ => return Err(bad()),
    };
    match text[..at].trim().parse::<f64>() {
        Ok(number) if (1e3..=1e12).contains(&(number * factor)) => Ok(Size((number * factor) as usize)),
        _ => Err(bad()),
    }
}

pub(crate) fn execute(arguments: &ViewArguments) -> Ending {
    refuse_planes_as_folders(&arguments.directories, arguments.section.as_ref(), arguments.mirror.as_ref())?;
    refuse_ends_of_ranges_as_folders(&arguments.directories, arguments.range.as_deref())?;
    let range = match &arguments.range {
        Some(text) => Some(parse_range(text, &first_field(arguments)?)?),
        None => None,
    };
    let settings = ViewSettings {
        fields: arguments.fields.clone(),
        color_map: arguments.colors.map(ColorArgument::map),
        range,
        view: arguments.view,
        section: arguments.section,
        frame: arguments.frame,
        bodies: arguments.bodies.clone(),
        mirror: arguments.mirror,
        columns: arguments.columns.clone(),
    };
    if let Some(file) = &arguments.output {
        return save(arguments, &settings, file);
    }
    let viewer = Viewer::open(&arguments.directories, settings, arguments.port).map_err(failure)?;
    viewer.start().map_err(failure)?;
    terminal::print(&format!("{}\n", viewer.address()))?;
    open(&viewer, !arguments.no_open);
    terminal::note("Ctrl-C ends it");
    // The threads of the viewer go on until a signal ends the program.
    loop {
        thread::park();
    }
}

/// Opens the page of a viewer in the browser, if it is to be.
pub(crate) fn open(viewer: &Viewer, opens: bool) {
    if opens && let Err(reason) = browser::open(viewer.address()) {
        let port = viewer.port();
        terminal::note(&format!(
            "note: the browser was not opened: {reason}. Open the address yourself, from another machine after `ssh -L {port}:127.0.0.1:{port} HOST`"
        ));
    }
}

/// The field that is shown first: in its unit limits are written.
fn first_field(arguments: &ViewArguments) -> Result<String, Failure> {
    if let Some(field) = arguments.fields.first() {
        return Ok(field.clone());
    }
    let first = sphorge::view::first_field(&arguments.directories).map_err(failure)?;
    first.ok_or_else(|| {
        Failure::bad_input("`--range` without a field, and the runs have no frame yet", "name the field with `--field`")
    })
}

fn save(arguments: &ViewArguments, settings: &ViewSettings, file: &Path) -> Ending {
    if !file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html")) {
        return Err(Failure::bad_input(
            format!("{} is not the name of a page", terminal::path(file)),
            "end it with .html; `sphorge plot` draws pictures",
        ));
    }
    let ViewArguments { directories, most, overwrite, .. } = arguments;
    let page = save_single_page(directories, settings, most.0, file, *overwrite).map_err(failure)?;
    for words in &page.damaged {
        terminal::note(&format!("warning: {words}"));
    }
    for words in &page.left_out {
        terminal::note(&format!("note: {words}"));
    }
    terminal::print(&format!("{} ({:.1} MB)\n", terminal::path(file), page.bytes as f64 / 1e6))?;
    Ok(Outcome::Done)
}

/// A disk that takes no more is a failure, everything else a wrong folder, field or port.
pub(crate) fn failure(error: ViewError) -> Failure {
    match error {
        ViewError::Output(error) => of_output(error),
        ViewError::Random { .. } => Failure::Failed(error.into()),
        _ => Failure::BadInput(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_unit() {
        assert_eq!(parse_size("10 MB"), Ok(Size(10_000_000)));
        assert_eq!(parse_size("500kB"), Ok(Size(500_000)));
        for bad in ["", "10", "MB", "x MB", "-1 MB", "10 Mb", "0.1 kB", "nan MB", "9e9 GB"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
