//! Values as the user wrote them, with their place in the text. Reading never fails on a wrong number, unit or word:
//! that is found when the deck is interpreted, so that several such faults are reported together.

use super::declare::Read;
use super::expected::{Expected, Words};
use super::fault::{Fault, Problems};
use super::quantity::QuantityKind;
use super::scalar::Scalar;
use super::suggest::{listed, nearest};
use super::written::{Content, Literal, Written};
use sphorge_physics::parameter::Bound;
use std::{marker::PhantomData, ops::Range};

/// Names a kind of quantity in the type of a key.
pub(crate) trait Kind {
    const NAME: &'static str;
    const KIND: QuantityKind;
}

macro_rules! kind_types {
    ($($name:ident => $kind:ident,)+) => { $(
        pub(crate) enum $name {}
        impl Kind for $name {
            const NAME: &'static str = stringify!($name);
            const KIND: QuantityKind = QuantityKind::$kind;
        }
    )+ };
}
kind_types! {
    Number => NUMBER, Length => LENGTH, Time => TIME, Velocity => VELOCITY, Acceleration => ACCELERATION, Angle => ANGLE,
AngularVelocity => ANGULAR_VELOCITY, Rate => RATE, Density => DENSITY, Stress => PRESSURE, Temperature => TEMPERATURE,
    SpecificHeat => SPECIFIC_HEAT, Conductivity => CONDUCTIVITY, HeatFlux => HEAT_FLUX, HeatTransfer => HEAT_TRANSFER,
    FractureEnergy => FRACTURE_ENERGY,
}

