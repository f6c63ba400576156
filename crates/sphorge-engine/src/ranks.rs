//! Ranks: processes, or threads in their place, that share the particles of a run.
//!
//! A [`Communicator`] carries bytes between them. Every call is collective: all ranks make it, in the same order.

mod archive;
mod fault;
mod files;

pub use archive::SharedArchive;
pub use fault::StepFault;
pub use files::{Loaded, RankFiles};

use crate::persist::Fixed;
use crate::{Column, RunFailure};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Transport of bytes between ranks. A rank sends nothing to itself.
pub trait Communicator: Send + Sync + std::fmt::Debug {
    /// Number of this rank, from zero on.
    fn rank(&self) -> usize;
    /// Number of ranks.
    fn size(&self) -> usize;
    /// Begins to send `to[r]` to rank `r` and to receive `lengths[r]` bytes from it, without waiting. Empty messages
    /// are not sent. An exchange is finished before the next one begins.
    ///
    /// # Errors
    /// A rank is lost, with the reason.
    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String>;
}

/// Messages in flight from a rank to others and from them to it.
pub trait Messages: Send + Sync {
    /// Lets them make progress if that needs the processor, without waiting.
    fn advance(&mut self) {}
    /// Waits for all of them; returns the message of each rank.
    ///
    /// # Errors
    /// A rank is lost, with the reason.
    fn finish(self: Box<Self>) -> Result<Vec<Vec<u8>>, String>;
}

/// The ranks of a run, as an engine sees them: values instead of bytes.
#[derive(Clone, Debug)]
pub struct Ranks {
    communicator: Arc<dyn Communicator>,
    /// Why a rank was lost, until it can be reported.
    lost: Arc<OnceLock<RunFailure>>,
    /// Nanoseconds spent in exchanges.
    waited: Arc<AtomicU64>,
}

/// An exchange that has been begun.
pub(crate) struct UnderWay {
    ranks: Ranks,
    messages: Box<dyn Messages>,
}

impl UnderWay {
    /// See [`Messages::advance`].
    pub(crate) fn advance(&mut self) {
        self.ranks.timed(|| self.messages.advance());
    }

    /// Waits for the messages of every rank.
    ///
    /// # Errors
    /// A rank is lost.
    pub(crate) fn finish(self) -> Result<Vec<Vec<u8>>, RunFailure> {
        let Self { ranks, messages } = self;
        ranks.timed(|| messages.finish()).map_err(lost)
    }
}

impl Ranks {
    /// The ranks of a communicator.
    pub fn new(communicator: Arc<dyn Communicator>) -> Self {
        Self { communicator, lost: Arc::default(), waited: Arc::default() }
    }

    /// Number of this rank.
    pub fn rank(&self) -> usize {
        self.communicator.rank()
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.communicator.size()
    }

    /// Sends bytes to every rank and receives as many as `lengths` says from each.
    ///
    /// # Errors
    /// Here and below: a rank is lost.
    pub fn exchange(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Vec<Vec<u8>>, RunFailure> {
        self.begin(to, lengths)?.finish()
    }

    /// Sends any number of values to every other rank; returns those from each.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub(crate) fn exchange_values<V: Fixed>(&self, to: &[Vec<V>]) -> Result<Vec<Vec<V>>, RunFailure> {
        let counts = self.to_others(to.iter().map(|values| encoded(&[values.len()])).collect());
        let one_each = self.lengths(&vec![1; self.size()], usize::SIZE, |_| true);
        let mut lengths = Vec::with_capacity(self.size());
        for bytes in self.exchange(counts, &one_each)? {
            lengths.push(decoded::<usize>(&bytes)?.iter().sum::<usize>() * V::SIZE);
        }
        let values = self.to_others(to.iter().map(|values| encoded(values)).collect());
        self.exchange(values, &lengths)?.iter().map(|bytes| decoded(bytes)).collect()
    }

