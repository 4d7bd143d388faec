/* Networks: a statement and its file of weights become the text of parameters and of one function, so that all later
 * stages see sums over families, which they differentiate and emit as loops.
 *
 * In: a STMT_NETWORK. Out: a text in the language. Must hold: every weight is a finite number and stands once; a file
 * of another kind is not quoted in messages. */
#include "syntax/network.h"

#include "base/num.h"
#include "base/words.h"
#include "syntax/ast_build.h"

#include <ctype.h>
#include <math.h>

/* A width above WIDEST or TERMS turns of nested sums would be refused later, in words about sums. */
enum { WIDEST = 1000, TERMS = 1000000, LAYERS = 8, EACH = 2 * (LAYERS + 1) };

typedef struct Network {
  Ast *ast;
  const AstStmt *s;
  uint32_t width[LAYERS + 2]; /* of the arguments, the layers, the value */
  uint32_t n;                 /* layers of weights: hidden ones and the last */
} Network;

/* Weights between two layers, w1 [rows, columns], or their biases, b1 [rows]; of the last layer w3 [columns] and b3. */
typedef struct Weights {
  const char *key;
  uint32_t rows, columns; /* 0: a number less */
} Weights;

static Weights weights_of(const Network *net, uint32_t i) {
  uint32_t layer = i / 2, last = layer + 1 == net->n;
  const char *key = arena_printf(net->ast->arena, "%c%u", i % 2 ? 'b' : 'w', layer + 1);
  return (Weights){key, last ? 0 : net->width[layer + 1], i % 2 ? 0 : net->width[layer]};
}

/* ---- the statement ---- */

/* Widths of the layers; 0 after a message. */
static int read_layers(Network *net) {
  const AstStmt *s = net->s;
  double terms = 1;
  net->width[0] = ast_list_length(net->ast, s->args);
  for (AstId id = s->dims; id; id = ast_expr(net->ast, id)->next) {
    const AstExpr *x = ast_expr(net->ast, id);
    double width = x->kind == AST_NUM ? num_value(x->number) : 0;
    if (!(width >= 1 && width <= WIDEST && width == floor(width)))
      return diag_error(net->ast->diags, x->span, "the width of a layer is a whole number from 1 to %d" HELP
                        "write the widths of the hidden layers: `layers 16, 16`", WIDEST);
    if (net->n == LAYERS)
      return diag_error(net->ast->diags, x->span, "a network has at most %d hidden layers" HELP
                        "one or two wide layers fit smooth functions of a few arguments", LAYERS);
    net->width[++net->n] = (uint32_t)width;
    terms *= width;
  }
  net->width[++net->n] = 1;
  if (terms * net->width[0] <= TERMS) return 1;
  return diag_error(net->ast->diags, s->span, "a call of this network takes %.0f terms, the product of its widths, and "
                    "may take %d" HELP "write fewer or narrower layers", terms * net->width[0], TERMS);
}

AstStmt *stmt_network(Ast *ast, Span span, Ident name, AstList args, AstText path, AstList layers, Ident activation) {
  AstStmt *s = stmt_function(ast, span, name, args, path.text ? ast_string(ast, path) : 0);
  s->kind = STMT_NETWORK;
  s->dims = layers.first;
  s->type = activation.name ? activation.name : "tanh";
  if (strcmp(s->type, "tanh") != 0 && strcmp(s->type, "softplus") != 0)
    diag_error(ast->diags, activation.span, "unknown activation `%s`" HELP
               "write `tanh`, the default, or `softplus`: both are smooth", s->type);
  return s;
}

/* ---- first weights ---- */

/* Uniform numbers in -1..1, the same on every machine (G. Marsaglia, J. Stat. Softw. 8 (2003) 14: xorshift). */
static double next_random(uint32_t *state) {
  *state ^= *state << 13, *state ^= *state >> 17, *state ^= *state << 5;
  return *state / 2147483648.0 - 1;
}

/* Weights with variance 1/columns, so that a layer keeps the size of its values; biases spread the kinks of units. */
static void begin_weights(const Weights *w, uint32_t *state, StrBuf *out) {
  double size = w->columns ? sqrt(3.0 / w->columns) : w->rows ? 1 : 0;
  uint32_t rows = w->rows ? w->rows : 1, columns = w->columns ? w->columns : 1;
  if (w->rows) sb_putc(out, '{');
  for (uint32_t i = 0; i < rows; i++) {
    sb_puts(out, i ? ", " : "");
    if (w->columns) sb_putc(out, '{');
    for (uint32_t j = 0; j < columns; j++) sb_printf(out, "%s%.6f", j ? ", " : "", size * next_random(state));
    if (w->columns) sb_putc(out, '}');
  }
  if (w->rows) sb_putc(out, '}');
}

