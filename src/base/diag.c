/* Diagnostics: records messages once each, and prints them by place, with the source line and a caret under the
 * span. */
#include "base/diag.h"

#include "base/visible.h"

Diags *diags_new(Arena *a, const Sources *sources) {
  Diags *d = ARENA_NEW(a, Diags);
  d->arena = a;
  d->sources = sources;
  return d;
}

/* The text behind the numbers of an index that begins here, `[12]` or `[1,2]`; NULL: there is none. */
static const char *behind_index(const char *s) {
  size_t n = *s == '[' ? strspn(s + 1, "0123456789,") : 0;
  return n && s[n + 1] == ']' ? s + n + 2 : NULL;
}

/* Whether two messages differ by indices only. *later: b is about a later member. */
static int are_of_family(const char *a, const char *b, int *later) {
  int order = 0;
  while (*a && *b) {
    const char *next_a = behind_index(a), *next_b = behind_index(b);
    if (!(next_a && next_b) && *a != *b) return 0;
    long longer = next_a && next_b ? (next_b - b) - (next_a - a) : 0; /* numbers with more digits are larger */
    if (order == 0 && next_a && next_b) order = longer ? (int)longer : strncmp(b, a, (size_t)(next_a - a));
    a = next_a && next_b ? next_a : a + 1;
    b = next_a && next_b ? next_b : b + 1;
  }
  if (*a != *b) return 0;
  *later = order > 0;
  return 1;
}

/* The recorded message equal to this one, or NULL: a text compiled once a scene repeats its mistakes. Of errors and
 * warnings also one about another member of the same family. *fresh: this member is later than all recorded ones. */
static Diag *find(const Diags *d, const Diag *one, int *fresh) {
  for (uint32_t i = 0; i < d->list.n; i++) {
    Diag *other = &d->list.at[i];
    if (other->span.begin != one->span.begin || other->span.end != one->span.end || other->severity != one->severity)
      continue;
    if (strcmp(other->message, one->message) == 0) return other;
    if (one->severity != DIAG_NOTE && are_of_family(other->last ? other->last : other->message, one->message, fresh))
      return other;
  }
  return NULL;
}

static int add(Diags *d, Severity severity, Span span, const char *fmt, va_list ap) {
  char *text = arena_vprintf(d->arena, fmt, ap), *help = strchr(text, HELP[0]);
  if (help) *help++ = '\0';
  Diag one = {.severity = severity, .span = span, .message = text, .help = help};
  if (severity == DIAG_ERROR) d->errors++;
  int fresh = 0;
  Diag *known = span.end ? find(d, &one, &fresh) : NULL;
  d->latest = known ? (uint32_t)(known - d->list.at) : d->list.n > DIAG_MAX ? DIAG_MAX : d->list.n;
  if (fresh) {
    known->last = text;
    known->more++;
  } else if (known && help && !known->more) known->help = help;
  if (known) return 0;
  if (d->list.n > DIAG_MAX) { /* messages that are not shown share the last slot */
    d->unshown++;
    d->list.at[DIAG_MAX] = one;
  } else {
    vec_push(d->arena, &d->list, one);
  }
  return 0;
}

#define ADD(severity)                        \
  va_list ap;                                \
  va_start(ap, fmt);                         \
  add(d, (severity), span, fmt, ap);         \
  va_end(ap);                                \
  return 0

int diag_error(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_ERROR); }
int diag_warning(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_WARNING); }
int diag_note(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_NOTE); }
void diag_drop_notes(Diags *d, Span span) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < d->list.n; k++) {
    const Diag *x = &d->list.at[k];
    if (x->severity != DIAG_NOTE || x->span.begin != span.begin || x->span.end != span.end) d->list.at[n++] = *x;
  }
  d->list.n = n;
}

int diag_verror(Diags *d, Span span, const char *fmt, va_list ap) { return add(d, DIAG_ERROR, span, fmt, ap); }

void diag_help(Diags *d, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  if (!d->list.at[d->latest].more) d->list.at[d->latest].help = arena_vprintf(d->arena, fmt, ap);
  va_end(ap);
}

