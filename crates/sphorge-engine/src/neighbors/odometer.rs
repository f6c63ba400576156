//! How far points may have moved.

/// Advances by at least what any point moves through: who has moved how far need not be looked at before it says that someone
/// may have moved too far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Odometer {
    /// m
    way: f64,
}

impl Odometer {
    /// No point moved farther than `way`, m.
    pub(crate) fn advance(&mut self, way: f64) {
        self.way += way;
    }

    /// Points were put somewhere else: readings before and after tell nothing of each other.
    pub(crate) fn lose_track(&mut self) {
        self.way = f64::INFINITY;
    }

    /// Whether no point has moved farther than `allowed` (m) since the `earlier` reading; false also if that is not known.
    pub(crate) fn is_within(&self, earlier: Self, allowed: f64) -> bool {
        self.way - earlier.way <= allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_add_up_and_a_lost_track_is_never_within() {
        let mut odometer = Odometer::default();
        let start = odometer;
        odometer.advance(0.5);
        let later = odometer;
        odometer.advance(0.25);
        assert!(odometer.is_within(start, 0.75) && !odometer.is_within(start, 0.7) && odometer.is_within(later, 0.3));
        odometer.lose_track();
        let lost = odometer;
        assert!(!odometer.is_within(start, 1e9) && !odometer.is_within(lost, 1e9));
    }
}
