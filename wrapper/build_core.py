"""The extension ``libcontact._core``: its declarations are the public headers, read as they are.

Plain ``pip install .`` compiles the core (libc and libm only), the files' add-on for an HDF5 that h5py brings, and a
series that refuses every call. The Makefile links
the archives that it has built instead, by the variables LIBCONTACT_PREBUILT (folder of the archives),
LIBCONTACT_PACKAGES (what pkg-config calls GSL and HDF5, where they are) and LIBCONTACT_OPENMP (a flag or nothing).
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import cffi

LIBRARY = Path("libcontact")
INCLUDE = LIBRARY / "include"
ADDON_HEADERS = {"gsl": "libcontact/series.h", "hdf5": "libcontact/output.h"}
FLAGS = [
    "-O3",
    "-std=c99",
    # clang there: its headers hide functions, and no pairs (see the Makefile)
    "-fno-slp-vectorize" if sys.platform == "darwin" else "-D_POSIX_C_SOURCE=200112L",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fvisibility=hidden",
    "-fopenmp-simd",
]


def included(header):
    """The headers of the library that a header includes, in order."""
    return re.findall(
        r"^#include <(libcontact/\w+\.h)>", (INCLUDE / header).read_text(encoding="utf-8"), re.M
    )


def in_order(headers):
    """All headers, each after those that it includes."""
    found = []

    def visit(header):
        if header not in found:
            for other in included(header):
                visit(other)
            found.append(header)

    for header in headers:
        visit(header)
    return found


def declarations(header):
    """The text of a header without comments, preprocessor lines, the words around C declarations in C++ and the export
    word."""
    text = (INCLUDE / header).read_text(encoding="utf-8")
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.S)
    text = re.sub(r"^#.*$", "", text, flags=re.M)
    return re.sub(r"\bCT_(API|BEGIN_DECLS|END_DECLS)\b", "", text)


def pkg_config(option, packages):
    if not packages:
        return []
    command = [os.environ.get("PKG_CONFIG", "pkg-config"), option, *packages]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()


packages = os.environ.get("LIBCONTACT_PACKAGES", "").split()
openmp = os.environ.get("LIBCONTACT_OPENMP", "").split()
prebuilt = os.environ.get("LIBCONTACT_PREBUILT")
headers = in_order(included("libcontact.h") + list(ADDON_HEADERS.values()))

if prebuilt:
    names = [f"libcontact-{name}.a" for name in ADDON_HEADERS] + ["libcontact.a"]
    sources, objects = [], [str(Path(prebuilt) / name) for name in names]
else:
    sources = sorted(
        str(path)
        for path in (LIBRARY / "src").rglob("*.c")
        if path.parent.name not in ADDON_HEADERS
        or (path.name == "missing.c") == (path.parent.name == "gsl" or sys.platform == "win32")
    )
    objects = []

# The clock that tells what each effect costs: wall time in seconds.
CLOCK = """
#include <time.h>
#ifdef _WIN32
static double wall_clock(void) { return (double)clock() / CLOCKS_PER_SEC; }
#else
static double wall_clock(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
#endif
"""

# An allocator that counts the bytes that the library holds; each block stores its size before it.
COUNTED = """
#include <stdlib.h>
#ifdef __GNUC__
#define ADD(to, n) __atomic_add_fetch(to, n, __ATOMIC_RELAXED)
#else
#define ADD(to, n) (*(to) += (n))
#endif
static long long held;
static long long bytes_held(void) { return ADD(&held, 0); }
static void *counted_allocate(size_t size, void *context)
{
  size_t *block = size > (size_t)-1 - 16 ? NULL : calloc(size + 16, 1);
  (void)context;
  if (block == NULL) return NULL;
  *block = size + 16;
  ADD(&held, (long long)*block);
  return (char *)block + 16;
}
static void counted_release(void *memory, void *context)
{
  size_t *block = (size_t *)(void *)((char *)memory - 16);
  (void)context;
  ADD(&held, -(long long)*block);
  free(block);
}
static ct_status count_memory(void)
{
  ct_allocator counted = {counted_allocate, counted_release, NULL, 1};
  return ct_set_allocator(&counted, NULL);
}
"""

# Functions of an effect that is written in Python (effects/own.py).
OWN = """
extern "Python" {
  ct_status own_force(const ct_effect *, const ct_view *, double *, ct_error *);
  ct_status own_energy(const ct_effect *, const ct_view *, double *, ct_error *);
  ct_status own_omega2_bound(const ct_effect *, const ct_view *, double *, ct_error *);
  ct_status own_rate_bound(const ct_effect *, const ct_view *, double *, ct_error *);
}
"""

# HDF5's calls by name, in the library that h5py has loaded (hdf5.py).
LOAD = "int ct_hdf5_load(void *(*find)(const char *name));"

ffi = cffi.FFI()
ffi.cdef(
    "\n".join(map(declarations, headers))
    + "\nstatic double wall_clock(void); long long bytes_held(void); ct_status count_memory(void);"
    + OWN
    + 'extern "Python" void *hdf5_find(const char *name);'
    + LOAD
)
ffi.set_source(
    "libcontact._core",
    "\n".join(f"#include <{header}>" for header in ["libcontact.h", *ADDON_HEADERS.values()])
    + CLOCK
    + COUNTED
    + LOAD,
    sources=sources,
    include_dirs=[str(INCLUDE), str(LIBRARY / "src/hdf5/loaded")],
    extra_objects=objects,
    extra_compile_args=[]
    if sys.platform == "win32"
    else FLAGS + pkg_config("--cflags", packages if prebuilt else []),
    extra_link_args=openmp + pkg_config("--libs", packages if prebuilt else []),
    libraries=["m"] if sys.platform != "win32" else [],
)
