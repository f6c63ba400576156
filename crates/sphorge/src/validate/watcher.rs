//! Who follows a validation.

use super::{Case, CaseReport, Variant};
use crate::run::{Observer, Silent};

/// Watches a validation; what it observes are the runs, one after the other.
pub trait Watcher: Observer {
    /// Case number `number` of `count`, from one, is next.
    fn case_started(&mut self, _case: &Case, _number: usize, _count: usize) {}
    /// The run of a variant is next.
    fn variant_started(&mut self, _variant: &Variant, _number: usize, _count: usize) {}
    /// All runs of a case are done and judged.
    fn case_judged(&mut self, _report: &CaseReport) {}
}

impl Watcher for Silent {}
