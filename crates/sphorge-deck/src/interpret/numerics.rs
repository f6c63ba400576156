//! Discretisation, search, time, output.

use crate::choice::{FaceGradientsWord, FormulationWord, GuardWord, SearchWord, SmoothingLengthWord};
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::method::{Choices, Method};
use crate::raw::{
    RawAdaptive, RawDeck, RawNumerics, RawOutput, RawSearch, RawSkin, RawSmoothingLength, RawStepControl, RawTime,
    RawTotalLagrangian,
};
use crate::strategy::Strategy;
use crate::value::{Choice, Given, Number, ScalarOr};
use sphorge_engine::model::{
    AdaptiveSearch, ArtificialStress, FaceGradients, Formulation, Numerics, OutputControl, Search, SmoothingLength,
    StepControl, TimeControl,
};
use sphorge_engine::particles::FIELDS;
use sphorge_physics::parameter::Bound;
use sphorge_physics::step_control::StepChange;

/// Exponents above give a force that is zero or infinite in all but name.
const LARGEST_EXPONENT: u64 = 16;
/// Strongest viscosity of shocks: steps are shorter in proportion.
const MOST_VISCOSITY_OF_SHOCKS: f64 = 10.0;
/// Strongest hourglass springs: their fastest vibration is 1.3 times as fast as that of the metal.
const STRONGEST_HOURGLASS: f64 = 4.0;
/// Stretches at which the reference configuration may be renewed: above those of elastic bodies.
const RENEWAL_RANGE: std::ops::RangeInclusive<f64> = 1.1..=100.0;

/// A step halved more often than this does not move the time.
const MOST_REPEATS: u64 = 100;

/// More frames or rows than these are a slip of units, and would fill a disk.
const MOST_FRAMES: f64 = 1e5;
const MOST_ROWS: f64 = 1e7;

/// The value of a key, or its default.
macro_rules! or_default {
    ($given:expr, $default:expr, $read:expr) => {
        match &$given {
            Some(given) => $read(given),
            None => Some($default),
        }
    };
}

/// Numerical options.
pub(crate) fn numerics(raw: &RawNumerics, usual: &Choices, problems: &mut Problems) -> Option<Numerics> {
    let kernel = or_default!(raw.kernel, Default::default(), |k: &Choice<_>| k.get(problems));
    let integrator = or_default!(raw.integrator, usual.integrator, |k: &Choice<_>| k.get(problems));
    let precision = or_default!(raw.precision, Default::default(), |k: &Choice<_>| k.get(problems));
    let pair_form = or_default!(raw.pair_form, Default::default(), |k: &Choice<_>| k.get(problems));
    let gradient_correction = or_default!(raw.gradient_correction, Default::default(), |k: &Choice<_>| k.get(problems));
    let energy_split = or_default!(raw.energy_split, Default::default(), |k: &Choice<_>| k.get(problems));
    let temperature = or_default!(raw.temperature, Default::default(), |k: &Choice<_>| k.get(problems));
    let xsph = or_default!(raw.xsph, usual.xsph, |x: &Given<Number>| x.within(Bound::Between(0.0, 1.0), problems));
    let mls_interval = or_default!(raw.mls_interval, None, |n: &crate::value::Count| n.positive(problems).map(Some));
    let smoothing_length =
        or_default!(raw.smoothing_length, SmoothingLength::Constant, |given| smoothing_length(given, problems));
    let viscosity = viscosity(raw, usual, problems);
    let artificial_stress = artificial_stress(raw, usual.artificial_stress, problems);
    let Viscosity {
        constants: (viscosity_alpha, viscosity_beta),
        of_shocks: viscosity_of_shocks,
        of_all_waves: viscosity_of_all_waves,
        balsara,
    } = viscosity?;
    Some(Numerics {
        kernel: kernel?,
        integrator: integrator?,
        precision: precision?,
        pair_form: pair_form?,
        gradient_correction: gradient_correction?,
        viscosity_alpha,
        viscosity_beta,
        viscosity_of_shocks,
        viscosity_of_all_waves,
        balsara,
        artificial_stress: artificial_stress?,
        xsph: xsph?,
        mls_interval: mls_interval?,
        energy_split: energy_split?,
        temperature: temperature?,
        smoothing_length: smoothing_length?,
    })
}

