//! A parameter of an effect: what it measures and holds, and the values that it may have.

use crate::quantity::Quantity;

/// What a parameter holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    Number,
    /// A list of this many numbers. A finding gives them separately, under these keys (not at all if there are none).
    List(usize, &'static [&'static str]),
    /// Points (x, y) in order of x.
    Points,
}

/// The values that a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite value.
    Finite,
    /// Zero and above.
    NotNegative,
    /// Above zero.
    Positive,
    /// −1 and above.
    AtLeastMinusOne,
    /// Above −1.
    AboveMinusOne,
}

impl Range {
    /// Whether `value` is in it.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::AtLeastMinusOne => value >= -1.0,
                Self::AboveMinusOne => value > -1.0,
            }
    }

    /// The lower end; `None` if there is none.
    pub fn least(self) -> Option<f64> {
        match self {
            Self::Finite => None,
            Self::NotNegative | Self::Positive => Some(0.0),
            Self::AtLeastMinusOne | Self::AboveMinusOne => Some(-1.0),
        }
    }

    /// The requirement on a value, in words.
    pub fn requirement(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
            Self::AtLeastMinusOne => "finite and at least -1",
            Self::AboveMinusOne => "finite and above -1",
        }
    }
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key in files and findings.
    pub key: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// What it holds.
    pub shape: Shape,
    /// The values that each of its numbers may have.
    pub range: Range,
    /// The value if a file does not give one; `None` if a file must give it.
    pub default: Option<f64>,
    /// The value at which there is no effect.
    pub neutral: f64,
    /// A remark in files instead of the unit; an empty one leaves the unit out.
    pub remark: Option<&'static str>,
}

impl Parameter {
    /// A finite number that must be given and is neutral at zero.
    pub const fn new(key: &'static str, quantity: Quantity) -> Self {
        Self { key, quantity, shape: Shape::Number, range: Range::Finite, default: None, neutral: 0.0, remark: None }
    }

    /// This parameter, limited to `range`.
    pub const fn within(mut self, range: Range) -> Self {
        self.range = range;
        self
    }

    /// This parameter with a default.
    pub const fn or(mut self, default: f64) -> Self {
        self.default = Some(default);
        self
    }

    /// This parameter, which has no effect at the value `neutral`.
    pub const fn neutral_at(mut self, neutral: f64) -> Self {
        self.neutral = neutral;
        self
    }

    /// This parameter with a shape other than a number.
    pub const fn of(mut self, shape: Shape) -> Self {
        self.shape = shape;
        self
    }

    /// This parameter with a remark instead of its unit.
    pub const fn remarked(mut self, remark: &'static str) -> Self {
        self.remark = Some(remark);
        self
    }
}

/// The onset of an effect, on the recordings' own clock.
pub static ONSET: Parameter = Parameter::new("onset", Quantity::Time);
