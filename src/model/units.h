/* Units: what [kg*m/s^2] means in SI. */
#ifndef LAGC_UNITS_H
#define LAGC_UNITS_H

#include "model/dims.h"
#include "syntax/ast.h"

typedef struct {
  Dim dim;     /* DIM_ANY: none was written */
  Num factor;  /* x units are x*factor*pi^pi_power + offset in SI */
  int pi_power;
  Num offset;  /* 273.15 of degC; otherwise 0 */
  const char *text; /* as written; "" for none */
} Unit;

/* The meaning of a unit as written; unknown names are reported, with the nearest known one.
 * No unit written: DIM_ANY, factor 1. */
Unit unit_resolve(const AstUnit *u, Dims *dims, Diags *diags, Arena *a);

/* The unit of a dimension in SI: the factor is 1, the text is "" where the dimension is not known or none. */
Unit unit_of_dim(Dims *dims, Dim d);

/* Whether a unit is given in which something is measured: not the absence of one, no angle, no number. */
int unit_measures(const AstUnit *u);

/* Whether it is the name of a unit, with or without a prefix. */
int unit_exists(const char *name);

/* The table: name i, and whether it takes prefixes; NULL past the end. Likewise the prefixes. */
const char *unit_name(uint32_t i, int *takes_prefixes);
const char *unit_prefix(uint32_t i);

/* What one of unit i is in SI base units, for people: "kg*m/s^2", "60 s", "pi/180"; NULL for a base unit. */
const char *unit_meaning(uint32_t i, Arena *a);

/* factor * pi^pi_power */
double unit_factor(const Unit *u);

#endif