/// Lists that outlive the positions they were made for know kernels of one size.
pub(crate) fn check_smoothing(
    raw: &RawNumerics,
    numerics: Option<&Numerics>,
    strategy: Option<Strategy>,
    problems: &mut Problems,
) {
    let follows = numerics.is_some_and(|n| n.smoothing_length != SmoothingLength::Constant);
    let Some(given) = raw.smoothing_length.as_ref().filter(|_| follows) else { return };
    let outlive = match strategy.map(|s| s.search) {
        Some(Search::Adaptive(_) | Search::Initial) => true,
        Some(Search::EveryStep | Search::Skin { .. }) | None => false,
    };
    if outlive {
        let message = "smoothing lengths that follow the density need neighbour lists that follow the positions";
        let fault = Fault::new("wrong-search", message, given.span(), "not with the search of this deck");
        problems.push(fault.help("set `search` to \"skin\" or \"every-step\" (with `method = \"updated-lagrangian\"`), or leave the smoothing length constant"));
    }
}

fn smoothing_length(
    given: &ScalarOr<Choice<SmoothingLengthWord>, RawSmoothingLength>,
    problems: &mut Problems,
) -> Option<SmoothingLength> {
    let usual = SmoothingLength::FollowDensity { factor: defaults::SMOOTHING_FACTOR };
    let (table, at) = match given {
        ScalarOr::Scalar(word) => return Some(if word.get(problems)? { usual } else { SmoothingLength::Constant }),
        ScalarOr::Composed(table, at) => (table, at.clone()),
    };
    let options = vec![("follow-density", table.follow_density.as_ref())];
    let follow = super::exactly_one(options, "a smoothing length rule", at, problems)?;
    let factor = or_default!(follow.factor, defaults::SMOOTHING_FACTOR, |f: &Given<Number>| f
        .within(Bound::Between(1.0, 4.0), problems));
    Some(SmoothingLength::FollowDensity { factor: factor? })
}

/// Viscosity of shocks where bodies meet slowly ([`super::fast`]).
const SLOW: f64 = 0.0;

/// Artificial viscosity of a deck.
struct Viscosity {
    /// Linear and quadratic.
    constants: (f64, f64),
    /// The constant of shocks, where the deck gives it.
    of_shocks: f64,
    of_all_waves: bool,
    balsara: bool,
}

fn viscosity(raw: &RawNumerics, usual: &Choices, problems: &mut Problems) -> Option<Viscosity> {
    let plain = |constants| Viscosity { constants, of_shocks: SLOW, of_all_waves: false, balsara: false };
    let (default_alpha, default_beta) = usual.viscosity;
    let table = match &raw.viscosity {
        None => return Some(plain(usual.viscosity)),
        Some(ScalarOr::Scalar(flag)) => {
            return Some(plain(if flag.get(problems)? { usual.viscosity } else { (0.0, 0.0) }));
        }
        Some(ScalarOr::Composed(table, _)) => table,
    };
    let alpha = or_default!(table.alpha, default_alpha, |a: &Given<Number>| a.within(Bound::NonNegative, problems));
    let beta = or_default!(table.beta, default_beta, |b: &Given<Number>| b.within(Bound::NonNegative, problems));
    let balsara = or_default!(table.balsara, false, |b: &crate::value::Flag| b.get(problems));
    let shocks = or_default!(table.shocks, SLOW, |s: &Given<Number>| s
        .within(Bound::Between(0.0, MOST_VISCOSITY_OF_SHOCKS), problems));
    let all_waves = or_default!(table.all_waves, false, |b: &crate::value::Flag| b.get(problems));
    Some(Viscosity { constants: (alpha?, beta?), of_shocks: shocks?, of_all_waves: all_waves?, balsara: balsara? })
}

fn artificial_stress(
    raw: &RawNumerics,
    usual: Option<ArtificialStress>,
    problems: &mut Problems,
) -> Option<Option<ArtificialStress>> {
    let (epsilon, exponent) = defaults::ARTIFICIAL_STRESS;
    let published = ArtificialStress { epsilon, exponent };
    let table = match &raw.artificial_stress {
        None => return Some(usual),
        Some(ScalarOr::Scalar(flag)) => return flag.get(problems).map(|on| on.then_some(usual.unwrap_or(published))),
        Some(ScalarOr::Composed(table, _)) => table,
    };
    let epsilon =
        or_default!(table.epsilon, epsilon, |e: &Given<Number>| e.within(Bound::Between(0.0, 10.0), problems));
    let exponent = match &table.exponent {
        None => Some(exponent),
        Some(count) => match count.positive(problems) {
            Some(n) if n > LARGEST_EXPONENT => {
                let message = format!("the exponent must be between 1 and {LARGEST_EXPONENT}");
                problems.push(Fault::new("out-of-range", message, count.span(), format!("found {n}")));
                None
            }
            n => n.and_then(|n| u32::try_from(n).ok()),
        },
    };
    Some(Some(ArtificialStress { epsilon: epsilon?, exponent: exponent? }))
}

