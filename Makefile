# lagc and liblag. `make help` lists what can be made; README.md says what it is for.

# ---- settings: make NAME=value; CPPFLAGS, LDFLAGS, RANLIB, WERROR, SAN, DESTDIR and T are empty ---------------------
.DEFAULT_GOAL := all
CC      ?= cc
CFLAGS  ?= -O2
WARN    := -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes $(WERROR)
BUILD   ?= build
FLEX    ?= flex
BISON   ?= bison
PREFIX  ?= /usr/local
LIBDIR  ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include

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
               $(wildcard $(foreach d,/usr /usr/local,$d/include/gsl/gsl_odeiv2.h $d/include/minizip/zip.h $d/include/lzma.h $d/include/librsvg-2.0/librsvg/rsvg.h $d/include/hdf5/serial/hdf5.h)) $(wildcard /usr/lib/*/openmpi/include/mpi.h))
BUILDS    := $(filter-out help clean uninstall,$(or $(MAKECMDGOALS),all))
ifneq ($(BUILDS),)
-include $(CONFIG)
endif

# ccache, where it is installed, keeps objects between builds and between copies of the tree; `make CCACHE=` does without.
CCACHE ?= $(if $(CCACHE_DISABLE),,$(firstword $(wildcard $(addsuffix /ccache,$(subst :, ,$(PATH))))))
export CCACHE_NOHASHDIR ?= 1

# GSL is optional: without it there are no gsl-* methods, and no liblag_gsl.a.
GSL := $(GSL_FOUND)
GSL_LIBS := $(if $(GSL),-lgsl -lgslcblas)

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
# liblzma packs pages; without it they are longer.
XZ := $(XZ_FOUND)
LAGC_LIBS := $(if $(ZIP),-lminizip -lz) $(if $(XZ),-llzma)

# The runtime for other numbers than doubles: `lagc run --precision`. Quad needs libquadmath.
PRECISIONS ?= long $(QUAD_FOUND)
PRECISIONS := $(PRECISIONS)

# A flag that keeps the compiler from storing wrong numbers, where it does with these flags: src/toolchain/compiler_probe.in.
SAFE := $(SAFE_FOUND)

# After the restart of make the file is not made again.
HASH := \#
AS_SET = $(subst ','\'',$(subst $(HASH),\$(HASH),$(subst $$,$$$$,$(CONFIG_OF))))
ifneq ($(CONFIG_FOR),$(CONFIG_OF))
CONFIG_STALE := FORCE
endif
ifeq ($(MAKE_RESTARTS),)
$(CONFIG): .ci/probe src/toolchain/compiler_probe.in $(CC_FILE) $(CONFIG_STALE)
	@mkdir -p $(@D)
	@{ echo 'CONFIG_FOR := $(AS_SET)'; CC='$(CC)' CPPFLAGS='$(CPPFLAGS)' CFLAGS='$(CFLAGS)' LDFLAGS='$(LDFLAGS)' .ci/probe; } >$@.part
	@mv $@.part $@
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
SHARED   := action_integral consistent_state magnitudes option_range quadrature
NOT_HERE := $(if $(WINDOWS),%/process.c %/clock.c %/threads.c,%windows.c)
LAGC_SRC := $(filter-out src/main.c src/playground/% $(NOT_HERE),$(wildcard src/*.c src/*/*.c))
GEN_SRC  := $(patsubst %,$(BUILD)/gen/%,lag.tab.c lag.lex.c toolchain/outfile.c $(if $(WINDOWS),base/windows.c) $(SHARED:%=numeric/%.c))
RT_SRC   := $(filter-out runtime/gsl/% runtime/png/% runtime/hdf5/% runtime/mpi/% runtime/matlab/% runtime/page/% runtime/evaluator/lag_run.c $(NOT_HERE),$(wildcard runtime/*/*.c))
GSL_SRC  := $(wildcard runtime/gsl/*.c)

LAGC_OBJ := $(LAGC_SRC:%.c=$(BUILD)/obj/%.o) $(GEN_SRC:$(BUILD)/gen/%.c=$(BUILD)/obj/gen/%.o)
RT_OBJ   := $(RT_SRC:%.c=$(BUILD)/obj/%.o)
GSL_OBJ  := $(GSL_SRC:%.c=$(BUILD)/obj/%.o)

LIBLAG  := $(BUILD)/liblag.a $(if $(GSL),$(BUILD)/liblag_gsl.a) $(PARTS:%=$(BUILD)/liblag_%.a)
LIBLAG_MORE := $(PRECISIONS:%=$(BUILD)/liblag_%.a)
# The shared library, named after the ABI of models, where programs are ELF; `make DYNAMIC=` makes none.
DYNAMIC ?= $(ELF_FOUND)
LIBLAG_SO = $(if $(DYNAMIC),$(BUILD)/liblag.so.$(SOVERSION))

# Libraries of other precisions are kept up to date once they are there.
all: $(BUILD)/lagc$(EXE) $(LIBLAG) $(BUILD)/lag-run$(EXE) $(wildcard $(LIBLAG_MORE))
# The runtime for long double and quad takes as long to build as all the rest.
precisions: $(LIBLAG_MORE)
install: $(LIBLAG_SO)

# ---- the compiler and the runtime -------------------------------------------------------------------
$(BUILD)/lagc$(EXE): $(BUILD)/obj/src/main.o $(BUILD)/liblagc.a
	$(CC) $(CFLAGS) $(SAN) $(LDFLAGS) $(if $(WINDOWS),-static) -o $@ $^ $(LAGC_LIBS) -lm

# `ar s` writes the index; RANLIB is for an ar that does not.
ARCHIVE = rm -f $@ && $(AR) rcs $@ $(1)$(if $(RANLIB), && $(RANLIB) $@)

# Everything of the compiler but main: what the unit tests link.
$(BUILD)/liblagc.a: $(LAGC_OBJ)
	$(call ARCHIVE,$^)
$(BUILD)/liblag.a: $(RT_OBJ)
	$(call ARCHIVE,$^)
# The simulator that evaluates models, as `lagc run` begins: it needs no compiler.
$(BUILD)/obj/runtime/evaluator/lag_run.o: RT_FLAGS += $(if $(GSL),-DLAG_WITH_GSL)
$(BUILD)/obj/runtime/evaluator/lag_run.o: $(CONFIG)
$(BUILD)/lag-run$(EXE): $(BUILD)/obj/runtime/evaluator/lag_run.o $(if $(GSL),$(BUILD)/liblag_gsl.a) $(BUILD)/liblag.a
	$(CC) $(CFLAGS) $(SAN) $(LDFLAGS) $(if $(WINDOWS),-static,-rdynamic) -o $@ $^ $(GSL_LIBS) -lm $(if $(WINDOWS),,-ldl)
# References within it are bound to its own functions.
$(BUILD)/liblag.so.%: $(RT_OBJ) runtime/liblag.map
	$(CC) $(CFLAGS) $(SAN) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,--version-script=runtime/liblag.map -Wl,-Bsymbolic -o $@ $(RT_OBJ) -lm
$(BUILD)/liblag_gsl.a: $(GSL_OBJ)
	$(call ARCHIVE,$^)
# Beside it, what links it.
$(BUILD)/liblag_png.a: $(BUILD)/obj/runtime/png/png.o
	$(call ARCHIVE,$^)
	@pkg-config --libs librsvg-2.0 >$(@:.a=.libs)
$(BUILD)/liblag_hdf5.a: $(BUILD)/obj/runtime/hdf5/hdf5.o
	$(call ARCHIVE,$^)
	@pkg-config --libs-only-L --libs-only-l $(HDF5) | sed 's/-lhdf5/-lhdf5_hl &/' >$(@:.a=.libs)
$(BUILD)/liblag_mpi.a: $(BUILD)/obj/runtime/mpi/mpi.o
	$(call ARCHIVE,$^)
	@pkg-config --libs ompi-c >$(@:.a=.libs)
# gcc takes the vectors from a pragma in the file; Clang passes vectors as the file's flags say.
$(addprefix $(BUILD)/obj/runtime/,lanes/lanes_4.o methods/kepler_lanes_4.o): override CFLAGS += $(if $(CLANG_X86),-mavx2)
$(addprefix $(BUILD)/obj/runtime/,lanes/lanes_8.o methods/kepler_lanes_8.o): override CFLAGS += $(if $(CLANG_X86),-mavx512f -mavx512dq)
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

# Folders of objects, made once each: mkdir for each object would take a second.
OBJ     := $(LAGC_OBJ) $(RT_OBJ) $(GSL_OBJ) $(BUILD)/obj/src/main.o $(BUILD)/obj/runtime/evaluator/lag_run.o $(foreach p,$(PARTS),$(BUILD)/obj/runtime/$p/$p.o)
FOLDERS := $(sort $(dir $(OBJ)))
$(OBJ): | $(FOLDERS)
$(FOLDERS):
	@mkdir -p $@
# Rooms in which lagc and a run spend little of their time: -O1 builds them in two thirds of the time of -O2, and those that do each thing once by
# -Og in half of it.
ONCE   := $(patsubst %,src/%,commands fmu report toolchain) runtime/app
SELDOM := $(patsubst %,src/%,claims emit lower mech model phase_space self_check symmetry syntax) $(patsubst %,runtime/%,analysis io sweep)
$(foreach d,$(ONCE),$(eval $(BUILD)/obj/$(d)/%.o: CFLAGS := $(CFLAGS:-O2=-Og)))
$(foreach d,$(SELDOM),$(eval $(BUILD)/obj/$(d)/%.o: CFLAGS := $(CFLAGS:-O2=-O1)))
$(BUILD)/obj/src/%.o: src/%.c
	$(CCACHE) $(CC) $(WARN) $(SRC_FLAGS) $(CFLAGS) $(SAFE) $(SAN) -MMD -MP -c -o $@ $<
$(BUILD)/obj/runtime/%.o: runtime/%.c
	$(CCACHE) $(CC) $(WARN) $(RT_FLAGS) $(CFLAGS) $(SAFE) $(SAN) -MMD -MP -c -o $@ $<

# Of one text, by runtime/precision.awk, in $(BUILD)/gen/long and $(BUILD)/gen/quad; lagc finds the headers in $(BUILD)/lag-long
# and $(BUILD)/lag-quad. src/toolchain/toolchain.c compiles models with the same LAG_REAL.
REAL_long := -std=c11 '-DLAG_REAL=long double' '-DLAG_OF_REAL(f)=f\#\#l' '-DLAG_PRECISION="long"'
REAL_quad := -std=gnu11 -include quadmath.h -DLAG_REAL=__float128 '-DLAG_OF_REAL(f)=f\#\#q' '-DLAG_PRECISION="quad"'
DIGITS_long := $(if $(filter long,$(PRECISIONS)),$(LONG_DIGITS))
DIGITS_quad := 36
RT_HEAD  := $(patsubst runtime/%,%,$(wildcard runtime/*/*.h))
TABLES   := $(BUILD)/gen/app/options.def $(BUILD)/gen/numeric/functions.def $(BUILD)/gen/numeric/program_code.def $(BUILD)/gen/kernels/steppers.def
API_HEAD := lag.h lag_libraries.h lag_method.h lag_model.h
# Of every scalar; emitted C includes them.
ANY_HEAD := lag_lanes.h lag_math.h lag_sincos.h lag_support.h lag_band.h lag_kkt.h lag_tree.h

