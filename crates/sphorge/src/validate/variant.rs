//! A run of a case: its deck with some of its values changed.

/// A run of the deck with some of its values changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Name of the run, unique within the case.
    pub label: String,
    /// Part of a series of refinements, coarse to fine.
    pub series: Option<&'static str>,
    /// Changes to the deck: path and value, as `--set` takes them.
    pub overrides: Vec<(String, String)>,
    /// A failure of the run is a result like any other, and does not fail the case.
    pub may_fail: bool,
}

impl Variant {
    /// The deck as it is.
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), series: None, overrides: Vec::new(), may_fail: false }
    }

    /// A member of a series of refinements.
    pub fn of_series(label: impl Into<String>, series: &'static str) -> Self {
        Self { series: Some(series), ..Self::new(label) }
    }

    /// Changes a value of the deck.
    pub fn set(mut self, path: &str, value: &str) -> Self {
        self.overrides.push((path.to_owned(), value.to_owned()));
        self
    }

    /// Lets the run fail.
    pub fn may_fail(self) -> Self {
        Self { may_fail: true, ..self }
    }

    /// Changes the spacing.
    pub fn spacing(self, spacing: &str) -> Self {
        self.set("particles.spacing", spacing)
    }
}

/// Members of a series, one for each spacing, coarse to fine; labels begin with `prefix`.
pub(super) fn refinements(series: &'static str, prefix: &str, spacings: &[&str]) -> Vec<Variant> {
    let label = |spacing: &str| format!("{prefix}{spacing}");
    spacings.iter().map(|spacing| Variant::of_series(label(spacing), series).spacing(spacing)).collect()
}
