/* Fuzzing the whole way: any bytes are parsed, and every scene, and every effect that no scene uses, is derived,
 * lowered, and written as C, header, text and LaTeX, its expectations judged. Nothing may crash, leak, take more
 * than its memory limit, or make a program that prog_verify refuses; a model that is not built says why.
 *
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined ... tests/fuzz/fuzz_compile.c LIBLAGC -o fuzz
 *   ./fuzz -dict=tests/fuzz/lag.dict -timeout=10 tests/fuzz/corpus/compile
 * tests/fuzz/driver.c replays the corpus in `make test`. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "emit/cnames.h"
#include "emit/cwriter.h"
#include "emit/emit_model.h"
#include "report/equation_listing.h"
#include "lower/lower.h"
#include "symmetry/charges.h"
#include "claims/expect.h"
#include "model/model.h"
#include "syntax/parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_MEMORY = 256 * 1024 * 1024, MAX_SCENES = 8 };

static void write_everything(Arena *a, Eqns *e) {
  ProgramSet *u = unit_new(e, "fuzz.lag", 0);
  unit_require(u, e, WANT_VARIATION);
  unit_add_scene(u, e);
  if (prog_verify(u->accel)) abort();
  if (u->energy && prog_verify(u->energy)) abort();
  if (u->variation && (prog_verify(u->variation) || prog_verify(u->second))) abort();
  if (prog_verify(u->scenes.at[0].observe)) abort();
  StrBuf c = strbuf(a), text = strbuf(a), latex = strbuf(a);
  emit_model(u, cname(a, u->name), MODEL_PLAIN, &c);
  const char *cost = op_count_text(u->accel, a);
  show_equations(e, cost, PRINT_TEXT, &text);
  show_equations(e, cost, PRINT_LATEX, &latex);
  emit_header(u, u->name, (HeaderParts){0}, sb_text(&text), &c);
}

/* One scene, or one effect on top of the first scene. */
static void compile(Ast *ast, const char *scene, Name also) {
  ModelChoice choice = {.scene = scene, .also = also};
  Model *m = model_build(ast, &choice);
  if (!m && !ast->diags->errors) abort();
  if (!m) return;
  Eqns *e = equations_of(m);
  if (!e && !ast->diags->errors) abort();
  if (e) write_everything(ast->arena, e);
}

/* The expectations of the model, or of one effect. */
static void judge(Ast *ast, Name effect) {
  ModelChoice choice = {.bare = 1, .also = effect};
  ExpectResults results = {0};
  Model *m = model_build(ast, &choice);
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e) return;
  expects_check(e, effect, 0, &results);
  StrBuf out = strbuf(ast->arena);
  expects_print(&results, ast->sources, &out);
}

static void run(Arena *a, const uint8_t *data, size_t size) {
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  const Source *source = source_add(sources, "fuzz.lag", arena_strndup(a, (const char *)data, size), size);
  if (!source) return;
  if (parse(ast, source)) {
    SceneList scenes = model_scenes(ast);
    for (uint32_t i = 0; i < scenes.n && i < MAX_SCENES; i++) compile(ast, scenes.at[i], NULL);
    EffectList unused = model_unused_effects(ast);
    for (uint32_t i = 0; i < unused.n && i < MAX_SCENES; i++) compile(ast, NULL, unused.at[i]);
    EffectList where = model_claiming_effects(ast);
    for (uint32_t i = 0; i < where.n && i < MAX_SCENES && !ast->diags->errors; i++) judge(ast, where.at[i]);
  }
  StrBuf out = strbuf(a);
  diags_print(ast->diags, &out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char devices[] = "/dev"; /* including a terminal would wait for ever */
  for (size_t i = 0; i + 4 <= size; i++)
    if (memcmp(data + i, devices, 4) == 0) return 0;
  ArenaConfig config = {.chunk = 4096, .max_bytes = FUZZ_MEMORY};
  Arena *a = arena_new(&config);
  jmp_buf failed;
  if (!a) return 0;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    run(a, data, size);
  }
  arena_free(a);
  return 0;
}
