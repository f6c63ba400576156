//! Writes one frame as VTK XML PolyData (`.vtp`).
//!
//! Values are little-endian and stand behind the XML header ([`super::vtp_data`]), compressed by zlib unless the deck has `output.compression = "none"`.
//! Points are `Float64`: displacements of elastic cases are below the resolution of `Float32` coordinates. Fields are
//! `Float32`, whole numbers `UInt32`. Every particle is a vertex cell, so that ParaView shows and thresholds it. The unit of an array is its
//! `UNITS_LABEL`, where VTK keeps units. Field data carry what a reader needs beside the particles: `TimeValue` (s), `Step`, `Dimensions`,
//! `BodySpacing` (m), `BodyName` and `BodyMaterial` (one value a body, in the order of the field `body`), and for people, since ParaView shows field
//! data and no units, `Units`.

use super::{
    atomic::Sink,
    history::field_unit,
    vtp_data::{COMPRESSOR, write_compressed, write_raw},
};
use crate::engine::{FieldSource, RunFailure};
use crate::model::Model;
use crate::particles::{Column, ColumnKind, FieldInfo, find_field};
use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};

/// What a frame states beside its particles.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameHeader {
    /// Time, s.
    pub time: f64,
    /// Steps done.
    pub step: u64,
    /// Number of space dimensions.
    pub dimensions: usize,
    /// Particle spacing of each body, m.
    pub body_spacing: Vec<f64>,
}

impl FrameHeader {
    /// Of a frame of a model at a time (s), after so many steps.
    pub(crate) fn new(model: &Model, time: f64, step: u64) -> Self {
        let body_spacing = model.bodies.iter().map(|body| body.spacing).collect();
        Self { time, step, dimensions: model.dimensions.count(), body_spacing }
    }
}

/// What the number of a body in the field `body` stands for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameBody {
    /// Name in the deck.
    pub name: String,
    /// Name of its material.
    pub material: String,
}

/// Writes frames of one run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameWriter {
    /// The bodies in the order of the deck; may be none.
    pub bodies: Vec<FrameBody>,
    /// Whether values are compressed.
    pub is_compressed: bool,
}

impl Default for FrameWriter {
    fn default() -> Self {
        Self { bodies: Vec::new(), is_compressed: true }
    }
}

/// VTK's names of components.
fn component_names(kind: ColumnKind) -> &'static [&'static str] {
    match kind {
        ColumnKind::Scalar | ColumnKind::Integer => &[],
        ColumnKind::Vector => &["X", "Y", "Z"],
        ColumnKind::Symmetric => &["XX", "YY", "ZZ", "XY", "YZ", "XZ"],
        ColumnKind::Tensor => &["XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"],
    }
}

/// Number of particles a file can hold: VTK's connectivity is written as `Int32`.
const MAX_PARTICLES: usize = i32::MAX as usize;

/// Arrays before the fields: points, and the two of the vertices.
const ARRAYS_BEFORE: usize = 3;

impl FrameWriter {
    /// Of the frames of a model, with the names of its bodies.
    pub fn new(model: &Model) -> Self {
        let material =
            |index: usize| model.materials.get(index).map_or_else(String::new, |material| material.name.clone());
        let bodies = model.bodies.iter();
        let bodies = bodies.map(|body| FrameBody { name: body.name.clone(), material: material(body.material) });
        Self { bodies: bodies.collect(), is_compressed: model.output.is_compressed }
    }

