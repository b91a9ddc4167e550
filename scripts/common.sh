# What scripts/demo and scripts/test share: packages, build, environment. To be sourced.
# Supported: Debian 11, 12 and 13 with their own ROS packages (in /usr). On Ubuntu 20.04 with /opt/ros/noetic
# build the package in a catkin workspace instead; rosdep knows its dependencies.

PROJECT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
BUILD="${COLLISION_PAIRS_BUILD:-$PROJECT/build}"
export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"  # ROS needs the system's Python

say() { printf '== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

# missing_packages FILE...: those of the lists that are not installed.
missing_packages() {
  local package
  sed -e 's/#.*//' "$@" | awk 'NF {print $1}' | sort -u | while read -r package; do
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

# Says how far a long command is. Not by awk: Debian's keeps what it reads until much has come.
count_lines() {
  local line number=0
  while read -r line; do
    number=$((number + 1))
    [ $((number % 100)) != 0 ] || echo "   $number steps"
  done
}

install_packages() {
  local missing as_root=()
  missing="$(missing_packages "$@")"
  [ -z "$missing" ] && return
  . /etc/os-release
  [ "${ID:-}" = debian ] && [ "${VERSION_ID:-0}" -ge 11 ] ||
    die "these scripts install packages on Debian 11 and later only, and this is ${PRETTY_NAME:-unknown}; install what package.xml names and build in a catkin workspace"
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || die "packages are missing and there is no sudo; run as root: apt-get install $(echo $missing)"
    as_root=(sudo)
  fi
  say "installing $(echo "$missing" | wc -l) packages and their dependencies (several minutes)"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    -o Dpkg::Use-Pty=0 $missing | count_lines
  missing="$(missing_packages "$@")"
  [ -z "$missing" ] || die "could not be installed: $(echo $missing)"
}

# build [--target "TARGET..."] [OPTION OF CMAKE...]
build() {
  local log="$BUILD/build.log" target=all
  if [ "${1:-}" = --target ]; then target="$2"; shift 2; fi
  local cache="$BUILD/CMakeCache.txt" made_in=
  [ ! -f "$cache" ] || made_in="$(sed -n 's/^CMAKE_CACHEFILE_DIR:INTERNAL=//p' "$cache")"
  if [ -n "$made_in" ] && ! [ "$made_in" -ef "$BUILD" ]; then
    say "$BUILD was built as $made_in and then copied or moved: rebuilding"
    rm -rf "$cache" "$BUILD/CMakeFiles" "$BUILD/devel"
  fi
  mkdir -p "$BUILD"
  say "building (several minutes the first time; log: $log)"
  cmake -S "$PROJECT" -B "$BUILD" "$@" >"$log" 2>&1 || { tail -20 "$log"; die "cmake failed"; }
  cmake --build "$BUILD" -j"$(nproc)" --target $target 2>&1 | tee -a "$log" |
    sed -unE 's/^\[ *[0-9]+%\] Built target (collision|test|check)/   &/p' ||
    { grep -E -A5 'error|Error' "$log" | head -40; die "the build failed"; }
}

# The environment of the built package: what `source devel/setup.bash` gives, on Debian too.
ros_environment() {
  local given="${ROS_PACKAGE_PATH:-}"  # setup.sh forgets it: ros_environment makes it anew from the workspaces
  set +u
  . "$BUILD/devel/setup.sh"
  set -u
  export ROS_PACKAGE_PATH="$PROJECT${given:+:$given}${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}:/usr/share"
}

# A roslaunch in a group of its own, under a master on $port.
start_launch() {  # [FILE] [ARGUMENT...]
  setsid roslaunch -p "$port" collision_pairs "$@" & launch=$!
}

# roslaunch ends its nodes on SIGINT, in order; what is then still there is ended with its group.
stop_launch() {
  kill -INT "${launch:-}" 2>/dev/null || true
  for _ in $(seq 100); do kill -0 "${launch:-}" 2>/dev/null || break; sleep 0.1; done
  kill -KILL -- "-${launch:-}" 2>/dev/null || true
}

# An X server without a screen.
start_screen() {
  export DISPLAY=":$((90 + RANDOM % 100))" LIBGL_ALWAYS_SOFTWARE=1
  Xvfb "$DISPLAY" -screen 0 1280x800x24 >/dev/null 2>&1 & screen=$!
}

# A TCP port that nobody listens on, beginning with the one given.
free_port() {
  /usr/bin/python3 - "$1" <<'PY'
import socket, sys
for port in range(int(sys.argv[1]), 65536):
    with socket.socket() as probe:
        try:
            probe.bind(("", port))
        except OSError:
            continue
    print(port)
    break
PY
}
