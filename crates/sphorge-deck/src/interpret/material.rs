//! Materials: a deck's own, changed ones, and those of the catalogue.

use crate::declare::Named;
use crate::fault::{Fault, Problems};
use crate::material::{Constants, Incomplete, Missing, advice, build, constants, entries, entry, is_of_moduli, places};
use crate::printable::is_printable;
use crate::raw::RawMaterial;
use crate::suggest::{did_you_mean, like, listed};
use crate::value::Word;
use sphorge_engine::model::Material;
use sphorge_physics::damage::DAMAGE_LAWS;
use sphorge_physics::flow::FlowLaw;
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    ops::Range,
};

/// Most materials a chain of `base` leads through.
const LONGEST_CHAIN: usize = 20;

/// A material of the deck.
struct Own {
    constants: Constants,
    base: Option<String>,
    base_at: Range<usize>,
    at: Range<usize>,
    /// Where its constants stand.
    places: BTreeMap<String, Range<usize>>,
    /// Whether some of its constants could not be read: what it then lacks is told already.
    is_spoiled: bool,
}

/// Longest name of a material, characters: it stands in every frame.
const LONGEST_NAME: usize = 64;

/// All materials a deck can name.
pub(crate) struct Library {
    own: BTreeMap<String, Own>,
}

impl Library {
    /// Reads the deck's materials, used or not.
    pub(crate) fn new(raw: &Named<RawMaterial>, problems: &mut Problems) -> Self {
        let mut own = BTreeMap::new();
        for (name, material) in &raw.0 {
            let length = name.get_ref().chars().count();
            if length == 0 || length > LONGEST_NAME || !is_printable(name.get_ref()) {
                let message = format!("`{}` cannot name a material", name.get_ref());
                let fault = Fault::new("bad-name", message, name.span(), "this name");
                problems
                    .push(fault.help("use a name of at most 64 characters on one line, without control characters"));
            }
            let base = material.base.as_ref().and_then(|b| b.text(problems)).map(str::to_owned);
            let base_at = material.base.as_ref().map_or(name.span(), |b| b.span());
            let before = problems.count();
            let constants = constants(material, problems);
            let is_spoiled = problems.count() > before;
            own.insert(
                name.get_ref().clone(),
                Own { constants, base, base_at, at: name.span(), places: places(material), is_spoiled },
            );
        }
        let library = Self { own };
        for (name, material) in &library.own {
            if let Some(base) = &material.base
                && !library.known(base)
            {
                problems.push(library.unknown(base, material.base_at.clone()));
            } else if library.constants(name).is_none() {
                let message = format!(
                    "the `base` of material `{name}` leads back to itself, or through more than {LONGEST_CHAIN} other materials"
                );
                let fault = Fault::new("circular-base", message, material.base_at.clone(), "does not end");
                problems
                    .push(fault.help("a chain of `base` must end at a material without `base`, or in the catalogue"));
            }
        }
        library
    }

    fn known(&self, name: &str) -> bool {
        self.own.contains_key(name) || entry(name).is_some()
    }

    fn unknown(&self, name: &str, at: Range<usize>) -> Fault {
        let names = self.own.keys().map(String::as_str).chain(entries().iter().map(|(n, _)| n.as_str()));
        let near = did_you_mean(like(name, names));
        Fault::new(
            "unknown-material",
            format!("there is no material called `{name}`"),
            at,
            "neither in the deck nor in the catalogue",
        )
        .help(format!(
            "{near}`sphorge materials` lists the catalogue; [material.{}] defines your own",
            toml_edit::Key::new(name).display_repr()
        ))
        .if_all_entries_are_read()
    }

    /// Whether constants of a material or its bases could not be read.
    fn is_spoiled(&self, name: &str) -> bool {
        self.chain(name).any(|own| own.is_spoiled)
    }

    /// A material of the deck and those it is based on, as far as the deck has them.
    fn chain(&self, name: &str) -> impl Iterator<Item = &Own> {
        let base = |own: &&Own| own.base.as_ref().and_then(|base| self.own.get(base));
        std::iter::successors(self.own.get(name), base).take(LONGEST_CHAIN)
    }

