/* The stages of a compilation, and what all commands do with files and messages. */
#include "commands/compiler.h"

#include <stdio.h>
#include <string.h>

#include "base/diag.h"
#include "base/method_table.h"
#include "base/visible.h"
#include "commands/run_request.h"
#include "emit/late_text.h"
#include "ir/program_set.h"
#include "self_check/self_check.h"
#include "lower/lower.h"
#include "mech/constrain.h"
#include "mech/consistent_start.h"
#include "mech/mass_definiteness.h"
#include "model/model.h"
#include "report/equation_listing.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"
#include "toolchain/files.h"
#include "toolchain/gallery.h"

void compiler_messages(const Compiler *c, StrBuf *out) {
  if (!c->diags->errors) model_warn_unused(c->ast); /* by now the command line's expressions are read, too */
  if (c->o.command == CMD_CHECK && c->o.json) return;
  diags_print(c->diags, out);
}

void compiler_print_messages(const Compiler *c) {
  StrBuf messages = strbuf(c->arena);
  compiler_messages(c, &messages);
  fputs(sb_text(&messages), stderr);
}

int usage_error(const char *message) {
  fputs("lagc: ", stderr);
  fput_visible(stderr, message, "\n\t");
  fputc('\n', stderr);
  return STATUS_USAGE;
}

static int wants_dump(const Compiler *c, const char *stage) {
  const char *at = c->o.dump ? strstr(c->o.dump, stage) : NULL;
  size_t n = strlen(stage);
  return at && (at == c->o.dump || at[-1] == ',') && (at[n] == ',' || at[n] == '\0');
}

int compiler_is_source(Compiler *c, const char *path) {
  for (uint32_t i = 0; i < c->sources->files.n; i++) {
    if (!file_same(path, c->sources->files.at[i].path)) continue;
    const char *what = i == 0 ? "the model" : "a part of the model";
    usage_error(arena_printf(c->arena, "%s would be overwritten: it is %s; write to another file", path, what));
    return 1;
  }
  return 0;
}

int compiler_write(Compiler *c, const char *path, const StrBuf *text) {
  const char *why;
  if (c->small) sb_putn(&c->small->written, sb_text(text), text->n);
  if (c->small) return STATUS_OK;
  if (path && c->sources && compiler_is_source(c, path)) return STATUS_USAGE;
  if (file_write(path ? path : "-", sb_text(text), text->n, &why)) return STATUS_OK;
  return usage_error(arena_printf(c->arena, "cannot write %s: %s", path ? path : "standard output", why));
}

int compiler_write_c(Compiler *c, const char *path, const StrBuf *text) {
  const StrBuf whole = c->small ? *text : late_text_write(text);
  return compiler_write(c, path, &whole);
}

int compiler_report(Compiler *c, const char *path, const StrBuf *text) {
  return c->diags->errors ? STATUS_MODEL : compiler_write(c, path, text);
}

/* --- the stages --- */

void compiler_begin(Compiler *c) {
  c->sources = sources_new(c->arena);
  c->diags = diags_new(c->arena, c->sources);
  c->ast = ast_new(c->arena, interner_new(c->arena), c->sources, c->diags);
}

int compiler_open(Compiler *c) {
  const char *why = NULL, *path = gallery_path(c->arena, c->argv0, c->o.file, &why);
  if (!path) return usage_error(why);
  c->o.file = path;
  if (!source_read_model(c->sources, path, &why)) {
    const char *model = gallery_name(c->arena, c->argv0, path), *whole = arena_printf(c->arena, "%s.lag", path);
    if (file_exists(whole))
      return usage_error(arena_printf(c->arena, "cannot read %s: %s; did you mean %s?", path, why, whole));
    return usage_error(arena_printf(c->arena, model ? "cannot read %s: %s; the gallery has @%s" : "cannot read %s: %s",
                                    path, why, model));
  }
  return STATUS_OK;
}

int compiler_parse(Compiler *c) {
  parse(c->ast, &c->sources->files.at[0]);
  settings_defines(c->ast, c->o.defines.at, c->o.defines.n);
  if (wants_dump(c, "ast")) {
    StrBuf b = strbuf(c->arena);
    ast_dump(c->ast, &b);
    compiler_write(c, NULL, &b);
  }
  return c->diags->errors ? STATUS_MODEL : STATUS_OK;
}

