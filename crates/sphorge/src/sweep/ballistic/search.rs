//! Which speeds to run next, from what became of those before. Nothing else is remembered, so that a search that was stopped goes on where it was.

use super::fit::RechtIpson;
use std::cmp::Ordering;

/// What became of a projectile.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It got through.
    Through,
    /// It was stopped, or thrown back.
    Stopped,
    /// The run does not tell, and why.
    Open(String),
    /// The run did not reach its end.
    Failed,
}

impl Outcome {
    /// In a word or two.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Through => "through",
            Self::Stopped => "stopped",
            Self::Open(_) => "open",
            Self::Failed => "failed",
        }
    }

    /// Whether it is known.
    pub fn is_known(&self) -> bool {
        matches!(self, Self::Through | Self::Stopped)
    }
}

/// A run at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Impact velocity, m/s.
    pub speed: f64,
    /// Velocity at the end along the flight, m/s; none of a run that has not reached its end.
    pub residual: Option<f64>,
    /// Median velocity of the particles of all other bodies at the end along the flight, m/s.
    pub target: f64,
    /// What became of the projectile.
    pub outcome: Outcome,
}

/// The fastest that was stopped and the slowest that got through, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// The fastest speed that was stopped.
    pub stopped: f64,
    /// The slowest speed that got through.
    pub through: f64,
}

impl Bracket {
    /// Of these runs, if some were stopped and some were not.
    pub fn of(shots: &[Shot]) -> Option<Self> {
        let speeds = |of: Outcome| shots.iter().filter(move |shot| shot.outcome == of).map(|shot| shot.speed);
        let stopped = speeds(Outcome::Stopped).max_by(f64::total_cmp)?;
        Some(Self { stopped, through: speeds(Outcome::Through).min_by(f64::total_cmp)? })
    }

    /// Its middle.
    pub fn middle(&self) -> f64 {
        0.5 * (self.stopped + self.through)
    }

    /// How far its ends are apart.
    pub fn width(&self) -> f64 {
        (self.through - self.stopped).abs()
    }

    /// Whether something was stopped that was faster than what got through.
    pub fn is_mixed(&self) -> bool {
        self.through < self.stopped
    }
}

/// What is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Speed of the deck, m/s: where a search without bounds begins.
    pub own: f64,
    /// Lower bound, m/s.
    pub from: Option<f64>,
    /// Upper bound, m/s.
    pub to: Option<f64>,
    /// Further speeds to run, m/s.
    pub at: Vec<f64>,
    /// Width of a bracket that is narrow enough, m/s.
    pub within: f64,
    /// Most runs.
    pub runs: usize,
    /// Runs at once.
    pub at_once: usize,
    /// Exponent of the curve, if it is held.
    pub exponent: Option<f64>,
}

/// How a search ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The bracket is narrow enough.
    Found,
    /// Everything got through.
    AllThrough,
    /// Everything was stopped.
    AllStopped,
    /// Something was stopped that was faster than what got through, and the speeds between do not make the bracket narrower.
    Mixed,
    /// Runs in the bracket failed, or do not tell.
    Open,
    /// Runs that were there bracket the limit beyond the bounds, between which alone runs are made.
    Outside,
    /// No run tells.
    NothingTells,
    /// There are as many runs as there may be.
    RunsUsed,
}

/// What comes next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Runs at these speeds.
    Run(Vec<f64>),
    /// Nothing.
    End(End),
}

/// Runs that do not tell, in a bracket or without one, after which the search ends.
const MOST_OPEN: usize = 3;
/// What a search without bounds changes the speed by.
const STRIDE: f64 = 1.4;
/// How far it goes from the speed of the deck.
const FARTHEST: f64 = 32.0;

