//! One archive for all ranks: it holds what one process would save, whoever saves and whoever loads it.

use super::Ranks;
use crate::RunFailure;
use crate::persist::{Archive, ArchiveError, Fixed, Split};

/// An archive as each rank sees it; the first one has it. Values that are the same on all ranks are those of the first, pieces lie one behind the
/// other in the order of the ranks. All ranks save or load the same names in the same order. A rank that cannot load a value may stop: the others
/// go on with it once it is dropped, or the first one tells them.
pub struct SharedArchive<'a> {
    ranks: &'a Ranks,
    /// On the first rank.
    whole: Option<&'a mut dyn Archive>,
    is_saving: bool,
    split: Split,
    lost: Option<RunFailure>,
    has_ended: bool,
}

/// What the first rank says comes next.
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

/// A value as its first rank tells of it: what it is, and its bytes.
type Header = (u8, usize);

impl<'a> SharedArchive<'a> {
    /// To save to; the first rank gives the archive.
    pub fn to_save(ranks: &'a Ranks, whole: Option<&'a mut dyn Archive>) -> Self {
        Self { ranks, whole, is_saving: true, split: Split::Same, lost: None, has_ended: false }
    }

    /// To load from; the first rank gives the archive.
    pub fn to_load(ranks: &'a Ranks, whole: Option<&'a mut dyn Archive>) -> Self {
        Self { is_saving: false, ..Self::to_save(ranks, whole) }
    }

    /// Ends what all ranks have loaded, some of them not all of it.
    ///
    /// # Errors
    /// A rank was lost.
    pub fn end(mut self) -> Result<(), RunFailure> {
        if self.lost.is_none() && !self.is_saving && !self.has_ended {
            if self.ranks.rank() == 0 {
                self.ranks.broadcast(&header(Next::End, 0), Header::SIZE)?;
            } else {
                self.split = Split::Same;
                // What the others still load.
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

    /// Notes a lost rank, and says of a value that it is missing.
    fn or_lost<V>(&mut self, result: Result<V, RunFailure>) -> Result<V, ArchiveError> {
        result.map_err(|failure| {
            let error = ArchiveError::Unsupported(failure.message.clone());
            self.lost = Some(failure);
            error
        })
    }

    /// Joins the pieces of all ranks on the first one.
    fn send(&mut self, name: &str, bytes: Vec<u8>) {
        let own = bytes.len();
        let of_all = match self.split {
            Split::Same => Ok(vec![bytes]),
            Split::Pieces(_) => self.ranks.gather_bytes(bytes),
        };
        if let Ok(pieces) = self.or_lost(of_all)
            && let Some(whole) = &mut self.whole
        {
            debug_assert!(pieces.first().is_none_or(|piece| piece.len() == own));
            whole.save(name, pieces.concat());
        }
    }

    /// Takes what the first rank has.
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
        let loaded = self.whole.as_mut().map(|whole| whole.load(name));
        let next = match (&loaded, self.split) {
            (Some(Err(_)), _) => header(Next::Fault, 0),
            (Some(Ok(bytes)), Split::Same) => header(Next::Same, bytes.len()),
            (Some(Ok(bytes)), Split::Pieces(_)) => header(Next::Pieces, bytes.len()),
            (None, _) => Vec::new(),
        };
        let next = self.ranks.broadcast(&next, Header::SIZE)?;
        let (next, length) = Header::read(&next).unwrap_or_default();
        match Next::ALL.get(next as usize).copied().unwrap_or(Next::End) {
            Next::End => {
                self.has_ended = true;
                Ok(Err(ArchiveError::Missing(name.to_owned())))
            }
            Next::Fault => Ok(loaded.unwrap_or_else(|| Err(ArchiveError::Missing(name.to_owned())))),
            Next::Same => {
                let own = loaded.and_then(Result::ok).unwrap_or_default();
                self.ranks.broadcast(&own, length).map(Ok)
            }
            Next::Pieces => {
                let count = if let Split::Pieces(count) = self.split { count } else { 0 };
                let counts = self.ranks.gather_one(count)?;
                let all: usize = counts.iter().sum();
                // As many bytes of each value, or none that could be told apart.
                let width = length.checked_div(all).unwrap_or(0);
                let fits = width * all == length;
                let bytes = loaded.and_then(Result::ok).unwrap_or_default();
                let mut rest = &bytes[..];
                let pieces = counts.iter().map(|count| {
                    let (piece, behind) = rest.split_at((count * width).min(rest.len()));
                    rest = behind;
                    piece.to_vec()
                });
                let own = self.ranks.scatter_bytes(pieces.collect())?;
                Ok(if fits { Ok(own) } else { Err(ArchiveError::Mismatch(name.to_owned())) })
            }
        }
    }
}

fn header(next: Next, length: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(Header::SIZE);
    (next as u8, length).write(&mut bytes);
    bytes
}

impl Archive for SharedArchive<'_> {
    fn is_saving(&self) -> bool {
        self.is_saving
    }

    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        if self.lost.is_none() {
            self.send(name, bytes);
        }
    }

    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        self.receive(name)
    }

    fn split(&mut self, split: Split) {
        self.split = split;
    }
}
