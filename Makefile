# lagc and liblag. `make help` lists what can be made; README.md says what it is for.

# ---- settings: make NAME=value ----------------------------------------------------------------------
.DEFAULT_GOAL := all
CC      ?= cc
CFLAGS  ?= -O2
CPPFLAGS ?=
LDFLAGS ?=
RANLIB  ?=
WERROR  ?=
WARN    := -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes $(WERROR)
BUILD   ?= build
SAN     ?=
FLEX    ?= flex
BISON   ?= bison
PREFIX  ?= /usr/local
LIBDIR  ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DESTDIR ?=
T       ?=

# Position-independent code lets liblag go into shared objects. It costs nothing measurable: without interposition calls within a file stay direct,
# and of 92 files 73 keep their instructions; the others take addresses of a few data from a table. Results keep their bits.
PIC ?= -fPIC -fno-semantic-interposition

# LIBDIR and INCLUDEDIR below PREFIX are relative to it in liblag.pc and in lagc, which can then be moved together.
below = $(subst ^,,$(subst ^$(PREFIX)/,$(1),^$(2)))
LIB_FROM_BIN     := $(call below,../,$(LIBDIR))
INCLUDE_FROM_BIN := $(call below,../,$(INCLUDEDIR))

CPPFLAGS_ALL := $(CPPFLAGS) -D_XOPEN_SOURCE=700
SRC_FLAGS    := $(CPPFLAGS_ALL) -Isrc -I$(BUILD)/gen
RT_FLAGS     := $(CPPFLAGS_ALL) -Iruntime/include -Iruntime -I$(BUILD)/gen -ffp-contract=off $(PIC)
SOVERSION     = $(shell sed -n 's/^.define LAG_ABI //p' runtime/include/lag_model.h 2>/dev/null)
VERSION       = $(shell sed -n 's/^.define LAG_VERSION "\(.*\)"/\1/p' runtime/include/lag.h 2>/dev/null)

