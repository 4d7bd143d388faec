/* Walks each side from its root down, by descending node numbers, and gives every operand its role. */
#include "claims/edit_sites.h"

typedef struct {
  const Model *m;
  AstId first;
  Site *of;       /* [node - first] */
  uint8_t *known; /* [node - first] the node is a site */
} Walk;

static int is_sum(AstKind k) { return k == AST_ADD || k == AST_SUB; }
static int is_product(AstKind k) { return k == AST_MUL || k == AST_DIV; }

int site_is_sum(const Model *m, const Site *s) { return is_sum(ast_expr(m->ast, s->node)->kind); }

static int blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* The span s with the parentheses around it, if any (one pair, and not a call's). */
static Span with_parentheses(const Model *m, Span s) {
  Place p = source_place(m->ast->sources, s.begin);
  if (!p.file) return s;
  const char *text = p.file->text;
  uint32_t b = s.begin - p.file->base, e = s.end - p.file->base;
  while (b > 0 && blank(text[b - 1])) b--;
  while (e < p.file->len && blank(text[e])) e++;
  if (b == 0 || text[b - 1] != '(' || text[e] != ')') return s;
  return (Span){b - 1 + p.file->base, e + 1 + p.file->base};
}

static void put(Walk *w, AstId node, const Site *above, SiteRole role) {
  Site *s = &w->of[node - w->first];
  Span span = ast_expr(w->m->ast, node)->span;
  if (role != SITE_ARGUMENT && role != SITE_ROOT && role != SITE_PART) span = with_parentheses(w->m, span);
  *s = (Site){.node = node, .up = above ? above->node : 0, .left = above ? above->left : s->left, .role = role, .span = span, .with_op = span};
  w->known[node - w->first] = 1;
}

static void put_operands(Walk *w, const AstExpr *x, const Site *s) {
  AstKind left = ast_expr(w->m->ast, x->a)->kind;
  SiteRole role, left_role;
  if (is_sum(x->kind)) {
    role = SITE_TERM;
    left_role = is_sum(left) ? SITE_PART : SITE_TERM;
  } else if (x->kind == AST_MUL) {
    role = SITE_FACTOR;
    left_role = is_product(left) ? SITE_PART : SITE_FACTOR;
  } else {
    role = SITE_DIVISOR;
    left_role = left == AST_DIV ? SITE_PART : SITE_NUMERATOR;
  }
  put(w, x->a, s, left_role);
  put(w, x->b, s, role);
  Site *b = &w->of[x->b - w->first];
  b->with_op = span_join(x->op_span, b->span);
}

/* The arguments of a call that are values: none of d(), all but the condition of if(). */
static void put_arguments(Walk *w, const AstExpr *x, const Site *s) {
  if (strcmp(x->name, "d") == 0) return;
  AstId arg = x->args;
  if (strcmp(x->name, "if") == 0 && arg) arg = ast_expr(w->m->ast, arg)->next;
  for (; arg; arg = ast_expr(w->m->ast, arg)->next) put(w, arg, s, SITE_ARGUMENT);
}

static void put_below(Walk *w, const Site *s) {
  const AstExpr *x = ast_expr(w->m->ast, s->node);
  switch (x->kind) {
    case AST_ADD: case AST_SUB: case AST_MUL: case AST_DIV: put_operands(w, x, s); return;
    case AST_NEG: put(w, x->a, s, s->role == SITE_FACTOR ? SITE_FACTOR : SITE_NUMERATOR); return;
    case AST_POW: put(w, x->a, s, SITE_BASE); return;
    case AST_CALL: put_arguments(w, x, s); return;
    case AST_NUM: case AST_NAME: case AST_PRIME: case AST_UNIT: case AST_MEMBER: case AST_INDEX: case AST_AT: case AST_STRING:
    case AST_NOT: case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE: case AST_AND:
    case AST_OR: case AST_SUM: case AST_PRODUCT: case AST_TUPLE: case AST_LIST: case AST_BIND: case AST_ERROR: return;
  }
}

static void walk_side(const Model *m, AstId root, int left, SiteList *out) {
  AstId first = ast_expr(m->ast, root)->first;
  Walk w = {.m = m, .first = first};
  w.of = ARENA_ARRAY(m->arena, Site, root - first + 1);
  w.known = ARENA_ARRAY(m->arena, uint8_t, root - first + 1);
  w.of[root - first].left = left;
  put(&w, root, NULL, SITE_ROOT);
  w.of[root - first].left = left;
  for (AstId i = root + 1; i-- > first;) {
    if (!w.known[i - first]) continue;
    put_below(&w, &w.of[i - first]);
    out->at[out->n++] = w.of[i - first];
  }
}

SiteList edit_sites_of(const Model *m, const Expect *x) {
  uint32_t left = x->lhs_ast - ast_expr(m->ast, x->lhs_ast)->first + 1;
  uint32_t right = x->rhs_ast - ast_expr(m->ast, x->rhs_ast)->first + 1;
  SiteList l = {.at = ARENA_ARRAY(m->arena, Site, left + right)};
  walk_side(m, x->lhs_ast, 1, &l);
  walk_side(m, x->rhs_ast, 0, &l);
  return l;
}

const char *span_text(const Model *m, Span span) {
  enum { LONGEST = 44, HEAD = 26, TAIL = 14 };
  Place p = source_place(m->ast->sources, span.begin);
  if (!p.file) return "";
  const char *from = p.file->text + (span.begin - p.file->base), *end = from + (span.end - span.begin);
  StrBuf b = strbuf(m->arena);
  for (const char *c = from; c < end; c++) {
    while (*c == '#' && c + 1 < end && *c != '\n')
      while (c + 1 < end && *c != '\n') c++;
    if (!blank(*c)) sb_putc(&b, *c);
    else if (b.n && b.at[b.n - 1] != ' ') sb_putc(&b, ' ');
  }
  const char *text = sb_text(&b);
  if (b.n <= LONGEST) return text;
  size_t head = HEAD, tail = b.n - TAIL;
  while (head && ((unsigned char)text[head] & 0xC0) == 0x80) head--;
  while (tail < b.n && ((unsigned char)text[tail] & 0xC0) == 0x80) tail++;
  return arena_printf(m->arena, "%.*s ... %s", (int)head, text, text + tail);
}
