//! The lists of the reference configuration, made on the card at the start and where it is renewed.

use super::columns::{Columns, Group};
use super::failure;
use super::plan::{Plan, Planned, Threads};
use super::search::SPARE;
use super::snapshot::read;
use super::surfaces;
use crate::device::{Array, Card, Launch};
use sphorge_engine::{Model, Particles, RunFailure};

/// Kernels compiled and bound.
pub(super) fn bound(card: &Card, columns: &Columns, planned: &[Planned]) -> Result<Vec<Launch>, RunFailure> {
    let surface = columns.array(Group::Surface).map_or(0, Array::count);
    let threads = |of: Threads| match of {
        Threads::Of(count) => count,
        Threads::OfSurface => surface,
    };
    planned.iter().map(|of| of.kernel.bind(card, columns, threads(of.threads)).map_err(failure)).collect()
}

/// Makes the lists of the particles, where a plan has such: counts neighbours, makes room for them, and finds them again.
pub(super) fn make(
    card: &Card,
    columns: &mut Columns,
    plan: &Plan,
    (model, p): (&Model, &Particles),
) -> Result<(), RunFailure> {
    let count = p.len();
    if plan.count_lists.is_empty() {
        return Ok(());
    }
    let stride = columns.array(Group::Weight).map_or(0, Array::count) / super::snapshot::WEIGHT_FIELDS;
    let starts = find_starts(card, columns, plan, count)?;
    let total = starts.last().map_or(0, |total| *total as usize);
    columns.insert(Group::ListStarts, card.indices(&starts).map_err(failure)?);
    columns.insert(Group::List, card.zeros(total).map_err(failure)?);
    card.launch(&bound(card, columns, &plan.fill_lists)?);
    if model.has_faces() {
        let list: Vec<u32> = read(card, columns, Group::List)?.into_iter().map(f32::to_bits).collect();
        surfaces::find(card, columns, (model, p), stride, (&starts, &list))?;
    }
    Ok(())
}

/// Makes the lists of `count` particles anew. Whether they are in another place, which kernels are to be bound to: they get more room than they need
/// where they had too little.
pub(super) fn make_anew(card: &Card, columns: &mut Columns, plan: &Plan, count: usize) -> Result<bool, RunFailure> {
    let starts = find_starts(card, columns, plan, count)?;
    let total = starts.last().map_or(0, |total| *total as usize);
    let of_starts = columns.array(Group::ListStarts).ok_or_else(|| failure("no lists"))?;
    card.write_indices(of_starts, &starts);
    let is_short = columns.array(Group::List).is_none_or(|list| list.count() < total);
    if is_short {
        let room = total + (SPARE * total as f64) as usize;
        columns.insert(Group::List, card.zeros(room).map_err(failure)?);
    }
    card.launch(&bound(card, columns, &plan.fill_lists)?);
    Ok(is_short)
}

/// Counts neighbours: where the list of each particle starts, and behind the last the number of all.
fn find_starts(card: &Card, columns: &Columns, plan: &Plan, count: usize) -> Result<Vec<u32>, RunFailure> {
    card.launch(&bound(card, columns, &plan.count_lists)?);
    let weights = read(card, columns, Group::Weight)?;
    let stride = weights.len() / super::snapshot::WEIGHT_FIELDS;
    let mut starts: Vec<u32> = vec![0];
    let mut total: u32 = 0;
    for neighbors in &weights[stride..stride + count] {
        let longer = total.checked_add(*neighbors as u32);
        total = longer.ok_or_else(|| failure("more than 4 294 967 295 pairs: the card cannot number them"))?;
        starts.push(total);
    }
    Ok(starts)
}
