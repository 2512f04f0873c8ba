//! The task's reference at every tick of 1 ms, preceded by a smooth start from rest.

use crate::scenario::Scenario;
use torque::Motion;

/// The period of the machine's ticks (s).
pub const TICK: f64 = 1e-3;
/// The duration of the start from rest to the task's speed (s).
const RUN_IN: f64 = 3.0;
/// The number of ticks beyond the end for which delayed drives need commands: the longest delay that can be injected.
const BEYOND: usize = 128;

/// Positions, velocities and accelerations; `[tick × dof + joint]`, rad or m.
pub struct Table {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
}

/// The motion to be tracked.
pub struct Course {
    /// Joints.
    pub dof: usize,
    /// The time of the first tick, on the recordings' clock (s).
    pub begin: f64,
    /// Ticks before the task begins.
    pub run_in: usize,
    /// Ticks in all.
    pub ticks: usize,
    /// At the ticks.
    pub at: Table,
    /// The reference in the middle between each tick and the next, at which a torque that is held for the tick is exact. It
    /// continues for [`BEYOND`] ticks.
    pub middle: Table,
}

impl Course {
    /// The reference of `task`, which begins at `start` (s, on the recordings' clock).
    pub fn new(task: &Scenario, start: f64) -> Self {
        let run_in = (RUN_IN / TICK).round() as usize;
        let ticks = run_in + (task.duration / TICK).round() as usize;
        Self {
            dof: task.arm.dof(),
            begin: start - RUN_IN,
            run_in,
            ticks,
            at: table(task, ticks, 0.0),
            middle: table(task, ticks + BEYOND, 0.5),
        }
    }

    /// The time of a tick on the task's clock (s); negative during the start from rest.
    #[cfg(any(test, feature = "viewer"))]
    pub fn time(&self, tick: usize) -> f64 {
        tick as f64 * TICK - RUN_IN
    }

    /// The time on the recordings' clock in the middle after a tick (s).
    pub fn middle_time(&self, tick: usize) -> f64 {
        self.begin + (tick as f64 + 0.5) * TICK
    }
}

fn table(task: &Scenario, ticks: usize, after: f64) -> Table {
    let dof = task.arm.dof();
    let with = || Vec::with_capacity(ticks * dof);
    let mut table = Table { q: with(), qd: with(), qdd: with() };
    let mut motion = Motion::new(dof);
    for tick in 0..ticks {
        let [along, rate, change] = way((tick as f64 + after) * TICK - RUN_IN);
        task.reference.at(along, &mut motion);
        table.q.extend_from_slice(&motion.q);
        for (qd, qdd) in motion.qd.iter().zip(&motion.qdd) {
            table.qd.push(qd * rate);
            table.qdd.push(qdd * rate * rate + qd * change);
        }
    }
    table
}

/// The time on the task's clock at which the reference is evaluated at `time` (s), with its first and second derivative. It
/// starts at rest and reaches the rate of one at time 0.
fn way(time: f64) -> [f64; 3] {
    if time >= 0.0 {
        return [time, 1.0, 0.0];
    }
    let x = 1.0 + time / RUN_IN;
    let rate = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    let change = 30.0 * x * x * (1.0 - x) * (1.0 - x) / RUN_IN;
    // The integral of the rate, which is half of the elapsed time when the task begins.
    let along = RUN_IN * (x.powi(4) * (2.5 + x * (x - 3.0)) - 0.5);
    [along, rate, change]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The start from rest into the task has no jump; velocities and accelerations are the derivatives of positions.
    #[test]
    fn the_start_of_the_task_is_smooth() {
        let task = Scenario::built_in("taskD").expect("it comes with the program");
        let course = Course::new(&task, 90.0);
        let n = course.dof;
        assert_eq!((course.begin, course.time(course.run_in)), (87.0, 0.0));
        assert!(course.at.qd[..n].iter().chain(&course.at.qdd[..n]).all(|rate| *rate == 0.0));
        for tick in 1..course.ticks - 1 {
            for j in 0..n {
                let [before, here, after] = [tick - 1, tick, tick + 1].map(|tick| course.at.q[tick * n + j]);
                let qd = (after - before) / (2.0 * TICK);
                let qdd = (after - 2.0 * here + before) / (TICK * TICK);
                assert!((qd - course.at.qd[tick * n + j]).abs() < 1e-5);
                assert!((qdd - course.at.qdd[tick * n + j]).abs() < 2e-2);
            }
        }
    }
}
