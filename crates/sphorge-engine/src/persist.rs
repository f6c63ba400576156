//! State that a run must survive with: what is saved by a checkpoint and loaded by a resumed run.
//!
//! Every struct that holds such state writes it in one [`Persist::persist`], which serves both directions: what is saved is what is
//! loaded. How an archive is stored is left to the implementation of [`Archive`].
//!
//! State is loaded into what was started with the same model and particles, so sizes are known beforehand: an archive of other sizes is
//! refused, and so are places of particles that there are not. What follows from the rest in the next step is not saved.

use rayon::prelude::*;
use std::collections::BTreeMap;

/// How a value is shared among the ranks of a run, where there are others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// All have the same.
    Same,
    /// This one has so many values of a column, those of its particles or of their blocks.
    Pieces(usize),
}

/// Where each rank of a run keeps its own part of an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Parts {
    /// In its memory, in place of the part it kept there before.
    Memory,
    /// In a file, which these words of the program name to it.
    Files(String),
}

/// Named values, to be written or to be read.
pub trait Archive {
    /// Whether values go into the archive; otherwise they come out of it.
    fn is_saving(&self) -> bool;
    /// Puts a value into the archive.
    fn save(&mut self, name: &str, bytes: Vec<u8>);
    /// Takes a value out of the archive.
    ///
    /// # Errors
    /// There is none of this name.
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError>;
    /// Says how the values to come are shared among ranks; for archives of several.
    fn split(&mut self, split: Split) {
        let _ = split;
    }
    /// Where other ranks keep their parts of the archive, if this one holds a part alone: that of the first rank.
    fn parts(&self) -> Option<Parts> {
        None
    }
}

/// Why an archive cannot be loaded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArchiveError {
    /// A value is not there.
    #[error("the saved state does not contain `{0}`")]
    Missing(String),
    /// A value has another type or length.
    #[error("`{0}` of the saved state has another size or type")]
    Mismatch(String),
    /// The engine keeps its state to itself.
    #[error("{0}")]
    Unsupported(String),
    /// A rank cannot write its part, or read it.
    #[error("{0}")]
    Part(String),
}

/// State that can be saved and loaded.
pub trait Persist {
    /// Saves or loads the value under `name`, as the archive asks for.
    ///
    /// # Errors
    /// See [`ArchiveError`]; the value may then be half loaded.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError>;
}

/// Saves or loads the fields of a struct, each under the name of the struct and its own.
#[macro_export]
macro_rules! persist_fields {
    ($type:ty { $($field:ident),+ $(,)? }) => {
        impl $crate::persist::Persist for $type {
            fn persist(
                &mut self,
                name: &str,
                archive: &mut dyn $crate::persist::Archive,
            ) -> Result<(), $crate::persist::ArchiveError> {
                $( $crate::persist::Persist::persist(&mut self.$field, &format!("{name}.{}", stringify!($field)), archive)?; )+
                Ok(())
            }
        }
    };
}

/// A value of fixed size, written as little-endian bytes.
pub trait Fixed: Sized + Send + Sync {
    /// Number of bytes.
    const SIZE: usize;
    /// Appends the bytes.
    fn write(&self, out: &mut Vec<u8>);
    /// From exactly [`Self::SIZE`] bytes; `None` where they mean nothing.
    fn read(bytes: &[u8]) -> Option<Self>;
}

macro_rules! fixed_numbers {
    ($($number:ty),+) => { $(
        impl Fixed for $number {
            const SIZE: usize = size_of::<$number>();
            fn write(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn read(bytes: &[u8]) -> Option<Self> {
                Some(Self::from_le_bytes(bytes.try_into().ok()?))
            }
        }
    )+ };
}

fixed_numbers!(u8, u32, u64, f32, f64);

impl Fixed for usize {
    const SIZE: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        (*self as u64).write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        usize::try_from(u64::read(bytes)?).ok()
    }
}

impl Fixed for bool {
    const SIZE: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        out.push(u8::from(*self));
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }
}

