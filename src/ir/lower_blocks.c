/* The blocks of coupled coordinates of a model's mass matrix, and the solution of M q'' = f. */
#include "ir/lower_impl.h"

static uint32_t find_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* label[i]: the first coordinate of the block that i belongs to. */
static uint32_t *label_blocks(const Eqns *e) {
  uint32_t *parent = ARENA_ARRAY(e->m->arena, uint32_t, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) parent[i] = i;
  for (uint32_t k = 0; k < e->mass.n; k++) {
    uint32_t a = find_root(parent, e->mass.at[k].row), b = find_root(parent, e->mass.at[k].col);
    if (a < b) parent[b] = a;
    else parent[a] = b;
  }
  for (uint32_t i = 0; i < e->n; i++) parent[i] = find_root(parent, i);
  return parent;
}

/* The blocks in the order of their first coordinates, filled in one pass over coordinates and entries. */
static uint32_t make_blocks(Lower *l, Block *blocks) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  const uint32_t *label = label_blocks(e);
  uint32_t n = 0, *block = ARENA_ARRAY(a, uint32_t, e->n), *place = ARENA_ARRAY(a, uint32_t, e->n);
  for (uint32_t i = 0; i < e->n; i++) {
    block[i] = label[i] == i ? n++ : block[label[i]];
    place[i] = blocks[block[i]].n++;
  }
  uint32_t **at = ARENA_ARRAY(a, uint32_t *, n);
  Slot **M = ARENA_ARRAY(a, Slot *, n), **f = ARENA_ARRAY(a, Slot *, n);
  for (uint32_t k = 0; k < n; k++) {
    Block *b = &blocks[k];
    b->of = e->n;
    b->at = at[k] = ARENA_ARRAY(a, uint32_t, b->n);
    b->f = f[k] = ARENA_ARRAY(a, Slot, b->n);
    b->M = M[k] = ARENA_ARRAY(a, Slot, (size_t)b->n * b->n);
  }
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    Block *b = &blocks[block[x->row]];
    Slot s = lower_slot(l, x->e);
    prog_name(l->p, s, block_name(b, a, "M", x->row, x->col));
    M[block[x->row]][place[x->row] * b->n + place[x->col]] = s;
  }
  for (uint32_t i = 0; i < e->n; i++) {
    Block *b = &blocks[block[i]];
    at[block[i]][place[i]] = i;
    Slot s = f[block[i]][place[i]] = lower_slot(l, e->f[i]);
    prog_name(l->p, s, block_name(b, a, "f", i, UINT32_MAX));
  }
  for (uint32_t k = 0; k < n; k++) {
    Block *b = &blocks[k];
    b->definite = b->n > 1 ? e->definite_mass : expr_sign(l->g, eqns_mass(e, b->at[0], b->at[0])) == SIGN_POSITIVE;
  }
  return n;
}

const Block *lower_blocks(Lower *l, uint32_t *n) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  Expr *roots = ARENA_ARRAY(a, Expr, e->mass.n + e->n);
  for (uint32_t k = 0; k < e->mass.n; k++) roots[k] = e->mass.at[k].e;
  for (uint32_t i = 0; i < e->n; i++) roots[e->mass.n + i] = e->f[i];
  prog_title(l->p, "mass matrix M and forces f");
  lower_roots(l, roots, e->mass.n + e->n);
  Block *blocks = ARENA_ARRAY(a, Block, e->n);
  *n = make_blocks(l, blocks);
  return blocks;
}

void lower_solution(Lower *l, Slot *acc) {
  const Eqns *e = l->e;
  if (!e->n) return;
  uint32_t n;
  const Block *blocks = lower_blocks(l, &n);
  prog_title(l->p, "M q'' = f");
  Slot *x = ARENA_ARRAY(l->p->arena, Slot, e->n);
  for (uint32_t k = 0; k < n; k++) {
    const Block *b = &blocks[k];
    Factored fac = block_factor(l->p, b, NULL);
    factor_solve(l->p, &fac, b->f, x);
    for (uint32_t i = 0; i < b->n; i++) {
      acc[b->at[i]] = x[i];
      prog_name(l->p, x[i], expr_symbol(e->g, e->m->coords.at[b->at[i]].a)->name);
    }
  }
}
