//! `sphorge plot`: pictures of runs.

use crate::{
    commands::{
        picture_arguments::{
            ColorArgument, parse_mirror, parse_range, parse_section, refuse_ends_of_ranges_as_folders,
            refuse_planes_as_folders,
        },
        picture_names::{section_word, view_word},
        plot_quantities::{read_quantities, read_width},
    },
    failure::{Ending, Failure, Outcome, of_output},
    readable::quantity,
    terminal,
};
use clap::{Args, ValueEnum};
use sphorge::{
    deck::{did_you_mean, names_like},
    output::{FrameFile, RunDirectory, read_series},
    particles::{FIELDS, find_field},
    plot::{
        ColumnsPicture, Condition, FieldPicture, FrameChoice, Mirror, Paper, PictureFormat, PlotError, Section, View,
        animate_field, common_measures, plot_each_frame, plot_field, plot_field_of_runs, plot_run,
    },
};
use std::path::{Path, PathBuf};

/// Arguments of `plot`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge plot out/iron-plate
  sphorge plot out/iron-plate --field temperature --frames first,20,last
  sphorge plot out/iron-plate --field pressure --time \"12 us\" --range=-1,1GPa
  sphorge plot out/taylor-bar --field plastic_strain --view xz --section --range 0,1.5
  sphorge plot out/copper-bar --field plastic_strain --view xz --section --mirror
  sphorge plot out/bullet --field plastic_strain --body plate --where \"plastic_strain > 0.2\"
  sphorge plot out/bullet --field body --view \"1,-2,0.4 up z\" --section=\"x at 0 mm\"
  sphorge plot out/penetration --field plastic_strain --measures
  sphorge plot out/penetration --field velocity --animate
  sphorge plot out/penetration --field velocity --frames all --dpi 200
  sphorge plot out/iron-plate --column height --column width
  sphorge plot out/tensile --column motion.grip.force_x --x length --from-start length
  sphorge plot out/iron-plate --column height --x width -o height.csv
  sphorge plot out/1mm out/05mm --column height --width \"85 mm\" -o height.svg