/* ---- the file of weights ---- */

typedef struct Reader {
  const Network *net;
  const Source *file;
  uint32_t at;
} Reader;

static const char *here(Reader *r) {
  while (r->at < r->file->len && strchr(" \t\r\n", r->file->text[r->at])) r->at++;
  return r->file->text + r->at;
}

/* Reports a mistake at n bytes from here; 0. */
static int mistake(Reader *r, uint32_t n, const char *what) {
  uint32_t at = r->file->base + r->at;
  diag_error(r->net->ast->diags, (Span){at, at + n}, "%s", what);
  diag_also(r->net->ast->diags, r->net->s->span, "read for this network");
  return 0;
}

static int take(Reader *r, char c) {
  if (*here(r) != c) return 0;
  r->at++;
  return 1;
}

/* Appends the number here to out. */
static int read_number(Reader *r, StrBuf *out) {
  const char *s = here(r);
  uint32_t n = 0;
  while (r->at + n < r->file->len && (isalnum((unsigned char)s[n]) || strchr("+-.", s[n])) && s[n]) n++;
  const char *word = arena_strndup(r->net->ast->arena, s, n);
  double x;
  if (!n) return mistake(r, 1, "expected a number");
  if (!num_parse_double(word, &x) || !isfinite(x))
    return mistake(r, n, arena_printf(r->net->ast->arena, "a weight must be a finite number, not `%.40s`" HELP
                                      "train the network again: `lagc fit ... --fit %s` writes the file", word,
                                      r->net->s->name));
  sb_puts(out, word);
  r->at += n;
  return 1;
}

/* Appends a list of n numbers, or of n lists of `columns` numbers each, in the language's braces. */
static int read_list(Reader *r, const char *key, uint32_t n, uint32_t columns, StrBuf *out) {
  Arena *a = r->net->ast->arena;
  uint32_t begin = r->at, i = 0;
  if (!take(r, '['))
    return mistake(r, 1, arena_printf(a, "expected `[`: \"%s\" has a list of %u members here", key, n));
  sb_putc(out, '{');
  for (int more = *here(r) != ']'; more; more = take(r, ','), i++) {
    sb_puts(out, i ? ", " : "");
    if (!(columns && i < n ? read_list(r, key, columns, 0, out) : read_number(r, out))) return 0;
  }
  sb_putc(out, '}');
  if (!take(r, ']')) return mistake(r, 1, "expected `,` or `]`");
  if (i == n) return 1;
  r->at = begin;
  here(r);
  return mistake(r, 1, arena_printf(a, "this list of \"%s\" has %u members, and the layers of the network ask for %u"
                                    HELP "write the widths with which the file was made", key, i, n));
}

/* "w1": [[...], ...] to value[i]. */
static int read_member(Reader *r, StrBuf *value) {
  const Network *net = r->net;
  const char *s = here(r);
  const char *end = *s == '"' ? memchr(s + 1, '"', r->file->len - r->at - 1) : NULL;
  if (!end) return mistake(r, 1, "expected a name such as \"w1\"");
  uint32_t n = (uint32_t)(end - s) + 1, i = 0;
  const char *key = arena_strndup(net->ast->arena, s + 1, n - 2);
  while (i < 2 * net->n && strcmp(weights_of(net, i).key, key) != 0) i++;
  if (i == 2 * net->n || value[i].n)
    return mistake(r, n, arena_printf(net->ast->arena, i < 2 * net->n ? "\"%.40s\" stands twice" :
                                      "\"%.40s\" is no weight of a network with %u hidden layer%s", key, net->n - 1,
                                      plural(net->n - 1)));
  r->at += n;
  if (!take(r, ':')) return mistake(r, 1, "expected `:`");
  Weights w = weights_of(net, i);
  here(r);
  if (w.rows) return read_list(r, key, w.rows, w.columns, &value[i]);
  return w.columns ? read_list(r, key, w.columns, 0, &value[i]) : read_number(r, &value[i]);
}

