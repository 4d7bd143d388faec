/* Reciprocals of distances cubed, 1/(x sqrt(x)), outside of loops: many are computed by one call, which makes them
 * side by side, if the compiler has vectors (lag_lanes.h); the bits are the same. */
#include "emit/cwriter_impl.h"

enum { FEWEST_CUBES = 8 }; /* fewer wait longer for memory than they gain */

/* The root in the reciprocal cube s, if it and its cube serve nothing else; 0: s is another value. */
static Slot root_of(const Prog *p, const uint32_t *uses, Slot s) {
  const Ins *i = &p->ins.at[s], *one = &p->ins.at[i->a], *cube = &p->ins.at[i->b];
  if (i->op != IR_DIV || one->op != IR_CONST || !num_is_one(one->number) || cube->op != IR_MUL) return 0;
  const Slot root = p->ins.at[cube->a].op == IR_SQRT ? cube->a : cube->b;
  const Ins *r = &p->ins.at[root];
  if (r->op != IR_SQRT || r->a != (root == cube->a ? cube->b : cube->a)) return 0;
  return uses[i->b] == 1 && uses[root] == 1 ? root : 0;
}

int ccubes_some(const Prog *p) {
  const uint32_t *uses = prog_uses(p);
  uint32_t n = 0;
  for (Slot s = 1; s < p->ins.n; s++) n += root_of(p, uses, s) != 0;
  return n >= FEWEST_CUBES;
}

/* Cubes whose roots' operands are computed before slot s, at[ins.n]; returns their number. */
static uint32_t collect(const Writer *w, Slot s, Slot *at) {
  uint32_t n = 0;
  for (Slot k = s; k < w->p->ins.n; k++) {
    const Slot root = root_of(w->p, w->uses, k), x = w->p->ins.at[root].a;
    if (!root || w->in_call[k] || cloop_contains(w, root) || cloop_contains(w, k)) continue;
    if (x < s || w->p->ins.at[x].op == IR_LOAD) at[n++] = k;
  }
  return n;
}

int ccubes_write(Writer *w, Slot s) {
  const Prog *p = w->p;
  if (!w->in_call || !w->style->turns) return 0;
  if (w->in_call[s] || p->ins.at[s].op != IR_SQRT) return w->in_call[s];
  Slot *at = ARENA_ARRAY(w->a, Slot, p->ins.n);
  const uint32_t n = collect(w, s, at);
  if (n < FEWEST_CUBES) return 0;
  const char *squares = cnames_take(&w->names, "squares"), *cubes = cnames_take(&w->names, "inv_cubes");
  StrBuf list = strbuf(w->a);
  for (uint32_t k = 0; k < n; k++) {
    const Ins *i = &p->ins.at[at[k]];
    const Slot root = root_of(p, w->uses, at[k]);
    cwriter_arrays_of(w, root);
    sb_printf(&list, "%s%s", k ? ", " : "", cwriter_operand(w, p->ins.at[root].a).text);
    w->in_call[at[k]] = w->in_call[i->b] = w->in_call[root] = 1;
    w->piece[at[k]] = (CExpr){arena_printf(w->a, "%s[%u]", cubes, k), C_ATOM, 0};
  }
  cwriter_flush_title(w);
  cwriter_line(w, arena_printf(w->a, "const LAG_REAL %s[] = {%s};", squares, sb_text(&list)));
  cwriter_line(w, arena_printf(w->a, "LAG_REAL %s[%u];", cubes, n));
  cwriter_line(w, arena_printf(w->a, "lag_inverse_cubes(%u, %s, %s);", n, squares, cubes));
  return w->in_call[s];
}
