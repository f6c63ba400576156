//! The table of a sweep as Parquet, for pandas, polars, DuckDB and others.

use super::SweepTable;
use crate::output::{Durability, OutputError, Summary, write_file};
use parquet::{
    basic::{LogicalType, Repetition, Type as Kind},
    column::writer::ColumnWriter,
    data_type::ByteArray,
    errors::ParquetError,
    file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter},
    schema::types::Type,
};
use std::{collections::BTreeMap, path::Path, sync::Arc};

/// The values of a column.
enum Values {
    /// None where a run has none.
    Numbers(Vec<Option<f64>>),
    Counts(Vec<Option<u64>>),
    Texts(Vec<String>),
}

/// A column with its unit.
struct Column {
    name: String,
    unit: &'static str,
    own_unit: Option<String>,
    values: Values,
}

impl SweepTable {
    /// The table as a Parquet file: the columns of `sweep.csv` by their names, SI; numbers are null where a run has none. The units are in the metadata
    /// of the file, under `units`, as JSON.
    ///
    /// # Errors
    /// Two columns have the same name.
    pub fn parquet(&self) -> Result<Vec<u8>, String> {
        written(&self.columns()).map_err(|error| error.to_string())
    }

    /// Writes it to a file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_parquet(&self, path: &Path) -> Result<(), OutputError> {
        let bytes = self.parquet().map_err(std::io::Error::other);
        write_file(path, Durability::Process, |out| out.write_all(&bytes?))
    }

    fn columns(&self) -> Vec<Column> {
        let texts = |name: &str, values: Vec<String>| Column {
            name: name.to_owned(),
            unit: "",
            own_unit: None,
            values: Values::Texts(values),
        };
        let of = |name: &str, unit: &'static str, pick: fn(&Summary) -> f64| {
            let values = self.rows.iter().map(|row| row.summary.as_ref().map(|summary| pick(summary)));
            Column { name: name.to_owned(), unit, own_unit: None, values: Values::Numbers(values.collect()) }
        };
        let count = |name: &str, pick: fn(&Summary) -> u64| {
            let values = self.rows.iter().map(|row| row.summary.as_ref().map(|summary| pick(summary)));
            Column { name: name.to_owned(), unit: "", own_unit: None, values: Values::Counts(values.collect()) }
        };
        let mut columns = vec![texts("run", self.rows.iter().map(|row| row.run.clone()).collect())];
        for (k, key) in self.keys.iter().enumerate() {
            // A key whose values are not all quantities of one kind is texts.
            let numbers: Option<Vec<f64>> = self.rows.iter().map(|row| row.numbers[k]).collect();
            let values = match numbers {
                Some(numbers) => Values::Numbers(numbers.into_iter().map(Some).collect()),
                None => Values::Texts(self.rows.iter().map(|row| row.values[k].clone()).collect()),
            };
            columns.push(Column { name: key.name.clone(), unit: "", own_unit: Some(key.unit.clone()), values });
        }
        columns.push(texts("status", self.rows.iter().map(|row| row.status().to_owned()).collect()));
        columns.push(texts("warnings", self.rows.iter().map(|row| row.warnings().join(" ")).collect()));
        for measure in &self.measures {
            let values = Values::Numbers(self.rows.iter().map(|row| row.measure(&measure.name)).collect());
            let (name, own_unit) = (measure.name.clone(), Some(measure.unit.clone()));
            columns.push(Column { name, unit: "", own_unit, values });
        }
        columns.push(of("simulated_time", "s", |summary| summary.simulated_time));
        columns.push(of("wall_seconds", "s", |summary| summary.wall_seconds));
        columns.push(count("steps", |summary| summary.steps));
        columns.push(count("particles", |summary| summary.particles));
        columns.push(of("energy_drift", "", |summary| summary.energy.relative_drift));
        // A measure may be called like another column.
        for k in 1..columns.len() {
            while columns[..k].iter().any(|column| column.name == columns[k].name) {
                columns[k].name.insert_str(0, "measure.");
            }
        }
        columns
    }
}