Without --field and --column a standard set of pictures is drawn. Several runs
are drawn side by side (--field) or in the same chart (--column). Pictures are
written to the folder `plots` of the first run unless -o names another place.
Plain numbers are in SI; units are written as in decks: \"12 us\", \"1.5 GPa\",
--window=\"-60,60,-100,20 mm\". For an unknown field or column,
the available ones are listed.")]
pub(crate) struct PlotArguments {
    /// Run folders, of finished or unfinished runs
    #[arg(value_name = "DIR", required = true)]
    directories: Vec<PathBuf>,
    /// Draw a field, or a component such as `stress.xy`; can be repeated
    #[arg(long = "field", value_name = "FIELD")]
    fields: Vec<String>,
    /// Frames to draw side by side: `first`, `last`, numbers, or times such as "12 us"; `all` draws each as a separate picture [default: last]
    #[arg(long, value_name = "FRAMES", value_delimiter = ',', allow_hyphen_values = true, requires = "fields")]
    frames: Vec<FrameWord>,
    /// Draw the frames nearest to these times, side by side
    #[arg(long, value_name = "TIME", value_delimiter = ',', value_parser = parse_time, allow_hyphen_values = true, requires = "fields", conflicts_with = "frames")]
    time: Vec<FrameChoice>,
    /// Draw the frames (all, unless some are named) as an animated PNG; `ffmpeg -i name.png name.mp4` makes a film of it
    #[arg(long, requires = "fields", conflicts_with = "format")]
    animate: bool,
    /// Length of the animation
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true, default_value = "6 s", requires = "animate")]
    duration: Duration,
    /// Direction of view: xy, xz, yz, corner, or any direction towards the eye such as "1,-2,1"; of the last two, z points up, unless gravity or a floor across y says otherwise, or an axis is named: "corner up y", "1,0.5,2 up y" [default: the plane of a plane problem, otherwise corner]
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true, requires = "fields")]
    view: Option<View>,
    /// Cut the bodies and show the inside: in the middle or at the symmetry plane, or along a plane such as --section="x at 3 mm" or --section="1,1,0 at 0,0,5 mm" (normal and point); a plane beside all bodies is refused, and so is that of a plane problem
    #[arg(long, value_name = "PLANE", num_args = 0..=1, require_equals = true, default_missing_value = "middle", value_parser = parse_section, requires = "fields")]
    section: Option<Section>,
    /// Draw this body alone; can be repeated
    #[arg(long = "body", value_name = "NAME", requires = "fields")]
    bodies: Vec<String>,
    /// Draw the particles alone that meet a condition such as "plastic_strain > 0.2" or "pressure < -1 GPa"; of several, all
    #[arg(long = "where", value_name = "CONDITION", value_parser = parse_condition, requires = "fields")]
    conditions: Vec<Condition>,
    /// Add the images in the deck's symmetry planes: the whole of a half or quarter model; not in a plane towards which a body flies at the start, which stands for a wall, unless it is named: --mirror=x,y,z
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "halving", value_parser = parse_mirror, requires = "fields")]
    mirror: Option<Mirror>,
    /// Draw the deck's measures of craters and clouds on the particles
    #[arg(long, requires = "fields")]
    measures: bool,
    /// Values at the ends of the colour bar [default: the extremes shown, or where outliers stretch these by half or more the range of 99 % of the particles; arrows then give the extremes]
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, requires = "fields")]
    range: Option<String>,
    /// Part of the view to show: left, right, bottom, top [default: all]
    #[arg(long, value_name = "L,R,B,T", value_parser = parse_window, allow_hyphen_values = true, requires = "fields")]
    window: Option<[(f64, f64); 2]>,
    /// Colour map [default: automatic]
    #[arg(long, value_name = "COLOURS", requires = "fields")]
    colors: Option<ColorArgument>,
    /// Draw a column of history.csv over time or --x; can be repeated, columns of the same unit share a chart
    #[arg(long = "column", value_name = "COLUMN")]
    columns: Vec<String>,
    /// Draw the columns over this one instead of time: a force over a displacement
    #[arg(long, value_name = "COLUMN", requires = "columns")]
    x: Option<String>,
    /// Multiply a column that is drawn: --scale height=-1, or all of --column: --scale 4; can be repeated
    #[arg(long = "scale", value_name = "[COLUMN=]FACTOR", value_parser = parse_scale, allow_hyphen_values = true, requires = "columns")]
    scales: Vec<(Option<String>, f64)>,
    /// Draw the change of a column since the first row: the elongation where a column is a length; can be repeated
    #[arg(long = "from-start", value_name = "COLUMN", requires = "columns")]
    from_start: Vec<String>,
    /// Output file, PNG, SVG or (for columns) CSV by its extension, or output folder
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
    /// Picture format [default: png, or the extension of -o]
    #[arg(long, value_name = "FORMAT")]
    format: Option<FormatArgument>,
    /// Pixels per inch, 50 to 1200; text keeps its printed size [default: 100; 300 for particles in SVG]
    #[arg(long, value_name = "DPI", value_parser = clap::value_parser!(u32).range(50..=1200), allow_hyphen_values = true)]
    dpi: Option<u32>,
    /// Width of the picture, such as "85 mm" or "390 px" [default: automatic]
    #[arg(long, value_name = "WIDTH", allow_hyphen_values = true)]
    width: Option<String>,
}

/// Forms of pictures.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum FormatArgument {
    /// Pixel image
    Png,
    /// Vector graphics: lines and text scale
    Svg,
}

/// Frames as they are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FrameWord {
    All,
    One(FrameChoice),
}

impl std::str::FromStr for FrameWord {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" { Ok(Self::All) } else { text.parse().map(Self::One) }
    }
}

/// A span of time, s.
#[derive(Clone, Copy, Debug)]
struct Duration(f64);

