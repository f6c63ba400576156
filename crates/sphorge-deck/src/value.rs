//! Values as the user wrote them, with their place in the text. Reading never fails on a wrong number, unit or word:
//! that is found when the deck is interpreted, so that several such faults are reported together.

use super::quantity::{QuantityKind, parse_quantity};
use super::report::{Fault, Problems, listed, nearest};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use sphorge_physics::parameter::Bound;
use std::{borrow::Cow, fmt, marker::PhantomData, ops::Range};
use toml::Spanned;

/// A TOML value that is not looked into further.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Literal {
    Integer(i64),
    Number(f64),
    Text(String),
    Boolean(bool),
    /// An array or a table.
    Composite(&'static str),
}

impl Literal {
    fn described(&self) -> String {
        match self {
            Self::Integer(i) => format!("found the number {i}"),
            Self::Number(x) => format!("found the number {x}"),
            Self::Text(text) => format!("found the text \"{text}\""),
            Self::Boolean(b) => format!("found {b}"),
            Self::Composite(what) => format!("found {what}"),
        }
    }
}

macro_rules! visit_scalars {
    ($made:expr) => {
        fn visit_bool<E>(self, v: bool) -> Result<Self::Value, E> {
            Ok($made(Literal::Boolean(v)))
        }
        fn visit_i64<E>(self, v: i64) -> Result<Self::Value, E> {
            Ok($made(Literal::Integer(v)))
        }
        fn visit_u64<E>(self, v: u64) -> Result<Self::Value, E> {
            Ok($made(Literal::Number(v as f64)))
        }
        fn visit_f64<E>(self, v: f64) -> Result<Self::Value, E> {
            Ok($made(Literal::Number(v)))
        }
        fn visit_str<E>(self, v: &str) -> Result<Self::Value, E> {
            Ok($made(Literal::Text(v.to_owned())))
        }
    };
}

impl<'de> Deserialize<'de> for Literal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Literal;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value")
            }
            visit_scalars!(|literal| literal);
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Literal, A::Error> {
                while seq.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Literal::Composite("a list"))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Literal, A::Error> {
                while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Literal::Composite("a table"))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

/// A single value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Scalar {
    pub(crate) literal: Literal,
    pub(crate) span: Range<usize>,
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<Literal>::deserialize(deserializer)?;
        Ok(Self { span: spanned.span(), literal: spanned.into_inner() })
    }
}

impl Scalar {
    /// A fault at this value: what was expected is the message, what was found the label.
    fn fault(&self, code: &'static str, expected: impl Into<String>) -> Fault {
        Fault::new(code, expected, self.span.clone(), self.literal.described())
    }

    /// The value as a quantity, in SI units.
    pub(crate) fn quantity(&self, kind: QuantityKind, problems: &mut Problems) -> Option<f64> {
        let value = match &self.literal {
            Literal::Integer(i) => *i as f64,
            Literal::Number(x) => *x,
            Literal::Text(text) => match parse_quantity(text, kind) {
                Ok(value) => value,
                Err(error) => {
                    // A plain string starts one byte after its quote; anything fancier is marked as a whole.
                    let start = self.span.start + 1;
                    let plain = problems.text().get(start..start + text.len()) == Some(text.as_str());
                    let at = if plain { start + error.at.start..start + error.at.end } else { self.span.clone() };
                    let fault = Fault::new("wrong-quantity", error.message, at, "this");
                    problems.push(match error.help {
                        Some(help) => fault.help(help),
                        None => fault,
                    });
                    return None;
                }
            },
            _ => {
                let fault = self.fault("wrong-type", format!("expected {} {}", kind.article(), kind.name));
                problems.push(fault.help(format!("write it as {}", kind.examples)));
                return None;
            }
        };
        if value.is_finite() {
            return Some(value);
        }
        let fault = self.fault("not-finite", format!("expected a finite {}", kind.name));
        problems.push(fault.help(format!("write it as {}", kind.examples)));
        None
    }

    /// The value as a quantity within a bound.
    pub(crate) fn bounded(&self, kind: QuantityKind, bound: Bound, problems: &mut Problems) -> Option<f64> {
        let value = self.quantity(kind, problems)?;
        if bound.allows(value) {
            return Some(value);
        }
        let wanted = match bound {
            Bound::Any => "finite".to_owned(),
            Bound::Positive => "above zero".to_owned(),
            Bound::NonNegative if kind == QuantityKind::TEMPERATURE => "absolute zero or above".to_owned(),
            Bound::NonNegative => "zero or above".to_owned(),
            Bound::Between(low, high) => format!("between {low} and {high}"),
        };
        let fault = self.fault("out-of-range", format!("the {} must be {wanted}", kind.name));
        problems.push(fault);
        None
    }
}

/// Names a kind of quantity in the type of a key.
pub(crate) trait Kind {
    const NAME: &'static str;
    const KIND: QuantityKind;
}

macro_rules! kind_types {
    ($($name:ident => $kind:ident,)+) => { $(
        #[derive(Clone, Copy, Debug)]
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
}

macro_rules! scalar_wrapper {
    ($(#[$doc:meta])* $name:ident < $parameter:ident >) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(crate) struct $name<$parameter>(pub(crate) Scalar, PhantomData<$parameter>);
        impl<'de, $parameter> Deserialize<'de> for $name<$parameter> {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                Scalar::deserialize(deserializer).map(Self::from)
            }
        }
        impl<$parameter> From<Scalar> for $name<$parameter> {
            fn from(scalar: Scalar) -> Self {
                Self(scalar, PhantomData)
            }
        }
        impl<$parameter> $name<$parameter> {
            pub(crate) fn span(&self) -> Range<usize> {
                self.0.span.clone()
            }
        }
    };
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(crate) struct $name(pub(crate) Scalar);
        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                Scalar::deserialize(deserializer).map(Self)
            }
        }
        impl From<Scalar> for $name {
            fn from(scalar: Scalar) -> Self {
                Self(scalar)
            }
        }
    };
}

