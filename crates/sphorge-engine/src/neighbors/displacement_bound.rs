//! An upper bound on how far points have moved.

/// Accumulated bound on the displacement of any point: as long as it is small enough, positions need not be compared.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DisplacementBound {
    /// m
    displacement: f64,
}

impl DisplacementBound {
    /// No point was displaced by more than `displacement`, m.
    pub(crate) fn advance(&mut self, displacement: f64) {
        self.displacement += displacement;
    }

    /// Points were moved or reordered: displacements between earlier and later states are unknown.
    pub(crate) fn lose_track(&mut self) {
        self.displacement = f64::INFINITY;
    }

    /// Whether no point has moved farther than `allowed` (m) since the `earlier` state; false also if that is not known.
    pub(crate) fn is_within(&self, earlier: Self, allowed: f64) -> bool {
        self.displacement - earlier.displacement <= allowed
    }
}

crate::persist_fields!(DisplacementBound { displacement });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_add_up_and_an_unknown_one_is_never_within() {
        let mut bound = DisplacementBound::default();
        let start = bound;
        bound.advance(0.5);
        let later = bound;
        bound.advance(0.25);
        assert!(bound.is_within(start, 0.75) && !bound.is_within(start, 0.7) && bound.is_within(later, 0.3));
        bound.lose_track();
        let lost = bound;
        assert!(!bound.is_within(start, 1e9) && !bound.is_within(lost, 1e9));
    }
}
