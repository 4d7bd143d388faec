/* Dimensions as interned sparse vectors of rational exponents; unknowns by Gaussian elimination. Contract and
 * source: dims.h. */
#include "model/dims.h"

#include <string.h>

#include "base/hash.h"
#include "base/id_table.h"
#include "base/vec.h"

/* Power in a product. key < DIM_BASES: a base unit; otherwise unknown key - DIM_BASES. */
typedef struct {
  uint32_t key;
  Num e; /* never 0 */
} DimPower;

typedef struct {
  const DimPower *part; /* by increasing key */
  uint32_t n;
  Dim found;             /* memo of dim_resolved, valid while Dims.time is found_when; 0: none */
  uint32_t found_when;
} DimVector;

typedef struct {
  Name name;
  Dim is; /* its solution, in older unknowns; 0: unsolved */
  Span why;
} Unknown;

typedef struct {
  Dim dim;
  const char *text;
} Spelling;

struct Dims {
  Arena *arena;
  VEC(DimVector) forms; /* 0 is DIM_ANY */
  VEC(Unknown) unknowns;
  VEC(DimPower) scratch;
  VEC(Spelling) spellings;
  uint32_t time;        /* incremented when an unknown is solved */
  IdTable table;        /* of `forms` */
};

static uint32_t hash_parts(const DimPower *p, uint32_t n) {
  uint32_t h = n;
  for (uint32_t i = 0; i < n; i++)
    h = hash_mix(hash_mix(hash_mix(h, p[i].key), (uint32_t)p[i].e.num), (uint32_t)p[i].e.den);
  return h;
}

static int same_parts(const DimVector *f, const DimPower *p, uint32_t n) {
  if (f->n != n) return 0;
  for (uint32_t i = 0; i < n; i++)
    if (f->part[i].key != p[i].key || !num_equal(f->part[i].e, p[i].e)) return 0;
  return 1;
}

/* Interns the vector in d->scratch, and empties it. */
static Dim intern_scratch(Dims *d) {
  uint32_t n = d->scratch.n, hash = hash_parts(d->scratch.at, n), slot = idtable_start(&d->table, hash);
  d->scratch.n = 0;
  for (Dim i; idtable_next(&d->table, hash, &slot, &i);)
    if (same_parts(&d->forms.at[i], d->scratch.at, n)) return i;
  DimPower *copy = ARENA_ARRAY(d->arena, DimPower, n + 1);
  if (n) memcpy(copy, d->scratch.at, n * sizeof *copy);
  DimVector f = {.part = copy, .n = n};
  vec_push(d->arena, &d->forms, f);
  idtable_add(&d->table, hash, d->forms.n - 1);
  return d->forms.n - 1;
}

Dims *dims_new(Arena *a) {
  Dims *d = ARENA_NEW(a, Dims);
  d->arena = a;
  d->table = idtable(a, 0);
  vec_push(a, &d->forms, (DimVector){0});
  intern_scratch(d); /* DIM_NONE */
  return d;
}

static Dim of_key(Dims *d, uint32_t key) {
  vec_push(d->arena, &d->scratch, ((DimPower){key, num_int(1)}));
  return intern_scratch(d);
}

Dim dim_base(Dims *d, DimBase base) { return of_key(d, base); }
/* Dimension that consists of unknown u alone. */
static Dim dim_of_unknown(Dims *d, uint32_t u) { return of_key(d, u + DIM_BASES); }
uint32_t dim_unknowns(const Dims *d) { return d->unknowns.n; }

Dim dim_unknown(Dims *d, Name name) {
  vec_push(d->arena, &d->unknowns, ((Unknown){.name = name}));
  return dim_of_unknown(d, d->unknowns.n - 1);
}

static void put(Dims *d, uint32_t key, Num e) {
  if (!num_is_zero(e)) vec_push(d->arena, &d->scratch, ((DimPower){key, e}));
}

/* Interned a * b^e. */
static Dim combine(Dims *d, Dim a, Dim b, Num e) {
  if (a == DIM_ANY || b == DIM_ANY) return DIM_ANY;
  const DimVector *f = &d->forms.at[a], *g = &d->forms.at[b];
  uint32_t i = 0, k = 0;
  while (i < f->n || k < g->n) {
    uint32_t x = i < f->n ? f->part[i].key : UINT32_MAX, y = k < g->n ? g->part[k].key : UINT32_MAX;
    Num left = x <= y ? f->part[i++].e : num_int(0), right = y <= x ? num_mul(g->part[k++].e, e) : num_int(0);
    put(d, x < y ? x : y, num_add(left, right));
  }
  return intern_scratch(d);
}

