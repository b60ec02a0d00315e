#!/bin/sh
# The README's test command on an empty machine: makes a root of Debian with apt and git alone, clones this
# repository's last commit into it and runs `sh verification/fresh.sh tests` (or figures) there, in a name space of its
# own. For Arm a cross build, whose engine tests run under qemu-user. Ends with a line for the table of docs/machines.md.
# usage: sh verification/tools/machine.sh debian12|debian13|arm64 [g++|clang++] [tests|figures]
# CI=true: warnings are errors, and the book is built. Downloaded packages are kept in ~/.cache/dpdref.
# Exit code: that of the tests; 77 where no root can be made, which needs root's rights and a mirror.
set -eu
system=${1:-}
export CXX="${2:-g++}"
job=${3:-tests}
usage() {
    echo "usage: sh verification/tools/machine.sh debian12|debian13|arm64 [g++|clang++] [tests|figures]" >&2
    exit 2
}
case "$CXX" in g++ | clang++) ;; *) usage ;; esac
case "$system $job" in
"debian12 tests" | "debian12 figures") suite=bookworm ;;
"debian13 tests" | "debian13 figures") suite=trixie ;;
"arm64 tests") suite=bookworm; [ "$CXX" = g++ ] || usage ;;
*) usage ;;
esac
cd "$(dirname "$0")/../.."
repository=$PWD

impossible() {
    echo "machine.sh: no empty root can be made here: $1" >&2
    exit 77
}

# --- what it takes
[ "$(id -u)" -eq 0 ] || impossible "it needs root's rights"
commit=$(git rev-parse --verify -q --short HEAD) || impossible "this is no clone"
unshare --mount --pid --fork --kill-child true 2>/dev/null || impossible "no name spaces of their own for mounts"
export DEBIAN_FRONTEND=noninteractive
tools="mmdebstrap debian-archive-keyring"
[ "$system" != arm64 ] || tools="$tools g++-aarch64-linux-gnu qemu-user cmake ninja-build"
apt-get update -q </dev/null >/dev/null 2>&1 || : # a source that fails may be another one
# shellcheck disable=SC2086 # a list of words
apt-get install -y -q --no-install-recommends -o DPkg::Lock::Timeout=600 $tools </dev/null >/dev/null 2>&1 ||
    impossible "apt-get cannot install $tools"
# Debian from where this machine has it
# shellcheck disable=SC2016 # apt's variables
mirror=$(apt-get indextargets --format '$(REPO_URI) $(LABEL) $(COMPONENT)' 'Created-By: Packages' |
    awk '$2 == "Debian" && $3 == "main" { print $1; exit }')
[ -n "$mirror" ] || impossible "apt knows no mirror of Debian"
scratch=$(mktemp -d "${TMPDIR:-/tmp}/dpdref-machine.XXXXXX")
[ "$(df -Pk "$scratch" | awk 'NR == 2 { print $4 }')" -gt 8000000 ] || impossible "less than 8 GB are free"
# shellcheck disable=SC2317 # called by the trap
finish() {
    # The mounts went with the processes that saw them. To be sure:
    if grep -q " $scratch" /proc/mounts; then
        echo "machine.sh: something is mounted in $scratch, which stays" >&2
    else
        rm -rf --one-file-system "$scratch"
    fi
}
trap finish EXIT
trap 'exit 130' INT TERM HUP
packages=${XDG_CACHE_HOME:-$HOME/.cache}/dpdref/$suite
mkdir -p "$packages"
find "$packages" -name '*.deb' -ctime +60 -delete

root=$scratch/root
make_root() {
    mmdebstrap --quiet --dpkgopt=force-unsafe-io --skip=download/empty,essential/unlink \
        --setup-hook="mkdir -p \"\$1/var/cache/apt/archives\"; find '$packages' -maxdepth 1 -name '*.deb' -exec cp -pt \"\$1/var/cache/apt/archives\" {} +" \
        --customize-hook="cp -pu \"\$1\"/var/cache/apt/archives/*.deb '$packages'" \
        "$@" "$suite" "$root" "$mirror" </dev/null || impossible "mmdebstrap failed"
}

