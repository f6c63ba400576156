//! Reduction of numbers of parts of the particles until a few rows are left, which are copied back.
//!
//! A GPU has some hundred thousand threads at once, and a thread alone waits for memory most of the time: the first pass has a thread for a few
//! particles, and each of the following reduces a few rows of the one before.

use crate::engine::columns::{Binder, Group, Recording, recording};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_physics::{Numbers, Real};

/// Particles that a thread of a first pass reduces to a row.
const EACH: usize = 16;

/// Rows that one thread of a further pass reduces at most.
const WIDTH: usize = 16;

/// Number of rows that are copied back without further passes: so few bytes take as long as one.
const FEW: usize = 256;

/// Rows of a first pass over columns of that length, which is one of whole chunks.
pub(in crate::engine) const fn rows(length: usize) -> usize {
    length / EACH
}

/// Folds over the particles of a row of a first pass over columns of that length. Threads beside each other read particles beside each other.
pub(super) fn over_particles<S: Numbers<Recorded>>(
    bind: &mut Binder<'_>,
    (length, row): (usize, Index),
    start: S,
    step: impl FnOnce(S, Index) -> S,
) -> S {
    let rows = Index::of(rows(length) as u32);
    bind.scope.fold(Index::of(0), Index::of(EACH as u32), start, |_, state, k| step(state, row + k * rows))
}

/// Reduction operation of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Together {
    Least,
    Largest,
    Sum,
    /// For a sum beyond single precision: the remainder after whole [`UNITS`], and, in the next column, the number of
    /// these.
    Ones,
    Units,
}

/// This number counts as one in the second column of a two-column sum.
pub(in crate::engine) const UNITS: f64 = 4096.0;

impl Together {
    pub(in crate::engine) fn of(self, a: Recorded, b: Recorded) -> Recorded {
        match self {
            Self::Least => a.min(b),
            Self::Largest => a.max(b),
            Self::Sum | Self::Ones | Self::Units => a + b,
        }
    }
}

/// Carries whole units to the second column, so that sums of few rows stay exact.
pub(super) fn carry(numbers: &mut [Recorded], columns: &[Together]) {
    for k in (1..columns.len()).filter(|k| columns[*k] == Together::Units) {
        let units = Index::floor(numbers[k - 1] * Recorded::of(1.0 / UNITS)).number();
        numbers[k - 1] -= units * Recorded::of(UNITS);
        numbers[k] += units;
    }
}

/// Rows after each pass, given their number: no more passes than needed, and all of about the same width.
fn passes(rows: usize) -> Vec<usize> {
    let after = |width: usize, passes: u32| FEW * width.pow(passes);
    let count = (0..).find(|count| after(WIDTH, *count) >= rows).unwrap_or_default();
    let width = (1..WIDTH).find(|width| after(*width, count) >= rows).unwrap_or(WIDTH);
    let mut left = rows;
    let pass = |_| {
        left = left.div_ceil(width);
        left
    };
    (0..count).map(pass).collect()
}

/// The group with the result for a group with this number of rows.
pub(in crate::engine) fn left(group: Group, rows: usize) -> Group {
    match passes(rows).len() {
        0 => group,
        count => reduced(group, count - 1),
    }
}

/// Result of a pass over a group.
fn reduced(group: Group, pass: usize) -> Group {
    match group {
        Group::Ways => Group::WaysLeft(pass),
        Group::HeatExtremes => Group::HeatExtremesLeft(pass),
        _ => Group::ExtremesLeft(pass),
    }
}

/// Groups that the passes over a group with this number of rows write, with their rows.
pub(in crate::engine) fn groups(group: Group, rows: usize) -> impl Iterator<Item = (Group, usize)> {
    passes(rows).into_iter().enumerate().map(move |(pass, rows)| (reduced(group, pass), rows))
}

