#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests. Arguments go to ctest, e.g. ./test.sh -R unit
set -euo pipefail
# shellcheck source=.ci/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/.ci/setup.sh"

install_packages
build all
say "Testing"
with_multicast ctest --test-dir build --output-on-failure --parallel 2 "$@"