# ---- what the C compiler can do ---------------------------------------------------------------------
# Results of probes stay in $(CONFIG). It is made when something is built, and again after a change of compiler, flags, folders or GSL's header.
CONFIG    := $(BUILD)/config.mk
CC_FILE   := $(firstword $(wildcard $(firstword $(CC)) $(addsuffix /$(firstword $(CC)),$(subst :, ,$(PATH)))))
CONFIG_OF := $(strip $(CC_FILE) $(CC) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS) $(LIB_FROM_BIN) $(INCLUDE_FROM_BIN) \
               $(wildcard $(foreach d,/usr /usr/local,$d/include/gsl/gsl_odeiv2.h $d/include/minizip/zip.h $d/include/librsvg-2.0/librsvg/rsvg.h $d/include/hdf5/serial/hdf5.h)) $(wildcard /usr/lib/*/openmpi/include/mpi.h))
BUILDS    := $(filter-out help clean uninstall,$(or $(MAKECMDGOALS),all))
ifneq ($(BUILDS),)
-include $(CONFIG)
endif

# ccache, where it is installed, keeps objects between builds and between copies of the tree; `make CCACHE=` does without.
CCACHE ?= $(firstword $(wildcard $(addsuffix /ccache,$(subst :, ,$(PATH)))))
export CCACHE_NOHASHDIR ?= 1

# GSL is optional: without it there are no gsl-* methods, and no liblag_gsl.a.
GSL := $(GSL_FOUND)
GSL_LIBS := $(if $(GSL),-lgsl -lgslcblas)
GSL_PROBE = \043include <gsl/gsl_odeiv2.h>\nint main(void) { return gsl_odeiv2_step_rk8pd == 0; }\n

# librsvg is optional: without it there are no pictures as PNG, and no liblag_png.a.
PNG := $(PNG_FOUND)
PNG_CFLAGS = $(shell pkg-config --cflags librsvg-2.0)
# The serial HDF5 is optional, too: `lagc sweep -o FILE.h5`.
HDF5 := $(HDF5_FOUND)
HDF5_CFLAGS = $(shell pkg-config --cflags $(HDF5))
# Open MPI: `lagc sweep --mpi K`.
MPI := $(MPI_FOUND)
MPI_CFLAGS = $(shell pkg-config --cflags ompi-c)
PARTS := $(if $(PNG),png) $(if $(HDF5),hdf5) $(if $(MPI),mpi)

# minizip of zlib writes the archives of FMUs: without it `lagc fmu` is refused.
ZIP := $(ZIP_FOUND)
ZIP_LIBS := $(if $(ZIP),-lminizip -lz)
ZIP_PROBE = \043include <minizip/zip.h>\nint main(void) { return zipOpen2_64 == 0; }\n

# The runtime for other numbers than doubles: `lagc run --precision`. Quad needs libquadmath, and a printf that learns from it.
QUAD_PROBE = \043include <quadmath.h>\n\043include <stdio.h>\n\043include <string.h>\nint main(void) { char s[40]; \
  snprintf(s, 40, "%%.3Qg", expq(0.0Q)/3); return strcmp(s, "0.333"); }\n
PRECISIONS ?= long $(QUAD_FOUND)
PRECISIONS := $(PRECISIONS)

# A flag that keeps the compiler from storing wrong numbers, where it does with these flags: src/toolchain/compiler_probe.in.
SAFE := $(SAFE_FOUND)

# A program that cannot run here, as in a cross build, finds nothing: no quad, no flag. After the restart of make the file is not made again.
HASH := \#
AS_SET = $(subst ','\'',$(subst $(HASH),\$(HASH),$(subst $$,$$$$,$(CONFIG_OF))))
ifneq ($(CONFIG_FOR),$(CONFIG_OF))
CONFIG_STALE := FORCE
endif
ifeq ($(MAKE_RESTARTS),)
$(CONFIG): Makefile src/toolchain/compiler_probe.in $(CC_FILE) $(CONFIG_STALE)
	@d=$(BUILD)/probe.$$$$ && mkdir -p $$d && { \
	  echo 'CONFIG_FOR := $(AS_SET)'; \
	  printf 'GSL_FOUND := '; printf '$(GSL_PROBE)' | $(CC) $(CPPFLAGS) $(LDFLAGS) -x c - -o $$d/gsl -lgsl -lgslcblas -lm 2>/dev/null && \
	    echo yes || echo; \
	  printf 'PNG_FOUND := '; p=$$(pkg-config --cflags --libs librsvg-2.0 2>/dev/null) && \
	    echo 'int main(void) { return rsvg_handle_render_document == 0; }' | $(CC) $(LDFLAGS) -include librsvg/rsvg.h -x c - -o $$d/png $$p 2>/dev/null && echo yes || echo; \
	  printf 'HDF5_FOUND := '; for n in hdf5-serial hdf5; do p=$$(pkg-config --cflags --libs $$n 2>/dev/null) && \
	    echo 'int main(void) { return H5DSset_scale == 0; }' | $(CC) $(LDFLAGS) -include hdf5.h -include hdf5_hl.h -x c - -o $$d/hdf5 $$p -lhdf5_hl 2>/dev/null && echo $$n && break; done || echo; \
	  printf 'MPI_FOUND := '; p=$$(pkg-config --cflags --libs ompi-c 2>/dev/null) && \
	    echo 'int main(void) { return MPI_Init_thread == 0; }' | $(CC) $(LDFLAGS) -include mpi.h -x c - -o $$d/mpi $$p 2>/dev/null && echo yes || echo; \
	  printf 'ZIP_FOUND := '; printf '$(ZIP_PROBE)' | $(CC) $(CPPFLAGS) $(LDFLAGS) -x c - -o $$d/zip -lminizip -lz 2>/dev/null && echo yes || echo; \
	  printf 'QUAD_FOUND := '; printf '$(QUAD_PROBE)' | $(CC) $(LDFLAGS) -std=gnu11 -w -x c - -o $$d/quad -lquadmath -lm 2>/dev/null && \
	    $$d/quad 2>/dev/null && echo quad || echo; \
	  printf 'SAFE_FOUND := '; $(CC) $(CFLAGS) $(LDFLAGS) -x c src/toolchain/compiler_probe.in -o $$d/safe 2>/dev/null && \
	    { $$d/safe 2>/dev/null; [ $$? = 1 ]; } && echo -fno-tree-slp-vectorize || echo; \
	  printf 'FAST_LINKER := '; echo 'int main(void) { return 0; }' | $(CC) $(LDFLAGS) -fuse-ld=gold -x c - -o $$d/gold 2>/dev/null && \
	    $$d/gold 2>/dev/null && command -v ld.gold || echo; \
	  printf 'WINDOWS_FOUND := '; echo _WIN32 | $(CC) -E -P -x c - 2>/dev/null | sed 's/^1$$/yes/; s/^_WIN32$$//'; \
	  printf 'ELF_FOUND := '; echo __ELF__ | $(CC) -E -P -x c - 2>/dev/null | sed 's/^1$$/yes/; s/^__ELF__$$//'; \
	  printf 'CLANG_X86 := '; printf '#if defined(__clang__) && defined(__x86_64__)\nyes\n#endif\n' | $(CC) -E -P -x c - 2>/dev/null | grep yes || echo; \
	  printf 'LONG_DIGITS := '; echo __LDBL_DECIMAL_DIG__ | $(CC) -E -P -x c - 2>/dev/null || echo; \
	} >$$d/config.mk; mv $$d/config.mk $@; rm -rf $$d
endif

# Windows, by MinGW: what POSIX has and Windows lacks stands in files *windows.c. Programs are static: no library of MinGW's has to come with them.
WINDOWS := $(WINDOWS_FOUND)
EXE     := $(if $(WINDOWS),.exe)
ifneq ($(WINDOWS),)
CPPFLAGS_ALL += -D__USE_MINGW_ANSI_STDIO=1
WARN += -Wno-format -Wno-conversion # gcc knows the formats of Microsoft's printf only; isnan of MinGW converts
endif

# ---- what is made of what ---------------------------------------------------------------------------
# Of runtime/numeric, the files that the compiler calls, too.
SHARED   := action_integral consistent_state magnitudes
NOT_HERE := $(if $(WINDOWS),%/process.c %/clock.c %/threads.c,%windows.c)
LAGC_SRC := $(filter-out src/main.c $(NOT_HERE),$(wildcard src/*.c src/*/*.c))
GEN_SRC  := $(patsubst %,$(BUILD)/gen/%,lag.tab.c lag.lex.c toolchain/outfile.c $(if $(WINDOWS),base/windows.c) $(SHARED:%=numeric/%.c))
RT_SRC   := $(filter-out runtime/gsl/% runtime/png/% runtime/hdf5/% runtime/mpi/% runtime/matlab/% $(NOT_HERE),$(wildcard runtime/*/*.c))
GSL_SRC  := $(wildcard runtime/gsl/*.c)

LAGC_OBJ := $(LAGC_SRC:%.c=$(BUILD)/obj/%.o) $(GEN_SRC:$(BUILD)/gen/%.c=$(BUILD)/obj/gen/%.o)
RT_OBJ   := $(RT_SRC:%.c=$(BUILD)/obj/%.o)
GSL_OBJ  := $(GSL_SRC:%.c=$(BUILD)/obj/%.o)

LIBLAG  := $(BUILD)/liblag.a $(if $(GSL),$(BUILD)/liblag_gsl.a) $(PARTS:%=$(BUILD)/liblag_%.a)
LIBLAG_MORE := $(PRECISIONS:%=$(BUILD)/liblag_%.a)
# The shared library, named after the ABI of models, where programs are ELF; `make DYNAMIC=` makes none.
DYNAMIC ?= $(ELF_FOUND)
LIBLAG_SO = $(if $(DYNAMIC),$(BUILD)/liblag.so.$(SOVERSION))

all: $(BUILD)/lagc$(EXE) $(LIBLAG) $(LIBLAG_MORE)
install: $(LIBLAG_SO)

# ---- the compiler and the runtime -------------------------------------------------------------------
$(BUILD)/lagc$(EXE): $(BUILD)/obj/src/main.o $(BUILD)/liblagc.a
	$(CC) $(CFLAGS) $(SAN) $(LDFLAGS) $(if $(WINDOWS),-static) -o $@ $^ $(ZIP_LIBS) -lm

# `ar s` writes the index; RANLIB is for an ar that does not.
ARCHIVE = rm -f $@ && $(AR) rcs $@
INDEX   = $(if $(RANLIB),$(RANLIB) $@)

# Everything of the compiler but main: what the unit tests link.
$(BUILD)/liblagc.a: $(LAGC_OBJ)
	$(ARCHIVE) $^
	$(INDEX)
$(BUILD)/liblag.a: $(RT_OBJ)
	$(ARCHIVE) $^
	$(INDEX)
# References within it are bound to its own functions.
$(BUILD)/liblag.so.%: $(RT_OBJ) runtime/liblag.map
	$(CC) $(CFLAGS) $(SAN) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,--version-script=runtime/liblag.map -Wl,-Bsymbolic -o $@ $(RT_OBJ) -lm
$(BUILD)/liblag_gsl.a: $(GSL_OBJ)
	$(ARCHIVE) $^
	$(INDEX)
# Beside it, what links it.
$(BUILD)/liblag_png.a: $(BUILD)/obj/runtime/png/png.o
	$(ARCHIVE) $^
	$(INDEX)
	@pkg-config --libs librsvg-2.0 >$(@:.a=.libs)
$(BUILD)/liblag_hdf5.a: $(BUILD)/obj/runtime/hdf5/hdf5.o
	$(ARCHIVE) $^
	$(INDEX)
	@pkg-config --libs-only-L --libs-only-l $(HDF5) | sed 's/-lhdf5/-lhdf5_hl &/' >$(@:.a=.libs)
$(BUILD)/liblag_mpi.a: $(BUILD)/obj/runtime/mpi/mpi.o
	$(ARCHIVE) $^
	$(INDEX)
	@pkg-config --libs ompi-c >$(@:.a=.libs)
# gcc takes the vectors from a pragma in the file; Clang passes vectors as the file's flags say.
$(BUILD)/obj/runtime/lanes/lanes_4.o: override CFLAGS += $(if $(CLANG_X86),-mavx2)
$(BUILD)/obj/runtime/lanes/lanes_8.o: override CFLAGS += $(if $(CLANG_X86),-mavx512f -mavx512dq)
$(BUILD)/obj/runtime/png/png.o: override CFLAGS += $(PNG_CFLAGS)
$(BUILD)/obj/runtime/hdf5/hdf5.o: override CFLAGS += $(HDF5_CFLAGS)
$(BUILD)/obj/runtime/mpi/mpi.o: override CFLAGS += $(MPI_CFLAGS)

$(BUILD)/gen/lag.tab.c: grammar/lag.y
	@mkdir -p $(@D)
	$(BISON) -Wall -Werror --defines=$(BUILD)/gen/lag.tab.h -o $@ $<
$(BUILD)/gen/lag.tab.h: $(BUILD)/gen/lag.tab.c ;
$(BUILD)/gen/lag.lex.c: grammar/lag.l
	@mkdir -p $(@D)
	$(FLEX) --header-file=$(BUILD)/gen/lag.lex.h -o $@ $<
$(BUILD)/gen/lag.lex.h: $(BUILD)/gen/lag.lex.c ;

$(BUILD)/obj/src/%.o: src/%.c
	@mkdir -p $(@D)
	$(CCACHE) $(CC) $(WARN) $(SRC_FLAGS) $(CFLAGS) $(SAFE) $(SAN) -MMD -MP -c -o $@ $<
$(BUILD)/obj/runtime/%.o: runtime/%.c
	@mkdir -p $(@D)
	$(CCACHE) $(CC) $(WARN) $(RT_FLAGS) $(CFLAGS) $(SAFE) $(SAN) -MMD -MP -c -o $@ $<

# Of one text, by runtime/precision.awk, in $(BUILD)/gen/long and $(BUILD)/gen/quad; lagc finds the headers in $(BUILD)/lag-long
# and $(BUILD)/lag-quad. src/toolchain/toolchain.c compiles models with the same LAG_REAL.
REAL_long := -std=c11 '-DLAG_REAL=long double' '-DLAG_PRECISION="long"'
REAL_quad := -std=gnu11 -include quadmath.h -DLAG_REAL=__float128 '-DLAG_PRECISION="quad"'
DIGITS_long := $(if $(filter long,$(PRECISIONS)),$(LONG_DIGITS))
DIGITS_quad := 36
RT_HEAD  := $(patsubst runtime/%,%,$(wildcard runtime/*/*.h))
API_HEAD := lag.h lag_libraries.h lag_model.h

