//! Fragments in the frames of a run: what has broken off, how heavy and how large it is, and how it flies and spins.
//!
//! The particles of a body that have some integrity hang together up to a distance ([`FragmentOptions::link`]). Where frames have the deformation
//! gradient `F`, it is the distance before the deformation, `|(F_i^-1 + F_j^-1)/2 (x_i - x_j)|`, so that metal which is drawn out or compressed
//! stays what it is. Of each fragment, with masses `m`, positions `x` about the centre of mass and velocities `v` relative to that of it,
//!
//! - the spin `w` is that of the rigid body with its angular momentum, `sum m (x^2 1 - x x) w = sum m x cross v`;
//! - the sizes are those of the box with its second moments: a row of `n` particles is `n` spacings long.
//!
//! What lies over the end of a periodic axis is one fragment, and places are those of the piece in one. What goes all around such an axis has no ends
//! along it: it can spin about that axis alone, and is as long as the axis.

mod joined;

pub(crate) use joined::Cloud;
use joined::Member;

use crate::{
    deck::{DeckReport, Setup, load, load_model},
    model::{Formulation, Material, Model},
    output::{FrameColumn, FrameFile, OutputError, RunDirectory, Status, Summary, mass_unit, read_series},
    particles::DEFORMATION_GRADIENT,
    plot::{FrameChoice, PlotError, body_number},
};
use serde::Serialize;
use sphorge_physics::tensor::{self, Tensor};
use std::path::PathBuf;

/// Field of what a particle still bears.
const INTEGRITY: &str = "integrity";

/// What counts as a fragment.
#[derive(Clone, Debug, PartialEq)]
pub struct FragmentOptions {
    /// Names of bodies; all of them if empty.
    pub bodies: Vec<String>,
    /// Distance up to which particles hang together, in spacings of their body.
    pub link: f64,
    /// Particles that a fragment has at least.
    pub least: u64,
}

impl Default for FragmentOptions {
    /// As the measure `fragments` of a deck.
    fn default() -> Self {
        Self { bodies: Vec::new(), link: 1.5, least: 10 }
    }
}

/// What hangs together of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fragment {
    /// Name of the body.
    pub body: String,
    /// Number of particles.
    pub particles: u64,
    /// Mass, kg; in plane strain per metre of thickness, in one dimension per square metre. Beside planes of symmetry that of the modelled part.
    pub mass: f64,
    /// Centre of mass, m.
    pub position: [f64; 3],
    /// Velocity of the centre of mass, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity, rad/s.
    pub spin: [f64; 3],
    /// Edges of the box with the same second moments, longest first, m; zero along axes that the deck does not have.
    pub size: [f64; 3],
}

/// What of a body is part of no fragment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Loose {
    /// Name of the body.
    pub body: String,
    /// Number of particles, severed ones and those of pieces that are too small.
    pub particles: u64,
    /// Their mass, in the unit of that of a fragment.
    pub mass: f64,
    /// Velocity of their centre of mass, m/s: with it the momentum of the fragments adds up to that of the body.
    pub velocity: [f64; 3],
}

/// Fragments at one time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FragmentTable {
    /// Number of the frame.
    pub frame: usize,
    /// Time, s.
    pub time: f64,
    /// Number of space dimensions.
    pub dimensions: usize,
    /// Unit of masses: in plane strain they are those of a metre of thickness, in one dimension those of a square metre.
    pub mass_unit: &'static str,
    /// The fragments, heaviest first.
    pub fragments: Vec<Fragment>,
    /// What is left of each body.
    pub loose: Vec<Loose>,
    /// What there is to note: how the run ended if not well, and what the frame does not have.
    pub notes: Vec<String>,
}

