"""scikit-learn's Gaussian process on the paper's joint 2, one start. usage: regress.py TABLE.csv"""

import json
import sys
import time

import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel


def main():
    table = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
    inputs, targets = table[:, :-1], table[:, -1]
    kernel = ConstantKernel(10.0, (1e-6, 1e6)) * RBF(10.0, (1e-2, 1e4)) + WhiteKernel(1e-6, (1e-14, 1e1))
    begun = time.process_time()
    fitted = GaussianProcessRegressor(kernel).fit(inputs, targets)
    seconds = time.process_time() - begun
    print(json.dumps({"seconds": seconds, "likelihood": float(fitted.log_marginal_likelihood_value_)}))


if __name__ == "__main__":
    main()