impl Search {
    /// What to run after these runs. Runs at other speeds than are asked for, which were there before, count as any.
    pub fn next(&self, shots: &[Shot]) -> Next {
        let is_there = |speed: f64| shots.iter().any(|shot| shot.speed == speed);
        let run = |mut speeds: Vec<f64>, made: usize| {
            speeds.truncate(self.runs.saturating_sub(made));
            if speeds.is_empty() { Next::End(End::RunsUsed) } else { Next::Run(speeds) }
        };
        let (there, missing): (Vec<f64>, Vec<f64>) = self.first().into_iter().partition(|speed| is_there(*speed));
        if !missing.is_empty() {
            // However many others were there.
            return run(missing, there.len());
        }
        let run = |speeds: Vec<f64>| run(speeds, shots.len());
        let speeds = || shots.iter().map(|shot| shot.speed);
        let lowest = speeds().min_by(f64::total_cmp).unwrap_or(self.own);
        let highest = speeds().max_by(f64::total_cmp).unwrap_or(self.own);
        let is_any = |of: Outcome| shots.iter().any(|shot| shot.outcome == of);
        let is_known_at = |speed: f64| shots.iter().all(|shot| shot.speed != speed || shot.outcome.is_known());
        let (least, most) = self.bounds();
        let open = |shot: &&Shot| !shot.outcome.is_known() && (least..=most).contains(&shot.speed);
        let is_over = shots.iter().filter(open).count() >= MOST_OPEN;
        let or_beside = |end: End, of: Outcome| match end {
            End::Open => self.beside(shots, &of).map_or(Next::End(end), run),
            _ => Next::End(end),
        };
        match (Bracket::of(shots), is_any(Outcome::Through)) {
            (Some(bracket), _) => match self.between(shots, bracket) {
                Ok(speeds) => run(speeds),
                Err(end) => Next::End(end),
            },
            (None, false) if !is_any(Outcome::Stopped) => Next::End(End::NothingTells),
            (None, _) if is_over => Next::End(End::Open),
            (None, true) if self.from.is_none() && lowest > self.own / FARTHEST => {
                run(vec![self.round(lowest / STRIDE)])
            }
            (None, true) => or_beside(if is_known_at(lowest) { End::AllThrough } else { End::Open }, Outcome::Through),
            (None, false) if self.to.is_none() && highest < self.own * FARTHEST => {
                run(vec![self.round(highest * STRIDE)])
            }
            (None, false) => {
                or_beside(if is_known_at(highest) { End::AllStopped } else { End::Open }, Outcome::Stopped)
            }
        }
    }

    /// Speeds that are run whatever comes out, each once, slow to fast.
    pub fn first(&self) -> Vec<f64> {
        let mut speeds: Vec<f64> = self.from.into_iter().chain(self.to).chain(self.at.iter().copied()).collect();
        if speeds.is_empty() {
            speeds.push(self.own);
        }
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        speeds
    }

    /// Speeds in a bracket, or why there are none to run.
    fn between(&self, shots: &[Shot], bracket: Bracket) -> Result<Vec<f64>, End> {
        if bracket.width() <= self.within {
            return Err(End::Found);
        }
        if bracket.is_mixed() {
            return Err(End::Mixed);
        }
        // Nothing is run beyond the bounds, though runs that were there may be.
        let (least, most) = self.bounds();
        let (low, high) = (bracket.stopped.max(least), bracket.through.min(most));
        if low >= high {
            return Err(End::Outside);
        }
        let bracket = Bracket { stopped: low, through: high };
        let inside = || shots.iter().filter(|shot| (low..=high).contains(&shot.speed));
        let open = inside().filter(|shot| !shot.outcome.is_known()).count();
        if open >= MOST_OPEN {
            return Err(End::Open);
        }
        if open > 0 {
            // In the middle of the widest gap between them.
            let mut ends: Vec<f64> = inside().map(|shot| shot.speed).chain([low, high]).collect();
            ends.sort_by(f64::total_cmp);
            let gap =
                ends.windows(2).max_by(|a, b| (a[1] - a[0]).partial_cmp(&(b[1] - b[0])).unwrap_or(Ordering::Equal));
            return gap
                .and_then(|gap| self.untried(shots, (gap[0], gap[1]), [0.5 * (gap[0] + gap[1])]))
                .ok_or(End::Open);
        }
        let count = self.count(bracket.width());
        let even = |k: usize| low + bracket.width() * k as f64 / (count + 1) as f64;
        let speeds = match count {
            1 => self.untried(shots, (low, high), [self.guess(shots, bracket).unwrap_or(bracket.middle())]),
            _ => self.untried(shots, (low, high), (1..=count).map(even)),
        };
        speeds.ok_or(End::Open)
    }