/// Why there is no table.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum FragmentError {
    /// There is no such frame or body.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Choice(#[from] PlotError),
    /// A file of the run cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The frames do not have the masses or bodies of particles, and the deck that says them cannot be read.
    #[error("the frames have no field `{name}`, and the deck of the run, which has it, cannot be read")]
    #[diagnostic(help("run the deck again with `{name}` among its `output.fields`"))]
    Deck {
        /// The field.
        name: &'static str,
        /// What is wrong with the deck.
        #[source]
        source: Box<DeckReport>,
    },
    /// The deck makes other particles than the run has.
    #[error("the frames have no field `{name}`, and the deck in {} makes {made} particles instead of {there}", path.display())]
    #[diagnostic(help("run the deck again with `{name}` among its `output.fields`"))]
    OtherParticles {
        /// The field.
        name: &'static str,
        /// The deck.
        path: PathBuf,
        /// What it makes.
        made: usize,
        /// What the frame has.
        there: usize,
    },
    /// The frames lack a field that is needed.
    #[error("the frames have no field `{name}`")]
    #[diagnostic(help("run the deck again with `{name}` among its `output.fields`"))]
    Field {
        /// Its name.
        name: &'static str,
    },
    /// A number is out of range.
    #[error("{what}")]
    #[diagnostic(help("{help}"))]
    Option {
        /// What is wrong.
        what: String,
        /// What is expected.
        help: String,
    },
}

/// The fragments in one frame of a run, or in all of them.
///
/// # Errors
/// [`FragmentError::Choice`] for a frame or body that there is not, [`FragmentError::Field`] for frames without the velocity, and what cannot be
/// read.
pub fn fragments(
    run: &RunDirectory,
    frame: Option<FrameChoice>,
    options: &FragmentOptions,
) -> Result<Vec<FragmentTable>, FragmentError> {
    options.check()?;
    let series = read_series(run)?;
    let chosen = match frame {
        None => 0..series.len(),
        Some(choice) => {
            let path = choice.pick(&series)?;
            let number = series.iter().position(|(_, of)| of == path).unwrap_or(0);
            number..number + 1
        }
    };
    let model = load_model(&run.deck()).ok();
    // Metal that breaks is not whole where frames leave its integrity out.
    let breaks = model.as_ref().is_some_and(|model| model.materials.iter().any(Material::breaks));
    let notes = notes(run, model.as_ref());
    let mut whole = None;
    let table = |number: usize| {
        let mut frame = FrameFile::open(&series[number].1)?;
        if breaks && frame.arrays().iter().all(|array| array.name != INTEGRITY) {
            return Err(FragmentError::Field { name: INTEGRITY });
        }
        let whole = match &whole {
            Some(known) => known,
            None => whole.insert(Whole::of(run, model.as_ref(), &mut frame)?),
        };
        let mut table = of_frame(number, &mut frame, whole, options)?;
        table.notes.splice(0..0, notes.iter().cloned());
        Ok(table)
    };
    chosen.map(table).collect()
}

/// What there is to note of a run, whatever its frames have.
fn notes(run: &RunDirectory, model: Option<&Model>) -> Vec<String> {
    let mut notes = Vec::new();
    match Summary::read(run).map(|summary| summary.status) {
        Ok(Status::Failed) => notes.push("the run failed: its last frame is not its end".to_owned()),
        Ok(Status::Stopped) => notes.push("the run was stopped: its last frame is not its end".to_owned()),
        Ok(Status::Completed | Status::CompletedWithWarnings) => {}
        Err(_) => notes.push("the run has not ended: its last frame is not its end".to_owned()),
    }
    if model.is_none() {
        notes.push(
            "the deck of the run cannot be read: periodic axes and what breaks are not known, and every end counts as one".to_owned(),
        );
    }
    notes
}

impl FragmentOptions {
    fn check(&self) -> Result<(), FragmentError> {
        let fault = |what: String, help: &str| Err(FragmentError::Option { what, help: help.to_owned() });
        if !(self.link > 0.0 && self.link <= 10.0) {
            return fault(
                format!("a link of {} spacings", self.link),
                "expected a number above 0, at most 10; particles of a lattice are 1 apart",
            );
        }
        if self.least == 0 {
            return fault("fragments of no particles".to_owned(), "expected a whole number of at least 1");
        }
        Ok(())
    }
}

/// What of the particles does not change.
struct Whole {
    /// Mass of each, kg.
    mass: Vec<f64>,
    /// Number of the body of each.
    body: Vec<u32>,
    /// Periodic axes: lower and upper end of the cell, m.
    periodic: [Option<(f64, f64)>; 3],
    /// Whether a frame of this form can have the deformation gradient.
    knows_deformation: bool,
}

