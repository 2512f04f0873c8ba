// Nanoseconds a state of Pinocchio's algorithms, as JSON. Inputs: robot (URDF), number of states.
// The states and the check sums are those of crates/arm/examples/arm_peers.rs.
#include <pinocchio/fwd.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

namespace {

using pinocchio::Convention;
using Vectors = std::vector<Eigen::VectorXd>;

constexpr int repeats = 40;

// The time a state takes in the fastest pass, which other programs disturbed least.
template <class Call>
double fastest(int states, Call call) {
  double least = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass <= repeats; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < states; ++k) call(k);
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
    if (pass > 0) least = std::min(least, taken.count() / states);
  }
  return least;
}

Vectors signal(int states, int n, double phase) {
  Vectors vectors(states, Eigen::VectorXd(n));
  for (int k = 0; k < states; ++k)
    for (int i = 0; i < n; ++i) vectors[k][i] = std::sin((k * 7 + i) * 0.37 + phase);
  return vectors;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  pinocchio::Model model;
  pinocchio::urdf::buildModel(argv[1], model);
  pinocchio::Data data(model);
  const int states = std::atoi(argv[2]), n = model.nv;
  const Vectors q = signal(states, n, 0.0), qd = signal(states, n, 1.0), qdd = signal(states, n, 2.0);

  double torque = 0, acceleration = 0, mass = 0, regressor = 0;
  for (int k = 0; k < states; ++k) {
    torque += pinocchio::rnea(model, data, q[k], qd[k], qdd[k]).sum();
    acceleration += pinocchio::aba(model, data, q[k], qd[k], qdd[k], Convention::WORLD).sum();
    pinocchio::crba(model, data, q[k], Convention::WORLD);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) mass += i < j ? data.M(i, j) : data.M(j, i);
    regressor += pinocchio::computeJointTorqueRegressor(model, data, q[k], qd[k], qdd[k]).sum();
  }

  double sink = 0;
  const double rnea = fastest(states, [&](int k) { sink += pinocchio::rnea(model, data, q[k], qd[k], qdd[k])[0]; });
  const double aba = fastest(states, [&](int k) {
    sink += pinocchio::aba(model, data, q[k], qd[k], qdd[k], Convention::WORLD)[0];
  });
  const double aba_local = fastest(states, [&](int k) {
    sink += pinocchio::aba(model, data, q[k], qd[k], qdd[k], Convention::LOCAL)[0];
  });
  const double crba = fastest(states, [&](int k) { sink += pinocchio::crba(model, data, q[k], Convention::WORLD)(0, 0); });
  const double crba_local =
      fastest(states, [&](int k) { sink += pinocchio::crba(model, data, q[k], Convention::LOCAL)(0, 0); });
  const double columns = fastest(states, [&](int k) {
    sink += pinocchio::computeJointTorqueRegressor(model, data, q[k], qd[k], qdd[k])(0, 0);
  });
  std::printf(
      "{\"ns\": {\"rnea\": %.2f, \"aba\": %.2f, \"aba_local\": %.2f, \"crba\": %.2f, \"crba_local\": %.2f, "
      "\"regressor\": %.2f}, \"sums\": [%.17e, %.17e, %.17e, %.17e], \"dof\": %d, \"sink\": %.3g}\n",
      rnea, aba, aba_local, crba, crba_local, columns, torque, acceleration, mass, regressor, n, sink);
}
