//! What a deck expects at each place, as data. The declarations in `raw` yield it; form checks, `--set`, the schema and
//! through it the reference page are walks over it.

use super::quantity::QuantityKind;
use std::borrow::Cow;

/// What is expected at a place.
#[derive(Clone, Copy)]
pub(crate) enum Expected {
    /// Free text or a name.
    Text,
    /// True or false.
    Flag,
    /// A whole number, zero or above.
    Count,
    /// A quantity of a kind that follows from something else.
    Level,
    /// This word.
    Word(&'static str),
    /// One of several words.
    Words(Words),
    /// A quantity; the name of its kind in the schema.
    Quantity(&'static str, QuantityKind),
    /// A quantity that is a constant of a law.
    Constant(QuantityKind),
    /// A vector of one to three quantities.
    Vector(&'static Expected),
    /// A list of any length.
    List(&'static Expected),
    /// A pair in a list of its own.
    Pair(&'static Expected, &'static Expected),
    /// A table with known keys.
    Table(fn() -> &'static TableKeys),
    /// A table of one of several laws.
    Laws(fn() -> &'static TableKeys),
    /// A table of the constants of a law.
    Law(&'static TableKeys),
    /// A table with keys of the user's choice.
    Named(&'static Expected),
    /// The one or the other.
    Either(&'static Expected, &'static Expected),
}

/// A closed set of words.
#[derive(Clone, Copy)]
pub(crate) struct Words {
    /// Name in the schema.
    pub(crate) name: &'static str,
    /// What is chosen, for people.
    pub(crate) what: &'static str,
    /// Every word and its meaning.
    pub(crate) words: fn() -> Vec<(&'static str, &'static str)>,
}

/// A table with known keys.
pub(crate) struct TableKeys {
    /// Name in the schema.
    pub(crate) name: &'static str,
    /// Comment of the declaration, as it stands there.
    pub(crate) comment: Cow<'static, str>,
    /// The keys in the order of declaration.
    pub(crate) keys: Cow<'static, [Key]>,
}

/// A key of a table.
#[derive(Clone)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    /// Comment of the declaration, as it stands there.
    pub(crate) comment: Cow<'static, str>,
    pub(crate) expected: Expected,
    /// Whether the table is wrong without it.
    pub(crate) required: bool,
    /// A value one may write, as JSON.
    pub(crate) example: Option<&'static str>,
    /// What it is when left out, as JSON.
    pub(crate) default: Option<Cow<'static, str>>,
    /// What it is when left out, for people, where that is not a value.
    pub(crate) otherwise: Option<&'static str>,
}

/// Lines of a comment without the blanks they begin with.
pub(crate) fn lines(comment: &str) -> String {
    comment.lines().map(str::trim).collect::<Vec<_>>().join("\n").trim().to_owned()
}

impl Key {
    /// The value one may write.
    pub(crate) fn example(&self) -> Option<serde_json::Value> {
        serde_json::from_str(self.example?).ok()
    }

    /// What it is when left out, if that is a value.
    pub(crate) fn default(&self) -> Option<serde_json::Value> {
        serde_json::from_str(self.default.as_deref()?).ok()
    }
}

/// Form of a value in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// A single value.
    Scalar,
    /// A list.
    List,
    /// A table.
    Table,
}

impl Expected {
    /// The table that can stand here.
    pub(crate) fn table(&self) -> Option<&'static TableKeys> {
        match self {
            Self::Table(table) | Self::Laws(table) => Some(table()),
            Self::Law(table) => Some(table),
            Self::Either(one, other) => one.table().or_else(|| other.table()),
            _ => None,
        }
    }

    /// The keys of that table.
    pub(crate) fn keys(&self) -> &'static [Key] {
        self.table().map_or(&[], |table| &table.keys)
    }

    /// What is expected at a key of it, and the key if it has a declaration of its own.
    pub(crate) fn key(&self, name: &str) -> Option<(&'static Expected, Option<&'static Key>)> {
        if let Self::Named(any) = self {
            return Some((any, None));
        }
        self.keys().iter().find(|key| key.name == name).map(|key| (&key.expected, Some(key)))
    }

    /// What is expected at the `index`th entry of a list.
    pub(crate) fn item(&self, index: usize) -> Option<&'static Expected> {
        match self {
            Self::List(entry) | Self::Vector(entry) => Some(entry),
            Self::Pair(first, second) => [*first, *second].get(index).copied(),
            Self::Either(one, other) => one.item(index).or_else(|| other.item(index)),
            _ => None,
        }
    }

    /// Fewest and most entries of a list.
    pub(crate) fn length(&self) -> (usize, usize) {
        match self {
            Self::Pair(..) => (2, 2),
            Self::Vector(..) => (1, 3),
            Self::Either(one, other) if one.allows(Form::List) => one.length(),
            Self::Either(_, other) => other.length(),
            _ => (0, usize::MAX),
        }
    }

    /// Whether a value of this form can stand here.
    pub(crate) fn allows(&self, form: Form) -> bool {
        match self {
            Self::Either(one, other) => one.allows(form) || other.allows(form),
            Self::List(_) | Self::Pair(..) | Self::Vector(..) => form == Form::List,
            Self::Table(_) | Self::Laws(_) | Self::Law(_) | Self::Named(_) => form == Form::Table,
            _ => form == Form::Scalar,
        }
    }
}
