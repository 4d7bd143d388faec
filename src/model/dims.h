/* Dimensions, and what the equations of a model tell of those that nobody wrote down.
 *
 * A Dim is a product of powers of the SI base units and of unknowns, one for each name that was declared
 * without a unit: m^2*k. Written additively it is a sparse vector of rational exponents, and every place
 * where two things must have one dimension (a sum, a comparison, a force against its coordinate) is a linear
 * equation between two such vectors. dim_equate solves them one by one, by elimination (A. Kennedy,
 * "Dimension types", ESOP 1994, doi:10.1007/3-540-57880-3_23, has exponents that are integers; here they are
 * rationals, so that a field's linear algebra is enough).
 *
 * Dims are numbers of entries in a table, equal where the vectors are equal. All memory is the arena's. */
#ifndef LAGC_DIMS_H
#define LAGC_DIMS_H

#include "base/intern.h"
#include "base/num.h"
#include "base/source.h"

typedef uint32_t Dim;
typedef struct Dims Dims;

enum { DIM_ANY = 0 };  /* of what has no dimension of its own (zero), or whose error was reported: fits everything */
enum { DIM_NONE = 1 }; /* dimensionless */

typedef enum { DIM_LENGTH, DIM_MASS, DIM_TIME, DIM_CURRENT, DIM_TEMPERATURE, DIM_AMOUNT, DIM_LUMINOUS, DIM_BASES } DimBase;

Dims *dims_new(Arena *a);

Dim dim_base(Dims *d, DimBase base);
Dim dim_mul(Dims *d, Dim a, Dim b);
Dim dim_div(Dims *d, Dim a, Dim b);
Dim dim_pow(Dims *d, Dim a, Num e);
Dim dim_per_second(Dims *d, Dim a);

/* A new unknown: the dimension of `name`, which was declared without one. They are numbered from 0. */
Dim dim_unknown(Dims *d, Name name);
uint32_t dim_unknowns(const Dims *d);

/* a and b are one dimension: 1 when they are, or when an unknown can be chosen so; the newest one that
 * occurs is then, because of what stands at `why`. 0 when they contradict each other. */
int dim_equate(Dims *d, Dim a, Dim b, Span why);

/* How much has been found out; and forgets what was found out since. */
uint32_t dims_mark(const Dims *d);
void dims_undo(Dims *d, uint32_t mark);

/* The same dimension in terms of base units and of what is still unknown. */
Dim dim_found(Dims *d, Dim a);

/* Whether an unknown is left in it. */
int dim_is_open(Dims *d, Dim a);

/* The dimension with unknowns first .. first + n - 1 replaced; DIM_ANY where one of them becomes DIM_ANY. */
Dim dim_replace(Dims *d, Dim a, uint32_t first, uint32_t n, const Dim *with);

/* The dimension of unknown u alone, still unknown or not. */
Dim dim_of_unknown(Dims *d, uint32_t u);

/* A name whose dimension was found, and where. */
typedef struct {
  Name name;
  Dim is;
  Span why;
} DimCause;

/* Such a name among those that occur in `a`; 0 when there is none. */
int dim_cause(const Dims *d, Dim a, DimCause *cause);

/* The exponent of a base unit, after dim_found. */
Num dim_exponent(const Dims *d, Dim a, DimBase base);

/* Messages spell this dimension so: [N/m], where a model's author wrote it. The first spelling counts. */
void dim_spell(Dims *d, Dim a, const char *text);

/* A name of what is unknown in it; NULL when nothing is, or when it has none. */
Name dim_open_name(Dims *d, Dim a);

/* "m/s^2", "J", as the model's author spells it; "1" when dimensionless; "m*unit(k)" where it is open. */
const char *dim_text(Dims *d, Dim a);

#endif
