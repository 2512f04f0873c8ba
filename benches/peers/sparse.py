"""GPyTorch's stochastic variational Gaussian process on the CPU. usage: sparse.py TRAIN.csv TEST.csv INDUCING EPOCHS"""

import json
import sys
import time

import gpytorch
import numpy as np
import torch


class Model(gpytorch.models.ApproximateGP):
    def __init__(self, points):
        chosen = gpytorch.variational.CholeskyVariationalDistribution(points.size(0))
        strategy = gpytorch.variational.VariationalStrategy(self, points, chosen, learn_inducing_locations=True)
        super().__init__(strategy)
        self.mean = gpytorch.means.ConstantMean()
        self.kernel = gpytorch.kernels.ScaleKernel(gpytorch.kernels.RBFKernel(ard_num_dims=points.size(1)))

    def forward(self, x):
        return gpytorch.distributions.MultivariateNormal(self.mean(x), self.kernel(x))


def main():
    torch.manual_seed(0)
    torch.set_num_threads(1)
    train, test = (np.loadtxt(path, delimiter=",", skiprows=1) for path in sys.argv[1:3])
    inducing, epochs = int(sys.argv[3]), int(sys.argv[4])
    scale = train.std(axis=0)
    scale[scale == 0] = 1.0
    middle = train.mean(axis=0)
    tables = [torch.tensor((table - middle) / scale, dtype=torch.float32) for table in (train, test)]
    (x, y), (x_test, y_test) = ((table[:, :-1], table[:, -1]) for table in tables)
    begun = time.process_time()
    model = Model(x[torch.randperm(len(x))[:inducing]].clone())
    likelihood = gpytorch.likelihoods.GaussianLikelihood()
    objective = gpytorch.mlls.VariationalELBO(likelihood, model, num_data=len(y))
    optimizer = torch.optim.Adam([*model.parameters(), *likelihood.parameters()], lr=0.01)
    model.train()
    batch = 1024
    for _ in range(epochs):
        order = torch.randperm(len(x))
        for start in range(0, len(x), batch):
            rows = order[start : start + batch]
            optimizer.zero_grad()
            loss = -objective(model(x[rows]), y[rows])
            loss.backward()
            optimizer.step()
    seconds = time.process_time() - begun
    model.eval()
    with torch.no_grad():
        error = float((model(x_test).mean - y_test).square().mean().sqrt()) * scale[-1]
    print(json.dumps({"seconds": seconds, "error": error}))


if __name__ == "__main__":
    main()
