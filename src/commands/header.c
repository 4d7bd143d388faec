/* `lagc header`: the model as a header that depends on nothing. */
#include "commands/commands.h"

#include <string.h>

#include "emit/emit_model.h"
#include "mech/constrain.h"
#include "mech/consistent_start.h"
#include "report/equation_listing.h"

/* The prefix of a header's names: its file's (pend.h: PEND_IMPLEMENTATION), on standard output the model's. */
static const char *header_name(Compiler *c, const char *model) {
  const char *path = c->o.output;
  if (!path || strcmp(path, "-") == 0) return model;
  const char *slash = strrchr(path, '/'), *stem = slash ? slash + 1 : path, *dot = strchr(stem + (stem[0] == '.'), '.');
  return dot ? arena_strndup(c->arena, stem, (size_t)(dot - stem)) : stem;
}

/* Computes the consistent start that a run would find, and stores it in the header's scene. */
static int bake_start(Compiler *c, const Eqns *e, IrUnit *u) {
  long double *found = ARENA_ARRAY(c->arena, long double, 2 * (size_t)e->n + 1);
  unsigned char *moved = ARENA_ARRAY(c->arena, unsigned char, 2 * (size_t)e->n + 1);
  if (!start_of_scene(e, found, moved)) return 0;
  for (uint32_t i = 0; i < 2 * e->n; i++)
    if (moved[i]) vec_push(c->arena, &u->scenes.at[0].moves, ((IrMove){i, (double)found[i]}));
  return 1;
}

int command_header(Compiler *c) {
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  constraints_keep_none(e);
  IrUnit *u = compiler_lower_scene(c, e, 0);
  if (!u || !bake_start(c, e, u)) return STATUS_MODEL;
  StrBuf equations = strbuf(c->arena), out = strbuf(c->arena);
  show_equations(e, "", PRINT_TEXT, &equations);
  emit_header(u, header_name(c, u->name), sb_text(&equations), &out);
  return compiler_write(c, c->o.output, &out);
}
