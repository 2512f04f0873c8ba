//! Which cases there are: robots, difficulty and families, decided before anything is simulated.

use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::fault::{Fault, families, outside};
use crate::robot::Robot;

/// Cases drawn from a seed: a third hold nothing but ordinary friction, a tenth something outside the catalogue, the others one to
/// three effects of it, every family about as often; half are easy, half hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Campaign {
    /// What everything is drawn from.
    pub seed: u64,
    /// How many cases there are.
    pub cases: usize,
}

/// What a case is to be, before sizes are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CasePlan {
    /// The case's place in its campaign, from 0.
    pub index: usize,
    /// Its name, that of its folder.
    pub name: String,
    /// What its sizes, motions and noise are drawn from.
    pub seed: u64,
    /// Whether it is of the harder kind: 100 to 500 Hz and sometimes 1 kHz, stamps that jitter, rows lost, functional forms that are not
    /// the textbook's, smaller effects, two training recordings instead of three.
    pub hard: bool,
    /// Whether every joint has ordinary Coulomb and viscous friction.
    pub background_friction: bool,
    /// Names of the effects.
    pub effects: Vec<String>,
}

impl Campaign {
    /// The plan of case `index`, or of none if there are not so many.
    pub fn case(&self, index: usize) -> Option<CasePlan> {
        self.plans().into_iter().nth(index)
    }

    /// The plans of all cases.
    pub fn plans(&self) -> Vec<CasePlan> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let count = |part: f64| (self.cases as f64 * part).round() as usize;
        let (ordinary, unknown) = (count(1.0 / 3.0), count(0.1));
        let mut outside = Deck::new(outside());
        let mut families = Deck::new(families());
        let mut effects: Vec<Vec<String>> = vec![Vec::new(); ordinary];
        effects.extend((0..unknown).map(|_| vec![outside.next(&mut random).to_owned()]));
        while effects.len() < self.cases {
            let size = *[1, 2, 2, 3].choose(&mut random).unwrap_or(&1);
            effects.push(families.hand(size, &mut random));
        }
        // Where friction is and how hard a case is has nothing to do with what is in it.
        let mut quarters: Vec<bool> = (0..self.cases).map(|i| i % 4 != 0).collect();
        let mut halves: Vec<bool> = (0..self.cases).map(|i| i % 2 == 1).collect();
        effects.shuffle(&mut random);
        quarters.shuffle(&mut random);
        halves.shuffle(&mut random);
        let digits = self.cases.saturating_sub(1).to_string().len().max(3);
        let cases = effects.into_iter().zip(quarters).zip(halves).enumerate();
        cases
            .map(|(index, ((effects, background_friction), hard))| CasePlan {
                index,
                name: format!("case_{index:0digits$}"),
                // Fits the integers of any JSON reader.
                seed: random.random::<u64>() >> 11,
                hard,
                background_friction,
                effects,
            })
            .collect()
    }
}

impl CasePlan {
    /// The robot of this case: they take turns; where the inertia of a drive is concealed, it is one whose drives have none to
    /// begin with, if there is one.
    ///
    /// # Panics
    /// If there are no robots.
    pub fn robot<'a>(&self, robots: &'a [Robot]) -> &'a Robot {
        let turn = self.index % robots.len();
        let needs_plain = self.effects.iter().any(|effect| effect == "rotor_inertia");
        let from_here = (0..robots.len()).map(|k| &robots[(turn + k) % robots.len()]);
        from_here
            .into_iter()
            .find(|robot| !(needs_plain && robot.has_rotors()))
            .unwrap_or(&robots[turn])
    }
}

/// Names that come round equally often, in another order every time.
struct Deck {
    names: Vec<&'static str>,
    left: Vec<&'static str>,
}

impl Deck {
    fn new(names: Vec<&'static str>) -> Self {
        Self {
            names,
            left: Vec::new(),
        }
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

    /// The next `size` names that can be together; those that cannot wait.
    fn hand(&mut self, size: usize, random: &mut impl Rng) -> Vec<String> {
        self.fill(3 * self.names.len(), random);
        let mut hand: Vec<&str> = Vec::new();
        let mut place = 0;
        while hand.len() < size {
            let next = self.left[place];
            let alike = |name: &str| Fault::named(name).and_then(|fault| fault.alone_among);
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

    #[test]
    fn cases_are_shared_out_as_promised() {
        let plans = Campaign { seed: 7, cases: 300 }.plans();
        let count = |holds: &dyn Fn(&CasePlan) -> bool| plans.iter().filter(|plan| holds(plan)).count();
        assert_eq!(count(&|plan| plan.effects.is_empty()), 100);
        assert_eq!(
            count(&|plan| plan.effects.iter().any(|name| name.ends_with("_unknown"))),
            30
        );
        assert_eq!(count(&|plan| plan.hard), 150);
        assert_eq!(count(&|plan| !plan.background_friction), 75);
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

    #[test]
    fn a_plan_depends_on_the_seed_alone() {
        let campaign = Campaign { seed: 1, cases: 30 };
        assert_eq!(campaign.plans(), campaign.plans());
        assert_eq!(campaign.case(3), campaign.plans().into_iter().nth(3));
        assert_eq!(campaign.case(30), None);
        assert_ne!(campaign.plans(), Campaign { seed: 2, cases: 30 }.plans());
    }
}
