//! The strengths of the background's parts, and those that are tried beside them.

use std::fmt;

use crate::thresholds::{
    BEYOND_STRONGEST, CONSTANTS_BESIDE_LINKS, FINER_STRENGTH, FRICTION_STRENGTHS, GAIN_STRENGTHS, LAG_COST,
    LINK_STRENGTHS, OFFSET_STRENGTHS, OWN_STRENGTHS, PER_BACKGROUND_PART, PER_LINK_APART, USUAL_STRENGTH,
    VARIED_FRICTION,
};

/// The strengths of the parts of the background, as standard deviations; zero switches a part off.
#[derive(Clone, Debug, PartialEq)]
pub struct PriorStrengths {
    /// ρ of each link's inertial parameters.
    pub links: Vec<f64>,
    /// The least ρ of each link, whatever the evidence prefers: the URDF has a placeholder for the body of some links.
    pub least: Vec<f64>,
    /// The form of each joint's friction, relative to its prior.
    pub friction: f64,
    /// The joints and recordings in which friction is much different.
    pub varied: Vec<(usize, usize)>,
    /// How much the friction of each joint differs between recordings, relative to `friction`. It costs no evidence: less of it is a simpler
    /// background.
    pub between: Vec<f64>,
    /// The joints whose friction curves are not corrected, because a correction makes their held-out error larger than the nominal model's.
    pub uncorrected_friction: Vec<usize>,
    /// The constant torques of the joints, relative to their prior.
    pub offset: f64,
    /// The torque constants, relative to their prior.
    pub gain: f64,
    /// The joints whose constant torque is a named effect, so that it is not in the background.
    pub named_offsets: Vec<usize>,
    /// The joints whose constant torque has no name, because it may be a part of an unexplained residual. It corrects the model with any
    /// size.
    pub nameless_offsets: Vec<usize>,
    /// The joints whose torque constant is a named effect, so that it is not in the background.
    pub named_constants: Vec<usize>,
    /// The joints whose torque constant would differ from one by more than [`MOST_CONSTANT`](crate::thresholds::MOST_CONSTANT), so that it
    /// is not in the background: an effect must explain the difference.
    pub impossible_constants: Vec<usize>,
    /// Whether a lag of all torques is in the background.
    pub lag: bool,
}

/// The largest number of joints and recordings whose friction is made much different at once.
const MOST_DIFFERENT: usize = 3;

/// A part of the background that [`PriorStrengths::weaker`] reduces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The links' inertial parameters.
    Links,
    /// The form of friction.
    Friction,
    /// The torque constants.
    Gain,
}

impl fmt::Display for PriorStrengths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A finer strength is a product of factors, with as many digits as it has.
        let links: Vec<String> = self.links.iter().map(|rho| ((rho * 1e3).round() / 1e3).to_string()).collect();
        write!(
            f,
            "links {}; friction {}; offsets {}; torque constants {}",
            links.join(" "),
            self.friction,
            self.offset,
            self.gain
        )?;
        for (joint, recording) in &self.varied {
            write!(f, "; friction of joint {joint} in recording {recording}")?;
        }
        if self.between.iter().any(|&between| between != 1.0) {
            let between: Vec<String> = self.between.iter().map(f64::to_string).collect();
            write!(f, "; friction between recordings × {}", between.join(" "))?;
        }
        for joint in &self.uncorrected_friction {
            write!(f, "; friction of joint {joint} not corrected")?;
        }
        if self.lag { write!(f, "; lag") } else { Ok(()) }
    }
}

impl PriorStrengths {
    /// No background: the nominal model.
    pub fn none(links: usize) -> Self {
        Self {
            links: vec![0.0; links],
            least: vec![0.0; links],
            friction: 0.0,
            varied: Vec::new(),
            between: vec![1.0; links],
            uncorrected_friction: Vec::new(),
            offset: 0.0,
            gain: 0.0,
            named_offsets: Vec::new(),
            nameless_offsets: Vec::new(),
            named_constants: Vec::new(),
            impossible_constants: Vec::new(),
            lag: false,
        }
    }

    /// These strengths without a lag of all torques.
    #[must_use]
    pub fn without_lag(&self) -> Self {
        Self { lag: false, ..self.clone() }
    }

    /// ρ of a link.
    pub fn of_link(&self, link: usize) -> f64 {
        self.links[link].max(self.least[link])
    }

    /// The strength of the friction of a joint that a recording has of its own.
    pub fn own_friction(&self, joint: Option<usize>, recording: usize) -> f64 {
        let is_varied = joint.is_some_and(|joint| self.varied.contains(&(joint, recording)));
        let usual = joint.map_or(self.friction, |joint| self.between_recordings(joint));
        if is_varied { self.friction_of(joint).max(VARIED_FRICTION) } else { usual }
    }

    /// The strength of the friction of a joint that most recordings have of their own.
    pub fn between_recordings(&self, joint: usize) -> f64 {
        self.between[joint] * self.friction_of(Some(joint))
    }

