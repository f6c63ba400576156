//! Reads frames written by [`super::FrameWriter`] back, in one file or in pieces; other `.vtp` files only as far as their form is the same.

use super::{
    FrameBody, FrameHeader,
    error::{AtPath, OutputError},
    pieces::ORDER,
    regular_file::{self, most},
    vtp_data::{self, COMPRESSOR},
    xml,
};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

/// An opened frame: headers are read, values on demand. Particles come in the order of their `id`, whether one file has them or pieces of many
/// processes.
#[derive(Debug)]
pub struct FrameFile {
    path: PathBuf,
    /// What the frame states beside its particles.
    pub header: FrameHeader,
    /// What the numbers of the field `body` stand for; empty where the frame does not say.
    pub bodies: Vec<FrameBody>,
    /// Number of particles.
    pub count: usize,
    arrays: Vec<FrameArray>,
    pieces: Vec<PieceFile>,
    /// Of each particle, in the order of the pieces, its place in the frame; without it places are those of the one piece.
    places: Option<Vec<u32>>,
}

/// One of the files that hold the values of a frame. It is opened whenever it is read: there may be thousands.
#[derive(Debug)]
struct PieceFile {
    path: PathBuf,
    count: usize,
    /// Where the points begin, and each of the arrays.
    points_offset: u64,
    offsets: Vec<u64>,
    data_start: u64,
    is_compressed: bool,
}

/// What a file of values says beside them.
struct Told {
    header: FrameHeader,
    bodies: Vec<FrameBody>,
    arrays: Vec<FrameArray>,
}

/// What is known of a field in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameArray {
    /// Field name.
    pub name: String,
    /// Components per particle.
    pub width: usize,
    /// Names of the components; empty for a scalar.
    pub components: Vec<String>,
    /// Unit in SI, empty for pure numbers.
    pub unit: String,
    whole_numbers: bool,
}

impl FrameArray {
    /// Whether its values count or number something.
    pub fn is_of_whole_numbers(&self) -> bool {
        self.whole_numbers
    }
}

/// Values of a field in a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameColumn {
    /// Components per particle.
    pub width: usize,
    /// Particle by particle, component by component.
    pub values: Vec<f32>,
}

/// Longest header that is scanned for the beginning of the data.
const MAX_HEADER: usize = 1 << 20;
const DATA_MARK: &str = "<AppendedData encoding=\"raw\">";

