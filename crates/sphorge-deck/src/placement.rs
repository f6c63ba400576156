//! Faults of placement, found when particles exist, told in terms of the deck.

use super::fault::{Fault, Problems};
use super::interpret::SourceSpans;
use super::material::shown;
use sphorge_engine::Particles;
use sphorge_engine::geometry::{
    BoundingPlane, FillError, FilledMass, LARGEST_CLOSURE, MASS_TOLERANCE, MAX_PARTICLES, PressedBodies,
    bytes_per_particle, fitting_spacings, misplaced_layers, pressed_at_start, rings_fill,
};
use sphorge_engine::model::{Arrangement, Dimensions, LatticePlacement, Model, Solid};

/// A length for people.
pub(crate) fn millimetres(length: f64) -> String {
    // Round-off has no sign.
    format!("{:.4} mm", (length * 1e7).round() / 1e4 + 0.0)
}

fn point(position: [f64; 3], model: &Model) -> String {
    let axes: Vec<String> = position.iter().take(model.dimensions.count()).map(|c| format!("{:.4}", c * 1e3)).collect();
    format!("({}) mm", axes.join(", "))
}

/// Size of a body, m, from which on one that has too many particles may be of millimetres.
const LARGE: f64 = 1.0;

/// A value to three digits.
fn significant(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Spacings a particle may be away from the point of the tracer that follows it.
const TRACER_REACH: f64 = 2.0;

/// Tracers that would follow a particle far from their point.
pub(crate) fn check_tracers(model: &Model, particles: &Particles, places: &SourceSpans, problems: &mut Problems) {
    for (tracer, at) in model.tracers.iter().zip(&places.tracers).filter(|(tracer, _)| !tracer.is_fixed) {
        let Some((i, distance)) = particles.nearest(tracer.point, tracer.body) else { continue };
        if distance > TRACER_REACH * model.bodies[particles.body[i] as usize].spacing {
            let of = tracer.body.map_or("all bodies".to_owned(), |body| format!("body `{}`", model.bodies[body].name));
            let message = format!("tracer `{}` starts outside {of}", tracer.name);
            let label = format!("the nearest particle is {} away", millimetres(distance));
            let help = "move the point, or watch it with `fixed = true`";
            problems.push(Fault::new("stray-tracer", message, at.clone(), label).help(help));
        }
    }
}

/// Bodies that press each other before anything moves: refused where they are deeper in each other than
/// [`LARGEST_CLOSURE`], else told. Particles from files have no surface that one could expect to touch: they are told.
pub(crate) fn check_pressed(
    model: &Model,
    particles: &Particles,
    places: &SourceSpans,
    problems: &mut Problems,
) -> Vec<String> {
    let name = |body: usize| &model.bodies[body].name;
    let mut notes = Vec::new();
    for pressed in pressed_at_start(model, particles) {
        let PressedBodies { first, second, place, depth, normal, energy, force, normal_force, .. } = pressed;
        let around = pressed.is_all_around();
        let size = if around { normal_force } else { force.iter().map(|c| c * c).sum::<f64>().sqrt() };
        let per = if model.dimensions == Dimensions::Three { "" } else { "/m" };
        let overlap = format!("{} deep in each other at {}", millimetres(depth), point(place, model));
        let held = format!(
            "the contact holds {energy:.3e} J{per} and pushes with {size:.3e} N{per}{} before anything moves",
            if around { " from all sides" } else { "" }
        );
        let way = point(normal.map(|c| depth * c), model);
        let cure = if around {
            format!(
                "make the one inside smaller, or the hole larger, by {}; a press fit is let go at once, as by a blow: it rings, and metal may yield that \
                 would not at rest",
                millimetres(depth)
            )
        } else {
            format!("move `{}` by {way}, or choose spacings that fill both up to their common face", name(first))
        };
        let is_cloud = |body: usize| matches!(model.bodies[body].shape.solid, Solid::Cloud { .. });
        if pressed.share() > LARGEST_CLOSURE && !is_cloud(first) && !is_cloud(second) {
            let message = format!("bodies `{}` and `{}` press each other at the start", name(first), name(second));
            let fault = Fault::new("pressed", message, places.bodies[second].clone(), "this body")
                .also(places.bodies[first].clone(), format!("{overlap}: {held}"))
                .help(cure);
            problems.push(fault);
        } else {
            notes.push(format!("bodies `{}` and `{}` are {overlap}: {held}; {cure}", name(first), name(second)));
        }
    }
    notes
}

/// Bodies that are told of one by one.
const TOLD: usize = 20;

/// One sentence for each body, up to a number of them, that weighs more or less than its shape, or ends in a plane its lattice does not end at.
pub(crate) fn notes(model: &Model, particles: &Particles, masses: &[FilledMass]) -> Vec<String> {
    let layers = misplaced_layers(model, particles);
    let mut notes = Vec::new();
    let mut more = 0;
    for (index, (body, mass)) in model.bodies.iter().zip(masses).enumerate() {
        let mut faults = Vec::new();
        let excess = mass.excess();
        if excess.abs() > MASS_TOLERANCE {
            let word = if excess > 0.0 { "more" } else { "less" };
            faults.push(format!("its particles have {:.1} % {word} mass than its shape", 100.0 * excess.abs()));
        }
        for layer in layers.iter().filter(|layer| layer.body == index) {
            let plane = match layer.plane {
                BoundingPlane::Symmetry(plane) => {
                    format!("the symmetry plane across {}", ["x", "y", "z"][model.symmetry[plane].axis])
                }
                BoundingPlane::Wall(wall) => format!("wall `{}`", model.walls[wall].name),
            };
            let (gap, half) = (millimetres(layer.gap), millimetres(0.5 * body.spacing));
            faults
                .push(format!("its first layer of particles is {gap} from {plane} instead of half a spacing ({half})"));
        }
        if faults.is_empty() {
            continue;
        }
        if notes.len() == TOLD {
            more += 1;
            continue;
        }
        let mut cures = Vec::new();
        if body.lattice.placement == LatticePlacement::OnFaces {
            cures.push("`placement = \"cell-centres\"`".to_owned());
        }
        let fitting: Vec<String> = fitting_spacings(model, index).into_iter().flatten().map(written).collect();
        if !fitting.is_empty() {
            let plural = if fitting.len() == 1 { "a spacing that fits" } else { "spacings that fit" };
            cures.push(format!("{plural} better: {}", fitting.join(", ")));
        }
        if body.lattice.arrangement != Arrangement::Rings && rings_fill(&body.shape, model.dimensions) {
            cures.push("`lattice = \"rings\"`".to_owned());
        }
        if cures.is_empty() {
            cures.push("a finer spacing fits better".to_owned());
        }
        notes.push(format!("body `{}`: {}; {}", body.name, faults.join(", "), cures.join(", or ")));
    }
    if more > 0 {
        notes.push(format!("{more} more bodies do not fit their spacing"));
    }
    let is_known = |body: usize, plane: usize| {
        layers
            .iter()
            .any(|layer| layer.body == body && matches!(layer.plane, BoundingPlane::Symmetry(of) if of == plane))
    };
    notes.extend(crate::bonds::notes(model, particles, is_known));
    notes
}

/// A length as it would be written in a deck.
fn written(length: f64) -> String {
    format!("{} mm", (length * 1e3 * 1e12).round() / 1e12)
}

/// The fault an error of the filling is for the deck.
pub(crate) fn fault(error: FillError, model: &Model, places: &SourceSpans) -> Fault {
    let name = |body: usize| &model.bodies[body].name;
    let spacing_of = |body: usize| places.body_spacings[body].clone().unwrap_or(places.spacing.clone());
    let axis_name = |axis: usize| ["x", "y", "z"][axis];
    match error {
        FillError::Empty { body, thickness, spacing } => {
            let message = format!("body `{}` contains no particles", name(body));
            let label = format!("{} at its thinnest", millimetres(thickness));
            Fault::new("empty-body", message, places.bodies[body].clone(), label)
                .also(spacing_of(body), format!("the spacing is {}", millimetres(spacing)))
                .help(format!(
                    "a body has to be at least one spacing thick: spacing at most {}",
                    millimetres(thickness)
                ))
        }
        FillError::NoSite { body, spacing } => {
            let message = format!("body `{}` contains no particles", name(body));
            Fault::new("empty-body", message, places.bodies[body].clone(), "no lattice point is inside its shape")
                .also(spacing_of(body), format!("the spacing is {}", millimetres(spacing)))
                .help("check where the parts of its shape lie, or make the spacing smaller")
        }
        FillError::TooMany { body, count, limit } => {
            let gigabytes = count * bytes_per_particle(model) / 1e9;
            let memory = if gigabytes < 1e4 { format!("{gigabytes:.0}") } else { format!("{gigabytes:.1e}") };
            let message = format!("the deck makes about {count:.2e} particles, which take about {memory} GB");
            let why = if limit < MAX_PARTICLES { "the available memory is enough for" } else { "the limit is" };
            let d = model.dimensions.count() as f64;
            let coarser = model.bodies[body].spacing * (count / 1e6).powf(1.0 / d);
            // Where a unit has slipped by far it says nothing.
            let is_sensible = (1e-7..1e3).contains(&coarser);
            let cure = if is_sensible {
                format!("; a spacing of {} gives a million", millimetres(coarser))
            } else {
                "; check the units".to_owned()
            };
            let (low, high) = model.bodies[body].shape.bounds(model.dimensions);
            let extents = low.iter().zip(&high).take(model.dimensions.count()).map(|(low, high)| high - low);
            let across = extents.filter(|extent| extent.is_finite()).fold(0.0, f64::max);
            let size = if across >= LARGE {
                format!(
                    "body `{}` is {} across, and a number without a unit is in SI, so lengths in metres: check the units; ",
                    name(body),
                    shown(significant(across), "m")
                )
            } else {
                String::new()
            };
            let cure = if size.is_empty() { cure } else { String::new() };
            let kept = match model.time.step_control {
                Some(_) if limit < MAX_PARTICLES => ", `time.step-control.repeats = 0` nearly halves the memory",
                _ => "",
            };
            Fault::new("too-many-particles", message, spacing_of(body), "at this spacing")
                .also(places.bodies[body].clone(), "most of them here")
                .help(format!("{size}{why} {limit:.0e} particles{cure}{kept}"))
        }
        FillError::Crowded { body, position, count, spacing } => {
            let message = format!("particles of body `{}` are much closer to each other than its spacing", name(body));
            let label = format!("{count} of them within one spacing at {}", point(position, model));
            Fault::new("crowded-particles", message, places.bodies[body].clone(), label)
                .also(spacing_of(body), format!("the spacing is {}", millimetres(spacing)))
                .help("check the length unit of the file and the spacing: particles should be about one spacing apart")
        }
        FillError::Far { body, position, spacing } => {
            let message =
                format!("body `{}` is so far from the origin that its particles cannot be told apart", name(body));
            let label = format!("a particle at {}", point(position, model));
            Fault::new("too-far", message, places.bodies[body].clone(), label)
                .also(spacing_of(body), format!("the spacing is {}", millimetres(spacing)))
                .help("double precision has 15 digits: move the bodies closer to the origin, or check the units")
        }
        FillError::Overlap { first, second, position, count } => {
            let message = format!("bodies `{}` and `{}` overlap", name(first), name(second));
            let particles = if count == 1 { "one particle".to_owned() } else { format!("{count} particles") };
            Fault::new("overlap", message, places.bodies[second].clone(), "this body")
                .also(
                    places.bodies[first].clone(),
                    format!("{particles} of this body too close to the other, for example at {}", point(position, model)),
                )
                .help("move them apart; bodies that touch share a face, and their outermost particles are one spacing apart")
        }
        FillError::EmptyRegion { region } => {
            let message = format!("region `{}` contains no particles", model.regions[region].name);
            Fault::new("empty-region", message, places.regions[region].clone(), "selects no particles")
                .help("particles are half a spacing inside the faces of a body: check the shape, and its body")
        }
        FillError::BehindWall { wall, body, depth } => {
            let message = format!("body `{}` is on or behind wall `{}`", name(body), model.walls[wall].name);
            Fault::new("behind-wall", message, places.walls[wall].clone(), "this wall")
                .also(places.bodies[body].clone(), format!("reaches {} behind it", millimetres(depth.max(0.0))))
                .help("the normal points from the wall towards the material; move the body or reverse the normal")
        }
        FillError::AcrossSymmetry { plane, body, distance } => {
            let message = format!("body `{}` reaches across a symmetry plane, or meets its image", name(body));
            let label = if distance < 0.0 {
                format!("its particles reach {} behind the plane", millimetres(-distance))
            } else {
                format!("its particles come within {} of the plane", millimetres(distance))
            };
            let of = &model.symmetry[plane];
            let (low, high) = model.bodies[body].shape.bounds(model.dimensions);
            // How far it reaches to the side that the plane keeps.
            let farthest = if of.side > 0.0 { high[of.axis] - of.position } else { of.position - low[of.axis] };
            let other = if of.side > 0.0 { "negative" } else { "positive" };
            let help = match farthest <= 0.0 {
                true => format!("the whole body is behind the plane: set `side = \"{other}\"`, or move the body or the plane (`at`)"),
                false => "end the body at the plane, with particles at cell centres (an `intersection` with a box removes the rest); check `side`".to_owned(),
            };
            Fault::new("across-symmetry", message, places.symmetry[plane].clone(), "this plane")
                .also(places.bodies[body].clone(), label)
                .help(help)
        }
        FillError::OutsideCell { axis, body } => {
            let message = format!("body `{}` reaches out of the periodic cell along {}", name(body), axis_name(axis));
            Fault::new("outside-cell", message, places.periodic[axis].clone(), "this cell")
                .also(places.bodies[body].clone(), "this body")
                .help("the cell has to hold all bodies")
        }
        FillError::PeriodicOverlap { axis, distance } => {
            let message = format!("particles at the two ends of the periodic cell along {} overlap", axis_name(axis));
            Fault::new(
                "periodic-overlap",
                message,
                places.periodic[axis].clone(),
                format!("{} apart", millimetres(distance)),
            )
            .help("make the cell a whole number of spacings long, with particles at cell centres")
        }
        FillError::DrivenTwice { first, second, axis } => {
            let message = format!("some particles are driven along {} by two motions", axis_name(axis));
            Fault::new("driven-twice", message, places.motions[second].clone(), "second")
                .also(places.motions[first].clone(), "first")
                .help("choose regions that do not overlap, or leave the axis \"free\" in one of the motions")
        }
    }
}
