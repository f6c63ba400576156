//! Messages of the halo exchange: at one point of the step, one message to each rank that reads particles of this one,
//! with all columns it receives.

use super::{GhostColumn, Halo};
use crate::ranks::{Ranks, UnderWay};
use smallvec::SmallVec;

/// Columns that the ghosts of a halo receive.
pub(crate) struct Exchanged<'a> {
    pub(crate) halo: &'a dyn Halo,
    pub(crate) columns: Columns<'a>,
}

/// Columns of a set, reused so that no step allocates.
pub(crate) type Columns<'a> = SmallVec<[GhostColumn<'a>; 16]>;
/// The ghosts of the lists, and those of the contact.
pub(crate) type ExchangedSets<'a> = SmallVec<[Exchanged<'a>; 2]>;

/// Messages to other ranks, as they are packed.
#[derive(Default)]
pub struct Outgoing {
    ranks: Option<Ranks>,
    to: Vec<Vec<u8>>,
    lengths: Vec<usize>,
}

/// Messages of other ranks, as they are unpacked; none if a rank is lost.
pub struct Incoming {
    from: Vec<Vec<u8>>,
    /// Bytes of each that have been read.
    taken: Vec<usize>,
}

/// Halo exchange in flight.
pub(crate) struct Arrival(Option<(Ranks, UnderWay)>);

impl Outgoing {
    /// The messages to each of the ranks, and the lengths of those from them.
    pub(super) fn among(&mut self, ranks: &Ranks) -> (&mut [Vec<u8>], &mut [usize]) {
        if self.ranks.is_none() {
            self.ranks = Some(ranks.clone());
            self.to = vec![Vec::new(); ranks.size()];
            self.lengths = vec![0; ranks.size()];
        }
        (&mut self.to, &mut self.lengths)
    }

    fn send(self) -> Arrival {
        Arrival(self.ranks.and_then(|ranks| match ranks.begin(self.to, &self.lengths) {
            Ok(under_way) => Some((ranks, under_way)),
            Err(failure) => {
                ranks.note_loss(failure);
                None
            }
        }))
    }
}

impl Arrival {
    /// Lets the messages make progress.
    pub(crate) fn advance(&mut self) {
        if let Some((_, under_way)) = &mut self.0 {
            under_way.advance();
        }
    }

    /// Waits for the messages. The engine reports the loss of a rank at the end of the stage; until then ghosts keep
    /// their values.
    fn wait(self) -> Incoming {
        let from = self.0.map_or_else(Vec::new, |(ranks, under_way)| {
            under_way.finish().unwrap_or_else(|failure| {
                ranks.note_loss(failure);
                Vec::new()
            })
        });
        Incoming { taken: vec![0; from.len()], from }
    }
}

impl Incoming {
    /// The next bytes from a rank; `None` if they have not arrived.
    pub(super) fn take(&mut self, rank: usize, length: usize) -> Option<&[u8]> {
        let start = *self.taken.get(rank)?;
        self.taken[rank] += length;
        self.from[rank].get(start..start + length)
    }
}

/// Sends the values of these columns for ghosts on other ranks, and does not wait for those of the ghosts here. Until
/// [`finish`], particles keep their values.
pub(crate) fn begin(exchanged: &[Exchanged<'_>]) -> Arrival {
    let mut outgoing = Outgoing::default();
    for Exchanged { halo, columns } in exchanged {
        halo.pack(columns, &mut outgoing);
    }
    outgoing.send()
}

/// Waits for the values of the ghosts, and fills the same columns.
pub(crate) fn finish(arrival: Arrival, exchanged: ExchangedSets<'_>) {
    let mut incoming = arrival.wait();
    for Exchanged { halo, columns } in exchanged {
        columns.into_iter().for_each(|column| halo.unpack(column, &mut incoming));
    }
}

/// Fills the columns at once.
pub(crate) fn fill(exchanged: ExchangedSets<'_>) {
    finish(begin(&exchanged), exchanged);
}
