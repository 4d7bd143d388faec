/* text -> Ast: drives scanner, filter and parser, and follows includes.
 *
 * In: a source. Out: its statements in the Ast, messages in ast->diags.
 * Must hold: the parser's stack, the only memory outside the arena, is freed on every exit. */
#include "base/visible.h"
#include "numeric/functions.def"
#include "syntax/network.h"
#include "syntax/parse.h"
#include "syntax/parse_state.h"

void parse_done_file(Parse *cx, StmtList stmts) { cx->stmts = stmts; }
void parse_done_value(Parse *cx, AstId value) { cx->value = value; }

/* Pushes tokens until the parser accepts or gives up. After a mistake the parser discards tokens up
 * to the END; blocks inside the rest of the statement are skipped here. */
static void push_tokens(Parse *cx, TokKind begin) {
  Token t = {.kind = begin};
  int skipping = 0;
  uint32_t depth = 0;
  do {
    cx->before = cx->current;
    cx->current = t;
    cx->reported = 0;
    if (!parse_push(cx, &t)) return;
    if (cx->reported) skipping = 1, depth = t.depth;
    if (t.kind == TOK_END) skipping = 0;
    do {
      const OpenBracket *open = filter_open_bracket(cx->filter);
      cx->open = open ? *open : (OpenBracket){0};
      t = filter_next(cx->filter);
    } while (skipping && t.depth > depth);
  } while (1);
}

/* Reports the first invisible or direction-changing character, in comments and texts too: what a reader sees must be
 * what is compiled (N. Boucher, R. Anderson, "Trojan Source", arXiv:2111.00169). */
static void report_hidden(Ast *ast, const Source *source) {
  unsigned long code;
  for (size_t at = 0, len; at < source->len; at += len) {
    const char *s = source->text + at;
    len = utf8_at(s, source->len - at, &code);
    if (!is_hidden(code) || *s == '\t' || *s == '\n' || (*s == '\r' && (at + 1 == source->len || s[1] == '\n')))
      continue;
    uint32_t begin = source->base + (uint32_t)at;
    diag_error(ast->diags, (Span){begin, begin + (uint32_t)len},
               "a character that does not show, U+%04X, stands here; remove it", (unsigned)code);
    return;
  }
}

/* Parses one text. When memory runs out, the stack is freed and the failure passed to the previous guard of the
 * arena. */
static void run(Parse *cx, Ast *ast, const Source *source, TokKind begin) {
  *cx = (Parse){.ast = ast};
  jmp_buf here;
  jmp_buf *outer = arena_guard(ast->arena, &here);
  if (setjmp(here)) {
    if (cx->stack) parse_close(cx);
    arena_guard(ast->arena, outer);
    arena_fail(ast->arena);
  }
  Scan *scan = scan_new(ast->arena, ast->names, source);
  cx->filter = filter_new(scan, begin == TOK_BEGIN_EXPR);
  parse_open(cx);
  uint32_t errors = ast->diags->errors;
  push_tokens(cx, begin);
  if (ast->diags->errors == errors) report_hidden(ast, source);
  parse_close(cx);
  arena_guard(ast->arena, outer);
}

/* ---- include ---- */

/* A parsed file and the statement that included it (NULL: the user's file). */
typedef struct {
  const char *path;
  uint32_t base, end;
  AstStmt *asked_by;
} File;

typedef struct {
  Ast *ast;
  VEC(File) files;
} Includes;

static uint32_t file_of(const Includes *in, uint32_t offset) {
  uint32_t i = 0;
  while (i + 1 < in->files.n && (offset < in->files.at[i].base || offset > in->files.at[i].end)) i++;
  return i;
}

static void add_file(Includes *in, const Source *source, const char *path, AstStmt *asked_by) {
  File f = {.path = path, .base = source->base, .end = source->base + source->len, .asked_by = asked_by};
  vec_push(in->ast->arena, &in->files, f);
}

/* Reports a cycle, `a.lag` includes `b.lag` includes `a.lag`, walking back from the file that closes it. */
static void report_cycle(const Includes *in, const AstStmt *s, uint32_t from, uint32_t to) {
  StrBuf chain = strbuf(in->ast->arena);
  sb_printf(&chain, "`%s`", in->files.at[to].path);
  for (uint32_t i = from; i != to; i = file_of(in, in->files.at[i].asked_by->span.begin))
    sb_printf(&chain, ", which `%s` includes", in->files.at[i].path);
  sb_printf(&chain, ", which `%s` includes", in->files.at[to].path);
  diag_error(in->ast->diags, s->name_span, "this file includes itself" HELP "%s", sb_text(&chain));
}

