/* Hints for unknown names: declarations out of reach, habits from paper (xdot, p_x, wt), functions of other
 * languages, nearest names. */
#include "base/words.h"
#include "model/builder.h"

static int declares(const AstStmt *st, Name name) {
  return st->name == name && ((st->kind >= STMT_COORD && st->kind <= STMT_FUNCTION) || st->kind == STMT_OBSERVE);
}

const AstStmt *declared_in_use(const Builder *b, Name name, Name effect) {
  for (uint32_t i = 0; i < b->active.n; i++)
    if ((!b->active.at[i].effect || b->active.at[i].effect == effect) && declares(b->active.at[i].stmt, name))
      return b->active.at[i].stmt;
  return NULL;
}

int effect_declares(const AstStmt *effect, Name name) {
  for (const AstStmt *x = effect ? effect->body : NULL; x; x = x->next)
    if (declares(x, name)) return 1;
  return 0;
}

const AstStmt *declaring_effect(const Builder *b, Name name) {
  for (const AstStmt *e = b->ast->first; e; e = e->next)
    if (e->kind == STMT_EFFECT && effect_declares(e, name)) return e;
  return NULL;
}

static int is_active(const Builder *b, const AstStmt *st) {
  for (uint32_t i = 0; i < b->active.n; i++)
    if (b->active.at[i].stmt == st) return 1;
  return 0;
}

/* An effect that is off and declares a symmetry (a charge) of this name, or NULL. */
static const AstStmt *effect_with_charge(const Builder *b, Name name) {
  for (const AstStmt *e = b->ast->first; e; e = e->next)
    for (const AstStmt *x = e->kind == STMT_EFFECT ? e->body : NULL; x; x = x->next)
      if (x->kind == STMT_SYMMETRY && x->name == name && !is_active(b, x)) return e;
  return NULL;
}

/* --- notation of paper --- */

/* 1 if word[0..n) names a coordinate, a state or a let. */
static int has_rate(const Builder *b, const char *word, size_t n) {
  for (uint32_t i = 0; n && i < b->scope.all.n; i++) {
    const Entity *e = &b->scope.all.at[i];
    int moves = e->kind == ENT_COORD || e->kind == ENT_STATE || e->kind == ENT_LET;
    if (moves && strlen(e->name) == n && strncmp(e->name, word, n) == 0) return 1;
  }
  return 0;
}

/* Recognises xdot, x_dot, dx, vx, xddot, ddx, ... of a name x; 0: no match. */
static int advise_rate(Builder *b, const char *name) {
  static const struct {
    const char *before, *behind, *primes;
  } forms[] = {{"", "_ddot", "''"}, {"", "ddot", "''"}, {"", "_dot", "'"}, {"", "dot", "'"},
               {"dd", "", "''"},    {"d", "", "'"},     {"v_", "", "'"},   {"v", "", "'"},
               {"", "p", "'"},      {"a_", "", "''"},   {"a", "", "''"}};
  size_t len = strlen(name);
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    size_t before = strlen(forms[i].before), behind = strlen(forms[i].behind);
    if (len <= before + behind || strncmp(name, forms[i].before, before) != 0 ||
        strcmp(name + len - behind, forms[i].behind) != 0)
      continue;
    size_t n = len - before - behind;
    if (!has_rate(b, name + before, n)) continue;
    diag_help(b->diags, "the %s of `%.*s` is written `%.*s%s`", forms[i].primes[1] ? "second derivative" : "rate",
              (int)n, name + before, (int)n, name + before, forms[i].primes);
    return 1;
  }
  return 0;
}

/* Recognises a momentum p_x where none is allowed. */
static int advise_momentum(Builder *b, const char *name) {
  if (strncmp(name, "p_", 2) != 0 || !has_rate(b, name + 2, strlen(name + 2))) return 0;
  diag_help(b->diags,
            "the momentum `%s` may stand in outputs, observables and expectations; here write it with the velocity "
            "`%s'`, which an event sets",
            name, name + 2);
  return 1;
}

/* Gives the advice of the first row that has the name among its words; 0: no row has it. */
static int advise_word(Builder *b, const char *const (*rows)[2], size_t n, Name name) {
  for (size_t i = 0; i < n; i++)
    if (has_word(rows[i][0], name)) {
      diag_help(b->diags, "%s", rows[i][1]);
      return 1;
    }
  return 0;
}

