//! Effects in files: a table with `effect`, `joint`, `other`, the parameters in the spec's order, `onset`.

use std::fmt;

use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::effect::{Effect, Value};
use crate::kinds::{Kind, NAMES};
use crate::spec::{Scope, Shape, Spec};

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => number.serialize(serializer),
            Self::List(list) => list.serialize(serializer),
            Self::Points(points) => points.serialize(serializer),
        }
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("effect", self.name())?;
        if let Some(joint) = self.joint() {
            map.serialize_entry("joint", joint)?;
        }
        if let Some(other) = self.other() {
            map.serialize_entry("other", other)?;
        }
        for (parameter, value) in self.values() {
            map.serialize_entry(parameter.key, value)?;
        }
        if let Some(onset) = self.onset() {
            map.serialize_entry("onset", &onset)?;
        }
        map.end()
    }
}

/// A value in a file.
#[derive(Clone, Debug)]
enum Raw {
    Number(f64),
    Text(String),
    Bool(bool),
    List(Vec<Raw>),
    Nothing,
}

impl Raw {
    /// The error that it is of another type than `expected`.
    fn wrong<E: Error>(&self, expected: &'static str) -> E {
        let found = match self {
            Self::Number(number) => Unexpected::Float(*number),
            Self::Text(text) => Unexpected::Str(text),
            Self::Bool(value) => Unexpected::Bool(*value),
            Self::List(_) => Unexpected::Seq,
            Self::Nothing => Unexpected::Unit,
        };
        E::invalid_type(found, &expected)
    }

    fn number<E: Error>(&self) -> Result<f64, E> {
        match self {
            Self::Number(number) => Ok(*number),
            other => Err(other.wrong("f64")),
        }
    }

    fn text<E: Error>(self) -> Result<String, E> {
        match self {
            Self::Text(text) => Ok(text),
            other => Err(other.wrong("a string")),
        }
    }

    fn list<E: Error>(&self) -> Result<&[Self], E> {
        match self {
            Self::List(list) => Ok(list),
            other => Err(other.wrong("an array")),
        }
    }

    fn numbers<E: Error>(&self, count: usize) -> Result<Vec<f64>, E> {
        let list = self.list()?;
        if list.len() != count {
            let expected = format!("an array of {count} numbers");
            return Err(E::invalid_length(list.len(), &expected.as_str()));
        }
        list.iter().map(Self::number).collect()
    }

    fn value<E: Error>(&self, shape: Shape) -> Result<Value, E> {
        Ok(match shape {
            Shape::Number => Value::Number(self.number()?),
            Shape::List(count, _) => Value::List(self.numbers(count)?),
            Shape::Points => {
                let point = |raw: &Self| raw.numbers(2).map(|point| [point[0], point[1]]);
                Value::Points(self.list()?.iter().map(point).collect::<Result<_, E>>()?)
            }
        })
    }
}

impl<'de> Deserialize<'de> for Raw {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Raw;
            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a number, a string or an array")
            }
            fn visit_bool<E>(self, value: bool) -> Result<Raw, E> {
                Ok(Raw::Bool(value))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Raw, E> {
                Ok(Raw::Number(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Raw, E> {
                Ok(Raw::Number(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Raw, E> {
                Ok(Raw::Number(value))
            }
            fn visit_str<E>(self, value: &str) -> Result<Raw, E> {
                Ok(Raw::Text(value.to_owned()))
            }
            fn visit_unit<E>(self) -> Result<Raw, E> {
                Ok(Raw::Nothing)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Raw, A::Error> {
                let mut list = Vec::new();
                while let Some(next) = seq.next_element()? {
                    list.push(next);
                }
                Ok(Raw::List(list))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

impl<'de> Deserialize<'de> for Effect {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = Effect;
            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a table with the key effect")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Effect, A::Error> {
                let mut entries: Vec<(String, Raw)> = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                from_entries(entries)
            }
        }
        deserializer.deserialize_map(Table)
    }
}

/// The keys that an effect may have, in the order of files.
fn keys(spec: &Spec, has_other: bool) -> Vec<&'static str> {
    let joint = (spec.scope == Scope::Joint).then_some("joint");
    let keys = joint.into_iter().chain(has_other.then_some("other"));
    let keys = keys.chain(spec.parameters.iter().map(|parameter| parameter.key));
    keys.chain(spec.may_set_in.then_some("onset")).collect()
}

fn from_entries<E: Error>(mut entries: Vec<(String, Raw)>) -> Result<Effect, E> {
    let at = entries.iter().position(|(key, _)| key == "effect");
    let name = entries.remove(at.ok_or_else(|| E::missing_field("effect"))?).1.text()?;
    let kind = Kind::named(&name).ok_or_else(|| E::unknown_variant(&name, &NAMES))?;
    let spec = kind.spec();
    let known = keys(spec, kind.get().has_other());
    let mut effect = Effect::of(kind.get());
    let mut given: Vec<String> = Vec::new();
    for (key, raw) in entries {
        if given.contains(&key) {
            return Err(E::custom(format_args!("duplicate field `{key}`")));
        }
        if !known.contains(&key.as_str()) {
            let known: Vec<String> = known.iter().map(|key| format!("`{key}`")).collect();
            let expected = match known.as_slice() {
                [one] => one.clone(),
                [one, other] => format!("{one} or {other}"),
                several => format!("one of {}", several.join(", ")),
            };
            return Err(E::custom(format_args!("unknown field `{key}`, expected {expected}")));
        }
        effect = match key.as_str() {
            "joint" => effect.on(raw.text()?),
            "other" => effect.with_other(raw.text()?),
            "onset" => effect.since(Some(raw.number()?)),
            _ => match spec.parameters.iter().find(|parameter| parameter.key == key) {
                Some(parameter) => effect.with(&key, raw.value(parameter.shape)?),
                None => effect,
            },
        };
        given.push(key);
    }
    let is_needed = |key: &&&str| {
        let parameter = spec.parameters.iter().find(|parameter| parameter.key == **key);
        match parameter {
            Some(parameter) => parameter.default.is_none() && parameter.shape != Shape::Points,
            None => **key != "onset",
        }
    };
    let missing = known
        .iter()
        .filter(is_needed)
        .find(|key| !given.iter().any(|given| given == *key));
    match missing {
        Some(key) => Err(E::missing_field(key)),
        None => Ok(effect),
    }
}
