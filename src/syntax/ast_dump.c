/* Ast -> a listing, one node a line, children indented by two columns, for people and golden tests.
 * It shows everything that later passes can see, except spans.
 *
 * Must hold: no recursion on expressions; past DUMP_DEEP levels the indentation stops and the level is printed. */
#include "syntax/parse.h"

enum { DUMP_DEEP = 24 };

typedef struct {
  AstId id;
  uint32_t level;
  const char *role; /* relation to the parent, or "" */
} Pending;

typedef struct {
  const Ast *ast;
  StrBuf *out;
  VEC(Pending) stack;
} Dump;

#define KIND_NAME_(kind, text) #kind,
static const char *const kind_names[] = {AST_EXPR_KINDS(KIND_NAME_)};
#undef KIND_NAME_
#define KIND_TEXT_(kind, text) text,
static const char *const kind_texts[] = {AST_EXPR_KINDS(KIND_TEXT_)};
#undef KIND_TEXT_

static const char *const stmt_names[] = {
    "model",     "include",     "coord",      "momentum", "param",     "const",       "input",   "state", "let",
    "function",  "network",
    "hamiltonian", "lagrangian", "kinetic",  "potential", "dissipation", "force",   "flow",  "constraint",
    "symmetry",  "canonical",   "map",        "expect",   "event",     "contact",     "guide",   "observe", "draw",
    "for",       "effect",      "requires",   "excludes", "scene",     "start",       "exact",   "set",     "use",
    "span",      "method",      "tolerance",  "output",   "monitor",   "measure",     "like",    "stop"};
_Static_assert(sizeof stmt_names / sizeof *stmt_names == STMT_STOP + 1, "a name for each statement");

static void indent(Dump *d, uint32_t level) {
  uint32_t shown = level < DUMP_DEEP ? level : DUMP_DEEP;
  sb_printf(d->out, "%*s", (int)(2 * shown), "");
  if (level > DUMP_DEEP) sb_printf(d->out, "%u: ", level);
}

static void dump_unit(Dump *d, const AstUnit *u) {
  sb_puts(d->out, " [");
  for (uint32_t i = 0; i < u->n; i++) {
    sb_printf(d->out, "%s%s", i ? " " : "", u->at[i].name);
    if (num_is_one(u->at[i].exponent)) continue;
    sb_putc(d->out, '^');
    num_print(d->out, u->at[i].exponent);
  }
  sb_putc(d->out, ']');
}

/* "AST_NUM" -> "num" */
static void dump_kind(Dump *d, AstKind kind) {
  if (kind_texts[kind]) {
    sb_puts(d->out, kind == AST_NEG ? "negative" : kind_texts[kind]);
    return;
  }
  for (const char *c = kind_names[kind] + 4; *c; c++)
    sb_putc(d->out, (char)(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c));
}

static void dump_node(Dump *d, const Pending *p) {
  const AstExpr *e = ast_expr(d->ast, p->id);
  indent(d, p->level);
  sb_puts(d->out, p->role);
  dump_kind(d, e->kind);
  if (e->kind == AST_STRING) sb_printf(d->out, " \"%s\"", e->name);
  else if (e->name) sb_printf(d->out, " %s", e->name);
  if (e->kind == AST_NUM) {
    sb_putc(d->out, ' ');
    num_print(d->out, e->number);
  }
  if (e->kind == AST_UNIT) dump_unit(d, &e->unit);
  sb_putc(d->out, '\n');
}

static void push(Dump *d, AstId id, uint32_t level, const char *role) {
  Pending p = {id, level, role};
  if (id) vec_push(d->ast->arena, &d->stack, p);
}

/* A list goes on the stack in reverse, so that it comes off in order. */
static void push_list(Dump *d, AstId first, uint32_t level, const char *role) {
  uint32_t from = d->stack.n;
  for (AstId id = first; id; id = ast_expr(d->ast, id)->next) push(d, id, level, role);
  for (uint32_t i = from, k = d->stack.n; i + 1 < k; i++, k--) {
    Pending p = d->stack.at[i];
    d->stack.at[i] = d->stack.at[k - 1];
    d->stack.at[k - 1] = p;
  }
}

static void drain(Dump *d) {
  while (d->stack.n) {
    Pending p = d->stack.at[--d->stack.n];
    const AstExpr *e = ast_expr(d->ast, p.id);
    dump_node(d, &p);
    push_list(d, e->args, p.level + 1, "");
    push(d, e->c, p.level + 1, "");
    push(d, e->b, p.level + 1, "");
    push(d, e->a, p.level + 1, "");
  }
}

static void dump_head(Dump *d, const AstStmt *s) {
  static const char *const signs[] = {"", " > 0", " >= 0", " < 0", " <= 0"};
  static const char *const ways[] = {" crossing", " rising", " falling", " every"};
  sb_puts(d->out, stmt_names[s->kind]);
  if (s->name) sb_printf(d->out, " %s", s->name);
  if (s->doc) sb_printf(d->out, " \"%s\"", s->doc);
  if (s->type) sb_printf(d->out, ": %s", s->type);
  if (s->unit.n) dump_unit(d, &s->unit);
  sb_puts(d->out, signs[s->sign]);
  if (s->kind == STMT_EVENT) sb_puts(d->out, ways[s->direction]);
  if (s->periodic) sb_puts(d->out, " periodic");
  if (s->exactly) sb_puts(d->out, s->exactly == START_GUESS ? " guess" : " exactly");
  sb_putc(d->out, '\n');
}

/* Recursion is bounded by the parser's limit on nested blocks. */
static void dump_all(Dump *d, const AstStmt *first, uint32_t level) {
  for (const AstStmt *s = first; s; s = s->next) {
    indent(d, level);
    dump_head(d, s);
    push(d, s->rhs, level + 1, "= ");
    push(d, s->lhs, level + 1, "");
    push_list(d, s->args, level + 1, "arg ");
    push_list(d, s->dims, level + 1, "of ");
    drain(d);
    dump_all(d, s->body, level + 1);
  }
}

void ast_dump(const Ast *ast, StrBuf *out) {
  Dump d = {.ast = ast, .out = out};
  dump_all(&d, ast->first, 0);
}
