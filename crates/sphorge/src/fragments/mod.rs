//! Fragments in the frames of a run: what has broken off, how heavy and how large it is, and how it flies and spins.
//!
//! The particles of a body that have some integrity hang together up to a distance ([`FragmentOptions::link`]). Where frames have the deformation
//! gradient `F`, it is the distance before the deformation, `|(F_i^-1 + F_j^-1)/2 (x_i - x_j)|`, so that metal which is drawn out or compressed
//! stays what it is. Of each fragment, with masses `m`, positions `x` about the centre of mass and velocities `v` relative to that of it,
//!
//! - the spin `w` is that of the rigid body with its angular momentum, `sum m (x^2 1 - x x) w = sum m x cross v`;
//! - the sizes are those of the box with its second moments: a row of `n` particles is `n` spacings long.

mod joined;

pub(crate) use joined::Cloud;

use crate::{
    deck::{DeckReport, load, load_model},
    model::Material,
    output::{FrameColumn, FrameFile, OutputError, RunDirectory, read_series},
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
    /// Their mass, kg.
    pub mass: f64,
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
    /// The fragments, heaviest first.
    pub fragments: Vec<Fragment>,
    /// What is left of each body.
    pub loose: Vec<Loose>,
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
    /// The frames do not have the masses of particles, and the deck that says them cannot be read.
    #[error("the frames have no field `mass`, and the deck of the run, which has it, cannot be read")]
    #[diagnostic(help("run the deck again with `mass` among its `output.fields`"))]
    Mass(#[source] Box<DeckReport>),
    /// The deck makes other particles than the run has.
    #[error("the frames have no field `mass`, and the deck in {} makes {made} particles instead of {there}", path.display())]
    #[diagnostic(help("run the deck again with `mass` among its `output.fields`"))]
    OtherParticles {
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
    // Metal that breaks is not whole where frames leave its integrity out.
    let breaks = load_model(&run.deck()).is_ok_and(|model| model.materials.iter().any(Material::breaks));
    let mut mass = None;
    let table = |number: usize| {
        let mut frame = FrameFile::open(&series[number].1)?;
        if breaks && frame.arrays().iter().all(|array| array.name != INTEGRITY) {
            return Err(FragmentError::Field { name: INTEGRITY });
        }
        let mass = match &mass {
            Some(known) => known,
            None => mass.insert(masses(run, &mut frame)?),
        };
        of_frame(number, &mut frame, mass, options)
    };
    chosen.map(table).collect()
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

/// Masses of all particles, kg: they do not change.
fn masses(run: &RunDirectory, frame: &mut FrameFile) -> Result<Vec<f64>, FragmentError> {
    if let Some(column) = frame.column("mass")? {
        return Ok(column.values.into_iter().map(f64::from).collect());
    }
    let path = run.deck();
    let setup = load(&path, &[], f64::INFINITY).map_err(|report| FragmentError::Mass(Box::new(report)))?;
    let (made, there) = (setup.particles.len(), frame.count);
    if made != there {
        return Err(FragmentError::OtherParticles { path, made, there });
    }
    Ok(setup.particles.mass)
}

/// A field that frames have unless the deck says otherwise.
fn needed(frame: &mut FrameFile, name: &'static str) -> Result<FrameColumn, FragmentError> {
    frame.column(name)?.ok_or(FragmentError::Field { name })
}

fn of_frame(
    number: usize,
    frame: &mut FrameFile,
    mass: &[f64],
    options: &FragmentOptions,
) -> Result<FragmentTable, FragmentError> {
    let position = frame.positions()?;
    let body = needed(frame, "body")?.values;
    let velocity = needed(frame, "velocity")?.values;
    let integrity = frame.column(INTEGRITY)?.map(|column| column.values);
    let deformation: Option<Vec<Tensor<f64>>> = frame.column(DEFORMATION_GRADIENT)?.filter(|f| f.width == 9).map(|f| {
        let (rows, _) = f.values.as_chunks::<9>();
        rows.iter().map(|f| [0, 3, 6].map(|k| [f[k], f[k + 1], f[k + 2]].map(f64::from))).collect()
    });
    let numbers = match options.bodies.is_empty() {
        true => (0..frame.bodies.len()).collect(),
        false => options.bodies.iter().map(|name| body_number(frame, name)).collect::<Result<Vec<_>, _>>()?,
    };
    let dimensions = frame.header.dimensions;
    let mut table =
        FragmentTable { frame: number, time: frame.header.time, dimensions, fragments: Vec::new(), loose: Vec::new() };
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
        };
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); position.len()];
        for (i, root) in cloud.joined(is_part) {
            members[root].push(i);
        }
        let mut loose = Loose { body: name.clone(), particles: 0, mass: 0.0 };
        for i in (0..position.len()).filter(|&i| is_of_body(i)) {
            (loose.particles, loose.mass) = (loose.particles + 1, loose.mass + mass[i]);
        }
        for members in members.into_iter().filter(|members| members.len() as u64 >= options.least) {
            let velocity = |i: usize| [0, 1, 2].map(|a| f64::from(velocity[3 * i + a]));
            let points = members.iter().map(|&i| (mass[i], position[i], velocity(i)));
            let fragment = Fragment::of(name, dimensions, spacing, points);
            (loose.particles, loose.mass) = (loose.particles - fragment.particles, loose.mass - fragment.mass);
            table.fragments.push(fragment);
        }
        loose.mass = if loose.particles == 0 { 0.0 } else { loose.mass.max(0.0) };
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
