/* check SEED FROM TO: derives models FROM .. TO of a seed in one process, and lets each compare what it compiled
 * with its text (src/self_check). Prints those that disagree, and a last line: `N agree, N with nothing decided, N
 * refused, N disagree; seed S`. Exit status 1 where one disagrees, or more than a tenth is refused: a generator
 * whose models are no models tests nothing. */
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ir/program_set.h"
#include "self_check/self_check.h"
#include "lower/lower.h"
#include "model.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

typedef enum { AGREES, UNDECIDED, REFUSED, DISAGREES, OUTCOMES } Outcome;

static Outcome judge(Arena *a, Diags *diags, Sources *sources, const char *text) {
  Ast *ast = ast_new(a, interner_new(a), sources, diags);
  if (!parse(ast, source_add(sources, "random.lag", text, strlen(text)))) return REFUSED;
  Model *m = model_build(ast, &(ModelChoice){0});
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e) return REFUSED;
  ProgramSet *u = unit_new(e, "random.lag", 0);
  unsigned of_headers =
      WANT_MASS | WANT_INVERSE | WANT_BY_INPUTS | WANT_BY_PARAMS | WANT_MULTIPLIERS | WANT_CONSTRAINED;
  unit_require(u, e, WANT_TAYLOR | of_headers | (e->singular_mass ? 0 : WANT_VARIATION | WANT_LINEAR));
  unit_add_scene(u, e);
  unit_hoist(u);
  SelfCheck told;
  if (!self_check(e, u, 0, &told)) return DISAGREES;
  return told.states ? AGREES : UNDECIDED;
}

static Outcome check_one(uint64_t seed, uint64_t number) {
  char *text = random_model(seed, number);
  ArenaConfig config = {.max_bytes = (size_t)1 << 30};
  Arena *a = arena_new(&config);
  jmp_buf out_of_memory;
  if (!text || !a) exit(2);
  Outcome v = REFUSED;
  if (!setjmp(out_of_memory)) {
    arena_guard(a, &out_of_memory);
    Sources *sources = sources_new(a);
    Diags *diags = diags_new(a, sources);
    v = judge(a, diags, sources, text);
    if (v == DISAGREES || getenv("RANDOM_VERBOSE")) {
      StrBuf said = strbuf(a);
      diags_print(diags, &said);
      printf("model %llu of seed %llu:\n%s%s\n", (unsigned long long)number, (unsigned long long)seed,
             v == DISAGREES ? text : "", sb_text(&said));
    }
  }
  arena_free(a);
  free(text);
  return v;
}

int main(int argc, char **argv) {
  if (argc != 4) return fprintf(stderr, "usage: check SEED FROM TO\n"), 2;
  uint64_t seed = strtoull(argv[1], NULL, 10), from = strtoull(argv[2], NULL, 10), to = strtoull(argv[3], NULL, 10);
  uint64_t n[OUTCOMES] = {0};
  for (uint64_t i = from; i <= to; i++) n[check_one(seed, i)]++;
  printf("%llu agree, %llu with nothing decided, %llu refused, %llu disagree; seed %llu\n",
         (unsigned long long)n[AGREES], (unsigned long long)n[UNDECIDED], (unsigned long long)n[REFUSED],
         (unsigned long long)n[DISAGREES], (unsigned long long)seed);
  return n[DISAGREES] > 0 || n[REFUSED] * 10 > to - from + 1;
}
