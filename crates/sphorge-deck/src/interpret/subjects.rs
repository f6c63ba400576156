//! What notes are about, with its place in the deck: a note names it first, as in "body `bar`: ...".

use crate::fault::Problems;
use crate::raw::{RawBody, RawDeck};
use crate::value::{Given, ScalarOr};
use std::ops::Range;

/// Words with which notes name things of a deck, and where these stand.
#[derive(Debug, Default)]
pub(crate) struct Subjects {
    places: Vec<(String, Range<usize>)>,
}

impl Subjects {
    /// Those of a deck.
    pub(super) fn new(raw: &RawDeck) -> Self {
        let mut places = Vec::new();
        let mut add = |words: String, at: Range<usize>| places.push((words, at));
        for body in &raw.body {
            let Some(name) = body.name.peek() else { continue };
            add(format!("body `{name}`"), body.name.span());
            add(format!("bodies `{name}`"), body.name.span());
            for (words, at) in of_body(body) {
                add(format!("body `{name}` {words}"), at);
            }
        }
        for (name, material) in &raw.material.0 {
            add(format!("material `{}`", name.get_ref()), name.span());
            if let Some(strength) = &material.strength {
                add(format!("material `{}` yields", name.get_ref()), strength.span());
            }
            if let Some(after_failure) = &material.after_failure {
                add(format!("material `{}` is deleted", name.get_ref()), after_failure.span());
            }
            if let Some(conductivity) = &material.conductivity {
                add(format!("material `{}` has a `conductivity`", name.get_ref()), conductivity.span());
            }
        }
        let regions = raw.region.iter().map(|of| ("region", &of.name));
        let walls = raw.wall.iter().map(|of| ("wall", &of.name));
        let measures = raw.measure.iter().map(|of| ("measure", &of.name));
        let sections = raw.section.iter().map(|of| ("section", &of.name));
        let boundaries = raw.thermal.iter().flat_map(|thermal| &thermal.boundary);
        let boundaries = boundaries.map(|of| ("heat boundary", &of.name));
        for (what, name) in regions.chain(walls).chain(measures).chain(sections).chain(boundaries) {
            if let Some(text) = name.peek() {
                add(format!("{what} `{text}`"), name.span());
            }
        }
        for plane in &raw.symmetry {
            if let Some(axis @ ("x" | "y" | "z")) = plane.axis.peek() {
                add(format!("the symmetry plane across {axis}"), plane.axis.span());
            }
        }
        let end = raw.time.as_ref().and_then(|time| time.end.as_ref());
        let gravity = raw.gravity.as_ref().map(|gravity| gravity.span.clone());
        let viscosity = raw.numerics.viscosity.as_ref().map(|viscosity| match viscosity {
            ScalarOr::Scalar(flag) => flag.span(),
            ScalarOr::Composed(_, at) => at.clone(),
        });
        let of_viscosity = |key: fn(&crate::raw::RawViscosity) -> Option<Range<usize>>| match &raw.numerics.viscosity {
            Some(ScalarOr::Composed(table, _)) => key(table),
            _ => None,
        };
        let keys = [
            ("the run takes some", end.map(Given::span)),
            ("gravity", gravity),
            ("between bodies", raw.contact.as_ref().map(|contact| contact.span())),
            ("`numerics.viscosity.alpha`", of_viscosity(|table| table.alpha.as_ref().map(Given::span))),
            ("`numerics.viscosity.beta`", of_viscosity(|table| table.beta.as_ref().map(Given::span))),
            ("`numerics.viscosity.all-waves`", of_viscosity(|table| table.all_waves.as_ref().map(|flag| flag.span()))),
            ("`numerics.viscosity`", viscosity),
        ];
        for (words, at) in keys {
            if let Some(at) = at {
                add(words.to_owned(), at);
            }
        }
        Self { places }
    }

    /// A note with the line of what it names first; as it is if it has one, or names nothing of the deck.
    pub(crate) fn with_line(&self, note: String, problems: &Problems) -> String {
        let named = |(words, at): &'_ (String, Range<usize>)| Some((note.find(words)?, words.len(), at.clone()));
        let found = self.places.iter().filter_map(named).min_by_key(|(start, length, _)| (*start, usize::MAX - length));
        match found {
            Some((.., at)) if !note.starts_with("line ") => problems.at_line(&at, note),
            _ => note,
        }
    }
}

/// What notes say of the state a body starts in, and the key that it is given by.
fn of_body(body: &RawBody) -> impl Iterator<Item = (&'static str, Range<usize>)> {
    let velocity = body.velocity.as_ref().map(|velocity| velocity.span.clone());
    let temperature = body.temperature.as_ref().map(Given::span);
    let moves = ["moves at", "flies away", "starts with"].map(|words| velocity.clone().map(|at| (words, at)));
    let spacing = body.spacing.as_ref().map(Given::span).map(|at| ("is too coarse", at));
    moves.into_iter().chain([temperature.map(|at| ("starts at", at)), spacing]).flatten()
}