scalar_wrapper! {
    /// A quantity of kind `K`.
    Given<K>
}
scalar_wrapper! {
    /// A word out of the table `C`.
    Choice<C>
}
scalar_wrapper! {
    /// A whole number, zero or above.
    Count
}
scalar_wrapper! {
    /// A quantity in the unit of a field named elsewhere.
    FieldLevel
}
scalar_wrapper! {
    /// Free text or a name.
    Word
}
scalar_wrapper! {
    /// True or false.
    Flag
}

impl<K: Kind> Given<K> {
    pub(crate) fn si(&self, problems: &mut Problems) -> Option<f64> {
        self.0.quantity(K::KIND, problems)
    }

    pub(crate) fn within(&self, bound: Bound, problems: &mut Problems) -> Option<f64> {
        self.0.bounded(K::KIND, bound, problems)
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
    pub(crate) fn span(&self) -> Range<usize> {
        self.0.span.clone()
    }

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
}

impl<C: Choices> Choice<C> {
    pub(crate) fn get(&self, problems: &mut Problems) -> Option<C::Value> {
        let table = C::table();
        let words = || table.iter().map(|entry| entry.0);
        if let Literal::Text(text) = &self.0.literal {
            if let Some(entry) = table.iter().find(|entry| entry.0 == text) {
                return Some(entry.1.clone());
            }
            let near = C::meant(text)
                .or_else(|| nearest(text, words()))
                .map(|n| format!("did you mean `{n}`? "))
                .unwrap_or_default();
            let fault = Fault::new("unknown-choice", format!("unknown {} `{text}`", C::WHAT), self.span(), "not known");
            problems.push(fault.help(format!("{near}Choose {}.", listed(words(), "or"))));
            return None;
        }
        let fault = self.0.fault("wrong-type", format!("expected the name of a {}", C::WHAT));
        problems.push(fault.help(format!("Choose {}.", listed(words(), "or"))));
        None
    }
}

/// A vector of one to three components.
#[derive(Clone, Debug)]
pub(crate) struct VectorOf<K> {
    pub(crate) components: Vec<Given<K>>,
    pub(crate) span: Range<usize>,
}

impl<'de, K> Deserialize<'de> for VectorOf<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<Vec<Given<K>>>::deserialize(deserializer)?;
        Ok(Self { span: spanned.span(), components: spanned.into_inner() })
    }
}

/// Either a single value or something composed, told apart by what stands in the text.
#[derive(Clone, Debug)]
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

impl<'de, S: From<Scalar>, T: Deserialize<'de>> Deserialize<'de> for ScalarOr<S, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        enum Form<T> {
            Scalar(Literal),
            Composed(T),
        }
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = Form<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value, a list or a table")
            }
            visit_scalars!(Form::Scalar);
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Form<T>, A::Error> {
                T::deserialize(SeqAccessDeserializer::new(seq)).map(Form::Composed)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Form<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Form::Composed)
            }
        }
        impl<'de, T: Deserialize<'de>> Deserialize<'de> for Form<T> {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(Either(PhantomData))
            }
        }
        let spanned = Spanned::<Form<T>>::deserialize(deserializer)?;
        let span = spanned.span();
        Ok(match spanned.into_inner() {
            Form::Scalar(literal) => Self::Scalar(S::from(Scalar { literal, span })),
            Form::Composed(value) => Self::Composed(value, span),
        })
    }
}

impl<K: Kind> JsonSchema for Given<K> {
    fn schema_name() -> Cow<'static, str> {
        K::NAME.into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kind = K::KIND;
        json_schema!({
            "description": format!("{} {}: {}, or a plain number in SI", kind.article(), kind.name, kind.examples),
            "type": ["number", "string"],
            "x-unit": kind.si_unit,
        })
    }
}

impl<K: Kind> JsonSchema for VectorOf<K> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}Vector", K::NAME).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let component = generator.subschema_for::<Given<K>>();
        json_schema!({
            "description": format!("one {} per axis of the deck", K::KIND.name),
            "type": "array", "items": component, "minItems": 1, "maxItems": 3, "x-unit": K::KIND.si_unit,
        })
    }
}

impl<C: Choices> JsonSchema for Choice<C> {
    fn schema_name() -> Cow<'static, str> {
        C::NAME.into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let options: Vec<Schema> = C::table()
            .into_iter()
            .map(|(word, _, meaning)| json_schema!({ "const": word, "description": meaning }))
            .collect();
        json_schema!({ "description": C::WHAT, "oneOf": options })
    }
}

macro_rules! inline_schema {
    ($($name:ident => $schema:tt,)+) => { $(
        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    )+ };
}
inline_schema! {
    Word => { "type": "string" },
    Flag => { "type": "boolean" },
    FieldLevel => { "type": ["number", "string"] },
    Count => { "type": "integer", "minimum": 0 },
}

impl<S: JsonSchema, T: JsonSchema> JsonSchema for ScalarOr<S, T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("{}Or{}", S::schema_name(), T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (scalar, composed) = (generator.subschema_for::<S>(), generator.subschema_for::<T>());
        json_schema!({ "anyOf": [scalar, composed] })
    }
}
