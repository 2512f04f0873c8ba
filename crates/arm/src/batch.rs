//! The algorithms over many states, several at a time: one in each lane of the processor's vectors.
//!
//! Signals are stored joint after joint: with `samples` states, joint `i` of state `k` is at index `i * samples + k`.
//! Matrices are stored in the same way, entry after entry. The results have the same bits as those of one state at a
//! time, on every processor (see `real`). A call allocates its scratch once, whatever the number of states.

use pulp::{Arch, Simd, WithSimd};

use crate::model::Arm;
use crate::real::{Lanes, Real};
use crate::regressor::PARAMETERS_PER_LINK;
use crate::scratch::Scratch;

impl Arm {
    /// [`Arm::inverse_dynamics`] for many states; all slices are stored joint after joint.
    ///
    /// # Panics
    /// If the slices differ in length, or the length is not a multiple of the number of joints.
    pub fn inverse_dynamics_batch(&self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.evaluate(InverseDynamics, [q, qd, qdd], [(tau, 1)]);
    }

    /// [`Arm::forward_dynamics`] for many states; all slices are stored joint after joint.
    ///
    /// # Panics
    /// If the slices differ in length, or the length is not a multiple of the number of joints.
    pub fn forward_dynamics_batch(&self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        self.evaluate(ForwardDynamics, [q, qd, tau], [(qdd, 1)]);
    }

    /// [`Arm::mass_matrix`] for many states: entry (i, j) of state `k` is at index `(j * dof + i) * samples + k`.
    ///
    /// # Panics
    /// If the size of a slice does not match that of `q`.
    pub fn mass_matrix_batch(&self, q: &[f64], mass_matrix: &mut [f64]) {
        self.evaluate(MassMatrix, [q], [(mass_matrix, self.dof())]);
    }

    /// [`Arm::torque_regressor`] for many states: row `i`, column `c` of state `k` is at index `(c * dof + i) *
    /// samples + k`.
    ///
    /// The rows of joints beyond a column's link are zero in every state and are not written: pass a `regressor`
    /// filled with zeros. A state has 10 dof² numbers; about a hundred states at a time stay in the processor's
    /// caches.
    ///
    /// # Panics
    /// If the size of a slice does not match that of `q`.
    pub fn torque_regressor_batch(&self, q: &[f64], qd: &[f64], qdd: &[f64], regressor: &mut [f64]) {
        let width = PARAMETERS_PER_LINK * self.dof();
        self.evaluate(Regressor, [q, qd, qdd], [(regressor, width)]);
    }

    /// The derivatives ∂τ/∂q and ∂τ/∂q̇ of [`Arm::inverse_dynamics`] for many states. Entry (i, j) of state `k` is the
    /// derivative of τ_i with respect to joint j (N m or N per rad or m, and per rad/s or m/s), at index `(j * dof + i) *
    /// samples + k`. ∂τ/∂q̈ is the mass matrix.
    ///
    /// # Panics
    /// If the size of a slice does not match that of `q`.
    pub fn inverse_dynamics_derivatives_batch(
        &self,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        by_position: &mut [f64],
        by_velocity: &mut [f64],
    ) {
        let n = self.dof();
        self.evaluate(Derivatives, [q, qd, qdd], [(by_position, n), (by_velocity, n)]);
    }

    /// Runs `recursion` over all states. Each output is given with its number of values per joint.
    fn evaluate<R: Recursion, const I: usize, const O: usize>(
        &self,
        recursion: R,
        inputs: [&[f64]; I],
        outputs: [(&mut [f64], usize); O],
    ) {
        let len = inputs[0].len();
        assert_eq!(len % self.dof(), 0, "a signal has as many states for each joint");
        for input in inputs {
            assert_eq!(input.len(), len, "the signals have one length");
        }
        for (output, width) in &outputs {
            assert_eq!(output.len(), len * width, "the output has a place for each state");
        }
        let samples = len / self.dof();
        if samples > 0 {
            Arch::new().dispatch(Evaluation {
                arm: self,
                recursion,
                samples,
                inputs,
                outputs: outputs.map(|(output, _)| output),
            });
        }
    }
}

