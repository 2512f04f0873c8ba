"""Learned models of today on the paper's tasks: a Lagrangian-inspired polynomial kernel, and a small network on the residual.

    testbed transfer --samples /tmp/tasks
    python benches/models/models.py /tmp/tasks kernel
    python benches/models/models.py /tmp/tasks network

A third argument, A or ABC, is the training set; both without.

Prints the mean squared torque error on task D, joint by joint, after training on A and on A, B and C. Seeds: 0 to 4 for the network;
the kernel's fit has no random part. requirements.txt has the versions.
"""

import sys
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor
from sklearn.preprocessing import StandardScaler

DOF = 6

# Logarithms of hyperparameters may differ by so much from where they begin.
RANGE = 8.0

# Two ways to fit, because the result depends on it: relative noise variance, and iterations.
FITS = [(1e-8, 40), (1e-10, 15)]


def load(folder, tasks):
    rows = np.vstack([np.loadtxt(Path(folder) / f"{task}.csv", delimiter=",", skiprows=1) for task in tasks])
    return [rows[:, part * DOF : (part + 1) * DOF] for part in range(5)]


class Lagrangian:
    """Torques whose kinetic and potential energy are Gaussian processes with polynomial kernels.

    Giacomuzzo, Carli, Romeres, Dalla Libera 2024, "A Black-Box Physics-Informed Estimator based on Gaussian Process Regression for
    Robot Inverse Dynamics Identification", IEEE Transactions on Robotics, section IV: of link i, the kinetic energy is
    quadratic in the velocities of the joints up to i and of second order in the cosine and sine of each of their angles, the
    potential energy of first order in them; one variance a link, energy and (kinetic) joint, one weight a joint of cosine and
    sine against the constant. Kernels of torques follow by the Lagrange equations, here by hand.
    """

    def __init__(self):
        self.sigma = np.zeros((DOF, DOF))  # logs: kinetic, link i, joint c <= i
        self.kinetic = np.zeros(DOF)  # logs: weight of cosine and sine
        self.potential = np.zeros(DOF)
        self.gravity = np.zeros(DOF)  # logs: variance of each link's potential energy

    def kernel(self, a, b):
        """K[n, j, m, l], between the torques of joints j and l at the samples n of a and m of b; a = (q, qd, qdd)."""
        q, p, acc = (x[:, None, :] for x in a)
        q2, p2, acc2 = (x[None, :, :] for x in b)
        delta = q - q2
        cosine, sine = np.cos(delta), np.sin(delta)
        total = np.zeros((delta.shape[0], DOF, delta.shape[1], DOF))
        weight = np.exp(self.kinetic)
        base = 1 + weight * cosine
        norm = (1 + weight) ** 2
        g0 = base**2 / norm
        g1 = -2 * base * weight * sine / norm
        g2 = (2 * (weight * sine) ** 2 - 2 * base * weight * cosine) / norm
        u = np.exp(self.potential)
        h0 = (1 + u * cosine) / (1 + u)
        h1 = -u * sine / (1 + u)
        h2 = -u * cosine / (1 + u)
        for link in range(DOF):
            joints = range(link + 1)
            # Products over the joints with none, one or two factors replaced by their derivatives.
            def product(factors, first=None, second=None, which=(g0, g1, g2)):
                result = np.ones(delta.shape[:2])
                for c in joints:
                    order = (c == first) + (c == second)
                    result = result * which[order][:, :, c]
                return result

            sigma = np.exp(self.sigma[link])
            s = sum(sigma[c] * p[:, :, c] * p2[:, :, c] for c in joints)
            s_t = sum(sigma[c] * acc[:, :, c] * p2[:, :, c] for c in joints)
            s_u = sum(sigma[c] * p[:, :, c] * acc2[:, :, c] for c in joints)
            s_tu = sum(sigma[c] * acc[:, :, c] * acc2[:, :, c] for c in joints)
            g = product(joints)
            gb = [product(joints, c) for c in joints]
            gbc = {}
            for c in joints:
                for d in range(c + 1):
                    gbc[c, d] = gbc[d, c] = product(joints, c, d)
            g_t = sum(p[:, :, c] * gb[c] for c in joints)
            g_u = sum(p2[:, :, c] * gb[c] for c in joints)
            g_tu = sum(p[:, :, c] * p2[:, :, d] * gbc[c, d] for c in joints for d in joints)
            for j in joints:
                gj_u = sum(p2[:, :, c] * gbc[j, c] for c in joints)
                for l in joints:
                    gl_t = sum(p[:, :, c] * gbc[c, l] for c in joints)
                    value = 2 * sigma[j] * sigma[l] * (
                        acc2[:, :, j] * (acc[:, :, l] * g + p[:, :, l] * g_t)
                        - p2[:, :, j] * (acc[:, :, l] * g_u + p[:, :, l] * g_tu)
                    )
                    value = value - 2 * sigma[l] * p[:, :, l] * (s_u * gb[j] - s * gj_u)
                    value = value + 2 * sigma[j] * p2[:, :, j] * (s_t * gb[l] + s * gl_t) - s * s * gbc[j, l]
                    if j == l:
                        value = value + 2 * sigma[j] * (s_tu * g - s_t * g_u + s_u * g_t - s * g_tu)
                    total[:, j, :, l] += value
            v = np.exp(self.gravity[link])
            for j in joints:
                for l in joints:
                    total[:, j, :, l] -= v * product(joints, j, l, which=(h0, h1, h2))
        return total

    def parameters(self):
        lower = np.tril_indices(DOF)
        return np.concatenate([self.sigma[lower], self.kinetic, self.potential, self.gravity])

    def set(self, values):
        count = DOF * (DOF + 1) // 2
        self.sigma[np.tril_indices(DOF)] = values[:count]
        self.kinetic, self.potential, self.gravity = np.split(values[count:], 3)

    def fit(self, inputs, torques, noise, thin, iterations):
        """Maximum marginal likelihood on every `thin`-th sample; torques are divided by their deviation, joint by joint."""
        self.scale = torques.std(axis=0)
        # A link's energies begin at the size of the torques of its joint.
        self.sigma[:] = np.log(self.scale)[:, None]
        self.gravity[:] = 2 * np.log(self.scale)
        few = [x[::thin] for x in inputs]
        y = (torques[::thin] / self.scale).ravel()

        def matrix(a, b):
            k = self.kernel(a, b) / self.scale[None, :, None, None] / self.scale[None, None, None, :]
            return k.reshape(len(a[0]) * DOF, len(b[0]) * DOF)

        def cost(values):
            self.set(values)
            k = matrix(few, few)
            k[np.diag_indices_from(k)] += noise * np.trace(k) / len(k)
            try:
                factor = cho_factor(k, lower=True)
            except np.linalg.LinAlgError:
                return 1e10
            alpha = cho_solve(factor, y)
            amplitude = y @ alpha / len(y)
            return np.log(np.diag(factor[0])).sum() + 0.5 * len(y) * np.log(amplitude)

        start = self.parameters()
        bounds = [(value - RANGE, value + RANGE) for value in start]
        found = minimize(cost, start, method="L-BFGS-B", bounds=bounds, options={"maxiter": iterations})
        self.set(found.x)
        self.matrix = matrix
        self.at_bounds = int((np.abs(np.abs(found.x - start) - RANGE) < 1e-3).sum())
        return found.fun

    def condition(self, inputs, torques, noise):
        self.inputs = inputs
        k = self.matrix(inputs, inputs)
        k[np.diag_indices_from(k)] += noise * np.trace(k) / len(k)
        self.alpha = cho_solve(cho_factor(k, lower=True, overwrite_a=True), (torques / self.scale).ravel())

    def predict(self, inputs):
        out = []
        for part in range(0, len(inputs[0]), 100):
            k = self.matrix([x[part : part + 100] for x in inputs], self.inputs)
            out.append((k @ self.alpha).reshape(-1, DOF) * self.scale)
        return np.vstack(out)


