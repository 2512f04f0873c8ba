#!/usr/bin/env python3
"""Writes reference.json: scikit-learn's likelihood, mean and variance at given hyperparameters; and the same in 80-bit arithmetic.

The 80-bit values say how far scikit-learn itself is off where the matrix is ill-conditioned. They need a machine whose long double has 80 bits.

usage: reference.py > reference.json          (needs: pip install scikit-learn numpy)
"""
import json, os, sys
os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np, sklearn
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

rng = np.random.default_rng(20250101)

def trajectory(n, dim, speed):
    """Smooth joint-like motion: each input a sum of two sines of time."""
    t = np.arange(n) / 80.0
    w = rng.uniform(0.5, 1.5, (dim, 2)) * speed; p = rng.uniform(0, 2 * np.pi, (dim, 2)); a = rng.uniform(0.3, 1.2, (dim, 2))
    return np.stack([(a[d, :, None] * np.sin(w[d, :, None] * t + p[d, :, None])).sum(0) for d in range(dim)], 1)

def target(x): return np.sin(x[:, 0]) * 3 + np.cos(1.7 * x[:, -1]) * x[:, 0] + 0.3 * x.sum(1)

def exact(x, y, amplitude, lengths, noise, at):
    """Rasmussen and Williams 2006, algorithm 2.1, in 80-bit arithmetic: likelihood and mean."""
    wide = np.longdouble; n = len(y); scaled = lambda a: a.astype(wide) / np.asarray(lengths, wide)
    kernel = lambda a, b: wide(amplitude)**2 * np.exp(-((a[:, None] - b[None])**2).sum(-1) / 2)
    c = kernel(scaled(x), scaled(x)); c[np.arange(n), np.arange(n)] += wide(noise)**2
    w = np.concatenate([y.astype(wide)[:, None], kernel(scaled(x), scaled(at))], 1)
    for j in range(n):
        c[j, j] = np.sqrt(c[j, j]); c[j+1:, j] /= c[j, j]; c[j+1:, j+1:] -= np.outer(c[j+1:, j], c[j+1:, j])
        w[j] /= c[j, j]; w[j+1:] -= np.outer(c[j+1:, j], w[j])
    return -(w[:, 0] @ w[:, 0]) / 2 - np.log(np.diag(c)).sum() - n / wide(2) * np.log(2 * wide(np.pi)), w[:, 1:].T @ w[:, 0]

def case(name, x, amplitude, lengths, noise, tests=12):
    y = target(x) + noise * rng.standard_normal(len(x))
    at = np.concatenate([x[rng.integers(0, len(x), tests)] + 0.05 * rng.standard_normal((tests, x.shape[1])), x[:2], x[:2] + 100.0])
    g = GaussianProcessRegressor(ConstantKernel(amplitude**2) * RBF(lengths), alpha=noise**2, optimizer=None).fit(x, y)
    mean, deviation = g.predict(at, return_std=True)
    exact_likelihood, exact_mean = exact(x, y, amplitude, lengths, noise, at)
    flat = lambda a: [float(v) for v in np.asarray(a).ravel()]
    return dict(name=name, dim=x.shape[1], inputs=flat(x), targets=flat(y), amplitude=amplitude, lengths=lengths, noise=noise,
                log_marginal_likelihood=float(g.log_marginal_likelihood_value_), at=flat(at), mean=flat(mean), variance=flat(deviation**2),
                exact_log_marginal_likelihood=float(exact_likelihood), exact_mean=flat(exact_mean))

cases = [
    case("isotropic, noise 1e-2, scattered", rng.uniform(-2, 2, (120, 3)), 2.0, 1.5, 1e-2),
    case("isotropic, noise 1e-2, short length: full rank", rng.uniform(-2, 2, (120, 3)), 2.0, 0.3, 1e-2),
    case("one length an input, noise 1e-3, scattered", rng.uniform(-2, 2, (150, 4)), 3.0, [1.0, 4.0, 8.0, 2.0], 1e-3),
    case("isotropic, noise 1e-3, trajectory", trajectory(300, 3, 2.0), 2.0, 1.2, 1e-3),
    case("one length an input, noise 1e-3, trajectory", trajectory(300, 6, 3.0), 5.0, [3.0, 2.0, 10.0, 5.0, 8.0, 2.5], 1e-3),
    case("isotropic, noise 1e-2, one input", trajectory(200, 1, 4.0), 1.0, 0.5, 1e-2),
    case("one length an input, noise 1e-4, trajectory", trajectory(300, 6, 3.0), 5.0, [3.0, 2.0, 10.0, 5.0, 8.0, 2.5], 1e-4),
    case("isotropic, noise variance 1e-9 of amplitude squared, trajectory: condition number near 1e11", trajectory(300, 3, 2.0), 4.0, 3.0, 4.0 * 10**-4.5),
]
json.dump(dict(scikit_learn=sklearn.__version__, numpy=np.__version__, cases=cases), sys.stdout)
print()