/// One of the arm's recursions, for any type of number.
trait Recursion {
    /// Whether this entry of the output is zero in every state, so that it is not written.
    fn is_zero(&self, _dof: usize, _entry: usize) -> bool {
        false
    }

    /// Computes one state, or one vector of states. The signals in `inputs` follow each other, as do those in
    /// `output`, which holds zeros at first.
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]);
}

struct InverseDynamics;

impl Recursion for InverseDynamics {
    #[inline(always)]
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]) {
        let [q, qd, qdd] = thirds(inputs);
        arm.newton_euler(context, scratch, q, qd, qdd, output);
    }
}

struct ForwardDynamics;

impl Recursion for ForwardDynamics {
    #[inline(always)]
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]) {
        let [q, qd, tau] = thirds(inputs);
        arm.articulated_bodies(context, scratch, q, qd, tau, output);
    }
}

struct MassMatrix;

impl Recursion for MassMatrix {
    #[inline(always)]
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]) {
        arm.composite_bodies(context, scratch, inputs, output);
    }
}

struct Regressor;

impl Recursion for Regressor {
    fn is_zero(&self, dof: usize, entry: usize) -> bool {
        let (row, column) = (entry % dof, entry / dof);
        row > column / PARAMETERS_PER_LINK
    }

    #[inline(always)]
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]) {
        let [q, qd, qdd] = thirds(inputs);
        arm.link_powers(context, scratch, q, qd, qdd, output);
    }
}

struct Derivatives;

impl Recursion for Derivatives {
    #[inline(always)]
    fn run<T: Real>(&self, arm: &Arm, context: T::Context, scratch: &mut Scratch<T>, inputs: &[T], output: &mut [T]) {
        let [q, qd, qdd] = thirds(inputs);
        let (by_position, by_velocity) = output.split_at_mut(arm.dof() * arm.dof());
        arm.tangents(context, scratch, q, qd, qdd, by_position, by_velocity);
    }
}

#[inline(always)]
fn thirds<T>(values: &[T]) -> [&[T]; 3] {
    let (a, rest) = values.split_at(values.len() / 3);
    let (b, c) = rest.split_at(a.len());
    [a, b, c]
}

struct Evaluation<'a, R, const I: usize, const O: usize> {
    arm: &'a Arm,
    recursion: R,
    samples: usize,
    inputs: [&'a [f64]; I],
    outputs: [&'a mut [f64]; O],
}

impl<R: Recursion, const I: usize, const O: usize> WithSimd for Evaluation<'_, R, I, O> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { arm, recursion, samples, .. } = self;
        let zero = Lanes::constant(simd, 0.0);
        let mut scratch = Scratch::new(simd, arm.dof());
        let columns = self.inputs.iter().flat_map(|input| input.chunks_exact(samples));
        let inputs: Vec<&[f64]> = columns.collect();
        let columns = self.outputs.into_iter().flat_map(|output| output.chunks_exact_mut(samples));
        let mut outputs: Vec<(usize, &mut [f64])> = columns.enumerate().collect();
        let mut output = vec![zero; outputs.len()];
        outputs.retain(|(entry, _)| !recursion.is_zero(arm.dof(), *entry));
        let mut input = vec![zero; inputs.len()];
        for start in (0..samples).step_by(S::F64_LANES) {
            // The lanes after the last state hold zeros; their results are not used.
            let states = start..samples.min(start + S::F64_LANES);
            for (lanes, column) in input.iter_mut().zip(&inputs) {
                let column = &column[states.clone()];
                lanes.values = match S::as_simd_f64s(column) {
                    ([values], []) => *values,
                    _ => simd.partial_load_f64s(column),
                };
            }
            recursion.run(arm, simd, &mut scratch, &input, &mut output);
            for (entry, column) in &mut outputs {
                let values = output[*entry].values;
                let column = &mut column[states.clone()];
                match S::as_mut_simd_f64s(column) {
                    ([at], []) => *at = values,
                    _ => simd.partial_store_f64s(column, values),
                }
            }
        }
    }
}
