/* `lagc check`: derives every scene and every unused effect, then judges symmetries and expectations. */
#include "commands/check_json.h"
#include "commands/commands.h"

#include <string.h>

#include "symmetry/charges.h"
#include "mech/discontinuity.h"
#include "mech/far_error.h"
#include "mech/mass_definiteness.h"
#include "mech/switches.h"
#include "claims/expect.h"
#include "symmetry/noether_report.h"
#include "report/equation_listing.h"

/* The model without effects, as scenes without effects have met it. */
typedef struct {
  int compared; /* its equations, with the text */
  int judged;   /* it claims symmetries alone, and they hold: see lines */
  StrBuf lines;
} PlainModel;

/* Judges symmetries and expectations for the model without effects, and those inside an effect with that effect and
 * its requirements; no scene is needed. */
static void check_claims(Compiler *c, const PlainModel *plain, int allow_numeric, ExpectResults *results, StrBuf *out) {
  const Ast *ast = c->ast;
  EffectList where = model_claiming_effects(ast);
  Eqns **e = ARENA_ARRAY(ast->arena, Eqns *, where.n + 1);
  for (uint32_t i = 0; i < where.n; i++) {
    ModelChoice choice = {.bare = 1, .also = where.at[i]};
    if (where.at[i] || !plain->compared) e[i] = compiler_derive_compared(c, &choice);
    else if (!plain->judged) e[i] = compiler_derive(c, &choice);
  }
  sb_puts(out, sb_text(&plain->lines));
  for (uint32_t i = 0; i < where.n; i++) {
    if (!e[i]) continue;
    charges_judge(e[i], where.at[i]);
    charges_print(e[i], where.at[i], out);
    check_json_symmetries(c, e[i], where.at[i]);
    if (!where.at[i]) canonicals_check(e[i], out);
  }
  for (uint32_t i = 0; i < where.n; i++)
    if (e[i]) expects_check(e[i], where.at[i], allow_numeric, results);
}

static const char *with_effects(const Model *m) {
  StrBuf b = strbuf(m->arena);
  for (uint32_t i = 0; i < m->effects.n; i++) sb_printf(&b, "%s%s", i ? ", " : ", with ", m->effects.at[i]);
  return sb_text(&b);
}

typedef VEC(FoundUnit) FoundUnits;

/* Adds the units that a scene's model inferred and that are not listed yet. */
static void collect_units(Compiler *c, const Model *m, FoundUnits *all) {
  for (uint32_t i = 0; i < m->found.n; i++) {
    FoundUnit u = m->found.at[i];
    uint32_t k = 0;
    while (k < all->n && (all->at[k].name != u.name || strcmp(all->at[k].unit, u.unit) != 0)) k++;
    u.unit = k < all->n ? NULL : arena_strdup(c->arena, u.unit);
    if (u.unit) vec_push(c->arena, all, u);
  }
}

static void list_units(const FoundUnits *all, StrBuf *out) {
  for (uint32_t i = 0; i < all->n; i++)
    sb_printf(out, "%s%s [%s]", i ? ", " : "units found: ", all->at[i].name, all->at[i].unit);
  if (all->n) sb_putc(out, '\n');
}

/* Whether the model declares inputs; those of contacts do not count. */
static int has_inputs(const Model *m) { return m->inputs.n > model_contact_inputs(m); }

/* Additions of one scene, or one effect in no scene, to the report. */
typedef struct {
  ModelChoice choice;
  int is_first;
  PlainModel *plain;
  FoundUnits *found;
  StrBuf *out;
} CheckedPart;

static void list_families(const Model *m, StrBuf *out) {
  for (uint32_t i = 0; i < m->families.n; i++) {
    const ContactFamily *f = &m->families.at[i];
    sb_printf(out, "%s%s[%s%s%s]", i ? ", " : "contacts ", f->name, f->name_i, f->name_j ? ", " : "",
              f->name_j ? f->name_j : "");
  }
  if (m->families.n) sb_printf(out, ": %s, which moreau follows\n", m->families.n > 1 ? "families" : "a family");
}

