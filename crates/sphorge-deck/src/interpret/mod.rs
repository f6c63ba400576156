//! From the deck as written to the model: units, defaults, names, bounds. Independent faults are collected, not stopped at.

mod body;
mod boundary;
mod cloud;
mod contact;
mod fast;
mod idle;
mod limits;
mod material;
mod measure;
mod numerics;
mod observed;
mod shape;
mod subjects;
mod thermal;
mod velocity;
mod warnings;

use super::fault::{Fault, Problems};
use super::method::Method;
use super::printable::is_printable;
use super::raw::{RawDeck, RawRegion};
use super::strategy::Strategy;
use super::suggest::suggest;
use super::value::{Kind, ScalarOr, VectorOf, Word};
use sphorge_engine::model::{BodyContact, Dimensions, Formulation, Integrator, Model, Numerics, Region, Search};
use sphorge_engine::particles::{DEFORMATION_GRADIENT, is_kept};
use std::{cell::Cell, collections::HashMap, ops::Range};
use subjects::Subjects;

/// Where the things of a model stand in the deck, for faults found only when particles exist.
#[derive(Debug, Default)]
pub(crate) struct SourceSpans {
    pub(crate) spacing: Range<usize>,
    pub(crate) bodies: Vec<Range<usize>>,
    /// The spacing of its own, where a body has one.
    pub(crate) body_spacings: Vec<Option<Range<usize>>>,
    pub(crate) regions: Vec<Range<usize>>,
    pub(crate) walls: Vec<Range<usize>>,
    pub(crate) symmetry: Vec<Range<usize>>,
    pub(crate) periodic: [Range<usize>; 3],
    pub(crate) motions: Vec<Range<usize>>,
    pub(crate) tracers: Vec<Range<usize>>,
    pub(crate) heat_boundaries: Vec<Range<usize>>,
    /// What notes are about.
    pub(crate) subjects: Subjects,
}

/// More than one of what names name.
fn plural(what: &str) -> String {
    what.strip_suffix('y').map_or_else(|| format!("{what}s"), |stem| format!("{stem}ies"))
}

/// Names of the deck's bodies, regions or walls, with what they are called in messages.
#[derive(Debug)]
pub(crate) struct Names {
    what: &'static str,
    names: Vec<String>,
    /// Place of each name among them.
    indices: HashMap<String, usize>,
    /// Whether the deck refers to each.
    are_found: Vec<Cell<bool>>,
}

impl Names {
    /// Takes the names and reports those that are no names or not the only one.
    pub(crate) fn collect<'a>(
        what: &'static str,
        words: impl Iterator<Item = &'a Word>,
        problems: &mut Problems,
    ) -> (Self, Vec<Range<usize>>) {
        let mut names: Vec<String> = Vec::new();
        let mut places: Vec<Range<usize>> = Vec::new();
        let mut indices: HashMap<String, usize> = HashMap::new();
        for (index, word) in words.enumerate() {
            let name = word.text(problems).unwrap_or_default().to_owned();
            let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
            let help = "use 1 to 64 letters, digits, `-` and `_`: names become columns and files";
            let bad = |message: String| Fault::new("bad-name", message, word.span(), "this name").help(help);
            if word.peek().is_none() {
                // That it is no text has been told.
            } else if name.is_empty() {
                problems.push(bad(format!("a {what} needs a name")));
            } else if name.len() > 64 {
                problems.push(bad(format!("a name of {} characters is too long for a {what}", name.chars().count())));
            } else if !name.chars().all(legal) {
                problems.push(bad(format!("`{name}` cannot name a {what}")));
            } else if let Some(&first) = indices.get(&name) {
                let message = format!("two {} are called `{name}`", plural(what));
                let fault = Fault::new("duplicate-name", message, word.span(), "again here");
                problems.push(fault.also(places[first].clone(), "first here").help("give each its own name"));
            }
            indices.entry(name.clone()).or_insert(index);
            names.push(name);
            places.push(word.span());
        }
        let are_found = vec![Cell::new(false); names.len()];
        (Self { what, names, indices, are_found }, places)
    }

    /// The index of a name the deck refers to.
    pub(crate) fn find(&self, word: &Word, problems: &mut Problems) -> Option<usize> {
        let name = word.text(problems)?;
        let found = self.indices.get(name).copied();
        if let Some(index) = found {
            self.are_found[index].set(true);
        }
        if found.is_none() {
            let message = format!("there is no {} called `{name}`", self.what);
            let fault = Fault::new("unknown-name", message, word.span(), "not in the deck");
            let help = suggest(name, self.names.iter().map(String::as_str), &plural(self.what));
            problems.push(fault.help(help).if_all_entries_are_read());
        }
        found
    }

    /// Those that the deck has not referred to so far.
    fn unused(&self) -> impl Iterator<Item = &str> {
        self.names.iter().zip(&self.are_found).filter(|(_, is_found)| !is_found.get()).map(|(name, _)| name.as_str())
    }
}