/* Whether `path` was included before; a cycle is reported. */
static int seen_before(const Includes *in, const AstStmt *s, const char *path) {
  uint32_t known = 0;
  while (known < in->files.n && strcmp(in->files.at[known].path, path) != 0) known++;
  if (known == in->files.n) return 0;
  uint32_t from = file_of(in, s->span.begin);
  for (uint32_t i = from;; i = file_of(in, in->files.at[i].asked_by->span.begin)) {
    if (i == known) return report_cycle(in, s, from, known), 1;
    if (!in->files.at[i].asked_by) return 1;
  }
}

/* Whether the first message since `before` is about the first word of the file. */
static int begins_wrong(const Ast *ast, const Source *source, uint32_t before) {
  uint32_t at = 0;
  while (at < source->len && (strchr(" \t\r\n", source->text[at]) || source->text[at] == '#')) {
    const char *end = source->text[at] == '#' ? memchr(source->text + at, '\n', source->len - at) : source->text + at;
    at = end ? (uint32_t)(end - source->text) + 1 : source->len;
  }
  return ast->diags->list.n > before && ast->diags->list.at[before].span.begin <= source->base + at;
}

/* The statements of the file that s includes; none when it was included before or cannot be read. */
static StmtList included(Includes *in, AstStmt *s) {
  Ast *ast = in->ast;
  const char *path = source_locate(ast->sources, in->files.at[file_of(in, s->span.begin)].path, s->doc);
  if (seen_before(in, s, path)) return (StmtList){NULL, NULL};
  const char *error = NULL;
  const Source *source = source_read(ast->sources, path, &error);
  if (!source) {
    diag_error(ast->diags, s->name_span, "cannot read `%s`: %s", path, error);
    return (StmtList){NULL, NULL};
  }
  add_file(in, source, path, s);
  Diags before = *ast->diags;
  Parse cx;
  run(&cx, ast, source, TOK_BEGIN_FILE);
  if (cx.stmts.first || !begins_wrong(ast, source, before.list.n)) return cx.stmts;
  *ast->diags = before; /* a file of another kind, perhaps with secrets, is not quoted */
  diag_error(ast->diags, s->name_span,
             "`%s` is not a model: it has no statement" HELP "`lagc check %s` shows its lines", path, path);
  return cx.stmts;
}

/* The declarations that a network stands for, at its place. */
static StmtList declared_network(Includes *in, AstStmt *s) {
  Ast *ast = in->ast;
  const char *text = network_text(ast, s, in->files.at[file_of(in, s->span.begin)].path);
  const Source *source = text ? source_add(ast->sources, arena_printf(ast->arena, "network %s", s->name), text,
                                           strlen(text)) : NULL;
  if (!source) return (StmtList){NULL, NULL};
  Parse cx;
  run(&cx, ast, source, TOK_BEGIN_FILE);
  for (AstStmt *each = cx.stmts.first; each; each = each->next) each->name_span = s->name_span;
  return cx.stmts;
}

/* Puts the statements of included files where the include statements stand, and those of networks likewise. */
static StmtList follow_includes(Includes *in, StmtList list) {
  StmtList done = {NULL, NULL};
  for (AstStmt *s = list.first, *next; s; s = next) {
    next = s->next;
    s->next = NULL;
    if (s->kind != STMT_INCLUDE && s->kind != STMT_NETWORK) {
      done = stmts_add(done, s);
      continue;
    }
    StmtList more = s->kind == STMT_NETWORK ? declared_network(in, s) : included(in, s);
    if (!more.first) continue;
    more.last->next = next;
    next = more.first;
  }
  return done;
}

/* ---- entry points ---- */

int parse(Ast *ast, const Source *source) {
  uint32_t errors = ast->diags->errors;
  Includes in = {.ast = ast};
  add_file(&in, source, path_relative_to(ast->arena, "", source->path), NULL);
  Parse cx;
  run(&cx, ast, source, TOK_BEGIN_FILE);
  StmtList all = follow_includes(&in, cx.stmts);
  StmtList whole = stmts_join((StmtList){ast->first, ast->last}, all);
  ast->first = whole.first;
  ast->last = whole.last;
  return ast->diags->errors == errors;
}

const AstStmt *parse_composed(Ast *ast) {
#define FUNCTION(name, arguments, text) "function " #name "(" arguments ") = " text "\n"
  static const char text[] = COMPOSED(FUNCTION);
  if (ast->composed) return ast->composed;
  const Source *source = source_add(ast->sources, "functions of the language", text, sizeof text - 1);
  Parse cx;
  if (source) run(&cx, ast, source, TOK_BEGIN_FILE);
  return source ? ast->composed = cx.stmts.first : NULL;
}

AstId parse_expression(Ast *ast, const Source *source) {
  uint32_t errors = ast->diags->errors;
  Parse cx;
  run(&cx, ast, source, TOK_BEGIN_EXPR);
  return ast->diags->errors == errors ? cx.value : 0;
}
