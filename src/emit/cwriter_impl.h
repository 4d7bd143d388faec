/* Internals of the writer of function bodies: cwriter.c writes statements, csolve.c linear systems, cloop.c loops,
 * cnest.c nests of loops, ccubes.c reciprocal cubes. */
#pragma once

#include "emit/cwriter.h"
#include "ir/roll.h"

enum { SINCOS_BATCH = 4 }; /* largest number of angles whose sines and cosines one call computes */
enum { C_SELECT = 1, C_OR, C_AND, C_CMP, C_ADD, C_MUL, C_UNARY, C_ATOM };

typedef struct {
  const char *text;
  int prec;
  int counted; /* 1: a generated name such as w1, without meaning */
} CExpr;

typedef struct {
  const Prog *p;
  const CStyle *style;
  Arena *a;
  CNames names;
  uint32_t *uses;
  const char **stored; /* by slot: comment of the store of its value */
  CExpr *piece; /* by slot: C text of its value */
  /* by slot of a sine: the cosine of the same angle, and vice versa, where one call computes both; or 0 */
  Slot *pair;
  unsigned char *in_call; /* by slot: 1 if a call of several (ccubes.c) has computed it */
  StrBuf *out;
  uint32_t temps;
  const char *title; /* pending: printed before the next statement */
  size_t indent;     /* added to the two columns of the body */
  Rolls rolls;
  const char ***kept; /* [loops][period] arrays that hold a value of all turns; NULL if none does */
  unsigned char named[ARR_COUNT]; /* arrays whose loads have been declared */
  unsigned char *load_needs_name; /* by slot: a load used outside of loops, or by all turns of one */
  const char *cells, *row, *turn; /* array of sums to which nests add, and the nests' counters */
  struct {
    const Spline *curve;
    const char *name;
  } rows[8]; /* [nrows] tables that were written */
  uint32_t nrows;
  int together;       /* 1: in turns side by side, whose values are vectors */
  const CExpr *again; /* by slot, in turns written a second time: the names of the first; or NULL */
  const char *parameters; /* array copy of the parameters that nests read, if parameters are struct members; or NULL */
} Writer;

CExpr cwriter_operand(const Writer *w, Slot s);
CExpr cwriter_spell(Writer *w, const Ins *i);
int cwriter_is_short(const Writer *w, CExpr x);

/* Condition before a store: "if (!fixed[3]) ", or "". */
const char *cwriter_guard(const Writer *w, const char *index);

/* Appends a statement, broken at spaces where it is long; cwriter_line with a line end. */
void cwriter_statement(Writer *w, const char *text);
void cwriter_line(Writer *w, const char *text);
void cwriter_pivot(Writer *w, const Ins *i);
void cwriter_flush_title(Writer *w);

/* Name of an array that is read. */
const char *cwriter_array(const Writer *w, IrArray array);

/* Clears the texts of all values and spells the constants, which need no statement and may be used in an earlier
 * turn of a loop. */
void cwriter_init_pieces(Writer *w);

/* Writes an instruction outside the loops of cloop.c. */
void cwriter_instruction(Writer *w, Slot s);

/* Finds the pairs sin x, cos x that one sincos call computes. */
void cwriter_find_sincos(Writer *w);

/* Takes a name for a value: the user's, one derived from its operands, or w1, w2, ... */
CExpr cwriter_name(Writer *w, const Ins *i);

/* Writes `const LAG_REAL name = x;`; slot s is spelled by that name from now on. */
void cwriter_declare(Writer *w, Slot s, CExpr name, CExpr x);

/* Declares a sine and its cosine by one sincos call, named after their instructions, unless done already. Returns 0
 * if slot s has no pair. */
int cwriter_declare_sincos(Writer *w, Slot s, const Ins *first, const Ins *second);

/* Declares the loads of the arrays that instruction s reads. */
void cwriter_arrays_of(Writer *w, Slot s);

/* Computes reciprocal cubes from slot s on by one call, if there are enough. Returns 1 if s is computed by a call. */
int ccubes_write(Writer *w, Slot s);

/* Whether sin and cos of one operand can share a call: both outside of loops, or in the same turn of one loop in all
 * turns. */
int cloop_share_turn(const Writer *w, Slot a, Slot b);

/* Whether slot s is computed in a loop. */
int cloop_contains(const Writer *w, Slot s);

/* Finds the loads that need a name; to be called before any text is written. */
void cloop_prepare(Writer *w);

/* Whether a load gets a name at the top of the function. */
int cloop_names_load(const Writer *w, Slot s);

/* Name without indices, common to all turns of a loop: x[3]' -> x', D12 -> D, L2_11 -> L. */
const char *cloop_stem(Arena *a, const char *name);

/* Text of the index first + by_i*i + by_j*j. */
const char *cloop_index(Arena *a, int64_t first, int64_t by_i, const char *i, int64_t by_j, const char *j);

/* Writes an IR_SOLVE. */
void csolve_write(Writer *w, const Ins *i);

/* Writes a whole loop. */
void cloop_write(Writer *w, uint32_t loop);

/* Declares counters and the array of sums; writes one nest. */
void cnest_prepare(Writer *w);
void cnest_write(Writer *w, const Ins *i);

/* Number of stores from store k on that can be written as one loop (0: none); and that loop. */
uint32_t cloop_stores(const Writer *w, uint32_t k);
void cloop_write_stores(Writer *w, uint32_t k, uint32_t n);