fn parse_time(text: &str) -> Result<FrameChoice, String> {
    match read_quantities::<1>(text, "s")? {
        [time] if time >= 0.0 => Ok(FrameChoice::Time(time)),
        _ => Err("times count from zero".to_owned()),
    }
}

fn parse_duration(text: &str) -> Result<Duration, String> {
    match read_quantities::<1>(text, "s")? {
        [time] if (0.01..=3600.0).contains(&time) => Ok(Duration(time)),
        _ => Err("an animation takes between 0.01 s and an hour".to_owned()),
    }
}

fn parse_window(text: &str) -> Result<[(f64, f64); 2], String> {
    match read_quantities(text, "m")? {
        [left, right, bottom, top] if left < right && bottom < top => Ok([(left, right), (bottom, top)]),
        _ => Err("write left before right and bottom before top: `-60,60,-100,20 mm`".to_owned()),
    }
}

fn parse_scale(text: &str) -> Result<(Option<String>, f64), String> {
    let (name, factor) = text.rsplit_once('=').map_or((None, text), |(name, factor)| (Some(name.to_owned()), factor));
    match factor.trim().parse() {
        Ok(factor) if f64::is_finite(factor) && factor != 0.0 => Ok((name, factor)),
        _ => Err("write a factor, or a column and its factor: `4`, `height=-1`".to_owned()),
    }
}

fn parse_condition(text: &str) -> Result<Condition, String> {
    let bad = || "write a field, `>` or `<`, and a number: `plastic_strain > 0.2`, `stress.xy < -1 GPa`".to_owned();
    let at = text.find(['>', '<']).ok_or_else(bad)?;
    let (field, bound) = (text[..at].trim(), text[at + 1..].trim());
    let name = field.split('.').next().unwrap_or_default();
    if name.is_empty() || bound.is_empty() {
        return Err(bad());
    }
    let known = find_field(name);
    let [bound] = read_quantities::<1>(bound, known.map_or("", |field| field.unit)).map_err(|message| match known {
        Some(_) => message,
        // Without the field its unit is not known, either.
        None => {
            let near = did_you_mean(names_like(name, FIELDS.iter().map(|field| field.name)));
            format!(
                "there is no field `{name}`{}",
                if near.is_empty() { near } else { format!("; {}", near.trim_end()) }
            )
        }
    })?;
    Ok(Condition { field: field.to_owned(), is_above: text[at..].starts_with('>'), bound })
}

pub(crate) fn execute(arguments: &PlotArguments) -> Ending {
    let list: String = draw(arguments)?.iter().map(|file| format!("{}\n", terminal::path(file))).collect();
    terminal::print(&list)?;
    Ok(Outcome::Done)
}

/// Draws what is asked for, and returns the files.
pub(crate) fn draw(arguments: &PlotArguments) -> Result<Vec<PathBuf>, Failure> {
    refuse_planes_as_folders(&arguments.directories, arguments.section.as_ref(), arguments.mirror.as_ref())?;
    refuse_ends_of_ranges_as_folders(&arguments.directories, arguments.range.as_deref())?;
    let open = |path: &PathBuf| {
        let run = RunDirectory::open(path).map_err(|error| Failure::BadInput(error.into()))?;
        // The folder itself, where the path says `..`.
        let whole = path.canonicalize().unwrap_or_else(|_| path.clone());
        let name = whole.file_name().map_or_else(|| "run".to_owned(), |name| name.to_string_lossy().into_owned());
        Ok((name, run))
    };
    let runs = arguments.directories.iter().map(open).collect::<Result<Vec<_>, Failure>>()?;
    Job::new(&runs, arguments)?.draw()
}

/// What is drawn, and where to.
struct Job<'a> {
    runs: &'a [(String, RunDirectory)],
    arguments: &'a PlotArguments,
    frames: Vec<FrameChoice>,
    /// Each frame by itself.
    apart: bool,
    paper: Paper,
    format: PictureFormat,
}