/* Parameters that --fix made numbers are a model of their own. */
static void note_plain(Compiler *c, const Eqns *e, PlainModel *plain) {
  const Model *m = e->m;
  if (m->effects.n || c->o.fix) return;
  plain->compared = 1;
  if (plain->judged || m->expects.n || m->canonicals.n || m->hamiltonian) return;
  charges_print(e, NULL, &plain->lines);
  check_json_symmetries(c, e, NULL);
  plain->judged = 1;
}

static void check_scene(Compiler *c, void *data) {
  const CheckedPart *x = data;
  StrBuf *out = x->out;
  const char *name = x->choice.scene;
  Eqns *e = compiler_derive_compared(c, &x->choice);
  if (!e) check_json_scene(c, "scene", name, NULL, 0);
  if (!e) return;
  note_plain(c, e, x->plain);
  if (!out->n) {
    show_facts(e, out);
    show_cyclic(e, "", out);
    list_families(e->m, out);
    check_json_facts(c, e);
  }
  collect_units(c, e->m, x->found);
  switches_find(e);
  switches_warn(e);
  discontinuity_warn(e);
  far_errors_note(e);
  int moves = mobility_show(e, out) && mass_regular_at_start(e);
  check_json_scene(c, "scene", name, e->m, moves);
  if (!moves) return;
  sb_printf(out, "scene %s: ok%s\n", name, with_effects(e->m));
  if (x->is_first || e->m->effects.n) switches_show(e, out);
  if (e->m->effects.n || has_inputs(e->m) || e->energy_jumps) charges_show_broken(e, out);
}

static void check_unused_effect(Compiler *c, void *data) {
  const CheckedPart *x = data;
  const char *name = x->choice.also;
  Eqns *e = compiler_derive_compared(c, &x->choice);
  if (!e) return;
  switches_find(e);
  switches_warn(e);
  discontinuity_warn(e);
  far_errors_note(e);
  collect_units(c, e->m, x->found);
  check_json_scene(c, "effect in no scene", name, e->m, 1);
  sb_printf(x->out, "effect %s (in no scene): ok\n", name);
}

static void check_unused_effects(Compiler *c, FoundUnits *found, StrBuf *out) {
  EffectList unused = model_unused_effects(c->ast);
  for (uint32_t i = 0; i < unused.n; i++) {
    CheckedPart part = {.choice = {.bare = 1, .also = unused.at[i], .drawing = DRAWING_CHECKED},
                        .found = found, .out = out};
    compiler_with_scratch(c, check_unused_effect, &part);
  }
}

int check_print(Compiler *c, const char *scene, int allow_numeric, StrBuf *out) {
  const Ast *ast = c->ast;
  SceneList scenes = model_scenes(ast);
  FoundUnits found = {0};
  ExpectResults results = {0};
  PlainModel plain = {.lines = strbuf(c->arena)};
  for (uint32_t i = 0; i < scenes.n; i++) {
    if (scene && strcmp(scene, scenes.at[i]) != 0) continue;
    CheckedPart part = {.choice = {.scene = scenes.at[i], .drawing = DRAWING_CHECKED},
                        .is_first = i == 0 || scene, .plain = &plain, .found = &found, .out = out};
    compiler_with_scratch(c, check_scene, &part);
  }
  if (scene && !out->n) compiler_derive_compared(c, &(ModelChoice){.scene = scene}); /* reports the unknown scene */
  if (!scene) check_unused_effects(c, &found, out);
  list_units(&found, out);
  check_json_units(c, found.at, found.n);
  if (ast->diags->errors) return 0; /* expectations of a wrong model say nothing */
  check_claims(c, &plain, allow_numeric, &results, out);
  check_json_expects(c, &results);
  expects_print(&results, ast->sources, out);
  return 1;
}

int command_check(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  c->told = strbuf(c->arena);
  int judged = check_print(c, c->o.scene, c->o.allow_numeric, &out);
  if (judged || c->o.json) sb_puts(&out, sb_text(&c->told));
  check_json_report(c, &out);
  if (!judged) return STATUS_MODEL;
  if (c->o.json) return c->diags->errors ? STATUS_MODEL : STATUS_OK; /* main prints it, with the messages */
  int status = compiler_write(c, NULL, &out);
  return c->diags->errors ? STATUS_MODEL : status;
}
