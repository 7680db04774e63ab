# Installs what the project needs, from Debian's own packages; sourced by the other scripts.
#
# When all is there, nothing happens: no apt, no root. When something is missing, it says what and
# why, and installs it as root or through sudo; without either it names the command to run.

# Release of Debian | its Boost. The names below differ in nothing else: X.Y stands for that.
packages_boost='
12|1.81
13|1.83
'

# Each line: package | why the project needs it. `build` is what the programs need.
packages_build='
g++|the C++20 compiler
cmake|describes the build
ninja-build|runs the build
ccache|makes every build after the first one fast
pkg-config|finds libraries that have no CMake files
libboostX.Y-dev|Asio: serial ports, sockets and timers
libboost-jsonX.Y-dev|JSON on the API of tmcld
libspdlog-dev|logging
libfmt-dev|text formatting, under spdlog and in the tools
libtomlplusplus-dev|reads tmcld.toml
libcli11-dev|command lines of the tools
libusb-1.0-0-dev|modules on USB without their terminal
libssl-dev|TLS, and the hashes of tokens
prometheus-cpp-dev|writes /metrics in the form that Prometheus reads
libexpected-dev|tl::expected, results that are a value or an error
libncurses-dev|draws the axes on the whole terminal (tmclctl top)
libmosquitto-dev|puts a gateway on an MQTT broker (tmcld-mqtt)
libprotozero-dev|Sparkplug, a dialect of MQTT, in Protocol Buffers (tmcld-mqtt)
libqrencode-dev|draws what a phone reads (tmclctl page --phone)
'

packages_test='
libgtest-dev|unit tests
libgmock-dev|unit tests
libbenchmark-dev|benchmarks
iproute2|sets CAN interfaces up
can-utils|cansend and candump, which tests compare with
curl|calls tmcld by HTTP, as docs/PROTOCOL.md shows
chromium|a browser, which the page of tmcld is tested in
fonts-dejavu-core|the font of the pictures that the page is compared with
openssl|makes certificates for tests
zbar-tools|reads the picture that a phone is to read
socat|joins and cuts serial lines
zsh|its completion of tmclctl
fish|its completion of tmclctl
tshark|reads what tmclctl has recorded
python3|hosts in Python, and some tests
python3-serial|serial ports in Python
python3-can|CAN in Python
mypy|the types of the package for Python
python3-pip|makes the wheel of that package
python3-setuptools|makes the wheel of that package
python3-wheel|makes the wheel of that package
python3-venv|a place for that package and its tests
python3-pytest|the plugin of that package
mosquitto|the broker that tmcld-mqtt is tested on
mosquitto-clients|clients of that broker
faketime|clocks that are wrong
prometheus|promtool, which reads alerts and queries
python3-tango|the bridge to Tango, without its database
'

packages_page='
nodejs|builds the page that tmcld shows a browser
npm|gets what that page is made with
'

packages_bridges='
linuxcnc-uspace|the bridge to the HAL of LinuxCNC
'

packages_vm='
qemu-system-x86|runs the small VM in which SocketCAN works
busybox-static|first program in that VM
cpio|packs the initramfs of that VM
kmod|knows in which order drivers load
iproute2|sets CAN interfaces up
'

packages_package='
dpkg-dev|finds out which libraries a package needs
file|knows what has to be stripped
lintian|checks packages
'

packages_wheel='
python3-pip|makes the wheel of the Python package
python3-setuptools|makes the wheel of the Python package
python3-wheel|makes the wheel of the Python package
'

packages_bare='
debootstrap|makes the bare Debian in which packages are installed
'

packages_check='
clang-format|checks the formatting
clang-19|compiles with sanitizers in two thirds of the time of g++, and has a fuzzer
libclang-rt-19-dev|the sanitizers and the fuzzer of that compiler
lld|links programs with sanitizers in a quarter of the time
'

_say() { printf '%s\n' "$*" >&2; }

# Of this Debian; empty where it is another system.
packages_release() {
  (
    . /etc/os-release 2>/dev/null || true
    [[ ${ID-} != debian ]] || printf '%s\n' "${VERSION_ID-}"
  )
}

# packages_of RELEASE SET...: the lines of the sets by the names of that release; of the newest one that is known here,
# where it is none of these.
packages_of() {
  local boost set table
  boost=$(grep "^$1|" <<<"$packages_boost" || grep . <<<"$packages_boost" | tail -n1)
  shift
  for set in "$@"; do
    table=packages_$set
    printf '%s\n' "${!table//X.Y/${boost#*|}}"
  done | grep . | sort -u
}

# The packages that are there, of those named. Node is often there from elsewhere: what counts is that it can
# be called, and Debian's npm may not go with it.
_packages_installed() {
  ! command -v node >/dev/null || echo nodejs
  ! command -v npm >/dev/null || echo npm
  dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | awk '$1 == "installed" { print $2 }' || true
}

# The lines of the given sets whose package is not installed.
_packages_missing() {
  local lines names name line
  local -A is_installed=()
  lines=$(packages_of "$(packages_release)" "$@")
  mapfile -t names < <(cut -d'|' -f1 <<<"$lines")
  while read -r name; do is_installed[$name]=yes; done < <(_packages_installed "${names[@]}")
  while IFS= read -r line; do
    [[ -n ${is_installed[${line%%|*}]:-} ]] || printf '%s\n' "$line"
  done <<<"$lines"
}