impl<'a> Job<'a> {
    fn new(runs: &'a [(String, RunDirectory)], arguments: &'a PlotArguments) -> Result<Self, Failure> {
        let chosen = arguments.frames.iter().filter_map(|word| match word {
            FrameWord::All => None,
            FrameWord::One(choice) => Some(*choice),
        });
        let frames: Vec<_> = chosen.chain(arguments.time.iter().copied()).collect();
        let all = arguments.frames.contains(&FrameWord::All);
        if all && !frames.is_empty() {
            return Err(Failure::bad_input("`all` cannot be combined with other frames", "write `--frames all` alone"));
        }
        if runs.len() > 1 && (all || arguments.animate) {
            return Err(Failure::bad_input(
                "`--animate` and `--frames all` draw one run only",
                "name one run, or choose frames such as `--frames first,last`, which are drawn side by side",
            ));
        }
        let format = match (arguments.format, &arguments.output) {
            (Some(FormatArgument::Png), _) => PictureFormat::Png,
            (Some(FormatArgument::Svg), _) => PictureFormat::Svg,
            (None, Some(path)) => PictureFormat::of(path).unwrap_or_default(),
            (None, None) => PictureFormat::default(),
        };
        let dpi = arguments.dpi.unwrap_or(match format {
            PictureFormat::Png => 100,
            PictureFormat::Svg => 300,
        });
        let width = match &arguments.width {
            Some(text) => Some(read_width(text, arguments.dpi.unwrap_or(100)).map_err(|reason| {
                Failure::bad_input(
                    format!("`--width {text}`: {reason}"),
                    "write a width such as \"85 mm\" or \"390 px\"",
                )
            })?),
            None => None,
        };
        let paper = Paper { dpi, width };
        let job = Self { runs, arguments, frames, apart: all && !arguments.animate, paper, format };
        if let Some(file) = job.single_file() {
            job.check_file(file)?;
        }
        Ok(job)
    }

