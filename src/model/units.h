/* Units as written, [kg*m/s^2]: dimension and conversion to SI. Table and sources: units.c. */
#pragma once

#include "model/dims.h"
#include "syntax/ast.h"

typedef struct {
  Dim dim;     /* DIM_ANY: no unit was written */
  Num factor;  /* x units are x*factor*pi^pi_power + offset in SI */
  int pi_power;
  Num offset;  /* 273.15 of degC; otherwise 0 */
  const char *text; /* as written; "" for none */
} Unit;

/* Converts a unit of the text; unknown names are reported, with the nearest known one. No unit written: DIM_ANY,
 * factor 1. */
Unit unit_resolve(const AstUnit *u, Dims *dims, Diags *diags, Arena *a);

/* SI unit of dimension d, written `text`. */
static inline Unit unit_si(Dim d, const char *text) {
  return (Unit){.dim = d, .factor = num_int(1), .offset = num_int(0), .text = text};
}

/* SI unit of a dimension: factor 1; text "" for unknown dimensions and pure numbers. */
Unit unit_of_dim(Dims *dims, Dim d);

/* 1 for a unit with a dimension: not an absent one, an angle, or [1]. */
int unit_measures(const AstUnit *u);

/* 1 if `name` is a unit, with or without an SI prefix. */
int unit_exists(const char *name);

/* Table of units: name i, NULL past the end; whether SI prefixes are allowed. Table of prefixes. */
const char *unit_name(uint32_t i);
int unit_takes_prefixes(uint32_t i);
const char *unit_prefix(uint32_t i);

/* Value of unit i in SI base units, for readers: "kg*m/s^2", "60 s", "pi/180"; NULL for a base unit. */
const char *unit_meaning(uint32_t i, Arena *a);

/* factor * pi^pi_power */
double unit_factor(const Unit *u);
const char *unit_factor_text(Arena *a, const Unit *u); /* in 40 digits, where it has them */
