//! The columns of the particles on a GPU, and kernels that name the columns they touch.

mod compensated;
pub(super) mod groups;
mod handles;

pub(super) use compensated::{added, keeps_rests};
pub(super) use groups::Group;
pub(super) use handles::{
    Columnar, Compensated, CompensatedTensor, CompensatedVector, Handles, Layout, Member, Number, Read, ReadColumns,
    ReadRecords, ReadShared, Records, Shared, SharedFrom, SymmetricColumns, TensorColumns, ValuedMember, VectorColumns,
    Write, WriteColumns,
};

use crate::device::{Array, Card, CardFault, Launch};
use crate::record::{Counters, Index, IndexOutput, Indices, Input, Kernel, KernelFault, Output, Recorded, Scope};

/// A group whose columns a kernel reads by their indices.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    buffer: Input,
    stride: u32,
}

/// A group whose columns a kernel writes by their indices, and may read.
#[derive(Clone, Copy)]
pub(super) struct Writing {
    buffer: Output,
    stride: u32,
}

fn place(stride: u32, column: usize, i: Index) -> Index {
    if column == 0 { i } else { Index::of(stride * column as u32) + i }
}

impl Reading {
    pub(super) fn get(self, column: usize, i: Index) -> Recorded {
        self.buffer.at(place(self.stride, column, i))
    }

    /// A number by its index in the whole group.
    pub(super) fn get_at(self, at: Index) -> Recorded {
        self.buffer.at(at)
    }
}

impl Writing {
    pub(super) fn set(self, column: usize, i: Index, value: Recorded) {
        self.buffer.set(place(self.stride, column, i), value);
    }

    /// A number by its index in the whole group.
    pub(super) fn get_at(self, at: Index) -> Recorded {
        self.buffer.at(at)
    }

    /// Writes a number by its index in the whole group.
    pub(super) fn set_at(self, at: Index, value: Recorded) {
        self.buffer.set(at, value);
    }
}

/// Result of a branch or a loop that only stores.
pub(super) const NOTHING: [Recorded; 0] = [];

/// A kernel that is being recorded, with the groups it has requested so far.
pub(super) struct Binder<'a> {
    pub(super) scope: &'a mut Scope,
    groups: Vec<Group>,
    /// Number of particles.
    stride: u32,
}

impl Binder<'_> {
    fn input(&mut self, group: Group) -> Input {
        self.groups.push(group);
        self.scope.input(&format!("{group:?}"))
    }

    fn output(&mut self, group: Group) -> Output {
        self.groups.push(group);
        self.scope.output(&format!("{group:?}"))
    }

    fn columns(&mut self, group: Group) -> Read {
        Columnar { buffer: self.input(group), stride: self.stride }
    }

    fn written_columns(&mut self, group: Group) -> Write {
        Columnar { buffer: self.output(group), stride: self.stride }
    }

    /// A group whose rows are not those of declared columns.
    pub(super) fn read(&mut self, group: Group) -> Reading {
        Reading { buffer: self.input(group), stride: self.stride }
    }

    /// The same to be written.
    pub(super) fn write(&mut self, group: Group) -> Writing {
        Writing { buffer: self.output(group), stride: self.stride }
    }

    /// Length of the columns.
    pub(super) fn stride(&self) -> Index {
        Index::of(self.stride)
    }

    pub(super) fn indices(&mut self, group: Group) -> Indices {
        self.groups.push(group);
        self.scope.indices(&format!("{group:?}"))
    }

    pub(super) fn index_output(&mut self, group: Group) -> IndexOutput {
        self.groups.push(group);
        self.scope.index_output(&format!("{group:?}"))
    }

    pub(super) fn counters(&mut self, group: Group) -> Counters {
        self.groups.push(group);
        self.scope.counters(&format!("{group:?}"))
    }
}

/// A kernel with the groups of its buffers.
pub(super) struct Recording {
    pub(super) kernel: Kernel,
    pub(super) groups: Vec<Group>,
}

/// Records a kernel of `count` particles.
pub(super) fn recording(
    name: &str,
    count: usize,
    body: impl FnOnce(&mut Binder<'_>, Index),
) -> Result<Recording, KernelFault> {
    let mut groups = Vec::new();
    let kernel = Kernel::record(name, |scope| {
        let thread = scope.thread();
        let mut binder = Binder { scope, groups: Vec::new(), stride: count as u32 };
        body(&mut binder, thread);
        groups = binder.groups;
    })?;
    Ok(Recording { kernel, groups })
}

impl Recording {
    /// The kernel compiled for a GPU and bound to the columns of an engine.
    pub(super) fn bind(&self, card: &Card, columns: &Columns, threads: usize) -> Result<Launch, CardFault> {
        let program = card.compile(&self.kernel)?;
        let arrays: Vec<&Array> = self.groups.iter().filter_map(|group| columns.array(*group)).collect();
        card.bind(&program, &arrays, threads as u32)
    }
}

/// The groups of an engine, in the memory of its GPU.
#[derive(Default)]
pub(super) struct Columns {
    arrays: Vec<(Group, Array)>,
}

impl Columns {
    /// Adds a group, or replaces its array.
    pub(super) fn insert(&mut self, group: Group, array: Array) {
        match self.arrays.iter_mut().find(|(of, _)| *of == group) {
            Some((_, known)) => *known = array,
            None => self.arrays.push((group, array)),
        }
    }

    pub(super) fn remove(&mut self, group: Group) {
        self.arrays.retain(|(of, _)| *of != group);
    }

    pub(super) fn into_all(self) -> impl Iterator<Item = (Group, Array)> {
        self.arrays.into_iter()
    }

    pub(super) fn array(&self, group: Group) -> Option<&Array> {
        self.arrays.iter().find(|(of, _)| *of == group).map(|(_, array)| array)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &(Group, Array)> {
        self.arrays.iter()
    }
}
