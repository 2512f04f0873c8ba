//! The cases of a campaign: robots, difficulty and families, decided before anything is simulated.

use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::fault::{Fault, families, outside};
use crate::robot::Robot;
use crate::urdf_error::SIGMAS;

/// Cases drawn from a seed. A third have only baseline friction, a tenth an effect outside the catalogue, and the others
/// one to three effects of the catalogue, each family about equally often. Half of the cases are easy, and half are hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Campaign {
    /// The seed of all random choices.
    pub seed: u64,
    /// The number of cases.
    pub cases: usize,
    /// Whether half of the cases resemble real robots ([`CasePlan::lifelike`]).
    pub lifelike: bool,
    /// The relative error of the URDFs; `None` for 0, 0.03, 0.1 and 0.3 in turns, so that a quarter is exact.
    pub urdf_error: Option<f64>,
}

/// The plan of a case, before the sizes of effects are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct CasePlan {
    /// The index of the case in its campaign, from 0.
    pub index: usize,
    /// Its name, which is also that of its folder.
    pub name: String,
    /// The seed of its sizes, motions and noise.
    pub seed: u64,
    /// Whether it is hard: 100 to 500 Hz and sometimes 1 kHz, jittered stamps, lost rows, functional forms other than
    /// the textbook's, smaller effects, two training recordings instead of three.
    pub hard: bool,
    /// Whether every joint has baseline Coulomb and viscous friction.
    pub background_friction: bool,
    /// Names of the effects.
    pub effects: Vec<String>,
    /// Whether it resembles a real robot: small effects on every joint, wrong torque constants, friction that differs between
    /// recordings, coloured and quantised torque noise, elastic gearboxes, tools that the URDF draws and that are not mounted,
    /// and files with clocks of their own.
    pub lifelike: bool,
    /// The relative error of all inertial parameters of the URDF.
    pub urdf_error: f64,
}

impl Campaign {
    /// The plan of case `index`; `None` beyond the last.
    pub fn case(&self, index: usize) -> Option<CasePlan> {
        self.plans().into_iter().nth(index)
    }

    /// The plans of all cases.
    pub fn plans(&self) -> Vec<CasePlan> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let count = |part: f64| (self.cases as f64 * part).round() as usize;
        let (baseline, unknown) = (count(1.0 / 3.0), count(0.1));
        let mut outside = Deck::new(outside());
        let mut families = Deck::new(families());
        let mut effects: Vec<(Vec<String>, bool)> = Vec::new();
        // Every second case of each kind resembles a real robot.
        while effects.len() < self.cases {
            let lifelike = self.lifelike && effects.len() % 2 == 1;
            let names = match effects.len() {
                number if number < baseline => Vec::new(),
                number if number < baseline + unknown => vec![outside.next(&mut random).to_owned()],
                _ => {
                    let sizes: &[usize] = if lifelike { &[1, 2, 2, 3, 3, 5] } else { &[1, 2, 2, 3] };
                    let size = sizes.choose(&mut random).copied().unwrap_or(1);
                    families.next_names(size, &mut random)
                }
            };
            effects.push((names, lifelike));
        }
        // Friction and difficulty are independent of the faults.
        let mut quarters: Vec<bool> = (0..self.cases).map(|i| i % 4 != 0).collect();
        let mut halves: Vec<bool> = (0..self.cases).map(|i| i % 2 == 1).collect();
        let mut errors: Vec<f64> = (0..self.cases).map(|i| SIGMAS[i % SIGMAS.len()]).collect();
        effects.shuffle(&mut random);
        quarters.shuffle(&mut random);
        halves.shuffle(&mut random);
        errors.shuffle(&mut random);
        let digits = self.cases.saturating_sub(1).to_string().len().max(3);
        let cases = effects.into_iter().zip(quarters).zip(halves).zip(errors).enumerate();
        cases
            .map(|(index, ((((effects, lifelike), friction), hard), error))| CasePlan {
                index,
                name: format!("case_{index:0digits$}"),
                // Small enough for the integers of any JSON reader.
                seed: random.random::<u64>() >> 11,
                hard,
                // Every real joint has friction.
                background_friction: friction || lifelike,
                effects,
                lifelike,
                urdf_error: self.urdf_error.unwrap_or(error),
            })
            .collect()
    }
}

