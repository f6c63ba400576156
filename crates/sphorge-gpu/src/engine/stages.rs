//! The stages of a step: groups of kernels that are launched together.

use super::ranks::touched::Touched;
use crate::device::Launch;
use std::collections::BTreeMap;

/// A group of kernels that are launched together, in the order of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    /// New reference configuration of bodies that separate.
    Renew,
    /// Lists of the reference configuration: before their lengths are known, and after memory is allocated for them.
    CountLists,
    FillLists,
    /// For shared particles: how far they have moved since ghosts were chosen.
    GhostDisplacements,
    Begin,
    /// Smoothing lengths that follow the density.
    Follow,
    /// Before a search: wrapping of positions along periodic axes.
    Wrap,
    Sorting,
    /// With stored lists: how far particles have moved, and the search.
    Displacements,
    /// In adaptive search along periodic axes: how far particles have moved since the last full search.
    DisplacementsSinceSearch,
    Search,
    /// In adaptive search: the particles to be searched, and their search.
    Mark,
    SearchMarked,
    /// Audit of the lists.
    Audit,
    Gradients,
    /// The same with the corrections of the strain that the guard counts, in steps in which these are due.
    CorrectedGradients,
    /// Moving least squares, in steps in which they are due.
    Restore,
    /// For forces evaluated at other positions than gradients, which are corrected.
    Correct,
    /// Contact, walls and gravity.
    Push,
    Stress,
    Forces,
    /// The end of the step, and its changes.
    Finish,
    /// Heat conduction: what lies about particles, its sums if they are due, the exchange, and the extremes of both.
    LookForHeat,
    SumHeat,
    FlowHeat,
    HeatExtremes,
    /// The sums of the ledger.
    Ledger,
    /// The force through a section, and its sum over all particles.
    Section(usize),
    SectionSums(usize),
}

/// What each stage consists of.
pub(super) struct Stages<T>(BTreeMap<Stage, Vec<T>>);

impl<T> Default for Stages<T> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T> Stages<T> {
    pub(super) fn of(&self, stage: Stage) -> &[T] {
        self.0.get(&stage).map_or(&[], Vec::as_slice)
    }

    pub(super) fn is_empty(&self, stage: Stage) -> bool {
        self.of(stage).is_empty()
    }

    pub(super) fn push(&mut self, stage: Stage, kernel: T) {
        self.0.entry(stage).or_default().push(kernel);
    }

    pub(super) fn extend(&mut self, stage: Stage, kernels: impl IntoIterator<Item = T>) {
        self.0.entry(stage).or_default().extend(kernels);
    }

    /// All of them, in the order of a run.
    pub(super) fn all(&self) -> impl Iterator<Item = &T> {
        self.0.values().flatten()
    }

    /// The same stages of what a function makes of each.
    pub(super) fn map<U, E>(&self, make: impl Fn(&T) -> Result<U, E>) -> Result<Stages<U>, E> {
        let of_stage = |(stage, kernels): (&Stage, &Vec<T>)| {
            Ok((*stage, kernels.iter().map(&make).collect::<Result<Vec<U>, E>>()?))
        };
        Ok(Stages(self.0.iter().map(of_stage).collect::<Result<_, E>>()?))
    }
}

/// A kernel that is launched in a step, and its access to columns of particles, which is not needed on a single GPU.
pub(super) struct Staged {
    pub(super) launch: Launch,
    pub(super) touched: Touched,
}
