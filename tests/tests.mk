# Tests, benches, coverage and mutants: what `make test`, `make bench` and their like build and run. Included by the Makefile.

# ---- tests: tests/run.sh says what a suite is -------------------------------------------------------
# Two builds for `make test`: as users get it, less the precisions; and in $(BUILD)/san with the address and undefined-behaviour sanitizers,
# which unit tests, their helpers and fuzz targets link. gcc compiles sanitized code at -Og in 60 % of the time of -O1 or of -O0, and in two
# thirds of that without the four checks of pointers, whose faults the address sanitizer sees for the greater part.
# `make test-long`, which CI runs, has all checks, at -O0, which leaves out no load, in $(BUILD)/zero; long and quad precision; and, where clang is
# installed, everything by clang. `make test-all` is the same without leaving out rows.
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
	$(RUN_TESTS) --today $(T)
# Unit and golden suites, without sanitizers: one build, of the compiler and of the runtime for doubles.
QUICK_BIN := $(BUILD)/test/quick
# Not those that take more than ten seconds each.
QUICK     := $(filter-out unit/test_rt_cost unit/test_nest unit/test_lift golden/gallery golden/run_emitted golden/run_steps golden/lib_%, \
               $(filter unit/test_%,$(UNIT_SRC:tests/%.c=%)) $(patsubst tests/%.sh,%,$(wildcard tests/golden/*.sh)))
check-quick: BIN   := $(QUICK_BIN)
check-quick: CLANG :=
check-quick:
	$(SETUP) test
	$(QUIET) BIN=$(QUICK_BIN) SAN_BUILD=$(BUILD) SAN_FLAGS= PRECISIONS= $(BUILD)/lagc $(LIBLAG) $(UNIT_SRC:tests/unit/%.c=$(QUICK_BIN)/%)
	$(RUN_TESTS) $(or $(T),$(QUICK))
ZERO = SAN_BUILD='$(BUILD)/zero' SAN_OPT='-O0 -g1' SAN_FLAGS='$(SAN_ALL)' BIN='$(BUILD)/zero/bin'
LONG := test-long test-all
$(LONG): MORE_BUILDS = PRECISIONS='$(PRECISIONS)' LAGC_CLANG='$(if $(CLANG),$(BUILD)/clang/lagc)'
$(LONG): SAN_BUILD := $(BUILD)/zero
$(LONG): SAN_FLAGS := $(SAN_ALL)
$(LONG): BIN := $(BUILD)/zero/bin
$(LONG):
	$(SETUP) test
	$(BUILD_TESTS) build-more $(ZERO)
	$(RUN_TESTS) $(@:test-%=--%) $(T)
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
	$(QUIET) all precisions
	$(RUN_TESTS) --bench $(T)

# What accuracy costs in time: models/COST.md, by this machine.
cost-report:
	$(SETUP) build
	$(QUIET) all precisions
	@LAGC='$(BUILD)/lagc' CC='$(CC)' sh tests/bench/lib_cost_report.sh

SAN_MAKE = $(QUIET) BUILD=$(SAN_BUILD) PRECISIONS= CFLAGS='$(SAN_OPT)' SAN='$(SAN_FLAGS)'
SAN_LAGC := $(SAN_BUILD)/liblagc.a
SAN_RT   := $(if $(GSL),$(SAN_BUILD)/liblag_gsl.a) $(SAN_BUILD)/liblag.a

# The largest build starts first; modules of pages, which are shrunk one step behind the other, while test programs are made.
ifneq ($(ONLY),)
build-tests: build-san
	$(QUIET) $(ONLY:tests/unit/%.c=$(BIN)/%)
else
build-tests: build-programs build-page
endif
build-programs: build-san build-plain
	$(QUIET) $(TEST_BIN)
build-page: build-plain
	$(if $(WASM),$(QUIET) page)
build-san:
	@echo 'building $(SAN_BUILD) with sanitizers'
	$(SAN_MAKE) $(if $(ONLY),,$(SAN_BUILD)/lagc) $(SAN_LAGC) $(SAN_RT)
build-plain:
	@echo 'building $(BUILD)/lagc'
	$(QUIET) all
build-more: build-san build-plain
	@echo 'building other precisions$(if $(CLANG), and $(BUILD)/clang by clang)'
	$(QUIET) precisions
	$(if $(CLANG),$(QUIET) BUILD=$(BUILD)/clang PRECISIONS= CC='$(CLANG)' CFLAGS=-O1 $(BUILD)/clang/lagc $(BUILD)/clang/liblag.a$(if $(GSL), $(BUILD)/clang/liblag_gsl.a))

# Test programs themselves: -O1 would take ten times as long to compile. Their objects stay when a library changes.
TEST_OPT ?= -O0 -g1
TEST_C    = $(CC) -std=c11 -Wall -Wextra $(CPPFLAGS_ALL) $(TEST_OPT) $(SAN_FLAGS) -MMD -MP -MF $(basename $@).d -o $@ $<
TEST_O    = $(CCACHE) $(TEST_C) -c
TEST_LINK = $(CC) $(TEST_OPT) $(SAN_FLAGS) $(FAST_LINKER:%=-fuse-ld=gold) -o $@ $<
.SECONDARY: $(TEST_BIN:=.o)
# tests/unit/test_rt_*: of the runtime. The rest of tests/unit: of the compiler.
$(BIN)/test_rt_%.o: tests/unit/test_rt_%.c | $(SAN_RT)
	@mkdir -p $(@D)
	$(TEST_O) -Iruntime/include -Iruntime -ffp-contract=off
$(BIN)/test_rt_%: $(BIN)/test_rt_%.o $(SAN_RT)
	$(TEST_LINK) $(SAN_RT) $(GSL_LIBS) -lcmocka -lm
$(BIN)/%.o: tests/unit/%.c | $(SAN_LAGC)
	@mkdir -p $(@D)
	$(TEST_O) -Isrc -I$(SAN_BUILD)/gen
$(BIN)/%: $(BIN)/%.o $(SAN_LAGC)
	$(TEST_LINK) $(SAN_LAGC) $(LAGC_LIBS) -lcmocka -lm
$(BIN)/fuzz_%.o: tests/fuzz/fuzz_%.c | $(SAN_LAGC)
	@mkdir -p $(@D)
	$(TEST_O) -Isrc -I$(SAN_BUILD)/gen
$(BIN)/fuzz_%: $(BIN)/fuzz_%.o $(BIN)/driver.o $(SAN_LAGC)
	$(TEST_LINK) $(BIN)/driver.o $(SAN_LAGC) $(LAGC_LIBS) -lm
# fuzz_load is of the runtime, with models as lagc emits them: the method behind the colon is what they are emitted for.
LOAD_MODELS := spring:verlet pend:variational series:taylor flow:gauss rod:variational ball:verlet
LOAD_SRC    := $(foreach m,$(LOAD_MODELS),$(BUILD)/test/load_$(firstword $(subst :, ,$m)).c)
$(BUILD)/test/load_%.c: tests/fuzz/load/load_%.lag $(BUILD)/lagc
	@mkdir -p $(@D)
	$(BUILD)/lagc emit $< --with linear --method $(patsubst $*:%,%,$(filter $*:%,$(LOAD_MODELS))) -o $@
$(BIN)/fuzz_load: tests/fuzz/fuzz_load.c $(BIN)/driver.o $(LOAD_SRC) $(SAN_RT)
	@mkdir -p $(@D)
	$(TEST_C) $(FAST_LINKER:%=-fuse-ld=gold) -Iruntime/include -Iruntime -ffp-contract=off $(BIN)/driver.o $(LOAD_SRC) $(SAN_RT) $(GSL_LIBS) -lm
$(BIN)/driver.o: tests/fuzz/driver.c
	@mkdir -p $(@D)
	$(TEST_O)

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
	  with="-Isrc -I$(BUILD)/fuzz/gen $(BUILD)/fuzz/liblagc.a $(LAGC_LIBS)"; \
	  [ $$f != fuzz_load ] || with="-DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION -Iruntime/include -Iruntime $(LOAD_SRC) $(BUILD)/fuzz/liblag.a"; \
	  $(CLANG) -std=c11 $(CPPFLAGS_ALL) -O1 -g $(SAN_ALL) -fsanitize=fuzzer -o $(BUILD)/fuzz/$$f tests/fuzz/$$f.c $$with -lm; \
	  case $$f in fuzz_parse|fuzz_compile) words=-dict=tests/fuzz/lag.dict ;; *) words= ;; esac; \
	  $(BUILD)/fuzz/$$f -max_total_time=$(SECONDS) -max_len=4096 -print_final_stats=1 -artifact_prefix=$(BUILD)/fuzz/ $$words $$found $$corpus; \
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
	  $(CC) -std=c11 $(CPPFLAGS_ALL) -O0 --coverage -Isrc -I$(COV)/gen -o $(COV)/$$f tests/fuzz/$$f.c tests/fuzz/driver.c $(COV)/liblagc.a $(LAGC_LIBS) -lm; \
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
	@ln -sfn "$(CURDIR)/runtime" "$(CURDIR)/models" $(COVERAGE)/.. # lagc finds headers and gallery there
	@printf '#!/bin/sh\nexec %s "$$@" -O0 --coverage\n' '$(CC)' >$(COVERAGE)/counted-cc && chmod +x $(COVERAGE)/counted-cc
	-$(COVERAGE_MAKE) MODEL_CC='$(CURDIR)/$(COVERAGE)/counted-cc' COVERAGE=yes GCOV_ERROR_FILE=/dev/null run-coverage
	@sh tests/coverage/lib_report.sh $(COVERAGE)
build-coverage: all $(TEST_BIN) $(if $(WASM),page)
run-coverage:
	$(RUN_TESTS) $(T)

# One-token changes of the sources, one at a time: which ones does no suite see? tests/mutants/mutants.py
N    ?= 100
SEED ?= 1
mutants:
	$(SETUP) test
	SAN_FLAGS='$(SAN_FLAGS)' python3 tests/mutants/mutants.py --n $(N) --seed $(SEED) $(if $(JOBS),--jobs $(JOBS)) $(if $(ONLY_IN),--only '$(ONLY_IN)') $(if $(SUITES),--suites '$(SUITES)')
