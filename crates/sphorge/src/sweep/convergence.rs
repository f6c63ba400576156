//! Measures over the particle spacing: observed order and Richardson's limit.
//!
//! From the three finest spacings `h1 < h2 < h3` with values `f1, f2, f3` the order `p` follows from
//! `(f3 - f2) / (f2 - f1) = (h3^p - h2^p) / (h2^p - h1^p)`, and the limit from `f1 - (f2 - f1) / ((h2/h1)^p - 1)` (Roache, *Verification and
//! Validation in Computational Science and Engineering*, 1998, 5.10). Where the differences change their sign or do not shrink there is neither.

use super::{
    Planning, Sweep, SweepError, SweepTable, Varied,
    plan::{Load, MOST_RUNS},
    table::unquoted,
};
use crate::{
    deck::{DeckReport, Setup},
    number::{four_digits, plain, plain_quantity},
    output::{Durability, OutputError, write_file},
};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use std::{fmt, path::Path};

/// Highest order that is looked for.
const HIGHEST_ORDER: f64 = 20.0;
/// Values that differ by less, relative to their size, are the same.
const SAME: f64 = 1e-12;
/// Differences of a measure that are less than this share of what else is measured in its unit are rounding: such as those of a mean velocity
/// across the one that bodies have.
const BESIDE: f64 = 1e-13;

/// A sweep over the particle spacing.
#[derive(Clone, Debug)]
pub struct SpacedDeck {
    /// The runs.
    pub sweep: Sweep,
    /// Bodies whose own spacing is changed in proportion.
    pub in_proportion: Vec<String>,
}

/// Plans runs of a deck at several spacings, coarse to fine. Bodies with a spacing of their own keep its ratio to `particles.spacing`.
///
/// # Errors
/// As [`Sweep::plan`], for fewer than two spacings, and for a deck without measures.
pub fn spaced(
    load: impl Fn(&[(String, String)]) -> Result<Setup, DeckReport>,
    spacings: &[String],
    planning: &Planning<'_>,
) -> Result<SpacedDeck, SweepError> {
    const KEY: &str = "particles.spacing";
    let fault = |what: &str, help: &str| SweepError::Varied { what: what.to_owned(), help: help.to_owned() };
    if spacings.len() > MOST_RUNS {
        return Err(fault(&format!("these are more than {MOST_RUNS} runs"), "give fewer spacings"));
    }
    let varied = Varied { key: KEY.to_owned(), values: spacings.to_vec() };
    let Some((numbers, "m")) = varied.numbers() else {
        return Err(fault("the spacings are not all lengths", "write them as \"0.6 mm,0.3 mm,0.15 mm\""));
    };
    if !numbers.iter().all(|spacing| *spacing > 0.0) {
        return Err(fault("a spacing is not above zero", "write them as \"0.6 mm,0.3 mm,0.15 mm\""));
    }
    if numbers.len() < 2 {
        return Err(fault("there is one spacing only", "give two to compare, three or more for order and limit"));
    }
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by(|a, b| numbers[*b].total_cmp(&numbers[*a]));
    if let Some(pair) = order.windows(2).find(|pair| numbers[pair[0]] == numbers[pair[1]]) {
        return Err(fault(&format!("the spacing `{}` is given twice", spacings[pair[1]]), "give each once"));
    }
    let which = || "the deck itself".to_owned();
    let own = load(&[]).map_err(|source| SweepError::Deck { which: which(), set: String::new(), source })?;
    if own.model.measures.is_empty() {
        return Err(fault(
            "the deck has no measure, so that there is nothing whose order and limit could be found",
            "add a [[measure]] to it, such as `name = \"height\"` with `extent = { body = \"bar\", axis = \"y\" }`",
        ));
    }
    let is_own = |spacing: f64| (spacing / own.model.spacing - 1.0).abs() > 1e-9;
    let bodies: Vec<(usize, &str, f64)> = own
        .model
        .bodies
        .iter()
        .enumerate()
        .filter(|(_, body)| is_own(body.spacing))
        .map(|(k, body)| (k, body.name.as_str(), body.spacing / own.model.spacing))
        .collect();
    let set = |k: &usize| {
        let scaled = bodies
            .iter()
            .map(|(body, _, ratio)| (format!("body.{body}.spacing"), format!("{:e}", ratio * numbers[*k])));
        let set = std::iter::once((KEY.to_owned(), spacings[*k].clone())).chain(scaled).collect();
        (vec![spacings[*k].clone()], set)
    };
    let varied = Varied { key: KEY.to_owned(), values: order.iter().map(|k| spacings[*k].clone()).collect() };
    let in_proportion = bodies.iter().map(|(_, name, _)| (*name).to_owned()).collect();
    let load: &Load<'_> = &load;
    let sweep = Sweep::of(load, vec![varied], order.iter().map(set).collect(), planning)?;
    Ok(SpacedDeck { sweep, in_proportion })
}

