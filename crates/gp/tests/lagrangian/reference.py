"""Figures of the reference implementation in benches/models, for crates/gp/src/lagrangian/tests.rs.

    python crates/gp/tests/lagrangian/reference.py > crates/gp/tests/lagrangian/reference.json

A revolute arm of three joints with random hyperparameters: a block of its covariance, and torques predicted from seven samples of
random torques. Versions: benches/models/requirements.txt.
"""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[4] / "benches/models"))
import models  # noqa: E402

models.DOF = 3
rng = np.random.default_rng(3)
model = models.Lagrangian()
model.set(0.7 * rng.normal(size=len(model.parameters())))
motion = [rng.normal(size=(9, 3)) for _ in range(3)]
torques = rng.normal(size=(7, 3)) * [1.0, 5.0, 0.1]
train, test = [x[:7] for x in motion], [x[7:] for x in motion]
covariance = model.kernel([x[:1] for x in train], [x[1:2] for x in train])[0, :, 0, :]
model.scale = torques.std(axis=0)


def matrix(a, b):
    k = model.kernel(a, b) / model.scale[None, :, None, None] / model.scale[None, None, None, :]
    return k.reshape(len(a[0]) * 3, len(b[0]) * 3)


model.matrix = matrix
noise = 1e-4
model.condition(train, torques, noise)
lower = np.tril_indices(3)
weight = lambda w: (np.exp(w) / (1 + np.exp(w))).tolist()
print(
    json.dumps(
        {
            "kinetic": np.exp(model.sigma[lower]).tolist(),
            "potential": np.exp(model.gravity).tolist(),
            "kinetic_share": weight(model.kinetic),
            "potential_share": weight(model.potential),
            "noise": noise,
            "units": model.scale.tolist(),
            "motion": [x.ravel().tolist() for x in motion],
            "torques": torques.ravel().tolist(),
            "covariance": covariance.ravel().tolist(),
            "predicted": model.predict(test).ravel().tolist(),
        }
    )
)
