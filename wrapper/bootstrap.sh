#!/bin/sh
# Set up what only the system can give. Needed: a Python with venv and headers. Wanted: pkg-config, GSL, HDF5.
# With apt and the rights it installs what is missing; otherwise it says what it could not get and goes on without that part.
set -u
PYTHON=${PYTHON:-python3}

missing_needed=""
missing_wanted=""
"$PYTHON" -c 'import ensurepip, venv' 2>/dev/null || missing_needed="$missing_needed python3-venv"
"$PYTHON" -c 'import os, sysconfig, sys; sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' 2>/dev/null ||
  missing_needed="$missing_needed python3-dev"

wants() { # wants PART: not left out by WITHOUT
  case " ${WITHOUT:-} " in *" $1 "*) return 1 ;; esac
}
if ! command -v pkg-config >/dev/null 2>&1; then
  missing_wanted="$missing_wanted pkg-config"
  wants gsl && missing_wanted="$missing_wanted libgsl-dev"
  wants hdf5 && missing_wanted="$missing_wanted libhdf5-dev"
else
  wants gsl && ! pkg-config --exists gsl && missing_wanted="$missing_wanted libgsl-dev"
  wants hdf5 && ! pkg-config --exists hdf5-serial && ! pkg-config --exists hdf5 && missing_wanted="$missing_wanted libhdf5-dev"
fi
missing="$missing_needed$missing_wanted"
[ -n "$missing" ] || exit 0

install() { # install PREFIX PACKAGES: apt-get, with sudo or nothing before it
  run=$1
  shift
  $run apt-get -o DPkg::Lock::Timeout=300 -qq update &&
    $run env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -qq -y --no-install-recommends install "$@"
}

done=no
if [ "${BOOTSTRAP:-yes}" != no ] && command -v apt-get >/dev/null 2>&1; then
  # shellcheck disable=SC2086
  if [ "$(id -u)" = 0 ]; then
    echo "setting up:$missing" >&2
    install "" $missing >&2 && done=yes
  elif command -v sudo >/dev/null 2>&1 && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
    echo "setting up with sudo:$missing" >&2
    install sudo $missing >&2 && done=yes
  fi
fi
if [ "$done" = no ]; then
  [ -z "$missing_wanted" ] || echo "not found, and left out:$missing_wanted" >&2
  echo "to get everything: apt-get install$missing" >&2
  if [ -n "$missing_needed" ]; then
    echo "cannot go on without:$missing_needed (\`make lib\` still builds the C library)" >&2
    exit 1
  fi
fi