/// A vector with the components the deck's dimensions ask for; further components may be given if they are zero.
pub(crate) fn vector<K: Kind>(
    given: &VectorOf<K>,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<[f64; 3]> {
    let mut values = [0.0; 3];
    let mut sound = true;
    let count = dimensions.count();
    if given.components.len() < count || given.components.len() > 3 {
        problems.push(wrong_length(dimensions, None, given.components.len(), given.span.clone(), K::KIND.examples));
        return None;
    }
    for (axis, component) in given.components.iter().enumerate() {
        match component.si(problems) {
            Some(value) if axis >= count && value != 0.0 => {
                let message = format!("{}, so this component must be zero", described(dimensions));
                problems
                    .push(Fault::new("wrong-dimensions", message, component.span(), "not zero").help("leave it out"));
                sound = false;
            }
            Some(value) => values[axis] = value,
            None => sound = false,
        }
    }
    sound.then_some(values)
}

/// Fault of a list that does not have one entry per axis.
pub(crate) fn wrong_length(
    dimensions: Dimensions,
    key: Option<&str>,
    found: usize,
    at: Range<usize>,
    examples: &str,
) -> Fault {
    let count = dimensions.count();
    let plural = if count == 1 { "" } else { "s" };
    let of = key.map(|key| format!(" in `{key}`")).unwrap_or_default();
    let message = format!("expected {count} component{plural}{of}, found {found}");
    Fault::new("wrong-dimensions", message, at, format!("{}: one entry per axis", described(dimensions)))
        .help(format!("each entry as {examples}"))
}

/// The deck's dimensions in a sentence.
pub(crate) fn described(dimensions: Dimensions) -> &'static str {
    match dimensions {
        Dimensions::One => "the deck is one-dimensional",
        Dimensions::PlaneStrain => "the deck is plane strain",
        Dimensions::Three => "the deck is three-dimensional",
    }
}