/// The successive passes over a group of columns with this number of rows, with the threads of each.
pub(in crate::engine) fn reduce<const COLUMNS: usize>(
    group: Group,
    rows: usize,
    columns: [Together; COLUMNS],
) -> Result<Vec<(Recording, usize)>, KernelFault> {
    let (mut from, mut length) = (group, rows);
    let mut kernels = Vec::new();
    for (to, left) in groups(group, rows) {
        // Names are letters, digits and underscores.
        let name = format!("{to:?}").to_lowercase().replace('(', "_").replace(')', "");
        let kernel = recording(&name, length, |bind, row| {
            let (rows, sums) = (bind.read(from), bind.write(to));
            let at = |i: Index| core::array::from_fn(|k| rows.get(k, i));
            // Threads beside each other read rows beside each other. The last ones have a row less.
            let (last, end) = (Recorded::of((length - 1) as f64), Recorded::of(length as f64));
            let width = Index::of(length.div_ceil(left) as u32);
            let start: [Recorded; COLUMNS] = at(row);
            let mut all = bind.scope.fold(Index::of(1), width, start, |_, mut all, k| {
                let i = (row + k * Index::of(left as u32)).number();
                let numbers: [Recorded; COLUMNS] = at(Index::floor(i.min(last)));
                for (k, number) in all.iter_mut().enumerate() {
                    *number = Recorded::select_lt(i, end, columns[k].of(*number, numbers[k]), *number);
                }
                all
            });
            carry(&mut all, &columns);
            for (k, number) in all.into_iter().enumerate() {
                sums.set_at(Index::of((k * left) as u32) + row, number);
            }
        })?;
        kernels.push((kernel, left));
        (from, length) = (to, left);
    }
    Ok(kernels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Evaluation;

    #[test]
    fn passes_are_as_few_and_narrow_as_possible() {
        // Of 2e5, 2e6 and the most particles there may be.
        let of = |particles: usize| passes(rows(particles.next_multiple_of(256)));
        assert_eq!(of(195_112), [1744, 250]);
        assert_eq!(of(2_000_000), [15_626, 1954, 245]);
        assert_eq!(of((1 << 24) - 1), [65_536, 4096, 256]);
        assert!(passes(1).is_empty() && passes(FEW).is_empty());
    }

    #[test]
    fn any_number_of_rows_is_reduced_to_a_few() {
        use Together::{Largest, Least, Ones, Sum, Units};
        for count in [1, FEW, FEW + 1, 1000, FEW * WIDTH, FEW * WIDTH + 1, 300_000] {
            let number = |k: usize, i: usize| ((i * 7919 + k * 31) % 1009) as f32 - 500.0;
            let mut rows: Vec<f32> = (0..3).flat_map(|k| (0..count).map(move |i| number(k, i))).collect();
            // Up to 1e9 in all, of which single precision would keep seven digits.
            let whole = |i: usize| (i * 7919 % 1009) + 3 * 4096;
            rows.extend((0..count).map(|i| (whole(i) % 4096) as f32));
            rows.extend((0..count).map(|i| (whole(i) / 4096) as f32));
            let expected = [
                (0..count).map(|i| number(0, i)).fold(f32::INFINITY, f32::min),
                (0..count).map(|i| number(1, i)).fold(f32::NEG_INFINITY, f32::max),
                (0..count).map(|i| number(2, i)).sum(),
            ];
            for (kernel, left) in reduce(Group::Extremes, count, [Least, Largest, Sum, Ones, Units]).unwrap() {
                let mut buffers = [rows, vec![f32::NAN; 5 * left]];
                Evaluation::default().run(&kernel.kernel, &mut buffers, left as u32);
                let [_, sums] = buffers;
                rows = sums;
            }
            let left = rows.len() / 5;
            assert!(left <= FEW, "{left} of {count}");
            let of = |k: usize| rows[k * left..(k + 1) * left].iter().copied();
            let found = [of(0).fold(f32::INFINITY, f32::min), of(1).fold(f32::NEG_INFINITY, f32::max), of(2).sum()];
            assert_eq!(found, expected, "{count}");
            let parts = |k: usize| of(k).map(|part| part as u64).sum::<u64>();
            assert_eq!(parts(3) + 4096 * parts(4), (0..count).map(whole).sum::<usize>() as u64, "{count}");
        }
    }
}
