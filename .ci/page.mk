# The WebAssembly module of live pages: liblag without simulators, built where Clang has a target wasm32-wasi (Debian: clang lld wasi-libc
# libclang-rt-14-dev-wasm32); smaller where binaryen is found. Included by the Makefile.
WASM       := $(WASM_FOUND)
SHRINK      = $(if $(shell command -v wasm-opt),wasm-opt -Oz --enable-bulk-memory $@ -o $@)
WASM_SRC   := runtime/page/page_module.c $(filter runtime/core/% runtime/methods/% runtime/constraints/% runtime/contacts/% runtime/numeric/% \
                runtime/evaluator/% runtime/analysis/automatic_method.c runtime/analysis/spectrum.c,$(RT_SRC))
WASM_OBJ   := $(WASM_SRC:%.c=$(BUILD)/obj/wasm/%.o)
WASM_FLAGS := -std=c11 -Oz -mbulk-memory -ftls-model=local-exec -ffp-contract=off $(CPPFLAGS_ALL) -Iruntime/include -Iruntime -I$(BUILD)/gen
# What a page's script calls (runtime/page/motion.js).
WASM_CALLS := $(shell cat runtime/page/*.js | grep -oE "\\bf\.(lag|page)_[a-z_]+" | cut -c 3- | sort -u) malloc free page_output page_state

$(BUILD)/obj/wasm/%.o: %.c
	@mkdir -p $(@D)
	$(CCACHE) $(WASM) $(WASM_FLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/lag.wasm: $(WASM_OBJ) runtime/page/motion.js
	$(WASM) -mexec-model=reactor -Wl,--gc-sections,--strip-all,--stack-first,-z,stack-size=1048576 $(WASM_CALLS:%=-Wl,--export=%) -o $@ $(WASM_OBJ) -lm
	$(SHRINK)

# The page of `lagc page`: a frame with the scripts in it.
LIVE := $(addprefix runtime/page/,live.html motion.js words.js typeset.js plots.js drag.js live.js)
$(BUILD)/gen/page/live_page.txt: $(LIVE) runtime/io/page.html
	@mkdir -p $(@D)
	sed -n '/^\/\/ ---- drawing/,/^\/\/ ---- marks/p' runtime/io/page.html >$(@D)/drawing.js
	sed -n '/^\/\/ ---- numbers/,/^\/\/ ---- the run/p' runtime/io/page.html >$(@D)/numbers.js
	sed -e '/@DRAWING@/{r $(@D)/drawing.js' -e 'd}' $(@D)/numbers.js runtime/page/words.js runtime/page/typeset.js runtime/page/plots.js runtime/page/drag.js runtime/page/live.js >$(@D)/live.js
	sed -e '/@MOTION@/{r runtime/page/motion.js' -e 'd}' runtime/page/live.html | sed 's/^  *//; /^\/\/ /d' >$@
	{ echo '"use strict";'; sed 's/^  *//; /^\/\/ /d' $(@D)/live.js; } >$(@D)/live_script.txt
$(BUILD)/gen/page/live_script.txt: $(BUILD)/gen/page/live_page.txt ; @: # the same recipe writes it
$(eval $(call as_text,commands/live_page.h,$(BUILD)/gen/page/live_page.txt))
$(eval $(call as_text,commands/live_script.h,$(BUILD)/gen/page/live_script.txt))
$(BUILD)/obj/src/commands/page.o $(BUILD)/obj/src/commands/playground.o: $(BUILD)/gen/commands/live_page.h
$(BUILD)/obj/src/commands/page_parts.o: $(BUILD)/gen/commands/live_script.h

page: all $(BUILD)/lag.wasm $(BUILD)/lagc.wasm.gz

# The gallery as live pages: build/site/index.html.
site: page
	.ci/site $(BUILD)/lagc $(BUILD)/site
.PHONY: site

-include $(WASM_OBJ:.o=.d)