/// Fault of an axis the deck does not have.
pub(crate) fn check_axis(
    axis: usize,
    at: Range<usize>,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<usize> {
    if axis < dimensions.count() {
        return Some(axis);
    }
    let message = format!("{}: there is no {} axis", described(dimensions), ["x", "y", "z"][axis]);
    problems.push(Fault::new("wrong-dimensions", message, at, "this axis"));
    None
}

/// The value of the one of several keys that is given.
pub(crate) fn exactly_one<T>(
    options: Vec<(&'static str, Option<T>)>,
    what: &str,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<T> {
    let given: Vec<(&str, bool)> = options.iter().map(|(name, value)| (*name, value.is_some())).collect();
    let index = only_one(&given, what, at, problems)?;
    options.into_iter().nth(index)?.1
}

/// The place of the only option that is given.
fn only_one(options: &[(&str, bool)], what: &str, at: Range<usize>, problems: &mut Problems) -> Option<usize> {
    let given: Vec<usize> = (0..options.len()).filter(|&k| options[k].1).collect();
    if let [index] = given.as_slice() {
        return Some(*index);
    }
    let listed = |words: &[&str]| crate::suggest::listed(words.iter().copied(), "or");
    if given.is_empty() {
        let names: Vec<&str> = options.iter().map(|option| option.0).collect();
        let one_of = if names.len() == 1 { "" } else { "one of " };
        let message = format!("{what} needs {one_of}{}", listed(&names));
        problems.push(Fault::new("exactly-one", message, at, "has none").if_its_entry_is_whole());
    } else {
        let found: Vec<&str> = given.iter().map(|&k| options[k].0).collect();
        let message = format!("{what} can have only one of {}", listed(&found));
        problems.push(Fault::new("exactly-one", message, at, "has several").help("keep one of them"));
    }
    None
}

/// What a deck means.
pub(crate) struct Interpreted {
    pub(crate) model: Model,
    pub(crate) places: SourceSpans,
    /// What the user should know: what the choices of the deck leave out, what is doubtful in a material.
    pub(crate) notes: Vec<String>,
    /// The same of materials of the catalogue as they are.
    pub(crate) catalogue_notes: Vec<String>,
    /// Names of materials whose conductivity is zero because nothing states it.
    pub(crate) without_conductivity: Vec<String>,
    /// Whether the deck has a table of heat.
    pub(crate) asks_for_heat: bool,
    /// Names of materials whose density or modulus has been told to be wrong: what follows from it is not.
    pub(crate) with_odd_moduli: Vec<String>,
}

/// Interprets a deck; `None` only with faults in `problems`.
pub(crate) fn interpret(raw: &RawDeck, name: &str, problems: &mut Problems) -> Option<Interpreted> {
    if limits::exceeds(raw, problems) {
        return None;
    }
    let dimensions = raw.dimensions.as_ref().and_then(|word| word.get(problems));
    let spacing_given = raw.particles.as_ref().and_then(|particles| particles.spacing.as_ref());
    let spacing = spacing_given.and_then(|spacing| spacing.spacing(problems));
    let method = numerics::method(raw, problems);
    let (strategy, usual) = (method.map(|m| m.0), method.map_or_else(|| Method::of(None).choices(), |m| m.1));
    let mut numerics = numerics::numerics(&raw.numerics, &usual, problems);
    let search = strategy.map(|strategy| strategy.search);
    let audit = match &raw.audit {
        None => Some(None),
        Some(steps) => steps.positive(problems).map(Some),
    };
    numerics::check_smoothing(&raw.numerics, numerics.as_ref(), strategy, problems);
    let mut time = raw.time.as_ref().and_then(|time| numerics::time(time, usual.courant, problems));
    let output = numerics::output(&raw.output, time.as_ref().map(|t| t.end), search, problems);
    let library = material::Library::new(&raw.material, problems);
    let (body_names, body_places) = Names::collect("body", raw.body.iter().map(|b| &b.name), problems);
    let (region_names, region_places) = Names::collect("region", raw.region.iter().map(|r| &r.name), problems);
    let (_, wall_places) = Names::collect("wall", raw.wall.iter().map(|w| &w.name), problems);
    if raw.body.is_empty() && problems.is_empty() {
        let help = "add a [[body]] with `name`, `material` and `shape`";
        problems.push(Fault::new("no-body", "the deck has no body", 0..0, "nothing to simulate").help(help));
    }
    // Vectors cannot be read without the dimensions.
    let dimensions = dimensions?;
    let mut materials = material::Chosen::new(&library);
    let defaults = body::ParticleDefaults::read(raw.particles.as_ref(), spacing, &usual, problems);
    let bodies: Vec<_> =
        raw.body.iter().map(|b| body::body(b, dimensions, &defaults, &mut materials, problems)).collect();
    if raw.time.as_ref().is_some_and(|time| time.courant.is_none())
        && let Some(time) = &mut time
        && bodies.iter().flatten().any(|body| !materials.has_strength(body.material))
    {
        time.courant = time.courant.min(crate::defaults::COURANT);
    }
    let regions: Vec<_> = raw.region.iter().map(|r| region(r, &body_names, dimensions, problems)).collect();
    let walled = boundary::Walled {
        spacing,
        usual: usual.wall,
        formulation: strategy.map(|strategy| strategy.formulation),
        bodies: &bodies,
        dimensions,
        has_strength: &|material| materials.has_strength(material),
        yield_speed: &|body| materials.yield_speed(body.material, body.temperature),
    };
    let walls: Vec<_> = raw.wall.iter().map(|w| boundary::wall(w, dimensions, &walled, problems)).collect();
    let (periodic, periodic_places) = boundary::periodic(&raw.periodic, dimensions, problems);
    let symmetry = boundary::symmetry(&raw.symmetry, &periodic, dimensions, problems);
    let motions: Vec<_> = raw.motion.iter().map(|m| boundary::motion(m, &region_names, dimensions, problems)).collect();
    let contact = contact::contact(raw.contact.as_ref(), strategy.map(|s| s.formulation), raw.body.len(), problems);
    let gravity = raw.gravity.as_ref().map_or(Some([0.0; 3]), |g| vector(g, dimensions, problems));
    let formulation = strategy.map(|strategy| strategy.formulation);
    let scene = measure::Scene { dimensions, formulation, bodies: &body_names, regions: &region_names };
    let measures = measure::measures(&raw.measure, &scene, problems);
    let tracers = observed::tracers(&raw.tracer, &scene, problems);
    let sections = observed::sections(&raw.section, &scene, problems);
    let warnings = warnings::limits(&raw.warnings, problems);
    let title = raw.title.as_ref().map_or(Some(""), |t| t.text(problems)).map(str::to_owned);
    if let (Some(text), Some(word)) = (&title, &raw.title)
        && !is_printable(text)
    {
        // It goes to terminals and files as it is.
        let message = "expected a title of one line without control characters";
        let fault = Fault::new("control-character", message, word.span(), "this title");
        problems.push(fault.help("it appears in terminals, pictures and files"));
    }
    check_together(raw, dimensions, strategy, numerics.as_ref(), contact, problems);
    let thermal = thermal::thermal(raw.thermal.as_ref(), dimensions, &body_names, &region_names, problems);
    if let Some(thermal) = thermal.as_ref().filter(|t| t.conduction) {
        let at = raw.thermal.as_ref().map_or(0..0, |t| t.span());
        materials.need_conduction(thermal.mechanics, at, problems);
    }
    if numerics.as_ref().is_some_and(|n| n.temperature == sphorge_engine::model::TemperatureSource::Energy) {
        materials.need_specific_heat("`numerics.temperature = \"energy\"`", problems);
    }
    if strategy.is_some_and(|strategy| strategy.formulation == Formulation::UpdatedLagrangian) {
        materials.refuse_hyperelastic(problems);
    }
    materials.tell_unused(problems);
    if !problems.is_empty() {
        return None;
    }
    let places = SourceSpans {
        spacing: spacing_given.map_or(0..0, |spacing| spacing.span()),
        bodies: body_places,
        body_spacings: raw.body.iter().map(|b| b.spacing.as_ref().map(|s| s.span())).collect(),
        regions: region_places,
        walls: wall_places,
        symmetry: raw.symmetry.iter().map(|s| s.axis.span()).collect(),
        periodic: periodic_places,
        motions: raw.motion.iter().map(|m| m.region.span()).collect(),
        heat_boundaries: raw.thermal.iter().flat_map(|thermal| &thermal.boundary).map(|b| b.name.span()).collect(),
        tracers: raw.tracer.iter().map(|t| t.point.span.clone()).collect(),
        subjects: Subjects::new(raw),
    };
    let dropped = strategy.zip(numerics.as_mut()).and_then(|(strategy, n)| strategy.normalise(n));
    let mut notes = materials.notes().to_vec();
    let catalogue_notes = materials.catalogue_notes().to_vec();
    let (without_conductivity, with_odd_moduli) = (materials.without_conductivity(), materials.with_odd_moduli());
    notes.extend(dropped);
    let used_by = "no motion, measure, tracer or heat boundary";
    notes.extend(
        region_names.unused().map(|name| format!("{used_by} of the deck names region `{name}`, which has no effect")),
    );
    let (materials, formulation, mut output) = (materials.into_materials(), strategy?.formulation, output?);
    if raw.output.fields.is_none() {
        output.fields.retain(|field| is_kept(field, formulation, &materials));
    } else if !matches!(formulation, Formulation::TotalLagrangian { .. }) {
        let listed = output.fields.len();
        output.fields.retain(|field| field != DEFORMATION_GRADIENT);
        if output.fields.len() < listed {
            notes.push(format!(
                "the updated Lagrangian form does not know the field `{DEFORMATION_GRADIENT}`, which is left out"
            ));
        }
    }
    let mut model = Model {
        title: title?,
        name: name.to_owned(),
        dimensions,
        spacing: spacing?,
        numerics: numerics?,
        formulation,
        search: search?,
        audit: audit?,
        time: time?,
        materials,
        bodies: bodies.into_iter().collect::<Option<_>>()?,
        contact: contact?,
        thermal: thermal?,
        regions: regions.into_iter().collect::<Option<_>>()?,
        walls: walls.into_iter().collect::<Option<_>>()?,
        symmetry: symmetry?,
        periodic,
        motions: motions.into_iter().collect::<Option<_>>()?,
        gravity: gravity?,
        output,
        measures: measures?,
        tracers: tracers?,
        sections: sections?,
        warnings: warnings?,
    };
    let (of_shocks, note) = fast::viscosity_of_shocks(&raw.numerics, usual.viscosity_of_shocks, &model);
    model.numerics.viscosity_of_shocks = of_shocks;
    notes.extend(note);
    idle::tell(raw, &model, problems);
    notes.splice(0..0, problems.take_doubts());
    Some(Interpreted {
        model,
        places,
        notes,
        catalogue_notes,
        without_conductivity,
        with_odd_moduli,
        asks_for_heat: raw.thermal.is_some(),
    })
}

/// Choices that exclude each other.
fn check_together(
    raw: &RawDeck,
    dimensions: Dimensions,
    strategy: Option<Strategy>,
    numerics: Option<&Numerics>,
    contact: Option<BodyContact>,
    problems: &mut Problems,
) {
    let total = strategy.is_some_and(|strategy| strategy.search == Search::Initial);
    if let (true, Some(n), Some(key)) = (total, numerics, &raw.numerics.integrator)
        && n.integrator == Integrator::PredictorCorrector
    {
        let message = "the total Lagrangian form is integrated by leapfrog";
        let help = "choose `integrator = \"leapfrog\"`, or a method that sums over the current neighbours: \
                    `method = \"updated-lagrangian\"`";
        problems.push(Fault::new("not-together", message, key.span(), "not in the total Lagrangian form").help(help));
    }
    // A deck that names neither search nor method has the default one.
    let with_search = |fault: Fault| match (&raw.search, &raw.method) {
        (Some(search), _) => fault.also(search.span(), "not with this search"),
        (None, Some(method)) => fault.also(method.span(), "not with this method"),
        (None, None) => fault,
    };
    if let (Some(strategy), Some(how), Some(contact)) = (strategy, contact, &raw.contact)
        && let Some((message, help)) = without_contact(strategy, how, raw.body.len())
    {
        let fault = Fault::new("not-together", message, contact.span(), "this contact");
        problems.push(with_search(fault).help(help));
    }
    let cell = [&raw.periodic.x, &raw.periodic.y, &raw.periodic.z].into_iter().flatten().next();
    if let (Some(Formulation::TotalLagrangian { .. }), true, Some(cell)) =
        (strategy.map(|s| s.formulation), raw.body.len() > 1, cell)
    {
        let message = "contact across the ends of a periodic cell is not possible in the total Lagrangian form";
        let fault = Fault::new("not-together", message, cell.span.clone(), "periodic");
        problems.push(with_search(fault).help("choose `method = \"updated-lagrangian\"`"));
    }
    if let Some(Formulation::TotalLagrangian { self_contact: true, .. }) = strategy.map(|s| s.formulation) {
        check_self_contact(raw, dimensions, contact, problems);
    }
}

/// A body that is asked to meet itself where it cannot.
fn check_self_contact(raw: &RawDeck, dimensions: Dimensions, contact: Option<BodyContact>, problems: &mut Problems) {
    let Some(ScalarOr::Composed(search, _)) = &raw.search else { return };
    let Some(given) = search.total_lagrangian.as_ref().and_then(|form| form.self_contact.as_ref()) else { return };
    let (where_not, why) = match (&raw.periodic.x, &raw.periodic.y, &raw.periodic.z) {
        _ if contact == Some(BodyContact::Sph) => ("with kernel sums", raw.contact.as_ref().map(|c| c.span())),
        _ if dimensions == Dimensions::One => ("in one dimension", raw.dimensions.as_ref().map(|word| word.span())),
        (Some(cell), ..) | (_, Some(cell), _) | (.., Some(cell)) => ("in a periodic cell", Some(cell.span.clone())),
        (None, None, None) => return,
    };
    let message = format!("self-contact is not possible {where_not}");
    let fault = Fault::new("not-together", message, given.span(), "not possible");
    let fault = match why {
        Some(span) => fault.also(span, "with this"),
        None => fault,
    };
    problems.push(fault.help("leave `self-contact` out"));
}

/// Why bodies cannot meet in this way with a strategy, and what to do.
fn without_contact(strategy: Strategy, contact: BodyContact, bodies: usize) -> Option<(&'static str, &'static str)> {
    match (strategy.formulation, strategy.search, contact) {
        (Formulation::TotalLagrangian { .. }, _, BodyContact::Sph) if bodies > 1 => Some((
            "the total Lagrangian form sums over the particles of one body, so bodies cannot interact through kernel sums",
            "choose `contact = \"penalty\"`, which is its default, or `method = \"updated-lagrangian\"`",
        )),
        (Formulation::UpdatedLagrangian, Search::Initial, BodyContact::Penalty(_) | BodyContact::Facets { .. }) => {
            Some((
                "initial neighbour lists do not include approaching bodies, so a contact between them is not possible",
                "choose another `search`, or leave `contact` out",
            ))
        }
        (_, Search::Adaptive(adaptive), BodyContact::Penalty(_) | BodyContact::Facets { .. })
            if adaptive.guard.is_none() =>
        {
            Some((
                "the adaptive search without its guard misses approaching bodies, so a contact between them is not possible",
                "leave `guard` out, choose another `search`, or leave `contact` out",
            ))
        }
        (_, Search::EveryStep | Search::Skin { .. } | Search::Adaptive(_) | Search::Initial, _) => None,
    }
}

fn region(raw: &RawRegion, bodies: &Names, dimensions: Dimensions, problems: &mut Problems) -> Option<Region> {
    let body = raw.body.as_ref().map(|b| bodies.find(b, problems));
    let at = raw.name.span();
    let shape = raw.shape.as_ref().map(|s| shape::shape(s, dimensions, at.clone(), problems));
    if body.is_none() && shape.is_none() {
        let fault =
            Fault::new("empty-region", "a region needs a `body`, a `shape` or both", at, "selects no particles");
        problems.push(fault.if_its_entry_is_whole());
        return None;
    }
    let name = raw.name.text(problems)?.to_owned();
    Some(Region {
        name,
        body: body.map_or(Some(None), |b| b.map(Some))?,
        shape: shape.map_or(Some(None), |s| s.map(Some))?,
    })
}