Dim dim_mul(Dims *d, Dim a, Dim b) {
  if (a == DIM_NONE) return b;
  if (b == DIM_NONE) return a;
  return combine(d, a, b, num_int(1));
}

Dim dim_div(Dims *d, Dim a, Dim b) {
  if (b == DIM_NONE) return a;
  return a == b && a != DIM_ANY ? DIM_NONE : combine(d, a, b, num_int(-1));
}

Dim dim_pow(Dims *d, Dim a, Num e) {
  return a == DIM_ANY || num_is_zero(e) ? (a ? DIM_NONE : DIM_ANY) : combine(d, DIM_NONE, a, e);
}

Dim dim_per_second(Dims *d, Dim a) { return dim_div(d, a, dim_base(d, DIM_TIME)); }

/* --- unknowns --- */

/* Last power of a solved unknown, or NULL. */
static const DimPower *solved_part(const Dims *d, Dim a) {
  const DimVector *f = &d->forms.at[a];
  for (uint32_t i = f->n; i-- > 0 && f->part[i].key >= DIM_BASES;)
    if (d->unknowns.at[f->part[i].key - DIM_BASES].is) return &f->part[i];
  return NULL;
}

/* a with `is` in place of the unknown whose power in it is p. */
static Dim put_for_unknown(Dims *d, Dim a, DimPower p, Dim is) {
  Dim without = combine(d, a, of_key(d, p.key), num_neg(p.e));
  return combine(d, without, is, p.e);
}

/* Terminates: the solution of an unknown contains older unknowns only (the pivot is the newest one). */
Dim dim_resolved(Dims *d, Dim a) {
  if (d->forms.at[a].found && d->forms.at[a].found_when == d->time) return d->forms.at[a].found;
  Dim r = a;
  for (const DimPower *p = solved_part(d, r); p; p = solved_part(d, r))
    r = put_for_unknown(d, r, *p, d->unknowns.at[p->key - DIM_BASES].is);
  d->forms.at[a].found = r;
  d->forms.at[a].found_when = d->time;
  return r;
}

static const DimPower *last_part(const Dims *d, Dim a) {
  return d->forms.at[a].n ? &d->forms.at[a].part[d->forms.at[a].n - 1] : NULL;
}

int dim_is_open(Dims *d, Dim a) {
  const DimPower *last = last_part(d, dim_resolved(d, a));
  return last && last->key >= DIM_BASES;
}

Name dim_open_name(Dims *d, Dim a) {
  const DimPower *last = last_part(d, dim_resolved(d, a));
  return last && last->key >= DIM_BASES ? d->unknowns.at[last->key - DIM_BASES].name : NULL;
}

int dim_equate(Dims *d, Dim a, Dim b, Span why) {
  if (a == b || a == DIM_ANY || b == DIM_ANY) return 1;
  Dim difference = dim_resolved(d, dim_div(d, a, b));
  const DimPower *pivot = last_part(d, difference);
  if (!pivot) return 1;
  if (pivot->key < DIM_BASES) return 0;
  uint32_t key = pivot->key;
  Num e = pivot->e;
  Dim rest = combine(d, difference, of_key(d, key), num_neg(e));
  Dim is = dim_pow(d, rest, num_div(num_int(-1), e));
  d->unknowns.at[key - DIM_BASES].is = is;
  d->unknowns.at[key - DIM_BASES].why = why;
  d->time++;
  return 1;
}

/* A power of unknown first .. first + n - 1, or NULL. */
static const DimPower *part_between(const Dims *d, Dim a, uint32_t first, uint32_t n) {
  const DimVector *f = &d->forms.at[a];
  for (uint32_t i = 0; i < f->n; i++)
    if (f->part[i].key >= first + DIM_BASES && f->part[i].key < first + n + DIM_BASES) return &f->part[i];
  return NULL;
}

