/* C text of the support functions, and the frame of a function around the body of a Prog. */
#include "emit/cfunction.h"

#include <ctype.h>
#include <string.h>

#include "base/num.h"

/* Whether a name begins at s: FLAG_REAL, of a model `flag`, stays; -DLAG_REAL is an option, jac_lag_ode CasADi's. */
static int begins_name(const char *text, const char *s) {
  if (s == text || !(isalnum((unsigned char)s[-1]) || s[-1] == '_')) return 1;
  return (s >= text + 2 && memcmp(s - 2, "-D", 2) == 0) || (s >= text + 4 && memcmp(s - 4, "jac_", 4) == 0);
}

void csupport_expand(const char *text, const char *prefix, const char *lower, StrBuf *out) {
  for (const char *s = text; *s;) {
    int upper = strncmp(s, "LAG_", 4) == 0, is_lower = strncmp(s, "lag_", 4) == 0;
    if ((upper || is_lower) && begins_name(text, s)) {
      sb_printf(out, "%s_", upper ? prefix : lower);
      s += 4;
    } else {
      sb_putc(out, *s++);
    }
  }
}

/* Whether the program uses the parameter `name`: reads, writes, or needs it as workspace. */
static int is_used(const Prog *p, const CStyle *st, const char *name) {
  if (strcmp(name, "w") == 0) return p->solves.n > 0;
  for (int k = 0; k < ARR_COUNT; k++)
    if (st->in[k] && strcmp(name, st->in[k]) == 0 && prog_reads(p, (IrArray)k)) return 1;
  for (uint32_t k = 0; k < p->stores.n; k++)
    if (strcmp(st->out[p->stores.at[k].array], name) == 0) return 1;
  return 0;
}

static void write_unused(const Prog *p, const CStyle *st, StrBuf *out) {
  int some = 0;
  for (int i = 0; st->own[i]; i++)
    if (!is_used(p, st, st->own[i])) sb_printf(out, "%s(void)%s;", some++ ? " " : "  ", st->own[i]);
  if (some) sb_putc(out, '\n');
}

const char *cfunction_status(const Prog *p, const CStyle *style) {
  return arena_printf(p->arena, "%s_%s", style->prefix, prog_has_pivots(p) ? "PIVOTS_STATUS" : "OK");
}

void cfunction(const Prog *p, const CStyle *style, const CFunction *f, StrBuf *out) {
  sb_putc(out, '\n');
  if (f->comment) sb_printf(out, "/* %s */\n", comment_text(p->arena, f->comment));
  sb_printf(out, "%s {\n", f->head);
  write_unused(p, style, out);
  if (f->own_work && p->solves.n) sb_printf(out, "  %s_REAL w[%u];\n", style->prefix, prog_work_size(p));
  cwrite_body(p, style, p->arena, out);
  if (f->returns) sb_printf(out, "  return %s;\n", cfunction_status(p, style));
  sb_puts(out, "}\n");
}

const char *shortest_double(Arena *a, double x) {
  char text[32];
  if (x > -1e9 && x < 1e9 && (double)(int)x == x) return arena_printf(a, "%d", (int)x); /* 10, not 1e+01 */
  num_format_double(text, x);
  return arena_strdup(a, text);
}

/* Whether statements, indented by two spaces, declare names outside of loops. */
static int declares(const char *body) {
  for (; *body; body += strcspn(body, "\n"), body += *body != '\0') {
    const char *type = strstr(body, "_REAL ");
    if (type && type < body + strcspn(body, "\n") && strncmp(body, "   ", 3) != 0 && strncmp(body, "  for", 5) != 0)
      return 1;
  }
  return 0;
}

/* Statements under a condition, or none, and in a block where they declare names. */
static void write_guarded(const char *condition, const char *body, StrBuf *out) {
  int block = declares(body);
  body += strspn(body, "\n ");
  int one = strchr(body, '\n') == body + strlen(body) - 1;
  if (!block && (one || !*condition)) {
    sb_printf(out, "  %s%s", condition, body);
    return;
  }
  sb_printf(out, "  %s{\n    ", condition);
  while (*body) {
    size_t n = strcspn(body, "\n");
    sb_printf(out, "%.*s\n", (int)n, body);
    body += n;
    body += strspn(body, "\n");
    if (*body) sb_puts(out, "  ");
  }
  sb_puts(out, "  }\n");
}

void cwrite_params(const IrParams *x, CStyle style, Arena *a, StrBuf *out) {
  StrBuf body = strbuf(a);
  const char *condition = "";
  if (x->n == 1 && style.guard) {
    condition = arena_printf(a, "if (!%s[%u]) ", style.guard, x->first);
    style.guard = NULL;
  }
  style.loads_inline = style.prefer_short_code = style.apart = 1;
  cwrite_body(x->values, &style, a, &body);
  write_guarded(condition, sb_text(&body), out);
}