%/app/where.o: override CFLAGS += -D_GNU_SOURCE # names of the registers in a signal's context
define precision_rules
$(BUILD)/gen/$(1)/%: runtime/% runtime/precision.awk
	@mkdir -p $$(@D)
	awk -v kind=$(1) -v digits=$$(DIGITS_$(1)) -f runtime/precision.awk $$< >$$@.part
	@mv $$@.part $$@
$(BUILD)/lag-$(1)/%.h: $(BUILD)/gen/$(1)/include/%.h
	@mkdir -p $$(@D)
	cp $$< $$@
$(BUILD)/obj/$(1)/%.o: $(BUILD)/gen/$(1)/%.c $(RT_HEAD:%=$(BUILD)/gen/$(1)/%) | $(BUILD)/gen/io/page.h
	@mkdir -p $$(@D)
	$$(CCACHE) $$(CC) $$(REAL_$(1)) -w $$(CPPFLAGS_ALL) -I$(BUILD)/gen/$(1)/include -I$(BUILD)/gen/$(1) -I$(BUILD)/gen -ffp-contract=off $$(PIC) $$(CFLAGS) $$(SAFE) -c -o $$@ $$<
$(BUILD)/liblag_$(1).a: $(RT_SRC:runtime/%.c=$(BUILD)/obj/$(1)/%.o) $(API_HEAD:%=$(BUILD)/lag-$(1)/%)
	$$(ARCHIVE) $$(filter %.o,$$^)
	$$(INDEX)
endef
$(foreach p,$(PRECISIONS),$(eval $(call precision_rules,$(p))))
.SECONDARY: $(foreach p,$(PRECISIONS),$(RT_HEAD:%=$(BUILD)/gen/$(p)/%) $(RT_SRC:runtime/%=$(BUILD)/gen/$(p)/%))

