#!/usr/bin/env bash
# Builds this tree for ARM processors (aarch64, Debian 12) by a cross compiler, and runs a command there under emulation.
#
#   scripts/on_arm.sh COMMAND [ARGUMENT ...]
#
# for example: scripts/on_arm.sh build/gradus render scenes/cornell-box.xml --spp 4 --size 64x64 -o /tmp/arm.exr
#
# The system lies in /var/tmp/gradus-aarch64, or where GRADUS_SYSTEM says; what is not there is made by debootstrap. The
# clone, in it as /gradus/main, is of what is committed, and its build folder stays from one call to the next. Programs
# take some ten times as long as on a processor of their own. Needs root, the network, and the packages debootstrap,
# g++-aarch64-linux-gnu, qemu-user-static and binfmt-support.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -lt 1 ]; then
    sed -n '2,/^set /{ /^set /d; s/^# \{0,1\}//p }' "$0"
    exit 2
fi
export GRADUS_SYSTEM=${GRADUS_SYSTEM:-/var/tmp/gradus-aarch64}
export QEMU_LD_PREFIX=$GRADUS_SYSTEM # where programs find their libraries that are run from here

if [ ! -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ]; then
    [ -e /proc/sys/fs/binfmt_misc/register ] || mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc
    update-binfmts --enable qemu-aarch64
fi

# Runs a command there; mounts end with it.
there() {
    unshare --mount --propagation private bash -euc '
        system=$1
        shift
        for folder in proc sys dev; do mount --rbind "/$folder" "$system/$folder"; done
        exec chroot "$system" env HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
    ' bash "$GRADUS_SYSTEM" "$@"
}

clone=$GRADUS_SYSTEM/gradus/main
if [ ! -e "$clone" ]; then
    debootstrap --arch=arm64 --variant=minbase --include=ca-certificates bookworm "$GRADUS_SYSTEM" \
        http://deb.debian.org/debian
    mapfile -t packages < <(scripts/install_dependencies.sh --list)
    there apt-get update -qq
    there apt-get install -qq -y --no-install-recommends "${packages[@]}"
    # Paths that the build knows are the same there.
    mkdir -p "$GRADUS_SYSTEM$(dirname "$GRADUS_SYSTEM")"
    ln -s / "$GRADUS_SYSTEM$GRADUS_SYSTEM"
    git clone -q . "$clone"
fi
git -C "$clone" fetch -q origin HEAD # from this tree
git -C "$clone" reset -q --hard FETCH_HEAD

(
    cd "$clone"
    cmake -G Ninja -B build -D CMAKE_BUILD_TYPE=Release -D CMAKE_UNITY_BUILD=ON \
        -D CMAKE_TOOLCHAIN_FILE=cmake/aarch64.cmake
    cmake --build build --target gradus gradus-compile gradus-pictures
) >&2
there bash -euc 'cd /gradus/main; exec "$@"' bash "$@"
