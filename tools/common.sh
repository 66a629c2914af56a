# shellcheck shell=bash
# Shared by ./demo, ./test and the scripts of tools/; sourced with `root` set to the checkout.
#
# ISOCHOR_BUILD_DIR   where the build trees go (default: build/ in the checkout), one per preset
# ISOCHOR_JOBS        parallel jobs (default: one per core)
# ISOCHOR_NO_CCACHE   1: compile everything, even where ccache is installed

build_root=${ISOCHOR_BUILD_DIR:-$root/build}
case $build_root in /*) ;; *) build_root=$PWD/$build_root ;; esac
jobs=${ISOCHOR_JOBS:-$(nproc)}

# Without these ccache keeps nothing that was compiled with precompiled headers.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}

say() { printf '\n== %s\n' "$*"; }

fail() {
  printf '%s: error: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# Reports the command that stopped a script which runs under `set -eE`.
trap_errors() {
  trap 'printf "%s: error: line %s: %s\n" "${0##*/}" "$LINENO" "$BASH_COMMAND" >&2' ERR
}

# configure PRESET [CMAKE_ARGUMENT...]
configure() {
  local preset=$1 launcher=
  shift
  if [ "${ISOCHOR_NO_CCACHE:-0}" != 1 ] && command -v ccache >/dev/null; then launcher=ccache; fi
  (cd "$root" && cmake --preset "$preset" -B "$build_root/$preset" --log-level=WARNING \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" "$@") || fail "configuring the preset '$preset' failed"
}

# build PRESET [CMAKE_BUILD_ARGUMENT...]
build() {
  local preset=$1
  shift
  cmake --build "$build_root/$preset" --parallel "$jobs" "$@" ||
    fail "building the preset '$preset' failed"
}
