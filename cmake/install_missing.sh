# Sourced by scripts that need programs or libraries which Debian packages. Calls: need PACKAGE TEST..., then install_missing.
missing=()

# Notes PACKAGE when the command TEST... fails.
need() {
  local package=$1
  shift
  "$@" >/dev/null 2>&1 || missing+=("$package")
}

# Installs what was noted, as root or through sudo, and says so.
install_missing() {
  [ ${#missing[@]} -eq 0 ] && return
  if ! command -v apt-get >/dev/null; then
    echo "please install: ${missing[*]} (Debian's names; there is no apt-get here)" >&2
    return 1
  fi
  echo "installing ${missing[*]}" >&2
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  # Callers may stand in an `if`, where `set -e` is off.
  "${as_root[@]}" apt-get update -qq >&2 &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}" >&2 ||
    return 1
  missing=()
}