SHELLS := bash zsh fish
# Texts as C, in the order of their lines: `static const char *const NAME[]`, with the name of the file that they become.
AS_C = { echo 'static const char *const $(basename $(@F))[] = {'; sed 's/[\\"]/\\&/g; s/.*/"&\\n",/' $<; echo '};'; }
$(BUILD)/gen/io/page.h: runtime/io/page.html
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/verify_driver.h: src/commands/verify_driver.in
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/toolchain/probe_text.h: src/toolchain/compiler_probe.in
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
# How files are written is one text in the compiler and in the runtime, of which neither includes a header of the other's.
$(BUILD)/gen/toolchain/outfile.%: runtime/io/outfile.%
	@mkdir -p $(@D)
	sed 's|"io/outfile.h"|"toolchain/outfile.h"|; s|"io/posix.h"|"base/posix.h"|' $< >$@.part
	@mv $@.part $@
$(BUILD)/gen/base/%: runtime/io/%
	@mkdir -p $(@D)
	sed 's|"io/posix.h"|"base/posix.h"|' $< >$@.part
	@mv $@.part $@
# SHARED for the compiler: the same text for long double.
$(BUILD)/gen/numeric/%: runtime/numeric/% runtime/precision.awk
	@mkdir -p $(@D)
	awk -v kind=long -v digits=21 -f runtime/precision.awk $< | sed 's/LAG_REAL/long double/g' >$@.part
	@mv $@.part $@
# With its section in place, without that file's first line.
$(BUILD)/gen/emit/lag_math.txt: runtime/include/lag_math.h runtime/include/lag_sincos.h
	@mkdir -p $(@D)
	{ sed '/^#include "lag_sincos.h"$$/,$$d' $<; sed 1d runtime/include/lag_sincos.h; sed '1,/^#include "lag_sincos.h"$$/d' $<; } >$@.part
	@mv $@.part $@
$(BUILD)/gen/emit/lag_math.h: $(BUILD)/gen/emit/lag_math.txt
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/emit/lag_kkt.h: runtime/include/lag_kkt.h
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
# Coefficients of headers' steppers are the runtime's.
$(BUILD)/gen/emit/%_text.h: runtime/methods/%.c
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/emit/%_text.h: runtime/numeric/%.c
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/emit/%_types.h: runtime/numeric/%.h
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/emit/%_types.h: runtime/methods/%.h
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/fmu/%_text.h: src/fmu/%.in
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/language.h: grammar/LANGUAGE.md
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
# Documents that help shows and searches.
$(BUILD)/gen/commands/tutorial.h: models/TUTORIAL.md
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/readme.h: README.md
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/python.txt: runtime/python/README.md
	@mkdir -p $(@D)
	@sed '/^Tests:/,$$d' $< >$@
$(BUILD)/gen/commands/python.h: $(BUILD)/gen/commands/python.txt
	$(AS_C) >$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/complete_%.h: src/commands/complete.%
	@mkdir -p $(@D)
	$(AS_C) >$@.part
	@mv $@.part $@
# One version: LAG_VERSION of lag.h.
$(BUILD)/obj/src/main.o: SRC_FLAGS += -DLAGC_VERSION='"$(VERSION)"'
$(BUILD)/obj/src/main.o: runtime/include/lag.h
$(BUILD)/obj/src/base/method_table.o: SRC_FLAGS += $(if $(GSL),-DLAGC_WITH_GSL)
$(BUILD)/obj/src/fmu/zip.o: SRC_FLAGS += $(if $(ZIP),-DLAGC_WITH_ZIP)
$(BUILD)/obj/src/emit/header_moreau.o: $(patsubst %,$(BUILD)/gen/emit/%_text.h,contact_impulses band_matrix) $(patsubst %,$(BUILD)/gen/emit/%_types.h,contact_impulses band_matrix)
$(BUILD)/obj/src/toolchain/toolchain.o: SRC_FLAGS += '-DLAGC_LIBDIR="$(LIB_FROM_BIN)"' '-DLAGC_INCLUDEDIR="$(INCLUDE_FROM_BIN)"'
$(BUILD)/obj/src/base/method_table.o $(BUILD)/obj/src/fmu/zip.o $(BUILD)/obj/src/toolchain/toolchain.o: $(CONFIG)
$(BUILD)/obj/runtime/io/html.o: $(BUILD)/gen/io/page.h
$(BUILD)/obj/src/emit/embedded_math.o: $(BUILD)/gen/emit/lag_math.h $(BUILD)/gen/emit/lag_kkt.h
$(BUILD)/obj/src/emit/header_steps.o: $(patsubst %,$(BUILD)/gen/emit/%_text.h,composition dop853 rk4 rk45)
$(BUILD)/obj/src/toolchain/toolchain.o: $(BUILD)/gen/toolchain/probe_text.h
$(BUILD)/obj/src/fmu/fmu.o: $(patsubst %,$(BUILD)/gen/fmu/%_text.h,core cosimulation fmi2 fmi3)
$(BUILD)/obj/src/commands/manual.o: $(patsubst %,$(BUILD)/gen/commands/%.h,language python readme tutorial)
$(BUILD)/obj/src/commands/verify.o: $(BUILD)/gen/commands/verify_driver.h
$(BUILD)/obj/src/commands/completion.o: $(SHELLS:%=$(BUILD)/gen/commands/complete_%.h)
$(LAGC_OBJ) $(BUILD)/obj/src/main.o: | $(BUILD)/gen/base/visible.h $(BUILD)/gen/base/posix.h $(SHARED:%=$(BUILD)/gen/numeric/%.h) $(BUILD)/gen/numeric/edit_distance.h
$(patsubst %,$(BUILD)/obj/src/%.o,toolchain/files commands/build commands/options commands/cost_reference) $(BUILD)/obj/gen/toolchain/outfile.o: $(BUILD)/gen/toolchain/outfile.h
$(BUILD)/obj/gen/toolchain/outfile.o $(BUILD)/obj/gen/base/windows.o: | $(BUILD)/gen/base/posix.h
# Generated code is not ours to warn about.
$(BUILD)/obj/gen/%.o: $(BUILD)/gen/%.c | $(BUILD)/gen/lag.tab.h $(BUILD)/gen/lag.lex.h
	@mkdir -p $(@D)
	$(CCACHE) $(CC) -std=c11 -w $(SRC_FLAGS) $(CFLAGS) $(SAFE) $(SAN) -MMD -MP -c -o $@ $<
$(BUILD)/obj/src/syntax/parse.o: $(BUILD)/gen/lag.tab.h $(BUILD)/gen/lag.lex.h

