//! Typed handles of columns: what kernels read and write, by name.
//!
//! [`super::groups`] declares the columns of each group. Binding a group gives a structure of handles, such as
//! `plastic.work`, whose type says how many columns it has and which are rests. Where a number of a column is found
//! follows from the [`Source`] alone.

use super::compensated::added;
use super::groups::Group;
use super::{Binder, NOTHING};
use crate::record::{Double, Index, Input, Output, Recorded};
use sphorge_physics::{Elementary, Real, SymmetricTensor, Tensor, Vector};

/// Where columns are read from.
pub(in crate::engine) trait Source: Copy {
    /// Index of a number in its buffer.
    fn place(self, column: usize, i: Index) -> Index;

    fn load(self, at: Index) -> Recorded;
}

/// Where columns are written, too.
pub(in crate::engine) trait Sink: Source {
    fn store(self, at: Index, value: Recorded);
}

/// A buffer of numbers.
pub(in crate::engine) trait Buffer: Copy {
    fn load(self, at: Index) -> Recorded;
}

impl Buffer for Input {
    fn load(self, at: Index) -> Recorded {
        self.at(at)
    }
}

impl Buffer for Output {
    fn load(self, at: Index) -> Recorded {
        self.at(at)
    }
}

/// Columns of one number for each particle, one after the other.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Columnar<B> {
    pub(super) buffer: B,
    pub(super) stride: u32,
}

/// Columns that are read.
pub(in crate::engine) type Read = Columnar<Input>;

/// Columns that are written, and may be read.
pub(in crate::engine) type Write = Columnar<Output>;

impl<B: Buffer> Source for Columnar<B> {
    fn place(self, column: usize, i: Index) -> Index {
        if column == 0 { i } else { Index::of(self.stride * column as u32) + i }
    }

    fn load(self, at: Index) -> Recorded {
        self.buffer.load(at)
    }
}

impl Sink for Write {
    fn store(self, at: Index, value: Recorded) {
        self.buffer.set(at, value);
    }
}

/// Columns of one of several members of a group, such as those of a body, whose number is a value of the kernel.
#[derive(Clone, Copy)]
pub(in crate::engine) struct OfMember<B> {
    columns: Columnar<B>,
    member: Index,
    /// Columns of a member.
    length: usize,
}

impl<B: Buffer> Source for OfMember<B> {
    fn place(self, column: usize, i: Index) -> Index {
        let column = self.member * Index::of(self.length as u32) + Index::of(column as u32);
        column * Index::of(self.columns.stride) + i
    }

    fn load(self, at: Index) -> Recorded {
        self.columns.buffer.load(at)
    }
}

impl Sink for OfMember<Output> {
    fn store(self, at: Index, value: Recorded) {
        self.columns.buffer.set(at, value);
    }
}

/// Records that follow each other, such as those of facets or pairs of bodies.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Records {
    buffer: Input,
    length: usize,
}

impl Source for Records {
    fn place(self, column: usize, i: Index) -> Index {
        i * Index::of(self.length as u32) + Index::of(column as u32)
    }

    fn load(self, at: Index) -> Recorded {
        self.buffer.at(at)
    }
}

/// Numbers that all threads read, from a known index on.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Shared {
    buffer: Input,
}

/// The same, from an index on that is a value of the kernel.
#[derive(Clone, Copy)]
pub(in crate::engine) struct SharedFrom {
    buffer: Input,
    first: Index,
}

impl Shared {
    pub(in crate::engine) fn from(self, first: Index) -> SharedFrom {
        SharedFrom { buffer: self.buffer, first }
    }
}

/// Numbers without rows.
pub(in crate::engine) trait SharedSource: Copy {
    fn number(self, column: usize) -> Recorded;
}

impl SharedSource for Shared {
    fn number(self, column: usize) -> Recorded {
        self.buffer.at(Index::of(column as u32))
    }
}

impl SharedSource for SharedFrom {
    fn number(self, column: usize) -> Recorded {
        self.buffer.at(self.first + Index::of(column as u32))
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident $([$n:ident])?: $width:expr;)*) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(in crate::engine) struct $kind<S $(, const $n: usize)?> {
            source: S,
            first: usize,
        }

        impl<S: Copy $(, const $n: usize)?> $kind<S $(, $n)?> {
            /// Number of columns.
            pub(in crate::engine) const WIDTH: usize = $width;

            pub(in crate::engine) const fn at(source: S, first: usize) -> Self {
                Self { source, first }
            }
        }
    )* };
}

