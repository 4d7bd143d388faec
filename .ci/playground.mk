# The WebAssembly module of playgrounds: the stages of lagc on one text in memory (src/playground), for where WASM is found (.ci/page.mk).
# Without src/toolchain, fmu and the commands that need files or processes: the linker drops what no answer calls.
LAGC_WASM_SRC := $(filter-out src/toolchain/% src/fmu/% src/commands/% src/base/source_file.c,$(LAGC_SRC)) $(wildcard src/playground/*.c) \
  $(patsubst %,src/commands/%.c,check check_json compiler const_ranges effect_sets noether page_model page_parts range required_derivatives run_request settings command_table)
LAGC_WASM_GEN := $(filter-out toolchain/%,$(GEN_SRC:$(BUILD)/gen/%=%))
LAGC_WASM_OBJ := $(LAGC_WASM_SRC:%.c=$(BUILD)/obj/wasm/%.o) $(LAGC_WASM_GEN:%.c=$(BUILD)/obj/wasm/gen/%.o)
# -Os is an eighth smaller than -O2, and as fast. long double has 34 digits here; the stack is below the data, so that too deep a call is an error.
LAGC_WASM_FLAGS := -std=c11 -Os -w -mbulk-memory -ftls-model=local-exec -ffp-contract=off -ffunction-sections -fdata-sections \
  $(CPPFLAGS_ALL) -D_WASI_EMULATED_PROCESS_CLOCKS -I$(BUILD)/gen/wasm $(SRC_FLAGS)

# Headers of src/playground in place of those of systems with jumps and files.
LAGC_WASM_HEAD := $(BUILD)/gen/wasm/setjmp.h $(BUILD)/gen/wasm/base/posix.h
$(BUILD)/gen/wasm/setjmp.h: src/playground/no_jumps.h
$(BUILD)/gen/wasm/base/posix.h: src/playground/no_files.h
$(LAGC_WASM_HEAD):
	@mkdir -p $(@D)
	cp $< $@
$(LAGC_WASM_OBJ): $(LAGC_WASM_HEAD) | $(LAGC_OBJ) # by then all that is generated is there
$(BUILD)/obj/wasm/src/%.o: src/%.c
	@mkdir -p $(@D)
	$(CCACHE) $(WASM) $(LAGC_WASM_FLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/obj/wasm/gen/%.o: $(BUILD)/gen/%.c
	@mkdir -p $(@D)
	$(CCACHE) $(WASM) $(LAGC_WASM_FLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/lagc.wasm: $(LAGC_WASM_OBJ)
	$(WASM) -mexec-model=reactor -Wl,--gc-sections,--strip-all,--stack-first,-z,stack-size=4194304 -Wl,--export=malloc,--export=playground_answer -o $@ $^ \
	  -lc-printscan-long-double -lwasi-emulated-process-clocks -lm
	$(SHRINK)
$(BUILD)/lagc.wasm.gz: $(BUILD)/lagc.wasm
	$(if $(shell command -v zopfli),zopfli -c,gzip -9nc) $< >$@

# The files of models/lib as `library[]`, {name, text}.
LIBRARY := $(sort $(wildcard models/lib/*.lag models/lib/*.csv models/lib/*.json))
$(BUILD)/gen/playground/library.h: $(LIBRARY)
	@mkdir -p $(@D)
	@{ echo 'static const struct { const char *name, *text; } library[] = {'; for f in $^; do echo "{\"$${f##*/}\","; sed 's/[\\"]/\\&/g; s/.*/"&\\n"/' $$f; echo '},'; done; echo '};'; } >$@
$(BUILD)/obj/wasm/src/playground/library_files.o: $(BUILD)/gen/playground/library.h

# The page of `lagc playground`: a frame with the scripts in it.
PLAY := $(addprefix src/playground/,playground.html mathml.js answer.js worker.js playground.js)
$(BUILD)/gen/playground/playground_page.txt: $(PLAY) runtime/page/motion.js
	@mkdir -p $(@D)
	cat src/playground/answer.js src/playground/worker.js >$(@D)/worker.js
	{ sed -n '/^function bytes_of/,/^}/p' runtime/page/motion.js; cat src/playground/playground.js; } >$(@D)/playground.js
	sed -e '/^@MATHML@/{r src/playground/mathml.js' -e 'd}' -e '/^@WORKER@/{r $(@D)/worker.js' -e 'd}' -e '/^@PLAYGROUND@/{r $(@D)/playground.js' -e 'd}' $< >$@
$(eval $(call as_text,commands/playground_page.h,$(BUILD)/gen/playground/playground_page.txt))
$(BUILD)/obj/src/commands/playground.o: $(BUILD)/gen/commands/playground_page.h

-include $(LAGC_WASM_OBJ:.o=.d)