/// The method, its neighbour search strategy or the one that takes its place, and what it has for the other keys.
pub(crate) fn method(raw: &RawDeck, problems: &mut Problems) -> Option<(Strategy, Choices)> {
    let named = raw.method.as_ref().map(|method| method.get(problems));
    let chosen = raw.search.as_ref().map(|given| search(given, problems));
    let method = named.unwrap_or_else(|| Some(Method::of(chosen.flatten())))?;
    let strategy = chosen.unwrap_or_else(|| Some(method.choices().strategy))?;
    if let (Method::TotalLagrangian, Formulation::UpdatedLagrangian, Some(named), Some(search)) =
        (method, strategy.formulation, &raw.method, &raw.search)
    {
        let message = "the total Lagrangian form sums over the initial neighbours, not over those a search finds";
        let fault = Fault::new("not-together", message, search.span(), "this search");
        problems.push(fault.also(named.span(), "not with this method").help("leave one of them out"));
    }
    Some((strategy, method.beside(strategy)))
}

/// Neighbour search strategy and formulation.
fn search(raw: &ScalarOr<Choice<SearchWord>, RawSearch>, problems: &mut Problems) -> Option<Strategy> {
    match raw {
        ScalarOr::Scalar(word) => word.get(problems),
        ScalarOr::Composed(RawSearch { skin, adaptive, total_lagrangian }, at) => {
            enum Chosen<'a> {
                Skin(&'a RawSkin),
                Adaptive(&'a RawAdaptive),
                Total(&'a RawTotalLagrangian),
            }
            let options = vec![
                ("skin", skin.as_ref().map(Chosen::Skin)),
                ("adaptive", adaptive.as_ref().map(Chosen::Adaptive)),
                ("total-lagrangian", total_lagrangian.as_ref().map(Chosen::Total)),
            ];
            match super::exactly_one(options, "the search", at.clone(), problems)? {
                Chosen::Skin(skin) => {
                    let fraction = or_default!(skin.fraction, defaults::SKIN_FRACTION, |f| share(f, problems));
                    Some(Strategy::updated(Search::Skin { fraction: fraction? }))
                }
                Chosen::Adaptive(adaptive) => {
                    Some(Strategy::updated(Search::Adaptive(adaptive_search(adaptive, problems)?)))
                }
                Chosen::Total(total) => total_lagrangian_form(total, problems),
            }
        }
    }
}

fn adaptive_search(raw: &RawAdaptive, problems: &mut Problems) -> Option<AdaptiveSearch> {
    let default = defaults::ADAPTIVE;
    let threshold =
        or_default!(raw.plastic_strain_threshold, default.plastic_strain_threshold, |t| share_or_none(t, problems));
    let guard = or_default!(raw.guard, default.guard, |g: &Choice<GuardWord>| g.get(problems));
    let bound = or_default!(raw.strain_bound, defaults::GUARD_STRAIN, |b| share(b, problems));
    let accumulate = or_default!(raw.accumulate, default.accumulate, |a: &crate::value::Flag| a.get(problems));
    if let (Some(None), Some(given)) = (guard, &raw.strain_bound) {
        let fault = Fault::new(
            "not-together",
            "without its guard the adaptive search does not use a strain bound",
            given.span(),
            "not used",
        );
        problems.push(fault.help("leave `strain-bound` or `guard = \"none\"` out"));
    }
    let bound = bound?;
    Some(AdaptiveSearch { plastic_strain_threshold: threshold?, accumulate: accumulate?, guard: guard?.map(|_| bound) })
}

fn total_lagrangian_form(raw: &RawTotalLagrangian, problems: &mut Problems) -> Option<Strategy> {
    let corrected = or_default!(raw.form, true, |f: &Choice<FormulationWord>| f.get(problems));
    let faces = or_default!(raw.faces, FaceGradients::Linear, |f: &Choice<FaceGradientsWord>| f.get(problems));
    let usual = defaults::hourglass(faces.unwrap_or_default());
    let hourglass = or_default!(raw.hourglass, usual, |h: &Given<Number>| hourglass(h, problems));
    let renewal = or_default!(raw.renewal, defaults::RENEWAL, |r: &Given<Number>| renewal(r, problems));
    let self_contact = or_default!(raw.self_contact, true, |s: &crate::value::Flag| s.get(problems));
    let unused = [
        ("hourglass control", "hourglass", raw.hourglass.as_ref().map(|h| h.span())),
        ("correction at faces", "faces", raw.faces.as_ref().map(|f| f.span())),
        ("renewal", "renewal", raw.renewal.as_ref().map(|r| r.span())),
        ("contact of a body with itself", "self-contact", raw.self_contact.as_ref().map(|s| s.span())),
    ];
    for (what, key, given) in unused {
        if let (Some(false), Some(given)) = (corrected, given) {
            let message = format!("the frozen form has no {what}");
            let fault = Fault::new("not-together", message, given, "not used");
            problems.push(fault.help(format!("leave `{key}` or `form = \"frozen\"` out")));
        }
    }
    let (hourglass, faces, renewal, self_contact) = (hourglass?, faces?, renewal?, self_contact?);
    Some(if corrected? {
        Strategy::total(Formulation::TotalLagrangian { hourglass, faces, renewal, self_contact })
    } else {
        Strategy::updated(Search::Initial)
    })
}

/// The strength of springs that the time step is made for.
fn hourglass(given: &Given<Number>, problems: &mut Problems) -> Option<f64> {
    let strength = given.within(Bound::NonNegative, problems)?;
    if strength <= STRONGEST_HOURGLASS {
        return Some(strength);
    }
    let message = format!("the strength of the hourglass springs must be between 0 and {STRONGEST_HOURGLASS}");
    let fault = Fault::new("out-of-range", message, given.span(), format!("found the number {strength}"));
    let help = "1.25 is right for bending; decks from the time when the default was 12 need a tenth of their number";
    problems.push(fault.help(help));
    None
}

/// A stretch, or none.
fn renewal(given: &Given<Number>, problems: &mut Problems) -> Option<Option<f64>> {
    let stretch = given.within(Bound::Any, problems)?;
    if stretch == 0.0 {
        return Some(None);
    }
    if !RENEWAL_RANGE.contains(&stretch) {
        let (low, high) = (RENEWAL_RANGE.start(), RENEWAL_RANGE.end());
        let message = format!("the stretch must be between {low} and {high}, or 0 for never");
        problems.push(Fault::new("out-of-range", message, given.span(), format!("found the number {stretch}")));
        return None;
    }
    Some(Some(stretch))
}

/// Between 0 and 1, both allowed.
fn share_or_none(given: &Given<Number>, problems: &mut Problems) -> Option<f64> {
    given.within(Bound::Between(0.0, 1.0), problems)
}

/// Above 0, at most 1.
fn share(given: &Given<Number>, problems: &mut Problems) -> Option<f64> {
    given.positive(problems)?;
    given.within(Bound::Between(0.0, 1.0), problems)
}

/// End of the run and time step; `usual` is the Courant number of the method.
pub(crate) fn time(raw: &RawTime, usual: f64, problems: &mut Problems) -> Option<TimeControl> {
    let end = raw.end.as_ref().and_then(|end| end.positive(problems));
    let courant = or_default!(raw.courant, usual, |c| share(c, problems));
    let max_step = or_default!(raw.max_step, None, |s: &Given<_>| s.positive(problems).map(Some));
    let fixed_step = or_default!(raw.fixed_step, None, |s: &Given<_>| s.positive(problems).map(Some));
    let stop = or_default!(raw.stop_kinetic_fraction, None, |s: &Given<Number>| {
        s.within(Bound::Between(0.0, 1.0), problems).map(Some)
    });
    let step_control = step_control(&raw.step_control, problems);
    let RawStepControl { density, stretch, energy, jump, repeats } = &raw.step_control;
    let numbers = [density, stretch, energy, jump].into_iter().flatten().map(Given::span);
    if let Some(fixed) = &raw.fixed_step
        && let Some(given) = numbers.chain(repeats.as_ref().map(crate::value::Count::span)).next()
    {
        let fault = Fault::new("not-together", "a fixed time step cannot have step control", given, "not used");
        problems.push(fault.also(fixed.span(), "given here").help("leave out one of them"));
    }
    let max_steps = or_default!(raw.max_steps, None, |n: &crate::value::Count| n.whole(problems).map(Some));
    Some(TimeControl {
        end: end?,
        courant: courant?,
        max_step: max_step?,
        fixed_step: fixed_step?,
        // A step that is given is taken as it is.
        step_control: step_control?.filter(|_| raw.fixed_step.is_none()),
        stop_kinetic_fraction: stop?,
        max_steps: max_steps?,
    })
}

/// When a step is taken back; `None` inside for never.
fn step_control(raw: &RawStepControl, problems: &mut Problems) -> Option<Option<StepControl>> {
    let default = StepChange::DEFAULT;
    let density = or_default!(raw.density, default.density, |n: &Given<_>| n.positive(problems));
    let stretch = or_default!(raw.stretch, default.stretch, |n: &Given<_>| n.positive(problems));
    let energy = or_default!(raw.energy, default.energy, |n: &Given<_>| n.positive(problems));
    let jump = or_default!(raw.jump, default.jump, |n: &Given<_>| n.positive(problems));
    let repeats = or_default!(raw.repeats, defaults::REPEATS, |n: &crate::value::Count| {
        let count = n.whole(problems)?;
        if count > MOST_REPEATS {
            let message = format!("a step is repeated at most {MOST_REPEATS} times");
            problems.push(Fault::new("out-of-range", message, n.span(), format!("found {count}")));
            return None;
        }
        Some(count as u32)
    });
    let largest = StepChange { density: density?, stretch: stretch?, energy: energy?, jump: jump? };
    let repeats = repeats?;
    Some((repeats > 0).then_some(StepControl { largest, repeats }))
}

/// What to write and when; `end` is the end of the run, if it could be read.
pub(crate) fn output(
    raw: &RawOutput,
    end: Option<f64>,
    search: Option<Search>,
    problems: &mut Problems,
) -> Option<OutputControl> {
    let frames = or_default!(raw.frames, defaults::FRAMES, |f: &crate::value::Count| f.positive(problems));
    let frame_interval = or_default!(raw.frame_interval, None, |t: &Given<_>| t.positive(problems).map(Some));
    let history_interval = or_default!(raw.history_interval, None, |t: &Given<_>| t.positive(problems).map(Some));
    if let (Some(count), Some(interval)) = (&raw.frames, &raw.frame_interval) {
        let fault = Fault::new(
            "exactly-one",
            "`frames` and `frame-interval` both set the time between frames",
            interval.span(),
            "and here",
        );
        problems.push(fault.also(count.span(), "here").help("keep one of them"));
    }
    let fields = match &raw.fields {
        None => {
            // Who is searched is what there is to see of an adaptive search.
            let is_usual =
                |name: &str, usual| usual || (name == "adapted" && matches!(search, Some(Search::Adaptive(_))));
            let usual = FIELDS.iter().filter(|f| is_usual(f.name, f.default_output));
            Some(usual.map(|f| f.name.to_owned()).collect())
        }
        Some(words) => super::observed::listed_fields(words, problems),
    };
    let is_compressed = or_default!(raw.compression, true, |k: &Choice<_>| k.get(problems));
    let in_pieces = or_default!(raw.pieces, true, |k: &Choice<_>| k.get(problems));
    let end = end?;
    let frame_interval = frame_interval?.unwrap_or(end / frames? as f64);
    let history_interval = history_interval?.unwrap_or(end / defaults::HISTORY_ROWS as f64);
    let place = |given: &Option<Given<crate::value::Time>>| given.as_ref().map_or(0..0, |g| g.span());
    let frames_at = raw.frames.as_ref().map_or_else(|| place(&raw.frame_interval), |f| f.span());
    for (what, interval, most, at) in [
        ("frames", frame_interval, MOST_FRAMES, frames_at),
        ("rows of the history", history_interval, MOST_ROWS, place(&raw.history_interval)),
    ] {
        let count = end / interval;
        if count > most {
            let message = format!("this makes {count:.1e} {what}; at most {most:.0e} are written");
            problems.push(Fault::new("out-of-range", message, at, "here").help("choose a longer interval"));
        }
    }
    Some(OutputControl {
        frame_interval,
        history_interval,
        fields: fields?,
        is_compressed: is_compressed?,
        in_pieces: in_pieces?,
    })
}
