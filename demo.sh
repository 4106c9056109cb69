#!/usr/bin/env bash
# Installs what is missing, builds, and runs all services on the built-in synthetic room, or on a recording:
#
#   ./demo.sh
#   ./demo.sh --dataset DIR [--camera NAME|FILE.yaml]
#   ./demo.sh --view                    # to be watched in a browser, until Ctrl-C
#
# Results are in out/. Other options go to egraph-run (build/bin/egraph-run --help).
set -euo pipefail
caller=$PWD
# shellcheck source=.ci/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/.ci/setup.sh"

install_packages
build programs
cd "$caller"

# Whether an option is among the arguments.
given() {
  local option=$1 argument
  shift
  for argument in "$@"; do
    case $argument in "$option" | "$option"=*) return 0 ;; esac
  done
  return 1
}

defaults=()
given --out "$@" || defaults+=(--out "$project/out")
given --dataset "$@" || defaults+=(--dataset synthetic:room)
given --dataset "$@" || given --frames "$@" || defaults+=(--frames 300)
say "Running"
here=()
if given --view "$@"; then here=(--here); else echo 'With --view you can watch it in a browser.'; fi
with_multicast ${here[@]+"${here[@]}"} "$project/build/bin/egraph-run" ${defaults[@]+"${defaults[@]}"} "$@"