    /// Where the deck gives a constant of a material: itself, or what it is based on.
    fn place(&self, name: &str, key: &str) -> Option<Range<usize>> {
        self.chain(name).find_map(|own| own.places.get(key).cloned())
    }

    /// Where the deck gives the constant that a note on a material names first.
    fn place_of_note(&self, name: &str, note: &str) -> Option<Range<usize>> {
        let keys = self.chain(name).flat_map(|own| &own.places);
        let named = |(key, at): (&String, &Range<usize>)| {
            let words = WORDS.iter().filter(|(of, _)| of == key).filter_map(|(_, words)| note.find(words));
            let constant = key.rsplit('.').next().unwrap_or(key);
            Some((words.chain(note.find(&format!("`{constant}`"))).min()?, at.clone()))
        };
        // Of a key that a material and what it is based on both have the first counts.
        keys.filter_map(named).min_by_key(|(start, _)| *start).map(|(_, at)| at)
    }

    /// The constants of a material with those of its bases; `None` for an unknown or circular one, or a chain too long.
    fn constants(&self, name: &str) -> Option<Constants> {
        let mut layers: Vec<&Constants> = Vec::new();
        let mut seen: Vec<&str> = Vec::new();
        let mut current = name;
        loop {
            // A deck's material that is based on its own name, or has the name of one of the catalogue, starts from that.
            let again = seen.contains(&current);
            match self.own.get(current).filter(|_| !again) {
                Some(_) if seen.len() == LONGEST_CHAIN => return None,
                Some(own) => {
                    seen.push(current);
                    layers.push(&own.constants);
                    match &own.base {
                        Some(base) => current = base,
                        None => {
                            layers.extend(entry(current));
                            break;
                        }
                    }
                }
                None if again && seen.last() != Some(&current) => return None,
                None => {
                    layers.push(entry(current)?);
                    break;
                }
            }
        }
        Some(layers.into_iter().rev().fold(Constants::default(), |below, above| below.overlaid(above)))
    }
}

/// Words of notes for constants of a material, beside their keys.
const WORDS: [(&str, &str); 13] = [
    ("density", "density"),
    ("young-modulus", "Young's modulus"),
    ("shear-modulus", "shear modulus"),
    ("poisson-ratio", "Poisson's ratio"),
    ("specific-heat", "specific heat"),
    ("conductivity", "conductivity"),
    ("reference-temperature", "reference temperature"),
    ("equation-of-state", "pressure law"),
    ("equation-of-state.sound-speed", "speed of sound"),
    ("young-modulus", "speed of sound"),
    ("shear-modulus", "speed of sound"),
    ("bulk-modulus", "speed of sound"),
    ("strength", "yields at"),
];

/// A material that a body uses.
struct Used {
    name: String,
    /// `None` if it could not be built.
    material: Option<Material>,
    /// Where a body names it first.
    at: Range<usize>,
    /// Whether some of its constants could not be read: what it then lacks is told already.
    is_spoiled: bool,
    states_conductivity: bool,
    /// Whether its density or a modulus has been told to be wrong.
    has_odd_moduli: bool,
}

/// The materials the bodies use, in order of first use.
pub(crate) struct Chosen<'a> {
    library: &'a Library,
    chosen: Vec<Used>,
    /// Place of each among them.
    indices: HashMap<String, usize>,
    /// What the user should know of them.
    notes: Vec<String>,
    /// The same of those of the catalogue as they are.
    catalogue_notes: Vec<String>,
    /// Whether a body names no material that there is: one that no body uses may be the one it means.
    lacks_some: bool,
}

impl<'a> Chosen<'a> {
    pub(crate) fn new(library: &'a Library) -> Self {
        let (notes, catalogue_notes) = (Vec::new(), Vec::new());
        Self { library, chosen: Vec::new(), indices: HashMap::new(), notes, catalogue_notes, lacks_some: false }
    }

