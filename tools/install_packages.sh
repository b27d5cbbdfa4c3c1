#!/bin/sh
# Installs what tools/packages.txt lists and this machine lacks. Does nothing, and asks nobody, when all is there.
set -eu

list="$(dirname "$0")/packages.txt"

is_installed() { # PACKAGE [PROGRAM]
  if [ -n "${2:-}" ] && command -v "$2" >/dev/null 2>&1; then return 0; fi
  command -v dpkg-query >/dev/null 2>&1 || return 1
  dpkg-query -W -f '${Status}\n' "$1" 2>/dev/null | grep -q '^install ok installed'
}

missing=""
while read -r package program; do
  case "$package" in '' | '#'*) continue ;; esac
  is_installed "$package" "$program" || missing="$missing $package"
done <"$list"
[ -n "$missing" ] || exit 0

if ! command -v apt-get >/dev/null 2>&1; then
  echo "install_packages: there is no apt here; install by hand (Debian names):$missing" >&2
  exit 1
fi
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "install_packages: not root and no sudo; as root: apt-get install$missing" >&2
    exit 1
  fi
  as_root="sudo"
fi

echo "installing:$missing"
# shellcheck disable=SC2086 # the names are words on purpose
$as_root apt-get update -qq
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
