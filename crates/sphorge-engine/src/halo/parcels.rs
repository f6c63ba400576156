//! Columns of ghosts on their way between ranks: at one point of the step, one message to each rank that reads particles of this one, with all that it
//! takes over of them.

use super::{GhostColumn, Halo};
use crate::ranks::{Ranks, UnderWay};
use smallvec::SmallVec;

/// Columns that the ghosts of a halo take over.
pub(crate) struct Exchanged<'a> {
    pub(crate) halo: &'a dyn Halo,
    pub(crate) columns: Columns<'a>,
}

/// Columns of a set: no step allocates for them.
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

/// Messages of other ranks, as they are unpacked; none where one is lost.
pub struct Incoming {
    from: Vec<Vec<u8>>,
    /// Bytes of each that were taken.
    taken: Vec<usize>,
}

/// What ghosts take over, on its way.
pub(crate) struct Arrival(Option<(Ranks, UnderWay)>);

impl Outgoing {
    /// The messages to each of the ranks, and how long those that come from them will be.
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
    /// Lets the messages get on.
    pub(crate) fn advance(&mut self) {
        if let Some((_, under_way)) = &mut self.0 {
            under_way.advance();
        }
    }

    /// Waits for the messages. The engine tells of a loss at the end of the stage; until then ghosts are as they were.
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
    /// The next bytes from a rank; `None` where they have not come.
    pub(super) fn take(&mut self, rank: usize, length: usize) -> Option<&[u8]> {
        let start = *self.taken.get(rank)?;
        self.taken[rank] += length;
        self.from[rank].get(start..start + length)
    }
}

/// Sends what ghosts elsewhere take over of these columns and does not wait for what those here do. Until [`finish`], particles keep their values.
pub(crate) fn begin(exchanged: &[Exchanged<'_>]) -> Arrival {
    let mut outgoing = Outgoing::default();
    for Exchanged { halo, columns } in exchanged {
        halo.pack(columns, &mut outgoing);
    }
    outgoing.send()
}

/// Waits for what the ghosts take over, and fills the same columns.
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
