//! Halo exchange: columns are packed on the GPU that has the particles, sent in one message to each other rank, and
//! unpacked on the GPU that reads them.

use super::touched::ColumnSet;
use crate::device::{Array, Card, Launch};
use crate::engine::columns::{Columns, Group, NOTHING, Recording, recording};
use crate::engine::failure;
use crate::record::{Element, Index, KernelFault, Recorded};
use sphorge_engine::RunFailure;
use sphorge_physics::{Elementary, Real};

/// Transfers a set of columns to the ghosts of other ranks, and to those of this one.
pub(super) struct Exchange {
    pack: Vec<Launch>,
    unpack: Vec<Launch>,
    sent: Array,
    received: Array,
    /// Numbers of a particle.
    width: usize,
}

/// Total number of particles that are sent, and number of ghosts here, which follow this number of particles of this
/// rank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    pub(super) sent: usize,
    pub(super) ghosts: usize,
    pub(super) own: usize,
}

impl Exchange {
    /// For these columns of groups, which are `stride` long.
    pub(super) fn new(
        card: &Card,
        columns: &Columns,
        set: &ColumnSet,
        counts: Counts,
        stride: usize,
    ) -> Result<Self, RunFailure> {
        let width = set.values().map(|columns| columns.count_ones() as usize).sum();
        let arrays = (card.zeros(counts.sent * width), card.zeros(counts.ghosts * width));
        let (sent, received) = (arrays.0.map_err(failure)?, arrays.1.map_err(failure)?);
        let (mut pack, mut unpack) = (Vec::new(), Vec::new());
        for part in parts(set) {
            let (packing, unpacking) = part.kernels(stride, counts.own).map_err(failure)?;
            pack.push(bound(card, columns, &packing, &sent, counts.sent)?);
            unpack.push(bound(card, columns, &unpacking, &received, counts.ghosts)?);
        }
        Ok(Self { pack, unpack, sent, received, width })
    }

    /// The message: the numbers of each particle contiguously, in the order in which particles are sent.
    pub(super) fn packed(&self, card: &Card) -> Result<Vec<f32>, RunFailure> {
        card.launch(&self.pack);
        card.read(&self.sent).map_err(failure)
    }

    /// Copies the received values, in the order of the ghosts, to them.
    pub(super) fn unpack(&self, card: &Card, numbers: &[f32]) {
        card.write(&self.received, numbers);
        card.launch(&self.unpack);
    }

    /// Numbers of a particle.
    pub(super) fn width(&self) -> usize {
        self.width
    }
}

/// Transfers marks of ghosts back to the particles they represent.
pub(super) struct Marks {
    take: Launch,
    set: Launch,
    taken: Array,
    returned: Array,
}

impl Marks {
    pub(super) fn new(card: &Card, columns: &Columns, counts: Counts, stride: usize) -> Result<Self, RunFailure> {
        let taken = card.zeros(counts.ghosts).map_err(failure)?;
        let returned = card.zeros(counts.sent).map_err(failure)?;
        let (take, set) = Self::kernels(stride, counts.own).map_err(failure)?;
        Ok(Self {
            take: bound(card, columns, &take, &taken, counts.ghosts)?,
            set: bound(card, columns, &set, &returned, counts.sent)?,
            taken,
            returned,
        })
    }

    /// Kernels that remove and set marks.
    fn kernels(stride: usize, own: usize) -> Result<(Recording, Recording), KernelFault> {
        let take = recording("take_marks", stride, |bind, thread| {
            let (marks, sent) = (bind.index_output(Group::Patched), bind.write(Group::Sent));
            let i = thread + Index::of(own as u32);
            sent.set_at(thread, marks.at(i).number());
            marks.set(i, Index::of(0));
        })?;
        let set = recording("set_marks", stride, |bind, thread| {
            let (returned, sends) = (bind.read(Group::Received), bind.indices(Group::Sends));
            let marks = bind.index_output(Group::Patched);
            // A particle that several ranks read may be marked by any of them.
            let mark = || {
                marks.set(sends.at(thread), Index::of(1));
                NOTHING
            };
            Recorded::if_lt(Recorded::of(0.5), returned.get_at(thread), mark, || NOTHING);
        })?;
        Ok((take, set))
    }