    /// The strength of the friction curve of a joint.
    pub fn friction_of(&self, joint: Option<usize>) -> f64 {
        let is_uncorrected = joint.is_some_and(|joint| self.uncorrected_friction.contains(&joint));
        if is_uncorrected { 0.0 } else { self.friction }
    }

    /// These strengths without corrections of the friction curves of `joints`.
    #[must_use]
    pub fn without_friction_of(&self, joints: &[usize]) -> Self {
        let mut next = self.clone();
        next.varied.retain(|(joint, _)| !joints.contains(joint));
        next.uncorrected_friction.extend(joints);
        next.uncorrected_friction.sort_unstable();
        next.uncorrected_friction.dedup();
        next
    }

    /// Whether the URDF has a placeholder for the body of some link.
    pub fn has_placeholders(&self) -> bool {
        self.least.iter().any(|&least| least > 0.0)
    }

    /// ρ of the link that differs most.
    pub fn strongest(&self) -> f64 {
        (0..self.links.len()).fold(0.0, |most: f64, link| most.max(self.of_link(link)))
    }

    /// These strengths with a link that differs from the URDF no more than most.
    #[must_use]
    pub fn with_link_as_most(&self, link: usize) -> Self {
        let mut next = self.clone();
        (next.links[link], next.least[link]) = (self.common(), 0.0);
        next
    }

    /// These strengths with the URDF's links.
    #[must_use]
    pub fn with_exact_links(&self) -> Self {
        Self { links: vec![0.0; self.links.len()], least: vec![0.0; self.links.len()], ..self.clone() }
    }

    /// Whether some links differ from the URDF and most do not.
    pub fn are_of_some_links(&self) -> bool {
        self.common() == 0.0 && self.links.iter().any(|&rho| rho > 0.0)
    }

    /// The evidence that they must bring (nats).
    pub fn cost(&self) -> f64 {
        let part = |strength: f64, cost: f64| if strength > 0.0 { cost } else { 0.0 };
        let common = self.common();
        let apart = self.links.iter().filter(|&&rho| rho != common).count();
        let unlikely = 0.5 * (common / USUAL_STRENGTH).powi(2);
        // Several wrong links among links that are exact are less likely than links that are all somewhat wrong.
        let several = if common == 0.0 { apart.saturating_sub(1) } else { 0 };
        // Where all links are wrong, the torque constants are probably wrong, too.
        let constants = if common > 0.0 { CONSTANTS_BESIDE_LINKS } else { PER_BACKGROUND_PART };
        part(self.friction, PER_BACKGROUND_PART)
            + part(self.offset, PER_BACKGROUND_PART)
            + part(self.gain, constants)
            + part(f64::from(u8::from(self.lag)), LAG_COST)
            + part(common, PER_BACKGROUND_PART)
            + unlikely
            + PER_LINK_APART * (apart + several + self.varied.len()) as f64
    }

    /// The strengths that are tried for one link, below and above that of most links.
    pub fn around_common(&self) -> (f64, f64) {
        let common = self.common();
        let below = LINK_STRENGTHS.into_iter().filter(|&rho| rho < common).fold(0.0, f64::max);
        let above = LINK_STRENGTHS.into_iter().filter(|&rho| rho > common).fold(f64::INFINITY, f64::min);
        (below, if above.is_finite() { above } else { BEYOND_STRONGEST * common })
    }

    /// ρ of most links.
    pub fn common(&self) -> f64 {
        self.links.iter().copied().fold(f64::INFINITY, f64::min).min(1e3)
    }

    /// The strengths that differ from these in a part common to all links or joints.
    pub fn neighbours(&self) -> Vec<Self> {
        let mut list = Vec::new();
        let mut add = |next: Self| {
            if next != *self && !list.contains(&next) {
                list.push(next);
            }
        };
        let common = self.common();
        for rho in LINK_STRENGTHS {
            add(Self { links: vec![rho; self.links.len()], ..self.clone() });
            // Links that differ more than most still do.
            let of_link = |&own: &f64| if own == common { rho } else { own.max(rho) };
            add(Self { links: self.links.iter().map(of_link).collect(), ..self.clone() });
        }
        for friction in FRICTION_STRENGTHS {
            add(Self { friction, ..self.clone() });
        }
        for gain in GAIN_STRENGTHS {
            add(Self { gain, ..self.clone() });
        }
        add(Self { lag: !self.lag, ..self.clone() });
        list
    }

    /// The strengths that differ from these in the constant torques.
    pub fn with_other_offsets(&self) -> Vec<Self> {
        let others = OFFSET_STRENGTHS.into_iter().filter(|&offset| offset != self.offset);
        others.map(|offset| Self { offset, ..self.clone() }).collect()
    }