    /// The index of the material a body names.
    pub(crate) fn choose(&mut self, word: &Word, problems: &mut Problems) -> Option<usize> {
        let Some(name) = word.text(problems) else {
            self.lacks_some = true;
            return None;
        };
        if let Some(&index) = self.indices.get(name) {
            return Some(index);
        }
        if !self.library.known(name) {
            problems.push(self.library.unknown(name, word.span()));
            self.lacks_some = true;
            return None;
        }
        // A circular base has been reported.
        let constants = self.library.constants(name)?;
        let own = self.library.own.get(name);
        let is_spoiled = self.library.is_spoiled(name);
        let material = build(name, &constants).map_err(|incomplete| {
            // What a constant that cannot be read leaves out is no fault of its own.
            if !is_spoiled {
                report(name, incomplete, word, self.library, problems);
            }
        });
        let mut material = material.ok();
        let mut told: Vec<String> = material.iter().flat_map(|material| advice(&constants, material)).collect();
        let has_odd_moduli = told.iter().any(|note| is_of_moduli(note));
        // What is judged is the material, not what stands for it.
        if let (Some(factor), Some(_)) = (constants.mass_scaling, &material) {
            let scaled = build(name, &constants.clone().with_scaled_mass()).ok();
            material = scaled.map(|scaled| Material { mass_scaling: factor, ..scaled });
            told.extend(scaled_mass(name, factor));
        }
        match own {
            Some(own) => {
                let place = |note: &str| self.library.place_of_note(name, note).unwrap_or_else(|| own.at.clone());
                self.notes.extend(told.into_iter().map(|note| problems.at_line(&place(&note), note)));
            }
            None => self.catalogue_notes.extend(told),
        }
        self.indices.insert(name.to_owned(), self.chosen.len());
        let states_conductivity = constants.conductivity.is_some();
        let at = word.span();
        let used = Used { name: name.to_owned(), material, at, is_spoiled, states_conductivity, has_odd_moduli };
        self.chosen.push(used);
        Some(self.chosen.len() - 1)
    }

    /// Tells of materials of the deck that no body uses. One that is none, under a name that nothing else has, is a slip: what was to be
    /// changed is another material.
    pub(crate) fn tell_unused(&mut self, problems: &mut Problems) {
        if self.lacks_some || self.chosen.is_empty() {
            return;
        }
        let used = || self.chosen.iter().map(|used| used.name.as_str());
        // Those that others are based on count with them.
        let mut reached: BTreeSet<&str> = used().collect();
        for Used { name, .. } in &self.chosen {
            let mut next = self.library.own.get(name);
            while let Some(base) = next.and_then(|own| own.base.as_deref()) {
                next = if reached.insert(base) { self.library.own.get(base) } else { None };
            }
        }
        let unused = self.library.own.iter().filter(|(name, _)| !reached.contains(name.as_str()));
        for (name, own) in unused {
            let (Some(constants), false) = (self.library.constants(name), self.library.is_spoiled(name)) else {
                continue;
            };
            let near = like(name, used());
            // Something whole may be meant for a body: what is like its name is told only where a body uses that.
            match build(name, &constants) {
                Ok(_) | Err(Incomplete::Inconsistent(_)) => self.notes.push(format!(
                    "no body uses material `{name}` of the deck, so its constants have no effect; {}bodies use {}",
                    did_you_mean(near),
                    listed(used(), "and")
                )),
                Err(Incomplete::Missing(missing)) => {
                    let lacks = match &missing[..] {
                        [first, second, more @ ..] if more.len() > 1 => {
                            format!("`{}`, `{}` and {} more constants", first.key, second.key, more.len())
                        }
                        few => listed(few.iter().map(|constant| constant.key), "and"),
                    };
                    let message =
                        format!("there is no material called `{name}`, and what the deck gives of it makes none");
                    let fault = Fault::new(
                        "unknown-name",
                        message,
                        own.at.clone(),
                        format!("used by no body, without {lacks}"),
                    );
                    let near =
                        if near.is_empty() { like(name, entries().iter().map(|(n, _)| n.as_str())) } else { near };
                    let help = format!("{}Bodies use {}.", did_you_mean(near), listed(used(), "and"));
                    problems.push(fault.help(help).if_all_entries_are_read());
                }
            }
        }
    }