fn written(columns: &[Column]) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(|column| {
        let (kind, logical, repetition) = match column.values {
            Values::Numbers(_) => (Kind::DOUBLE, None, Repetition::OPTIONAL),
            Values::Counts(_) => (Kind::INT64, None, Repetition::OPTIONAL),
            Values::Texts(_) => (Kind::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED),
        };
        let field =
            Type::primitive_type_builder(&column.name, kind).with_logical_type(logical).with_repetition(repetition);
        field.build().map(Arc::new)
    });
    let schema = Type::group_type_builder("sweep").with_fields(fields.collect::<Result<_, _>>()?).build()?;
    let unit = |column: &Column| column.own_unit.clone().unwrap_or_else(|| column.unit.to_owned());
    let units: BTreeMap<&str, String> = columns
        .iter()
        .map(|column| (column.name.as_str(), unit(column)))
        .filter(|(_, unit)| !unit.is_empty())
        .collect();
    let units = serde_json::to_string(&units).map_err(|error| ParquetError::General(error.to_string()))?;
    let metadata = vec![KeyValue::new("units".to_owned(), units)];
    let properties = WriterProperties::builder().set_key_value_metadata(Some(metadata)).build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for column in columns {
        let Some(mut writer) = group.next_column()? else { break };
        match (&column.values, writer.untyped()) {
            (Values::Numbers(values), ColumnWriter::DoubleColumnWriter(writer)) => {
                let (there, levels) = split(values);
                writer.write_batch(&there, Some(&levels), None)?;
            }
            (Values::Counts(values), ColumnWriter::Int64ColumnWriter(writer)) => {
                let (there, levels) = split(values);
                let there: Vec<i64> = there.into_iter().map(|count| count as i64).collect();
                writer.write_batch(&there, Some(&levels), None)?;
            }
            (Values::Texts(texts), ColumnWriter::ByteArrayColumnWriter(writer)) => {
                let texts: Vec<ByteArray> = texts.iter().map(|text| ByteArray::from(text.as_str())).collect();
                writer.write_batch(&texts, None, None)?;
            }
            _ => return Err(ParquetError::General(format!("the column `{}` is of another kind", column.name))),
        }
        writer.close()?;
    }
    group.close()?;
    file.into_inner()
}

/// The values that are there, and for each place whether there is one.
fn split<T: Copy>(values: &[Option<T>]) -> (Vec<T>, Vec<i16>) {
    (values.iter().copied().flatten().collect(), values.iter().map(|value| i16::from(value.is_some())).collect())
}

#[cfg(test)]
mod tests {
    use super::super::{SweepColumn, SweepRow};
    use super::*;
    use crate::output::testing;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    fn column(name: &str, unit: &str) -> SweepColumn {
        SweepColumn { name: name.to_owned(), unit: unit.to_owned() }
    }

    fn row(run: &str, values: [&str; 2], number: f64, height: Option<f64>) -> SweepRow {
        let measures = BTreeMap::from([("steps".to_owned(), height)]);
        let summary = Summary { measures, steps: 7, ..testing::summary(2.5) };
        SweepRow {
            run: run.to_owned(),
            values: values.map(str::to_owned).to_vec(),
            numbers: vec![Some(number), None],
            summary: height.map(|_| Box::new(summary)),
            told: None,
        }
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let table = SweepTable {
            keys: vec![column("particles.spacing", "m"), column("search", "")],
            measures: vec![column("steps", "m")],
            rows: vec![row("a", ["1 mm", "skin"], 1e-3, Some(0.02)), row("b", ["2 mm", "\u{fc}ber"], 2e-3, None)],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.parquet");
        table.write_parquet(&path).unwrap();
        let file = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let metadata = file.metadata().file_metadata();
        let units = metadata.key_value_metadata().unwrap().iter().find(|entry| entry.key == "units").unwrap();
        let units = units.value.as_deref().unwrap();
        assert_eq!(units, r#"{"particles.spacing":"m","simulated_time":"s","steps":"m","wall_seconds":"s"}"#);
        let rows: Vec<String> = file.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        assert!(
            rows[0].starts_with("{run: \"a\", particles.spacing: 0.001, search: \"skin\", status: "),
            "{}",
            rows[0]
        );
        assert!(rows[0].contains("steps: 0.02, ") && rows[0].contains("measure.steps: 7, "), "{}", rows[0]);
        assert!(
            rows[1].contains("search: \"\u{fc}ber\", status: \"unfinished\", warnings: \"\", steps: null, "),
            "{}",
            rows[1]
        );
        assert!(rows.len() == 2 && rows[1].contains("measure.steps: null"), "{}", rows[1]);
    }
}
