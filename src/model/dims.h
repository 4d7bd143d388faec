/* Dimensions, and inference of those that the text does not state, from the equations.
 *
 * A Dim is a product of powers of the SI base units and of unknowns, one for each name that was declared without a
 * unit: m^2*k. Written additively it is a sparse vector of rational exponents, and every place where two things must
 * have one dimension (a sum, a comparison, a force against its coordinate) is a linear equation between two such
 * vectors. dim_equate solves them one by one, by elimination (A. Kennedy, "Dimension types", ESOP 1994,
 * doi:10.1007/3-540-57880-3_23, has exponents that are integers; here they are rationals, so that a field's linear
 * algebra is enough).
 *
 * A Dim is an index into a table without duplicates: equal dimensions have equal indices. All memory is the arena's. */
#pragma once

#include "base/intern.h"
#include "base/num.h"
#include "base/source.h"

typedef uint32_t Dim;
typedef struct Dims Dims;

enum { DIM_ANY = 0 };  /* fits every dimension: zero, or a value whose error was reported */
enum { DIM_NONE = 1 }; /* dimensionless */

typedef enum {
  DIM_LENGTH, DIM_MASS, DIM_TIME, DIM_CURRENT, DIM_TEMPERATURE, DIM_AMOUNT, DIM_LUMINOUS,
  DIM_BASES
} DimBase;

Dims *dims_new(Arena *a);

Dim dim_base(Dims *d, DimBase base);
Dim dim_mul(Dims *d, Dim a, Dim b);
Dim dim_div(Dims *d, Dim a, Dim b);
Dim dim_pow(Dims *d, Dim a, Num e);
Dim dim_per_second(Dims *d, Dim a);

/* A new unknown: the dimension of `name`, which was declared without one. They are numbered from 0. */
Dim dim_unknown(Dims *d, Name name);
uint32_t dim_unknowns(const Dims *d);

/* Adds the equation a = b. 1: it holds, or it is solved for the newest unknown in it, with `why` as the reason. 0:
 * contradiction, nothing changes. */
int dim_equate(Dims *d, Dim a, Dim b, Span why);

/* Dimension with all solved unknowns substituted: base units and unsolved unknowns only. */
Dim dim_resolved(Dims *d, Dim a);

/* 1 if an unsolved unknown remains in a dimension. */
int dim_is_open(Dims *d, Dim a);

/* Substitutes with[k] for unknown first + k, k < n; DIM_ANY where a replacement is DIM_ANY. */
Dim dim_replace(Dims *d, Dim a, uint32_t first, uint32_t n, const Dim *with);

/* A name whose dimension was inferred, and the span that decided it. */
typedef struct {
  Name name;
  Dim is;
  Span why;
} DimCause;

/* An inferred name among the unknowns of a; 0 when there is none. */
int dim_cause(const Dims *d, Dim a, DimCause *cause);

/* Exponent of a base unit in a result of dim_resolved. */
Num dim_exponent(const Dims *d, Dim a, DimBase base);

/* Spelling of a dimension for messages, as the model's author wrote it: "N/m". The first one counts. */
void dim_spell(Dims *d, Dim a, const char *text);

/* Name of an unsolved unknown in a dimension; NULL when there is none, or it has no name. */
Name dim_open_name(Dims *d, Dim a);

/* The dimension as a product of powers of base units, "kg*m/s^2"; "" if dimensionless. */
const char *dim_product_text(Dims *d, Dim a);

/* Text of a dimension: "J", the author's spelling, "m/s^2"; "1" if dimensionless; "m*unit(k)" with an unknown. */
const char *dim_text(Dims *d, Dim a);
