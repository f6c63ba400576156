//! Particles that are not as they should be: how many, and which is the worst.
//!
//! Counts are whole numbers and the worst is the first by value, then by `id`: neither depends on the order particles are looked at in,
//! so that all threads may look.

mod inside;
mod pairs;
mod pieces;
mod single;

pub use pairs::{PAIR_DISTANCE, PAIR_GAP, TEARING_RADIUS, TEARING_SHARE};
pub use single::{AGAINST, Looked, Standard};

use super::Turns;
use crate::model::{Material, Model};
use crate::particles::Particles;
use inside::Inside;
use pairs::{Pairs, Torn};
use pieces::Pieces;
use rayon::prelude::*;
use sphorge_physics::Vector;

/// What is wrong with a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Suspicion {
    /// A temperature below this, K. The number is the temperature.
    Cold(f64),
    /// A temperature above this many times the one the energy allows: the highest of those that bodies start with and boundaries have,
    /// and the reference temperature, plus `e / c_p` where the specific internal energy is above zero. The number is that ratio. Where
    /// work does not heat, nothing is hot.
    Hot(f64),
    /// A temperature of the energy above this many times the particle's own: `T_0 + (e - e_cold - (1 - beta) w_p) / c_p` with the energy `e_cold` of
    /// the density on the isotherm `T_0`, which is left out in expansion. The number is that ratio. Only materials of which heat moves the pressure
    /// are looked at.
    MissingHeat(f64),
    /// A compression `chi = 1 - rho_0/rho` above this share of the largest that a shock reaches, `1/S` (1 for a law without `S`). The
    /// number is the share.
    Compressed(f64),
    /// A density below this share of the reference density. The number is the share.
    Expanded(f64),
    /// A place outside of a box by more than this, m. The number is the distance from the box, m.
    Away {
        /// Lower corner, m; along axes that do not count minus infinity.
        low: Vector<f64>,
        /// Upper corner, m.
        high: Vector<f64>,
        /// Distance that is no suspicion, m.
        limit: f64,
    },
    /// Behind a symmetry plane by more than this, in spacings of its body, and not severed: there only its image can be. The number is that depth.
    Behind {
        /// Depth that is no suspicion, in spacings.
        limit: f64,
        /// Whether some material breaks, so that there are severed particles.
        breaks: bool,
    },
    /// In a body of a material that neither spalls nor is damaged: fewer neighbours than one more than there are dimensions, which a
    /// gradient needs. The number is that of the neighbours.
    Lonely,
    /// In a body of a material that neither spalls nor is damaged: not part of its largest piece. Particles hang together as far as the kernel
    /// of one of them reaches. The number is that of the particles of the piece.
    Apart,
    /// Two particles of one body are each other's nearest, nearer than [`PAIR_DISTANCE`], and both are left alone by the others up to
    /// [`PAIR_GAP`] times their distance. The number is their distance over the local spacing `(m/rho)^(1/d)`.
    ///
    /// A lattice that is flattened by plastic flow is not suspected: its particles come near to two neighbours, one on either side.
    Paired,
    /// In a body of a material that neither spalls nor is damaged: [`Suspicion::Paired`], in tension, and so are more than [`TEARING_SHARE`] of the
    /// particles of the body up to [`TEARING_RADIUS`] local spacings away. The number is that share.
    ///
    /// What tears in a small part of a body is seen by this. Layers that compression lays on each other, as in the foot of a bar, are not in
    /// tension, or not for long and not around.
    Torn,
    /// In the total Lagrangian form: its centre lies in the cell of a particle of another body that is in one piece, and not both are of outermost layers.
    /// The number is how deep: zero at the face of the cell, one in its centre.
    Inside {
        /// Whether outermost layers are known.
        faces: bool,
        /// Whether some material breaks, so that there are severed particles.
        breaks: bool,
    },
}