# ---- the demonstration ------------------------------------------------------------------------------
# Set-up comes first, in a process of its own: the make that follows sees what it installed.
SETUP = @CC='$(CC)' FLEX='$(FLEX)' BISON='$(BISON)' .ci/setup
# A build that says nothing unless something is wrong; a job a processor, unless make was told how many.
QUIET = +@$(MAKE) -s --no-print-directory $(if $(filter --jobserver%,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 2))

demo:
	$(SETUP) build
	@echo 'building $(BUILD)/lagc'
	$(QUIET) all
	@$(MAKE) --no-print-directory run-demo

run-demo: all
	$(BUILD)/lagc run models/double_pendulum.lag --method rk45 --plot-x x2 --plot-y y2 --sketch --svg $(BUILD)/double_pendulum.svg

# The pictures of models/README.md, each by the command that stands above it.
gallery: all
	@sed -n 's|^Drawn by `build/lagc \(.*\)`:$$|$(BUILD)/lagc \1 --quiet|p' models/README.md | sh -e

# ---- tests: tests/run.sh says what a suite is -------------------------------------------------------
# Two builds for `make test`: as users get it, less the precisions; and in $(BUILD)/san with the address and undefined-behaviour sanitizers,
# which unit tests, their helpers and fuzz targets link. gcc compiles sanitized code at -Og in 60 % of the time of -O1 or of -O0, and in two
# thirds of that without the four checks of pointers, whose faults the address sanitizer sees for the greater part.
# `make test-long` has all checks, at -O0, which leaves out no load, in $(BUILD)/zero, and runs unit tests and fuzz targets once more with them;
# long and quad precision; and, where clang is installed, everything by clang.
SAN_BUILD := $(BUILD)/san
SAN_OPT   := -Og -g1
SAN_ALL   := -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
SAN_FLAGS := $(SAN_ALL) -fno-sanitize=null,alignment,pointer-overflow,object-size
BIN       := $(BUILD)/test/bin
CLANG     ?= $(shell command -v clang 2>/dev/null)
CXX_FOUND := $(shell command -v $(CXX) 2>/dev/null)