/* Names with a meaning on paper, and what to write instead. */
static const char *const paper_names[][2] = {
    {"dt", "a time derivative is written `x'`"},
    {"π", "did you mean `pi`?"},
    {"E H energy", "the energy is `energy`, in outputs, monitors, observables and expectations; elsewhere write it "
                   "with coordinates and velocities"},
    {"L lagrangian", "the Lagrangian is `lagrangian`, in outputs, observables and expectations; elsewhere write it "
                     "with coordinates and velocities"},
    {"g", "gravity is a parameter, too: `param g = 9.81 [m/s^2]`"},
    {"T V", "where L is `kinetic` less `potential` (no effect in use adds a `lagrangian`), the energies are `T` and "
            "`V`, in outputs, observables and expectations"},
    {"t", "`t` is the time, which a run gives its value: `span 20 [s]` says how long it is"},
    {"e", "the number is `exp(1)`; a parameter is declared: `param e = 0.9`"},
};

/* Recognises the index of `let a[i] = ...`, which lacks a range. */
static int advise_index(Builder *b, Name name, Span span) {
  for (uint32_t i = 0; i < b->active.n; i++) {
    const AstStmt *st = b->active.at[i].stmt;
    for (AstId d = st->kind == STMT_LET ? st->dims : 0; d; d = ast_expr(b->ast, d)->next) {
      const AstExpr *x = ast_expr(b->ast, d);
      if (x->kind != AST_NAME || x->name != name || span.begin != x->span.begin) continue;
      diag_help(b->diags, "an index has a range: `let %s[%s in 1..N] = ...`", st->name, name);
      return 1;
    }
  }
  return 0;
}

/* Functions of other languages and books, and what to write instead. */
static const char *const foreign_functions[][2] = {
    {FOREIGN_CHOICES, "a choice is written `if(x > 0, a, b)`: a where the condition holds, b where not; of several, "
                      "`if(x > 1, a, if(x > 0, b, c))`"},
    {"ln", "did you mean `log`?"},
    {"log10 log2", "write `log(x)/log(10)`, `log(x)/log(2)`"},
    {"arcsin arccos arctan arctan2", "the inverse functions are `asin`, `acos`, `atan`, `atan2`"},
    {"sec csc cot", "write `1/cos(x)`, `1/sin(x)`, `1/tan(x)`"},
    {"sqr square", "write `x^2`"},
    {"fabs", "did you mean `abs`?"},
    {"sgn signum", "did you mean `sign`?"},
    {"heaviside step", "write `if(x > 0, 1, 0)`"},
    {"diff Diff dt D grad", "a time derivative is written `x'`, a partial one `d(expr, name)`"},
    {"delay delayed lag history", "a delay does not exist: equations hold the state of one moment; a lag of first "
                                  "order is a state, `flow z' = (x - z)/T`"},
    {"length mag magnitude", "the length of a vector is `norm(r)`"},
};

int advise_unknown_function(Builder *b, Name name) {
  return advise_word(b, foreign_functions, sizeof foreign_functions / sizeof *foreign_functions, name);
}

/* 1 for an expression of the command line, where nothing can be declared. */
static int is_asked(const Builder *b, Span span) {
  const Source *file = source_place(b->ast->sources, span.begin).file;
  return file && strncmp(file->path, "--", 2) == 0;
}

/* Lists names that an expression can contain, of the model and of effects in use. */
static void advise_names(Builder *b) {
  enum { MOST = 24 };
  const Entity *shown[MOST];
  StrBuf list = strbuf(b->arena);
  uint32_t n = 0, i = 0;
  for (; i < b->scope.all.n && n < MOST; i++) {
    const Entity *e = &b->scope.all.at[i];
    int skip = e->kind == ENT_NONE || e->kind == ENT_FUNCTION || e->kind == ENT_BUILTIN;
    /* members of a family */
    for (uint32_t k = 0; k < n && !skip; k++) skip = shown[k]->name == e->name && shown[k]->effect == e->effect;
    if (skip) continue;
    sb_printf(&list, "%s%s%s%s", n ? ", " : "", e->effect ? e->effect : "", e->effect ? "." : "", e->name);
    shown[n++] = e;
  }
  if (n)
    diag_help(b->diags, "the model has %s%s%s", sb_text(&list), n == MOST ? ", ..." : "",
              b->m->lagrangian ? ", energy" : "");
}

static int is_among(const char *word, size_t length, const Name *names, uint32_t n) {
  for (uint32_t i = 0; i < n; i++)
    if (strlen(names[i]) == length && memcmp(names[i], word, length) == 0) return 1;
  return 0;
}

/* Recognises `wt` as w*t, where w and t are known. */
static int advise_product(Builder *b, Name name, const Name *known, uint32_t n) {
  size_t length = strlen(name);
  for (size_t cut = 1; cut < length; cut++)
    /* `xx` is a typing error, not x*x */
    if (is_among(name, cut, known, n) && is_among(name + cut, length - cut, known, n) &&
        strncmp(name, name + cut, cut) != 0) {
      diag_help(b->diags, "a product is written with `*`: `%.*s*%s`", (int)cut, name, name + cut);
      return 1;
    }
  return 0;
}

