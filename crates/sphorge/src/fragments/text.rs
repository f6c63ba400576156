//! Tables of fragments, for people and as CSV.

use super::{Fragment, FragmentTable};
use crate::{
    number::{plain, plain_quantity},
    output::{Durability, OutputError, write_file},
};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use std::path::Path;

/// Names of the columns of the CSV file; the unit of a mass is that of the run.
const COLUMNS: [&str; 19] = [
    "frame",
    "time (s)",
    "fragment",
    "body",
    "particles",
    "mass",
    "x (m)",
    "y (m)",
    "z (m)",
    "velocity_x (m/s)",
    "velocity_y (m/s)",
    "velocity_z (m/s)",
    "speed (m/s)",
    "spin_x (rad/s)",
    "spin_y (rad/s)",
    "spin_z (rad/s)",
    "size_1 (m)",
    "size_2 (m)",
    "size_3 (m)",
];

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The spin, rad/s: in a plane about its normal, with the sign, else how large it is; zero where nothing of the fragment moves by it but rounding.
fn spin(fragment: &Fragment, dimensions: usize) -> f64 {
    let spin = if dimensions == 2 { fragment.spin[2] } else { length(fragment.spin) };
    if spin.abs() * fragment.size[0] < 1e-9 { 0.0 } else { spin }
}

fn quantity(value: f64, unit: &str) -> String {
    plain(plain_quantity(value, unit))
}

/// Such as `(0, -12.5, 0) m/s`.
fn vector(v: &[f64]) -> String {
    // What is rounding beside the largest component is a zero.
    let largest = v.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let parts = v.iter().map(|x| if x.abs() < 1e-4 * largest { "0".to_owned() } else { quantity(*x, "") });
    format!("({})", parts.collect::<Vec<_>>().join(", "))
}

impl FragmentTable {
    /// For people: no more than `most` fragments one by one, the others together.
    pub fn text(&self, most: usize) -> String {
        let mass_unit = self.mass_unit;
        let mut text = format!("frame {} at {}\n", self.frame, quantity(self.time, "s"));
        let row = |(k, fragment): (usize, &Fragment)| {
            let size = fragment.size[..self.dimensions].iter().map(|x| quantity(*x, "m"));
            vec![
                (k + 1).to_string(),
                fragment.body.clone(),
                fragment.particles.to_string(),
                quantity(fragment.mass, mass_unit),
                vector(&fragment.velocity[..self.dimensions]),
                quantity(spin(fragment, self.dimensions), "rad/s"),
                size.collect::<Vec<_>>().join(" x "),
            ]
        };
        let mut table = Table::new();
        table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(["fragment", "body", "particles", "mass", "velocity, m/s", "spin", "size"]);
        table.add_rows(self.fragments.iter().enumerate().take(most).map(row));
        for k in [0, 2, 3, 5] {
            if let Some(column) = table.column_mut(k) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        if self.fragments.is_empty() {
            text.push_str("no fragments\n");
        } else {
            text.push_str(&format!("{table}\n"));
        }
        if let Some(rest) = self.fragments.get(most..).filter(|rest| !rest.is_empty()) {
            let mass = rest.iter().map(|fragment| fragment.mass).sum::<f64>();
            text.push_str(&format!("{} lighter fragments, {}\n", rest.len(), quantity(mass, mass_unit)));
        }
        for loose in self.loose.iter().filter(|loose| loose.particles > 0) {
            let (particles, mass) = (loose.particles, quantity(loose.mass, mass_unit));
            let velocity = vector(&loose.velocity[..self.dimensions]);
            text.push_str(&format!(
                "{}: {particles} particles, {mass}, are part of no fragment; their mean velocity is {velocity} m/s\n",
                loose.body
            ));
        }
        text
    }

    /// All fragments of some frames as CSV, with a head; what of a body is part of none is a line without a number, place, spin and size.
    pub fn csv(tables: &[Self]) -> String {
        let mut text = csv::Writer::from_writer(Vec::new());
        // All frames of a run have the same dimensions.
        let mass = format!("mass ({})", tables.first().map_or("kg", |table| table.mass_unit));
        let mut lines = vec![COLUMNS.map(|name| if name == "mass" { mass.clone() } else { name.to_owned() })];
        let texts = |values: [f64; 3]| values.map(|x| x.to_string());
        for table in tables {
            let mut add =
                |number: String, body: &str, particles: u64, mass: f64, vectors: [[String; 3]; 4], speed: f64| {
                    let [[x, y, z], [u, v, w], [p, q, r], [a, b, c]] = vectors;
                    let (frame, time) = (table.frame.to_string(), table.time.to_string());
                    let (particles, mass, speed) = (particles.to_string(), mass.to_string(), speed.to_string());
                    let body = body.to_owned();
                    lines.push([frame, time, number, body, particles, mass, x, y, z, u, v, w, speed, p, q, r, a, b, c]);
                };
            for (k, of) in table.fragments.iter().enumerate() {
                let vectors = [of.position, of.velocity, of.spin, of.size].map(texts);
                add((k + 1).to_string(), &of.body, of.particles, of.mass, vectors, length(of.velocity));
            }
            for of in table.loose.iter().filter(|of| of.particles > 0) {
                let none = || [const { String::new() }; 3];
                let vectors = [none(), texts(of.velocity), none(), none()];
                add(String::new(), &of.body, of.particles, of.mass, vectors, length(of.velocity));
            }
        }
        // Memory takes all that is written to it, and all lines have the same length.
        let written = lines.iter().all(|line| text.write_record(line).is_ok());
        debug_assert!(written);
        String::from_utf8(text.into_inner().unwrap_or_default()).unwrap_or_default()
    }

    /// Writes all fragments of some frames to a CSV file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_csv(tables: &[Self], to: &Path) -> Result<(), OutputError> {
        let text = Self::csv(tables);
        write_file(to, Durability::Process, |out| out.write_all(text.as_bytes()))
    }
}