def check_kernel():
    """The torques' kernel is the operator of Lagrange's equations on both sides of the energies': by differences, once."""
    rng = np.random.default_rng(0)
    model = Lagrangian()
    model.set(rng.normal(size=len(model.parameters())) * 0.3)
    states = [rng.normal(size=(2, DOF)) for _ in range(3)]
    k = model.kernel([x[:1] for x in states], [x[1:] for x in states])[0, :, 0, :]

    def energy(q, p, q2, p2):
        total = 0.0
        for link in range(DOF):
            c = slice(0, link + 1)
            delta = np.cos(q[c] - q2[c])
            w, u = np.exp(model.kinetic[c]), np.exp(model.potential[c])
            s = (np.exp(model.sigma[link, c]) * p[c] * p2[c]).sum()
            total += s * s * np.prod(((1 + w * delta) / (1 + w)) ** 2)
            total += np.exp(model.gravity[link]) * np.prod((1 + u * delta) / (1 + u))
        return total

    def lagrange(f, q, p, acc, j):
        """d/dt df/dp_j - df/dq_j by central differences."""
        h = 1e-3
        unit = np.eye(DOF)[j]
        def momentum(t):
            qt, pt = q + t * p + t * t / 2 * acc, p + t * acc
            return (f(qt, pt + h * unit) - f(qt, pt - h * unit)) / (2 * h)
        force = (f(q + h * unit, p) - f(q - h * unit, p)) / (2 * h)
        return (momentum(h) - momentum(-h)) / (2 * h) - force

    (q, q2), (p, p2), (acc, acc2) = states
    for j, l in [(0, 0), (1, 1), (2, 4), (5, 3), (5, 5)]:
        inner = lambda a, b: lagrange(lambda c, d: energy(a, b, c, d), q2, p2, acc2, l)
        difference = lagrange(inner, q, p, acc, j)
        assert abs(difference - k[j, l]) < 1e-3 * np.abs(k).max(), (j, l, difference, k[j, l])