Model *compiler_model(Compiler *c, const ModelChoice *choice) {
  ModelChoice with_defines = *choice;
  with_defines.defines = c->o.defines.at;
  with_defines.ndefines = c->o.defines.n;
  if (!choice->bare && !choice->unfixed) with_defines.fix = c->o.fix;
  if (c->small) with_defines.times = c->small->times, with_defines.more = c->small->more;
  return model_build(c->ast, &with_defines);
}

/* Whether the command knows families of contacts; reported. */
static int takes_families(const Compiler *c, const Model *m) {
  static const unsigned char knows[CMD_COUNT] = {
      [CMD_CHECK] = 1, [CMD_VERIFY] = 1, [CMD_DERIVE] = 1, [CMD_NOETHER] = 1, [CMD_RUN] = 1, [CMD_PLOT] = 1,
      [CMD_ANIMATE] = 1, [CMD_SWEEP] = 1, [CMD_BUILD] = 1, [CMD_EMIT] = 1, [CMD_PAGE] = 1, [CMD_EFFECTS] = 1};
  if (!m->families.n || knows[c->o.command]) return 1;
  int embeds = c->o.command == CMD_HEADER || c->o.command == CMD_FMU;
  return diag_error(m->diags, m->families.at[0].span, "families of contacts in `lagc %s` are not supported%s" HELP
                    "%ssingle contacts, `for i in 1..N { contact hit[i]: ... }`, stand in all programs",
                    command_find(c->o.command)->name, embeds ? ", whose programs allocate no lists of neighbours" : "",
                    embeds ? "`lagc build --shared` makes a library with a C interface; " : "");
}

Eqns *compiler_derive(Compiler *c, const ModelChoice *choice) {
  Model *m = compiler_model(c, choice);
  if (!m || !takes_families(c, m)) return NULL;
  StrBuf listing = strbuf(c->arena);
  Eqns *e = equations_of(m);
  if (e && !choice->bare) mass_warn_nonpositive(e); /* claims hold for all values of parameters */
  if (e && wants_dump(c, "eqns")) dump_equations(e, &listing);
  if (listing.n) compiler_write(c, NULL, &listing);
  return e;
}

Eqns *compiler_derive_scene(Compiler *c, const char *scene) {
  return compiler_derive(c, &(ModelChoice){.scene = scene});
}

Eqns *compiler_derive_wanted(Compiler *c, const ModelChoice *choice) {
  Eqns *e = compiler_derive(c, choice);
  return e && e->singular_mass && (derivatives_required(e, &c->o) & WANT_VARIATION) ? equations_regularised(e) : e;
}

ProgramSet *compiler_unit_head(Compiler *c, Eqns *e) {
  return unit_head(e, c->o.file, c->o.math && strcmp(c->o.math, "libm") == 0);
}

ProgramSet *compiler_new_unit(Compiler *c, Eqns *e) {
  ProgramSet *u = compiler_unit_head(c, e);
  unit_add_programs(u, e);
  return u;
}

static int agrees(const Eqns *e, const ProgramSet *u, uint32_t scene, SelfCheck *told) {
  const char *wrong = program_set_verify(u);
  if (wrong) diag_error(e->m->diags, (Span){0}, "internal error: %s", wrong);
  return !wrong && self_check(e, u, scene, told);
}

int compiler_agrees(const Eqns *e, const ProgramSet *u, uint32_t scene) {
  SelfCheck told;
  return agrees(e, u, scene, &told);
}

ProgramSet *compiler_lower_scene(Compiler *c, Eqns *e, int hoists) {
  ProgramSet *u = compiler_new_unit(c, e);
  unit_require(u, e, derivatives_afforded(derivatives_required(e, &c->o), e, u, &c->o));
  unit_add_scene(u, e);
  if (hoists) unit_hoist(u);
  if (!compiler_agrees(e, u, 0)) return NULL;
  StrBuf b = strbuf(c->arena);
  if (wants_dump(c, "passes")) lower_accel_traced(e, u->libm, &b);
  if (wants_dump(c, "prog")) prog_dump(u->accel, &b);
  if (b.n) compiler_write(c, NULL, &b);
  return u;
}

