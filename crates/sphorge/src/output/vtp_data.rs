//! Arrays of numbers behind the header of a frame: little-endian bytes as they are, or compressed.
//!
//! As they are, an array is its length in bytes and the bytes. Compressed, it is cut into blocks of [`BLOCK`] bytes, each a zlib stream of
//! its own, so that threads work side by side: the number of blocks, the bytes of a block, those of the last one (0 if it is whole), the
//! compressed bytes of each; then the streams. Lengths are `UInt64`. This is the form of VTK's `vtkZLibDataCompressor`.

use super::atomic::Sink;
use flate2::{Compression, bufread::ZlibDecoder, write::ZlibEncoder};
use rayon::prelude::*;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Bytes of a block before it is compressed: a multiple of every value. Larger ones are not smaller compressed.
const BLOCK: usize = 1 << 16;
/// Blocks that are compressed before they are written: bounds the memory beside the array itself.
const BLOCKS_AT_ONCE: usize = 64;
/// Deflate makes at most 1032 bytes of one.
const MOST_FROM_A_BYTE: u64 = 1032;

/// VTK's name of the compression.
pub(super) const COMPRESSOR: &str = "vtkZLibDataCompressor";

/// Writes an array as it is.
pub(super) fn write_raw(out: &mut dyn Sink, bytes: &[u8]) -> io::Result<()> {
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(bytes)
}

/// Writes an array compressed.
pub(super) fn write_compressed(out: &mut dyn Sink, bytes: &[u8]) -> io::Result<()> {
    let count = bytes.len().div_ceil(BLOCK);
    let mut head = vec![count as u64, BLOCK as u64, (bytes.len() % BLOCK) as u64];
    head.resize(3 + count, 0);
    let start = out.stream_position()?;
    write_numbers(out, &head)?;
    let mut sizes = head[3..].iter_mut();
    for group in bytes.chunks(BLOCKS_AT_ONCE * BLOCK) {
        let streams: Vec<_> = group.par_chunks(BLOCK).map(compress).collect();
        for stream in streams {
            let stream = stream?;
            out.write_all(&stream)?;
            if let Some(size) = sizes.next() {
                *size = stream.len() as u64;
            }
        }
    }
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(start))?;
    write_numbers(out, &head)?;
    out.seek(SeekFrom::Start(end)).map(drop)
}

fn compress(block: &[u8]) -> io::Result<Vec<u8>> {
    // The fastest level: half of the bytes are digits of rounding that no level makes shorter.
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(block.len() / 2), Compression::fast());
    encoder.write_all(block)?;
    encoder.finish()
}

fn write_numbers(out: &mut dyn Sink, numbers: &[u64]) -> io::Result<()> {
    out.write_all(&numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>())
}

/// Reads an array of `expected` bytes that begins at `start` in a file of `file_bytes`. Memory and time are bounded by the bytes of the file.
///
/// # Errors
/// What is wrong with it.
pub(super) fn read(
    file: &mut (impl Read + Seek),
    file_bytes: u64,
    start: u64,
    expected: u64,
    is_compressed: bool,
) -> Result<Vec<u8>, String> {
    let mut reader = Bounded { file, at: start, end: file_bytes };
    if !is_compressed {
        return match reader.number()? {
            length if length == expected => reader.bytes(length),
            _ => Err(OTHER_LENGTH.to_owned()),
        };
    }
    let [count, block, rest] = [reader.number()?, reader.number()?, reader.number()?];
    let whole = if rest == 0 { count } else { count.saturating_sub(1) };
    if whole.checked_mul(block).and_then(|bytes| bytes.checked_add(rest)) != Some(expected) {
        return Err(OTHER_LENGTH.to_owned());
    }
    if count.checked_mul(8).is_none_or(|bytes| bytes > reader.left()) {
        return Err(ENDS_EARLY.to_owned());
    }
    let sizes: Vec<u64> = (0..count).map(|_| reader.number()).collect::<Result<_, _>>()?;
    let compressed = sizes.iter().try_fold(0u64, |sum, size| sum.checked_add(*size));
    let compressed = compressed.filter(|bytes| *bytes <= reader.left()).ok_or(ENDS_EARLY)?;
    if compressed.checked_mul(MOST_FROM_A_BYTE).is_none_or(|most| expected > most) {
        return Err("a block is too short for its stated length".to_owned());
    }
    let mut bytes = Vec::new();
    for (k, size) in sizes.into_iter().enumerate() {
        let length = if (k as u64) < whole { block } else { rest };
        let stream = reader.bytes(size)?;
        let before = bytes.len() as u64;
        // One byte more than there should be, so that too many are seen.
        let read = ZlibDecoder::new(stream.as_slice()).take(length + 1).read_to_end(&mut bytes);
        read.map_err(|error| format!("a block cannot be decompressed: {error}"))?;
        if bytes.len() as u64 - before != length {
            return Err(OTHER_LENGTH.to_owned());
        }
    }
    Ok(bytes)
}