    /// Whether a material resists shear.
    pub(crate) fn has_strength(&self, index: usize) -> bool {
        self.chosen[index].material.as_ref().is_some_and(|m| m.shear_modulus > 0.0)
    }

    /// Speed at which a bar of a material that strikes a rigid wall begins to yield at a temperature (K), m/s: without bound where it never does. `None` for
    /// what has no strength or may break.
    pub(crate) fn yield_speed(&self, index: usize, temperature: f64) -> Option<f64> {
        let material = self.chosen[index].material.as_ref().filter(|m| m.shear_modulus > 0.0 && !m.breaks())?;
        let impedance = (material.density * material.young_modulus()).sqrt();
        Some(material.yield_stress_at_rest(0.0, temperature) / impedance)
    }

    /// Temperature bodies of this material start at, if the material could be built.
    pub(crate) fn reference_temperature(&self, index: usize) -> Option<f64> {
        self.chosen[index].material.as_ref().map(|m| m.reference_temperature)
    }

    /// Reports materials without a specific heat, which `what` needs.
    pub(crate) fn need_specific_heat(&self, what: &str, problems: &mut Problems) {
        for Used { name, material, at, is_spoiled, .. } in &self.chosen {
            // One that cannot be read has been told.
            if !is_spoiled && material.as_ref().is_some_and(|m| !m.heats()) {
                let message = format!("material `{name}` has no `specific-heat`, and {what} needs it");
                let fault = Fault::new("missing-constant", message, at.clone(), "used here");
                let help = format!("add `specific-heat = \"452 J/(kg K)\"` with the right value to [material.{name}]");
                problems.push(fault.help(help).if_all_entries_are_read());
            }
        }
    }

    /// Reports what conduction lacks. Bodies that do not move need one that conducts: it sets the time step.
    pub(crate) fn need_conduction(&self, mechanics: bool, at: Range<usize>, problems: &mut Problems) {
        self.need_specific_heat("conduction", problems);
        let conducts_not =
            |used: &Used| !used.is_spoiled && used.material.as_ref().is_some_and(|m| m.conductivity == 0.0);
        if !mechanics && !self.chosen.is_empty() && self.chosen.iter().all(conducts_not) {
            let fault = Fault::new("missing-constant", "no material conducts, so no heat flows", at, "asked for here");
            problems.push(
                fault
                    .help("add `conductivity = \"80 W/(m K)\"` with the right value to a material")
                    .if_all_entries_are_read(),
            );
        }
    }

    /// Those whose conductivity is zero because nothing states it.
    pub(crate) fn without_conductivity(&self) -> Vec<String> {
        let without = self.chosen.iter().filter(|used| !used.states_conductivity);
        without.map(|used| used.name.clone()).collect()
    }

    /// Those whose density or modulus has been told to be wrong.
    pub(crate) fn with_odd_moduli(&self) -> Vec<String> {
        self.chosen.iter().filter(|used| used.has_odd_moduli).map(|used| used.name.clone()).collect()
    }

    /// Reports materials with a law of the deformation gradient, which the updated Lagrangian form does not have.
    pub(crate) fn refuse_hyperelastic(&self, problems: &mut Problems) {
        for Used { name, material, at, .. } in &self.chosen {
            if let Some(law) = material.as_ref().map(|m| m.flow_law).filter(FlowLaw::is_hyperelastic) {
                let message = format!(
                    "`strength = \"{}\"` of material `{name}` needs the deformation gradient, which only the total Lagrangian form has",
                    law.key()
                );
                let fault = Fault::new("not-together", message, at.clone(), "used here");
                let help = "choose `method = \"total-lagrangian\"`, or `strength = \"elastic\"`";
                problems.push(fault.help(help).if_all_entries_are_read());
            }
        }
    }

    /// What the user should know of the materials of the deck.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What the user should know of materials of the catalogue that the deck has not changed.
    pub(crate) fn catalogue_notes(&self) -> &[String] {
        &self.catalogue_notes
    }

    /// All of them; those with faults are left out.
    pub(crate) fn into_materials(self) -> Vec<Material> {
        self.chosen.into_iter().filter_map(|used| used.material).collect()
    }
}

/// Share of mass that is added without a word.
const UNTOLD_MASS: f64 = 0.05;

