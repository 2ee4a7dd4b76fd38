#!/bin/sh
# Set up what only the system can give. Needed: a Python with venv and headers. Wanted: pkg-config, GSL, HDF5, and for the tests C++.
# Its words are the commands of make. With apt and the rights it installs what is missing; otherwise it says what it could not get and goes on without that part.
set -u
PYTHON=${PYTHON:-python3}
PKG_CONFIG=${PKG_CONFIG:-pkg-config}
CXX=${CXX:-c++}
commands=" $* "

wants() { # wants PART: not left out by WITHOUT
  case " ${WITHOUT:-} " in *" $1 "*) return 1 ;; esac
}

found() { # found NAME ...: one of these programs
  for name in "$@"; do command -v "$name" >/dev/null 2>&1 && return; done
  return 1
}

look() { # what is missing now
  needed=""
  wanted=""
  "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null || needed="$needed python3-venv"
  "$PYTHON" -c 'import os, sysconfig, sys; sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' 2>/dev/null ||
    needed="$needed python3-dev"
  command -v "$PKG_CONFIG" >/dev/null 2>&1 || wanted="$wanted pkg-config"
  wants gsl && { "$PKG_CONFIG" --exists gsl 2>/dev/null || wanted="$wanted libgsl-dev"; }
  wants hdf5 && { "$PKG_CONFIG" --exists hdf5-serial 2>/dev/null || "$PKG_CONFIG" --exists hdf5 2>/dev/null || wanted="$wanted libhdf5-dev"; }
  case "$commands" in *" test "*) command -v "${CXX%% *}" >/dev/null 2>&1 || command -v g++ >/dev/null 2>&1 || wanted="$wanted g++" ;; esac
  # Callgrind counts instructions. libc6-dbg: valgrind replaces functions of libc by their names.
  case "$commands" in *" memory "* | *" bench "*) command -v valgrind >/dev/null 2>&1 || wanted="$wanted valgrind libc6-dbg" ;; esac
  case "$commands" in *" wheels "* | *" check-cross "*)
    command -v qemu-aarch64 >/dev/null 2>&1 || wanted="$wanted qemu-user"
    command -v wine >/dev/null 2>&1 || wanted="$wanted wine"
    ;;
  esac
  case "$commands" in *" test-hosts "*) command -v ccx >/dev/null 2>&1 || wanted="$wanted calculix-ccx" ;; esac
  # The names that docs/browser.py looks for.
  case "$commands" in *" pdf "* | *" test-page "*) found chromium chromium-browser google-chrome chrome || wanted="$wanted chromium" ;; esac
  case "$commands" in *" test-page "*)
    found firefox-esr firefox || wanted="$wanted firefox-esr"
    found node || wanted="$wanted nodejs"
    ;;
  esac
  missing="$needed$wanted"
}

install() { # install RUN PACKAGES: apt-get, with sudo or nothing before it; if not all at once, then one by one
  run=$1
  shift
  $run apt-get -o DPkg::Lock::Timeout=300 -qq update
  set -- "$*" "$@"
  for packages in "$@"; do
    # shellcheck disable=SC2086
    $run env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -qq -y --no-install-recommends install $packages &&
      [ "$packages" = "$1" ] && return
  done
}

look
[ -n "$missing" ] || exit 0
if [ "${BOOTSTRAP:-yes}" != no ] && command -v apt-get >/dev/null 2>&1; then
  # shellcheck disable=SC2086
  if [ "$(id -u)" = 0 ]; then
    echo "setting up:$missing" >&2
    install "" $missing >&2
    look
  elif command -v sudo >/dev/null 2>&1 && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
    echo "setting up with sudo:$missing" >&2
    install sudo $missing >&2
    look
  fi
fi
[ -n "$missing" ] || exit 0
[ -z "$wanted" ] || echo "not found, and left out:$wanted" >&2
echo "to get everything: apt-get install$missing" >&2
if [ -n "$needed" ]; then
  echo "cannot go on without:$needed (\`make lib\` still builds the C library)" >&2
  exit 1
fi
