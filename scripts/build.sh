#!/usr/bin/env bash
# Builds the release preset into build/: everything, or the targets that are named.
#
#   scripts/build.sh [TARGET...]
set -euo pipefail
usage() { sed -n '2,/^$/s/^# \{0,1\}//p; /^set /q' "$0"; }
case "${1:-}" in
-h | --help) usage; exit 0 ;;
-*) usage >&2; exit 2 ;;
esac
cd "$(dirname "$0")/.."

# A tree that is configured keeps its generator.
generator=()
if [ ! -f build/CMakeCache.txt ]; then
    if command -v ninja >/dev/null; then
        generator=(-G Ninja)
    else
        generator=(-G "Unix Makefiles")
    fi
    if command -v ccache >/dev/null; then
        generator+=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache)
    fi
    # Files of a folder compiled together, eight at a time, build the whole tree in 40 % of the time; a change to one
    # compiles the others again, so the presets leave it off.
    generator+=(-D CMAKE_UNITY_BUILD=ON)
fi
cmake --preset release "${generator[@]}"
targets=()
[ $# -eq 0 ] || targets=(--target "$@")
if ! cmake --build build --parallel "$(nproc)" "${targets[@]}"; then
    # Two files may have a name in common, or one is wrong on its own, too.
    grep -q '^CMAKE_UNITY_BUILD:[A-Z]*=ON' build/CMakeCache.txt || exit 1
    echo "build: each file on its own, as files compiled together have failed" >&2
    cmake -D CMAKE_UNITY_BUILD=OFF build >/dev/null
    cmake --build build --parallel "$(nproc)" "${targets[@]}"
fi
