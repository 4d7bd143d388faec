/* Fuzzing the back half: each byte of the input is a choice in a grammar of models, so that all of them parse:
 * Taylor coefficients, families, starts and symmetries are reached by every other input. The model goes every way
 * that a command goes: checked, its symmetries found, its start brought to its constraints, emitted with all that
 * methods can want, and as a header. Nothing may crash, leak, upset a sanitizer, take more than its memory limit, or
 * make a program that prog_verify refuses; a model that is not built says why. With -DSHOW the program prints the
 * model of the file that it is given. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/commands.h"
#include "emit/cnames.h"
#include "emit/cwriter.h"
#include "emit/emit_model.h"
#include "ir/program_set.h"
#include "lower/lower.h"
#include "symmetry/charges.h"
#include "report/equation_listing.h"
#include "mech/consistent_start.h"
#include "model/model.h"
#include "syntax/parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_MEMORY = 256 * 1024 * 1024, MOST_COORDS = 3, DEEPEST = 3, LARGE = 32 };

/* ---- a model from choices ---- */

typedef struct {
  const uint8_t *at, *end;
  StrBuf out;
  /* coordinates beside the family; its length, or 0; whether there is a state; a vector */
  unsigned n, family, state, vector;
} Choices;

/* 0 where nothing is left to choose. */
static unsigned choose(Choices *c, unsigned n) { return c->at < c->end ? *c->at++ % n : 0; }
static void put(Choices *c, const char *text) { sb_puts(&c->out, text); }

static const char *const coords[] = {"x", "y", "th"};

static void put_atom(Choices *c, const char *member) {
  unsigned k = choose(c, 12);
  if (k < 4 && c->n) put(c, coords[k % c->n]);
  else if (k < 7 && member) sb_printf(&c->out, "u[%s]", member);
  else if (k == 7 && c->vector) put(c, choose(c, 2) ? "r.x" : "norm(r)");
  else if (k == 8 && c->state) put(c, "s");
  else if (k == 9) put(c, "t");
  else put(c, (const char *const[]){"k", "l", "2", "0.5", "1e-3", "pi"}[choose(c, 6)]);
}

static void put_expr(Choices *c, const char *member, unsigned depth) {
  static const char *const functions[] = {"sin", "cos",  "exp",  "log",  "sqrt", "tanh",
                                          "abs", "atan", "cosh", "asin", "sign", "sinh"};
  static const char *const two[] = {"atan2", "hypot", "min", "max"};
  unsigned k = depth ? choose(c, 10) : 0;
  if (k < 2) {
    put_atom(c, member);
    return;
  }
  if (k == 6) sb_printf(&c->out, "%s", functions[choose(c, sizeof functions / sizeof *functions)]);
  if (k == 7) sb_printf(&c->out, "%s", two[choose(c, 4)]);
  put(c, k == 9 ? "if(" : "(");
  put_expr(c, member, depth - 1);
  if (k == 9) put(c, " > 0, ");
  if (k == 8) sb_printf(&c->out, ")^%s", (const char *const[]){"2", "3", "(-1)", "(1/2)", "(-3/2)"}[choose(c, 5)]);
  else if (k != 6) {
    put(c, k == 7 ? ", " : k == 9 ? "" : (const char *const[]){" + ", " - ", "*", "/"}[k % 4]);
    put_expr(c, member, depth - 1);
    if (k == 9) put(c, ", ");
    if (k == 9) put_expr(c, member, depth - 1);
  }
  if (k != 8) put(c, ")");
}

static void statement(Choices *c, const char *head, unsigned depth) {
  put(c, head);
  put_expr(c, NULL, depth);
  put(c, "\n");
}

static void put_lagrangian(Choices *c) {
  static const char *const pairs[] = {"", "j in 1..i-1", "j in 1..N"};
  put(c, "lagrangian = ");
  for (unsigned i = 0; i < c->n; i++) {
    static const char *const inertia[] = {"k/2*%s'^2 + ", "%s'^2/2 + ",         "k*l^2*%s'^2 + ",
                                          "-%s'^2 + ",    "(1 + x^2)*%s'^2 + ", "%s'*x' + "};
    sb_printf(&c->out, inertia[choose(c, sizeof inertia / sizeof *inertia)], coords[i]);
  }
  if (c->vector) put(c, "k/2*dot(r', r') + ");
  if (c->family) {
    put(c, choose(c, 4) || c->family >= LARGE ? "sum(i in 1..N, m[i]/2*u[i]'^2) - sum(i in 1..N, "
                                              : "sum(i in 1..N, sum(j in 1..i, u[j]')^2/2) - sum(i in 1..N, ");
    const char *pair = pairs[choose(c, 3)];
    if (*pair) sb_printf(&c->out, "sum(%s, %s*", pair, choose(c, 2) ? "m[j]" : "(u[i] - u[j])^2");
    put_expr(c, *pair && choose(c, 2) ? "j" : "i", 2);
    put(c, *pair ? ")) + " : ") + ");
  }
  put(c, "(");
  put_expr(c, NULL, DEEPEST);
  put(c, ")\n");
}