    /// The strengths that differ from these in one link, or in the friction of a joint in one recording. A few of the joints and recordings
    /// `different`, the most different one first, must be able to stand for friction that differs everywhere.
    pub fn in_one_place(&self, different: &[(usize, usize)]) -> Vec<Self> {
        let mut list = self.with_other_links();
        let without = |one: &(usize, usize)| self.varied.iter().copied().filter(|other| other != one).collect();
        list.extend(self.varied.iter().map(|one| Self { varied: without(one), ..self.clone() }));
        for most in 1..=different.len().min(MOST_DIFFERENT) {
            let mut varied = [&self.varied[..], &different[..most]].concat();
            varied.sort_unstable();
            for friction in FRICTION_STRENGTHS.into_iter().filter(|&friction| friction < self.friction) {
                list.push(Self { friction, varied: varied.clone(), ..self.clone() });
            }
        }
        list
    }

    /// The strengths that differ from these in one link.
    pub fn with_other_links(&self) -> Vec<Self> {
        let mut list = Vec::new();
        let mut add = |next: Self| {
            if next != *self && !list.contains(&next) {
                list.push(next);
            }
        };
        for link in 0..self.links.len() {
            for rho in std::iter::once(self.common()).chain(OWN_STRENGTHS) {
                let mut next = self.clone();
                next.links[link] = rho;
                if rho >= self.common() {
                    add(next);
                }
            }
        }
        list
    }

    /// The strengths with which one link alone differs from the URDF.
    pub fn in_one_link(&self) -> Vec<Self> {
        let mut list = Vec::new();
        if self.common() > 0.0 {
            for link in 0..self.links.len() {
                for rho in OWN_STRENGTHS.into_iter().filter(|&rho| rho >= self.common()) {
                    let mut next = Self { links: vec![0.0; self.links.len()], ..self.clone() };
                    next.links[link] = rho;
                    list.push(next);
                }
            }
        }
        list
    }

    /// These strengths with all links a finer step weaker or stronger than on the grid.
    pub fn finer(&self) -> Vec<Self> {
        let most = LINK_STRENGTHS.into_iter().fold(0.0, f64::max);
        let scaled = |factor: f64| Self {
            links: self.links.iter().map(|rho| (rho * factor).min(most)).collect(),
            ..self.clone()
        };
        if self.links.iter().all(|&rho| rho == 0.0) {
            return Vec::new();
        }
        vec![scaled(1.0 / FINER_STRENGTH), scaled(FINER_STRENGTH)]
    }

    /// These strengths, with every link's at least `rho`.
    pub fn at_least(&self, rho: f64) -> Self {
        Self { links: self.links.iter().map(|own| own.max(rho)).collect(), ..self.clone() }
    }

    /// These strengths with less of one part, except for the constant torques, which no other effect replaces.
    pub fn weaker(&self) -> Vec<Self> {
        let mut list = Vec::new();
        let largest = self.links.iter().copied().fold(0.0, f64::max);
        for rho in LINK_STRENGTHS.into_iter().filter(|&rho| rho < largest) {
            list.push(Self { links: self.links.iter().map(|&own| own.min(rho)).collect(), ..self.clone() });
        }
        for friction in FRICTION_STRENGTHS.into_iter().filter(|&friction| friction < self.friction) {
            list.push(Self { friction, ..self.clone() });
        }
        if !self.varied.is_empty() {
            list.push(Self { varied: Vec::new(), ..self.clone() });
        }
        for gain in GAIN_STRENGTHS.into_iter().filter(|&gain| gain < self.gain) {
            list.push(Self { gain, ..self.clone() });
        }
        list
    }

    /// The part in which `other` differs from these strengths: the first one, if there are several.
    pub fn part_that_differs(&self, other: &Self) -> Part {
        if self.links != other.links {
            Part::Links
        } else if self.friction != other.friction
            || self.varied != other.varied
            || self.between != other.between
            || self.uncorrected_friction != other.uncorrected_friction
        {
            Part::Friction
        } else {
            Part::Gain
        }
    }

    /// Whether friction curves or torque constants differ from the model's.
    pub fn is_of_joints(&self) -> bool {
        self.friction > 0.0 || self.gain > 0.0 || !self.varied.is_empty()
    }

    /// Whether there is no background that corrects the model, beside a lag of the torques.
    pub fn is_none(&self) -> bool {
        !self.is_of_joints() && self.offset == 0.0 && self.nameless_offsets.is_empty() && self.strongest() == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_common_strength_may_change_while_one_link_stays_apart() {
        let strengths = PriorStrengths { links: vec![0.0, 1.0, 0.0], ..PriorStrengths::none(3) };
        let neighbours = strengths.neighbours();
        let has = |links: [f64; 3]| neighbours.iter().any(|next| next.links == links);
        assert!(has([0.1, 1.0, 0.1]) && has([0.1; 3]));
        assert!(!has([0.0, 0.1, 0.0]), "this changes one link, not the common strength");
    }
}