/* Computes the consistent start that a run would find, and stores it in the header's scene. */
static int bake_start(Compiler *c, const Eqns *e, ProgramSet *u) {
  long double *found = ARENA_ARRAY(c->arena, long double, 2 * (size_t)e->n + 1);
  unsigned char *moved = ARENA_ARRAY(c->arena, unsigned char, 2 * (size_t)e->n + 1);
  if (!start_of_scene(e, found, moved)) return 0;
  for (uint32_t i = 0; i < 2 * e->n; i++)
    if (moved[i]) vec_push(c->arena, &u->scenes.at[0].moves, ((IrMove){i, (double)found[i]}));
  return 1;
}

/* Warns of outputs that headers and FMUs leave out, since liblag computes their action variables. */
static void warn_of_actions(const Eqns *e) {
  const Model *m = e->m;
  for (uint32_t i = 0; i < e->noutputs; i++)
    for (uint32_t k = 0; k < m->actions.n && !output_is_plain(e, i); k++)
      if (expr_contains_sym(e->g, m->scene.outputs.at[i].value, m->actions.at[k].sym)) {
        diag_warning(m->diags, m->scene.outputs.at[i].span,
                     "the output `%s` is left out: liblag computes action variables, and this does without it",
                     m->scene.outputs.at[i].name);
        diag_help(m->diags, "a library with all outputs: `lagc build --shared`");
        break;
      }
}

/* Notes that sums over neighbours test all pairs in headers and FMUs, which keep no lists. */
static void note_pairs(const Eqns *e) {
  const Model *m = e->m;
  for (uint32_t i = 0; i < m->ast->nears.n && m->sums.n; i++)
    if (ast_expr(m->ast, m->ast->nears.at[i].sum)->kind == AST_SUM)
      diag_note(m->diags, m->ast->nears.at[i].span, "all pairs are tested here, in a time that grows as N^2" HELP
                "programs of `lagc run`, `lagc build` and `lagc emit` keep lists of neighbours");
}

ProgramSet *compiler_lower_embedded(Compiler *c, Eqns *e) {
  constraints_keep_none(e);
  note_pairs(e);
  warn_of_actions(e);
  ProgramSet *u = compiler_lower_scene(c, e, 0);
  return u && bake_start(c, e, u) ? u : NULL;
}

typedef struct {
  Compiler *c;
  const Eqns *e;
  int agrees;
} Comparison;

/* Compares the equations with the text, if it is not too long; the programs, which nobody reads afterwards, are made in
 * the scratch arena. */
static void compare(Arena *scratch, void *data) {
  Comparison *x = data;
  Model m = *x->e->m;
  Eqns e = *x->e;
  m.arena = scratch;
  e.m = &m;
  SelfCheck told;
  x->agrees = 1;
  if (self_check_ends(&e, &told)) {
    ProgramSet *u = compiler_new_unit(x->c, &e);
    unit_add_scene(u, &e);
    x->agrees = agrees(&e, u, 0, &told);
  }
  if (x->agrees && x->c->o.verbose) self_check_print(&e, &told, &x->c->told);
}

Eqns *compiler_derive_compared(Compiler *c, const ModelChoice *choice) {
  Eqns *e = compiler_derive(c, choice);
  if (!e) return NULL;
  Comparison x = {.c = c, .e = e};
  arena_with_scratch(e->m->arena, compare, &x);
  return x.agrees ? e : NULL;
}

typedef struct {
  Compiler *c;
  void (*work)(Compiler *c, void *data);
  void *data;
} ScratchWork;

static void work_in_scratch(Arena *scratch, void *data) {
  const ScratchWork *x = data;
  Ast *ast = x->c->ast, same = *ast;
  same.arena = scratch;
  x->c->ast = &same;
  x->work(x->c, x->data);
  x->c->ast = ast;
}

void compiler_with_scratch(Compiler *c, void (*work)(Compiler *c, void *data), void *data) {
  model_prepare(c->ast);
  arena_with_scratch(c->arena, work_in_scratch, &(ScratchWork){c, work, data});
}

int compiler_knows_method(Compiler *c) {
  size_t n = c->o.method ? strcspn(c->o.method, " (") : 0;
  if (!n || method_find(c->o.method, n) || method_may_be_gsl(c->o.method)) return 1;
  const char *name = arena_strndup(c->arena, c->o.method, n), *near = method_suggest(c->arena, name);
  const char *help = near ? arena_printf(c->arena, "did you mean %s? ", near) : "";
  usage_error(arena_printf(c->arena, "unknown method %s; %s`lagc methods` lists them", name, help));
  return 0;
}