    /// Bounds that nothing is run beyond.
    fn bounds(&self) -> (f64, f64) {
        (self.from.unwrap_or(0.0), self.to.unwrap_or(f64::INFINITY))
    }

    /// How many runs at once there are in a gap: no more than make it narrow enough.
    fn count(&self, width: f64) -> usize {
        let enough = ((width / self.within).ceil() as usize).saturating_sub(1).max(1);
        self.at_once.clamp(1, enough)
    }

    /// Speeds in a gap as short as they may be, of which there are no runs; none if there is no other number.
    fn untried(
        &self,
        shots: &[Shot],
        (low, high): (f64, f64),
        speeds: impl IntoIterator<Item = f64>,
    ) -> Option<Vec<f64>> {
        let is_new = |speed: &f64| low < *speed && *speed < high && shots.iter().all(|shot| shot.speed != *speed);
        let rounded = |speed: f64| Some(self.round(speed)).filter(is_new).or(Some(speed).filter(is_new));
        let mut speeds: Vec<f64> = speeds.into_iter().filter_map(rounded).collect();
        speeds.dedup();
        Some(speeds).filter(|speeds| !speeds.is_empty())
    }

    /// Speeds between what was stopped, or got through, and the next run that does not tell, if these are not close.
    fn beside(&self, shots: &[Shot], of: &Outcome) -> Option<Vec<f64>> {
        let (least, most) = self.bounds();
        let speeds = |of: &dyn Fn(&Outcome) -> bool| {
            let found = shots.iter().filter(|shot| of(&shot.outcome)).map(|shot| shot.speed);
            found.collect::<Vec<f64>>().into_iter()
        };
        let (told, open) = (speeds(&|outcome| outcome == of), speeds(&|outcome| !outcome.is_known()));
        let (low, high) = match of {
            Outcome::Through => {
                let told = told.min_by(f64::total_cmp)?;
                (open.filter(|speed| *speed < told).max_by(f64::total_cmp)?, told)
            }
            _ => {
                let told = told.max_by(f64::total_cmp)?;
                (told, open.filter(|speed| *speed > told).min_by(f64::total_cmp)?)
            }
        };
        let (low, high) = (low.max(least), high.min(most));
        if high - low <= self.within {
            return None;
        }
        let count = self.count(high - low);
        self.untried(shots, (low, high), (1..=count).map(|k| low + (high - low) * k as f64 / (count + 1) as f64))
    }

    /// A speed beside the limit of the curve, so that the next two runs may close the bracket. Every third run halves it whatever the curve says.
    fn guess(&self, shots: &[Shot], bracket: Bracket) -> Option<f64> {
        if (shots.len() - self.first().len().min(shots.len())) % 3 == 2 {
            return None;
        }
        let Bracket { stopped: low, through: high } = bracket;
        let curve = RechtIpson::fit(&through(shots), (low, high), self.exponent.or(Some(2.0))).ok()?;
        let beside = 0.45 * self.within;
        let (below, above) = (curve.limit - beside, curve.limit + beside);
        let speed = if above - low < high - below { above } else { below };
        let edge = 0.05 * bracket.width();
        Some(speed.clamp(low + edge, high - edge))
    }

    /// A speed as short a number as the width allows.
    fn round(&self, speed: f64) -> f64 {
        let digits = (1.0 - self.within.log10()).ceil().clamp(-12.0, 12.0) as i32;
        let unit = 10f64.powi(digits.abs());
        if digits >= 0 { (speed * unit).round() / unit } else { (speed / unit).round() * unit }
    }
}