# Bytes are evaluated in doubles.
REAL_SRC := $(filter-out runtime/evaluator/%,$(RT_SRC))

define precision_rules
$(BUILD)/gen/$(1)/%: runtime/% runtime/precision.awk
	@mkdir -p $$(@D)
	awk -v kind=$(1) -v digits=$$(DIGITS_$(1)) -f runtime/precision.awk $$< >$$@.part
	@mv $$@.part $$@
$(BUILD)/lag-$(1)/%.h: $(BUILD)/gen/$(1)/include/%.h
	@mkdir -p $$(@D)
	cp $$< $$@
$(ANY_HEAD:%=$(BUILD)/lag-$(1)/%): $(BUILD)/lag-$(1)/%.h: runtime/include/%.h
	@mkdir -p $$(@D)
	cp $$< $$@
$(BUILD)/obj/$(1)/%.o: $(BUILD)/gen/$(1)/%.c $(RT_HEAD:%=$(BUILD)/gen/$(1)/%) | $(BUILD)/gen/io/page.h $(TABLES)
	@mkdir -p $$(@D)
	$$(CCACHE) $$(CC) $$(REAL_$(1)) -w $$(CPPFLAGS_ALL) -I$(BUILD)/gen/$(1)/include -I$(BUILD)/gen/$(1) -I$(BUILD)/gen -ffp-contract=off $$(PIC) $$(CFLAGS) $$(SAFE) -c -o $$@ $$<
