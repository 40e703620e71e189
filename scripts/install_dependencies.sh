#!/usr/bin/env bash
# Installs the packages of Debian 12 or 13, or Ubuntu 24.04, that building, testing and running Gradus takes; only those
# that are missing.
#
#   scripts/install_dependencies.sh [--bench] [--list]
#
# --bench adds what bench/report takes. --list prints the packages, one a line, and installs nothing. Needs root or sudo
# only where something is missing.
set -euo pipefail
usage() { sed -n '2,/^$/s/^# \{0,1\}//p; /^set /q' "$0"; }
bench=no list=no
for argument in "$@"; do
    case "$argument" in
    --bench) bench=yes ;;
    --list) list=yes ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
    esac
done

packages=(
    # Tools.
    g++ cmake ninja-build python3
    # OpenCL: loader, headers, and PoCL, which runs kernels on the CPU. PoCL brings its own clang and links
    # kernels with the linker that comes with g++.
    ocl-icd-opencl-dev opencl-headers opencl-clhpp-headers pocl-opencl-icd
    # Ray tracing, images, scene files, command line, text.
    libembree-dev libtbb-dev libopenimageio-dev libopenexr-dev libpugixml-dev zlib1g-dev
    libcli11-dev nlohmann-json3-dev libfmt-dev
    # Tests. FFTW is what the solver is measured against, Google Benchmark times the kernels.
    libgtest-dev libgmock-dev libfftw3-dev libbenchmark-dev
)
# Checks every memory access of the kernels. Where there is none, as in Debian 13, the tests that take it are skipped.
optional=(oclgrind)

[ "$bench" = no ] || packages+=(python3-venv) # the virtual environment of the rivals
if [ "$list" = yes ]; then
    printf '%s\n' "${packages[@]}" "${optional[@]}"
    exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This is not a Debian: the packages must be there already. They are, by Debian's names: ${packages[*]}" >&2
    exit 0
fi

# Those of the packages that are not installed.
missing() {
    local package status
    for package in "$@"; do
        status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
        [ "$status" = installed ] || printf '%s\n' "$package"
    done
}
# Those that are not installed and could be.
available() {
    local package
    for package in $(missing "$@"); do
        ! apt-cache show "$package" >/dev/null 2>&1 || printf '%s\n' "$package"
    done
}

mapfile -t needed < <(missing "${packages[@]}")
mapfile -t wanted < <(available "${optional[@]}")
[ $((${#needed[@]} + ${#wanted[@]})) -gt 0 ] || exit 0

echo "Installing ${needed[*]} ${wanted[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "Neither root nor sudo. As root: apt-get install --no-install-recommends ${needed[*]} ${wanted[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
run_apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" </dev/null; }
# Package lists are fetched where they are missing, do not name a package, or name one that the mirror has replaced.
install() {
    [ $# -gt 0 ] || return 0
    apt-get install --simulate "$@" >/dev/null 2>&1 || run_apt update -q
    run_apt install -y -q --no-install-recommends "$@" ||
        { run_apt update -q && run_apt install -y -q --no-install-recommends "$@"; }
}

install "${needed[@]}"
mapfile -t wanted < <(available "${optional[@]}") # by those lists
install "${wanted[@]}"