/* Solved unknowns are replaced by their solutions first. Terminates, as those contain older unknowns only. */
Dim dim_replace(Dims *d, Dim a, uint32_t first, uint32_t n, const Dim *with) {
  Dim r = a;
  for (const DimPower *p = part_between(d, r, first, n); p; p = part_between(d, r, first, n)) {
    uint32_t u = p->key - DIM_BASES;
    r = put_for_unknown(d, r, *p, d->unknowns.at[u].is ? d->unknowns.at[u].is : with[u - first]);
  }
  return r;
}

int dim_cause(const Dims *d, Dim a, DimCause *cause) {
  const DimVector *f = &d->forms.at[a];
  for (uint32_t i = 0; i < f->n; i++) {
    if (f->part[i].key < DIM_BASES) continue;
    const Unknown *u = &d->unknowns.at[f->part[i].key - DIM_BASES];
    if (!u->is || !u->name) continue;
    *cause = (DimCause){u->name, u->is, u->why};
    return 1;
  }
  return 0;
}

Num dim_exponent(const Dims *d, Dim a, DimBase base) {
  const DimVector *f = &d->forms.at[a];
  for (uint32_t i = 0; i < f->n; i++)
    if (f->part[i].key == base) return f->part[i].e;
  return num_int(0);
}

/* --- as text --- */

void dim_spell(Dims *d, Dim a, const char *text) {
  for (uint32_t i = 0; i < d->spellings.n; i++)
    if (d->spellings.at[i].dim == a) return;
  vec_push(d->arena, &d->spellings, ((Spelling){a, text}));
}

/* Name of a derived SI unit with this dimension (exponents of m, kg, s, A), or NULL. */
static const char *derived_name(const Dims *d, Dim a) {
  static const struct {
    const char *name;
    int8_t e[4];
  } derived[] = {{"N", {1, 1, -2}},   {"J", {2, 1, -2}},   {"W", {2, 1, -3}},
                 {"Pa", {-1, 1, -2}}, {"C", {0, 0, 1, 1}}, {"V", {2, 1, -3, -1}}};
  for (size_t i = 0; i < sizeof derived / sizeof *derived; i++) {
    int same = 1;
    for (int k = 0; k < DIM_BASES && same; k++)
      same = num_equal(dim_exponent(d, a, (DimBase)k), num_int(k < 4 ? derived[i].e[k] : 0));
    if (same && last_part(d, a)->key < DIM_BASES) return derived[i].name;
  }
  return NULL;
}

static void put_power(StrBuf *b, const char *name, Num e) {
  sb_puts(b, name);
  if (num_is_one(e)) return;
  sb_puts(b, num_is_int(e) ? "^" : "^(");
  num_print(b, e);
  if (!num_is_int(e)) sb_putc(b, ')');
}

/* Power i in writing order: kg before m. */
static DimPower part_in_order(const DimVector *f, uint32_t i) {
  if (i < 2 && f->n > 1 && f->part[0].key == DIM_LENGTH && f->part[1].key == DIM_MASS) return f->part[1 - i];
  return f->part[i];
}

static const char *key_name(const Dims *d, uint32_t key) {
  static const char *const base[DIM_BASES] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  if (key < DIM_BASES) return base[key];
  Name name = d->unknowns.at[key - DIM_BASES].name;
  return name ? arena_printf(d->arena, "unit(%s)", name) : "?";
}

/* Product of powers, kg before m, each divisor behind a `/`. */
const char *dim_product_text(Dims *d, Dim a) {
  StrBuf b = strbuf(d->arena);
  const DimVector f = d->forms.at[a];
  for (int sign = 1; sign >= -1; sign -= 2)
    for (uint32_t i = 0; i < f.n; i++) {
      DimPower p = part_in_order(&f, i);
      if (num_sign(p.e) != sign) continue;
      if (sign < 0) sb_puts(&b, b.n ? "/" : "1/");
      else if (b.n) sb_putc(&b, '*');
      put_power(&b, key_name(d, p.key), sign < 0 ? num_neg(p.e) : p.e);
    }
  return sb_text(&b);
}

const char *dim_text(Dims *d, Dim a) {
  if (a == DIM_ANY) return "?";
  a = dim_resolved(d, a);
  if (a == DIM_NONE) return "1";
  const char *name = derived_name(d, a);
  if (name) return name;
  for (uint32_t i = 0; i < d->spellings.n; i++)
    if (d->spellings.at[i].dim == a) return d->spellings.at[i].text;
  return dim_product_text(d, a);
}