/// What mass scaling does to a material.
fn scaled_mass(name: &str, factor: f64) -> Option<String> {
    (factor > 1.0 + UNTOLD_MASS).then(|| {
        format!(
            "material `{name}`: `mass-scaling` adds {:.0} % to its mass, and to weights and kinetic energies: it is for loads so slow that the kinetic energy \
             stays a few per cent of the internal energy; time steps are {:.3} times as long",
            100.0 * (factor - 1.0),
            factor.sqrt()
        )
    })
}

/// Which materials of the catalogue have constants of a law of damage, to be taken by its word alone.
fn with_constants_of(key: &str, law: &str) -> String {
    let has = |constants: &Constants| constants.damage.as_ref().is_some_and(|of| DAMAGE_LAWS[of.law].key == law);
    let names: Vec<&str> =
        entries().iter().filter(|(_, constants)| has(constants)).map(|(name, _)| name.as_str()).collect();
    if key == "damage" && !names.is_empty() {
        format!(
            "; in the catalogue {} {} constants of `{law}`",
            listed(names.iter().copied(), "and"),
            if names.len() == 1 { "has" } else { "have" }
        )
    } else {
        String::new()
    }
}

fn report(name: &str, incomplete: Incomplete, word: &Word, library: &Library, problems: &mut Problems) {
    let own = library.own.get(name);
    // What the user wrote of it comes first, else where the material begins.
    let place = |code, message: String, keys: &[&str], label: &str| {
        let mut written = keys.iter().filter_map(|key| library.place(name, key));
        match (written.next(), own) {
            (Some(first), _) => {
                let fault = Fault::new(code, message, first, label);
                written.fold(fault, |fault, at| fault.also(at, "and this")).also(word.span(), "used here")
            }
            (None, Some(own)) => {
                Fault::new(code, message, own.at.clone(), "this material").also(word.span(), "used here")
            }
            (None, None) => Fault::new(code, message, word.span(), "a material of the catalogue, to be completed"),
        }
    };
    match incomplete {
        Incomplete::Inconsistent(of) => {
            let keys: Vec<&str> = of.keys.iter().map(String::as_str).collect();
            let fault = place("inconsistent", format!("material `{name}`: {}", of.message), &keys, "this");
            problems.push(fault.help(of.help));
        }
        Incomplete::Missing(missing) => {
            let base = if own.is_none() { "; such a table starts from the catalogue's constants" } else { "" };
            // Those of one law are one fault.
            for of_law in missing.chunk_by(|a, b| a.law.is_some() && (a.law, &a.table) == (b.law, &b.table)) {
                let Missing { law, table, beside, .. } = &of_law[0];
                let law = law.map(|law| format!(", which `{law}` needs")).unwrap_or_default();
                let keys = listed(of_law.iter().map(|constant| constant.key), "and");
                let message = format!("material `{name}` has no {keys}{law}");
                let fault = place(
                    "missing-constant",
                    message,
                    &[*beside],
                    if of_law.len() > 1 { "this needs them" } else { "this needs it" },
                );
                let wanted: Vec<String> =
                    of_law.iter().map(|constant| format!("`{}`, {}", constant.key, constant.meaning)).collect();
                let wanted = wanted.join("; ");
                let written = library.place(name, beside).and_then(|at| problems.text().get(at));
                let is_word = written.is_some_and(|written| written.starts_with(['"', '\'']));
                let help = match table.split_once('.') {
                    // A word cannot be added to, by no header either.
                    Some((key, law)) if is_word => {
                        let constants: Vec<String> =
                            of_law.iter().map(|constant| format!("{} = ...", constant.key)).collect();
                        format!(
                            "write `{key} = {{ {law} = {{ {} }} }}` in place of this line, with {wanted}{}",
                            constants.join(", "),
                            with_constants_of(key, law)
                        )
                    }
                    _ => {
                        let table = if table.is_empty() { name.to_owned() } else { format!("{name}.{table}") };
                        format!("add {wanted}, to [material.{table}]{base}")
                    }
                };
                problems.push(fault.help(help).if_its_entry_is_whole());
            }
        }
    }
}
