# lagc and liblag. `make` builds build/lagc and build/liblag.a; README.md has the other commands.
CC      ?= cc
CFLAGS  ?= -O2 -g
WARN    := -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes
BUILD   ?= build
SAN     ?=
FLEX    ?= flex
BISON   ?= bison

CPPFLAGS_ALL := -D_XOPEN_SOURCE=700
SRC_FLAGS    := $(CPPFLAGS_ALL) -Isrc -I$(BUILD)/gen
RT_FLAGS     := $(CPPFLAGS_ALL) -Iruntime/include -Iruntime -ffp-contract=off

LAGC_SRC := $(filter-out src/main.c,$(wildcard src/*.c src/*/*.c))
GEN_SRC  := $(patsubst %,$(BUILD)/gen/%,lag.tab.c lag.lex.c)
RT_SRC   := $(filter-out runtime/gsl/%,$(wildcard runtime/*/*.c))
GSL_SRC  := $(wildcard runtime/gsl/*.c)

LAGC_OBJ := $(LAGC_SRC:%.c=$(BUILD)/obj/%.o) $(GEN_SRC:$(BUILD)/gen/%.c=$(BUILD)/obj/gen/%.o)
RT_OBJ   := $(RT_SRC:%.c=$(BUILD)/obj/%.o)
GSL_OBJ  := $(GSL_SRC:%.c=$(BUILD)/obj/%.o)

all: $(BUILD)/lagc $(BUILD)/liblag.a $(BUILD)/liblag_gsl.a

$(BUILD)/lagc: $(BUILD)/obj/src/main.o $(BUILD)/liblagc.a
	$(CC) $(CFLAGS) $(SAN) -o $@ $^ -lm

# Everything of the compiler but main: what the unit tests link.
$(BUILD)/liblagc.a: $(LAGC_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^
$(BUILD)/liblag.a: $(RT_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^
$(BUILD)/liblag_gsl.a: $(GSL_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/gen/lag.tab.c: grammar/lag.y
	@mkdir -p $(@D)
	$(BISON) -Wall -Werror --header=$(BUILD)/gen/lag.tab.h -o $@ $<
$(BUILD)/gen/lag.tab.h: $(BUILD)/gen/lag.tab.c ;
$(BUILD)/gen/lag.lex.c: grammar/lag.l
	@mkdir -p $(@D)
	$(FLEX) --header-file=$(BUILD)/gen/lag.lex.h -o $@ $<
$(BUILD)/gen/lag.lex.h: $(BUILD)/gen/lag.lex.c ;

$(BUILD)/obj/src/%.o: src/%.c
	@mkdir -p $(@D)
	$(CC) $(WARN) $(SRC_FLAGS) $(CFLAGS) $(SAN) -MMD -MP -c -o $@ $<
$(BUILD)/obj/runtime/%.o: runtime/%.c
	@mkdir -p $(@D)
	$(CC) $(WARN) $(RT_FLAGS) $(CFLAGS) $(SAN) -MMD -MP -c -o $@ $<
# Generated code is not ours to warn about.
$(BUILD)/obj/gen/%.o: $(BUILD)/gen/%.c | $(BUILD)/gen/lag.tab.h $(BUILD)/gen/lag.lex.h
	@mkdir -p $(@D)
	$(CC) -std=c11 -w $(SRC_FLAGS) $(CFLAGS) $(SAN) -MMD -MP -c -o $@ $<
$(BUILD)/obj/src/syntax/parse.o: $(BUILD)/gen/lag.tab.h $(BUILD)/gen/lag.lex.h

-include $(LAGC_OBJ:.o=.d) $(RT_OBJ:.o=.d) $(GSL_OBJ:.o=.d) $(BUILD)/obj/src/main.d

clean:
	rm -rf $(BUILD)

.PHONY: all clean
