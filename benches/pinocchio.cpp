// Prints the nanoseconds of a call of Pinocchio's algorithms on a model that its Python module saved as text.
// usage: pinocchio MODEL.txt CALLS (benches/peers.py builds and runs it)
#include <pinocchio/fwd.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace pinocchio;

constexpr int STATES = 256;
volatile double sink;

template <class Call>
double per_call(int calls, Call call) {
    for (int k = 0; k < 1000; ++k) call(k % STATES);
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < calls; ++k) call(k % STATES);
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / calls;
}

int main(int argc, char **argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: MODEL.txt CALLS\n"), 2;
    Model model;
    serialization::loadFromText(model, argv[1]);
    Data data(model);
    const int calls = std::atoi(argv[2]);
    // The states of crates/arm/examples/time_calls.rs.
    auto vector = [&](int k, double phase) {
        Eigen::VectorXd v(model.nv);
        for (int i = 0; i < model.nv; ++i) v[i] = std::sin((k * 7 + i) * 0.37 + phase);
        return v;
    };
    std::vector<Eigen::VectorXd> a, b, c;
    for (int k = 0; k < STATES; ++k) a.push_back(vector(k, 0)), b.push_back(vector(k, 1)), c.push_back(vector(k, 2));
    const double inverse = per_call(calls, [&](int k) { sink = rnea(model, data, a[k], b[k], c[k])[0]; });
    // Each in the faster of its two conventions.
    double forward = 1e300, matrix = 1e300;
    for (auto convention : {Convention::WORLD, Convention::LOCAL}) {
        forward = std::min(forward, per_call(calls, [&](int k) { sink = aba(model, data, a[k], b[k], c[k], convention)[0]; }));
        matrix = std::min(matrix, per_call(calls, [&](int k) { sink = crba(model, data, a[k], convention)(0, 0); }));
    }
    const double columns = per_call(calls, [&](int k) { sink = computeJointTorqueRegressor(model, data, a[k], b[k], c[k])(0, 0); });
    std::printf("{\"inverse dynamics\": %.1f, \"forward dynamics\": %.1f, \"mass matrix\": %.1f, \"torque regressor\": %.1f}\n", inverse, forward, matrix, columns);
}