/// A scalar of which the type says what is expected.
macro_rules! scalars {
    ($( $(#[doc = $comment:literal])* $name:ident $(<$of:ident : $bound:ident>)? => $expected:expr; )+) => { $(
        $(#[doc = $comment])*
        pub(crate) struct $name $(<$of>)? (Scalar, PhantomData<($($of,)?)>);

        impl $(<$of>)? $name $(<$of>)? {
            pub(crate) fn span(&self) -> Range<usize> {
                self.0.span.clone()
            }
        }

        impl $(<$of: $bound>)? Read for $name $(<$of>)? {
            const EXPECTED: &'static Expected = &$expected;
            fn read(written: Written<'_>) -> Option<Self> {
                Some(Self(Scalar::read(written)?, PhantomData))
            }
        }
    )+ };
}

scalars! {
    /// A quantity of kind `K`.
    Given<K: Kind> => Expected::Quantity(K::NAME, K::KIND);
    /// A word out of the table `C`.
    Choice<C: Choices> => Expected::Words(Words { name: C::NAME, what: C::WHAT, words: C::words });
    /// A whole number, zero or above.
    Count => Expected::Count;
    /// Free text or a name.
    Word => Expected::Text;
    /// True or false.
    Flag => Expected::Flag;
}

/// A velocity, or the word `free`.
pub(crate) struct VelocityOrFree(pub(crate) Scalar);

impl Read for VelocityOrFree {
    const EXPECTED: &'static Expected = &Expected::Either(Given::<Velocity>::EXPECTED, &Expected::Word("free"));
    fn read(written: Written<'_>) -> Option<Self> {
        Scalar::read(written).map(Self)
    }
}

impl<K: Kind> Given<K> {
    pub(crate) fn si(&self, problems: &mut Problems) -> Option<f64> {
        self.0.quantity(K::KIND, problems)
    }

    pub(crate) fn within(&self, bound: Bound, problems: &mut Problems) -> Option<f64> {
        self.0.bounded(K::KIND, bound, problems)
    }

    /// The same, with what to do about a value that is not.
    pub(crate) fn within_saying(&self, bound: Bound, help: &str, problems: &mut Problems) -> Option<f64> {
        let value = self.si(problems)?;
        if bound.allows(value) {
            return Some(value);
        }
        problems.push(self.0.out_of(bound, K::KIND).help(help));
        None
    }

    /// A spacing of particles: without a unit, one that is large may be of millimetres.
    pub(crate) fn spacing(&self, problems: &mut Problems) -> Option<f64> {
        let spacing = self.positive(problems)?;
        self.0.doubt_metres(spacing, problems);
        Some(spacing)
    }

    pub(crate) fn positive(&self, problems: &mut Problems) -> Option<f64> {
        self.within(Bound::Positive, problems)
    }
}

/// The whole numbers up to here survive the trip through a double.
const LARGEST_COUNT: f64 = 9_007_199_254_740_992.0;

impl Count {
    pub(crate) fn whole(&self, problems: &mut Problems) -> Option<u64> {
        let number = match &self.0.literal {
            Literal::Integer(i) => u64::try_from(*i).ok(),
            Literal::Number(x) if x.fract() == 0.0 && (0.0..LARGEST_COUNT).contains(x) => Some(*x as u64),
            _ => None,
        };
        if number.is_none() {
            problems.push(self.0.fault("wrong-type", "expected a whole number, zero or above"));
        }
        number
    }

    /// At least one.
    pub(crate) fn positive(&self, problems: &mut Problems) -> Option<u64> {
        let number = self.whole(problems)?;
        if number == 0 {
            problems.push(self.0.fault("out-of-range", "expected a whole number of at least 1"));
            return None;
        }
        Some(number)
    }
}

impl Word {
    pub(crate) fn text(&self, problems: &mut Problems) -> Option<&str> {
        if let Literal::Text(text) = &self.0.literal {
            return Some(text);
        }
        problems.push(self.0.fault("wrong-type", "expected text in quotes"));
        None
    }

    /// The text if it is one, without a fault if it is not.
    pub(crate) fn peek(&self) -> Option<&str> {
        match &self.0.literal {
            Literal::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl Flag {
    pub(crate) fn get(&self, problems: &mut Problems) -> Option<bool> {
        if let Literal::Boolean(flag) = self.0.literal {
            return Some(flag);
        }
        problems.push(self.0.fault("wrong-type", "expected true or false"));
        None
    }
}

/// A closed set of words.
pub(crate) trait Choices {
    type Value: Clone;
    /// Name in the schema.
    const NAME: &'static str;
    /// What is chosen, for people.
    const WHAT: &'static str;
    /// The word that is meant by another one in use elsewhere, for a suggestion.
    fn meant(_: &str) -> Option<&'static str> {
        None
    }
    /// Word, value, meaning.
    fn table() -> Vec<(&'static str, Self::Value, &'static str)>;
    /// Word, meaning.
    fn words() -> Vec<(&'static str, &'static str)> {
        Self::table().into_iter().map(|(word, _, meaning)| (word, meaning)).collect()
    }
}

impl<C: Choices> Choice<C> {
    pub(crate) fn get(&self, problems: &mut Problems) -> Option<C::Value> {
        let mut table = C::table();
        let words: Vec<&str> = table.iter().map(|entry| entry.0).collect();
        let index = chosen(&self.0, C::WHAT, &words, C::meant, problems)?;
        Some(table.swap_remove(index).1)
    }

    /// The word, if one is written, without a fault if it is not.
    pub(crate) fn peek(&self) -> Option<&str> {
        match &self.0.literal {
            Literal::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// The index of the word that is written.
fn chosen(
    scalar: &Scalar,
    what: &str,
    words: &[&str],
    meant: fn(&str) -> Option<&'static str>,
    problems: &mut Problems,
) -> Option<usize> {
    let choose = format!("choose {}", listed(words.iter().copied(), "or"));
    let Literal::Text(text) = &scalar.literal else {
        let fault = scalar.fault("wrong-type", format!("expected a word in quotes: the {what}"));
        problems.push(fault.help(choose));
        return None;
    };
    let index = words.iter().position(|word| word == text);
    if index.is_none() {
        let near = meant(text).or_else(|| nearest(text, words.iter().copied()));
        let near = near.map(|n| format!("did you mean `{n}`? ")).unwrap_or_default();
        let fault = Fault::new("unknown-choice", format!("unknown {what} `{text}`"), scalar.span.clone(), "not known");
        problems.push(fault.help(near + &choose));
    }
    index
}

/// A vector of one to three components.
pub(crate) struct VectorOf<K> {
    pub(crate) components: Vec<Given<K>>,
    pub(crate) span: Range<usize>,
}

impl<K: Kind> Read for VectorOf<K> {
    const EXPECTED: &'static Expected = &Expected::Vector(Given::<K>::EXPECTED);
    fn read(written: Written<'_>) -> Option<Self> {
        let components: Vec<_> = Vec::read(written)?;
        (1..=3).contains(&components.len()).then(|| Self { components, span: written.span() })
    }
}

/// Either a single value or something composed, told apart by what stands in the text.
pub(crate) enum ScalarOr<S, T> {
    Scalar(S),
    Composed(T, Range<usize>),
}

impl<W, T> ScalarOr<Choice<W>, T> {
    /// Where it stands.
    pub(crate) fn span(&self) -> Range<usize> {
        match self {
            Self::Scalar(word) => word.span(),
            Self::Composed(_, at) => at.clone(),
        }
    }
}

impl<S: Read, T: Read> Read for ScalarOr<S, T> {
    const EXPECTED: &'static Expected = &Expected::Either(S::EXPECTED, T::EXPECTED);
    fn read(written: Written<'_>) -> Option<Self> {
        Some(match written.content() {
            Content::Scalar(_) => Self::Scalar(S::read(written)?),
            _ => Self::Composed(T::read(written)?, written.span()),
        })
    }
}