/* Statements behind L; each name is declared once. */
static void put_rest(Choices *c) {
  static const char *const with_coords[] = {"force x = ",
                                            "expect x'' = ", "constraint skate: x'*sin(y) - y'*cos(y) = 0*",
                                            "constraint circle: x^2 + y^2 = l^2 + 0*",
                                            "contact floor: x >= -1, restitution = ",
                                            "event hit: x falling { x' = -k*x' }\nobserve o1 = ",
                                            "symmetry shift(e): x -> x + e*"};
  static const char *const any[] = {"dissipation = k*",
                                    "observe o2 = ", "constraint rod: l = ", "expect energy = ", "let w1 = "};
  unsigned done = 0;
  for (unsigned more = choose(c, 6); more--;) {
    unsigned k = choose(c, 13);
    if (done & 1u << k) continue;
    done |= 1u << k;
    if (k < 7 && c->n > (k == 2 || k == 3)) statement(c, with_coords[k], k == 0 ? 2 : 1);
    else if (k >= 7 && k < 12) statement(c, any[k - 7], 2);
    else if (k == 12)
      put(c, "effect air {\n  "), statement(c, c->n ? "force x = -k*x' + " : "dissipation = ", 1), put(c, "}\n");
  }
}

static const char *model_text(Arena *a, const uint8_t *data, size_t size) {
  Choices c = {.at = data, .end = data + size, .out = strbuf(a)};
  unsigned kinds = choose(&c, 16);
  c.n = choose(&c, MOST_COORDS + 1);
  c.state = (kinds & 6) == 6;
  c.vector = (kinds & 8) == 8;
  if (kinds & 1) c.family = choose(&c, 15) ? 2 + choose(&c, 9) : LARGE + choose(&c, 9); /* LARGE takes seconds */
  if (c.family >= LARGE) c.n = c.vector = 0; /* with a diagonal M, where pairs become loops */
  if (!c.n && !c.family && !c.vector) c.n = 1;
  put(&c, "model fuzzed\nparam k = 1.5 > 0, l = 0.7\n");
  for (unsigned i = 0; i < c.n; i++) sb_printf(&c.out, "coord %s%s\n", coords[i], choose(&c, 4) ? "" : " periodic");
  if (c.vector) put(&c, "coord r: vec2\n");
  if (c.family) sb_printf(&c.out, "const N = %u\ncoord u[N]\nparam m[N] = 1 > 0\n", c.family);
  if (c.state) statement(&c, "state s\nflow s' = -s + ", 2);
  put_lagrangian(&c);
  put_rest(&c);
  put(&c, "scene first {\n");
  for (unsigned i = 0; i < c.n; i++) sb_printf(&c.out, "  start %s = 0.%u\n", coords[i], choose(&c, 100));
  if (c.vector) put(&c, "  start r = (1, 0.5), r' = (0, 1)\n");
  if (c.family) put(&c, "  start u[i in 1..N] = i/3\n");
  put(&c, "  span 1\n}\n");
  return sb_text(&c.out);
}

/* ---- the ways of the commands ---- */

static Eqns *derive(Ast *ast, const ModelChoice *choice) {
  Model *m = model_build(ast, choice);
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e && !ast->diags->errors) abort();
  return e;
}

static void verify_all(const ProgramSet *u) {
  if (program_set_verify(u)) abort();
}

static void emit(Ast *ast, Eqns *e) {
  static const char *const everything = "all,gsl,cvode,arkode,ida,casadi";
  Arena *a = ast->arena;
  StrBuf text = strbuf(a), c = strbuf(a), header = strbuf(a);
  long double *found = ARENA_ARRAY(a, long double, 2 * (size_t)e->n + 1);
  unsigned char *moved = ARENA_ARRAY(a, unsigned char, 2 * (size_t)e->n + 1);
  start_of_scene(e, found, moved);
  ProgramSet *u = unit_new(e, "fuzz.lag", 0);
  unit_require(u, e, (e->singular_mass ? 0 : WANT_VARIATION) | WANT_TAYLOR | header_wants(everything));
  unit_add_scene(u, e);
  verify_all(u);
  show_equations(e, op_count_text(u->accel, a), PRINT_TEXT, &text);
  HeaderParts parts = {0};
  const char *error;
  if (header_parts(u, everything, &parts, &error)) emit_header(u, u->name, parts, sb_text(&text), &header);
  emit_header(u, u->name, (HeaderParts){0}, sb_text(&text), &header);
  unit_hoist(u);
  verify_all(u);
  emit_model(u, model_id(a, u->name), MODEL_PLAIN, &c);
}

/* Coordinates beyond which a search for symmetries takes seconds under sanitizers: seeds are searched, for which the
 * driver sets FUZZ_REPLAY, and mutants are not. */
enum { SEARCHED = 4 };

static void run(Arena *a, const char *text) {
  uint32_t n = 0;
  for (int way = 0; way < 3; way++) { /* as commands do, each from the text */
    Sources *sources = sources_new(a);
    Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
    StrBuf out = strbuf(a);
    if (!parse(ast, source_add(sources, "fuzz.lag", text, strlen(text)))) abort();
    Eqns *e = way == 0 ? derive(ast, &(ModelChoice){0}) : NULL;
    if (e) emit(ast, e), n = e->n;
    if (way == 2 && n > SEARCHED && !getenv("FUZZ_REPLAY")) continue;
    Compiler c = {.arena = a, .o.file = "fuzz.lag", .sources = sources, .diags = ast->diags, .ast = ast};
    if (way == 1) check_print(&c, NULL, 0, &out);
    if (way == 2) noether_print(&c, NULL, 10, NULL, &out);
    diags_print(ast->diags, &out);
    if (e && e->n >= LARGE) break; /* the others take seconds */
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  ArenaConfig config = {.chunk = 4096, .max_bytes = FUZZ_MEMORY};
  Arena *a = arena_new(&config);
  jmp_buf failed;
  if (!a) return 0;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    const char *text = model_text(a, data, size);
#ifdef SHOW
    fputs(text, stderr);
#endif
    run(a, text);
  }
  arena_free(a);
  return 0;
}