UNIT_SRC  := $(wildcard tests/unit/*.c)
FUZZ_SRC  := $(wildcard tests/fuzz/fuzz_*.c)
TEST_BIN  := $(UNIT_SRC:tests/unit/%.c=$(BIN)/%) $(FUZZ_SRC:tests/fuzz/%.c=$(BIN)/%)
# Where T names unit tests only, nothing else is built.
ONLY      := $(if $(filter-out unit/%,$(T)),,$(wildcard $(T:%=tests/%*.c)))

RUN_TESTS = @LAGC='$(BUILD)/lagc' LAGC_SAN='$(SAN_BUILD)/lagc' SAN_FLAGS='$(SAN_FLAGS)' LAGC_CLANG= PRECISIONS= $(MORE_BUILDS) \
            LIBLAG='$(LIBLAG)' LIBS='$(GSL_LIBS) -lm' INC='runtime/include' BIN='$(BIN)' BUILD='$(BUILD)' \
            CC='$(or $(MODEL_CC),$(CC))' LINKER='$(FAST_LINKER)' CLANG='$(CLANG)' CXX='$(CXX_FOUND)' GSL='$(GSL)' MAKE='$(MAKE)' sh tests/run.sh

# A job pool for all builds.
BUILD_TESTS = $(QUIET) build-tests

test:
	$(SETUP) test
	$(BUILD_TESTS)
	$(RUN_TESTS) $(T)
# Unit and golden suites, without sanitizers: one build, of the compiler and of the runtime for doubles.
QUICK_BIN := $(BUILD)/test/quick
# Not those that take more than ten seconds each.
QUICK     := $(filter-out unit/test_rt_cost unit/test_nest unit/test_lift golden/gallery golden/run_emitted golden/run_steps golden/lib_%, \
               $(UNIT_SRC:tests/%.c=%) $(patsubst tests/%.sh,%,$(wildcard tests/golden/*.sh)))
check-quick: BIN   := $(QUICK_BIN)
check-quick: CLANG :=
check-quick:
	$(SETUP) test
	$(QUIET) BIN=$(QUICK_BIN) SAN_BUILD=$(BUILD) SAN_FLAGS= PRECISIONS= $(BUILD)/lagc $(LIBLAG) $(UNIT_SRC:tests/unit/%.c=$(QUICK_BIN)/%)
	$(RUN_TESTS) $(or $(T),$(QUICK))
ZERO = SAN_BUILD='$(BUILD)/zero' SAN_OPT='-O0 -g1' SAN_FLAGS='$(SAN_ALL)' BIN='$(BUILD)/zero/bin'
test-long: MORE_BUILDS = PRECISIONS='$(PRECISIONS)' LAGC_CLANG='$(if $(CLANG),$(BUILD)/clang/lagc)'
test-long: SAN_BUILD := $(BUILD)/zero
test-long: SAN_FLAGS := $(SAN_ALL)
test-long: BIN := $(BUILD)/zero/bin
test-long:
	$(SETUP) test
	$(BUILD_TESTS) build-more $(ZERO)
	$(RUN_TESTS) --long $(T)
bless:
	$(SETUP) test
	$(BUILD_TESTS)
	$(RUN_TESTS) --bless $(T)
# A row a case of tests/hard: error, residual, steps, time.
hard:
	$(SETUP) build
	$(QUIET) all
	@LAGC='$(BUILD)/lagc' LIBS='$(GSL_LIBS) -lm' INC='runtime/include' BUILD='$(BUILD)' CC='$(CC)' GSL='$(GSL)' sh tests/hard/lib_table.sh
bench:
	$(SETUP) build
	$(QUIET) all
	$(RUN_TESTS) --bench $(T)

# What accuracy costs in time: models/COST.md, by this machine.
cost-report:
	$(SETUP) build
	$(QUIET) all
	@LAGC='$(BUILD)/lagc' CC='$(CC)' sh tests/bench/lib_cost_report.sh

SAN_MAKE = $(QUIET) BUILD=$(SAN_BUILD) PRECISIONS= CFLAGS='$(SAN_OPT)' SAN='$(SAN_FLAGS)'
SAN_LAGC := $(SAN_BUILD)/liblagc.a
SAN_RT   := $(if $(GSL),$(SAN_BUILD)/liblag_gsl.a) $(SAN_BUILD)/liblag.a

# The largest build starts first.
ifneq ($(ONLY),)
build-tests: build-san
	$(QUIET) $(ONLY:tests/unit/%.c=$(BIN)/%)
else
build-tests: build-san build-plain
	$(QUIET) $(TEST_BIN)
endif
build-san:
	@echo 'building $(SAN_BUILD) with sanitizers'
	$(SAN_MAKE) $(if $(ONLY),,$(SAN_BUILD)/lagc) $(SAN_LAGC) $(SAN_RT)
build-plain:
	@echo 'building $(BUILD)/lagc'
	$(QUIET) PRECISIONS= all
build-more: build-san build-plain
	@echo 'building other precisions$(if $(CLANG), and $(BUILD)/clang by clang)'
	$(QUIET) all
	$(if $(CLANG),$(QUIET) BUILD=$(BUILD)/clang PRECISIONS= CC='$(CLANG)' all)

# Test programs themselves: -O1 would take ten times as long to compile.
TEST_OPT ?= -O0 -g1
TEST_CC = $(CC) -std=c11 -Wall -Wextra $(CPPFLAGS_ALL) $(TEST_OPT) $(SAN_FLAGS) $(FAST_LINKER:%=-fuse-ld=gold) -MMD -MP -MF $@.d -o $@ $<
# tests/unit/test_rt_*: of the runtime. The rest of tests/unit: of the compiler.
$(BIN)/test_rt_%: tests/unit/test_rt_%.c $(SAN_RT)
	@mkdir -p $(@D)
	$(TEST_CC) -Iruntime/include -Iruntime -ffp-contract=off $(SAN_RT) $(GSL_LIBS) -lcmocka -lm
$(BIN)/%: tests/unit/%.c $(SAN_LAGC)
	@mkdir -p $(@D)
	$(TEST_CC) -Isrc -I$(SAN_BUILD)/gen $(SAN_LAGC) $(ZIP_LIBS) -lcmocka -lm
$(BIN)/fuzz_%: tests/fuzz/fuzz_%.c $(BIN)/driver.o $(SAN_LAGC)
	@mkdir -p $(@D)
	$(TEST_CC) -Isrc -I$(SAN_BUILD)/gen $(BIN)/driver.o $(SAN_LAGC) $(ZIP_LIBS) -lm
# fuzz_load is of the runtime, with models as lagc emits them: the method behind the colon is what they are emitted for.
LOAD_MODELS := spring:verlet pend:variational series:taylor flow:gauss rod:variational ball:verlet
LOAD_SRC    := $(foreach m,$(LOAD_MODELS),$(BUILD)/test/load_$(firstword $(subst :, ,$m)).c)
$(BUILD)/test/load_%.c: tests/fuzz/load/load_%.lag $(BUILD)/lagc
	@mkdir -p $(@D)
	$(BUILD)/lagc emit $< --with linear --method $(patsubst $*:%,%,$(filter $*:%,$(LOAD_MODELS))) -o $@
$(BIN)/fuzz_load: tests/fuzz/fuzz_load.c $(BIN)/driver.o $(LOAD_SRC) $(SAN_RT)
	@mkdir -p $(@D)
	$(TEST_CC) -Iruntime/include -Iruntime -ffp-contract=off $(BIN)/driver.o $(LOAD_SRC) $(SAN_RT) $(GSL_LIBS) -lm
$(BIN)/driver.o: tests/fuzz/driver.c
	@mkdir -p $(@D)
	$(TEST_CC) -c

# Looks for new failures: make fuzz [T=fuzz_parse] [SECONDS=60]. With clang's libFuzzer where there is clang,
# with the plain mutations of tests/fuzz/driver.c where there is not.
SECONDS ?= 60
FUZZ     = $(if $(T),$(T),$(FUZZ_SRC:tests/fuzz/%.c=%))
fuzz:
	$(SETUP) build
ifneq ($(CLANG),)
	$(QUIET) BUILD=$(BUILD)/fuzz PRECISIONS= CC='$(CLANG)' CFLAGS='-O1 -g' \
	  SAN='$(SAN_ALL) -fsanitize=fuzzer-no-link' \
	  $(BUILD)/fuzz/liblagc.a $(BUILD)/fuzz/liblag.a
	$(QUIET) $(if $(filter fuzz_load,$(FUZZ)),$(LOAD_SRC))
	@set -e; for f in $(FUZZ); do \
	  corpus=tests/fuzz/corpus/$${f#fuzz_}; found=$(BUILD)/fuzz/found/$$f; mkdir -p $$found; \
	  with="-Isrc -I$(BUILD)/fuzz/gen $(BUILD)/fuzz/liblagc.a $(ZIP_LIBS)"; \
	  [ $$f != fuzz_load ] || with="-DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION -Iruntime/include -Iruntime $(LOAD_SRC) $(BUILD)/fuzz/liblag.a"; \
	  $(CLANG) -std=c11 $(CPPFLAGS_ALL) -O1 -g $(SAN_ALL) -fsanitize=fuzzer -o $(BUILD)/fuzz/$$f tests/fuzz/$$f.c $$with -lm; \
	  $(BUILD)/fuzz/$$f -max_total_time=$(SECONDS) -max_len=4096 -print_final_stats=1 -artifact_prefix=$(BUILD)/fuzz/ $$found $$corpus; \
	done
else
	$(SAN_MAKE) $(SAN_LAGC)
	$(QUIET) $(FUZZ:%=$(BIN)/%)
	@set -e; for f in $(FUZZ); do \
	  $(BIN)/$$f --mutate $(SECONDS) $(BUILD)/fuzz-found tests/fuzz/corpus/$${f#fuzz_}; done
endif

# The share of lines of each file of the back half that the inputs of fuzz targets reach: the corpora, and what `make fuzz` has found.
COV = $(BUILD)/cov
fuzz-coverage:
	$(QUIET) BUILD=$(COV) PRECISIONS= CFLAGS=-O0 SAN=--coverage $(COV)/liblagc.a
	@find $(COV) -name '*.gcda' -delete
	@set -e; for f in $(FUZZ); do \
	  $(CC) -std=c11 $(CPPFLAGS_ALL) -O0 --coverage -Isrc -I$(COV)/gen -o $(COV)/$$f tests/fuzz/$$f.c tests/fuzz/driver.c $(COV)/liblagc.a $(ZIP_LIBS) -lm; \
	  for d in tests/fuzz/corpus/$${f#fuzz_} $(BUILD)/fuzz/found/$$f; do if [ "$$(ls $$d 2>/dev/null)" ]; then $(COV)/$$f $$d >$(COV)/log; fi; done; \
	done
	@for f in $(patsubst src/%.c,%,$(wildcard src/emit/*.c src/ir/*.c src/mech/*.c)); do gcov -n $(COV)/obj/src/$$f.gcda 2>/dev/null; done | \
	  awk -F "['%:]" '/^File .src\/.*\.c/ { f = $$2 } /^Lines executed/ && f { printf "%5.1f %%  %s\n", $$2, f; f = "" }'

# The share of lines that the suites of `make test` reach. Simulators count, too: MODEL_CC links them with gcov.
COVERAGE := $(BUILD)/coverage
COVERAGE_MAKE = $(QUIET) BUILD=$(COVERAGE) SAN_BUILD=$(COVERAGE) CCACHE= PRECISIONS= CLANG= CFLAGS='-O0 -include tests/coverage/counted.h' \
                SAN=--coverage SAN_FLAGS=--coverage TEST_OPT=-O0
coverage:
	$(SETUP) test
	$(COVERAGE_MAKE) build-coverage
	@find $(COVERAGE) -name '*.gcda' -delete
	@ln -sfn "$(CURDIR)/runtime" $(COVERAGE)/../runtime # lagc finds its headers in ../runtime
	@printf '#!/bin/sh\nexec %s "$$@" -O0 --coverage\n' '$(CC)' >$(COVERAGE)/counted-cc && chmod +x $(COVERAGE)/counted-cc
	-$(COVERAGE_MAKE) MODEL_CC='$(CURDIR)/$(COVERAGE)/counted-cc' COVERAGE=yes run-coverage
	@sh tests/coverage/lib_report.sh $(COVERAGE)
build-coverage: all $(TEST_BIN)
run-coverage:
	$(RUN_TESTS) $(T)

# One-token changes of the sources, one at a time: which ones does no suite see? tests/mutants/mutants.py
N    ?= 100
SEED ?= 1
mutants:
	$(SETUP) test
	python3 tests/mutants/mutants.py --n $(N) --seed $(SEED) $(if $(JOBS),--jobs $(JOBS)) $(if $(ONLY_IN),--only '$(ONLY_IN)')

# ---- installing -------------------------------------------------------------------------------------
MODELS := $(wildcard models/*.lag models/*.csv)
PC     := $(BUILD)/liblag.pc
# Where lagc.py goes; `make install PYTHONDIR=...` puts it where a Python looks.
PYTHONDIR ?= $(PREFIX)/share/lagc/python
HEADERS := lag.h lag_libraries.h lag_model.h lag_math.h lag_sincos.h lag_kkt.h
FILL_IN = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(call below,$${prefix}/,$(LIBDIR))|' \
            -e 's|@INCLUDEDIR@|$(call below,$${prefix}/,$(INCLUDEDIR))|' -e 's|@VERSION@|$(VERSION)|'
# The same for CMake: from its folder LIBDIR/cmake/lagc up to PREFIX, where LIBDIR is below it.
LIB_BELOW := $(call below,,$(LIBDIR))
SPACE := $(if ,) $(if ,)
TO_PREFIX := $(if $(filter /%,$(LIB_BELOW)),$(PREFIX),$${CMAKE_CURRENT_LIST_DIR}/../..$(subst $(SPACE),,$(patsubst %,/..,$(subst /, ,$(LIB_BELOW)))))
CMAKE_FILL_IN = sed -e 's|@CMAKE_PREFIX@|$(TO_PREFIX)|' -e 's|@LIBDIR@|$(call below,$${_lagc_prefix}/,$(LIBDIR))|' \
            -e 's|@INCLUDEDIR@|$(call below,$${_lagc_prefix}/,$(INCLUDEDIR))|' -e 's|@VERSION@|$(VERSION)|' -e 's|@SOVERSION@|$(SOVERSION)|g'
COMPLETIONS := bash-completion/completions zsh/site-functions fish/vendor_completions.d

install: all
	install -d '$(DESTDIR)$(PREFIX)/bin' '$(DESTDIR)$(LIBDIR)/pkgconfig' '$(DESTDIR)$(INCLUDEDIR)' \
	  '$(DESTDIR)$(PREFIX)/share/lagc/models/lib' '$(DESTDIR)$(PYTHONDIR)' '$(DESTDIR)$(PREFIX)/share/man/man1' '$(DESTDIR)$(PREFIX)/share/doc/lagc' \
	  $(COMPLETIONS:%='$(DESTDIR)$(PREFIX)/share/%')
	install -m 755 $(BUILD)/lagc$(EXE) '$(DESTDIR)$(PREFIX)/bin'
	install -m 644 $(LIBLAG) $(LIBLAG_MORE) $(PARTS:%=$(BUILD)/liblag_%.libs) '$(DESTDIR)$(LIBDIR)'
ifneq ($(DYNAMIC),)
	install -m 755 $(LIBLAG_SO) '$(DESTDIR)$(LIBDIR)'
	ln -sfn liblag.so.$(SOVERSION) '$(DESTDIR)$(LIBDIR)/liblag.so'
endif
	for p in $(PRECISIONS); do install -d "$(DESTDIR)$(LIBDIR)/lag-$$p" && \
	  install -m 644 $(BUILD)/lag-$$p/*.h "$(DESTDIR)$(LIBDIR)/lag-$$p" || exit 1; done
	install -m 644 $(HEADERS:%=runtime/include/%) '$(DESTDIR)$(INCLUDEDIR)'
	$(FILL_IN) runtime/liblag.pc.in >$(PC)
	install -m 644 $(PC) '$(DESTDIR)$(LIBDIR)/pkgconfig'
	install -d '$(DESTDIR)$(LIBDIR)/cmake/lagc'
	for f in lagcConfig lagcConfigVersion; do $(CMAKE_FILL_IN) runtime/$$f.cmake.in >$(BUILD)/$$f.cmake && \
	  install -m 644 $(BUILD)/$$f.cmake '$(DESTDIR)$(LIBDIR)/cmake/lagc' || exit 1; done
ifneq ($(GSL),)
	$(FILL_IN) runtime/gsl/liblag_gsl.pc.in >$(PC:.pc=_gsl.pc)
	install -m 644 $(PC:.pc=_gsl.pc) '$(DESTDIR)$(LIBDIR)/pkgconfig'
endif
	install -m 644 $(MODELS) '$(DESTDIR)$(PREFIX)/share/lagc/models'
	install -m 644 $(wildcard models/lib/*.lag models/lib/*.csv) '$(DESTDIR)$(PREFIX)/share/lagc/models/lib'
	install -m 644 runtime/python/lagc.py '$(DESTDIR)$(PYTHONDIR)'
	install -m 644 runtime/matlab/lagc_mex.c '$(DESTDIR)$(PREFIX)/share/lagc'
	install -m 644 grammar/lag.tmLanguage.json '$(DESTDIR)$(PREFIX)/share/lagc'
	install -m 644 src/lagc.1 '$(DESTDIR)$(PREFIX)/share/man/man1'
	install -m 644 src/commands/complete.bash '$(DESTDIR)$(PREFIX)/share/bash-completion/completions/lagc'
	install -m 644 src/commands/complete.zsh '$(DESTDIR)$(PREFIX)/share/zsh/site-functions/_lagc'
	install -m 644 src/commands/complete.fish '$(DESTDIR)$(PREFIX)/share/fish/vendor_completions.d/lagc.fish'
	install -m 644 LICENSE README.md '$(DESTDIR)$(PREFIX)/share/doc/lagc'

# Removes what install puts there, and the folders that are lagc's own.
uninstall:
	cd '$(DESTDIR)$(PREFIX)' && rm -f bin/lagc bin/lagc.exe share/man/man1/lagc.1 share/bash-completion/completions/lagc \
	  share/zsh/site-functions/_lagc share/fish/vendor_completions.d/lagc.fish && rm -rf share/lagc share/doc/lagc
	rm -f '$(DESTDIR)$(PYTHONDIR)/lagc.py'
	cd '$(DESTDIR)$(LIBDIR)' && rm -f liblag.so liblag.so.[0-9]* liblag.a liblag_gsl.a liblag_png.a liblag_png.libs liblag_hdf5.a liblag_hdf5.libs liblag_mpi.a liblag_mpi.libs liblag_long.a liblag_quad.a pkgconfig/liblag.pc pkgconfig/liblag_gsl.pc && \
	  rm -rf lag-long lag-quad cmake/lagc
	cd '$(DESTDIR)$(INCLUDEDIR)' && rm -f $(HEADERS)

# ---- a release ----
# The files of the last commit as lagc-VERSION.tar.gz, the same bytes wherever it is made: names in order, no dates but the commit's, no owners.
DIST := $(BUILD)/lagc-$(VERSION).tar.gz
dist:
	@git rev-parse --verify -q HEAD >/dev/null || { echo 'make dist packs the last commit: a git repository is needed'; exit 1; }
	@mkdir -p $(BUILD)
	git -c tar.umask=0022 archive --format=tar --prefix=lagc-$(VERSION)/ HEAD | gzip -9n >$(DIST).part
	@mv $(DIST).part $(DIST)
	@sha256sum $(DIST)

# ---- the rest ---------------------------------------------------------------------------------------
clean:
	rm -rf $(BUILD)

help:
	@echo 'make              the compiler build/lagc and the runtime build/liblag.a'
	@echo 'make demo         installs what is missing, then compiles and runs models/double_pendulum.lag'
	@echo 'make test         installs what is missing, then runs every test'
	@echo '                  T="unit/test_num golden": only suites whose names begin so'
	@echo '                  TIMES=1: the processor time of each suite; JOBS=4: suites at a time, one a processor unless given'
	@echo 'make check-quick  unit and golden tests only, without sanitizers: half a minute'
	@echo 'make test-long    the suites that take minutes'
	@echo 'make hard         hard cases with published digits: a row each, error beside what is allowed'
	@echo 'make bench        instructions and times next to peers, to tests/bench/RESULTS.md; nothing fails by being slow'
	@echo 'make cost-report  what accuracy costs in time, for eight models: models/COST.md with its pictures'
	@echo 'make bless        rewrites the expectations of golden tests: look at the diff before you commit it'
	@echo 'make fuzz         looks for inputs that break the compiler; SECONDS=60, T=fuzz_parse'
	@echo 'make fuzz-coverage  the share of lines of src/ir, src/mech and src/emit that its inputs reach'
	@echo 'make coverage     the share of lines of each folder that the suites of make test reach, by gcov; T= as above'
	@echo 'make mutants      plants one-token changes and prints those that no suite sees; N=100 SEED=1 JOBS=2 ONLY_IN=src/ir/'
	@echo 'make gallery      draws the pictures of models/README.md'
	@echo 'make install      PREFIX=/usr/local LIBDIR=PREFIX/lib INCLUDEDIR=PREFIX/include DESTDIR='
	@echo 'make uninstall    the same, backwards'
	@echo 'make dist         the last commit as build/lagc-VERSION.tar.gz, the same bytes wherever it is made'
	@echo 'make clean        removes build/'
	@echo 'settings: CC CFLAGS CPPFLAGS LDFLAGS AR RANLIB WERROR=-Werror BUILD FLEX BISON CXX CLANG= (to do without clang)'
	@echo '          GSL= PRECISIONS= DYNAMIC= ZIP= PNG= HDF5= MPI= (to do without gsl-* methods; long double and quad; a shared liblag; lagc fmu; pictures as PNG; HDF5; sweeps by MPI)'
	@echo '          for another machine: CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar BUILD=build/aarch64'
	@echo '          for Windows: CC=x86_64-w64-mingw32-gcc AR=x86_64-w64-mingw32-ar BUILD=build/windows'

ifneq ($(BUILDS),)
-include $(LAGC_OBJ:.o=.d) $(RT_OBJ:.o=.d) $(GSL_OBJ:.o=.d) $(BUILD)/obj/src/main.d $(TEST_BIN:=.d)
endif

FORCE:
.PHONY: FORCE all demo run-demo gallery test check-quick test-long bless hard bench cost-report build-tests build-san build-plain build-more coverage build-coverage run-coverage fuzz fuzz-coverage mutants install uninstall dist clean help
