#!/usr/bin/env bash
# Builds the release preset into build/: everything, or the targets that are named.
#
#   scripts/build.sh [TARGET...]
set -euo pipefail
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
cmake --build build --parallel "$(nproc)" "${targets[@]}"
