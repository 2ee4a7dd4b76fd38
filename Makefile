# Every command of the project; `make help` lists them. There is no configure step: this file finds out what the machine has.
#
# make figures | test | docs | measured | bench set up what is missing first (wrapper/bootstrap.sh), then call make again, so that the second
# make sees what the first one installed. BOOTSTRAP=no never installs system packages. WITHOUT="gsl hdf5" builds as if they were not there.

CC ?= cc
CXX ?= c++
AR ?= ar
# make's own default, f77, is no compiler of this machine.
ifeq ($(origin FC),default)
FC := $(firstword $(foreach f,gfortran flang-new flang ifx,$(shell command -v $(f) 2>/dev/null)))
endif
PYTHON ?= python3
PKG_CONFIG ?= pkg-config
prefix ?= /usr/local
includedir ?= $(prefix)/include
libdir ?= $(prefix)/lib
mandir ?= $(prefix)/share/man
# clang packs pairs of numbers into vectors whose shuffles take longer than what they save, in contact's searches most.
NO_PAIRS := -fno-slp-vectorize
IS_CLANG := $(shell $(CC) --version 2>/dev/null | grep clang)
OPT ?= -O3 $(if $(IS_CLANG),$(NO_PAIRS))
BUILD := build
empty :=
VERSION := $(subst $(empty) $(empty),.,$(shell sed -n 's/^ *CT_VERSION_[A-Z]* = \([0-9]\).*/\1/p' libcontact/include/libcontact/base.h))
# Before 1.0 a minor version may change the interface, so each has its own name.
SONAME := $(basename $(VERSION))
WITHOUT ?=
# V=1 shows every command as it runs.
V ?=
Q := $(if $(V),,@)
BOOTSTRAP ?= yes
override prefix := $(abspath $(prefix))