_can_be_root() { ((EUID == 0)) || command -v sudo >/dev/null; }

# Another apt may be at work, on a new machine most of all: wait for it rather than fail.
_apt() {
  local sudo=()
  ((EUID == 0)) || sudo=(sudo)
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@"
}

# The development packages of Boost's versions exclude each other. Removing someone's packages is not ours to do.
_packages_refuse_conflict() {
  local ours other
  ours=$(printf '%s\n' "$@" | grep -x 'libboost[0-9.]*-dev') || return 0
  other=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' 'libboost1.[0-9]*-dev' 2>/dev/null \
    | awk -v ours="$ours" '$1 == "installed" && $2 != ours { print $2 }' | head -n1)
  [[ -n $other ]] || return 0
  _say "$other is installed, and Debian does not allow $ours beside it."
  _say "Nothing was changed. If you can do without $other, replace it and try again:"
  _say "    sudo apt-get install $ours"
  return 1
}

_packages_say_by_hand() {
  _say "by other names (Boost 1.81 or later), install them, and build with:"
  _say "    cmake --preset release -DTMCL_BUILD_TESTS=OFF && cmake --build --preset release --target programs"
}

_packages_need_debian() {
  command -v apt-get >/dev/null && command -v dpkg-query >/dev/null && return
  _say "This machine has no apt. The scripts know Debian 12 and 13. If it has what scripts/lib/packages.sh lists"
  _packages_say_by_hand
  return 1
}

# The names are those of these releases, Boost's most of all.
_packages_doubt_release() {
  local release
  release=$(packages_release)
  [[ -z $release ]] || ! grep -q "^$release|" <<<"$packages_boost" || return 0
  release=$(. /etc/os-release 2>/dev/null && printf '%s' "${PRETTY_NAME:-}")
  _say "The names above are those of Debian 13, and this is ${release:-another system}. If it has these libraries"
  _packages_say_by_hand
}

_packages_list() {
  local name reason
  while IFS='|' read -r name reason; do
    _say "$(printf '  %-24s %s' "$name" "$reason")"
  done <<<"$1"
}

# packages_expect SET...: fails, naming what to do, when something is missing; installs nothing.
packages_expect() {
  local missing
  missing=$(_packages_missing "$@")
  [[ -n $missing ]] || return 0
  _say "These packages are missing:"
  _packages_list "$missing"
  _say "scripts/test installs them, or as root:"
  _say "    apt-get update && apt-get install $(cut -d'|' -f1 <<<"$missing" | xargs)"
  return 1
}

# packages_require SET...: installs what is missing of the sets named above (build, test, ...).
packages_require() {
  local missing names
  _packages_need_debian || return 1
  missing=$(_packages_missing "$@")
  [[ -n $missing ]] || return 0
  _say "These packages are missing:"
  _packages_list "$missing"
  mapfile -t names < <(cut -d'|' -f1 <<<"$missing")
  _packages_refuse_conflict "${names[@]}" || return 1
  _packages_install "${names[@]}"
}

_packages_install() {
  local log
  if ! _can_be_root; then
    _say "Installing them needs root, and there is no sudo here. Please run as root, then try again:"
    _say "    apt-get update && apt-get install --no-install-recommends $*"
    return 1
  fi
  _say "Installing them from Debian's packages (a minute or two)..."
  log=$(mktemp)
  # A source that has nothing to do with us may fail to refresh: only the installation decides.
  _apt update >"$log" 2>&1 || true
  if ! _apt install -y --no-install-recommends "$@" >>"$log" 2>&1; then
    tail -n 20 "$log" >&2
    rm -f "$log"
    _say "apt-get could not install them; its last words are above. To see more, run as root:"
    _say "    apt-get update && apt-get install --no-install-recommends $*"
    _packages_doubt_release
    return 1
  fi
  rm -f "$log"
}

# packages_resolve META: the package that a meta-package stands for today.
packages_resolve() {
  local name
  name=$(apt-cache depends "$1" 2>/dev/null | awk '$1 == "Depends:" { print $2; exit }')
  if [[ -z $name ]] && _can_be_root; then
    _apt update >/dev/null 2>&1 || true
    name=$(apt-cache depends "$1" | awk '$1 == "Depends:" { print $2; exit }')
  fi
  [[ -n $name ]] || { _say "apt knows no package $1; try apt-get update (as root)" && return 1; }
  printf '%s\n' "$name"
}

# packages_download NAME FOLDER: fetches a package without installing it; needs no root.
packages_download() {
  (
    cd "$2"
    # As root, apt would fetch as a user who may not write here.
    local options=(-qq -o APT::Sandbox::User="$(id -un)")
    apt-get "${options[@]}" download "$1" && exit
    if ! _can_be_root; then
      _say "apt could not download $1. Please run as root, then try again: apt-get update"
      exit 1
    fi
    _say "Trying again with fresh package lists..."
    _apt update && apt-get "${options[@]}" download "$1"
  )
}