const ENDS_EARLY: &str = "the file ends early";
const OTHER_LENGTH: &str = "the length of a block differs from that in the header";

/// Reads forward in a file whose length is known, before memory is taken for what it is said to hold.
struct Bounded<'a, F> {
    file: &'a mut F,
    at: u64,
    end: u64,
}

impl<F: Read + Seek> Bounded<'_, F> {
    fn left(&self) -> u64 {
        self.end.saturating_sub(self.at)
    }

    fn bytes(&mut self, count: u64) -> Result<Vec<u8>, String> {
        if count > self.left() {
            return Err(ENDS_EARLY.to_owned());
        }
        let mut bytes = vec![0; count as usize];
        let read = self.file.seek(SeekFrom::Start(self.at)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(|error| error.to_string())?;
        self.at += count;
        Ok(bytes)
    }

    fn number(&mut self) -> Result<u64, String> {
        let bytes = self.bytes(8)?;
        Ok(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Bytes that compress to about a half, so many that there are several groups of blocks, the last of them not whole.
    fn bytes() -> Vec<u8> {
        let mixed = |i: u32| if i.is_multiple_of(2) { 0 } else { (i.wrapping_mul(2_654_435_761) >> 24) as u8 };
        (0..(BLOCKS_AT_ONCE * BLOCK + 2 * BLOCK + 12) as u32).map(mixed).collect()
    }

    fn written(bytes: &[u8]) -> Vec<u8> {
        let mut file = Cursor::new(b"before".to_vec());
        file.seek(SeekFrom::End(0)).unwrap();
        write_compressed(&mut file, bytes).unwrap();
        file.write_all(b"behind").unwrap();
        file.into_inner()
    }

    fn read_back(file: &[u8], expected: usize) -> Result<Vec<u8>, String> {
        read(&mut Cursor::new(file), file.len() as u64, 6, expected as u64, true)
    }

    #[test]
    fn what_is_compressed_comes_back_and_what_follows_is_left_alone() {
        for bytes in [Vec::new(), vec![7; 24], vec![7; BLOCK], bytes()] {
            let file = written(&bytes);
            assert!(file.starts_with(b"before") && file.ends_with(b"behind"));
            assert!(read_back(&file, bytes.len()).unwrap() == bytes, "{} bytes", bytes.len());
            assert!(bytes.len() < 1000 || file.len() < 7 * bytes.len() / 10, "{} of {}", file.len(), bytes.len());
        }
    }

    /// Sets one of the numbers before the streams.
    fn with_number(file: &[u8], index: usize, number: u64) -> Vec<u8> {
        let mut changed = file.to_vec();
        changed[6 + 8 * index..14 + 8 * index].copy_from_slice(&number.to_le_bytes());
        changed
    }

    #[test]
    fn what_promises_more_than_the_file_holds_is_refused_before_memory_is_taken() {
        let file = written(&[7; 100]);
        let refused = |index, number, expected| read_back(&with_number(&file, index, number), expected).unwrap_err();
        assert_eq!(refused(2, 99, 100), OTHER_LENGTH);
        assert_eq!(refused(0, u64::MAX, 100), OTHER_LENGTH);
        assert_eq!(refused(3, u64::MAX, 100), ENDS_EARLY);
        // A block of 2^60 bytes in a stream of a few.
        assert!(refused(2, 1 << 60, 1 << 60).contains("is too short for its stated length"));
        // As many blocks of no bytes.
        let none = with_number(&with_number(&file, 1, 0), 2, 0);
        assert_eq!(read_back(&with_number(&none, 0, 1 << 59), 0).unwrap_err(), ENDS_EARLY);
        // A block that holds more, or less, than it says.
        for length in [99, 101] {
            assert_eq!(refused(2, length, length as usize), OTHER_LENGTH);
        }
        let mut torn = file.clone();
        torn[6 + 32 + 4] ^= 0x55;
        assert!(read_back(&torn, 100).is_err());
    }
}