impl Whole {
    /// As a frame has it, and the deck where that does not.
    fn of(run: &RunDirectory, model: Option<&Model>, frame: &mut FrameFile) -> Result<Self, FragmentError> {
        let (mass, body) = (frame.column("mass")?, frame.column("body")?);
        let missing = match (&mass, &body) {
            (None, _) => Some("mass"),
            (_, None) if frame.bodies.len() != 1 => Some("body"),
            _ => None,
        };
        let of_deck = missing.map(|name| of_deck(run, name, frame.count)).transpose()?;
        let of_deck = || of_deck.as_ref().map(|setup| &setup.particles);
        Ok(Self {
            mass: match mass {
                Some(column) => column.values.into_iter().map(f64::from).collect(),
                None => of_deck().map_or_else(Vec::new, |particles| particles.mass.clone()),
            },
            body: match body {
                Some(column) => column.values.into_iter().map(|x| x as u32).collect(),
                None if frame.bodies.len() == 1 => vec![0; frame.count],
                None => of_deck().map_or_else(Vec::new, |particles| particles.body.clone()),
            },
            periodic: model.map_or([None; 3], |model| model.periodic),
            knows_deformation: model
                .is_some_and(|model| matches!(model.formulation, Formulation::TotalLagrangian { .. })),
        })
    }
}

/// What the deck of a run makes, of as many particles as its frames have; `name` is the field that they lack.
fn of_deck(run: &RunDirectory, name: &'static str, there: usize) -> Result<Setup, FragmentError> {
    let path = run.deck();
    let setup =
        load(&path, &[], f64::INFINITY).map_err(|source| FragmentError::Deck { name, source: Box::new(source) })?;
    match setup.particles.len() {
        made if made == there => Ok(setup),
        made => Err(FragmentError::OtherParticles { name, path, made, there }),
    }
}

/// A field that frames have unless the deck says otherwise.
fn needed(frame: &mut FrameFile, name: &'static str) -> Result<FrameColumn, FragmentError> {
    frame.column(name)?.ok_or(FragmentError::Field { name })
}

fn of_frame(
    number: usize,
    frame: &mut FrameFile,
    whole: &Whole,
    options: &FragmentOptions,
) -> Result<FragmentTable, FragmentError> {
    let Whole { mass, body, periodic, knows_deformation } = whole;
    let position = frame.positions()?;
    if [mass.len(), body.len()].iter().any(|len| *len != position.len()) {
        let what = "its particles are not those of the frame before";
        return Err(OutputError::damaged(frame.path(), what).into());
    }
    let velocity = needed(frame, "velocity")?.values;
    let integrity = frame.column(INTEGRITY)?.map(|column| column.values);
    let deformation: Option<Vec<Tensor<f64>>> = frame.column(DEFORMATION_GRADIENT)?.filter(|f| f.width == 9).map(|f| {
        let (rows, _) = f.values.as_chunks::<9>();
        rows.iter().map(|f| [0, 3, 6].map(|k| [f[k], f[k + 1], f[k + 2]].map(f64::from))).collect()
    });
    let mut numbers: Vec<usize> = match options.bodies.is_empty() {
        true => (0..frame.bodies.len()).collect(),
        false => options.bodies.iter().map(|name| body_number(frame, name)).collect::<Result<_, _>>()?,
    };
    // A body that is named twice is there once.
    let mut is_new = vec![true; frame.bodies.len()];
    numbers.retain(|&of| std::mem::replace(&mut is_new[of], false));
    let dimensions = frame.header.dimensions;
    let mut notes = Vec::new();
    if deformation.is_none() {
        notes.push(match knows_deformation {
            true => format!(
                "the frames have no field `{DEFORMATION_GRADIENT}`: distances are those of now, and metal that is drawn out may count as several \
                 fragments; run the deck again with it among its `output.fields`"
            ),
            false => "the updated Lagrangian methods do not know the deformation: distances are those of now, and metal that is drawn out may count as \
                      several fragments"
                .to_owned(),
        });
    }
    let mut table = FragmentTable {
        frame: number,
        time: frame.header.time,
        dimensions,
        mass_unit: mass_unit(dimensions),
        fragments: Vec::new(),
        loose: Vec::new(),
        notes,
    };
    for of in numbers {
        let name = &frame.bodies[of].name;
        let spacing = frame.header.body_spacing.get(of).copied().unwrap_or(0.0);
        let is_of_body = |i: usize| body[i] as usize == of;
        let is_part = |i: usize| is_of_body(i) && integrity.as_ref().is_none_or(|integrity| integrity[i] > 0.0);
        let cloud = Cloud {
            dimensions,
            position: &position,
            deformation: deformation.as_deref(),
            link: options.link * spacing,
            periodic: *periodic,
        };
        let mut members: Vec<Vec<Member>> = vec![Vec::new(); position.len()];
        for member in cloud.joined(is_part) {
            members[member.root].push(member);
        }
        let velocity = |i: usize| [0, 1, 2].map(|a| f64::from(velocity[3 * i + a]));
        let mut is_loose: Vec<bool> = (0..position.len()).map(is_of_body).collect();
        for members in members.into_iter().filter(|members| members.len() as u64 >= options.least) {
            members.iter().for_each(|of| is_loose[of.particle] = false);
            let points = members.iter().map(|of| (mass[of.particle], of.position, velocity(of.particle)));
            let mut fragment = Fragment::of(name, dimensions, spacing, points);
            fragment.position = cloud.in_cell(fragment.position);
            let is_endless = members.first().map_or([false; 3], |of| of.is_endless);
            for (axis, spin) in fragment.spin.iter_mut().enumerate() {
                if (0..3).any(|other| other != axis && is_endless[other]) {
                    *spin = 0.0;
                }
            }
            table.fragments.push(fragment);
        }
        let mut loose = Loose { body: name.clone(), particles: 0, mass: 0.0, velocity: [0.0; 3] };
        for i in (0..position.len()).filter(|&i| is_loose[i]) {
            (loose.particles, loose.mass) = (loose.particles + 1, loose.mass + mass[i]);
            let v = velocity(i);
            loose.velocity.iter_mut().zip(v).for_each(|(sum, v)| *sum += mass[i] * v);
        }
        if loose.mass > 0.0 {
            loose.velocity = loose.velocity.map(|momentum| momentum / loose.mass);
        }
        table.loose.push(loose);
    }
    table.fragments.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    Ok(table)
}

