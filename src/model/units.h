/* Units: what [kg*m/s^2] means in SI, and dimensions to check sums by. */
#ifndef LAGC_UNITS_H
#define LAGC_UNITS_H

#include "syntax/ast.h"

enum { DIM_LENGTH, DIM_MASS, DIM_TIME, DIM_CURRENT, DIM_TEMPERATURE, DIM_AMOUNT, DIM_LUMINOUS, DIM_COUNT };
enum { DIM_ONE = 12 }; /* exponents are in twelfths: m^(1/2) is 6 */

typedef struct {
  int known;            /* 0: a name without a unit; fits everything */
  int16_t e[DIM_COUNT]; /* exponents of m, kg, s, A, K, mol, cd */
} Dim;

typedef struct {
  Dim dim;
  Num factor;  /* SI value of one unit, times pi^pi_power */
  int pi_power;
  const char *text; /* as written; "" for none */
} Unit;

extern const Dim DIM_NONE;    /* dimensionless */
extern const Dim DIM_UNKNOWN;

/* The meaning of a unit as written; unknown names are reported, with the nearest known one.
 * No unit written: dimension unknown, factor 1. */
Unit unit_resolve(const AstUnit *u, Diags *diags, Arena *a);

/* Whether it is the name of a unit, with or without a prefix. */
int unit_exists(const char *name);

double unit_factor(const Unit *u);

/* Unit i of the table, for `lagc help units` and completion: its name, NULL past the end; what one of it is in SI base
 * units ("kg*m/s^2", "60 s", "pi/180"), NULL for a base unit; whether it takes the SI prefixes. */
const char *unit_name(size_t i);
const char *unit_meaning(size_t i, Arena *a);
int unit_takes_prefixes(size_t i);

Dim dim_mul(Dim a, Dim b);
Dim dim_div(Dim a, Dim b);
Dim dim_pow(Dim a, Num e);
int dim_fits(Dim a, Dim b); /* equal, or one is unknown */
int dim_is_none(Dim a);     /* known, and dimensionless */

/* "m/s^2", "J"; "1" when dimensionless, "?" when unknown. */
const char *dim_text(Dim a, Arena *arena);

#endif