kinds! {
    /// A column.
    Number: 1;
    /// Several columns of their own.
    Numbers[N]: N;
    VectorColumns: 3;
    /// Several vectors.
    Vectors[N]: 3 * N;
    SymmetricColumns: 6;
    TensorColumns: 9;
    /// Three numbers, followed by their low parts.
    CompensatedVector: 6;
    /// Nine numbers, followed by their low parts.
    CompensatedTensor: 18;
    /// Several numbers, each followed by its low part.
    CompensatedNumbers[N]: 2 * N;
}

macro_rules! indexed {
    ($($kind:ident),*) => { $(
        impl<S: Copy> $kind<S> {
            /// Index of the first of its columns in the group.
            pub(in crate::engine) const fn column(self) -> usize {
                self.first
            }
        }
    )* };
}

indexed!(Number, VectorColumns, SymmetricColumns, TensorColumns, CompensatedVector);

/// A number with its low part.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Compensated<S> {
    source: S,
    first: usize,
    rest: usize,
}

impl<S: Copy> Compensated<S> {
    pub(in crate::engine) const WIDTH: usize = 2;

    pub(in crate::engine) const fn at(source: S, first: usize) -> Self {
        Self { source, first, rest: first + 1 }
    }

    /// Index of its column in the group, and of that of its low part.
    pub(in crate::engine) const fn columns(self) -> [usize; 2] {
        [self.first, self.rest]
    }

    /// The number without its low part.
    pub(in crate::engine) const fn high(self) -> Number<S> {
        Number::at(self.source, self.first)
    }

    /// The rest.
    pub(in crate::engine) const fn low(self) -> Number<S> {
        Number::at(self.source, self.rest)
    }

    /// The number or, if `k` is one, its low part.
    pub(in crate::engine) const fn part(self, k: usize) -> Number<S> {
        if k == 0 { self.high() } else { self.low() }
    }
}

impl<S: Source> Number<S> {
    pub(in crate::engine) fn get(self, i: Index) -> Recorded {
        self.source.load(self.source.place(self.first, i))
    }
}

impl<S: Sink> Number<S> {
    pub(in crate::engine) fn set(self, i: Index, value: Recorded) {
        self.source.store(self.source.place(self.first, i), value);
    }

    /// Adds to a number.
    pub(in crate::engine) fn add(self, i: Index, value: Recorded) {
        let at = self.source.place(self.first, i);
        self.source.store(at, self.source.load(at) + value);
    }
}

impl<S: Copy, const N: usize> Numbers<S, N> {
    pub(in crate::engine) const fn number(self, k: usize) -> Number<S> {
        Number::at(self.source, self.first + k)
    }
}

impl<S: Source, const N: usize> Numbers<S, N> {
    pub(in crate::engine) fn get(self, i: Index) -> [Recorded; N] {
        core::array::from_fn(|k| self.number(k).get(i))
    }
}

impl<S: Sink, const N: usize> Numbers<S, N> {
    pub(in crate::engine) fn set(self, i: Index, values: [Recorded; N]) {
        set_all(self.source, self.first, i, &values);
    }
}

/// Writes contiguous columns.
fn set_all<S: Sink>(source: S, first: usize, i: Index, values: &[Recorded]) {
    for (k, value) in values.iter().enumerate() {
        Number::at(source, first + k).set(i, *value);
    }
}

impl<S: Copy> VectorColumns<S> {
    pub(in crate::engine) const fn axis(self, a: usize) -> Number<S> {
        Number::at(self.source, self.first + a)
    }
}

impl<S: Source> VectorColumns<S> {
    pub(in crate::engine) fn get(self, i: Index) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.axis(a).get(i))
    }
}

impl<S: Sink> VectorColumns<S> {
    pub(in crate::engine) fn set(self, i: Index, values: Vector<Recorded>) {
        set_all(self.source, self.first, i, &values);
    }
}

impl<S: Copy, const N: usize> Vectors<S, N> {
    pub(in crate::engine) const fn vector(self, k: usize) -> VectorColumns<S> {
        VectorColumns::at(self.source, self.first + 3 * k)
    }
}

