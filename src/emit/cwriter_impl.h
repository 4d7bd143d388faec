/* The inside of the writer of function bodies: cwriter.c writes statements, csolve.c linear systems, cloop.c loops, cnest.c loops inside loops. */
#ifndef LAGC_CWRITER_IMPL_H
#define LAGC_CWRITER_IMPL_H

#include "emit/cwriter.h"
#include "ir/roll.h"

enum { ABREAST = 4 }; /* sines and cosines of so many angles by one call, at most */
enum { C_SELECT = 1, C_OR, C_AND, C_CMP, C_ADD, C_MUL, C_UNARY, C_ATOM };

typedef struct {
  const char *text;
  int prec;
  int counted; /* a name w1, w2, ... that says nothing */
} Piece;

typedef struct {
  const Prog *p;
  const CStyle *style;
  Arena *a;
  CNames names;
  uint32_t *uses;
  const char **stored; /* by slot: the comment of the store that uses it */
  Piece *piece; /* by slot: how its value is spelled where it is used */
  Slot *pair;   /* by slot: the cosine of a sine's operand, and the other way round, where one call makes both; or 0 */
  StrBuf *out;
  uint32_t temps;
  const char *title; /* pending: printed before the next statement */
  size_t indent;     /* besides that of the body */
  Rolls rolls;
  const char ***kept; /* [loops][period] the arrays that hold the values of all turns; NULL where none */
  unsigned char named[ARR_COUNT]; /* arrays whose loads have their names */
  unsigned char *named_load; /* by slot: a load that is used outside of loops, or by all turns of one */
  const char *cells, *row, *turn; /* the array of sums that nests add to, and their counters */
  const CIndices *indices; /* tables that nests take indices from */
  const char *parameters; /* an array with the parameters that nests read, where they are members of a struct; or NULL */
} Writer;

Piece cwriter_operand(const Writer *w, Slot s);
Piece cwriter_spell(Writer *w, const Ins *i);
int cwriter_is_short(const Writer *w, Piece x);

/* A statement, broken at spaces where it is long; without the end of the line. */
void cwriter_statement(Writer *w, const char *text);
void cwriter_pivot(Writer *w, const Ins *i);
void cwriter_flush_title(Writer *w);

/* What an array that is read is called. */
const char *cwriter_array(const Writer *w, IrArray array);

/* Before a program is written. Numbers need no statement, and are spelled now: in a loop they may stand in a later turn than their use. */
void cwriter_new_pieces(Writer *w);

/* An instruction that is in no loop of cloop.c. */
void cwriter_instruction(Writer *w, Slot s);

/* Finds sines and cosines that one call makes. */
void cwriter_find_pairs(Writer *w);

/* A name for the value: the user's, one made of what it is made of, or w1, w2, ... */
Piece cwriter_name(Writer *w, const Ins *i);

/* `const LAG_REAL name = x;`, and spells slot s by that name from now on. */
void cwriter_declare(Writer *w, Slot s, Piece name, Piece x);

/* Declares a value and its pair, with the names that their instructions have, by one call, unless the pair came first. 0 where
 * it has no pair. */
int cwriter_pair(Writer *w, Slot s, const Ins *first, const Ins *second);

/* Whether two functions of one operand stand side by side: both in no loop, or in the same turn of one in all turns. */
int cloop_together(const Writer *w, Slot a, Slot b);

/* Whether a loop computes it. */
int cloop_holds(const Writer *w, Slot s);

/* Before anything is written. */
void cloop_prepare(Writer *w);

/* Whether a load gets a name at the top of the function. */
int cloop_names_load(const Writer *w, Slot s);

/* x[3]' -> x', D12 -> D, L2_11 -> L: what the turns' names have in common. */
const char *cloop_stem(Arena *a, const char *name);

/* An IR_SOLVE. */
void csolve_write(Writer *w, const Ins *i);

/* An IR_INVERT. */
void csolve_write_inverse(Writer *w, const Ins *i);

/* A whole loop. */
void cloop_write(Writer *w, uint32_t loop);

/* Before anything is written; a nest. */
void cnest_prepare(Writer *w);
void cnest_write(Writer *w, const Ins *i);

/* How many stores from number k on can be written as a loop; 0 for none. And that loop. */
uint32_t cloop_stores(const Writer *w, uint32_t k);
void cloop_write_stores(Writer *w, uint32_t k, uint32_t n);

#endif