$(BUILD)/liblag_$(1).a: $(REAL_SRC:runtime/%.c=$(BUILD)/obj/$(1)/%.o) $(API_HEAD:%=$(BUILD)/lag-$(1)/%) $(ANY_HEAD:%=$(BUILD)/lag-$(1)/%)
	$$(call ARCHIVE,$$(filter %.o,$$^))
endef
$(foreach p,$(PRECISIONS),$(eval $(call precision_rules,$(p))))
.SECONDARY: $(foreach p,$(PRECISIONS),$(RT_HEAD:%=$(BUILD)/gen/$(p)/%) $(REAL_SRC:runtime/%=$(BUILD)/gen/$(p)/%))

# Texts of emitted headers, for the file beside them.
EMIT_TEXT := $(patsubst src/emit/%.in,%,$(wildcard src/emit/*.in))
$(BUILD)/gen/emit/%_text.h: src/emit/%.in src/emit/sections.awk
	@mkdir -p $(@D)
	awk -f src/emit/sections.awk $< >$@.part
	@mv $@.part $@
$(EMIT_TEXT:%=$(BUILD)/obj/src/emit/%.o): $(BUILD)/obj/src/emit/%.o: $(BUILD)/gen/emit/%_text.h

SHELLS := bash zsh fish
# Texts as C, in the order of their lines: `static const char *const NAME[]`, with the name of the file that they become.
AS_C = { echo 'static const char *const $(basename $(@F))[] = {'; sed 's/[\\"]/\\&/g; s/.*/"&\\n",/' $^; echo '};'; }
define as_text
$(BUILD)/gen/$(1): $(2)
	@mkdir -p $$(@D)
	$$(AS_C) >$$@.part
	@mv $$@.part $$@
endef
$(eval $(call as_text,io/page.h,runtime/io/page.html))
$(eval $(call as_text,commands/verify_driver.h,src/commands/verify_driver.in))
$(eval $(call as_text,toolchain/probe_text.h,src/toolchain/compiler_probe.in))
$(eval $(call as_text,emit/embedded_texts.h,$(patsubst %,runtime/include/lag_%.h,lanes math sincos support tree band kkt) runtime/numeric/gauss_points.h $(sort $(wildcard runtime/kernels/*.h))))
$(eval $(call as_text,fmu/%_text.h,src/fmu/%.in))
$(eval $(call as_text,commands/language.h,$(BUILD)/gen/commands/language.txt))
$(eval $(call as_text,commands/tutorial.h,models/TUTORIAL.md))
$(eval $(call as_text,commands/readme.h,README.md))
$(eval $(call as_text,commands/python.h,$(BUILD)/gen/commands/python.txt))
$(eval $(call as_text,commands/complete_%.h,src/commands/complete.%))
$(eval $(call as_text,commands/man_frame.h,src/lagc.1))
# Options and functions are described once, for the compiler and for the runtime in all precisions.
$(TABLES): $(BUILD)/gen/%: runtime/%
	@mkdir -p $(@D)
	cp $< $@
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
	awk -v kind=long -v digits=21 -f runtime/precision.awk $< | sed '/(as it stands)/!s/LAG_REAL/long double/g' >$@.part
	@mv $@.part $@
# What a model calls, for the compiler.
$(BUILD)/gen/numeric/lag_%.h: runtime/include/lag_%.h
	@mkdir -p $(@D)
	cp $< $@
# Documents that help shows and searches; the reference without the list of commands, which help has itself.
$(BUILD)/gen/commands/language.txt: grammar/LANGUAGE.md grammar/PHASE_SPACE.md
	@mkdir -p $(@D)
	@sed '/^<!-- generated/,/^<!-- end/d' $< >$@.part
	@sed -n '/^## /,$$p' grammar/PHASE_SPACE.md >>$@.part
	@mv $@.part $@
$(BUILD)/gen/commands/python.txt: runtime/python/README.md
	@mkdir -p $(@D)
	@sed '/^Tests:/,$$d' $< >$@
# One version: LAG_VERSION of lag.h.
$(BUILD)/obj/src/main.o: SRC_FLAGS += -DLAGC_VERSION='"$(VERSION)"'
$(BUILD)/obj/src/main.o: runtime/include/lag.h
$(BUILD)/obj/src/base/method_table.o: SRC_FLAGS += $(if $(GSL),-DLAGC_WITH_GSL)
$(BUILD)/obj/src/fmu/zip.o: SRC_FLAGS += $(if $(ZIP),-DLAGC_WITH_ZIP)
$(BUILD)/obj/src/commands/pack.o: SRC_FLAGS += $(if $(XZ),-DLAGC_WITH_XZ)
$(BUILD)/obj/src/toolchain/toolchain.o: SRC_FLAGS += '-DLAGC_LIBDIR="$(LIB_FROM_BIN)"' '-DLAGC_INCLUDEDIR="$(INCLUDE_FROM_BIN)"'
$(BUILD)/obj/src/base/method_table.o $(BUILD)/obj/src/fmu/zip.o $(BUILD)/obj/src/commands/pack.o $(BUILD)/obj/src/toolchain/toolchain.o: $(CONFIG)
$(BUILD)/obj/runtime/io/html.o: $(BUILD)/gen/io/page.h
$(BUILD)/obj/src/emit/embedded_math.o: $(BUILD)/gen/emit/embedded_texts.h
$(BUILD)/obj/src/toolchain/compiler_probe.o: $(BUILD)/gen/toolchain/probe_text.h
$(BUILD)/obj/src/fmu/fmu_archive.o: $(patsubst %,$(BUILD)/gen/fmu/%_text.h,core cosimulation exchange fmi2 fmi3)
$(BUILD)/obj/src/commands/manual.o: $(patsubst %,$(BUILD)/gen/commands/%.h,language python readme tutorial)
$(BUILD)/obj/src/commands/verify_program.o: $(BUILD)/gen/commands/verify_driver.h
$(BUILD)/obj/src/commands/man_page.o: $(BUILD)/gen/commands/man_frame.h
$(BUILD)/obj/src/commands/completion.o: $(SHELLS:%=$(BUILD)/gen/commands/complete_%.h)
$(LAGC_OBJ) $(BUILD)/obj/src/main.o: | $(TABLES) $(BUILD)/gen/base/visible.h $(BUILD)/gen/base/posix.h $(SHARED:%=$(BUILD)/gen/numeric/%.h) $(patsubst %,$(BUILD)/gen/numeric/%.h,edit_distance fnv1a gauss_points poison lag_lanes lag_tree)
$(patsubst %,$(BUILD)/obj/src/%.o,toolchain/files toolchain/simulator_cache commands/build commands/command_line commands/cost_reference) $(BUILD)/obj/gen/toolchain/outfile.o: $(BUILD)/gen/toolchain/outfile.h
$(BUILD)/obj/gen/toolchain/outfile.o $(BUILD)/obj/gen/base/windows.o: | $(BUILD)/gen/base/posix.h
# Generated code is not ours to warn about.
$(BUILD)/obj/gen/%.o: $(BUILD)/gen/%.c | $(BUILD)/gen/lag.tab.h $(BUILD)/gen/lag.lex.h
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
gallery: all precisions
	@sed -n 's|^Drawn by `build/lagc \(.*\)`:$$|$(BUILD)/lagc \1 --quiet|p' models/README.md | sh -e

include tests/tests.mk .ci/install.mk .ci/page.mk .ci/playground.mk

# ---- the rest ---------------------------------------------------------------------------------------
clean:
	rm -rf $(BUILD)

help:
	@cat .ci/make_help.txt

ifneq ($(BUILDS),)
-include $(LAGC_OBJ:.o=.d) $(RT_OBJ:.o=.d) $(WASM_OBJ:.o=.d) $(LAGC_WASM_OBJ:.o=.d) $(GSL_OBJ:.o=.d) $(BUILD)/obj/src/main.d $(TEST_BIN:=.d)
endif

FORCE:
.PHONY: FORCE all page demo run-demo precisions gallery test check-quick test-long test-all bless hard bench cost-report build-tests build-san build-plain build-page build-programs build-more coverage build-coverage run-coverage fuzz fuzz-coverage mutants install uninstall deb dist clean help