    /// Writes a frame with the named fields from where `out` stands, particles in the order they are read in. The position is written as
    /// the points, wherever it stands among `fields`.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for a name that is not in [`crate::particles::FIELDS`] or more than 2³¹ - 1 particles;
    /// otherwise what the writer reports.
    pub fn write(
        &self,
        out: &mut (impl Write + Seek),
        header: &FrameHeader,
        particles: &dyn FieldSource,
        fields: &[String],
    ) -> io::Result<()> {
        let out: &mut dyn Sink = out;
        let count = particles.count();
        if count > MAX_PARTICLES {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("{count} particles are too many for a frame"),
            ));
        }
        let fields = written_fields(fields)?;
        // Where arrays begin is known when those before are compressed: the header is written again then, as long as before.
        let mut offsets = vec![0; ARRAYS_BEFORE + fields.len()];
        let start = out.stream_position()?;
        out.write_all(self.head(header, count, &fields, &offsets).as_bytes())?;
        let data = out.stream_position()?;

        let read = |field: &str| particles.read(field).map_err(io::Error::other);
        let mut at = offsets.iter_mut();
        let mut add = |out: &mut dyn Sink, bytes: &[u8]| {
            if let Some(at) = at.next() {
                *at = out.stream_position()? - data;
            }
            if self.is_compressed { write_compressed(out, bytes) } else { write_raw(out, bytes) }
        };
        let Column::Vector(positions) = read("position")? else {
            return Err(io::Error::other("positions are not vectors"));
        };
        add(out, &gathered(24 * count, positions.iter().flatten().map(|x| x.to_le_bytes())))?;
        if let Some(particle) = positions.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
            return Err(io::Error::other(not_finite(header, "position", particle, particles)));
        }
        drop(positions);
        add(out, &gathered(4 * count, (0..count).map(|i| (i as i32).to_le_bytes())))?;
        add(out, &gathered(4 * count, (1..=count).map(|i| (i as i32).to_le_bytes())))?;
        for field in &fields {
            // One field at a time: a copy of all would double the memory of a run.
            let column = read(field.name)?;
            if let Some(particle) = first_not_finite(&column) {
                return Err(io::Error::other(not_finite(header, field.name, particle, particles)));
            }
            add(out, &column_bytes(&column))?;
        }
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")?;
        let end = out.stream_position()?;
        out.seek(SeekFrom::Start(start))?;
        out.write_all(self.head(header, count, &fields, &offsets).as_bytes())?;
        out.seek(SeekFrom::Start(end)).map(drop)
    }

    /// What the first element of a file says of its values.
    pub(super) fn attributes(&self) -> String {
        let compressor = if self.is_compressed { format!(" compressor=\"{COMPRESSOR}\"") } else { String::new() };
        format!("version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}")
    }

    /// The element of what a frame states beside its particles.
    pub(super) fn field_data(&self, header: &FrameHeader, fields: &[&FieldInfo]) -> String {
        let spacings: Vec<String> = header.body_spacing.iter().map(|s| format!("{s:e}")).collect();
        let names = strings("BodyName", self.bodies.iter().map(|body| body.name.clone()));
        let materials = strings("BodyMaterial", self.bodies.iter().map(|body| body.material.clone()));
        let unit = |field: &&&FieldInfo| !field.unit.is_empty();
        let position = std::iter::once("Points: m".to_owned());
        let units =
            fields.iter().filter(unit).map(|field| format!("{}: {}", field.name, field_unit(field, header.dimensions)));
        let units = strings("Units", position.chain(units));
        format!(
            r#"    <FieldData>
      <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time:e}</DataArray>
      <DataArray type="Int64" Name="Step" NumberOfTuples="1" format="ascii">{step}</DataArray>
      <DataArray type="Int64" Name="Dimensions" NumberOfTuples="1" format="ascii">{dimensions}</DataArray>
      <DataArray type="Float64" Name="BodySpacing" NumberOfTuples="{bodies}" format="ascii">{spacing}</DataArray>
{names}{materials}{units}    </FieldData>
"#,
            time = header.time,
            step = header.step,
            dimensions = header.dimensions,
            bodies = header.body_spacing.len(),
            spacing = spacings.join(" "),
        )
    }

    /// The XML up to the first byte of the arrays; of one length whatever the offsets are.
    fn head(&self, header: &FrameHeader, count: usize, fields: &[&FieldInfo], offsets: &[u64]) -> String {
        let mut offsets = offsets.iter();
        let mut offset = || format!("offset=\"{}\"", offsets.next().unwrap_or(&0));
        let mut text = format!(
            r#"<?xml version="1.0"?>
<VTKFile type="PolyData" {attributes}>
  <PolyData>
{field_data}    <Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" {points:OFFSET$}>
          {metre}
        </DataArray>
      </Points>
      <Verts>
        <DataArray type="Int32" Name="connectivity" format="appended" {connectivity:OFFSET$}/>
        <DataArray type="Int32" Name="offsets" format="appended" {ends:OFFSET$}/>
      </Verts>
      <PointData>
"#,
            attributes = self.attributes(),
            field_data = self.field_data(header, fields),
            points = offset(),
            connectivity = offset(),
            ends = offset(),
            metre = unit_label("m"),
        );
        for field in fields {
            let place = format!(" format=\"appended\" {:OFFSET$}", offset());
            let _ = write!(text, "        {}", array_element("DataArray", field, header.dimensions, &place));
        }
        text.push_str("      </PointData>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _");
        text
    }
}