/// Impact and residual velocity of what got through.
pub(super) fn through(shots: &[Shot]) -> Vec<(f64, f64)> {
    let through = shots.iter().filter(|shot| shot.outcome == Outcome::Through);
    through.filter_map(|shot| Some((shot.speed, shot.residual?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search() -> Search {
        Search {
            own: 300.0,
            from: Some(150.0),
            to: Some(320.0),
            at: Vec::new(),
            within: 2.0,
            runs: 30,
            at_once: 1,
            exponent: None,
        }
    }

    fn shot(speed: f64, outcome: Outcome) -> Shot {
        let residual = match outcome {
            Outcome::Through => Some(0.8 * (speed * speed - 184.5 * 184.5).max(1.0).sqrt()),
            Outcome::Failed => None,
            _ => Some(0.0),
        };
        Shot { speed, residual, target: 0.0, outcome }
    }

    /// Runs what is asked for until the end; each batch is what is asked for at once.
    fn played(search: &Search, of: impl Fn(f64) -> Outcome) -> (Vec<Shot>, End, usize) {
        let (mut shots, mut batches) = (Vec::new(), 0);
        loop {
            match search.next(&shots) {
                Next::End(end) => return (shots, end, batches),
                Next::Run(speeds) => {
                    assert!(!speeds.is_empty() && speeds.len() + shots.len() <= search.runs);
                    for speed in speeds {
                        assert!(shots.iter().all(|known: &Shot| known.speed != speed), "{speed} twice");
                        shots.push(shot(speed, of(speed)));
                    }
                    batches += 1;
                    assert!(batches < 100);
                }
            }
        }
    }

    fn at(limit: f64) -> impl Fn(f64) -> Outcome {
        move |speed| if speed > limit { Outcome::Through } else { Outcome::Stopped }
    }

    #[test]
    fn a_limit_is_bracketed_wherever_it_is() {
        for limit in [150.5, 151.0, 170.0, 184.5, 200.0, 256.3, 319.9] {
            let (shots, end, _) = played(&search(), at(limit));
            let bracket = Bracket::of(&shots).unwrap();
            assert!(end == End::Found && bracket.width() <= 2.0, "{limit}: {bracket:?}");
            assert!(
                bracket.stopped <= limit
                    && limit < bracket.through
                    && bracket.middle() == 0.5 * (bracket.stopped + bracket.through)
            );
            // No more digits than the width needs.
            assert!(shots.iter().all(|shot| (shot.speed * 10.0).round() / 10.0 == shot.speed), "{shots:?}");
            // Bisection alone takes 9; whatever the curve says, every third run is one.
            assert!(shots.len() <= 2 + 3 * 7, "{limit}: {} runs", shots.len());
        }
    }

    #[test]
    fn the_curve_saves_runs_where_it_is_right() {
        // Two bounds, one half, and what closes the bracket around the limit of the curve; 9 by halves alone.
        let (shots, end, _) = played(&search(), at(184.5));
        assert_eq!(end, End::Found);
        assert!(shots.len() <= 7, "{shots:?}");
    }

    #[test]
    fn several_at_once_need_fewer_rounds_and_no_more_than_close_the_bracket() {
        let four = Search { at_once: 4, ..search() };
        let (shots, end, batches) = played(&four, at(211.1));
        // 170 m/s by fifths: 34, 6.8, and three within it.
        assert!(end == End::Found && batches == 4 && shots.len() == 2 + 4 + 4 + 3, "{batches} {shots:?}");
    }

    #[test]
    fn speeds_that_are_asked_for_are_run_and_count() {
        let more = Search { at: vec![400.0, 190.0, 180.0, 190.0], ..search() };
        assert_eq!(more.next(&[]), Next::Run(vec![150.0, 180.0, 190.0, 320.0, 400.0]));
        let (shots, end, _) = played(&more, at(184.5));
        assert!(end == End::Found && shots[5..].iter().all(|shot| (180.0..190.0).contains(&shot.speed)), "{shots:?}");
    }

    #[test]
    fn bounds_that_are_on_one_side_are_told_and_none_are_widened() {
        assert_eq!(played(&search(), at(400.0)).1, End::AllStopped);
        assert_eq!(played(&search(), at(100.0)).1, End::AllThrough);
        assert_eq!(played(&search(), at(100.0)).0.len(), 2);
        let free = Search { from: None, to: None, ..search() };
        assert_eq!(free.next(&[]), Next::Run(vec![300.0]));
        for limit in [40.0, 184.5, 299.0, 301.0, 2000.0] {
            let (shots, end, _) = played(&free, at(limit));
            let bracket = Bracket::of(&shots).unwrap();
            assert!(end == End::Found && bracket.stopped <= limit && limit < bracket.through, "{limit} {shots:?}");
        }
        assert_eq!(played(&free, |_| Outcome::Through).1, End::AllThrough);
        assert_eq!(played(&free, |_| Outcome::Stopped).1, End::AllStopped);
        // A bound that does not tell is no bound.
        let open = |of: f64| move |speed: f64| if speed == of { Outcome::Failed } else { Outcome::Stopped };
        assert_eq!([played(&search(), open(320.0)).1, played(&search(), open(150.0)).1], [End::Open, End::AllStopped]);
        let open = |speed: f64| if speed == 150.0 { Outcome::Failed } else { Outcome::Through };
        assert_eq!(played(&search(), open).1, End::Open);
        // How near to it all is stopped, or gets through, is found out.
        let (shots, ..) = played(&search(), open);
        let through = shots.iter().filter(|shot| shot.outcome == Outcome::Through).map(|shot| shot.speed);
        assert!(through.fold(f64::INFINITY, f64::min) <= 152.0, "{shots:?}");
        // Only one of them is given: the other side is free.
        let to = Search { from: None, ..search() };
        assert_eq!(played(&to, at(400.0)).1, End::AllStopped);
        assert_eq!(played(&to, at(100.0)).1, End::Found);
    }

    #[test]
    fn what_does_not_grow_with_speed_is_told() {
        let of = |speed: f64| {
            if speed > 200.0 || (180.0..185.0).contains(&speed) { Outcome::Through } else { Outcome::Stopped }
        };
        let mixed = Search { at: vec![183.0, 195.0], ..search() };
        let (shots, end, _) = played(&mixed, of);
        let bracket = Bracket::of(&shots).unwrap();
        assert!(end == End::Mixed && bracket.is_mixed() && (bracket.through, bracket.stopped) == (183.0, 195.0));
        assert!(shots.len() == 4 && bracket.width() == 12.0 && bracket.middle() == 189.0);
        // Within what is asked for it does no harm.
        assert_eq!(played(&Search { within: 12.0, ..mixed }, of).1, End::Found);
    }

    #[test]
    fn runs_that_fail_or_do_not_tell_are_gone_around() {
        // One speed fails, which would be in the middle.
        let of = |speed: f64| if speed == 235.0 { Outcome::Failed } else { at(184.5)(speed) };
        let (shots, end, _) = played(&search(), of);
        assert!(end == End::Found && shots.iter().any(|shot| shot.outcome == Outcome::Failed), "{shots:?}");
        // All near the limit do not tell: the bracket is left around them.
        let slow =
            |speed: f64| if (178.0..192.0).contains(&speed) { Outcome::Open("slows".into()) } else { at(184.5)(speed) };
        let (shots, end, _) = played(&search(), slow);
        let bracket = Bracket::of(&shots).unwrap();
        assert!(end == End::Open && bracket.stopped < 178.0 && bracket.through >= 192.0, "{bracket:?}");
        assert_eq!(shots.iter().filter(|shot| !shot.outcome.is_known()).count(), MOST_OPEN);
        assert_eq!(played(&search(), |_| Outcome::Failed).1, End::NothingTells);
        // Nor is the search widened for long where nothing more is told.
        let free = Search { from: None, to: None, ..search() };
        let (shots, end, _) = played(&free, |speed| if speed < 290.0 { Outcome::Failed } else { Outcome::Through });
        assert!(end == End::Open && shots.len() == 1 + MOST_OPEN, "{shots:?}");
    }

    #[test]
    fn a_limit_is_bracketed_where_one_of_the_bounds_does_not_tell() {
        for at_once in [1, 3] {
            let search = Search { at_once, ..search() };
            for (of, limit) in [(150.0, 161.0), (150.0, 310.0), (320.0, 161.0), (320.0, 310.0)] {
                let (shots, end, _) = played(&search, |speed: f64| match speed == of {
                    true => Outcome::Open("has not struck".into()),
                    false => at(limit)(speed),
                });
                let bracket = Bracket::of(&shots).unwrap();
                assert!(end == End::Found && bracket.stopped <= limit && limit < bracket.through, "{of} {shots:?}");
            }
        }
        // Slow ones do not arrive: towards what tells, and no further than as many as may be open.
        let of = |speed: f64| if speed < 240.0 { Outcome::Open("has not struck".into()) } else { at(260.0)(speed) };
        let (shots, end, _) = played(&search(), of);
        assert!(end == End::Found && shots[2].speed == 235.0 && shots[3].speed > 240.0, "{shots:?}");
        let of = |speed: f64| if speed < 315.0 { Outcome::Failed } else { Outcome::Through };
        let (shots, end, _) = played(&search(), of);
        assert!(end == End::Open && shots.len() == 1 + MOST_OPEN, "{shots:?}");
    }

    #[test]
    fn runs_that_were_there_count_and_nothing_is_run_beyond_the_bounds() {
        let there =
            |speeds: &[f64], limit: f64| speeds.iter().map(|speed| shot(*speed, at(limit)(*speed))).collect::<Vec<_>>();
        // Only what is missing of the bounds, then between what is there.
        let known = there(&[180.0, 190.0], 184.5);
        assert_eq!(search().next(&known), Next::Run(vec![150.0, 320.0]));
        let Next::Run(speeds) = search().next(&there(&[150.0, 180.0, 190.0, 320.0], 184.5)) else { panic!() };
        assert!(speeds.iter().all(|speed| (180.0..190.0).contains(speed)), "{speeds:?}");
        assert_eq!(search().next(&there(&[150.0, 183.5, 185.5, 320.0], 184.5)), Next::End(End::Found));
        // However many they are, the bounds are run.
        let few = Search { runs: 2, ..search() };
        assert_eq!(few.next(&known), Next::Run(vec![150.0, 320.0]));
        assert_eq!(few.next(&there(&[150.0, 180.0, 190.0, 320.0], 184.5)), Next::End(End::RunsUsed));
        // They bracket it beyond a bound, or beside one that does not tell.
        for (limit, low, high) in [(130.0, 100.0, 140.0), (340.0, 330.0, 350.0)] {
            let known = there(&[low, high, 150.0, 320.0], limit);
            assert_eq!(search().next(&known), Next::End(End::Outside), "{known:?}");
        }
        let mut known = there(&[50.0, 200.0, 320.0], 184.5);
        known.push(shot(150.0, Outcome::Failed));
        let Next::Run(speeds) = search().next(&known) else { panic!() };
        assert!(speeds.iter().all(|speed| (150.0..200.0).contains(speed)), "{speeds:?}");
    }

    #[test]
    fn there_are_no_more_runs_than_asked_for() {
        for runs in 1..6 {
            let (shots, end, _) = played(&Search { runs, ..search() }, at(184.5));
            assert!(end == End::RunsUsed && shots.len() == runs);
        }
    }

    #[test]
    fn a_search_goes_on_from_any_of_its_runs() {
        let (shots, _, _) = played(&search(), at(200.0));
        for known in 0..shots.len() {
            let Next::Run(speeds) = search().next(&shots[..known]) else { panic!("{known}") };
            assert!(speeds.iter().zip(&shots[known..]).all(|(speed, shot)| *speed == shot.speed));
        }
    }
}