def line(name, error, note):
    joints = " | ".join(f"{value:.3g}" for value in (error**2).mean(axis=0))
    print(f"| {name} | {joints} | {(error**2).mean():.3g} | {note} |", flush=True)


def main():
    folder, which = sys.argv[1:3]
    check_kernel()
    q, qd, qdd, tau, rigid = load(folder, "D")
    test = [q, qd, qdd]
    print("| model | 1 | 2 | 3 | 4 | 5 | 6 | mean | |\n|---|---|---|---|---|---|---|---|---|")
    for tasks in sys.argv[3:] or ["A", "ABC"]:
        inputs = load(folder, tasks)
        motion, torques, left = inputs[:3], inputs[3], inputs[3] - inputs[4]
        thin, few = (4, 40) if tasks == "ABC" else (2, 16)
        if which == "kernel":
            for noise, iterations in FITS:
                for name, targets, base in [("whole torque", torques, 0 * tau), ("residual", left, rigid)]:
                    began = time.process_time()
                    model = Lagrangian()
                    model.fit(motion, targets, noise, few, iterations)
                    model.condition([x[::thin] for x in motion], targets[::thin], 1e-12)
                    used = time.process_time() - began
                    error = tau - base - model.predict(test)
                    line(
                        f"Lagrangian kernel, {name}, {tasks}, fitted with noise {noise:g} in {iterations} iterations",
                        error,
                        f"{used:.0f} s, {model.at_bounds} parameters at bounds",
                    )
            continue
        x = StandardScaler().fit(np.hstack(motion))
        y = StandardScaler().fit(left)
        for seed in range(5):
            began = time.process_time()
            network = MLPRegressor(hidden_layer_sizes=(64, 64), activation="tanh", max_iter=2000, tol=1e-7, n_iter_no_change=100, random_state=seed)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                network.fit(x.transform(np.hstack(motion)), y.transform(left))
            learned = y.inverse_transform(network.predict(x.transform(np.hstack(test))))
            line(f"network on the residual, {tasks}, seed {seed}", tau - rigid - learned, f"{time.process_time() - began:.0f} s")


if __name__ == "__main__":
    main()