impl Suspicion {
    /// The stored fields it looks at, beside those that every reduction may.
    pub(super) fn fields(self) -> Vec<&'static str> {
        match self {
            Self::Cold(_) | Self::Hot(_) => vec!["temperature", "energy"],
            Self::MissingHeat(_) => vec!["temperature", "energy", "plastic_work"],
            Self::Lonely => vec!["neighbors"],
            // In the total Lagrangian form bodies hang together in the reference configuration.
            Self::Apart => vec!["reference_position"],
            Self::Torn => vec!["pressure"],
            Self::Compressed(_) | Self::Expanded(_) | Self::Away { .. } | Self::Paired => Vec::new(),
            Self::Behind { breaks, .. } => of_cracks(breaks).to_vec(),
            Self::Inside { faces, breaks } => {
                let of_faces: &[_] = if faces { &["reference_normal"] } else { &[] };
                [&["deformation", "earlier_deformation"], of_faces, of_cracks(breaks)].concat()
            }
        }
    }
}

/// The field that tells of cracks, which exists where something breaks.
fn of_cracks(breaks: bool) -> &'static [&'static str] {
    if breaks { &["integrity"] } else { &[] }
}

/// Numbers of one body in what comes back of a [`Suspicion`].
const SUSPECT_NUMBERS: usize = 7;

/// What was found in one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspects {
    /// Particles of the body that were looked at.
    pub particles: u64,
    /// Of these, suspicious.
    pub suspects: u64,
    /// The worst number, and who has it and where, m; without suspects nothing.
    pub worst: Option<(f64, u32, Vector<f64>)>,
}

impl Suspects {
    /// Reads what came back, body by body.
    pub fn of(numbers: &[f64]) -> Vec<Self> {
        let read = |n: &[f64]| Self {
            particles: n[0] as u64,
            suspects: n[1] as u64,
            worst: (n[1] > 0.0).then(|| (n[2], n[3] as u32, [n[4], n[5], n[6]])),
        };
        numbers.chunks_exact(SUSPECT_NUMBERS).map(read).collect()
    }
}

/// What is found while one goes through the particles.
#[derive(Clone, Copy, Default)]
struct Tally {
    particles: u64,
    suspects: u64,
    /// The worst so far: larger is worse; number to show, place in the columns.
    worst: Option<(f64, f64, usize)>,
}

impl Tally {
    /// Takes in another tally.
    fn add(&mut self, other: &Self, id: &[u32]) {
        self.particles += other.particles;
        self.suspects += other.suspects;
        let worse = match (&self.worst, &other.worst) {
            (_, None) => false,
            (None, Some(_)) => true,
            (Some(a), Some(b)) => b.0.total_cmp(&a.0).then(id[a.2].cmp(&id[b.2])).is_gt(),
        };
        if worse {
            self.worst = other.worst;
        }
    }
}

/// Whether a particle is looked at; if so, whether it is suspicious: how bad it is, and the number to show.
type Verdict = Option<Option<(f64, f64)>>;

const BLAMELESS: Verdict = Some(None);

fn suspect_above(number: f64, limit: f64) -> Verdict {
    if number > limit { Some(Some((number, number))) } else { BLAMELESS }
}

/// Goes through all particles; numbers as [`Suspects::of`] reads them.
///
/// # Errors
/// A process is lost.
pub(super) fn evaluate<R: Turns>(
    suspicion: Suspicion,
    model: &Model,
    p: &Particles,
    turns: &R,
) -> Result<Vec<f64>, R::Lost> {
    if suspicion.is_of_single_particles() {
        // The last is that of a material that is not there.
        let standards: Vec<_> =
            (0..=model.materials.len()).map(|material| suspicion.standard(model, material)).collect();
        let sense = suspicion.sense();
        return count(model, p, turns, |i| match standards[(p.material[i] as usize).min(model.materials.len())] {
            Standard::Unseen => None,
            Standard::Blameless => BLAMELESS,
            Standard::Against(against) => {
                let number = suspicion.number(model, &against, &Looked::of(model, p, i));
                let is_worse = sense * number > sense * against[0];
                if is_worse { Some(Some((sense * number, number))) } else { BLAMELESS }
            }
        });
    }
    match suspicion {
        Suspicion::Apart => {
            let is_whole = wholes(model, p);
            let pieces = Pieces::find(model, p, &is_whole);
            count(model, p, turns, |i| match is_whole(i) {
                true if pieces.is_largest(i, p) => BLAMELESS,
                true => suspect_above(f64::from(pieces.size_of(i)), 0.0),
                false => None,
            })
        }
        Suspicion::Paired => {
            let pairs = Pairs::find(model, p);
            count(model, p, turns, |i| match pairs.partner_of(i) {
                None => BLAMELESS,
                Some(_) => Some(Some((-pairs.distance(i), pairs.distance(i)))),
            })
        }
        Suspicion::Torn => {
            let is_whole = wholes(model, p);
            let torn = Torn::find(model, p);
            count(model, p, turns, |i| if is_whole(i) { suspect_above(torn.share(i), TEARING_SHARE) } else { None })
        }
        Suspicion::Inside { .. } => {
            let inside = Inside::find(model, p);
            count(model, p, turns, |i| suspect_above(inside.depth(i), 0.0))
        }
        Suspicion::Cold(_)
        | Suspicion::Hot(_)
        | Suspicion::MissingHeat(_)
        | Suspicion::Compressed(_)
        | Suspicion::Expanded(_)
        | Suspicion::Away { .. }
        | Suspicion::Behind { .. }
        | Suspicion::Lonely => Ok(Vec::new()),
    }
}

