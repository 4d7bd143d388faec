#include "base/diag.h"

Diags *diags_new(Arena *a, const Sources *sources) {
  Diags *d = ARENA_NEW(a, Diags);
  d->arena = a;
  d->sources = sources;
  return d;
}

/* A text that is compiled several times (once a scene) makes the same mistake each time: one
 * message is enough. */
static Diag *find(const Diags *d, const Diag *one) {
  for (uint32_t i = 0; i < d->list.n; i++) {
    Diag *other = &d->list.at[i];
    if (other->span.begin == one->span.begin && other->span.end == one->span.end &&
        other->severity == one->severity && strcmp(other->message, one->message) == 0)
      return other;
  }
  return NULL;
}

static Diag *add(Diags *d, Severity severity, Span span, const char *fmt, va_list ap) {
  Diag one = {.severity = severity, .span = span, .message = arena_vprintf(d->arena, fmt, ap)};
  if (severity == DIAG_ERROR) d->errors++;
  Diag *known = span.end ? find(d, &one) : NULL;
  d->latest = known ? (uint32_t)(known - d->list.at) : d->list.n > DIAG_MAX ? DIAG_MAX : d->list.n;
  if (known) return known;
  if (d->list.n > DIAG_MAX) { /* the last slot takes what is no longer shown */
    d->unshown++;
    d->list.at[DIAG_MAX] = one;
  } else {
    vec_push(d->arena, &d->list, one);
  }
  return &d->list.at[d->list.n - 1];
}

#define ADD(severity)                                 \
  va_list ap;                                         \
  va_start(ap, fmt);                                  \
  Diag *one = add(d, (severity), span, fmt, ap);      \
  va_end(ap);                                         \
  return one

Diag *diag_error(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_ERROR); }
Diag *diag_warning(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_WARNING); }
Diag *diag_note(Diags *d, Span span, const char *fmt, ...) { ADD(DIAG_NOTE); }

void diag_help(Diags *d, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  d->list.at[d->latest].help = arena_vprintf(d->arena, fmt, ap);
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

/* The source line and, under it, a caret with tildes to the end of the span (or of the line).
 * Long lines are shown in a window around the span. */
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
  sb_printf(out, "%5u | %s%.*s%s\n      | %s", p->line, dots, (int)(len - from), p->line_text + from,
            more, from ? "   " : "");
  for (uint32_t k = from; k < p->line_byte && k < p->line_len; k++) {
    unsigned char c = (unsigned char)p->line_text[k];
    if (c == '\t') sb_putc(out, '\t');
    else if ((c & 0xC0) != 0x80) sb_putc(out, ' ');
  }
  sb_putc(out, '^');
  uint32_t end = p->line_byte + (span.end > span.begin ? span.end - span.begin : 1);
  for (uint32_t k = p->line_byte + 1; k < end && k < len; k++)
    if (((unsigned char)p->line_text[k] & 0xC0) != 0x80) sb_putc(out, '~');
  sb_putc(out, '\n');
}

static void print_one(const Diags *d, StrBuf *out, Severity severity, Span span, const char *message) {
  static const char *const words[] = {"note", "warning", "error"};
  Place p = source_place(d->sources, span.end ? span.begin : 0);
  if (p.file) sb_printf(out, "%s:%u:%u: ", p.file->path, p.line, p.column);
  else sb_puts(out, "lagc: ");
  sb_printf(out, "%s: %s\n", words[severity], message);
  if (p.file) print_snippet(out, &p, span);
}

/* Insertion order is kept among messages about one place. */
static void sort_by_place(const Diags *d, uint32_t *order) {
  for (uint32_t i = 0; i < d->list.n && i < DIAG_MAX; i++) {
    uint32_t k = i;
    for (; k > 0 && d->list.at[order[k - 1]].span.begin > d->list.at[i].span.begin; k--)
      order[k] = order[k - 1];
    order[k] = i;
  }
}

void diags_print(const Diags *d, StrBuf *out) {
  uint32_t *order = ARENA_ARRAY(d->arena, uint32_t, d->list.n + 1);
  sort_by_place(d, order);
  for (uint32_t i = 0; i < d->list.n && i < DIAG_MAX; i++) {
    const Diag *one = &d->list.at[order[i]];
    print_one(d, out, one->severity, one->span, one->message);
    if (one->help) sb_printf(out, "      = %s\n", one->help);
    if (one->note) print_one(d, out, DIAG_NOTE, one->note_span, one->note);
  }
  if (d->list.n > DIAG_MAX)
    sb_printf(out, "lagc: note: %u more messages are not shown\n", d->unshown + 1);
}
