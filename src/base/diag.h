/* Diagnostics: messages of the compiler to its user. They accumulate, and are printed together:
 *
 *   pend.lag:3:27: error: unknown name `thh`
 *      3 | lagrangian = m*l^2/2*thh'^2
 *        |                      ^~~
 *        = did you mean `th`?
 */
#pragma once

#include "base/source.h"
#include "base/strbuf.h"

typedef enum { DIAG_NOTE, DIAG_WARNING, DIAG_ERROR } Severity;

typedef struct Diag Diag;
struct Diag {
  Severity severity;
  Span span;
  const char *message;
  const char *last;  /* the same about the last member of a family, or NULL */
  uint32_t more;     /* members behind the first */
  const char *help;  /* a way out, or NULL */
  Span note_span;    /* a second place ("first declared here"), or zero */
  const char *note;
};

typedef struct {
  Arena *arena;
  const Sources *sources;
  VEC(Diag) list;
  uint32_t errors;  /* all of them */
  uint32_t latest;  /* index of the message recorded last */
  uint32_t unshown; /* messages past the first DIAG_MAX + 1 */
} Diags;

enum { DIAG_MAX = 100 }; /* messages shown; the rest are counted in one line */

Diags *diags_new(Arena *a, const Sources *sources);

/* Separates a message from the way out that it offers: "unknown name `%s`" HELP "did you mean `%s`?". */
#define HELP "\x1F"

/* Records a message about a span, with its way out, if the text has one; a repetition of a recorded message is
 * dropped, and of one about another member of a family, as `x[2]` after `x[1]`, counted. Returns 0. */
int diag_error(Diags *d, Span span, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
int diag_warning(Diags *d, Span span, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* A message that is neither error nor warning: verdicts of `lagc check`. */
int diag_note(Diags *d, Span span, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* Drops the notes about a span, before an error about it. */
void diag_drop_notes(Diags *d, Span span);

int diag_verror(Diags *d, Span span, const char *fmt, va_list ap) __attribute__((format(printf, 3, 0)));

/* Adds a way out, or a second place, to the message recorded last. */
void diag_help(Diags *d, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
void diag_also(Diags *d, Span span, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* The message, with the number of members that share it. */
const char *diag_text(const Diags *d, const Diag *one);

/* Appends every message, in order of place, as shown above. */
void diags_print(const Diags *d, StrBuf *out);
