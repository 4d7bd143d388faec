/* Parts of the emitted model file that emit_model.c puts together: scenes (emit_scene.c), Taylor recurrences
 * (emit_taylor.c), tables of variables (variable_tables.c). */
#pragma once

#include "emit/cfunction.h"
#include "ir/program_set.h"

typedef struct {
  const ProgramSet *u;
  Arena *a;
  const char *const *globals; /* names that functions must not hide, NULL at the end */
  StrBuf *out;
  StrBuf *fill; /* calls that write names of families; NULL: macros write them */
  int for_readers; /* 1: loops are written once, not for vectors too */
} ModelFile;

/* How functions of the file spell their arrays. own: names of their arguments, NULL at the end; written: of their
 * output arrays. */
CStyle model_style(const ModelFile *f, const char *const *own, const char *const *written);

/* Appends the function NAME of the state around p, if there is one; in: letters of further arrays that it reads;
 * written: words, its output arrays. */
void state_function(const ModelFile *f, const Prog *p, const char *name, const char *comment, const char *in,
                    const char *written);

/* Names of the arrays of the inputs' tables. */
const char *const *model_rows_names(const ProgramSet *u);
/* Appends the names of the bits that are set, or 0. */
void model_flags(unsigned flags, const char *const *names, uint32_t n, StrBuf *out);

/* emit_model.c: a table of positions. emit_families.c: families of contacts. */
void emit_entries(const char *name, const IrEntry *at, uint32_t n, StrBuf *out);
void emit_families(const ModelFile *f);

/* model_struct.c: appends the const lag_model called NAME, and the tables that it names. */
void emit_model_struct(const ProgramSet *u, const char *name, StrBuf *fill, StrBuf *out);

/* emit_scene.c: appends the functions and tables of scene `index` of the model whose lag_model is called NAME. */
void emit_scene(const ModelFile *f, const char *name, uint32_t index);

/* Series -> the functions that compute a model's Taylor coefficients, and the const lag_taylor called `taylor`.
 * base: all but in, out and own; lanes: for a text that is compiled for lanes. */
void emit_taylor(const Series *s, const CStyle *base, int lanes, StrBuf *out);

/* The same in plain C for a header, without lag_taylor: sizes and the type lower_taylor_work; functions
 * lower_taylor_first, _rest and _at. */
void emit_taylor_types(const Series *s, const CStyle *base, const char *lower, StrBuf *out);
void emit_taylor_functions(const Series *s, const CStyle *base, const char *lower, StrBuf *out);

/* Operations of order 0, of each other order, and sums of k - 1 products in order k. */
typedef struct {
  uint32_t first, next, sums;
} TaylorCosts;
TaylorCosts taylor_costs(const Series *s);
int taylor_sums_fit_registers(const Series *s);

/* For models with constraints, by component of [q|v|z]: 1 where the start sets it, 2 for implied ones. */
const unsigned char *scene_given(const ProgramSet *u, const IrScene *s);

/* Digest of the equations of a model whose lag_model is called NAME. */
const char *model_digest(const ProgramSet *u, const char *name);
/* Whether its lag_model has a linearisation: with constraints the derivatives are those of headers. */
int model_has_linear(const ProgramSet *u);

enum { TAYLOR_INLINE_MAX = 300 }; /* most operations of taylor_next that are inlined several times */

/* emit_lanes.c, for a text that is compiled for lanes: columns of factors of its convolution sums; functions for
 * these and for the step of an order; the loop over orders. */
uint32_t emit_lane_factors(const Series *s);
void emit_lane_sums(const Series *s, StrBuf *out);
void emit_lane_orders(const Series *s, StrBuf *out);
/* The scenes of lag_program.lanes_4 or lanes_8, of n units with these names. */
void emit_lane_scenes(const ProgramSet *const *units, const char *const *names, uint32_t n, int lanes, StrBuf *out);

/* The C identifier of scene k. */
const char *scene_id(const ProgramSet *u, uint32_t k);

/* Whether a table of variables (names, units, factors) is written with macros, as runs of numbered names (u[1],
 * u[2], ...) are, so that the text does not grow with the length of families; if so, table_macros must precede it.
 * */
int table_needs_macros(const IrVar *v, uint32_t n);
/* Whether a table of the unit is. */
int model_has_long_tables(const ProgramSet *u);
void table_macros(StrBuf *out);

/* `static const lag_var NAME[] = {...};`, or nothing for an empty table. fill: NULL, or calls that write the runs of
 * numbered names when the program begins, since a C compiler takes long for each entry. */
void table_vars(const char *name, const IrVar *v, uint32_t n, StrBuf *fill, Arena *a, StrBuf *out);

/* Number of a table in the model's precision: digits (or NULL) if longer than the double's text; integers stay
 * plain. */
const char *table_number(Arena *a, double x, const char *digits);