    /// The file that `-o` names; none if it names a folder.
    fn single_file(&self) -> Option<&'a Path> {
        self.arguments.output.as_deref().filter(|path| path.extension().is_some() && !path.is_dir())
    }

    fn check_file(&self, file: &Path) -> Result<(), Failure> {
        if is_table(file) {
            return match (self.arguments.fields.is_empty(), self.arguments.format) {
                (true, None) => Ok(()),
                (false, _) => Err(Failure::bad_input(
                    "a field is drawn, not written as numbers",
                    "end the name with .png or .svg; the frames in `fields` have the numbers",
                )),
                (true, Some(_)) => Err(Failure::bad_input("a table has no picture format", "leave out `--format`")),
            };
        }
        // The format is that of the name unless `--format` says another one.
        let drawn = PictureFormat::of(file);
        if self.arguments.animate && !matches!(drawn, Ok(PictureFormat::Png)) {
            return Err(Failure::bad_input(
                "an animation is an animated PNG file",
                "end the name with .png, which browsers play; `ffmpeg -i name.png name.mp4` makes a film of it, and in Python `run.plot(field, animate=True, format=\"webp\")` an animated WebP",
            ));
        }
        let format = drawn.map_err(failure)?;
        if format != self.format {
            let ending = self.format.extension();
            return Err(Failure::bad_input(
                format!("{} does not end in .{ending}, the chosen format", file.display()),
                format!("end it with .{ending}, or leave out `--format`"),
            ));
        }
        let named = self.arguments.fields.len() + usize::from(!self.arguments.columns.is_empty());
        // Of several runs, what they have in common is one.
        let pictures = if named == 0 && self.runs.len() > 1 { 1 } else { named };
        if pictures != 1 || self.apart {
            return Err(Failure::bad_input(
                format!("{} is a single file, but there are several pictures to draw", file.display()),
                "name a folder, or draw a single field, or columns",
            ));
        }
        Ok(())
    }

    fn draw(&self) -> Result<Vec<PathBuf>, Failure> {
        let (arguments, paper) = (self.arguments, self.paper);
        let [(_, run), others @ ..] = self.runs else { return Ok(Vec::new()) };
        if arguments.fields.is_empty() && arguments.columns.is_empty() {
            if others.is_empty() {
                let folder = arguments.output.clone().unwrap_or_else(|| run.plots());
                return plot_run(run, paper, self.format, &folder).map_err(failure);
            }
            return self.draw_measures();
        }
        if !arguments.fields.is_empty() {
            self.note_times_past_the_end();
        }
        let mut files = Vec::new();
        for field in &arguments.fields {
            files.extend(self.draw_field(run, field)?);
        }
        if !arguments.columns.is_empty() {
            files.push(self.draw_columns(&arguments.columns)?);
        }
        Ok(files)
    }

    /// What several runs have in common when nothing is named: their measures.
    fn draw_measures(&self) -> Result<Vec<PathBuf>, Failure> {
        let measures = common_measures(self.runs).map_err(failure)?;
        if measures.is_empty() {
            return Err(Failure::bad_input(
                "the runs have no measure in common",
                "name what to draw: `--column total_energy`, `--field velocity`",
            ));
        }
        Ok(vec![self.draw_columns(&measures)?])
    }

    fn draw_columns(&self, columns: &[String]) -> Result<PathBuf, Failure> {
        let mut name = format!("history-{}", columns.join("-"));
        if name.len() > 100 {
            name = format!("history-{}-columns", columns.len());
        }
        if let Some(x) = &self.arguments.x {
            name = format!("{name}-over-{x}");
        }
        let file = self.file(&name);
        let factors = self.arguments.scales.iter().flat_map(|(name, factor)| match name {
            Some(name) => vec![(name.clone(), *factor)],
            None => columns.iter().map(|column| (column.clone(), *factor)).collect(),
        });
        let picture = ColumnsPicture {
            columns: columns.to_vec(),
            along: self.arguments.x.clone(),
            factors: factors.collect(),
            from_start: self.arguments.from_start.clone(),
            paper: self.paper,
        };
        picture.save(self.runs, &file).map_err(failure)?;
        Ok(file)
    }

    fn draw_field(&self, run: &RunDirectory, field: &str) -> Result<Vec<PathBuf>, Failure> {
        let arguments = self.arguments;
        let range = arguments.range.as_deref().map(|text| parse_range(text, field)).transpose()?;
        let picture = FieldPicture {
            frames: self.frames.clone(),
            view: arguments.view,
            section: arguments.section,
            bodies: arguments.bodies.clone(),
            conditions: arguments.conditions.clone(),
            mirror: arguments.mirror,
            measures: arguments.measures,
            range,
            window: arguments.window,
            color_map: arguments.colors.map(ColorArgument::map),
            paper: self.paper,
            ..FieldPicture::new(field)
        };
        let seen = format!("{}{}", self.sight(run), if arguments.measures { "-measures" } else { "" });
        if self.apart {
            let name = |number: usize| self.file(&format!("{field}-{number:06}{seen}"));
            return plot_each_frame(run, &picture, name).map_err(failure);
        }
        if arguments.animate {
            let file = self.file(&format!("{field}-animated{seen}"));
            animate_field(run, &picture, arguments.duration.0, &file).map_err(failure)?;
            return Ok(vec![file]);
        }
        let frames = if self.frames.is_empty() { vec![FrameChoice::Last] } else { self.frames.clone() };
        // A series that cannot be read is refused by the drawing.
        let series = read_series(run).unwrap_or_default();
        let words: Vec<_> = frames.iter().map(|frame| frame_word(*frame, &series)).collect();
        let file = self.file(&format!("{field}-{}{seen}", words.join("-")));
        let picture = FieldPicture { frames, ..picture };
        match self.runs {
            [_] => plot_field(run, &picture, &file),
            several => plot_field_of_runs(several, &picture, &file),
        }
        .map_err(failure)?;
        Ok(vec![file])
    }

    /// From where particles are seen and how they are cut, for the name of a picture; nothing where it is as usual.
    fn sight(&self, run: &RunDirectory) -> String {
        let last = read_series(run).ok().and_then(|series| series.last().map(|(_, file)| file.clone()));
        let dimensions = last.and_then(|file| FrameFile::open(&file).ok()).map_or(0, |frame| frame.header.dimensions);
        let view = self.arguments.view.map(|view| view_word(view, dimensions));
        format!("{}{}", view.unwrap_or_default(), self.arguments.section.map(section_word).unwrap_or_default())
    }

    /// Tells which runs end before a time that was asked for.
    fn note_times_past_the_end(&self) {
        let times = self.frames.iter().filter_map(|frame| match frame {
            FrameChoice::Time(time) => Some(*time),
            _ => None,
        });
        let Some(latest) = times.reduce(f64::max) else { return };
        for (name, run) in self.runs {
            let end = read_series(run).ok().and_then(|series| series.last().map(|(time, _)| *time));
            if let Some(end) = end.filter(|end| latest > end * (1.0 + 1e-9)) {
                let [end, latest] = [end, latest].map(|time| quantity(time, "s"));
                terminal::note(&format!(
                    "note: the last frame of `{name}` is at {end}: it is drawn instead of {latest}"
                ));
            }
        }
    }

    /// Where a picture of that name goes; of several runs, the name says which.
    fn file(&self, name: &str) -> PathBuf {
        if let Some(file) = self.single_file() {
            return file.to_owned();
        }
        let beside = match self.runs {
            [_, others @ ..] if others.len() > 3 => format!("-of-{}-runs", self.runs.len()),
            [_, others @ ..] => others.iter().map(|(other, _)| format!("-vs-{other}")).collect(),
            [] => String::new(),
        };
        let own = self.runs.first().map(|(_, run)| run.plots());
        let folder = self.arguments.output.clone().or(own).unwrap_or_default();
        folder.join(format!("{name}{beside}.{}", self.format.extension()))
    }
}

