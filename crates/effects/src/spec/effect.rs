//! An effect with its parameter values: data, as in files.

use std::fmt;

use nalgebra::Vector3;

use super::{Parameter, Shape, Spec};
use crate::term::Term;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Several numbers.
    List(Vec<f64>),
    /// Points (x, y).
    Points(Vec<[f64; 2]>),
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<const N: usize> From<[f64; N]> for Value {
    fn from(list: [f64; N]) -> Self {
        Self::List(list.to_vec())
    }
}

impl From<Vec<[f64; 2]>> for Value {
    fn from(points: Vec<[f64; 2]>) -> Self {
        Self::Points(points)
    }
}

impl Value {
    /// All numbers in it.
    pub fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Number(number) => vec![*number],
            Self::List(list) => list.clone(),
            Self::Points(points) => points.iter().flatten().copied().collect(),
        }
    }
}

/// One effect with its parameters in SI units at the joint; a joint is named as in the URDF. [`Effect::of`] makes it of a spec.
///
/// For a prismatic joint read N for N m and m for rad. The torque of an effect is what it adds to the measured torque
/// beyond the torque of the rigid model.
#[derive(Clone)]
pub struct Effect {
    spec: &'static Spec,
    joint: Option<String>,
    other: Option<String>,
    /// One value for each of the spec's parameters.
    values: Vec<Value>,
    onset: Option<f64>,
}

impl Effect {
    /// An effect with this spec, without a joint. A parameter that has no default and is not set is NaN, which
    /// [`check`](crate::check) refuses.
    pub fn of(spec: &'static Spec) -> Self {
        let blank = |parameter: &Parameter| {
            let number = parameter.default.unwrap_or(f64::NAN);
            match parameter.shape {
                Shape::Number => Value::Number(number),
                Shape::List(count, _) => Value::List(vec![number; count]),
                Shape::Points => Value::Points(Vec::new()),
            }
        };
        Self { spec, joint: None, other: None, values: spec.parameters.iter().map(blank).collect(), onset: None }
    }

    /// This effect on the joint `name`.
    #[must_use]
    pub fn on(mut self, name: impl Into<String>) -> Self {
        self.joint = Some(name.into());
        self
    }

    /// This effect with the other joint on whose motion it depends.
    #[must_use]
    pub fn with_other(mut self, name: impl Into<String>) -> Self {
        self.other = Some(name.into());
        self
    }

    /// This effect with a parameter set; a key that the effect does not have changes nothing.
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        if let Some(at) = self.place(key) {
            self.values[at] = value.into();
        }
        self
    }

    /// This effect from `onset` on (s, on the clock of the recordings); `None` for an effect that always acts.
    #[must_use]
    pub fn since(mut self, onset: Option<f64>) -> Self {
        self.onset = onset;
        self
    }

    fn place(&self, key: &str) -> Option<usize> {
        self.spec.parameters.iter().position(|parameter| parameter.key == key)
    }

    /// Whether it has this spec.
    pub fn is(&self, spec: &'static Spec) -> bool {
        std::ptr::eq(self.spec, spec)
    }

    /// What is known of its kind.
    pub fn spec(&self) -> &'static Spec {
        self.spec
    }

    /// The catalogue's name of the effect.
    pub fn name(&self) -> &'static str {
        self.spec.name
    }

    /// The title of the effect with its parameters.
    pub fn title(&self) -> &'static str {
        (self.spec.own_title)(self).unwrap_or(self.spec.title)
    }

    /// The effect as a short phrase with its parameters, in the form of [`Spec::sentence`].
    pub fn sentence(&self) -> &'static str {
        (self.spec.own_sentence)(self).unwrap_or(self.spec.sentence)
    }

    /// Its term on the joint of an index, as [`Spec::of_command`] gives it.
    pub fn of_command(&self, joint: usize) -> Option<Term> {
        (self.spec.of_command)(self, joint)
    }

    /// The joint it is on; `None` for the whole arm.
    pub fn joint(&self) -> Option<&str> {
        self.joint.as_deref()
    }

    /// The other joint whose motion it depends on.
    pub fn other(&self) -> Option<&str> {
        self.other.as_deref()
    }

    /// When it sets in (s, on the recordings' own clock); `None` if it always acts.
    pub fn onset(&self) -> Option<f64> {
        self.onset
    }

    /// Its parameters with their values.
    pub fn values(&self) -> impl Iterator<Item = (&'static Parameter, &Value)> {
        self.spec.parameters.iter().zip(&self.values)
    }

    /// The number that is its parameter `key`; NaN if it has no such number.
    pub fn number(&self, key: &str) -> f64 {
        match self.place(key).map(|at| &self.values[at]) {
            Some(Value::Number(number)) => *number,
            _ => f64::NAN,
        }
    }

    /// The numbers that are its parameter `key`; all NaN if it has no such list.
    pub fn list<const N: usize>(&self, key: &str) -> [f64; N] {
        match self.place(key).map(|at| &self.values[at]) {
            Some(Value::List(list)) if list.len() == N => std::array::from_fn(|k| list[k]),
            _ => [f64::NAN; N],
        }
    }

    /// The vector that is its parameter `key`.
    pub fn vector(&self, key: &str) -> Vector3<f64> {
        Vector3::from(self.list::<3>(key))
    }

    /// The points that are its parameter `key`; none if it has none.
    pub fn points(&self, key: &str) -> &[[f64; 2]] {
        match self.place(key).map(|at| &self.values[at]) {
            Some(Value::Points(points)) => points,
            _ => &[],
        }
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.spec, other.spec)
            && (&self.joint, &self.other, self.onset) == (&other.joint, &other.other, other.onset)
            && self.values == other.values
    }
}

impl fmt::Debug for Effect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Effect");
        shown.field("name", &self.name()).field("joint", &self.joint);
        shown.field("other", &self.other).field("values", &self.values);
        shown.field("onset", &self.onset).finish()
    }
}