void diag_also(Diags *d, Span span, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  Diag *one = &d->list.at[d->latest];
  one->note_span = span;
  one->note = arena_vprintf(d->arena, fmt, ap);
  va_end(ap);
}

/* Puts the sign under each screen column that bytes from..to of the line take. */
static void put_under(StrBuf *out, const Place *p, uint32_t from, uint32_t to, char sign) {
  char shown[VISIBLE_SIZE];
  for (uint32_t k = from; k < to; k++) {
    unsigned char c = (unsigned char)p->line_text[k];
    if ((c & 0xC0) == 0x80) continue;
    if (c == '\t') {
      sb_putc(out, sign == ' ' ? '\t' : sign);
      continue;
    }
    show_visible(p->line_text + k, p->line_len - k, shown);
    for (size_t columns = shown[0] == '<' && c != '<' ? strlen(shown) : 1; columns; columns--) sb_putc(out, sign);
  }
}

/* The source line and, under it, a caret with tildes to the end of the span (or of the line). Long lines are shown
 * in a window around the span. */
static void print_snippet(StrBuf *out, const Place *p, Span span) {
  enum { WIDE = 160, BEFORE = 60 };
  uint32_t from = 0, len = p->line_len;
  if (len > WIDE) {
    if (p->line_byte > BEFORE) from = p->line_byte - BEFORE;
    while (from > 0 && ((unsigned char)p->line_text[from] & 0xC0) == 0x80) from--;
    if (len - from > WIDE) len = from + WIDE;
  }
  const char *dots = from ? "..." : "";
  const char *more = len < p->line_len ? "..." : "";
  sb_printf(out, "%5u | %s", p->line, dots);
  sb_visible(out, p->line_text + from, len - from, "\t");
  sb_printf(out, "%s\n      | %s", more, from ? "   " : "");
  put_under(out, p, from, p->line_byte < p->line_len ? p->line_byte : p->line_len, ' ');
  sb_putc(out, '^');
  uint32_t end = p->line_byte + (span.end > span.begin ? span.end - span.begin : 1);
  put_under(out, p, p->line_byte + 1, end < len ? end : len, '~');
  sb_putc(out, '\n');
}

static void print_one(const Diags *d, StrBuf *out, Severity severity, Span span, const char *message) {
  static const char *const words[] = {"note", "warning", "error"};
  Place p = source_place(d->sources, span.end ? span.begin : 0);
  if (p.file) sb_visible(out, p.file->path, strlen(p.file->path), "");
  if (p.file) sb_printf(out, ":%u:%u: ", p.line, p.column);
  else sb_puts(out, "lagc: ");
  sb_printf(out, "%s: ", words[severity]);
  sb_visible(out, message, strlen(message), "\n\t");
  sb_putc(out, '\n');
  if (p.file) print_snippet(out, &p, span);
}

/* Stable insertion sort of message indices by place. */
static void sort_by_place(const Diags *d, uint32_t *order) {
  for (uint32_t i = 0; i < d->list.n && i < DIAG_MAX; i++) {
    uint32_t k = i;
    for (; k > 0 && d->list.at[order[k - 1]].span.begin > d->list.at[i].span.begin; k--)
      order[k] = order[k - 1];
    order[k] = i;
  }
}

const char *diag_text(const Diags *d, const Diag *one) {
  return one->more ? arena_printf(d->arena, "%s, and %u more of its family", one->message, one->more) : one->message;
}

void diags_print(const Diags *d, StrBuf *out) {
  uint32_t *order = ARENA_ARRAY(d->arena, uint32_t, d->list.n + 1);
  sort_by_place(d, order);
  for (uint32_t i = 0; i < d->list.n && i < DIAG_MAX; i++) {
    const Diag *one = &d->list.at[order[i]];
    print_one(d, out, one->severity, one->span, diag_text(d, one));
    if (one->help) {
      sb_puts(out, "      = ");
      sb_visible(out, one->help, strlen(one->help), "\n\t");
      sb_putc(out, '\n');
    }
    if (one->note) print_one(d, out, DIAG_NOTE, one->note_span, one->note);
  }
  if (d->list.n > DIAG_MAX)
    sb_printf(out, "lagc: note: %u more messages not shown\n", d->unshown + 1);
}
