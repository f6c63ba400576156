//! Arguments that still pictures and the viewer have in common.

use crate::{commands::plot_quantities::read_quantities, failure::Failure};
use clap::ValueEnum;
use sphorge::{
    particles::find_field,
    plot::{ColorMap, Mirror, PictureFormat, Section},
};
use std::path::PathBuf;

/// Colours.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ColorArgument {
    /// Dark blue to yellow
    Viridis,
    /// Black through red to yellow
    Inferno,
    /// Blue over grey to red
    Diverging,
}

impl ColorArgument {
    pub(crate) fn map(self) -> ColorMap {
        match self {
            Self::Viridis => ColorMap::Viridis,
            Self::Inferno => ColorMap::Inferno,
            Self::Diverging => ColorMap::Diverging,
        }
    }
}

/// Forms of pictures.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum FormatArgument {
    /// Pixel image
    Png,
    /// Vector graphics: lines and text scale
    Svg,
}

impl FormatArgument {
    pub(crate) fn format(self) -> PictureFormat {
        match self {
            Self::Png => PictureFormat::Png,
            Self::Svg => PictureFormat::Svg,
        }
    }
}

pub(crate) fn parse_section(text: &str) -> Result<Section, String> {
    if text == "middle" {
        return Ok(Section::Middle);
    }
    let bad = || "write an axis or a normal, and where: `x at 3 mm`, `1,1,0 at 0,0,5 mm`".to_owned();
    let (direction, place) =
        text.split_once(" at ").map_or((text, None), |(direction, place)| (direction, Some(place)));
    if let Some(axis) = ["x", "y", "z"].iter().position(|name| *name == direction.trim()) {
        let along = |length: f64| std::array::from_fn(|k| if k == axis { length } else { 0.0 });
        let place = place.map(|place| read_quantities::<1>(place, "m")).transpose()?;
        return Ok(Section::Across { normal: along(1.0), point: place.map(|[place]| along(place)) });
    }
    let normal = read_quantities::<3>(direction, "").map_err(|_| bad())?;
    if normal.iter().all(|x| *x == 0.0) {
        return Err(bad());
    }
    let point = place.map(|place| read_quantities::<3>(place, "m")).transpose()?;
    Ok(Section::Across { normal, point })
}

pub(crate) fn parse_mirror(text: &str) -> Result<Mirror, String> {
    if text == "halving" { Ok(Mirror::Halving) } else { text.parse() }
}

/// Refuses what is no folder and follows a range of which the other end is missing: `--range 0 1` for `--range 0,1`.
pub(crate) fn refuse_ends_of_ranges_as_folders(directories: &[PathBuf], range: Option<&str>) -> Result<(), Failure> {
    let Some(low) = range.filter(|range| !range.contains(',')) else { return Ok(()) };
    let missing: Vec<&str> =
        directories.iter().filter(|path| !path.exists()).filter_map(|path| path.to_str()).collect();
    match missing.first() {
        Some(word) if word.trim_matches(',').parse::<f64>().is_ok() => {
            let high = missing.join(" ");
            let what = format!("there is no run folder `{word}`; `--range` takes both values in one word");
            Err(Failure::bad_input(what, format!("write --range=\"{low},{}\"", high.trim_matches(','))))
        }
        _ => Ok(()),
    }
}

/// Refuses what is no folder and follows an option that takes its value by `=` alone: `--section y` for `--section=y`.
pub(crate) fn refuse_planes_as_folders(
    directories: &[PathBuf],
    section: Option<&Section>,
    mirror: Option<&Mirror>,
) -> Result<(), Failure> {
    let missing = directories.iter().filter(|path| !path.exists()).filter_map(|path| path.to_str());
    for word in missing {
        let option = if section == Some(&Section::Middle) && parse_section(word).is_ok() {
            "--section"
        } else if mirror == Some(&Mirror::Halving) && parse_mirror(word).is_ok() {
            "--mirror"
        } else {
            continue;
        };
        let what = format!("there is no run folder `{word}`; `{option}` takes its value by `=`");
        return Err(Failure::bad_input(what, format!("write {option}=\"{word}\"")));
    }
    Ok(())
}

pub(crate) fn parse_range(text: &str, field: &str) -> Result<(f64, f64), Failure> {
    let unit = find_field(field.split('.').next().unwrap_or_default()).map_or("", |field| field.unit);
    let bad = |reason: &str| {
        Failure::bad_input(
            format!("`--range {text}` of {field}: {reason}"),
            "write two values, the smaller first: `0,1.5`, or with a unit `-1,1 GPa`",
        )
    };
    match read_quantities(text, unit).map_err(|reason| bad(&reason))? {
        [low, high] if low < high => Ok((low, high)),
        _ => Err(bad("the first value is not the smaller one")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_read_as_axes_or_normals_with_a_place() {
        let across = |normal, point| Ok(Section::Across { normal, point });
        assert_eq!(parse_section("middle"), Ok(Section::Middle));
        assert_eq!(parse_section("y"), across([0.0, 1.0, 0.0], None));
        assert_eq!(parse_section("y at -3 mm"), across([0.0, 1.0, 0.0], Some([0.0, -3e-3, 0.0])));
        assert_eq!(parse_section("1,1,0 at 0,2,5 mm"), across([1.0, 1.0, 0.0], Some([0.0, 2e-3, 5e-3])));
        for bad in ["w", "0,0,0", "1,1", "x at 3 s", "x at 1,2 mm", "1,0,0 at 3 mm"] {
            assert!(parse_section(bad).is_err(), "{bad}");
        }
    }
}