impl FrameFile {
    /// Opens a frame and reads its header: a `.vtp` file, or a `.pvtp` file that names the pieces of one.
    ///
    /// # Errors
    /// [`OutputError::Read`] if there is no such file, [`OutputError::Damaged`] if it is not one of our frames.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let is_in_pieces = path.extension().is_some_and(|ending| ending == "pvtp");
        let named = if is_in_pieces { named_pieces(path)? } else { vec![path.to_owned()] };
        let mut opened = named.iter().map(|piece| PieceFile::open(piece));
        let (first, told) = opened.next().ok_or_else(|| OutputError::damaged(path, "it names no pieces"))??;
        let mut pieces = vec![first];
        for piece in opened {
            let (piece, other) = piece?;
            if other.arrays != told.arrays || other.header != told.header || other.bodies != told.bodies {
                return Err(OutputError::damaged(&piece.path, "it belongs to another frame than the first piece"));
            }
            pieces.push(piece);
        }
        let too_many = || OutputError::damaged(path, "too many points");
        let count = pieces.iter().try_fold(0usize, |sum, piece| sum.checked_add(piece.count)).ok_or_else(too_many)?;
        let Told { header, bodies, arrays } = told;
        let mut frame = Self { path: path.to_owned(), header, bodies, count, arrays, pieces, places: None };
        if is_in_pieces {
            frame.places = Some(frame.places_by_id()?);
        }
        Ok(frame)
    }

    /// Whether all of a frame can be read. Of one that is known by the sum of its file, this says something only where that names pieces.
    pub(crate) fn is_whole(path: &Path, is_known: bool) -> bool {
        let is_in_pieces = path.extension().is_some_and(|ending| ending == "pvtp");
        if is_known && !is_in_pieces {
            return true;
        }
        let read = || -> Result<(), OutputError> {
            let mut frame = Self::open(path)?;
            frame.positions()?;
            let names: Vec<String> = frame.arrays.iter().map(|array| array.name.clone()).collect();
            names.iter().try_for_each(|name| frame.column(name).map(drop))
        };
        read().is_ok()
    }

    /// Its file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Fields in the frame.
    pub fn arrays(&self) -> &[FrameArray] {
        &self.arrays
    }

    /// Positions, m.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if the file is shorter than its header says.
    pub fn positions(&mut self) -> Result<Vec<[f64; 3]>, OutputError> {
        let bytes = self.bytes(|piece| piece.points_offset, 24)?;
        let (points, _) = bytes.as_chunks::<24>();
        let coordinate = |p: &[u8; 24], k: usize| f64::from_le_bytes(std::array::from_fn(|b| p[8 * k + b]));
        Ok(points.iter().map(|p| [coordinate(p, 0), coordinate(p, 1), coordinate(p, 2)]).collect())
    }

    /// Values of a field; `None` if the frame does not have it.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if the file is shorter than its header says.
    pub fn column(&mut self, name: &str) -> Result<Option<FrameColumn>, OutputError> {
        let Some(index) = self.arrays.iter().position(|a| a.name == name) else { return Ok(None) };
        let FrameArray { width, whole_numbers, .. } = self.arrays[index];
        let bytes = self.bytes(|piece| piece.offsets[index], 4 * width)?;
        let (values, _) = bytes.as_chunks::<4>();
        let decode = |b: &[u8; 4]| if whole_numbers { u32::from_le_bytes(*b) as f32 } else { f32::from_le_bytes(*b) };
        Ok(Some(FrameColumn { width, values: values.iter().map(decode).collect() }))
    }

    /// Bytes of all particles in the order of the frame, of arrays that begin at `offset` of each piece and hold `width` bytes a particle.
    fn bytes(&self, offset: impl Fn(&PieceFile) -> u64, width: usize) -> Result<Vec<u8>, OutputError> {
        let mut bytes = Vec::new();
        for piece in &self.pieces {
            let block = piece.block(offset(piece), width)?;
            // The block of a frame that is one file is not copied.
            if bytes.is_empty() { bytes = block } else { bytes.extend_from_slice(&block) }
        }
        let Some(places) = &self.places else { return Ok(bytes) };
        let mut sorted = vec![0; bytes.len()];
        for (value, &place) in bytes.chunks_exact(width).zip(places) {
            sorted[place as usize * width..][..width].copy_from_slice(value);
        }
        Ok(sorted)
    }

    /// The places of the particles of the pieces, which are to be those of one frame.
    fn places_by_id(&self) -> Result<Vec<u32>, OutputError> {
        let damaged = |reason: &str| OutputError::damaged(&self.path, reason);
        let index = self.arrays.iter().position(|a| a.name == ORDER && a.width == 1 && a.whole_numbers);
        let index = index.ok_or_else(|| damaged("its pieces have no `id` by which particles are ordered"))?;
        let bytes = self.bytes(|piece| piece.offsets[index], 4)?;
        let (ids, _) = bytes.as_chunks::<4>();
        let places: Vec<u32> = ids.iter().map(|id| u32::from_le_bytes(*id)).collect();
        let mut is_taken = vec![false; self.count];
        for &place in &places {
            match is_taken.get_mut(place as usize) {
                Some(taken) if !*taken => *taken = true,
                _ => return Err(damaged("its pieces do not contain each particle exactly once")),
            }
        }
        Ok(places)
    }
}

