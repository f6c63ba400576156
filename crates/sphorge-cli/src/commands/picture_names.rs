//! What of a direction of view and of a section stands in the name of a picture, so that it does not take the place of the usual one.

use crate::readable::quantity;
use sphorge::plot::{Section, View};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The direction of view, with a `-` before it; nothing of the usual one of a problem of so many dimensions.
pub(crate) fn view_word(view: View, dimensions: usize) -> String {
    let upright = |up: Option<usize>| up.map_or(String::new(), |axis| format!("-up-{}", AXES[axis.min(2)]));
    match view {
        View::Xy if dimensions < 3 => String::new(),
        View::Corner { up: None } if dimensions == 3 => String::new(),
        View::Xy => "-xy".to_owned(),
        View::Xz => "-xz".to_owned(),
        View::Yz => "-yz".to_owned(),
        View::Corner { up } => format!("-corner{}", upright(up)),
        View::From { direction, up } => format!("-from-{}{}", numbers(direction, "").join("_"), upright(up)),
    }
}

/// The section, with a `-` before it.
pub(crate) fn section_word(section: Section) -> String {
    let Section::Across { normal, point } = section else { return "-section".to_owned() };
    let axis = (0..3).find(|&axis| normal == std::array::from_fn(|k| f64::from(u8::from(k == axis))));
    let Some(axis) = axis else {
        let at = point.map_or(String::new(), |point| format!("-at-{}", numbers(point, "m").join("_")));
        return format!("-section-{}{at}", numbers(normal, "").join("_"));
    };
    let at = point.map_or(String::new(), |point| format!("-at-{}", numbers([point[axis]], "m").join("_")));
    format!("-section-{}{at}", AXES[axis])
}

/// Numbers as names of files can have them.
fn numbers<const N: usize>(values: [f64; N], unit: &str) -> Vec<String> {
    let written = values.map(|value| quantity(value, unit).replace('µ', "u"));
    written.map(|text| text.chars().filter(|c| c.is_ascii_alphanumeric() || ".-+".contains(*c)).collect()).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::picture_arguments::parse_section;

    #[test]
    fn a_view_is_named_where_it_is_not_the_usual_one() {
        let word = |text: &str, dimensions| view_word(text.parse().unwrap(), dimensions);
        assert_eq!([word("xy", 2), word("corner", 3), word("xy", 1)], ["", "", ""]);
        assert_eq!([word("xy", 3), word("corner", 2), word("xz", 3), word("yz", 3)], ["-xy", "-corner", "-xz", "-yz"]);
        assert_eq!(word("corner up y", 3), "-corner-up-y");
        assert_eq!(word("1,-2,0.4 up z", 3), "-from-1_-2_0.4-up-z");
    }

    #[test]
    fn a_section_is_named_by_its_plane() {
        let word = |text: &str| section_word(parse_section(text).unwrap());
        assert_eq!([word("middle"), word("y")], ["-section", "-section-y"]);
        assert_eq!([word("x at -3 mm"), word("z at 0 mm")], ["-section-x-at--3mm", "-section-z-at-0m"]);
        assert_eq!([word("z at 3 um"), word("-1,0,0")], ["-section-z-at-3um", "-section--1_0_0"]);
        assert_eq!(word("1,1,0 at 0,0,5 mm"), "-section-1_1_0-at-0m_0m_5mm");
        // However it is given, the name is one of a file, and not long.
        let long = word("1.23456789e-30,1e200,0.1 at 1e-9,1e9,0.33333333 m");
        assert!(long.len() < 90 && long.chars().all(|c| c.is_ascii_alphanumeric() || "-_.+".contains(c)), "{long}");
    }
}