/// Measures over spacings.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// The spacings, coarse to fine, as they were given.
    pub spacings: Vec<String>,
    /// The measures.
    pub measures: Vec<MeasureConvergence>,
}

/// A measure over spacings.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureConvergence {
    /// Its name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Its values, coarse to fine, SI; none where a run has none.
    pub values: Vec<Option<f64>>,
    /// Observed order and Richardson's limit, SI, or in words why there are none.
    pub limit: Result<(f64, f64), &'static str>,
}

impl Convergence {
    /// Of the table of a sweep over spacings.
    pub fn of(table: &SweepTable) -> Self {
        let spacing = |k: usize| table.rows[k].numbers.first().copied().flatten();
        let measure = |column: &super::SweepColumn| {
            let values: Vec<Option<f64>> = table.rows.iter().map(|row| row.measure(&column.name)).collect();
            let points: Vec<(f64, f64)> =
                values.iter().enumerate().filter_map(|(k, value)| spacing(k).zip(*value)).collect();
            let limit = order_and_limit(&points, BESIDE * magnitude(table, &column.unit));
            MeasureConvergence { name: column.name.clone(), unit: column.unit.clone(), values, limit }
        };
        let spacings = table.rows.iter().map(|row| unquoted(&row.values[0])).collect();
        Self { spacings, measures: table.measures.iter().map(measure).collect() }
    }

    /// Comma-separated values, SI.
    pub fn csv(&self) -> String {
        let mut text = csv::Writer::from_writer(Vec::new());
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut lines =
            vec![[own(&["measure", "unit"]), self.spacings.clone(), own(&["order", "limit", "why_not"])].concat()];
        for measure in &self.measures {
            let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
            let (order, limit) = (measure.limit.map(|of| of.0).ok(), measure.limit.map(|of| of.1).ok());
            let values = measure.values.iter().map(|value| number(*value)).collect();
            let why = measure.limit.err().unwrap_or_default().to_owned();
            lines.push(
                [vec![measure.name.clone(), measure.unit.clone()], values, vec![number(order), number(limit), why]]
                    .concat(),
            );
        }
        // Memory takes all that is written to it, and all lines have the same length.
        let written = lines.iter().all(|line| text.write_record(line).is_ok());
        debug_assert!(written);
        String::from_utf8_lossy(&text.into_inner().unwrap_or_default()).into_owned()
    }

    /// Writes `convergence.csv` to a folder.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let text = self.csv();
        write_file(&folder.join("convergence.csv"), Durability::Process, |out| out.write_all(text.as_bytes()))
    }
}

impl fmt::Display for Convergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new();
        table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        table
            .set_header([own(&["measure"]), self.spacings.clone(), own(&["order", "limit", "finest off by"])].concat());
        for measure in &self.measures {
            let quantity = |x: f64| plain(plain_quantity(x, &measure.unit));
            let values = measure.values.iter().map(|x| x.map_or_else(|| "\u{2013}".to_owned(), quantity)).collect();
            let end = match measure.limit {
                Ok((order, limit)) => {
                    let finest = measure.values.iter().rev().copied().flatten().next().unwrap_or(limit);
                    let off =
                        if limit == 0.0 { String::new() } else { format!("{:+.2} %", 100.0 * (finest / limit - 1.0)) };
                    vec![four_digits((1e3 * order).round() / 1e3), quantity(limit), off]
                }
                Err(why) => vec!["\u{2013}".to_owned(), why.to_owned(), String::new()],
            };
            table.add_row([vec![measure.name.clone()], values, end].concat());
        }
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        write!(f, "{table}")
    }
}

