#!/usr/bin/env bash
# Runs a command in a clone of this tree on another version of Debian or Ubuntu: to see that Gradus builds and passes
# there.
#
#   scripts/on_distribution.sh VERSION COMMAND [ARGUMENT ...]    for example: scripts/on_distribution.sh trixie ./check
#
# VERSION is a code name: trixie is Debian 13, noble is Ubuntu 24.04. The system lies in /var/tmp/gradus-VERSION, or
# where GRADUS_SYSTEM says; what is not there is made by debootstrap, for GRADUS_ARCHITECTURE if not this machine's. The
# clone, in it as /gradus/main, is of what is committed, and its build folder stays from one call to the next. Needs root,
# debootstrap and the network.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -lt 2 ]; then
    sed -n '2,/^set /{ /^set /d; s/^# \{0,1\}//p }' "$0"
    exit 2
fi
version=$1
shift
system=${GRADUS_SYSTEM:-/var/tmp/gradus-$version}

clone=$system/gradus/main
if [ ! -e "$clone" ]; then
    options=(--arch="${GRADUS_ARCHITECTURE:-$(dpkg --print-architecture)}" --variant=minbase --include=ca-certificates)
    mirror=(http://deb.debian.org/debian)
    if [ "$version" = noble ]; then
        options+=(--components=main,universe --no-check-gpg) # Debian has no keys of Ubuntu to check with
        mirror=(http://archive.ubuntu.com/ubuntu gutsy)      # debootstrap's script for every Ubuntu since then
    fi
    debootstrap "${options[@]}" "$version" "$system" "${mirror[@]}"
    git clone -q . "$clone"
fi
git -C "$clone" fetch -q origin HEAD # from this tree
git -C "$clone" reset -q --hard FETCH_HEAD

# Mounts end with the command.
unshare --mount --propagation private bash -euc '
    system=$1
    shift
    for folder in proc sys dev; do mount --rbind "/$folder" "$system/$folder"; done
    exec chroot "$system" bash -euc "cd /gradus/main; export HOME=/root DEBIAN_FRONTEND=noninteractive; exec \"\$@\"" \
        bash "$@"
' bash "$system" "$@"
