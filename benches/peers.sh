#!/usr/bin/env bash
# Ours against Pinocchio on the PUMA 560 and the seven-axis arm: alternating runs, ratios with their spread.
# usage: benches/peers.sh [RUNS [CALLS]]   (PYTHON=… a Python with Pinocchio; EIGEN=… the folder of Eigen's headers)
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
"$python" -c 'import pinocchio' 2>/dev/null || {
  echo "peers.sh: $python has no Pinocchio: pip install pin cmeel-eigen, or name another with PYTHON=…" >&2; exit 1; }
command -v g++ >/dev/null || { echo "peers.sh: g++ is missing: install a C++ compiler" >&2; exit 1; }
cargo build --quiet --release -p arm --example time_calls
"$python" benches/peers.py "${CARGO_TARGET_DIR:-target}/release/examples/time_calls" "${1:-9}" "${2:-100000}" \
  assets/puma560.urdf assets/seven_axis.urdf
