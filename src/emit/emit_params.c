/* Parameters in an emitted model: the values of a scene, and the derived parameters computed once. */
#include "emit/emit_impl.h"

void emit_derive(const File *f) {
  static const char *const own[] = {"p", NULL}, *const written[] = {"p"};
  if (!f->u->nderived) return;
  CStyle st = emit_style(f, own, written);
  st.apart = st.prefer_short_code = 1;
  CFunction c = {.comment = arena_printf(f->a, "Derived parameters, for the functions below: %s.", op_count_text(f->u->derived, f->a)),
                 .head = "static void derive(LAG_REAL *p)"};
  cfunction(f->u->derived, &st, &c, f->out);
}

/* Whether the parameter of p is a constant equal to that of `like`. */
static int is_number_like(const Prog *p, const Prog *like) {
  if (p->stores.n != 1 || like->stores.n != 1) return 0;
  const Ins *x = &p->ins.at[p->stores.at[0].slot], *y = &like->ins.at[like->stores.at[0].slot];
  return p->stores.at[0].slot && like->stores.at[0].slot && x->op == IR_CONST && y->op == IR_CONST && num_equal(x->number, y->number);
}

/* Number of parameters from i on with one constant value if at least 16; otherwise 1. */
static uint32_t same_params(const IrUnit *u, const IrScene *s, uint32_t i) {
  enum { MANY = 16 };
  uint32_t n = 1;
  while (i + n < u->p.n && is_number_like(s->params[i + n], s->params[i])) n++;
  return n >= MANY ? n : 1;
}

/* Function params_ID: parameters in order, as each formula may use the parameters before it. */
void emit_params(const File *f, const IrScene *s, const char *id) {
  static const char *const own[] = {"p", "fixed", NULL}, *const written[] = {"p"};
  sb_printf(f->out, "\nstatic void params_%s(LAG_REAL *p, const unsigned char *fixed) {\n", id);
  if (!f->u->p.n) sb_puts(f->out, "  (void)p; (void)fixed;\n");
  for (uint32_t i = 0, same; i < f->u->p.n; i += same) {
    same = same_params(f->u, s, i);
    if (same > 1) {
      const Prog *p = s->params[i];
      sb_printf(f->out, "  for (int k = 0; k < %u; k++) /* %s ... %s */\n    if (!fixed[k + %u]) p[k + %u] = %s;\n", same,
                comment_text(f->a, f->u->p.at[i].name), comment_text(f->a, f->u->p.at[i + same - 1].name), i, i,
                c_number(f->a, "LAG", p->ins.at[p->stores.at[0].slot].number));
      continue;
    }
    CStyle st = emit_style(f, own, written);
    st.loads_inline = 1;
    StrBuf body = strbuf(f->a);
    cwrite_body(s->params[i], &st, f->a, &body);
    cwrite_guarded(arena_printf(f->a, "if (!fixed[%u]) ", i), sb_text(&body), f->out);
  }
  sb_puts(f->out, f->u->nderived ? "  derive(p);\n}\n" : "}\n");
}