static int advise_function(Builder *b, Name name) {
  size_t i = 0;
  while (function_name(i) && strcmp(function_name(i), name) != 0) i++;
  if (function_name(i))
    diag_help(b->diags, "`%s` is a function, `%s(...)`; a power of it is written behind: `%s(...)^2`", name, name,
              name);
  return function_name(i) != NULL;
}

void advise_unknown_name(Builder *b, Name name, Span span, Name effect, const char *declare) {
  /* the message will not be shown, and the search is linear in the number of names */
  if (b->diags->list.n > DIAG_MAX) return;
  const AstStmt *later = declared_in_use(b, name, effect);
  if (later && span.begin >= later->span.begin && span.end <= later->span.end) {
    diag_help(b->diags, "the value of a name cannot contain the name itself");
    return;
  }
  if (later) {
    diag_help(b->diags, "here only names that stand before it are known; move its declaration up");
    diag_also(b->diags, later->name_span, "`%s` is declared here", name);
    return;
  }
  const AstStmt *owner = declaring_effect(b, name);
  if (!owner) owner = effect_with_charge(b, name);
  if (owner) {
    diag_help(b->diags, "the effect `%s` declares it, but is not in use here: `use %s`", owner->name, owner->name);
    return;
  }
  if (b->m->hamiltonian && is_momentum_name(name)) {
    diag_help(b->diags, "a momentum is declared with its coordinate: `momentum %s of x`", name);
    return;
  }
  if (advise_index(b, name, span) || advise_rate(b, name) || advise_momentum(b, name) || advise_function(b, name))
    return;
  Name *known = ARENA_ARRAY(b->arena, Name, b->scope.all.n + 3);
  uint32_t n = 0;
  vec_each(const Entity, e, b->scope.all)
    if (!e->effect || e->effect == effect || !scope_own(&b->scope, e->name, NULL)) known[n++] = e->name;
  known[n++] = "t";
  known[n++] = "pi";
  if (is_asked(b, span) && b->m->lagrangian) known[n++] = "energy";
  if (advise_product(b, name, known, n)) return;
  /* no nearest name, which could be t */
  int paper = strcmp(name, "dt") == 0 || strcmp(name, "T") == 0 || strcmp(name, "t") == 0;
  Name near = paper ? NULL : suggest(name, known, n);
  if (!near && advise_word(b, paper_names, sizeof paper_names / sizeof *paper_names, name)) return;
  if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else if (is_asked(b, span)) advise_names(b);
  else if (declare) diag_help(b->diags, "declare it: `%s %s`", declare, name);
  else diag_help(b->diags, "declare it: `param %s = 1`, `coord %s` or `let %s = ...`", name, name, name);
}

void report_no_member(Builder *b, Span span, Name effect, Name name) {
  diag_error(b->diags, span, "no effect in use declares `%s.%s`", effect, name);
  const AstStmt *e = NULL;
  VEC(Name) effects = {0};
  for (const AstStmt *s = b->ast->first; s; s = s->next)
    if (s->kind == STMT_EFFECT) {
      vec_push(b->arena, &effects, s->name);
      if (s->name == effect) e = s;
    }
  if (!e) {
    Name near = suggest(effect, effects.at, effects.n);
    if (near) diag_help(b->diags, "did you mean `%s.%s`?", near, name);
    else if (has_word("csv txt dat tsv npy", name))
      diag_help(b->diags, "the name of a file stands in quotes: `\"%s.%s\"`", effect, name);
    else if (strcmp(effect, "lambda") == 0)
      diag_help(b->diags, "the force of a constraint or contact is `lambda(%s)`", name);
    else if (!advise_momentum(b, effect)) diag_help(b->diags, "the model has no effect `%s`", effect);
    return;
  }
  VEC(Name) own = {0};
  StrBuf list = strbuf(b->arena);
  for (const AstStmt *x = e->body; x; x = x->next) {
    if (declares(x, name)) {
      diag_help(b->diags, "the effect is not in use here: `use %s`", effect);
      return;
    }
    if (x->name && declares(x, x->name)) {
      sb_printf(&list, "%s`%s`", own.n ? ", " : "", x->name);
      vec_push(b->arena, &own, x->name);
    }
  }
  Name near = suggest(name, own.at, own.n);
  if (near) diag_help(b->diags, "did you mean `%s.%s`?", effect, near);
  else if (own.n) diag_help(b->diags, "it declares %s", sb_text(&list));
  else diag_help(b->diags, "it declares nothing");
}

void warn_unit_is_constant(Builder *b, const AstUnit *u) {
  if (u->n != 1) return;
  const Entity *e = entity_named(b, u->at[0].name);
  if (!e || e->kind != ENT_CONST) return;
  diag_warning(b->diags, u->span, "`[%s]` is a unit here, not the constant `%s`", u->text, e->name);
  diag_help(b->diags, "an index touches its name: `x[%s]`", e->name);
}
