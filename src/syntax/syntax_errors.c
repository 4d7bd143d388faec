/* Syntax errors in the user's words.
 *
 * In: the unexpected token and the set of expected tokens. Out: one message, with a caret under the
 * unexpected token and, for a known mistake, advice. Names of tokens never appear: expected tokens
 * are grouped into words for a physicist, such as `an expression`. */
#include <string.h>

#include "base/words.h"
#include "syntax/parse_state.h"

/* ---- found and expected tokens ---- */

static const char *source_text(const Parse *cx, Span span, int *len) {
  const Source *source = cx->filter->scan->source;
  enum { SHOWN = 40 };
  uint32_t n = span.end - span.begin;
  const char *text = source->text + (span.begin - source->base);
  if (n > SHOWN) n = SHOWN;
  while (n && n < span.end - span.begin && ((unsigned char)text[n] & 0xC0) == 0x80) n--;
  *len = (int)n;
  return text;
}

static const char *describe(const Parse *cx, const Token *t) {
  TokKind kind = t->kind == TOK_END ? t->follows : t->kind;
  if (kind == TOK_NEWLINE || kind == TOK_FINISH) return token_word(kind);
  if (t->kind == TOK_END) return arena_printf(cx->ast->arena, "`%s`", token_word(kind));
  int len;
  const char *text = source_text(cx, t->span, &len);
  return arena_printf(cx->ast->arena, "`%.*s`", len, text);
}

/* Whether "an operator" covers k where `set` is expected; a comparison only where comparisons are. */
static int is_operator(const TokKind *set, int n, TokKind k) {
  if (k >= TOK_LT && k <= TOK_GE) return token_is_in(set, n, TOK_LT);
  return k >= TOK_PLUS && k <= TOK_OR;
}

/* Words for the expected tokens, each once: groups first, closing signs last. */
typedef struct {
  const char *word[8];
  int n;
} Words;

static void add_word(Words *w, const char *word) {
  if (w->n < 8) w->word[w->n++] = word;
}

static void add_groups(Words *w, const TokKind *set, int n) {
  int number = token_is_in(set, n, TOK_NUMBER), name = token_is_in(set, n, TOK_IDENT);
  int operators = token_is_in(set, n, TOK_TIMES);
  if (token_is_in(set, n, TOK_LAGRANGIAN)) add_word(w, "a statement");
  else if (number && name) add_word(w, "an expression");
  else if (name && !operators) add_word(w, "a name"); /* behind an operand it is a word of `hit(floor sticks)` alone */
  else if (number) add_word(w, "a number");
  if (operators) add_word(w, "an operator");
}

static int in_a_group(const TokKind *set, int n, TokKind k) {
  if (k == TOK_IDENT || k == TOK_NUMBER || (k >= TOK_MODEL && k <= TOK_STOP)) return 1;
  int operand = token_is_in(set, n, TOK_NUMBER) && token_is_in(set, n, TOK_IDENT);
  if (operand && ((token_flags(k) & T_START) || k == TOK_RANGE)) return 1; /* `max(x, ..20)`: not worth listing */
  int after_operand = token_is_in(set, n, TOK_TIMES) || token_is_in(set, n, TOK_PRIME);
  if (after_operand && (k == TOK_PRIME || k == TOK_INDEX || k == TOK_DOT || k == TOK_UNIT || k == TOK_LPAREN)) return 1;
  return token_is_in(set, n, TOK_TIMES) && is_operator(set, n, k);
}

static Words expected_words(const Parse *cx, const TokKind *set, int n) {
  Words w = {{0}, 0};
  add_groups(&w, set, n);
  for (int i = 0; i < n; i++) {
    TokKind k = set[i];
    if (in_a_group(set, n, k) || k == TOK_FINISH || k == TOK_END || k == TOK_COUNT) continue;
    /* an index, a type or a unit may follow most names: not worth listing */
    if (k == TOK_INDEX || ((k == TOK_UNIT || k == TOK_COLON) && token_is_in(set, n, TOK_UNIT) && n > 1)) continue;
    const char *word = token_word(k);
    int phrase = k == TOK_STRING || k == TOK_UNIT || k == TOK_SHAPE || k == TOK_CLAUSE;
    add_word(&w, phrase ? word : arena_printf(cx->ast->arena, "`%s`", word));
  }
  if (token_is_in(set, n, TOK_END)) add_word(&w, "the end of the statement");
  else if (!w.n) add_word(&w, "the end");
  return w;
}

static const char *join(const Parse *cx, const Words *w) {
  StrBuf b = strbuf(cx->ast->arena);
  for (int i = 0; i < w->n; i++)
    sb_printf(&b, "%s%s", i == 0 ? "" : i + 1 < w->n ? ", " : " or ", w->word[i]);
  return sb_text(&b);
}

/* " after `=`": names the token before; "" where the place is clear without it. */
static const char *after(const Parse *cx) {
  const Token *t = &cx->before;
  if (t->kind == TOK_END || t->kind == TOK_BEGIN_FILE || t->kind == TOK_BEGIN_EXPR || t->kind == TOK_LBRACE) return "";
  return arena_printf(cx->ast->arena, " after %s", describe(cx, t));
}

