//! Effects in files: a table with `effect`, `joint`, `other`, the parameters in the spec's order, `onset`.

use std::fmt;

use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::kinds::Kind;
use crate::spec::{Effect, Scope, Shape, Spec, Value};

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

/// A value in a file. Only a table is none of these.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "invalid type: map, expected a number, a string or an array")]
enum Raw {
    Number(f64),
    Text(String),
    Bool(bool),
    List(Vec<Raw>),
    Nothing,
}

/// Why a table in a file is no effect.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// The catalogue has no effect of this name.
    #[error("there is no effect \"{name}\"")]
    UnknownEffect {
        /// The name that was given.
        name: String,
    },
    /// A key without which the effect is not determined.
    #[error("{key} is missing")]
    Missing {
        /// The key.
        key: &'static str,
    },
    /// A key that the effect does not have.
    #[error("unknown key `{key}`; known here: {}", known.join(", "))]
    UnknownKey {
        /// The key.
        key: String,
        /// The effect's keys, in the order of files.
        known: Vec<&'static str>,
    },
    /// A key that is given twice.
    #[error("{key} is given twice")]
    Twice {
        /// The key.
        key: String,
    },
    /// A value of another type.
    #[error("{key} is {found}; it must be {expected}")]
    Type {
        /// The key.
        key: String,
        /// The value.
        found: String,
        /// The type that it must have.
        expected: String,
    },
}

/// What is wrong with a value: what was found, and what is expected.
type Wrong = (String, String);

impl fmt::Display for Raw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(formatter, "the number {number}"),
            Self::Text(text) => write!(formatter, "the text \"{text}\""),
            Self::Bool(value) => write!(formatter, "{value}"),
            Self::List(list) => write!(formatter, "a list of {}", list.len()),
            Self::Nothing => formatter.write_str("nothing"),
        }
    }
}

impl Raw {
    /// The error that it is of another type than `expected`.
    fn wrong(&self, expected: &str) -> Wrong {
        (self.to_string(), expected.to_owned())
    }

    fn number(&self) -> Result<f64, Wrong> {
        match self {
            Self::Number(number) => Ok(*number),
            other => Err(other.wrong("a number")),
        }
    }

    fn text(self) -> Result<String, Wrong> {
        match self {
            Self::Text(text) => Ok(text),
            other => Err(other.wrong("a text")),
        }
    }

    fn list(&self) -> Result<&[Self], Wrong> {
        match self {
            Self::List(list) => Ok(list),
            other => Err(other.wrong("a list")),
        }
    }

    fn numbers(&self, count: usize) -> Result<Vec<f64>, Wrong> {
        let list = self.list()?;
        if list.len() != count {
            return Err(self.wrong(&format!("a list of {count} numbers")));
        }
        list.iter().map(Self::number).collect()
    }

    fn value(&self, shape: Shape) -> Result<Value, Wrong> {
        Ok(match shape {
            Shape::Number => Value::Number(self.number()?),
            Shape::List(count, _) => Value::List(self.numbers(count)?),
            Shape::Points => {
                let point = |raw: &Self| raw.numbers(2).map(|point| [point[0], point[1]]);
                Value::Points(self.list()?.iter().map(point).collect::<Result<_, Wrong>>()?)
            }
        })
    }
}

/// The keys and values of a table.
struct Entries(Vec<(String, Raw)>);

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = Entries;
            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a table with the key effect")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries, A::Error> {
                let mut entries: Vec<(String, Raw)> = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Table)
    }
}

impl<'de> Deserialize<'de> for Effect {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)?.map_err(D::Error::custom)
    }
}

impl Effect {
    /// The effect in a table of a file, or what is wrong with the table.
    ///
    /// # Errors
    /// Those of the `deserializer`, if it holds no table.
    pub fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Result<Self, ReadError>, D::Error> {
        Ok(from_entries(Entries::deserialize(deserializer)?.0))
    }
}

/// The keys that an effect may have, in the order of files.
fn keys(spec: &Spec, has_other: bool) -> Vec<&'static str> {
    let joint = (spec.scope == Scope::Joint).then_some("joint");
    let keys = joint.into_iter().chain(has_other.then_some("other"));
    let keys = keys.chain(spec.parameters.iter().map(|parameter| parameter.key));
    keys.chain(spec.may_set_in.then_some("onset")).collect()
}

fn from_entries(mut entries: Vec<(String, Raw)>) -> Result<Effect, ReadError> {
    let wrong = |key: &str| {
        let key = key.to_owned();
        |(found, expected)| ReadError::Type { key, found, expected }
    };
    let at = entries.iter().position(|(key, _)| key == "effect");
    let at = at.ok_or(ReadError::Missing { key: "effect" })?;
    let name = entries.remove(at).1.text().map_err(wrong("effect"))?;
    let Some(kind) = Kind::named(&name) else {
        return Err(ReadError::UnknownEffect { name });
    };
    let spec = kind.spec();
    let known = keys(spec, spec.has_other);
    let mut effect = Effect::of(spec);
    let mut given: Vec<String> = Vec::new();
    for (key, raw) in entries {
        if given.contains(&key) {
            return Err(ReadError::Twice { key });
        }
        if !known.contains(&key.as_str()) {
            return Err(ReadError::UnknownKey { key, known });
        }
        effect = match key.as_str() {
            "joint" => effect.on(raw.text().map_err(wrong(&key))?),
            "other" => effect.with_other(raw.text().map_err(wrong(&key))?),
            "onset" => effect.since(Some(raw.number().map_err(wrong(&key))?)),
            _ => match spec.parameters.iter().find(|parameter| parameter.key == key) {
                Some(parameter) => effect.with(&key, raw.value(parameter.shape).map_err(wrong(&key))?),
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
    let missing = known.iter().filter(is_needed).find(|key| !given.iter().any(|given| given == *key));
    match missing {
        Some(key) => Err(ReadError::Missing { key }),
        None => Ok(effect),
    }
}