impl<S: Source, const N: usize> Vectors<S, N> {
    pub(in crate::engine) fn get(self, i: Index) -> [Vector<Recorded>; N] {
        core::array::from_fn(|k| self.vector(k).get(i))
    }
}

impl<S: Source> SymmetricColumns<S> {
    pub(in crate::engine) fn get(self, i: Index) -> SymmetricTensor<Recorded> {
        let component = |k| Number::at(self.source, self.first + k).get(i);
        SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(component))
    }
}

impl<S: Sink> SymmetricColumns<S> {
    pub(in crate::engine) fn set(self, i: Index, value: SymmetricTensor<Recorded>) {
        set_all(self.source, self.first, i, &value.to_array());
    }
}

impl<S: Sink> VectorColumns<S> {
    /// Adds to each of the numbers.
    pub(in crate::engine) fn add(self, i: Index, values: Vector<Recorded>) {
        for (a, value) in values.into_iter().enumerate() {
            self.axis(a).add(i, value);
        }
    }
}

impl<S: Sink, const N: usize> Numbers<S, N> {
    /// Adds to each of the numbers.
    pub(in crate::engine) fn add(self, i: Index, values: [Recorded; N]) {
        for (k, value) in values.into_iter().enumerate() {
            self.number(k).add(i, value);
        }
    }
}

impl<S: Copy> TensorColumns<S> {
    /// Row by row.
    pub(in crate::engine) const fn component(self, k: usize) -> Number<S> {
        Number::at(self.source, self.first + k)
    }
}

impl<S: Source> TensorColumns<S> {
    pub(in crate::engine) fn get(self, i: Index) -> Tensor<Recorded> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| self.component(3 * a + b).get(i)))
    }
}

impl<S: Sink> TensorColumns<S> {
    pub(in crate::engine) fn set(self, i: Index, value: &Tensor<Recorded>) {
        set_all(self.source, self.first, i, value.as_flattened());
    }
}

impl<S: Source> Compensated<S> {
    /// The number and its low part.
    pub(in crate::engine) fn get(self, i: Index) -> [Recorded; 2] {
        self.columns().map(|column| Number::at(self.source, column).get(i))
    }

    pub(in crate::engine) fn double(self, i: Index) -> Double {
        Double::new(self.get(i))
    }
}

impl<S: Sink> Compensated<S> {
    pub(in crate::engine) fn set(self, i: Index, [high, low]: [Recorded; 2]) {
        Number::at(self.source, self.first).set(i, high);
        Number::at(self.source, self.rest).set(i, low);
    }

    /// Adds to a number with its low part.
    pub(in crate::engine) fn add(self, i: Index, value: Recorded) {
        self.set(i, added(self.get(i), value));
    }
}

impl<S: Copy, const N: usize> CompensatedNumbers<S, N> {
    pub(in crate::engine) const fn number(self, k: usize) -> Compensated<S> {
        Compensated::at(self.source, self.first + 2 * k)
    }
}

impl<S: Sink, const N: usize> CompensatedNumbers<S, N> {
    /// Adds powers times a time, s, to works; most have none.
    pub(in crate::engine) fn book(self, powers: Numbers<S, N>, i: Index, dt: Recorded) {
        for k in 0..N {
            let power = powers.number(k).get(i);
            let book = || {
                self.number(k).add_in_order(i, || dt * power);
                NOTHING
            };
            Recorded::if_lt(Recorded::zero(), power.abs(), book, || NOTHING);
        }
    }
}

impl<S: Sink> Compensated<S> {
    /// Adds a number that is made once both indices are known.
    fn add_in_order(self, i: Index, value: impl FnOnce() -> Recorded) {
        let [high, low] = self.columns().map(|column| self.source.place(column, i));
        let sum = added([self.source.load(high), self.source.load(low)], value());
        self.source.store(high, sum[0]);
        self.source.store(low, sum[1]);
    }
}

impl<S: Copy> CompensatedVector<S> {
    pub(in crate::engine) const fn axis(self, a: usize) -> Compensated<S> {
        Compensated { source: self.source, first: self.first + a, rest: self.first + 3 + a }
    }

    /// The numbers without their low parts.
    pub(in crate::engine) const fn high(self) -> VectorColumns<S> {
        VectorColumns::at(self.source, self.first)
    }
}

impl<S: Source> CompensatedVector<S> {
    /// The numbers, each with its low part.
    pub(in crate::engine) fn get(self, i: Index) -> Vector<[Recorded; 2]> {
        [0, 1, 2].map(|a| self.axis(a).get(i))
    }

