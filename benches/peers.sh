#!/usr/bin/env bash
# This project and what people use instead, alternately in the same minutes: ratios with their spread.
#
# usage: benches/peers.sh [--venv DIR] [--rounds N] [--only NAME,...]
#
# Peers are installed by pip into DIR (default target/peers-venv). Names: arm, plant, gp, diagnosis (the default), and sparse, which
# installs GPyTorch, several gigabytes. A peer that is missing is named, and its rows are left out.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
venv=$root/target/peers-venv
rounds=7
only=arm,plant,gp,diagnosis
while [ $# -gt 0 ]; do
    case $1 in
        --venv) venv=$2; shift 2 ;;
        --rounds) rounds=$2; shift 2 ;;
        --only) only=$2; shift 2 ;;
        *) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 2 ;;
    esac
done
command -v python3 >/dev/null || { echo "needs python3" >&2; exit 1; }
command -v cargo >/dev/null || { echo "needs cargo" >&2; exit 1; }

[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
have() { "$venv/bin/python" -c "import $1" 2>/dev/null; }
install() { "$venv/bin/pip" install --quiet "$@" || echo "pip could not install: $*" >&2; }
have pinocchio || install pin cmeel-eigen cmeel-boost cmeel-urdfdom cmeel-urdfdom-headers
have mujoco || install mujoco
have sklearn || install scikit-learn
case ,$only, in *,diagnosis,*) have figaroh || install figaroh ;; esac
case ,$only, in *,sparse,*) have gpytorch || install gpytorch ;; esac

cd "$root"
for crate in arm plant gp torque; do
    cargo build --quiet --release --package $crate --example ${crate}_peers
done
case ,$only, in *,diagnosis,*) cargo build --quiet --release --package testbed --no-default-features ;; esac
mkdir -p target/peers
exec "$venv/bin/python" benches/peers/compare.py --rounds "$rounds" --only "$only" --ours "${CARGO_TARGET_DIR:-target}/release/examples" --build target/peers
