//! One archive for all ranks: it contains what one process would save, on any number of ranks.
//!
//! Either the first rank has all of it, or each rank a part: its own pieces and, on the first rank, the values that are
//! the same on all.

use super::Ranks;
use crate::RunFailure;
use crate::persist::{Archive, ArchiveError, Fixed, Split};

/// An archive as each rank sees it. Values that are the same on all ranks are those of the first rank; pieces are
/// contiguous in the order of the ranks. All ranks save or load the same names in the same order. A rank that cannot
/// load a value may stop: the archive continues with the others when it is dropped, or the first rank tells them.
pub struct SharedArchive<'a> {
    ranks: &'a Ranks,
    /// The archive of this rank; the first rank always has one.
    own: Option<&'a mut dyn Archive>,
    way: Way,
    split: Split,
    lost: Option<RunFailure>,
    has_ended: bool,
}

/// Direction of the values.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// Saved to the archive of the first rank.
    ToFirst,
    /// Saved to the archive of each rank.
    ToEach,
    /// Loaded from the archives that the ranks have.
    Out,
}

/// Announcement of the first rank: what comes next.
#[derive(Clone, Copy, PartialEq)]
enum Next {
    /// Nothing more.
    End,
    /// A value that is the same on all ranks.
    Same,
    /// Pieces of a value.
    Pieces,
    /// A value that cannot be loaded.
    Fault,
}

impl Next {
    const ALL: [Self; 4] = [Self::End, Self::Same, Self::Pieces, Self::Fault];
}

/// A value as the first rank announces it: its kind and its bytes.
type Header = (u8, usize);

impl<'a> SharedArchive<'a> {
    /// For saving to the archive of the first rank.
    pub fn to_save(ranks: &'a Ranks, whole: Option<&'a mut dyn Archive>) -> Self {
        Self { ranks, own: whole, way: Way::ToFirst, split: Split::Same, lost: None, has_ended: false }
    }

    /// For saving in parts, with the part of this rank. Nothing is sent.
    pub fn to_save_part(ranks: &'a Ranks, part: &'a mut dyn Archive) -> Self {
        Self { way: Way::ToEach, ..Self::to_save(ranks, Some(part)) }
    }

    /// For loading: the first rank provides an archive, and so does any other rank that has one. Parts may come from
    /// another number of ranks, or one part may be the whole.
    pub fn to_load(ranks: &'a Ranks, part: Option<&'a mut dyn Archive>) -> Self {
        Self { way: Way::Out, ..Self::to_save(ranks, part) }
    }

    /// Finishes loading on all ranks, some of which may have stopped.
    ///
    /// # Errors
    /// A rank was lost.
    pub fn end(mut self) -> Result<(), RunFailure> {
        if self.lost.is_none() && self.way == Way::Out && !self.has_ended {
            if self.ranks.rank() == 0 {
                self.ranks.broadcast(&header(Next::End, 0), Header::SIZE)?;
            } else {
                self.split = Split::Same;
                // Values that the others still load.
                while !self.has_ended {
                    let _ = self.receive("");
                    self.check()?;
                }
            }
        }
        self.check()
    }

    fn check(&self) -> Result<(), RunFailure> {
        self.lost.clone().map_or(Ok(()), Err)
    }

    /// Stores the loss of a rank, and reports the value as missing.
    fn or_lost<V>(&mut self, result: Result<V, RunFailure>) -> Result<V, ArchiveError> {
        result.map_err(|failure| {
            let error = ArchiveError::Unsupported(failure.message.clone());
            self.lost = Some(failure);
            error
        })
    }

    /// Joins the pieces of all ranks on the first one.
    fn send(&mut self, name: &str, bytes: Vec<u8>) {
        let of_all = match self.split {
            Split::Same => Ok(vec![bytes]),
            Split::Pieces(_) => self.ranks.gather_bytes(bytes),
        };
        if let Ok(pieces) = self.or_lost(of_all)
            && let Some(whole) = &mut self.own
        {
            whole.save(name, pieces.concat());
        }
    }

