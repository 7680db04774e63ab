# A Debian in the folder `root`; sourced by the scripts beside this, which set that and `log`.
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/lib/packages.sh"

((EUID == 0)) || { echo "$0 needs root: it makes a system in a folder" >&2; exit 1; }
# What is mounted is seen by this script alone, and ends with it.
[[ ${TMCL_MOUNTS-} == "$$" ]] || TMCL_MOUNTS=$$ exec unshare --mount -- "$0" "$@"

# stage NAME COMMAND...: what it prints is shown when it fails.
stage() {
  echo "-- $1"
  shift
  "$@" >"$log" 2>&1 || { tail -n 100 "$log"; return 1; }
}

# packages_for BUILD_FOLDER RELEASE: where the packages are; those of another release are made by `debian`.
packages_for() {
  if [[ $2 == "$(packages_release)" ]]; then echo "$1/packages"; else echo "$1/package-test/debian-$2/build/packages"; fi
}

unpack_system() {
  mkdir -p "$root"
  tar -C "$root" -xf "$1"
  cp /etc/resolv.conf "$root/etc/"
  # What is lost with the power is made anew.
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io"
}

# enter_system [FOLDER:THERE...]: with this computer's devices, and some of its folders.
enter_system() {
  local pair
  for pair in /proc:/proc /dev:/dev /dev/pts:/dev/pts "$@"; do
    mkdir -p "$root${pair#*:}"
    mount --bind "${pair%:*}" "$root${pair#*:}"
  done
}

inside() {
  chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb DEBIAN_FRONTEND=noninteractive "$@"
}