/// The files that a `.pvtp` file names.
fn named_pieces(path: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let damaged = |reason: &str| OutputError::damaged(path, reason);
    let text = regular_file::read_to_string(path, most::LIST).reading(path)?;
    let document = xml::parse(&text).map_err(|reason| damaged(&reason))?;
    if document.root_element().attribute("type") != Some("PPolyData") {
        return Err(damaged("it does not name pieces of polydata"));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let pieces = document.descendants().filter(|node| node.has_tag_name("Piece"));
    let source = |node: roxmltree::Node| node.attribute("Source").map(|source| folder.join(source));
    pieces.map(source).collect::<Option<_>>().ok_or_else(|| damaged("a piece has no source"))
}

impl PieceFile {
    fn open(path: &Path) -> Result<(Self, Told), OutputError> {
        let mut file = regular_file::open(path).reading(path)?;
        let (xml, data_start) = read_header(path, &mut file)?;
        let damaged = |reason: &str| OutputError::damaged(path, reason);
        let document = xml::parse(&xml).map_err(|reason| damaged(&reason))?;
        let root = document.root_element();
        let is_compressed = match root.attribute("compressor") {
            None => false,
            Some(COMPRESSOR) => true,
            Some(other) => return Err(damaged(&format!("its values are compressed by `{other}`, not `{COMPRESSOR}`"))),
        };
        if root.attribute("byte_order") != Some("LittleEndian") || root.attribute("header_type") != Some("UInt64") {
            return Err(damaged("values are not little-endian with lengths of 64 bits"));
        }
        let element = |name: &str| root.descendants().find(|n| n.has_tag_name(name));
        let piece = element("Piece").ok_or_else(|| damaged("no piece of data"))?;
        let count = number(piece, "NumberOfPoints").ok_or_else(|| damaged("no number of points"))? as usize;

        let field_text = |name: &str| {
            let array = element("FieldData")?.children().find(|n| n.attribute("Name") == Some(name));
            array?.text()
        };
        let field_data = |name: &str| -> Vec<f64> {
            let words = field_text(name).unwrap_or_default().split_whitespace();
            words.filter_map(|word| word.parse().ok()).collect()
        };
        let first = |name: &str| field_data(name).first().copied().ok_or_else(|| damaged(&format!("no `{name}`")));
        let header = FrameHeader {
            time: first("TimeValue")?,
            step: first("Step")? as u64,
            dimensions: first("Dimensions")? as usize,
            body_spacing: field_data("BodySpacing"),
        };
        let [names, materials] = ["BodyName", "BodyMaterial"].map(|name| strings(field_text(name).unwrap_or_default()));
        let bodies = names.into_iter().zip(materials).map(|(name, material)| FrameBody { name, material }).collect();

        let points_offset = element("Points")
            .and_then(|n| n.children().find(|c| c.has_tag_name("DataArray")))
            .filter(|n| n.attribute("type") == Some("Float64"))
            .and_then(|n| number(n, "offset"))
            .ok_or_else(|| damaged("no points in double precision"))?;
        let arrays: Vec<(FrameArray, u64)> = element("PointData")
            .into_iter()
            .flat_map(|n| n.children())
            .filter(|n| n.has_tag_name("DataArray"))
            .map(|n| frame_array(n).ok_or_else(|| damaged("a field of unknown layout")))
            .collect::<Result<_, _>>()?;
        let (arrays, offsets) = arrays.into_iter().unzip();
        let piece = Self { path: path.to_owned(), count, points_offset, offsets, data_start, is_compressed };
        Ok((piece, Told { header, bodies, arrays }))
    }

    /// Bytes of the block at `offset`, which must hold `width` bytes a particle.
    fn block(&self, offset: u64, width: usize) -> Result<Vec<u8>, OutputError> {
        let damaged = |reason: &str| OutputError::damaged(&self.path, reason);
        let mut file = regular_file::open(&self.path).reading(&self.path)?;
        let file_bytes = file.metadata().reading(&self.path)?.len();
        let expected = (self.count as u64).checked_mul(width as u64).ok_or_else(|| damaged("too many points"))?;
        let start = self.data_start.checked_add(offset).ok_or_else(|| damaged("the file ends early"))?;
        vtp_data::read(&mut file, file_bytes, start, expected, self.is_compressed).map_err(|reason| damaged(&reason))
    }
}

/// The XML before the data, closed so that it parses, and where the data begin.
fn read_header(path: &Path, file: &mut File) -> Result<(String, u64), OutputError> {
    let mut head = Vec::new();
    file.take(MAX_HEADER as u64).read_to_end(&mut head).reading(path)?;
    let mark = head
        .windows(DATA_MARK.len())
        .position(|w| w == DATA_MARK.as_bytes())
        .ok_or_else(|| OutputError::damaged(path, "no appended raw data"))?;
    let after = mark + DATA_MARK.len();
    let underscore = head[after..]
        .iter()
        .position(|b| *b == b'_')
        .ok_or_else(|| OutputError::damaged(path, "the data do not begin"))?;
    let xml = std::str::from_utf8(&head[..after]).map_err(|_| OutputError::damaged(path, "the header is not text"))?;
    Ok((format!("{xml}</AppendedData></VTKFile>"), (after + underscore + 1) as u64))
}

/// Words of an array of VTK: numbers of their bytes, each word closed by a zero.
fn strings(text: &str) -> Vec<String> {
    let bytes: Vec<u8> =
        text.split_whitespace().filter_map(|code| code.parse::<i8>().ok()).map(|code| code as u8).collect();
    let words = bytes.split_inclusive(|byte| *byte == 0);
    words.map(|word| String::from_utf8_lossy(word).trim_end_matches('\0').to_owned()).collect()
}

fn number(node: roxmltree::Node, attribute: &str) -> Option<u64> {
    node.attribute(attribute)?.parse().ok()
}

/// An array, and where its values begin.
fn frame_array(node: roxmltree::Node) -> Option<(FrameArray, u64)> {
    let width = number(node, "NumberOfComponents").unwrap_or(1) as usize;
    if !(1..=9).contains(&width) {
        return None;
    }
    let components =
        (0..width).filter_map(|k| node.attribute(format!("ComponentName{k}").as_str()).map(str::to_owned)).collect();
    let whole_numbers = match node.attribute("type")? {
        "Float32" => false,
        "UInt32" => true,
        _ => return None,
    };
    let label = node.children().find(|n| n.attribute("name") == Some("UNITS_LABEL"));
    let array = FrameArray {
        name: node.attribute("Name")?.to_owned(),
        width,
        components,
        unit: label.and_then(|n| n.text()).unwrap_or_default().trim().to_owned(),
        whole_numbers,
    };
    Some((array, number(node, "offset")?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Particles,
        output::{FrameWriter, write_frame},
    };
    use std::io::Cursor;

    /// Three particles whose values all differ.
    fn particles() -> Particles {
        let mut particles = Particles::new(3);
        for i in 0..3 {
            let x = i as f64 + 1.0;
            particles.id[i] = 7 + i as u32;
            particles.position[i] = [x / 3.0, -x, 1e-9 * x];
            particles.pressure[i] = 1e9 * x;
            particles.deviator[i].xz = -2.0 * x;
            particles.velocity_gradient[i][1][2] = 0.5 * x;
        }
        particles
    }

    fn header() -> FrameHeader {
        FrameHeader { time: 6.1e-5, step: 42, dimensions: 3, body_spacing: vec![3e-4, 1e-3] }
    }

    /// A frame in both forms, compressed first.
    fn frames() -> [Vec<u8>; 2] {
        let fields = ["id", "pressure", "position", "stress", "velocity_gradient", "id"].map(str::to_owned);
        [true, false].map(|is_compressed| {
            let mut file = Cursor::new(Vec::new());
            let writer = FrameWriter { bodies: bodies(), is_compressed };
            writer.write(&mut file, &header(), &particles(), &fields).unwrap();
            file.into_inner()
        })
    }

    fn bodies() -> Vec<FrameBody> {
        [("Büchse", "copper"), ("plate", "")]
            .map(|(name, material)| FrameBody { name: name.into(), material: material.into() })
            .into()
    }

    fn open(bytes: &[u8]) -> (tempfile::TempDir, Result<FrameFile, OutputError>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("000000.vtp");
        std::fs::write(&path, bytes).unwrap();
        let frame = FrameFile::open(&path);
        (folder, frame)
    }

    #[test]
    fn a_frame_comes_back_as_written() {
        for bytes in frames() {
            let (_folder, frame) = open(&bytes);
            let mut frame = frame.unwrap();
            assert_eq!((frame.header.clone(), frame.count), (header(), 3));
            assert_eq!(frame.bodies, bodies());
            let names: Vec<_> = frame.arrays().iter().map(|a| (a.name.as_str(), a.unit.as_str())).collect();
            assert_eq!(names, [("id", ""), ("pressure", "Pa"), ("stress", "Pa"), ("velocity_gradient", "1/s")]);
            assert_eq!(frame.arrays()[2].components, ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]);
            assert_eq!(frame.positions().unwrap(), particles().position);
            assert_eq!(frame.column("id").unwrap().unwrap().values, [7.0, 8.0, 9.0]);
            let stress = frame.column("stress").unwrap().unwrap();
            assert_eq!(stress.values[6..12], [-2e9, -2e9, -2e9, 0.0, 0.0, -4.0]);
            let gradient = frame.column("velocity_gradient").unwrap().unwrap();
            assert_eq!((gradient.width, gradient.values[9 * 2 + 5]), (9, 1.5));
            assert_eq!(frame.column("speed").unwrap(), None);
        }
    }

    #[test]
    fn an_unknown_field_is_an_error() {
        let failed = write_frame(&mut Cursor::new(Vec::new()), &header(), &particles(), &["colour".to_owned()]);
        assert_eq!(failed.unwrap_err().kind(), std::io::ErrorKind::InvalidInput);
    }

    #[test]
    fn a_file_cut_anywhere_is_an_error_and_never_a_panic() {
        for bytes in frames() {
            // The header is text: most places of it are alike.
            let data = bytes.windows(2).position(|w| w == b" _").unwrap();
            for length in (0..data).step_by(97).chain((data..bytes.len() - 40).step_by(3)) {
                let (_folder, frame) = open(&bytes[..length]);
                let read_all = frame.and_then(|mut f| {
                    f.positions()?;
                    for name in ["id", "pressure", "stress", "velocity_gradient"] {
                        f.column(name)?;
                    }
                    Ok(())
                });
                assert!(read_all.is_err(), "cut at {length}");
            }
        }
    }

    /// A frame with another header.
    fn changed(frame: &[u8], from: &str, to: &str) -> Result<(), OutputError> {
        let at = frame.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let (_folder, frame) = open(&[&frame[..at], to.as_bytes(), &frame[at + from.len()..]].concat());
        frame.and_then(|mut frame| frame.positions()).map(drop)
    }

    #[test]
    fn a_header_that_promises_too_much_or_is_of_another_form_is_an_error() {
        for frame in frames() {
            for (from, to) in [
                ("NumberOfComponents=\"6\"", "NumberOfComponents=\"0\""),
                ("NumberOfPoints=\"3\"", "NumberOfPoints=\"18446744073709551615\""),
                ("NumberOfPoints=\"3\"", "NumberOfPoints=\"99999999999999999999999999\""),
                ("NumberOfPoints=\"3\"", "NumberOfPoints=\"4\""),
                ("offset=\"0\"", "offset=\"18446744073709551615\""),
                ("LittleEndian", "BigEndian"),
                ("<PolyData>", "<!DOCTYPE a [<!ENTITY b \"c\">]><PolyData>&b;"),
            ] {
                let error = changed(&frame, from, to);
                assert!(matches!(error, Err(OutputError::Damaged { .. })), "{to}: {error:?}");
            }
        }
        let [compressed, raw] = frames();
        let Err(OutputError::Damaged { reason, .. }) = changed(&compressed, COMPRESSOR, "vtkLZ4DataCompressor") else {
            panic!("it is read")
        };
        assert_eq!(reason, "its values are compressed by `vtkLZ4DataCompressor`, not `vtkZLibDataCompressor`");
        // What is not compressed is not taken for it.
        assert!(changed(&raw, "<VTKFile ", &format!("<VTKFile compressor=\"{COMPRESSOR}\" ")).is_err());
    }
}
