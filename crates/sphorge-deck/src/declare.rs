//! The declaration of the tables of a deck: from one list of keys follow the struct that holds what is written, the way it
//! is read, and what the rest of the program knows of the keys ([`TableKeys`]).

use super::expected::{Expected, Key, TableKeys};
use super::written::{Content, Spanned, Written, key_span};
use std::slice::Iter;
use toml_edit::TableLike;

/// What can be written at a place.
pub(crate) trait Read: Sized {
    const EXPECTED: &'static Expected;
    /// Whether a key with such a value must be there.
    const REQUIRED: bool = true;

    /// Whether a list goes on without an entry that cannot be read: a table of its own, and no component of something.
    const STANDS_ALONE: bool = false;

    /// What is written. `None` if it is not of the form expected, which is checked, and told, before.
    fn read(written: Written<'_>) -> Option<Self>;

    /// What it is when nothing is written.
    fn absent() -> Option<Self> {
        None
    }
}

impl<T: Read> Read for Option<T> {
    const EXPECTED: &'static Expected = T::EXPECTED;
    const REQUIRED: bool = false;
    /// What is not of the form expected has been told, and is left out, so that other faults are told with it.
    fn read(written: Written<'_>) -> Option<Self> {
        Some(T::read(written))
    }
    fn absent() -> Option<Self> {
        Some(None)
    }
}

impl<T: Read> Read for Vec<T> {
    const EXPECTED: &'static Expected = &Expected::List(T::EXPECTED);
    fn read(written: Written<'_>) -> Option<Self> {
        let Content::List(entries) = written.content() else { return None };
        let mut values = Self::with_capacity(entries.len());
        for entry in entries {
            match T::read(entry) {
                Some(value) => values.push(value),
                None if T::STANDS_ALONE => {}
                None => return None,
            }
        }
        Some(values)
    }
}

impl<A: Read, B: Read> Read for (A, B) {
    const EXPECTED: &'static Expected = &Expected::Pair(A::EXPECTED, B::EXPECTED);
    fn read(written: Written<'_>) -> Option<Self> {
        let Content::List(entries) = written.content() else { return None };
        let [first, second] = entries.as_slice() else { return None };
        Some((A::read(*first)?, B::read(*second)?))
    }
}

impl<T: Read> Read for Spanned<T> {
    const EXPECTED: &'static Expected = T::EXPECTED;
    fn read(written: Written<'_>) -> Option<Self> {
        Some(Self::new(T::read(written)?, written.span()))
    }
}

/// A table with keys of the user's choice, by name.
pub(crate) struct Named<T>(pub(crate) Vec<(Spanned<String>, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Read> Read for Named<T> {
    const EXPECTED: &'static Expected = &Expected::Named(T::EXPECTED);
    fn read(written: Written<'_>) -> Option<Self> {
        let Content::Table(table) = written.content() else { return None };
        let mut names: Vec<&str> = table.iter().map(|(name, _)| name).collect();
        names.sort_unstable();
        let mut entries = Vec::with_capacity(names.len());
        for name in names {
            if let Some(entry) = T::read(Written::Item(table.get(name)?)) {
                entries.push((Spanned::new(name.to_owned(), key_span(table, name)), entry));
            }
        }
        Some(Self(entries))
    }
}

/// Reads the values of a table, key by key in the order of declaration.
pub(crate) struct TableReader<'a> {
    table: &'a dyn TableLike,
    keys: Iter<'static, Key>,
}

impl<'a> TableReader<'a> {
    pub(crate) fn new(written: Written<'a>, declared: &'static TableKeys) -> Option<Self> {
        let Content::Table(table) = written.content() else { return None };
        Some(Self { table, keys: declared.keys.iter() })
    }

    fn next(&mut self) -> Option<Written<'a>> {
        self.table.get(self.keys.next()?.name).map(Written::Item)
    }

    /// The value of the next key.
    pub(crate) fn value<T: Read>(&mut self) -> Option<T> {
        self.next().map_or_else(T::absent, T::read)
    }

    /// The value of the next key, empty if it is not written.
    pub(crate) fn value_or_empty<T: Read + Default>(&mut self) -> Option<T> {
        Some(self.next().and_then(T::read).unwrap_or_default())
    }
}

/// The name of a field as a key: with `-` for `_`.
pub(crate) const fn kebab<const N: usize>(field: &str) -> [u8; N] {
    let mut key = [b'-'; N];
    let mut k = 0;
    while k < N {
        if field.as_bytes()[k] != b'_' {
            key[k] = field.as_bytes()[k];
        }
        k += 1;
    }
    key
}

/// Declares tables of a deck. Of a key are given its meaning as a comment, its name as that of the field (or in quotes
/// after `as`), its type, and where they apply
///
/// - `or empty`: what is not written is the default of the type,
/// - `or fault`: a deck is wrong without it, and is read on for its other faults,
/// - `example`: a value one may write, as JSON,
/// - `default`: what it is when not written, as JSON,
/// - `otherwise`: what it is when not written, in words.
macro_rules! tables {
    ($(
        $(#[doc = $comment:literal])*
        $(#[derive($($derived:ident),+)])?
        $table:ident {$(
            $(#[doc = $meaning:literal])*
            $field:ident $(as $name:literal)? : $type:ty
                $(, or $otherwise_is:ident)? $(, example $example:tt)? $(, default $default:tt)? $(, otherwise $otherwise:literal)?;
        )*}
    )+) => {$(
        $(#[doc = $comment])*
        $(#[derive($($derived),+)])?
        pub(crate) struct $table {
            $( $(#[doc = $meaning])* pub(crate) $field: $type, )*
        }

        impl $crate::declare::Read for $table {
            const EXPECTED: &'static $crate::expected::Expected = &$crate::expected::Expected::Table(Self::declared);
            const STANDS_ALONE: bool = true;

            fn read(written: $crate::written::Written<'_>) -> Option<Self> {
                let mut reader = $crate::declare::TableReader::new(written, Self::declared())?;
                // The fields are evaluated as they stand here, which is the order of the keys.
                Some(Self { $( $field: $crate::declare::read_next!(reader $(, $otherwise_is)?)?, )* })
            }
        }

        impl $table {
            fn declared() -> &'static $crate::expected::TableKeys {
                static KEYS: &[$crate::expected::Key] = &[$(
                    $crate::expected::Key {
                        name: $crate::declare::key_name!($field $($name)?),
                        comment: std::borrow::Cow::Borrowed(concat!($($meaning, "\n"),*)),
                        expected: *<$type as $crate::declare::Read>::EXPECTED,
                        required: $crate::declare::required!($type $(, $otherwise_is)?),
                        example: $crate::declare::given!($(stringify!($example))?),
                        default: $crate::declare::given!($(std::borrow::Cow::Borrowed(stringify!($default)))?),
                        otherwise: $crate::declare::given!($($otherwise)?),
                    },
                )*];
                static TABLE: $crate::expected::TableKeys = $crate::expected::TableKeys {
                    name: stringify!($table),
                    comment: std::borrow::Cow::Borrowed(concat!($($comment, "\n"),*)),
                    keys: std::borrow::Cow::Borrowed(KEYS),
                };
                &TABLE
            }
        }
    )+};
}

macro_rules! key_name {
    ($field:ident $name:literal) => {
        $name
    };
    ($field:ident) => {{
        const FIELD: &str = stringify!($field);
        const KEY: [u8; FIELD.len()] = $crate::declare::kebab(FIELD);
        match std::str::from_utf8(&KEY) {
            Ok(key) => key,
            Err(_) => FIELD,
        }
    }};
}

macro_rules! required {
    ($type:ty) => {
        <$type as $crate::declare::Read>::REQUIRED
    };
    ($type:ty, empty) => {
        false
    };
    ($type:ty, fault) => {
        true
    };
}

macro_rules! given {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

macro_rules! read_next {
    ($reader:ident) => {
        $reader.value()
    };
    ($reader:ident, empty) => {
        $reader.value_or_empty()
    };
    ($reader:ident, fault) => {
        $reader.value()
    };
}

pub(crate) use {given, key_name, read_next, required, tables};
