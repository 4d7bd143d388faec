/* `lagc emit`: the model as C for the runtime. */
#include "commands/commands.h"

#include "emit/emit_model.h"
#include "mech/switches.h"

int command_emit(Compiler *c) {
  if (!compiler_knows_method(c)) return STATUS_USAGE;
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  switches_find(e); /* for the runtime; headers, and what is verified, follow the text */
  ProgramSet *u = compiler_lower_scene(c, e, 1);
  if (!u) return STATUS_MODEL;
  StrBuf out = strbuf(c->arena);
  emit_model(u, model_id(c->arena, u->name), c->o.standalone ? MODEL_ALONE : MODEL_PLAIN, &out);
  return compiler_write_c(c, c->o.output, &out);
}