# Commands that set up the same build/ follow each other, under -j too; the makes that they call may run in parallel.
ifneq ($(filter figures test test-mpi check-mpi test-page page test-hosts docs slides pdf measured bench stability accuracy wheel wheels check-cross check-c fuzz kill zoo coverage memory clean,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif

# -- What the machine has -----------------------------------------------------------------------------------------------
first_package = $(firstword $(foreach p,$(1),$(shell $(PKG_CONFIG) --exists $(p) 2>/dev/null && echo $(p))))
GSL := $(if $(filter gsl,$(WITHOUT)),,$(call first_package,gsl))
HDF5 := $(if $(filter hdf5,$(WITHOUT)),,$(call first_package,hdf5-serial hdf5))
OPENMP := $(if $(filter openmp,$(WITHOUT)),,$(shell printf 'int main(void){return 0;}' | $(CC) -fopenmp -x c - -o /dev/null 2>/dev/null && echo -fopenmp))
HAVE_CXX := $(shell command -v $(CXX) 2>/dev/null)
HAVE_FC := $(if $(FC),$(shell command -v $(FC) 2>/dev/null))
HAVE_PKG_CONFIG := $(shell command -v $(PKG_CONFIG) 2>/dev/null)
ADDONS := gsl hdf5

# -ffp-contract=off: the same bits from every compiler. -fopenmp-simd: vector lanes without a runtime. -fno-math-errno: roots in lanes, too.
# -Wno-pass-failed: clang says of a loop that it did not make vectors, and need not.
WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-pass-failed $(if $(CI),-Werror)
BASE := -std=c99 -ffp-contract=off -fno-math-errno $(if $(OPENMP),-fopenmp,-fopenmp-simd) -fPIC -fvisibility=hidden -Ilibcontact/include
CORE_FLAGS := $(BASE) $(WARNINGS) $(CFLAGS)
GSL_FLAGS = $(if $(GSL),$(shell $(PKG_CONFIG) --cflags $(GSL)))
HDF5_FLAGS = $(if $(HDF5),$(shell $(PKG_CONFIG) --cflags $(HDF5)),-Ilibcontact/src/hdf5/loaded)
GSL_LIBS = $(if $(GSL),$(shell $(PKG_CONFIG) --libs $(GSL)))
HDF5_LIBS = $(if $(HDF5),$(shell $(PKG_CONFIG) --libs $(HDF5)))

# -- Files ---------------------------------------------------------------------------------------------------------------
HEADERS := $(wildcard libcontact/include/*.h libcontact/include/*/*.h)
CORE_SOURCES := $(filter-out libcontact/src/gsl/% libcontact/src/hdf5/%,$(wildcard libcontact/src/*/*.c))
# An add-on without its package is one source, whose calls refuse. HDF5 may also be loaded later, where files are those of POSIX.
addon_sources = $(if $(2),$(filter-out %/missing.c,$(wildcard libcontact/src/$(1)/*.c)),libcontact/src/$(1)/missing.c)
GSL_SOURCES := $(call addon_sources,gsl,$(GSL))
HDF5_SOURCES := $(call addon_sources,hdf5,$(if $(findstring -windows,$(CC))$(findstring -wasi,$(CC)),$(HDF5),loaded))
object = $(patsubst libcontact/src/%.c,$(1)/%.o,$(2))
CORE_OBJECTS := $(call object,$(BUILD)/obj,$(CORE_SOURCES))
ADDON_ARCHIVES := $(foreach a,$(ADDONS),$(BUILD)/lib/libcontact-$(a).a)
ARCHIVES := $(BUILD)/lib/libcontact.a $(ADDON_ARCHIVES)
SHARED := $(ARCHIVES:.a=.so)
WRAPPER := $(wildcard wrapper/*.py wrapper/libcontact/*.py wrapper/libcontact/*/*.py tutorials/scenes/*.toml tutorials/scenes/*.inp) wrapper/libcontact/py.typed wrapper/libcontact/planning/prices.csv wrapper/libcontact/_core.pyi setup.py pyproject.toml
VENV := $(BUILD)/venv

.PHONY: help all format lib archives install wheel wheels check-cross figures test docs slides pdf measured bench stability accuracy check-c fuzz kill zoo coverage threads memory tidy info clean setup book-tools notebook-tools
.PHONY: page test-page page-tools _page _test-page mpi install-mpi test-mpi _test-mpi check-mpi _check-mpi _zoo _figures _test _docs _slides _pdf _measured _bench _stability _accuracy _wheel _wheels _check-cross _check-c _fuzz _kill _memory test-hosts _test-hosts
.DELETE_ON_ERROR:

help:
	@echo "make figures          the plate impact: Figs. 3, 4, 5 in build/figures, errors against the exact solution"
	@echo "make test             all tests; the last line has their number"
	@echo "make check-c          only the C tests, without a Python environment"
	@echo "make docs             the book, in build/docs/html; STUDENT=1: without the answers of the exercises, in build/docs/student"
	@echo "make slides           the book with a deck of slides per week of its courses, in build/docs/html/slides"
	@echo "make pdf              the course, the book and the reference as PDFs (made by Chromium), in build/docs/html"
	@echo "make page             the laboratories of the book, with the library in WebAssembly, in build/page: opens from a disk"
	@echo "make measured         compute the numbers that the book quotes again, into docs/measured.json"
	@echo "make bench            measurements of speed: tables, and a picture of the projections, in build/bench"
	@echo "make stability        hard cases, each with its classification, in build/stability"
	@echo "make accuracy         errors and run times of every method, in build/accuracy; continues after an interruption (ACCURACY=--reduced: minutes)"
	@echo "make lib              the C libraries, in build/lib"
	@echo "make install prefix=  headers, libraries and pkg-config files (DESTDIR works too)"
	@echo "make wheel            the Python package, in build/wheel"
	@echo "make wheels           the Python package for Linux, Windows and macOS, in build/wheels (WHEELS=\"linux-x86_64 ...\": some of them)"
	@echo "make check-cross      the same runs by gcc, clang, musl, aarch64, Windows, WebAssembly, as far as they run here: bits, speed, size"
	@echo "make info             what was found on this machine"
	@echo "make fuzz             random calls, scenes, optimisations, files and faces, for FUZZ_SECONDS (60); total counts in build/fuzz"
	@echo "make kill             kill KILLS (100) runs while they write; each file must open and its run continue"
	@echo "make zoo              everyday scenes with all options, judged by oracles, in build/zoo; continues after an interruption (ZOO=\"--draws 0 SCENE\")"
	@echo "make coverage         lines and branches of the C library that the C tests run, by file, in build/coverage/index.html"
	@echo "make threads          states stepped by several threads, under the thread sanitizer"
	@echo "make test-mpi         one run on 1 to 4 processes of MPI; installs mpich, mpi4py and pymetis from the Python index"
	@echo "make check-mpi        scenes and the laboratory's short list on 1 to 4 processes, each cut in five ways: equal bits"
	@echo "make mpi MPICC=       the add-on library for hosts with MPI, in build/mpi; make install-mpi prefix= installs it, too"
	@echo "make test-hosts       the contact in scikit-fem, NGSolve and Akantu, and beside that of CalculiX; installs them"
	@echo "make test-page        the laboratories in Node, Chromium and Firefox, moved by pointer and keys"
	@echo "make memory           C tests under valgrind"
	@echo "make format           the layout of all C and Python sources"
	@echo "make tidy             clang's warnings, clang-tidy and codespell"
	@echo "make clean            remove build/"
	@echo "BOOTSTRAP=no never installs system packages; WITHOUT=\"gsl hdf5 openmp\" leaves parts out; V=1 shows the commands."

all: lib
lib: archives $(SHARED)
archives: $(ARCHIVES)

# -- Libraries -------------------------------------------------------------------------------------------------------------
# Flags that a change of must rebuild for: compiler, options, parts.
$(BUILD)/flags: FORCE
	@mkdir -p $(BUILD)
	@echo '$(CC) $(OPT) $(CORE_FLAGS) $(GSL) $(HDF5)' | cmp -s - $@ || echo '$(CC) $(OPT) $(CORE_FLAGS) $(GSL) $(HDF5)' > $@
FORCE:

$(BUILD)/obj/gsl/%.o $(BUILD)/asan/gsl/%.o: EXTRA = $(GSL_FLAGS)
$(BUILD)/obj/hdf5/%.o $(BUILD)/asan/hdf5/%.o: EXTRA = $(HDF5_FLAGS)
$(BUILD)/obj/%.o: libcontact/src/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  cc $<"
	$(Q)$(CC) $(OPT) $(CORE_FLAGS) $(EXTRA) $(SMALL) -MMD -MP -c $< -o $@

$(BUILD)/lib/libcontact.a: $(CORE_OBJECTS)
$(BUILD)/lib/libcontact-gsl.a: $(call object,$(BUILD)/obj,$(GSL_SOURCES))
$(BUILD)/lib/libcontact-hdf5.a: $(call object,$(BUILD)/obj,$(HDF5_SOURCES))
$(BUILD)/lib/%.a:
	@mkdir -p $(@D)
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(BUILD)/lib/libcontact.so: $(CORE_OBJECTS)
	@mkdir -p $(@D)
	$(Q)$(CC) -shared $(OPENMP) -Wl,-soname,libcontact.so.$(SONAME) -o $@ $^ -lm
	$(Q)ln -sf libcontact.so $(BUILD)/lib/libcontact.so.$(SONAME)
# An add-on sees the core through its public calls and finds it beside itself; the private helper it needs comes along, hidden.
HELPERS := $(BUILD)/obj/base/error.o
$(BUILD)/lib/libcontact-%.so: $(BUILD)/lib/libcontact-%.a $(BUILD)/lib/libcontact.so $(HELPERS)
	$(Q)$(CC) -shared -Wl,--no-undefined -Wl,-rpath,'$$ORIGIN' -Wl,-soname,libcontact-$*.so.$(SONAME) -o $@ -Wl,--whole-archive $< -Wl,--no-whole-archive \
	  $(HELPERS) -L$(BUILD)/lib -lcontact $(if $(filter gsl,$*),$(GSL_LIBS),$(HDF5_LIBS)) -lm
	$(Q)ln -sf libcontact-$*.so $(BUILD)/lib/libcontact-$*.so.$(SONAME)

-include $(wildcard $(foreach d,obj asan tsan fuzz/obj,$(BUILD)/$(d)/*.d $(BUILD)/$(d)/*/*.d))

# -- Installation -----------------------------------------------------------------------------------------------------------
PACKAGE = $(DESTDIR)$(libdir)/cmake/libcontact
FILL = sed -e 's|@prefix@|$(prefix)|; s|@includedir@|$(includedir)|; s|@libdir@|$(libdir)|; s|@version@|$(VERSION)|; s|@soname@|$(SONAME)|; s|@openmp@|$(OPENMP)|; s|@gsl@|$(GSL)|; s|@hdf5@|$(HDF5)|'
# One library from a folder of the build, in both kinds, and what pkg-config knows of it.
install_library = cp $(2)/lib$(1).a $(DESTDIR)$(libdir)/ && \
  cp $(2)/lib$(1).so $(DESTDIR)$(libdir)/lib$(1).so.$(VERSION) && \
  ln -sf lib$(1).so.$(VERSION) $(DESTDIR)$(libdir)/lib$(1).so.$(SONAME) && \
  ln -sf lib$(1).so.$(SONAME) $(DESTDIR)$(libdir)/lib$(1).so && \
  $(FILL) libcontact/lib$(1).pc.in > $(DESTDIR)$(libdir)/pkgconfig/lib$(1).pc
install: lib
	$(Q)mkdir -p $(DESTDIR)$(includedir)/libcontact $(DESTDIR)$(libdir)/pkgconfig $(DESTDIR)$(mandir)/man3 $(PACKAGE)
	$(Q)cp libcontact/include/*.h $(DESTDIR)$(includedir)/
	$(Q)cp libcontact/include/libcontact/*.h libcontact/fortran/libcontact.f90 $(DESTDIR)$(includedir)/libcontact/
	$(Q)$(FILL) libcontact/libcontact.3.in > $(DESTDIR)$(mandir)/man3/libcontact.3
	$(Q)for f in config config-version; do $(FILL) libcontact/libcontact-$$f.cmake.in > $(PACKAGE)/libcontact-$$f.cmake || exit 1; done
	$(Q)for a in contact $(ADDONS:%=contact-%); do $(call install_library,$$a,$(BUILD)/lib) || exit 1; done
	@echo "  installed in $(DESTDIR)$(prefix)"

# -- Set-up: system packages, then the Python environment ----------------------------------------------------------------------
setup:
	@BOOTSTRAP=$(BOOTSTRAP) PYTHON="$(PYTHON)" PKG_CONFIG="$(PKG_CONFIG)" CXX="$(CXX)" WITHOUT="$(WITHOUT)" sh wrapper/bootstrap.sh $(MAKECMDGOALS)

# One pip at a time in the environment, also under -j.
PIP = $(if $(shell command -v flock 2>/dev/null),flock $(VENV)/.lock) $(VENV)/bin/python -m pip

$(VENV)/.base:
	@echo "  python environment $(VENV)"
	$(Q)$(PYTHON) -m venv $(VENV)
	$(Q)$(PIP) install -q --upgrade pip
	$(Q)touch $@
$(VENV)/.%: wrapper/requirements/%.txt $(VENV)/.base
	@echo "  pip install -r $<"
	$(Q)$(PIP) install -q -r $<
	$(Q)touch $@
# What setuptools leaves in build/: it would take an extension from there for a new one.
SETUPTOOLS_LEFT := $(BUILD)/lib.* $(BUILD)/bdist.* $(BUILD)/temp.*
# The extension is linked with the archives above; `pip install .` alone compiles the core by itself.
$(VENV)/.wrapper: $(ARCHIVES) $(HEADERS) $(WRAPPER) $(VENV)/.run
	@echo "  wrapper"
	@rm -rf $(SETUPTOOLS_LEFT)
	$(Q)LIBCONTACT_PREBUILT=$(abspath $(BUILD)/lib) LIBCONTACT_PACKAGES="$(GSL) $(HDF5)" \
	  LIBCONTACT_OPENMP="$(OPENMP)" CC="$(CC)" PKG_CONFIG="$(PKG_CONFIG)" \
	  $(PIP) install -q --no-deps --no-build-isolation --force-reinstall .
	@rm -rf $(SETUPTOOLS_LEFT)
	$(Q)touch $@

# As many compilers at a time as there are processors, where the caller says nothing else.
JOBS = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1))
figures test test-page page docs slides pdf measured bench stability accuracy wheel wheels check-cross: setup
	@+$(MAKE) --no-print-directory $(JOBS) _$@
check-c:
	@+$(MAKE) --no-print-directory $(JOBS) _$@

# -- Figures, book, bench, wheel --------------------------------------------------------------------------------------------------
_figures: $(VENV)/.wrapper
	@mkdir -p $(BUILD)/figures
	MPLBACKEND=Agg LIBCONTACT_FIGURES=$(BUILD)/figures $(VENV)/bin/python tutorials/01_plate_impact.py
	@echo "written: $(BUILD)/figures/"

# STUDENT=1: the book without the answers of its exercises, in a folder of its own.
STUDENT ?=
BOOK := $(BUILD)/docs/$(if $(STUDENT),student,html)
# No file of the students' book has an answer.
CHECK_ANSWERS = $(if $(STUDENT),$(VENV)/bin/python docs/answers.py $(BOOK))
_docs: $(VENV)/.wrapper $(VENV)/.docs page-tools
	MPLBACKEND=Agg $(VENV)/bin/python -m sphinx -W --keep-going -n -q -b html $(if $(STUDENT),-D student=1) docs $(BOOK)
	$(CHECK_ANSWERS)
	@echo "written: $(BOOK)/index.html"

_slides: _docs
	@echo "written: $(BOOK)/slides/, the decks of the weeks: six/1.html ... twelve/12.html"

_pdf: _docs $(VENV)/.browser
	$(VENV)/bin/python docs/printed.py $(BOOK)
	$(CHECK_ANSWERS)

# The library in a page: WebAssembly with vector instructions. zig by itself takes -Oz for -Os.
PAGE_OPT := -Oz -Xclang -Oz -fno-pic -msimd128
$(BUILD)/page/core/lib/libcontact.a: FORCE $(VENV)/.cross
	+@$(MAKE) --no-print-directory $@ BUILD=$(BUILD)/page/core CC="$(ZIG) cc -target wasm32-wasi" AR="$(ZIG) ar" CFLAGS="$(PAGE_OPT)" OPT= WITHOUT="gsl hdf5 openmp"
$(BUILD)/page/module.wasm: $(BUILD)/page/core/lib/libcontact.a $(wildcard docs/laboratory/module/*)
	@echo "  module $@"
	$(Q)$(ZIG) cc -target wasm32-wasi -mexec-model=reactor -std=c99 -ffp-contract=off $(PAGE_OPT) -s $(WARNINGS) -Wl,--max-memory=536870912 \
	  -Ilibcontact/include docs/laboratory/module/*.c $< -o $@
.SECONDARY: $(VENV)/.cross
_page: $(BUILD)/page/module.wasm $(VENV)/.wrapper
	$(VENV)/bin/python tools/build_page.py $< $(BUILD)/page/html
	@echo "written: $(BUILD)/page/html/index.html"
_test-page: _page $(VENV)/.test $(VENV)/.docs $(VENV)/.browser
	LIBCONTACT_BUILD=$(BUILD) LIBCONTACT_PAGE_ACTIONS=60 $(VENV)/bin/python -m pytest -q tests/python/test_page.py tests/docs/test_laboratory.py

# Without the cross compiler the book has pictures in place of its laboratories.
page-tools: $(VENV)/.wrapper
	@+$(MAKE) --no-print-directory _page || echo "no cross compiler, so the laboratories of the book are pictures: wrapper/requirements/cross.txt" >&2

_measured: $(VENV)/.wrapper
	$(VENV)/bin/python docs/measure.py
	@echo "written: docs/measured.json"

_bench: $(VENV)/.wrapper $(VENV)/.bench
	$(VENV)/bin/python bench/run.py $(BUILD)/bench
	@echo "written: $(BUILD)/bench/"

_stability: $(VENV)/.wrapper
	$(VENV)/bin/python stability/run.py $(BUILD)/stability
	@echo "written: $(BUILD)/stability/"

# A table that was stopped goes on where it was.
_accuracy: $(VENV)/.wrapper $(VENV)/.bench
	MPLBACKEND=Agg $(VENV)/bin/python accuracy/run.py $(BUILD)/accuracy $(ACCURACY)
	@echo "written: $(BUILD)/accuracy/"

# The library for other machines, by the clang of the Python index, of whose runtime nothing comes along (CT_OWN_RUNTIME), and the wheels made
# of it. WHEELS and CROSS name some of the targets.
CROSS_TARGETS := linux-x86_64=x86_64-linux-gnu.2.17 linux-aarch64=aarch64-linux-gnu.2.17 musl-x86_64=x86_64-linux-musl musl-aarch64=aarch64-linux-musl \
  windows-x86_64=x86_64-windows-gnu macos-x86_64=x86_64-macos.11.0 macos-arm64=aarch64-macos.11.0 wasm32=wasm32-wasi wasm32-simd=wasm32-wasi
cross_target = $(patsubst $(1)=%,%,$(filter $(1)=%,$(CROSS_TARGETS)))
WHEELS ?= linux-x86_64 linux-aarch64 musl-x86_64 musl-aarch64 windows-x86_64 macos-x86_64 macos-arm64
CROSS ?= linux-x86_64 musl-x86_64 musl-aarch64 windows-x86_64 wasm32 wasm32-simd
# What unwinds a stack for C++ is of no use in a wheel. What runs once a run or for output is compiled for size, and of contact's loops
# those are unrolled that gain most for their size: products, those of friction, too, and what looks for the nearest face of a point.
CROSS_OPT = -O3 $(NO_PAIRS) -g0 -fno-asynchronous-unwind-tables -fno-unwind-tables $(if $(filter %-simd,$(1)),-msimd128)
FOR_SIZE := $(addsuffix /%,mesh exact dispersion scene host shape hdf5 gsl) $(addprefix solid/,below blocks bound element stress part call sleep) \
  $(addprefix projection/,nelder_mead simplex simplex_newton bfgs broyden steepest_descent sphere torus certified least_squares patch iterate ray) \
  $(addprefix step/,probe piece bisect state monitor energy cut effect integrator lanczos layers stable subdivide) \
  $(addprefix effect/,tie rigid load absorb rotation initial_stress) $(addprefix contact/,traction bound penetration result surfaces) \
  search/inside_out
NOT_UNROLLED := contact/% gap/% search/% projection/proof projection/robust% effect/viscosity \
  $(addprefix constraint/,active law law_rows losses matrix matrix_fill problem release solve tangent tangent_bound tangent_follow tangent_iterate tangent_lanes tangent_settle)
FOR_WHEELS = $(if $(findstring -DCT_OWN_RUNTIME,$(CFLAGS)),$(1))
$(FOR_SIZE:%=$(BUILD)/obj/%.o): SMALL = $(call FOR_WHEELS,-Os)
$(NOT_UNROLLED:%=$(BUILD)/obj/%.o): SMALL = $(call FOR_WHEELS,-fno-unroll-loops)
ZIG := $(abspath $(VENV))/bin/python -m ziglang
$(BUILD)/cross/%: FORCE $(VENV)/.cross
	@mkdir -p $@
	+@$(MAKE) --no-print-directory archives BUILD=$@ CC="$(ZIG) cc -target $(call cross_target,$*)" AR="$(ZIG) ar" OPT="$(call CROSS_OPT,$*)" \
	  WITHOUT="gsl hdf5" OPENMP=$(if $(filter wasm%,$*),,-fopenmp) CFLAGS=-DCT_OWN_RUNTIME
_wheels: $(WHEELS:%=$(BUILD)/cross/%) $(ARCHIVES) $(VENV)/.run
	$(VENV)/bin/python tools/build_wheels.py $(BUILD) $(foreach w,$(WHEELS),$w=$(call cross_target,$w))
	$(VENV)/bin/python tools/try_wheels.py $(BUILD) "$(CC) $(OPENMP)" $(foreach w,$(WHEELS),$w=$(call cross_target,$w))

# The same runs by all compilers and machines that can run here: their bits, their speed.
_check-cross: $(CROSS:%=$(BUILD)/cross/%) $(ARCHIVES)
	$(VENV)/bin/python tools/check_cross.py $(BUILD) "$(CC) $(OPENMP)" $(foreach c,$(CROSS),$c=$(call cross_target,$c))

_wheel: $(VENV)/.run
	@rm -rf $(SETUPTOOLS_LEFT) $(BUILD)/wheel
	$(Q)CC="$(CC)" $(PIP) wheel -q --no-deps --no-build-isolation -w $(BUILD)/wheel .
	@rm -rf $(SETUPTOOLS_LEFT)
	@ls $(BUILD)/wheel

# -- Tests ------------------------------------------------------------------------------------------------------------------------
# Each tests/c/test_*.c is a program; those of the add-ons are built when their packages are there. Once plainly, once with sanitizers.
ADDON_TESTS := exact_series output output_faults
C_TESTS := $(filter-out $(ADDON_TESTS),$(patsubst tests/c/test_%.c,%,$(wildcard tests/c/test_*.c))) \
  $(if $(GSL),$(patsubst tests/c/test_%.c,%,$(wildcard tests/c/test_exact_series.c))) \
  $(if $(HDF5),output output_faults)
# At -O1 clang makes no vectors, and need not say so. The tests themselves need no -O: they compile twice as fast and run as long.
SANITIZE := -O1 -g1 -fsanitize=address,undefined -fno-omit-frame-pointer -DCT_NO_CLONES -DCT_SHORT_LOOPS -Wno-pass-failed
SANITIZERS = $(shell printf 'int main(void){return 0;}' | $(CC) -fsanitize=address,undefined -x c - -o /dev/null 2>/dev/null && echo yes)
TEST_FLAGS := -std=c99 -ffp-contract=off $(OPENMP) -Wall -Wextra $(if $(CI),-Werror) -Ilibcontact/include -Itests/c
ASAN_OBJECTS := $(call object,$(BUILD)/asan,$(CORE_SOURCES) $(GSL_SOURCES) $(HDF5_SOURCES))

$(BUILD)/asan/%.o: libcontact/src/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  cc (sanitizers) $<"
	$(Q)$(CC) $(SANITIZE) $(CORE_FLAGS) $(EXTRA) -MMD -MP -c $< -o $@
$(BUILD)/asan/libcontact.a: $(ASAN_OBJECTS)
	$(Q)rm -f $@ && $(AR) rcs $@ $^
TEST_LIBS = $(GSL_LIBS) $(HDF5_LIBS) -lpthread -lm
$(BUILD)/tests/test_%: tests/c/test_%.c $(wildcard tests/c/*.h tests/fuzz/*.c) $(ARCHIVES)
	@mkdir -p $(@D)
	$(Q)$(CC) -O1 $(TEST_FLAGS) $(HDF5_FLAGS) $< -o $@ $(ADDON_ARCHIVES) $(BUILD)/lib/libcontact.a $(TEST_LIBS)
$(BUILD)/tests/asan_%: tests/c/test_%.c $(wildcard tests/c/*.h tests/fuzz/*.c) $(BUILD)/asan/libcontact.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(SANITIZE) -O0 $(TEST_FLAGS) $(HDF5_FLAGS) $< -o $@ $(BUILD)/asan/libcontact.a $(TEST_LIBS)

# Programs of a host, built against an installed copy through pkg-config: C99, C++ and Fortran, static and shared.
STAGE := $(abspath $(BUILD)/stage)
EMBED = $(foreach p,host project,$(foreach l,static shared,$(BUILD)/tests/embed_$(p)_c_$(l) $(if $(HAVE_CXX),$(BUILD)/tests/embed_$(p)_cxx_$(l)))) \
  $(if $(HAVE_FC),$(foreach l,static shared,$(BUILD)/tests/embed_host_fortran_$(l)))
$(BUILD)/stage/.done: $(ARCHIVES) $(SHARED) $(HEADERS) $(wildcard libcontact/*.in libcontact/fortran/*)
	rm -rf $(BUILD)/stage
	$(MAKE) --no-print-directory install prefix=$(STAGE) DESTDIR=
	$(Q)touch $@
EMBED_PACKAGE := PKG_CONFIG_PATH=$(STAGE)/lib/pkgconfig $(PKG_CONFIG)
EMBED_FLAGS := `$(EMBED_PACKAGE) --cflags libcontact`
EMBED_SHARED := `$(EMBED_PACKAGE) --libs libcontact` -Wl,-rpath,$(STAGE)/lib -lm
EMBED_STATIC := `$(EMBED_PACKAGE) --libs --static libcontact | sed 's|-lcontact|$(STAGE)/lib/libcontact.a|'`
define embed_rules
$(BUILD)/tests/embed_%_c_$(1): tests/embed/%.c tests/c/tap.h $(BUILD)/stage/.done
	@mkdir -p $$(@D)
	$(Q)$(CC) -std=c99 -O1 -Wall -Wextra -Wpedantic -Werror -Itests/c $(EMBED_FLAGS) $$< -o $$@ $(2)
$(BUILD)/tests/embed_%_cxx_$(1): tests/embed/%.c tests/c/tap.h $(BUILD)/stage/.done
	@mkdir -p $$(@D)
	$(Q)$(CXX) -x c++ -std=c++11 -O1 -Wall -Wextra -Werror -Itests/c $(EMBED_FLAGS) $$< -x none -o $$@ $(2)
# A compiler leaves the description of a module where it is told to: here, one folder a program. What it names, the host finds by pkg-config.
$(BUILD)/tests/embed_%_fortran_$(1): tests/embed/%.f90 tests/embed/%_layout.c $(BUILD)/stage/.done
	@mkdir -p $$@.dir
	$(Q)$(CC) -std=c99 -O1 -Wall -Wextra -Wpedantic -Werror $(EMBED_FLAGS) -c tests/embed/$$*_layout.c -o $$@.dir/layout.o
	$(Q)cd $$@.dir && $(FC) -O1 `$(EMBED_PACKAGE) --variable=fortran libcontact` $$(abspath $$<) layout.o -o $$(abspath $$@) $(2)
endef
$(eval $(call embed_rules,static,$$(EMBED_STATIC)))
$(eval $(call embed_rules,shared,$$(EMBED_SHARED)))

C_PROGRAMS = $(C_TESTS:%=$(BUILD)/tests/test_%) $(if $(SANITIZERS),$(C_TESTS:%=$(BUILD)/tests/asan_%)) $(if $(HAVE_PKG_CONFIG),$(EMBED))
C_SKIPPED = $(if $(GSL),,--skip "test_exact_series: no GSL") $(if $(HDF5),,--skip "test_output: no HDF5" --skip "test_output_faults: no HDF5") \
  $(if $(SANITIZERS),,--skip "asan_*: $(CC) has no sanitizers") \
  $(if $(HAVE_PKG_CONFIG),$(if $(HAVE_CXX),,--skip "embed_*_cxx: no C++ compiler") \
    $(if $(HAVE_FC),,--skip "embed_host_fortran: no Fortran compiler"),--skip "embed_*: no pkg-config")

# What was found is asked once, for both the files to make and the programs to run.
ifneq ($(filter _test _check-c,$(MAKECMDGOALS)),)
C_PROGRAMS := $(C_PROGRAMS)
C_SKIPPED := $(C_SKIPPED)
endif

# Pages that were made once are made again, as their tests compare bits with this library.
_test: $(C_PROGRAMS) $(VENV)/.wrapper $(VENV)/.test book-tools notebook-tools $(if $(wildcard $(BUILD)/page/html/index.html),_page)
	@LIBCONTACT_BUILD=$(BUILD) CC="$(CC)" PKG_CONFIG="$(PKG_CONFIG)" $(VENV)/bin/python tests/run_tests.py $(BUILD) $(C_SKIPPED) $(C_PROGRAMS)

# Without a network for them, the tests of the book are skipped.
book-tools: $(VENV)/.test
	@+$(MAKE) --no-print-directory $(VENV)/.docs || echo "not installed, so the tests of the book are skipped: wrapper/requirements/docs.txt" >&2

# Likewise the test of the notebook.
notebook-tools: $(VENV)/.test
	@+$(MAKE) --no-print-directory $(VENV)/.notebook || echo "not installed, so the test of the notebook is skipped: wrapper/requirements/notebook.txt" >&2

_check-c: $(C_PROGRAMS)
	@$(PYTHON) tests/run_tests.py $(BUILD) --no-pytest $(C_SKIPPED) $(C_PROGRAMS)

# Pieces of a run on the processes of MPI: an engine and METIS from the Python index, and the add-on library, built with the engine's compiler.
MPICC ?= $(abspath $(VENV))/bin/mpicc
$(BUILD)/mpi/mpi.o: libcontact/mpi/mpi.c libcontact/mpi/libcontact/mpi.h $(HEADERS)
	@mkdir -p $(@D)
	$(Q)$(MPICC) $(OPT) -std=c99 -fPIC -fvisibility=hidden $(WARNINGS) -Ilibcontact/include -Ilibcontact/mpi -c $< -o $@
$(BUILD)/mpi/libcontact-mpi.a: $(BUILD)/mpi/mpi.o
	$(Q)rm -f $@ && $(AR) rcs $@ $<
$(BUILD)/mpi/libcontact-mpi.so: $(BUILD)/mpi/mpi.o
	$(Q)$(MPICC) -shared -Wl,-soname,libcontact-mpi.so.$(SONAME) -o $@ $<
mpi: $(BUILD)/mpi/libcontact-mpi.a $(BUILD)/mpi/libcontact-mpi.so
install-mpi: install mpi
	cp libcontact/mpi/libcontact/mpi.h $(DESTDIR)$(includedir)/libcontact/
	$(call install_library,contact-mpi,$(BUILD)/mpi)
$(BUILD)/mpi/pieces: tests/mpi/pieces.c $(BUILD)/mpi/libcontact-mpi.a $(BUILD)/lib/libcontact.a
	$(Q)$(MPICC) -O1 $(TEST_FLAGS) -Ilibcontact/mpi $^ -o $@ -lm
test-mpi check-mpi: setup
	@+$(MAKE) --no-print-directory _$@
_test-mpi: $(VENV)/.wrapper $(VENV)/.test $(VENV)/.mpi
	@+$(MAKE) --no-print-directory $(BUILD)/mpi/pieces
	@LIBCONTACT_BUILD=$(BUILD) $(VENV)/bin/python -m pytest -q tests/python/test_mpi.py
_check-mpi: $(VENV)/.wrapper $(VENV)/.mpi
	$(VENV)/bin/python tests/mpi/matrix.py

# Other programs as hosts of the contact. Each is installed alone, since not all are made for each machine; what is absent is skipped.
$(VENV)/.hosts: wrapper/requirements/hosts.txt $(VENV)/.base
	@sed '/^#/d' $< | while read -r each; do echo "  pip install $$each"; \
	  $(PIP) install -q "$$each" || echo "not installed, so its tests are skipped: $$each" >&2; done
	$(Q)touch $@
test-hosts: setup
	@+$(MAKE) --no-print-directory _$@
_test-hosts: $(VENV)/.wrapper $(VENV)/.test $(VENV)/.hosts
	@LIBCONTACT_HOSTS=1 $(VENV)/bin/python -m pytest -q tests/python/test_hosts.py

# The fuzz target: libFuzzer where $(CC) or a clang has it, with the library compiled for it; else pseudo-random bytes.
FUZZ_SECONDS ?= 60
# C tests of random numbers, of which a make test runs few, and how many times as many of them.
LONG := projection_certified contact_geometry
FUZZ_LONG ?= 10
FUZZ_CC = $(firstword $(foreach c,$(CC) clang clang-19 clang-18 clang-17 clang-16 clang-15 clang-14,$(shell command -v $(firstword $(c)) >/dev/null 2>&1 && \
  printf 'int LLVMFuzzerTestOneInput(const char*d,unsigned long n){return d==0&&n==1;}' | $(c) -fsanitize=fuzzer,address -x c - -o /dev/null 2>/dev/null && echo $(c))))
ifneq ($(filter _fuzz,$(MAKECMDGOALS)),)
FUZZ_CC := $(FUZZ_CC)
endif
FUZZ_OBJECTS := $(call object,$(BUILD)/fuzz/obj,$(CORE_SOURCES))
FUZZ_FLAGS := $(SANITIZE) -std=c99 -ffp-contract=off -fno-math-errno -fopenmp-simd -Ilibcontact/include
$(BUILD)/fuzz/obj/%.o: libcontact/src/%.c
	@mkdir -p $(@D)
	@echo "  $(FUZZ_CC) (fuzzer) $<"
	$(Q)$(FUZZ_CC) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link -MMD -MP -c $< -o $@
$(BUILD)/fuzz/libfuzzer_project: tests/fuzz/fuzz_project.c $(FUZZ_OBJECTS)
	$(Q)$(FUZZ_CC) $(FUZZ_FLAGS) -fsanitize=fuzzer $^ -o $@ -lm
$(BUILD)/fuzz/random_project: tests/fuzz/fuzz_project.c $(BUILD)/asan/libcontact.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(SANITIZE) $(TEST_FLAGS) -DFUZZ_MAIN=1 $< -o $@ $(BUILD)/asan/libcontact.a $(TEST_LIBS)
# The target of the whole library: its own program, with the library under the sanitizers.
$(BUILD)/fuzz/random_api: tests/fuzz/fuzz_api.c tests/fuzz/dice.h tests/fuzz/seeds.h $(BUILD)/asan/libcontact.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(SANITIZE) $(TEST_FLAGS) -D_GNU_SOURCE -DFUZZ_MAIN=1 $(if $(HDF5),-DFUZZ_HDF5=1 $(HDF5_FLAGS)) $< -o $@ $(BUILD)/asan/libcontact.a $(TEST_LIBS)
# Likewise the target of what may be left out.
$(BUILD)/fuzz/random_optimisations: tests/fuzz/fuzz_optimisations.c tests/fuzz/dice.h tests/fuzz/seeds.h $(BUILD)/asan/libcontact.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(SANITIZE) $(TEST_FLAGS) -D_GNU_SOURCE -DFUZZ_MAIN=1 $< -o $@ $(BUILD)/asan/libcontact.a $(TEST_LIBS)
fuzz: setup
	@+$(MAKE) --no-print-directory _fuzz
_fuzz: $(if $(filter _fuzz,$(MAKECMDGOALS)),$(BUILD)/fuzz/$(if $(FUZZ_CC),libfuzzer_project,random_project)) $(if $(SANITIZERS),$(BUILD)/fuzz/random_api $(BUILD)/fuzz/random_optimisations $(LONG:%=$(BUILD)/tests/asan_%)) $(VENV)/.wrapper $(VENV)/.test
	@mkdir -p $(BUILD)/fuzz/corpus
	$(VENV)/bin/python tests/fuzz/run_fuzz.py $(FUZZ_SECONDS) $(BUILD)/fuzz $(if $(SANITIZERS),$(BUILD)/fuzz/random_api $(BUILD)/fuzz/random_optimisations)
	$< $(if $(FUZZ_CC),-max_total_time=$(FUZZ_SECONDS) -artifact_prefix=$(BUILD)/fuzz/ $(BUILD)/fuzz/corpus,1000000)
	@for t in $(if $(SANITIZERS),$(LONG)); do echo "  $(FUZZ_LONG) times test_$$t"; \
	  TAP_LONG=$(FUZZ_LONG) $(BUILD)/tests/asan_$$t > $(BUILD)/fuzz/$$t.txt 2>&1 || { grep -v '^ok' $(BUILD)/fuzz/$$t.txt; exit 1; }; done

# Runs that are killed while they write.
KILLS ?= 100
kill: setup
	@+$(MAKE) --no-print-directory _kill
_kill: $(VENV)/.wrapper $(VENV)/.test
	$(VENV)/bin/python stability/kill.py $(KILLS)

# Everyday scenes; what was run stays, and the same command goes on.
zoo: setup
	@+$(MAKE) --no-print-directory $(JOBS) _zoo
_zoo: $(VENV)/.wrapper
	$(VENV)/bin/python stability/zoo.py $(BUILD)/zoo $(ZOO)

# The C tests with a library that counts lines and branches (gcov), in a build of its own.
coverage: $(VENV)/.coverage
	@rm -rf $(BUILD)/coverage/tests && find $(BUILD) -path '*/coverage/*.gcda' -delete
	+-$(MAKE) --no-print-directory $(JOBS) _check-c BUILD=$(BUILD)/coverage CC="$(CC) --coverage" OPT="-O1 -fno-early-inlining" \
	  CFLAGS="-DCT_NO_CLONES -DCT_SHORT_LOOPS" SANITIZERS= HAVE_PKG_CONFIG=
	@rm -f *.gcno # of the compiler's probes
	$(VENV)/bin/gcovr --root . --filter libcontact/src/ --html-details $(BUILD)/coverage/index.html --print-summary $(BUILD)/coverage
	@echo "written: $(BUILD)/coverage/index.html"

# -- Threads and memory, looked at by other programs ----------------------------------------------------------------------------------
# Several states of one problem stepped by several threads of a host, under the thread sanitizer. Without OpenMP, whose runtime it does not see.
$(BUILD)/tsan/%.o: libcontact/src/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  cc (threads) $<"
	$(Q)$(CC) -O1 -g -fsanitize=thread -DCT_NO_CLONES $(filter-out -fopenmp,$(CORE_FLAGS)) -fopenmp-simd -MMD -MP -c $< -o $@
TSAN_OBJECTS := $(call object,$(BUILD)/tsan,$(CORE_SOURCES))
$(BUILD)/tsan/host_threads: tests/embed/threads.c $(TSAN_OBJECTS)
	$(Q)$(CC) -O1 -g -fsanitize=thread -std=c99 -Wall -Wextra -Ilibcontact/include $^ -o $@ -lpthread -lm
threads: $(BUILD)/tsan/host_threads
	TSAN_OPTIONS=halt_on_error=1 $<

# The C tests under valgrind; slow. MEMCHECK names some of them.
MEMCHECK ?= mesh mass solid solid_large solid_reduced plane_strain step subdivide integrator contact contact_status contact_geometry self_contact enforcement friction scene observe obstacle motion energy search \
  $(if $(HDF5),output) api_fuzz
memory: setup
	@+$(MAKE) --no-print-directory $(JOBS) _memory
_memory: $(MEMCHECK:%=$(BUILD)/tests/test_%)
	@for t in $(MEMCHECK); do echo "  valgrind test_$$t"; \
	  valgrind -q --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite --error-exitcode=99 $(BUILD)/tests/test_$$t > $(BUILD)/tests/memory.txt || { cat $(BUILD)/tests/memory.txt; exit 1; }; done

# -- Layout: .clang-format and pyproject.toml say how -------------------------------------------------------------------------------
format: $(VENV)/.test
	$(VENV)/bin/clang-format -i $$(git ls-files '*.c' '*.h')
	$(VENV)/bin/ruff check -q --fix .
	$(VENV)/bin/ruff format -q .

# Clang's warnings, the checks of .clang-tidy and codespell. Headers of packages are not ours.
TIDY_FLAGS = $(filter-out -fopenmp,$(CORE_FLAGS)) $(patsubst -I%,-isystem%,$(GSL_FLAGS) $(HDF5_FLAGS))
tidy: $(VENV)/.tidy
	@echo "  clang-tidy libcontact/src"
	$(Q)printf '%s\n' $(CORE_SOURCES) $(GSL_SOURCES) $(HDF5_SOURCES) | xargs -P $$(getconf _NPROCESSORS_ONLN) -n 1 sh -c '$(VENV)/bin/clang-tidy --quiet "$$0" -- $(TIDY_FLAGS) 2>/dev/null'
	@echo "  codespell"
	$(Q)$(VENV)/bin/codespell $$(git ls-files)

# -- The rest -----------------------------------------------------------------------------------------------------------------------
info:
	@echo "compiler   $(shell $(CC) --version | head -n 1)"
	@echo "flags      $(OPT) $(CORE_FLAGS)"
	@echo "OpenMP     $(if $(OPENMP),yes,no)"
	@echo "pkg-config $(if $(HAVE_PKG_CONFIG),$(HAVE_PKG_CONFIG),no: GSL and HDF5 cannot be found, the embedding tests are left out)"
	@echo "C++        $(if $(HAVE_CXX),$(HAVE_CXX),no: the C++ embedding tests are left out)"
	@echo "Fortran    $(if $(HAVE_FC),$(HAVE_FC),no: the Fortran embedding test is left out (gfortran is not set up by itself))"
	@echo "GSL        $(if $(GSL),$(GSL) $(shell $(PKG_CONFIG) --modversion $(GSL)),no: libcontact-gsl (the modal series) refuses every call)"
	@echo "HDF5       $(if $(HDF5),$(HDF5) $(shell $(PKG_CONFIG) --modversion $(HDF5)),no: results files and restart by the HDF5 of h5py, in Python only)"
	@echo "python     $(shell $(PYTHON) --version 2>&1) ($(PYTHON)), environment $(VENV)$(if $(wildcard $(VENV)/.wrapper),, (not made yet))"
	@echo "left out   $(if $(WITHOUT),$(WITHOUT),nothing (WITHOUT=\"gsl hdf5 openmp\" leaves parts out))"

clean:
	rm -rf $(BUILD) docs/tutorials docs/_code