# The commit that was the last when this began.
clone_into() {
    git clone -q "$repository" "$1" || impossible "no clone"
    git -C "$1" checkout -q "$commit" || impossible "no clone"
}

# A command in the clone in the root; its mounts end with it.
inside() {
    # shellcheck disable=SC2016 # of the inner shell
    unshare --mount --pid --fork --kill-child --propagation private sh -euc '
        mount --rbind /dev "$1/dev"
        mount -t proc proc "$1/proc"
        mount --bind "$2" "$1/var/cache/apt/archives"
        exec chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 CI="${CI:-}" CXX="$CXX" \
            http_proxy="${http_proxy:-}" sh -euc "cd /srv/dpdref; $3"' sh "$root" "$packages" "$1" </dev/null
}

# Headers and libraries, unpacked: the packages of fresh.sh that hold some.
test_on_arm() {
    wanted=$(sed -n '/^packages="/,/"$/p' verification/fresh.sh | tr -c 'a-z0-9.+-' '\n' | grep -E '^(lib|nlohmann).*-dev$' | paste -sd,)
    make_root --arch=arm64 --variant=extract --include="libc6-dev,libstdc++-12-dev,$wanted"
    # its absolute links, as that of libm.so, mean files of the root
    # shellcheck disable=SC2016 # of the inner shell
    find "$root/usr/lib" -lname '/*' -exec sh -c 'for link; do ln -snf "$0$(readlink "$link")" "$link"; done' "$root" {} +
    clone_into "$scratch/dpdref"
    echo "machine.sh: cross build for arm64"
    (
        unset CXX
        cd "$scratch/dpdref"
        cmake --preset ci --toolchain verification/tools/aarch64.cmake -DDPDREF_SYSROOT="$root" &&
            cmake --build --preset ci --target engine_test exact_test dpdref bits_of_state && ctest --preset ci -R '^(engine|exact|bits)$'
    )
}

fresh_in_root() {
    make_root --variant=minbase --include=git
    clone_into "$root/srv/dpdref"
    cp /etc/resolv.conf /etc/hosts "$root/etc/" || :
    {
        echo 'Acquire::Retries "5";'
        apt-config dump | grep -E '^Acquire::https?::Proxy' || :
    } >"$root/etc/apt/apt.conf.d/90machine"
    inside 'apt-get update -q' >/dev/null || impossible "apt-get update fails in it"
    [ "$CXX" = g++ ] || inside 'apt-get install -y -q --no-install-recommends clang' >/dev/null ||
        impossible "clang cannot be installed in it"
    echo "machine.sh: sh verification/fresh.sh $job, in an empty $system"
    inside "sh verification/fresh.sh $job"
}

begin=$(date +%s)
echo 77 >"$scratch/status"
{
    if [ "$system" = arm64 ]; then test_on_arm; else fresh_in_root; fi && echo 0 >"$scratch/status" || echo $? >"$scratch/status"
} | tee "$scratch/log"
status=$(cat "$scratch/status")
[ "$status" -ne 77 ] || exit 77
if [ "$status" -ne 0 ] && grep -qE 'Failed to fetch|Temporary failure resolving' "$scratch/log"; then
    impossible "the mirror failed"
fi
tests=$(sed -n 's/^.*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$/\1 of \2 failed/p' "$scratch/log")
compiler=$(sed -n 's/^-- The CXX compiler identification is //p' "$scratch/log")
elapsed=$(($(date +%s) - begin))
printf '\n| %s | %s | %s | %s | %d min |\n' "$system" "$compiler" "$commit" "${tests:-$job}" $((elapsed / 60))
exit "$status"
