//! Writes one frame as VTK XML PolyData (`.vtp`).
//!
//! Values are raw, little-endian, appended after the XML header; each block is preceded by its length as `UInt64`.
//! Points are `Float64`: displacements of elastic cases are below the resolution of `Float32` coordinates. Fields are
//! `Float32`, whole numbers `UInt32`. Every particle is a vertex cell, so that ParaView shows and thresholds it. Field data
//! carry what a reader needs beside the particles: `TimeValue` (s), `Step`, `Dimensions`, `BodySpacing` (m, one value a
//! body).

use crate::engine::FieldSource;
use crate::particles::{Column, ColumnKind, FieldInfo, find_field};
use std::io::{self, Write};

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

/// VTK's names of components.
pub(super) fn component_names(kind: ColumnKind) -> &'static [&'static str] {
    match kind {
        ColumnKind::Scalar | ColumnKind::Integer => &[],
        ColumnKind::Vector => &["X", "Y", "Z"],
        ColumnKind::Symmetric => &["XX", "YY", "ZZ", "XY", "YZ", "XZ"],
        ColumnKind::Tensor => &["XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"],
    }
}

/// Number of particles a file can hold: VTK's connectivity is written as `Int32`.
const MAX_PARTICLES: usize = i32::MAX as usize;

/// Writes a frame with the named fields, particles in the order they are read in. The position is written as the points, wherever it stands among `fields`.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] for a name that is not in [`crate::particles::FIELDS`] or more than 2³¹ - 1 particles;
/// otherwise what the writer reports.
pub fn write_frame(
    out: &mut dyn Write,
    header: &FrameHeader,
    particles: &dyn FieldSource,
    fields: &[String],
) -> io::Result<()> {
    let count = particles.count();
    if count > MAX_PARTICLES {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("{count} particles do not fit a frame")));
    }
    let mut written: Vec<&FieldInfo> = Vec::with_capacity(fields.len());
    for name in fields.iter().filter(|name| *name != "position") {
        let field = find_field(name)
            .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, format!("there is no field `{name}`")))?;
        if !written.iter().any(|f| f.name == field.name) {
            written.push(field);
        }
    }

    let read = |field: &str| particles.read(field).map_err(io::Error::other);
    write_header(out, header, count, &written)?;
    let Column::Vector(positions) = read("position")? else {
        return Err(io::Error::other("positions are no vectors"));
    };
    write_block(out, 24 * count, positions.iter().flatten().map(|x| x.to_le_bytes()))?;
    drop(positions);
    write_block(out, 4 * count, (0..count).map(|i| (i as i32).to_le_bytes()))?;
    write_block(out, 4 * count, (1..=count).map(|i| (i as i32).to_le_bytes()))?;
    for field in &written {
        // One field at a time: a copy of all would double the memory of a run.
        write_column(out, &read(field.name)?)?;
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

fn write_header(out: &mut dyn Write, header: &FrameHeader, count: usize, fields: &[&FieldInfo]) -> io::Result<()> {
    let spacings: Vec<String> = header.body_spacing.iter().map(|s| format!("{s:e}")).collect();
    write!(
        out,
        r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
      <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time:e}</DataArray>
      <DataArray type="Int64" Name="Step" NumberOfTuples="1" format="ascii">{step}</DataArray>
      <DataArray type="Int64" Name="Dimensions" NumberOfTuples="1" format="ascii">{dimensions}</DataArray>
      <DataArray type="Float64" Name="BodySpacing" NumberOfTuples="{bodies}" format="ascii">{spacing}</DataArray>
    </FieldData>
    <Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" offset="0"/>
      </Points>
"#,
        time = header.time,
        step = header.step,
        dimensions = header.dimensions,
        bodies = header.body_spacing.len(),
        spacing = spacings.join(" "),
    )?;
    let connectivity = 8 + 24 * count;
    let offsets = connectivity + 8 + 4 * count;
    let mut offset = offsets + 8 + 4 * count;
    write!(
        out,
        r#"      <Verts>
        <DataArray type="Int32" Name="connectivity" format="appended" offset="{connectivity}"/>
        <DataArray type="Int32" Name="offsets" format="appended" offset="{offsets}"/>
      </Verts>
      <PointData>
"#
    )?;
    for field in fields {
        let width = field.kind.width();
        let value_type = if field.kind == ColumnKind::Integer { "UInt32" } else { "Float32" };
        write!(out, r#"        <DataArray type="{value_type}" Name="{}" NumberOfComponents="{width}""#, field.name)?;
        for (k, component) in component_names(field.kind).iter().enumerate() {
            write!(out, r#" ComponentName{k}="{component}""#)?;
        }
        writeln!(out, r#" format="appended" offset="{offset}"/>"#)?;
        offset += 8 + 4 * width * count;
    }
    out.write_all(b"      </PointData>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _")
}

fn write_column(out: &mut dyn Write, column: &Column) -> io::Result<()> {
    let bytes = 4 * column.kind().width() * column.len();
    let single = |x: &f64| (*x as f32).to_le_bytes();
    match column {
        Column::Scalar(c) => write_block(out, bytes, c.iter().map(single)),
        Column::Integer(c) => write_block(out, bytes, c.iter().map(|x| x.to_le_bytes())),
        Column::Vector(c) => write_block(out, bytes, c.iter().flatten().map(single)),
        Column::Symmetric(c) => write_block(out, bytes, c.iter().flat_map(|s| s.to_array()).map(|x| single(&x))),
        Column::Tensor(c) => write_block(out, bytes, c.iter().flatten().flatten().map(single)),
    }
}

/// Length, then values; gathered in chunks because the writer is called through a pointer.
fn write_block<const N: usize>(
    out: &mut dyn Write,
    bytes: usize,
    values: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    out.write_all(&(bytes as u64).to_le_bytes())?;
    let mut chunk = Vec::with_capacity(1 << 14);
    for value in values {
        chunk.extend_from_slice(&value);
        if chunk.len() + N > chunk.capacity() {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    out.write_all(&chunk)
}