/// Whether a file is to hold numbers.
fn is_table(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))
}

/// How a frame is called in the name of a picture: one chosen by its time, by the time it has.
fn frame_word(frame: FrameChoice, series: &[(f64, PathBuf)]) -> String {
    match frame {
        FrameChoice::First => "first".to_owned(),
        FrameChoice::Last => "last".to_owned(),
        FrameChoice::Index(index) => index.to_string(),
        FrameChoice::Time(asked) => {
            let time = frame.find(series).map_or(asked, |(time, _)| *time);
            quantity(time, "s").replace(' ', "")
        }
    }
}

/// A disk that takes no more is a failure, everything else a wrong folder, field or column.
fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Output(error) => of_output(error),
        PlotError::Encode { .. } => Failure::Failed(error.into()),
        _ => Failure::BadInput(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_read_with_the_unit_of_their_field() {
        let condition = |field: &str, is_above, bound| Ok(Condition { field: field.to_owned(), is_above, bound });
        assert_eq!(parse_condition("plastic_strain>0.2"), condition("plastic_strain", true, 0.2));
        assert_eq!(parse_condition("stress.xy < -1 GPa"), condition("stress.xy", false, -1e9));
        assert_eq!(parse_condition("no_field_of_ours > 2"), condition("no_field_of_ours", true, 2.0));
        let slip = parse_condition("temprature > 5 degC").unwrap_err();
        assert_eq!(slip, "there is no field `temprature`; did you mean `temperature`?");
        assert_eq!(parse_condition("xyz > 5 degC").unwrap_err(), "there is no field `xyz`");
        for bad in ["", ">", "pressure", "pressure>", ">1", "pressure > 1 mm", "pressure >= 1", "pressure > x"] {
            assert!(parse_condition(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn factors_are_those_of_a_column_or_of_all() {
        assert_eq!(parse_scale("-4"), Ok((None, -4.0)));
        assert_eq!(parse_scale("wall.anvil.force_y=2"), Ok((Some("wall.anvil.force_y".to_owned()), 2.0)));
        for bad in ["", "height=", "0", "inf", "height=x"] {
            assert!(parse_scale(bad).is_err(), "{bad}");
        }
    }
}
