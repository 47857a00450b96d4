# Sourced by scripts that need programs or libraries which Debian packages. Calls: need_rust; need PACKAGE TEST..., then install_missing.
missing=()

# Finds cargo, also where rustup put it and this shell was not told, new enough, with the COMPONENT... `fmt` or `clippy` where they are
# named; Debian's own is too old, so nothing is installed.
need_rust() {
  command -v cargo >/dev/null || PATH=${CARGO_HOME:-${HOME:-}/.cargo}/bin:$PATH
  if ! command -v cargo >/dev/null; then
    echo "there is no Rust toolchain here: install one as https://rustup.rs says, and run this again" >&2
    return 1
  fi
  local least found component
  least=$(sed -n 's/^rust-version = "\(.*\)"$/\1/p' "$(dirname "${BASH_SOURCE[0]}")/../Cargo.toml")
  found=$(cargo --version | cut -d ' ' -f 2)
  if [ "$(printf '%s\n' "$least" "$found" | sort -V | head -n 1)" != "$least" ]; then
    echo "cargo is $found here; $least or newer is needed: run rustup update, and this again" >&2
    return 1
  fi
  for component; do
    if ! cargo "$component" --version >/dev/null 2>&1; then
      echo "cargo $component is missing here: run rustup component add ${component/#fmt/rustfmt}, and this again" >&2
      return 1
    fi
  done
}

# Finds a Python that has MODULE, into `python`: $PYTHON, that of the PATH, or Debian's, which is the one that Debian's modules are for.
find_python() {
  for python in "${PYTHON:-}" python3 /usr/bin/python3; do
    [ -n "$python" ] && "$python" -c "import $1" 2>/dev/null && return
  done
  return 1
}

find_numpy() { find_python numpy; }

# It brings NumPy and Pillow.
find_matplotlib() { find_python matplotlib; }

# Notes PACKAGE when the command TEST... fails.
need() {
  local package=$1
  shift
  "$@" >/dev/null 2>&1 || missing+=("$package")
}

# Once more, some seconds later, where it failed: servers of packages do not always answer.
twice() {
  "$@" || { sleep 5 && "$@"; }
}

# Installs what was noted, as root or through sudo, and says so.
install_missing() {
  [ ${#missing[@]} -eq 0 ] && return
  if ! command -v apt-get >/dev/null; then
    echo "please install: ${missing[*]} (Debian's names; there is no apt-get here)" >&2
    return 1
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "please run as root, as there is no sudo here:" >&2
      echo "apt-get update && apt-get install -y --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "installing ${missing[*]}" >&2
  # Callers may stand in an `if`, where `set -e` is off.
  twice "${as_root[@]}" apt-get update -qq >&2 &&
    twice "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}" >&2 ||
    return 1
  missing=()
}
