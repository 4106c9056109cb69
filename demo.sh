#!/usr/bin/env bash
# Installs what is missing, builds, and runs all services on the built-in synthetic room, or on a recording:
#
#   ./demo.sh
#   ./demo.sh --dataset DIR [--camera NAME|FILE.yaml]
#
# Results are in out/. Other options go to egraph-run (build/bin/egraph-run --help).
set -euo pipefail
caller=$PWD
# shellcheck source=.ci/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/.ci/setup.sh"

install_packages
build programs
cd "$caller"

input=(--dataset synthetic:room --frames 300)
out=(--out "$project/out")
for argument in "$@"; do
  case $argument in
    --dataset | --dataset=*) input=() ;;
    --out | --out=*) out=() ;;
  esac
done
say "Running"
with_multicast "$project/build/bin/egraph-run" ${input[@]+"${input[@]}"} ${out[@]+"${out[@]}"} "$@"