impl Fragment {
    /// Of masses, positions and velocities.
    fn of(
        body: &str,
        dimensions: usize,
        spacing: f64,
        points: impl Iterator<Item = (f64, [f64; 3], [f64; 3])> + Clone,
    ) -> Self {
        let axes = [0, 1, 2];
        let (mut particles, mut mass, mut position, mut velocity) = (0, 0.0, [0.0; 3], [0.0; 3]);
        for (m, x, v) in points.clone() {
            (particles, mass) = (particles + 1, mass + m);
            for a in axes {
                position[a] += m * x[a];
                velocity[a] += m * v[a];
            }
        }
        let (position, velocity) = (position.map(|x| x / mass), velocity.map(|v| v / mass));
        let (mut moment, mut angular_momentum) = (tensor::zero::<f64>(), [0.0; 3]);
        for (m, x, v) in points {
            let (x, v) = (axes.map(|a| x[a] - position[a]), axes.map(|a| v[a] - velocity[a]));
            for a in axes {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                angular_momentum[a] += m * (x[b] * v[c] - x[c] * v[b]);
                for b in axes {
                    moment[a][b] += m * x[a] * x[b];
                }
            }
        }
        // A row of n particles has n spacings: each has the moment of its own cell.
        let own = spacing * spacing / 12.0;
        let principal = tensor::principal_values(moment.map(|row| row.map(|x| x / mass)));
        let mut size = [0.0; 3];
        for (k, size) in size.iter_mut().enumerate().take(dimensions) {
            *size = (12.0 * (principal[2 - k].max(0.0) + own)).sqrt();
        }
        let trace = moment[0][0] + moment[1][1] + moment[2][2];
        // Not singular for a row of particles, which has no spin about itself.
        let inertia = axes.map(|a| axes.map(|b| if a == b { trace * (1.0 + 1e-9) } else { 0.0 } - moment[a][b]));
        let spin = match trace > 0.0 {
            true => tensor::apply(&tensor::inverse(&inertia), angular_momentum),
            false => [0.0; 3],
        };
        let spin = spin.map(|w| if w.is_finite() { w } else { 0.0 });
        Self { body: body.to_owned(), particles, mass, position, velocity, spin, size }
    }
}

mod text;

#[cfg(test)]
mod tests;