    /// Saves what this rank has to save.
    fn keep(&mut self, name: &str, bytes: Vec<u8>) {
        let is_kept = self.ranks.rank() == 0 || self.split != Split::Same;
        if let Some(part) = self.own.as_mut().filter(|_| is_kept) {
            part.save(name, bytes);
        }
    }

    /// Receives the value of the first rank.
    fn receive(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        if let Some(lost) = &self.lost {
            return Err(ArchiveError::Unsupported(lost.message.clone()));
        }
        if self.has_ended {
            return Err(ArchiveError::Missing(name.to_owned()));
        }
        let result = self.take(name);
        self.or_lost(result)?
    }

    fn take(&mut self, name: &str) -> Result<Result<Vec<u8>, ArchiveError>, RunFailure> {
        let is_first = self.ranks.rank() == 0;
        let loaded = if is_first { self.load_own(name) } else { Ok(Vec::new()) };
        let next = match (&loaded, self.split) {
            _ if !is_first => Vec::new(),
            (Err(_), _) => header(Next::Fault, 0),
            (Ok(bytes), Split::Same) => header(Next::Same, bytes.len()),
            (Ok(_), Split::Pieces(_)) => header(Next::Pieces, 0),
        };
        let next = self.ranks.broadcast(&next, Header::SIZE)?;
        let (next, length) = Header::read(&next).unwrap_or_default();
        match Next::ALL.get(next as usize).copied().unwrap_or(Next::End) {
            Next::End => {
                self.has_ended = true;
                Ok(Err(ArchiveError::Missing(name.to_owned())))
            }
            Next::Fault => Ok(loaded.and(Err(ArchiveError::Missing(name.to_owned())))),
            Next::Same => self.ranks.broadcast(&loaded.unwrap_or_default(), length).map(Ok),
            Next::Pieces => {
                let loaded = if is_first { loaded } else { self.load_own(name) };
                self.share_pieces(name, loaded)
            }
        }
    }

    /// A value of the part of this rank; nothing if it has none.
    fn load_own(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.own.as_mut().map_or(Ok(Vec::new()), |part| part.load(name))
    }

    /// The piece of this rank, from those that all ranks have loaded.
    fn share_pieces(
        &self,
        name: &str,
        loaded: Result<Vec<u8>, ArchiveError>,
    ) -> Result<Result<Vec<u8>, ArchiveError>, RunFailure> {
        let count = if let Split::Pieces(count) = self.split { count } else { 0 };
        let is_there = loaded.is_ok();
        let bytes = loaded.unwrap_or_default();
        let of_all = self.ranks.gather_one((is_there, (bytes.len(), count)))?;
        if of_all.iter().any(|(is_there, _)| !is_there) {
            return Ok(Err(ArchiveError::Missing(name.to_owned())));
        }
        let (lengths, counts): (Vec<usize>, Vec<usize>) = of_all.into_iter().map(|(_, of_rank)| of_rank).unzip();
        let (length, all) = (lengths.iter().sum::<usize>(), counts.iter().sum::<usize>());
        // The same number of bytes for each value, or none that could be distinguished.
        let width = length.checked_div(all).unwrap_or(0);
        if width * all != length {
            return Ok(Err(ArchiveError::Mismatch(name.to_owned())));
        }
        let wanted: Vec<usize> = counts.iter().map(|count| count * width).collect();
        self.ranks.share_anew(&bytes, &lengths, &wanted).map(Ok)
    }
}

fn header(next: Next, length: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(Header::SIZE);
    (next as u8, length).write(&mut bytes);
    bytes
}

impl Archive for SharedArchive<'_> {
    fn is_saving(&self) -> bool {
        self.way != Way::Out
    }

    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        match self.way {
            Way::ToEach => self.keep(name, bytes),
            Way::ToFirst if self.lost.is_none() => self.send(name, bytes),
            Way::ToFirst | Way::Out => {}
        }
    }

    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.receive(name)
    }

    fn split(&mut self, split: Split) {
        self.split = split;
    }
}