/// Whether a body of the material may come apart: it spalls, breaks by damage, or its flow law knows damage.
fn can_break(material: &Material) -> bool {
    material.breaks() || material.flow_law.history().iter().any(|v| v.name.contains("damage"))
}

/// Whether a particle is of a material that may not come apart.
fn wholes<'a>(model: &Model, p: &'a Particles) -> impl Fn(usize) -> bool + Sync + use<'a> {
    let whole: Vec<bool> = model.materials.iter().map(|material| !can_break(material)).collect();
    move |i| whole.get(p.material[i] as usize).copied().unwrap_or(false)
}

/// Particles one thread takes at a time.
const CHUNK: usize = 4096;

/// What is found in one body, as processes tell each other: particles, suspects, whether there is a worst, how bad it is, its number, who has it and where.
const TALLY_NUMBERS: usize = 9;

fn count<R: Turns>(
    model: &Model,
    p: &Particles,
    turns: &R,
    verdict: impl Fn(usize) -> Verdict + Sync,
) -> Result<Vec<f64>, R::Lost> {
    let bodies = model.bodies.len();
    let of_chunk = |chunk: usize| {
        let mut tallies = vec![Tally::default(); bodies];
        for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(p.len()) {
            let (Some(tally), Some(found)) = (tallies.get_mut(p.body[i] as usize), verdict(i)) else { continue };
            let worst = found.map(|(badness, number)| (badness, number, i));
            tally.add(&Tally { particles: 1, suspects: u64::from(found.is_some()), worst }, &p.id);
        }
        tallies
    };
    let merge = |mut a: Vec<Tally>, b: Vec<Tally>| {
        a.iter_mut().zip(&b).for_each(|(a, b)| a.add(b, &p.id));
        a
    };
    let chunks = (0..p.len().div_ceil(CHUNK)).into_par_iter();
    let tallies = chunks.map(of_chunk).reduce(|| vec![Tally::default(); bodies], merge);
    let mut all = vec![0.0; TALLY_NUMBERS * bodies];
    turns.pass(&mut all, |sums| {
        for (sums, tally) in sums.chunks_exact_mut(TALLY_NUMBERS).zip(&tallies) {
            sums[0] += tally.particles as f64;
            sums[1] += tally.suspects as f64;
            let Some((badness, number, i)) = tally.worst else { continue };
            let id = f64::from(p.id[i]);
            let is_worse = badness.total_cmp(&sums[3]).then(sums[5].total_cmp(&id)).is_gt();
            if sums[2] == 0.0 || is_worse {
                let [x, y, z] = p.position[i];
                sums[2..].copy_from_slice(&[1.0, badness, number, id, x, y, z]);
            }
        }
    })?;
    let shown = |sums: &[f64]| [sums[0], sums[1], sums[4], sums[5], sums[6], sums[7], sums[8]];
    Ok(all.chunks_exact(TALLY_NUMBERS).flat_map(shown).collect())
}

#[cfg(test)]
pub(super) mod tests;