impl<V: Fixed + Copy, const N: usize> Fixed for [V; N] {
    const SIZE: usize = N * V::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        self.iter().for_each(|v| v.write(out));
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        let first = V::read(bytes.get(..V::SIZE)?)?;
        let mut values = [first; N];
        for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(V::SIZE)) {
            *value = V::read(bytes)?;
        }
        Some(values)
    }
}

impl<A: Fixed, B: Fixed> Fixed for (A, B) {
    const SIZE: usize = A::SIZE + B::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        Some((A::read(bytes.get(..A::SIZE)?)?, B::read(bytes.get(A::SIZE..)?)?))
    }
}

impl<V: Fixed> Fixed for Option<V> {
    const SIZE: usize = 1 + V::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        out.push(u8::from(self.is_some()));
        match self {
            Some(value) => value.write(out),
            None => out.extend(std::iter::repeat_n(0, V::SIZE)),
        }
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        match bool::read(bytes.get(..1)?)? {
            true => Some(Some(V::read(&bytes[1..])?)),
            false => Some(None),
        }
    }
}

impl Fixed for crate::LimitReason {
    const SIZE: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        out.push(*self as u8);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        Self::from_u8(u8::read(bytes)?)
    }
}

impl Fixed for sphorge_physics::SymmetricTensor<f64> {
    const SIZE: usize = 48;
    fn write(&self, out: &mut Vec<u8>) {
        self.to_array().write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        Some(Self::from_array(<[f64; 6]>::read(bytes)?))
    }
}

impl<V: Fixed> Persist for V {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        if archive.is_saving() {
            let mut bytes = Vec::with_capacity(V::SIZE);
            self.write(&mut bytes);
            archive.save(name, bytes);
        } else {
            let bytes = archive.load(name)?;
            let value = if bytes.len() == V::SIZE { V::read(&bytes) } else { None };
            *self = value.ok_or_else(|| ArchiveError::Mismatch(name.to_owned()))?;
        }
        Ok(())
    }
}

/// Values that one thread converts at a time.
const AT_ONCE: usize = 4096;

/// The bytes of all values, one behind the other.
fn bytes_of<V: Fixed>(values: &[V]) -> Vec<u8> {
    let mut bytes = vec![0; values.len() * V::SIZE];
    if V::SIZE > 0 {
        bytes.par_chunks_mut(AT_ONCE * V::SIZE).zip(values.par_chunks(AT_ONCE)).for_each(|(bytes, values)| {
            let mut written = Vec::with_capacity(bytes.len());
            values.iter().for_each(|value| value.write(&mut written));
            bytes.copy_from_slice(&written);
        });
    }
    bytes
}

impl<V: Fixed> Persist for Vec<V> {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        if archive.is_saving() {
            archive.save(name, bytes_of(self));
        } else {
            let bytes = archive.load(name)?;
            let mismatch = || ArchiveError::Mismatch(name.to_owned());
            if V::SIZE == 0 || bytes.len() % V::SIZE != 0 {
                return Err(mismatch());
            }
            let values = bytes.par_chunks_exact(V::SIZE).with_min_len(AT_ONCE).map(V::read);
            *self = values.collect::<Option<Self>>().ok_or_else(mismatch)?;
        }
        Ok(())
    }
}

/// Refuses a value that was loaded unless it fits what it was loaded into.
///
/// # Errors
/// [`ArchiveError::Mismatch`] if it does not.
pub fn require(fits: bool, name: &str) -> Result<(), ArchiveError> {
    if fits { Ok(()) } else { Err(ArchiveError::Mismatch(name.to_owned())) }
}

/// No run takes more steps, nor counts more of anything: a state that says so was not saved by one, and its counts would soon wrap.
pub const MOST_COUNTED: u64 = 1 << 53;

