//! Output times: of frames, where steps end, and of rows, which come after the first step past theirs.

use crate::engine::persist::{Archive, ArchiveError, Persist, require};

/// The times `k * interval` after zero, and the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    interval: f64,
    end: f64,
    /// Number of the next time.
    next: u64,
}

/// Times this close, as a share of the interval, are one: `k * interval` and the end may differ by round-off.
const SAME: f64 = 1e-6;

impl Schedule {
    pub(super) fn new(interval: f64, end: f64) -> Self {
        Self { interval, end, next: 1 }
    }

    /// The next time, s. Multiplied, not summed up, so that it does not drift.
    pub(super) fn next(&self) -> f64 {
        let time = self.next as f64 * self.interval;
        if time < self.end - SAME * self.interval { time } else { self.end }
    }

    /// Whether `time` has arrived at the next time; if so, the one after it is next.
    pub(super) fn reached(&mut self, time: f64) -> bool {
        if !arrived(time, self.next()) {
            return false;
        }
        // A step without landing may have passed several; the end is none of the multiples.
        self.align(time);
        true
    }

    /// Whether the next time is that of a run which is at `time`: ahead of it, by an interval at most.
    pub(super) fn is_next_at(&self, time: f64) -> bool {
        let mut aligned = *self;
        aligned.align(time);
        // Rounding may have put a time on either side of a multiple.
        self.next.abs_diff(aligned.next) <= 1
    }

    /// Makes the first multiple after a time the next one.
    pub(super) fn align(&mut self, time: f64) {
        self.next = (time / self.interval * (1.0 + 1e-11)) as u64 + 1;
    }
}

impl Persist for Schedule {
    /// Interval and end are those of the model.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let name = format!("{name}.next");
        self.next.persist(&name, archive)?;
        require(self.next > 0, &name)
    }
}

/// Whether `time` is at `target` but for round-off.
pub(super) fn arrived(time: f64, target: f64) -> bool {
    time >= target - 1e-12 * target.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_multiples_and_the_end() {
        let mut schedule = Schedule::new(0.1, 0.35);
        let mut times = Vec::new();
        for _ in 0..5 {
            times.push(schedule.next());
            assert!(!schedule.reached(times.last().unwrap() - 1e-3));
            assert!(schedule.reached(*times.last().unwrap()));
        }
        assert_eq!(times, [0.1, 0.2, 3.0 * 0.1, 0.35, 0.35]);
    }

    #[test]
    fn an_end_on_a_multiple_is_not_met_twice() {
        // 3 * 0.1 is 0.30000000000000004.
        let mut schedule = Schedule::new(0.1, 0.3);
        assert!(schedule.reached(0.1) && schedule.reached(0.2));
        assert_eq!(schedule.next(), 0.3);
        let schedule = Schedule::new(5.0, 0.3);
        assert_eq!(schedule.next(), 0.3);
    }

    #[test]
    fn an_end_that_moves_on_leaves_out_no_multiple() {
        let mut schedule = Schedule::new(1.0, 2.5);
        assert!(schedule.reached(1.0) && schedule.reached(2.0) && schedule.reached(2.5));
        schedule.end = 6.0;
        assert_eq!(schedule.next(), 3.0);
        // A little before, by round-off.
        assert!(schedule.reached(3.0 * (1.0 - 1e-13)));
        assert_eq!(schedule.next(), 4.0);
    }

    #[test]
    fn passing_several_times_leaves_the_first_ahead() {
        let mut schedule = Schedule::new(1.0, 10.0);
        assert!(schedule.reached(3.5));
        assert_eq!(schedule.next(), 4.0);
    }
}
