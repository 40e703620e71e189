#!/usr/bin/env bash
# Builds this tree for ARM processors (aarch64, Debian 12) by a cross compiler, and runs a command there under emulation.
#
#   scripts/on_arm.sh COMMAND [ARGUMENT ...]
#
# for example: scripts/on_arm.sh build/gradus render scenes/cornell-box.xml --spp 4 --size 64x64 -o /tmp/arm.exr
#
# The system is one of scripts/on_distribution.sh, in /var/tmp/gradus-aarch64, or where GRADUS_SYSTEM says. Programs take
# some ten times as long as on a processor of their own. Needs what that script does, and the packages
# g++-aarch64-linux-gnu, qemu-user-static and binfmt-support.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -lt 1 ]; then
    sed -n '2,/^set /{ /^set /d; s/^# \{0,1\}//p }' "$0"
    exit 2
fi
export GRADUS_SYSTEM=${GRADUS_SYSTEM:-/var/tmp/gradus-aarch64} GRADUS_ARCHITECTURE=arm64

if [ ! -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ]; then
    [ -e /proc/sys/fs/binfmt_misc/register ] || mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc
    update-binfmts --enable qemu-aarch64
fi

there() { scripts/on_distribution.sh bookworm "$@"; }

there scripts/install_dependencies.sh >&2
# Paths that the build knows are the same there.
mkdir -p "$GRADUS_SYSTEM$(dirname "$GRADUS_SYSTEM")"
ln -sfn / "$GRADUS_SYSTEM$GRADUS_SYSTEM"
clone=$GRADUS_SYSTEM/gradus/main
CMAKE_TOOLCHAIN_FILE=$clone/cmake/aarch64.cmake "$clone/scripts/build.sh" gradus gradus-compile gradus-pictures >&2
there "$@"