impl CasePlan {
    /// The robot of this case; the robots take turns. If the inertia of a drive is injected, it is a robot whose URDF
    /// lacks no drive inertia, if there is one.
    ///
    /// # Panics
    /// If there are no robots.
    pub fn robot<'a>(&self, robots: &'a [Robot]) -> &'a Robot {
        let turn = self.index % robots.len();
        let needs_plain = self.effects.iter().any(|effect| effect == "rotor_inertia");
        let from_here = (0..robots.len()).map(|k| &robots[(turn + k) % robots.len()]);
        from_here.into_iter().find(|robot| !(needs_plain && robot.has_rotors())).unwrap_or(&robots[turn])
    }
}

/// Names that all occur equally often, in a new random order each time.
struct Deck {
    names: Vec<&'static str>,
    left: Vec<&'static str>,
}

impl Deck {
    fn new(names: Vec<&'static str>) -> Self {
        Self { names, left: Vec::new() }
    }

    fn next(&mut self, random: &mut impl Rng) -> &'static str {
        self.fill(1, random);
        self.left.remove(0)
    }

    fn fill(&mut self, least: usize, random: &mut impl Rng) {
        while self.left.len() < least {
            let mut round = self.names.clone();
            round.shuffle(random);
            self.left.extend(round);
        }
    }

    /// The next `size` names that may occur together; names that may not are kept for later.
    fn next_names(&mut self, size: usize, random: &mut impl Rng) -> Vec<String> {
        self.fill(3 * self.names.len(), random);
        let mut hand: Vec<&str> = Vec::new();
        let mut place = 0;
        while hand.len() < size {
            let next = self.left[place];
            let alike = |name: &str| Fault::named(name).and_then(|fault| fault.similar_faults);
            let clashes = |held: &&str| *held == next || (alike(next).is_some() && alike(held) == alike(next));
            if hand.iter().any(clashes) {
                place += 1;
            } else {
                hand.push(self.left.remove(place));
            }
        }
        hand.into_iter().map(str::to_owned).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn campaign(seed: u64, cases: usize, lifelike: bool) -> Campaign {
        Campaign { seed, cases, lifelike, urdf_error: None }
    }

    #[test]
    fn shares_of_kinds_and_families_are_as_documented() {
        for lifelike in [false, true] {
            let plans = campaign(7, 300, lifelike).plans();
            let count = |holds: &dyn Fn(&CasePlan) -> bool| plans.iter().filter(|plan| holds(plan)).count();
            assert_eq!(count(&|plan| plan.effects.is_empty()), 100);
            assert_eq!(count(&|plan| plan.effects.iter().any(|name| crate::is_outside(name))), 30);
            assert_eq!(count(&|plan| plan.hard), 150);
            assert!(count(&|plan| !plan.background_friction) <= 75);
            for sigma in SIGMAS {
                assert_eq!(count(&|plan| plan.urdf_error == sigma), 75);
            }
            let real = usize::from(lifelike);
            assert_eq!(count(&|plan| plan.lifelike), 150 * real);
            assert!(plans.iter().all(|plan| plan.background_friction || !plan.lifelike));
            assert!((5 * real..=150 * real).contains(&count(&|plan| plan.effects.len() == 5)));
            let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
            for name in plans.iter().flat_map(|plan| &plan.effects) {
                *counts.entry(name).or_default() += 1;
            }
            assert_eq!(counts.len(), families().len() + outside().len());
            let of = |names: &[&str]| {
                let list = || names.iter().map(|name| counts[name]);
                list().max().unwrap_or(0) - list().min().unwrap_or(0)
            };
            assert!(of(&outside()) <= 1 && of(&families()) <= 3, "{counts:?}");
        }
    }

    #[test]
    fn a_plan_depends_on_the_seed_alone() {
        let campaign = |seed: u64| campaign(seed, 30, true);
        assert_eq!(campaign(1).plans(), campaign(1).plans());
        assert_eq!(campaign(1).case(3), campaign(1).plans().into_iter().nth(3));
        assert_eq!(campaign(1).case(30), None);
        assert_ne!(campaign(1).plans(), campaign(2).plans());
        let same = Campaign { urdf_error: Some(0.1), ..campaign(1) };
        assert!(same.plans().iter().all(|plan| plan.urdf_error == 0.1));
    }
}
