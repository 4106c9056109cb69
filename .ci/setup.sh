# shellcheck shell=bash
# Sourced by demo.sh, test.sh and .ci/run: what they need, and how they build. Debian 12; root or sudo, if anything is missing.

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$project" || exit

say() { printf '\n== %s\n' "$*"; }

as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo > /dev/null; then
    sudo "$@"
  else
    echo "Neither root nor sudo, but this is needed: $*" >&2
    return 1
  fi
}

# Installs those packages of .ci/packages.txt that are not there yet.
install_packages() {
  local package
  local -a missing=()
  while read -r package; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2> /dev/null)" = installed ] || missing+=("$package")
  done < <(sed 's/#.*//' .ci/packages.txt | xargs -n 1)
  [ ${#missing[@]} -gt 0 ] || return 0
  say "Installing ${missing[*]}"
  as_root apt-get update -qq
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
}

# Compiling takes up to about 1.5 GB per job.
build_jobs() {
  local by_memory=$(($(awk '/^MemAvailable/ { print $2 }' /proc/meminfo) / 1500000))
  local by_cores
  by_cores=$(nproc)
  echo $((by_memory < 1 ? 1 : by_memory < by_cores ? by_memory : by_cores))
}

# Configures and builds into build/.
build() {
  say "Building"
  [ -f build/build.ninja ] || cmake --preset release > /dev/null
  cmake --build build --parallel "$(build_jobs)" --target "$@"
}

# Runs a command where LCM can send: here, or, if this machine has no route for multicast, in a network of its own, which
# nobody can reach from outside (--here: not that, then).
with_multicast() {
  local here=''
  [ "$1" != --here ] || { here=$1; shift; }
  if ip route get 239.255.76.67 > /dev/null 2>&1; then
    "$@"
  elif [ ! "$here" ] && [ "$(id -u)" = 0 ] && unshare -n true 2> /dev/null; then
    unshare -n sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
  else
    echo 'LCM needs a route for multicast. On one machine alone, this makes one:' >&2
    echo '  sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo' >&2
    return 1
  fi
}