/// Saves or loads a count that grows.
///
/// # Errors
/// See [`ArchiveError`]; a count above [`MOST_COUNTED`] is a mismatch.
pub fn persist_count(count: &mut u64, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
    count.persist(name, archive)?;
    require(*count <= MOST_COUNTED, name)
}

/// Saves or loads a column that is as long as it is.
///
/// # Errors
/// See [`ArchiveError`]; another length is a mismatch.
pub fn persist_column<V: Fixed>(
    values: &mut Vec<V>,
    name: &str,
    archive: &mut dyn Archive,
) -> Result<(), ArchiveError> {
    let length = values.len();
    values.persist(name, archive)?;
    require(values.len() == length, name)
}

/// Saves or loads a column that is as long as it is, of whose values each rank has its own.
///
/// # Errors
/// See [`persist_column`].
pub fn persist_pieces<V: Fixed>(
    values: &mut Vec<V>,
    name: &str,
    archive: &mut dyn Archive,
) -> Result<(), ArchiveError> {
    archive.split(Split::Pieces(values.len()));
    let result = persist_column(values, name, archive);
    archive.split(Split::Same);
    result
}

/// Saves or loads a column that has `count` values on this rank, or none on any.
///
/// # Errors
/// See [`ArchiveError`]; another length is a mismatch.
pub fn persist_pieces_or_none<V: Fixed>(
    values: &mut Vec<V>,
    count: usize,
    name: &str,
    archive: &mut dyn Archive,
) -> Result<(), ArchiveError> {
    archive.split(Split::Pieces(count));
    let result = values.persist(name, archive);
    archive.split(Split::Same);
    result?;
    require(values.is_empty() || values.len() == count, name)
}

/// Saves or loads parts that are no fixed values, as many as there are.
///
/// # Errors
/// See [`ArchiveError`].
pub fn persist_all<P: Persist + Default>(
    parts: &mut Vec<P>,
    name: &str,
    archive: &mut dyn Archive,
) -> Result<(), ArchiveError> {
    let mut count = parts.len();
    count.persist(&format!("{name}.count"), archive)?;
    parts.truncate(count);
    // One by one: a count that is wrong ends at the first part that is not there, before it takes memory.
    for k in 0..count {
        if k == parts.len() {
            parts.push(P::default());
        }
        parts[k].persist(&format!("{name}.{k}"), archive)?;
    }
    Ok(())
}

/// Saves or loads parts that are as many as they are.
///
/// # Errors
/// See [`ArchiveError`]; another number is a mismatch.
pub fn persist_each<P: Persist>(parts: &mut [P], name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
    let mut count = parts.len();
    count.persist(&format!("{name}.count"), archive)?;
    require(count == parts.len(), &format!("{name}.count"))?;
    for (k, part) in parts.iter_mut().enumerate() {
        part.persist(&format!("{name}.{k}"), archive)?;
    }
    Ok(())
}

/// Saves or loads what may not be there.
///
/// # Errors
/// See [`ArchiveError`].
pub fn persist_option<P: Persist + Default>(
    part: &mut Option<P>,
    name: &str,
    archive: &mut dyn Archive,
) -> Result<(), ArchiveError> {
    let mut is_there = part.is_some();
    is_there.persist(&format!("{name}.is_there"), archive)?;
    if !is_there {
        *part = None;
        return Ok(());
    }
    part.get_or_insert_default().persist(name, archive)
}

/// An archive in memory.
#[derive(Clone, Debug, Default)]
pub struct MemoryArchive {
    values: BTreeMap<String, Vec<u8>>,
    is_loading: bool,
    is_part: bool,
}

impl MemoryArchive {
    /// An empty archive to save to.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty archive for what the first rank has; others keep theirs in their own memory, each the last one alone.
    pub fn in_parts() -> Self {
        Self { is_part: true, ..Self::default() }
    }

    /// The same values, to load from.
    #[must_use]
    pub fn to_load(mut self) -> Self {
        self.is_loading = true;
        self
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.values().map(Vec::len).sum()
    }