    /// The marks of the ghosts, in their order; they are removed.
    pub(super) fn taken(&self, card: &Card) -> Result<Vec<f32>, RunFailure> {
        card.launch([&self.take]);
        card.read(&self.taken).map_err(failure)
    }

    /// Adds marks that have come back, in the order in which particles are sent.
    pub(super) fn set(&self, card: &Card, marks: &[f32]) {
        card.write(&self.returned, marks);
        card.launch([&self.set]);
    }
}

/// A kernel bound to columns, and to a message.
fn bound(
    card: &Card,
    columns: &Columns,
    kernel: &Recording,
    message: &Array,
    threads: usize,
) -> Result<Launch, RunFailure> {
    let program = card.compile(&kernel.kernel).map_err(failure)?;
    let array = |group: &Group| match group {
        Group::Sent | Group::Received => Ok(message),
        other => columns.array(*other).ok_or_else(|| failure(format!("no column {other:?}"))),
    };
    let arrays = kernel.groups.iter().map(array).collect::<Result<Vec<&Array>, RunFailure>>()?;
    card.bind(&program, &arrays, threads as u32).map_err(failure)
}

/// The kernels that exchange a set of columns and marks of ghosts, as on some rank.
pub(in crate::engine) fn kernels(set: &ColumnSet, stride: usize, own: usize) -> Result<Vec<Recording>, KernelFault> {
    let (take, put) = Marks::kernels(stride, own)?;
    let mut kernels = vec![take, put];
    for part in parts(set) {
        let (pack, unpack) = part.kernels(stride, own)?;
        kernels.extend([pack, unpack]);
    }
    Ok(kernels)
}

/// The columns of each group in a set.
fn parts(set: &ColumnSet) -> impl Iterator<Item = Part> + '_ {
    let width = set.values().map(|columns| columns.count_ones() as usize).sum();
    let mut first = 0;
    set.iter().map(move |(group, columns)| {
        let part = Part { group: *group, columns: numbers(*columns), first, width };
        first += part.columns.len();
        part
    })
}

/// The numbers of the columns of a set.
fn numbers(set: u128) -> Vec<usize> {
    (0..u128::BITS as usize).filter(|column| set >> column & 1 == 1).collect()
}

/// Columns of one group in a message.
struct Part {
    group: Group,
    columns: Vec<usize>,
    /// Index of the first of them among the numbers of a particle, and their number.
    first: usize,
    width: usize,
}

impl Part {
    /// Packing and unpacking.
    fn kernels(&self, stride: usize, own: usize) -> Result<(Recording, Recording), KernelFault> {
        Ok((self.pack(stride)?, self.unpack(stride, own)?))
    }

    fn name(&self, what: &str) -> String {
        let group = format!("{:?}", self.group).to_lowercase().replace('(', "_").replace(')', "");
        format!("{what}_{group}")
    }

    /// Index of a number of a particle in the message.
    fn place(&self, particle: Index, column: usize) -> Index {
        particle * Index::of(self.width as u32) + Index::of((self.first + column) as u32)
    }

    fn pack(&self, stride: usize) -> Result<Recording, KernelFault> {
        recording(&self.name("pack"), stride, |bind, thread| {
            let i = bind.indices(Group::Sends).at(thread);
            match self.group.of_particles() {
                Some(Element::Whole) => {
                    let whole = bind.indices(self.group);
                    let sent = bind.write(Group::Sent);
                    // Exact, because there are far fewer bodies and motions.
                    sent.set_at(self.place(thread, 0), whole.at(i).number());
                }
                _ => {
                    let (group, sent) = (bind.read(self.group), bind.write(Group::Sent));
                    for (k, column) in self.columns.iter().enumerate() {
                        sent.set_at(self.place(thread, k), group.get(*column, i));
                    }
                }
            }
        })
    }

    fn unpack(&self, stride: usize, own: usize) -> Result<Recording, KernelFault> {
        recording(&self.name("unpack"), stride, |bind, thread| {
            let i = thread + Index::of(own as u32);
            let received = bind.read(Group::Received);
            match self.group.of_particles() {
                Some(Element::Whole) => {
                    let whole = bind.index_output(self.group);
                    whole.set(i, Index::floor(received.get_at(self.place(thread, 0))));
                }
                _ => {
                    let group = bind.write(self.group);
                    for (k, column) in self.columns.iter().enumerate() {
                        group.set(*column, i, received.get_at(self.place(thread, k)));
                    }
                }
            }
        })
    }
}