/* ---- words in wrong places ---- */

static const char *place_name(unsigned where) {
  switch (where & W_ANY) {
    case W_FILE: return "the file itself";
    case W_SCENE: return "a scene";
    case W_EVENT: return "an event";
    case W_EFFECT: return "an effect";
    case W_FOR: return "a `for`";
    default: return where & W_FOR ? "a model, an effect or a `for`" : "a model or an effect";
  }
}

static Name nearest_word(const Parse *cx, Name wrong, unsigned where) {
  Name words[TOK_STOP - TOK_MODEL + 1];
  size_t n = 0;
  for (int k = TOK_MODEL; k <= TOK_STOP; k++)
    if (token_flags((TokKind)k) & where & W_ANY) words[n++] = intern(cx->ast->names, token_word((TokKind)k));
  return suggest(wrong, words, n);
}

/* Reports a statement that begins with an unknown or misplaced word. */
static void report_word(Parse *cx, const Token *t) {
  Diags *d = cx->ast->diags;
  unsigned where = cx->filter->where[t->depth];
  TokKind elsewhere = token_statement(t->name, W_ANY);
  if (elsewhere != TOK_IDENT) {
    diag_error(d, t->span, "`%s` cannot stand in %s", t->name,
               where == W_FILE ? "the model itself" : place_name(where));
    if (where == W_SCENE && (elsewhere == TOK_PARAM || elsewhere == TOK_CONST))
      diag_help(d, "it belongs in a model or an effect; in a scene a parameter gets another value by `NAME = …`");
    else diag_help(d, "it belongs in %s%s", place_name(token_flags(elsewhere)),
                   where != W_FILE && (token_flags(elsewhere) & W_FILE) ? "; is a `}` missing above?"
                   : (token_flags(elsewhere) & W_ANY) == W_SCENE ? ": `scene s { start x = 1; span 20 [s] }`" : "");
    return;
  }
  diag_error(d, t->span, "unknown statement `%s`", t->name);
  const char *way = advice_for_word(t->name, where);
  Name near = way ? NULL : nearest_word(cx, t->name, where);
  if (way) diag_help(d, "%s", way);
  else if (near) diag_help(d, "did you mean `%s`?", near);
  else if (where & (W_SCENE | W_EVENT))
    diag_help(d, t->follows == TOK_LPAREN ? "a start is set by `start %s = …`" : "a value is set with `%s = …`",
              t->name);
  else if (t->follows != TOK_ASSIGN && ((token_flags(t->follows) & T_BINARY) || t->follows == TOK_PRIME))
    diag_help(d, "equations of motion follow from the Lagrangian; `expect m*x'' = …` checks one of yours, `force x = "
                 "…` adds a force");
  else if (t->follows == TOK_STRING || t->follows == TOK_BAD)
    diag_help(d,
              "a second derivative has two primes, `%s''`; equations of motion follow from the Lagrangian, and "
              "`expect %s'' = …` checks one of yours",
              t->name, t->name);
  else if (t->follows == TOK_ASSIGN)
    diag_help(d, "a name is given a meaning with `let %s = …` or `param %s = …`", t->name, t->name);
  else diag_help(d, "`lagc help language` shows a model, `lagc help` lists the statements");
}

/* Reports a bracket that is still open at the end of a statement. */
static int report_open_bracket(Parse *cx, const TokKind *set, int n) {
  const OpenBracket *open = &cx->open;
  const Token *t = &cx->current;
  if (t->kind != TOK_END || !open->span.end || !(token_flags(cx->before.kind) & T_OPERAND)) return 0;
  TokKind close = open->kind == TOK_LPAREN ? TOK_RPAREN : open->kind == TOK_INDEX ? TOK_RBRACKET : TOK_RBRACE;
  if (!token_is_in(set, n, close)) return 0;
  diag_error(cx->ast->diags, t->span, "expected `%s`, found %s", token_word(close), describe(cx, t));
  diag_also(cx->ast->diags, open->span, "this `%s` is still open", token_word(open->kind));
  return 1;
}

void parse_report(Parse *cx, const TokKind *expected, int n) {
  const Token *t = &cx->current;
  Diags *d = cx->ast->diags;
  cx->reported = 1;
  if (t->kind == TOK_BAD) {
    diag_error(d, t->span, "%s", t->text);
    if (t->help) diag_help(d, "%s", t->help);
    return;
  }
  if (t->kind == TOK_BADWORD) {
    report_word(cx, t);
    return;
  }
  if (report_open_bracket(cx, expected, n)) return;
  Words w = expected_words(cx, expected, n);
  const char *help = advice_for_token(cx, expected, n);
  const char *found = describe(cx, t), *list = join(cx, &w), *where = after(cx);
  diag_error(d, t->span, "expected %s%s, found %s", list, where, found);
  if (help) diag_help(d, "%s", help);
}

void parse_too_deep(Parse *cx, Span span) {
  cx->reported = 1;
  diag_error(cx->ast->diags, span, "this is nested too deep (the limit is %d levels)", PARSE_STACK);
  diag_help(cx->ast->diags, "split the expression with `let`");
}