/* value[]: the weights in the file of the statement; 0 after a message. */
static int read_weights(const Network *net, const char *from, StrBuf *value) {
  Diags *d = net->ast->diags;
  const AstExpr *name = ast_expr(net->ast, net->s->rhs);
  const char *path = source_locate(net->ast->sources, from, name->name), *error;
  Reader r = {.net = net, .file = source_read(net->ast->sources, path, &error)};
  if (!r.file)
    return diag_error(d, name->span, "cannot read `%s`: %s" HELP "leave `from \"%s\"` out: weights then begin at "
                      "random values, and `lagc fit ... --fit %s -o %s` writes the file", path, error, name->name,
                      net->s->name, name->name);
  if (!take(&r, '{'))
    return diag_error(d, name->span, "`%s` is not a file of weights" HELP
                      "it begins `{\"w1\": [[...], ...], \"b1\": [...], ...`, as `lagc fit ... --fit %s` writes it",
                      path, net->s->name);
  for (int more = *here(&r) != '}'; more; more = take(&r, ','))
    if (!read_member(&r, value)) return 0;
  if (!take(&r, '}')) return mistake(&r, 1, "expected `,` or `}`");
  if (*here(&r)) return mistake(&r, 1, "the weights end with the `}` before this");
  for (uint32_t i = 0; i < 2 * net->n; i++)
    if (!value[i].n)
      return diag_error(d, name->span, "`%s` lacks \"%s\"", path, weights_of(net, i).key);
  return 1;
}

/* ---- the text ---- */

static void put_parameters(const Network *net, const StrBuf *value, StrBuf *out) {
  for (uint32_t i = 0; i < 2 * net->n; i++) {
    Weights w = weights_of(net, i);
    sb_printf(out, "param %s_%s", net->s->name, w.key);
    if (w.rows && w.columns) sb_printf(out, "[%u,%u]", w.rows, w.columns);
    else if (w.rows + w.columns) sb_printf(out, "[%u]", w.rows + w.columns);
    sb_printf(out, " [1] = %s\n", sb_text(&value[i]));
  }
}

/* The function: sums over units i2, i1 of layers 2, 1 within each other. */
static void put_function(const Network *net, StrBuf *out) {
  const char *V = net->s->name, *unit = net->s->type;
  if (strcmp(unit, "softplus") == 0) unit = arena_printf(net->ast->arena, "%s_unit", V);
  if (unit != net->s->type) sb_printf(out, "function %s(%s_x) = %s_x/2 + log(2*cosh(%s_x/2))\n", unit, V, V, V);
  sb_printf(out, "function %s(", V);
  for (AstId id = net->s->args; id; id = ast_expr(net->ast, id)->next)
    sb_printf(out, "%s%s", id == net->s->args ? "" : ", ", ast_expr(net->ast, id)->name);
  sb_printf(out, ") = %s_b%u", V, net->n);
  for (uint32_t k = net->n - 1; k > 0; k--) {
    sb_printf(out, " + sum(%s_i%u in 1..%u, %s_w%u[", V, k, net->width[k], V, k + 1);
    if (k + 1 < net->n) sb_printf(out, "%s_i%u, ", V, k + 1);
    sb_printf(out, "%s_i%u]*%s(%s_b%u[%s_i%u]", V, k, unit, V, k, V, k);
  }
  uint32_t j = 1;
  for (AstId id = net->s->args; id; id = ast_expr(net->ast, id)->next, j++)
    sb_printf(out, " + %s_w1[%s_i1,%u]*%s", V, V, j, ast_expr(net->ast, id)->name);
  for (uint32_t k = 1; k < net->n; k++) sb_puts(out, "))");
  sb_putc(out, '\n');
}

const char *network_text(Ast *ast, const AstStmt *s, const char *from) {
  Network net = {.ast = ast, .s = s};
  StrBuf value[EACH], out = strbuf(ast->arena);
  uint32_t state = 2463534242u;
  if (!read_layers(&net)) return NULL;
  for (uint32_t i = 0; i < 2 * net.n; i++) value[i] = strbuf(ast->arena);
  if (s->rhs && !read_weights(&net, from, value)) return NULL;
  for (uint32_t i = 0; i < 2 * net.n && !s->rhs; i++) {
    Weights w = weights_of(&net, i);
    if (w.rows || w.columns) {
      Weights as = {w.key, w.rows ? w.rows : w.columns, w.rows ? w.columns : 0};
      begin_weights(&as, &state, &value[i]);
    } else sb_puts(&value[i], "0");
  }
  put_parameters(&net, value, &out);
  put_function(&net, &out);
  return sb_text(&out);
}