/// The element of an array of a field: a line, or three with its unit.
pub(super) fn array_element(tag: &str, field: &FieldInfo, dimensions: usize, place: &str) -> String {
    let FieldInfo { name, kind, .. } = field;
    let (width, components) = (kind.width(), component_names(*kind));
    let value_type = if *kind == ColumnKind::Integer { "UInt32" } else { "Float32" };
    let components: String =
        components.iter().enumerate().map(|(k, name)| format!(r#" ComponentName{k}="{name}""#)).collect();
    let start = format!(r#"<{tag} type="{value_type}" Name="{name}" NumberOfComponents="{width}"{components}{place}"#);
    match field_unit(field, dimensions) {
        "" => format!("{start}/>\n"),
        unit => format!("{start}>\n          {}\n        </{tag}>\n", unit_label(unit)),
    }
}

/// Characters of `offset="..."` with the largest number.
const OFFSET: usize = 9 + 20;

/// Writes a frame of nameless bodies; see [`FrameWriter::write`].
///
/// # Errors
/// As there.
pub fn write_frame(
    out: &mut (impl Write + Seek),
    header: &FrameHeader,
    particles: &dyn FieldSource,
    fields: &[String],
) -> io::Result<()> {
    FrameWriter::default().write(out, header, particles, fields)
}

/// About the bytes of a frame that is not compressed.
pub(crate) fn uncompressed_bytes(count: usize, fields: &[String]) -> u64 {
    const HEADER: u64 = 3000;
    let fields = fields.iter().filter(|name| *name != "position").filter_map(|name| find_field(name));
    let values = fields.map(|field| 4 * field.kind.width() as u64).sum::<u64>();
    HEADER + count as u64 * (24 + 8 + values)
}

/// Fields by their names, each once.
pub(super) fn written_fields(names: &[String]) -> io::Result<Vec<&'static FieldInfo>> {
    let mut fields: Vec<&FieldInfo> = Vec::with_capacity(names.len());
    for name in names.iter().filter(|name| *name != "position") {
        let field = find_field(name)
            .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, format!("there is no field `{name}`")))?;
        if !fields.iter().any(|f| f.name == field.name) {
            fields.push(field);
        }
    }
    Ok(fields)
}

/// What VTK calls the unit of an array.
pub(super) fn unit_label(unit: &str) -> String {
    format!(r#"<InformationKey name="UNITS_LABEL" location="vtkDataArray">{unit}</InformationKey>"#)
}

/// An array of words, as VTK writes them: signed bytes, each word closed by a zero.
fn strings(name: &str, words: impl Iterator<Item = String>) -> String {
    let words: Vec<String> = words
        .map(|word| word.bytes().chain([0]).map(|byte| (byte as i8).to_string()).collect::<Vec<_>>().join(" "))
        .collect();
    if words.is_empty() {
        return String::new();
    }
    let (count, values) = (words.len(), words.join(" "));
    format!(
        "      <Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{count}\" format=\"ascii\">{values}</Array>\n"
    )
}

/// The first particle whose value is none that a frame can have: not a number, or beyond single precision.
fn first_not_finite(column: &Column) -> Option<usize> {
    let is_none = |x: f64| !(x as f32).is_finite();
    match column {
        Column::Scalar(c) => c.iter().position(|x| is_none(*x)),
        Column::Integer(_) => None,
        Column::Vector(c) => c.iter().position(|v| v.iter().any(|x| is_none(*x))),
        Column::Symmetric(c) => c.iter().position(|s| s.to_array().into_iter().any(is_none)),
        Column::Tensor(c) => c.iter().position(|t| t.iter().flatten().any(|x| is_none(*x))),
    }
}

/// What ends a run that has come to such a value.
fn not_finite(header: &FrameHeader, field: &'static str, index: usize, particles: &dyn FieldSource) -> RunFailure {
    let number = |name: &str| match particles.read(name) {
        Ok(Column::Integer(column)) => column.get(index).copied(),
        _ => None,
    };
    let position = match particles.read("position") {
        Ok(Column::Vector(column)) => column.get(index).copied(),
        _ => None,
    };
    RunFailure {
        step: header.step,
        time: header.time,
        field,
        particle: number("id"),
        body: number("body"),
        position,
        message: format!(
            "`{field}` is not finite, or beyond what a frame can hold; check the constants of the material and the units of the deck"
        ),
        step_may_be_smaller: false,
    }
}

fn column_bytes(column: &Column) -> Vec<u8> {
    let bytes = 4 * column.kind().width() * column.len();
    let single = |x: &f64| (*x as f32).to_le_bytes();
    match column {
        Column::Scalar(c) => gathered(bytes, c.iter().map(single)),
        Column::Integer(c) => gathered(bytes, c.iter().map(|x| x.to_le_bytes())),
        Column::Vector(c) => gathered(bytes, c.iter().flatten().map(single)),
        Column::Symmetric(c) => gathered(bytes, c.iter().flat_map(|s| s.to_array()).map(|x| single(&x))),
        Column::Tensor(c) => gathered(bytes, c.iter().flatten().flatten().map(single)),
    }
}

fn gathered<const N: usize>(bytes: usize, values: impl Iterator<Item = [u8; N]>) -> Vec<u8> {
    let mut all = Vec::with_capacity(bytes);
    values.for_each(|value| all.extend_from_slice(&value));
    all
}