    /// An [exchange](Self::exchange) without waiting. Nothing else is exchanged until it is finished.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub(crate) fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<UnderWay, RunFailure> {
        let messages = self.timed(|| self.communicator.begin(to, lengths)).map_err(lost)?;
        Ok(UnderWay { ranks: self.clone(), messages })
    }

    /// Runs something whose time counts as waiting.
    fn timed<R>(&self, exchange: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let done = exchange();
        self.waited.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    /// Seconds that this rank has waited for messages or sent them.
    pub fn waited(&self) -> f64 {
        1e-9 * self.waited.load(Ordering::Relaxed) as f64
    }

    /// The values of every rank, of which rank `r` has `counts[r]`, in the order of the ranks.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn gather<V: Fixed + Copy>(&self, own: &[V], counts: &[usize]) -> Result<Vec<V>, RunFailure> {
        let (rank, size) = (self.rank(), self.size());
        // Pieces of this rank and of those behind it, twice as many after each exchange: twelve exchanges with 4096
        // ranks.
        let mut pieces = vec![encoded(own)];
        let mut way = 1;
        while way < size {
            let (to, from, count) = ((rank + size - way) % size, (rank + way) % size, way.min(size - way));
            let mut sent = vec![Vec::new(); size];
            sent[to] = pieces[..count].concat();
            let expected: Vec<usize> = (0..count).map(|k| counts[(from + k) % size] * V::SIZE).collect();
            let mut lengths = vec![0; size];
            lengths[from] = expected.iter().sum();
            let received = self.exchange(sent, &lengths)?;
            let mut rest = &received[from][..];
            for length in expected {
                let (piece, behind) = rest.split_at(length);
                pieces.push(piece.to_vec());
                rest = behind;
            }
            way *= 2;
        }
        let mut all = Vec::with_capacity(counts.iter().sum());
        for other in 0..size {
            all.extend(decoded::<V>(&pieces[(other + size - rank) % size])?);
        }
        Ok(all)
    }

    /// The values of every rank, with any number on each, in the order of the ranks.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn gather_all<V: Fixed + Copy>(&self, own: &[V]) -> Result<Vec<V>, RunFailure> {
        let counts = self.gather_one(own.len())?;
        self.gather(own, &counts)
    }

    /// The same as [`Self::gather`], but only on the first rank; nothing on the others.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn gather_on_first_rank<V: Fixed + Copy>(&self, own: &[V], counts: &[usize]) -> Result<Vec<V>, RunFailure> {
        let is_first = self.rank() == 0;
        let lengths = self.lengths(counts, V::SIZE, |_| is_first);
        let mut to = vec![Vec::new(); self.size()];
        to[0] = encoded(own);
        let from = self.exchange(self.to_others(to), &lengths)?;
        if is_first { self.joined(own, &from) } else { Ok(Vec::new()) }
    }

    /// A field of the particles of all ranks, of which rank `r` has `counts[r]`, on the first rank; nothing on the others. A field that no rank has
    /// stays empty.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn collect(&self, own: Column<'_>, counts: &[usize]) -> Result<Column<'static>, RunFailure> {
        let none = vec![0; self.size()];
        let counts = if own.is_empty() { &none } else { counts };
        Ok(match own {
            Column::Scalar(values) => Column::Scalar(self.gather_on_first_rank(&values, counts)?.into()),
            Column::Integer(values) => Column::Integer(self.gather_on_first_rank(&values, counts)?.into()),
            Column::Vector(values) => Column::Vector(self.gather_on_first_rank(&values, counts)?.into()),
            Column::Symmetric(values) => Column::Symmetric(self.gather_on_first_rank(&values, counts)?.into()),
            Column::Tensor(values) => Column::Tensor(self.gather_on_first_rank(&values, counts)?.into()),
        })
    }

    /// A value of every rank, in their order.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn gather_one<V: Fixed + Copy>(&self, own: V) -> Result<Vec<V>, RunFailure> {
        self.gather(&[own], &vec![1; self.size()])
    }

    /// Bytes of one rank, of any length, on all ranks.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn broadcast_from(&self, rank: usize, own: &[u8]) -> Result<Vec<u8>, RunFailure> {
        let is_sender = self.rank() == rank;
        let length = self.gather_one(if is_sender { own.len() } else { 0 })?[rank];
        let to = vec![if is_sender { own.to_vec() } else { Vec::new() }; self.size()];
        let lengths = self.lengths(&vec![length; self.size()], 1, |r| r == rank);
        let mut from = self.exchange(self.to_others(to), &lengths)?;
        Ok(if is_sender { own.to_vec() } else { std::mem::take(&mut from[rank]) })
    }

    /// Bytes of the first rank, on all of them; the others know their number.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn broadcast(&self, own: &[u8], length: usize) -> Result<Vec<u8>, RunFailure> {
        let (rank, size) = (self.rank(), self.size());
        let mut bytes = if rank == 0 { own.to_vec() } else { Vec::new() };
        // Twice as many ranks have them after each exchange.
        let mut way = 1;
        while way < size {
            if rank < way && rank + way < size {
                let mut sent = vec![Vec::new(); size];
                sent[rank + way].clone_from(&bytes);
                self.exchange(sent, &vec![0; size])?;
            } else if (way..2 * way).contains(&rank) {
                let mut lengths = vec![0; size];
                lengths[rank - way] = length;
                bytes = std::mem::take(&mut self.exchange(vec![Vec::new(); size], &lengths)?[rank - way]);
            }
            way *= 2;
        }
        Ok(bytes)
    }

    /// Bytes of every rank, on the first of them; nothing on the others.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn gather_bytes(&self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, RunFailure> {
        let counts = self.gather_one(own.len())?;
        if self.rank() > 0 {
            let mut to = vec![Vec::new(); self.size()];
            to[0] = own;
            self.exchange(to, &vec![0; self.size()])?;
            return Ok(Vec::new());
        }
        let mut from = self.exchange(vec![Vec::new(); self.size()], &self.lengths(&counts, 1, |_| true))?;
        from[0] = own;
        Ok(from)
    }

    /// Redistributes bytes of which rank `r` has `lengths[r]`, in the order of the ranks, so that rank `r` has
    /// `wanted[r]` of them. The totals are equal.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn share_anew(&self, own: &[u8], lengths: &[usize], wanted: &[usize]) -> Result<Vec<u8>, RunFailure> {
        let rank = self.rank();
        let (before, after) = (places(lengths), places(wanted));
        let common = |a: &Range<usize>, b: &Range<usize>| a.start.max(b.start)..a.end.min(b.end);
        let sent = |to: &Range<usize>| {
            let Range { start, end } = common(&before[rank], to);
            let first = before[rank].start;
            if start < end { own[start - first..end - first].to_vec() } else { Vec::new() }
        };
        let mut to: Vec<Vec<u8>> = after.iter().map(|_| Vec::new()).collect();
        for (other, place) in after.iter().enumerate().filter(|(other, place)| *other != rank && !place.is_empty()) {
            to[other] = sent(place);
        }
        let length =
            |(other, place): (usize, &Range<usize>)| if other == rank { 0 } else { common(place, &after[rank]).len() };
        let mut from = self.exchange(to, &before.iter().enumerate().map(length).collect::<Vec<_>>())?;
        from[rank] = sent(&after[rank]);
        Ok(from.concat())
    }

    /// On all ranks the message of the first one that has failed, if any.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn first_failure(&self, own: Result<(), String>) -> Result<Result<(), String>, RunFailure> {
        let Some(failed) = self.gather_one(own.is_err())?.into_iter().position(|failed| failed) else {
            return Ok(Ok(()));
        };
        let told = self.broadcast_from(failed, own.err().unwrap_or_default().as_bytes())?;
        Ok(Err(format!("rank {failed}: {}", String::from_utf8_lossy(&told))))
    }

    /// Sums over all particles in their order, bit-identical to those of one rank: each rank adds its particles to the
    /// sums of the ranks before it, and all receive the result of the last one.
    ///
    /// # Errors
    /// See [`Self::exchange`].
    pub fn sum_in_turn<V: Fixed + Copy>(&self, sums: &mut [V], add: impl FnOnce(&mut [V])) -> Result<(), RunFailure> {
        let (rank, size) = (self.rank(), self.size());
        let mut lengths = vec![0; size];
        if rank > 0 {
            lengths[rank - 1] = sums.len() * V::SIZE;
            let from = self.exchange(vec![Vec::new(); size], &lengths)?;
            sums.copy_from_slice(&decoded(&from[rank - 1])?);
        }
        add(sums);
        if rank + 1 < size {
            let mut to = vec![Vec::new(); size];
            to[rank + 1] = encoded(sums);
            self.exchange(to, &vec![0; size])?;
        }
        let of_last = self.broadcast_from(size - 1, &encoded(sums))?;
        sums.copy_from_slice(&decoded(&of_last)?);
        Ok(())
    }

    /// Stores the loss of a rank that cannot be reported at once.
    pub(crate) fn note_loss(&self, failure: RunFailure) {
        let _ = self.lost.set(failure);
    }

    /// Reports a stored loss.
    ///
    /// # Errors
    /// There was one.
    pub(crate) fn check_lost(&self) -> Result<(), RunFailure> {
        self.lost.get().map_or(Ok(()), |failure| Err(failure.clone()))
    }

    /// Nothing to this rank itself.
    fn to_others(&self, mut to: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
        to[self.rank()] = Vec::new();
        to
    }

    /// Bytes expected from each other rank that sends.
    fn lengths(&self, counts: &[usize], size: usize, sends: impl Fn(usize) -> bool) -> Vec<usize> {
        let of = |(r, count): (usize, &usize)| if r != self.rank() && sends(r) { count * size } else { 0 };
        counts.iter().enumerate().map(of).collect()
    }

    fn joined<V: Fixed + Copy>(&self, own: &[V], from: &[Vec<u8>]) -> Result<Vec<V>, RunFailure> {
        let mut all = Vec::new();
        for (r, bytes) in from.iter().enumerate() {
            if r == self.rank() {
                all.extend_from_slice(own);
            } else {
                all.extend(decoded::<V>(bytes)?);
            }
        }
        Ok(all)
    }
}

/// Ranges of contiguous pieces.
fn places(lengths: &[usize]) -> Vec<Range<usize>> {
    let ends = lengths.iter().scan(0, |end, length| {
        *end += length;
        Some(*end)
    });
    ends.zip(lengths).map(|(end, length)| end - length..end).collect()
}

fn lost(reason: String) -> RunFailure {
    RunFailure::of_engine(format!("a rank of the run is lost: {reason}"))
}

/// Values as bytes.
pub(crate) fn encoded<V: Fixed>(values: &[V]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(values.len() * V::SIZE);
    values.iter().for_each(|value| value.write(&mut bytes));
    bytes
}

/// Values from the bytes of another rank.
pub(crate) fn decoded<V: Fixed>(bytes: &[u8]) -> Result<Vec<V>, RunFailure> {
    bytes.chunks_exact(V::SIZE).map(V::read).collect::<Option<_>>().ok_or_else(unreadable)
}

/// Another rank has sent bytes that are not valid values.
pub(crate) fn unreadable() -> RunFailure {
    lost("it sent an invalid message; all ranks must run the same program".to_owned())
}