/// Size of what is measured in a unit, SI: the largest of the measures that have it, what particles are apart, and how fast they are to be so
/// in the time of a run.
fn magnitude(table: &SweepTable, unit: &str) -> f64 {
    let alike = table.measures.iter().filter(|of| of.unit == unit);
    let measured = alike.flat_map(|of| table.rows.iter().filter_map(|row| row.measure(&of.name)));
    let of_particles = table.rows.iter().filter_map(|row| {
        let (spacing, summary) = row.numbers.first().copied().flatten().zip(row.summary.as_ref())?;
        match unit {
            "m" => Some(spacing),
            "m/s" if summary.simulated_time > 0.0 => Some(spacing / summary.simulated_time),
            _ => None,
        }
    });
    measured.chain(of_particles).map(f64::abs).filter(|x| x.is_finite()).fold(0.0, f64::max)
}

/// Observed order and limit of values over spacings, coarse to fine, from the three finest. Differences of `rounding` and less say nothing.
fn order_and_limit(points: &[(f64, f64)], rounding: f64) -> Result<(f64, f64), &'static str> {
    let [.., (h3, f3), (h2, f2), (h1, f1)] = *points else { return Err("needs three spacings") };
    let (coarse, fine) = (f3 - f2, f2 - f1);
    let size = (SAME * f1.abs().max(f2.abs()).max(f3.abs())).max(rounding);
    if coarse == 0.0 && fine == 0.0 {
        return Err("does not change");
    }
    if coarse.abs() <= size || fine.abs() <= size {
        return Err("no trend above rounding");
    }
    if coarse * fine <= 0.0 {
        return Err("oscillates");
    }
    let asked = coarse / fine;
    // Increasing in p, from the ratio of logarithms.
    let ratio = |p: f64| ((h3 / h1).powf(p) - (h2 / h1).powf(p)) / ((h2 / h1).powf(p) - 1.0);
    if asked <= (h3 / h2).ln() / (h2 / h1).ln() * (1.0 + 1e-9) {
        return Err("does not converge");
    }
    if asked >= ratio(HIGHEST_ORDER) {
        return Err("does not change");
    }
    let (mut low, mut high) = (0.0, HIGHEST_ORDER);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if ratio(middle) < asked { low = middle } else { high = middle }
    }
    let order = 0.5 * (low + high);
    Ok((order, f1 - fine / ((h2 / h1).powf(order) - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decks, engine::ENGINES};

    #[test]
    fn order_and_limit_of_a_power_law_are_found_whatever_the_spacings() {
        for (spacings, order) in
            [([0.4, 0.2, 0.1], 1.0), ([0.4, 0.2, 0.1], 2.0), ([0.5, 0.3, 0.21], 1.37), ([1e-3, 9e-4, 7e-4], 0.4)]
        {
            let points: Vec<_> = spacings.iter().map(|h: &f64| (*h, 7.0 - 3.0 * h.powf(order))).collect();
            let (found, limit) = order_and_limit(&points, 0.0).unwrap();
            assert!((found - order).abs() < 1e-6 && (limit - 7.0).abs() < 1e-7, "{found} {limit}");
            // Coarser ones are not looked at.
            let more = [&[(2.0, -50.0)], &points[..]].concat();
            assert_eq!(order_and_limit(&more, 0.0).unwrap(), (found, limit));
        }
    }

    #[test]
    fn where_there_is_no_order_it_is_said_why() {
        let of = |values: [f64; 3]| {
            order_and_limit(&[(0.4, values[0]), (0.2, values[1]), (0.1, values[2])], 1e-13).unwrap_err()
        };
        assert_eq!(of([1.0, 3.0, 2.0]), "oscillates");
        assert_eq!(of([1.0, 2.0, 4.0]), "does not converge");
        assert_eq!(of([1.0, 2.0, 3.0]), "does not converge");
        assert_eq!(of([2.0, 2.0, 2.0]), "does not change");
        assert_eq!(order_and_limit(&[(0.2, 1.0), (0.1, 2.0)], 0.0), Err("needs three spacings"));
        // Rounding, beside one and of something that is zero: signs and ratios of such differences would be of any order.
        for values in
            [[1.0 + 8e-16, 1.0 + 4e-16, 1.0], [8e-16, 2e-16, 0.5e-16], [-3e-16, 2e-16, 1e-16], [1.0, 0.5, 0.5 - 1e-16]]
        {
            assert_eq!(of(values), "no trend above rounding", "{values:?}");
        }
    }

    #[test]
    fn what_is_rounding_is_seen_beside_what_is_measured_in_the_same_unit() {
        use crate::output::{Status, testing};
        let column =
            |name: &str, unit: &str| crate::sweep::SweepColumn { name: name.to_owned(), unit: unit.to_owned() };
        let row = |h: f64, across: f64| {
            let measures = [("along", Some(100.0 - 1e3 * h)), ("across", Some(across)), ("share", Some(across))];
            let summary = crate::output::Summary {
                status: Status::Completed,
                measures: measures.map(|(name, value)| (name.to_owned(), value)).into(),
                ..testing::summary(2.0)
            };
            let summary = Some(Box::new(summary));
            crate::sweep::SweepRow {
                values: vec![h.to_string()],
                numbers: vec![Some(h)],
                summary,
                ..Default::default()
            }
        };
        let table = SweepTable {
            keys: vec![column("particles.spacing", "m")],
            measures: vec![column("along", "m/s"), column("across", "m/s"), column("share", "")],
            rows: vec![row(4e-3, 8e-15), row(2e-3, 4e-15), row(1e-3, 2e-15)],
        };
        let limits: Vec<_> = Convergence::of(&table).measures.into_iter().map(|of| of.limit).collect();
        assert!((limits[0].unwrap().0 - 1.0).abs() < 1e-6, "{limits:?}");
        assert_eq!(limits[1], Err("no trend above rounding"));
        // Nothing tells how large this one could be.
        assert!(limits[2].is_ok());
    }

    #[test]
    fn bodies_with_a_spacing_of_their_own_keep_its_ratio() {
        let folder = tempfile::tempdir().unwrap();
        let deck = decks::find("iron-plate").unwrap();
        let own =
            [("body.bar.spacing".to_owned(), "1 mm".to_owned()), ("particles.spacing".to_owned(), "2 mm".to_owned())];
        let load = |set: &[(String, String)]| crate::deck::load_text(deck.name, deck.text, &[&own[..], set].concat());
        let plan = |spacings: &[&str]| {
            let spacings: Vec<String> = spacings.iter().map(|text| (*text).to_owned()).collect();
            let stop = std::sync::atomic::AtomicBool::new(false);
            spaced(load, &spacings, &Planning { folder: folder.path(), engine: ENGINES[0], again: false, stop: &stop })
        };
        let planned = plan(&["1 mm", "4 mm", "2 mm"]).unwrap();
        assert_eq!(planned.in_proportion, ["bar"]);
        let runs = &planned.sweep.runs;
        assert_eq!(runs.iter().map(|run| run.values[0].as_str()).collect::<Vec<_>>(), ["4 mm", "2 mm", "1 mm"]);
        let spacings = |k: usize| {
            let model = crate::deck::load_text("d", &runs[k].deck_text, &[]).unwrap().model;
            (model.spacing, model.bodies[0].spacing)
        };
        assert_eq!((spacings(0), spacings(2)), ((4e-3, 2e-3), (1e-3, 0.5e-3)));
        for spacings in [&["1 mm"][..], &["1 mm", "1000 um"], &["1 mm", "1 s"], &["1 mm", "-1 mm"]] {
            assert!(matches!(plan(spacings), Err(SweepError::Varied { .. })), "{spacings:?}");
        }
    }
}