    /// The same values, to load from as often as is wanted.
    pub fn reader(&self) -> impl Archive + '_ {
        Reader(self)
    }
}

/// Reads an archive in memory and leaves it as it is.
struct Reader<'a>(&'a MemoryArchive);

impl Archive for Reader<'_> {
    fn is_saving(&self) -> bool {
        false
    }
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.0.values.get(name).cloned().ok_or_else(|| ArchiveError::Missing(name.to_owned()))
    }
    fn parts(&self) -> Option<Parts> {
        self.0.parts()
    }
}

/// Counts the bytes of what is saved, and keeps none.
#[derive(Clone, Copy, Debug, Default)]
pub struct ByteCount(
    /// Bytes so far.
    pub u64,
);

impl Archive for ByteCount {
    fn is_saving(&self) -> bool {
        true
    }
    fn save(&mut self, _: &str, bytes: Vec<u8>) {
        self.0 += bytes.len() as u64;
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        Err(ArchiveError::Missing(name.to_owned()))
    }
}

impl Archive for MemoryArchive {
    fn is_saving(&self) -> bool {
        !self.is_loading
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        let former = self.values.insert(name.to_owned(), bytes);
        debug_assert!(former.is_none(), "`{name}` is saved twice");
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.values.remove(name).ok_or_else(|| ArchiveError::Missing(name.to_owned()))
    }
    fn parts(&self) -> Option<Parts> {
        self.is_part.then_some(Parts::Memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Default, PartialEq)]
    struct State {
        time: f64,
        count: usize,
        last: Option<(f64, bool)>,
        column: Vec<[f64; 3]>,
    }
    persist_fields!(State { time, count, last, column });

    #[test]
    fn what_is_saved_is_loaded() {
        let mut state =
            State { time: -0.1, count: 7, last: Some((f64::INFINITY, true)), column: vec![[1.0, 2.0, 3.0]; 2] };
        let mut archive = MemoryArchive::new();
        state.persist("state", &mut archive).unwrap();
        assert_eq!(archive.bytes(), 8 + 8 + 10 + 48);
        let mut loaded = State { column: vec![[0.0; 3]; 9], ..State::default() };
        loaded.persist("state", &mut archive.to_load()).unwrap();
        assert_eq!(loaded, state);
    }

    #[test]
    fn what_is_of_another_length_or_number_is_named() {
        let mut archive = MemoryArchive::new();
        vec![1.0f64, 2.0].persist("column", &mut archive).unwrap();
        persist_all(&mut vec![1u8, 2], "parts", &mut archive).unwrap();
        (u64::MAX >> 1).persist("many.count", &mut archive).unwrap();
        let archive = archive.to_load();
        let mismatch = |name: &str| Err(ArchiveError::Mismatch(name.into()));
        assert_eq!(persist_column(&mut vec![0.0f64; 3], "column", &mut archive.clone()), mismatch("column"));
        assert_eq!(persist_each(&mut [0u8; 3], "parts", &mut archive.clone()), mismatch("parts.count"));
        let mut parts = vec![0u8; 3];
        persist_all(&mut parts, "parts", &mut archive.clone()).unwrap();
        assert_eq!(parts, [1, 2]);
        let missing = persist_all(&mut parts, "many", &mut archive.clone());
        assert_eq!(missing, Err(ArchiveError::Missing("many.0".into())));
    }

    #[test]
    fn what_is_missing_or_of_another_kind_is_named() {
        let mut archive = MemoryArchive::new();
        vec![1u8, 2, 3].persist("short", &mut archive).unwrap();
        2u8.persist("flag", &mut archive).unwrap();
        let mut archive = archive.to_load();
        assert_eq!(1.0f64.persist("no", &mut archive), Err(ArchiveError::Missing("no".into())));
        assert_eq!(Vec::<f64>::new().persist("short", &mut archive), Err(ArchiveError::Mismatch("short".into())));
        assert_eq!(true.persist("flag", &mut archive), Err(ArchiveError::Mismatch("flag".into())));
    }
}