    pub(in crate::engine) fn doubles(self, i: Index) -> Vector<Double> {
        self.get(i).map(Double::new)
    }
}

impl<S: Copy> CompensatedTensor<S> {
    /// Row by row.
    pub(in crate::engine) const fn component(self, k: usize) -> Compensated<S> {
        Compensated { source: self.source, first: self.first + k, rest: self.first + 9 + k }
    }

    /// The numbers without their low parts.
    pub(in crate::engine) const fn high(self) -> TensorColumns<S> {
        TensorColumns::at(self.source, self.first)
    }
}

impl<S: Source> CompensatedTensor<S> {
    pub(in crate::engine) fn doubles(self, i: Index) -> Tensor<Double> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| self.component(3 * a + b).double(i)))
    }
}

impl<S: SharedSource> Number<S> {
    pub(in crate::engine) fn value(self) -> Recorded {
        self.source.number(self.first)
    }
}

impl<S: SharedSource> VectorColumns<S> {
    pub(in crate::engine) fn value(self) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.axis(a).value())
    }
}

/// A structure of handles, as [`super::groups`] declares them.
pub(in crate::engine) trait Handles<S: Copy>: Copy {
    /// The same of another source.
    type From<T: Copy>: Handles<T>;

    /// Number of its columns.
    const LENGTH: usize;

    /// The group that it describes.
    const GROUP: Group;

    fn at(source: S, first: usize) -> Self;

    fn source(self) -> S;

    fn first(self) -> usize;
}

/// Handles of what is the same for all sources.
pub(in crate::engine) trait Layout: Handles<()> {
    /// Its columns, to know their indices.
    fn layout() -> Self {
        Self::at((), 0)
    }
}

impl<H: Handles<()>> Layout for H {}

/// Handles of columns that are read.
pub(in crate::engine) trait ReadColumns: Handles<Read> {
    fn read(bind: &mut Binder<'_>) -> Self {
        Self::read_of(bind, Self::GROUP)
    }

    /// Those of another group with the same columns.
    fn read_of(bind: &mut Binder<'_>, group: Group) -> Self {
        Self::at(bind.columns(group), 0)
    }
}

impl<H: Handles<Read>> ReadColumns for H {}

/// Handles of columns that are written.
pub(in crate::engine) trait WriteColumns: Handles<Write> {
    fn write(bind: &mut Binder<'_>) -> Self {
        Self::write_of(bind, Self::GROUP)
    }

    /// Those of another group with the same columns.
    fn write_of(bind: &mut Binder<'_>, group: Group) -> Self {
        Self::at(bind.written_columns(group), 0)
    }
}

impl<H: Handles<Write>> WriteColumns for H {}

/// Handles of the columns of one of several members.
pub(in crate::engine) trait Member<S: Copy>: Handles<S> {
    /// Of a member whose number is known.
    fn of(self, member: usize) -> Self {
        Self::at(self.source(), self.first() + member * Self::LENGTH)
    }
}

impl<S: Copy, H: Handles<S>> Member<S> for H {}

/// The same where its number is a value of the kernel.
pub(in crate::engine) trait ValuedMember<B: Copy>: Handles<Columnar<B>> {
    fn of_value(self, member: Index) -> Self::From<OfMember<B>> {
        Self::From::at(OfMember { columns: self.source(), member, length: Self::LENGTH }, self.first())
    }
}

impl<B: Copy, H: Handles<Columnar<B>>> ValuedMember<B> for H {}

/// Handles of records.
pub(in crate::engine) trait ReadRecords: Handles<Records> {
    fn records(bind: &mut Binder<'_>) -> Self {
        Self::records_of(bind, Self::GROUP)
    }

    /// Those of another group with the same columns.
    fn records_of(bind: &mut Binder<'_>, group: Group) -> Self {
        Self::at(Records { buffer: bind.input(group), length: Self::LENGTH }, 0)
    }
}

impl<H: Handles<Records>> ReadRecords for H {}

/// Handles of numbers that all threads read.
pub(in crate::engine) trait ReadShared: Handles<Shared> {
    fn shared(bind: &mut Binder<'_>) -> Self {
        Self::at(Shared { buffer: bind.input(Self::GROUP) }, 0)
    }
}

impl<H: Handles<Shared>> ReadShared for H {}
