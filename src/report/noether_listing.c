/* `lagc noether` as text and as LaTeX. */
#include "symmetry/noether_report.h"
#include "base/words.h"
#include "symmetry/charges.h"
#include "sym/family_rows.h"
#include "report/listing_text.h"

typedef struct {
  Text text;
  const NoetherReport *r;
  const char *Q; /* letter of the charges Q1, Q2, ..; another where the model has such names */
} Page;

/* Whether x is `letter` followed by digits. */
static int is_numbered(const char *x, const char *letter) {
  size_t n = strlen(letter);
  return strncmp(x, letter, n) == 0 && x[n] && x[n + strspn(x + n, "0123456789")] == '\0';
}

static int takes_names(const Eqns *e, const char *letter) {
  const ExprGraph *g = e->g;
  for (SymId k = 1; k <= expr_symbol_count(g); k++)
    if (is_numbered(expr_symbol(g, k)->name, letter)) return 1;
  for (Expr x = 1; x <= expr_count(g); x++)
    if (expr_op(g, x) == EX_DEF && is_numbered(expr_def_name(g, x), letter)) return 1;
  for (uint32_t k = 0; k < e->m->symmetries.n; k++)
    if (is_numbered(e->m->symmetries.at[k].name, letter)) return 1;
  return 0;
}

/* The first letter without such names in the model. */
static const char *free_letter(const Eqns *e) {
  static const char *const letters[] = {"Q", "C", "J", "charge"};
  enum { N = sizeof letters / sizeof *letters };
  uint32_t k = 0;
  while (k + 1 < N && takes_names(e, letters[k])) k++;
  return letters[k];
}

/* Q1, dQ1/dt */
static const char *named(const Page *p, const char *before, uint32_t k, const char *after) {
  return arena_printf(p->text.e->m->arena, "%s%s%u%s", before, p->Q, k + 1, after);
}

static const char *named_latex(const Page *p, uint32_t k, int dot) {
  const char *letter = strlen(p->Q) > 1 ? arena_printf(p->text.e->m->arena, "\\mathrm{%s}", p->Q) : p->Q;
  return arena_printf(p->text.e->m->arena, dot ? "\\dot{%s}_{%u}" : "%s_{%u}", letter, k + 1);
}

/* A line of prose; in LaTeX a comment. */
static void __attribute__((format(printf, 2, 3))) say(Page *p, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  const char *words = arena_vprintf(p->text.e->m->arena, fmt, ap);
  va_end(ap);
  sb_printf(p->text.out, "%s%s\n", text_latex(&p->text) ? "% " : "", words);
}

/* --- symmetries --- */

static void put_delta(Page *p, Name name, Expr x) {
  Text *t = &p->text;
  Arena *a = t->e->m->arena;
  if (!expr_is_zero(t->g, x))
    text_named(t, arena_printf(a, "delta %s", name), arena_printf(a, "\\delta %s", text_latex_name(t, name)), x, 0);
}

/* "  for k > 0" */
static void put_conditions(Page *p, uint32_t k) {
  Text *t = &p->text;
  Conditions all = noether_conditions(p->r, k);
  StrBuf b = strbuf(t->e->m->arena);
  for (uint32_t i = 0; i < all.n; i++) {
    sb_puts(&b, i ? ", " : "  for ");
    expr_print(t->g, all.at[i], PRINT_TEXT, &b);
    sb_puts(&b, " > 0");
  }
  if (all.n) say(p, "%s", sb_text(&b));
}

/* Changes of the coordinates and of time. */
static void deltas(Page *p, const FoundSymmetry *s) {
  const Text *t = &p->text;
  for (uint32_t i = 0; i < eqns_coordinates(t->e); i++)
    put_delta(p, expr_symbol(t->g, eqns_coordinate(t->e, i))->name, s->by.xi[i]);
  put_delta(p, "t", s->by.tau);
}

static void symmetry(Page *p, uint32_t k) {
  Text *t = &p->text;
  Arena *a = t->e->m->arena;
  const FoundSymmetry *s = &p->r->found.all.at[k];
  int moves = s->is.drift != PROVED_ZERO && !s->is.power_unknown;
  Name declared = noether_declared(p->r, k);
  text_heading(t, arena_printf(a, "%s: %s%s%s%s", named(p, "", k, ""), s->name, declared ? "; declared as " : "",
                               declared ? declared : "", s->is.jumps ? "; between jumps of L only" : ""));
  deltas(p, s);
  if (!expr_is_zero(t->g, s->is.F)) text_named(t, "F", "F", s->is.F, 0);
  if (s->is.over_time) say(p, "  F also contains the integral over t of dQ/dt below");
  text_named(t, named(p, "", k, ""), named_latex(p, k, 0), s->is.charge, !moves);
  if (moves) text_named(t, named(p, "d", k, "/dt"), named_latex(p, k, 1), s->is.power, 1);
  text_end(t);
  put_conditions(p, k);
  if (s->is.drift != NOT_DECIDED) return;
  say(p, s->is.power_unknown
             ? "  not decided whether it changes: L depends on an input whose rate of change is not known"
         : s->is.open_integral == 3
             ? "  not decided whether it changes: forces couple many coordinates, and no potential of theirs is "
               "looked for"
         : s->is.open_integral
             ? "  not decided whether it changes: forces that have a potential change it by its rate"
             : "  not decided whether it changes: this rate is neither proved to be 0 nor seen not to be");
}

static int some_jump(const FoundSymmetries *f) {
  int some = 0;
  for (uint32_t k = 0; k < f->all.n; k++) some |= f->all.at[k].is.jumps;
  return some;
}

static void symmetries(Page *p) {
  const FoundSymmetries *f = &p->r->found;
  Arena *a = p->text.e->m->arena;
  sb_putc(p->text.out, '\n');
  say(p, "looked for: %s", f->ansatz);
  if (!f->searched) {
    say(p, "not searched: %s", f->note);
    return;
  }
  if (!f->all.n) say(p, "found: none");
  else
    say(p, "found: %u symmetr%s, each proved%s; %s = p.delta q - E delta t - F", f->all.n, f->all.n == 1 ? "y" : "ies",
        some_jump(f) ? ", some between jumps of L only" : "", p->Q);
  if (f->unproved)
    say(p, "%u more direction%s of the solution space not written in closed form, or not proved: not listed",
        f->unproved, plural(f->unproved));
  if (f->note) say(p, "%s", f->note);
  if (f->galilean) say(p, "the ten charges of the Galilei group are among them");
  for (uint32_t k = 0; k < f->all.n; k++) symmetry(p, k);
  Expr *roots = ARENA_ARRAY(a, Expr, 3 * (size_t)f->all.n + 1);
  for (uint32_t k = 0; k < f->all.n; k++) {
    const Noether *is = &f->all.at[k].is;
    roots[3 * k] = is->charge, roots[3 * k + 1] = is->F, roots[3 * k + 2] = is->power;
  }
  text_definitions(&p->text, roots, 3 * f->all.n);
}

/* --- scaling --- */

/* s, s^2, s^(-1), s^(3/2). */
static const char *power_text(Page *p, Num power) {
  StrBuf b = strbuf(p->text.e->m->arena);
  int bare = num_is_int(power) && num_sign(power) > 0;
  if (num_is_one(power)) return "s";
  sb_puts(&b, bare ? "s^" : "s^(");
  num_print(&b, power);
  sb_puts(&b, bare ? "" : ")");
  return sb_text(&b);
}

static void scaling(Page *p) {
  const NoetherReport *r = p->r;
  Text *t = &p->text;
  StrBuf b = strbuf(t->e->m->arena), lines = strbuf(t->e->m->arena);
  if (!r->scales) return;
  sb_putc(t->out, '\n');
  sb_puts(&b, "scaling:");
  for (uint32_t i = 0; i <= t->e->n; i++) {
    Num power = i < t->e->n ? r->scaling.alpha[i] : r->scaling.beta;
    Name x = i < t->e->n ? t->e->m->coords.at[i].name : "t";
    if (num_is_zero(power)) continue;
    sb_printf(&lines, "%s -> %s*%s\n", x, power_text(p, power), x);
  }
  const char *line = family_rows(t->e->m->arena, sb_text(&lines), PRINT_TEXT);
  for (size_t n; (n = strcspn(line, "\n")) > 0; line += n + 1)
    sb_printf(&b, "%s %.*s", b.n > sizeof "scaling:" ? "," : "", (int)n, line);
  sb_printf(&b,
            " maps solutions to solutions; it multiplies the action by %s, so it is no symmetry in Noether's sense and "
            "has no charge",
            power_text(p, r->scaling.kappa));
  say(p, "%s", sb_text(&b));
}

/* --- the algebra --- */

static Expr charge_symbol(Page *p, uint32_t k) {
  Text *t = &p->text;
  SymId s = expr_declare(t->g, SYM_LOCAL, k, named(p, "", k, ""), SIGN_UNKNOWN);
  return expr_symbol(t->g, s)->node;
}

static Expr combination(const NoetherReport *r, const Bracket *k, const Expr *charge) {
  ExprGraph *g = r->e->g;
  Expr sum = k->constant;
  for (uint32_t i = 0; i < r->algebra.n; i++) sum = expr_add(g, sum, expr_mul(g, k->c[i], charge[i]));
  return sum;
}

static void bracket(Page *p, const Bracket *k, const Expr *charge, int last) {
  Text *t = &p->text;
  Arena *a = t->e->m->arena;
  Expr value = k->c ? combination(p->r, k, charge) : k->value;
  const char *text = arena_printf(a, "{%s, %s}", named(p, "", k->a, ""), named(p, "", k->b, ""));
  const char *tex = arena_printf(a, "\\{%s, %s\\}", named_latex(p, k->a, 0), named_latex(p, k->b, 0));
  text_named(t, text, tex, value, last);
}

static void algebra(Page *p) {
  const Algebra *x = &p->r->algebra;
  Arena *a = p->text.e->m->arena;
  Expr *charge = ARENA_ARRAY(a, Expr, x->n + 1);
  if (x->n < 2) return;
  if (x->why_not) {
    sb_putc(p->text.out, '\n');
    say(p, "no Poisson brackets: %s", x->why_not);
    return;
  }
  for (uint32_t k = 0; k < x->n; k++) charge[k] = charge_symbol(p, k);
  uint32_t pairs = x->n * (x->n - 1) / 2, zero = pairs - x->all.n, open = 0, outside = 0;
  if (x->all.n) text_heading(&p->text, "Poisson brackets");
  else sb_putc(p->text.out, '\n');
  for (uint32_t k = 0; k < x->all.n; k++) bracket(p, &x->all.at[k], charge, k + 1 == x->all.n);
  if (x->all.n) text_end(&p->text);
  for (uint32_t k = 0; k < x->all.n; k++) {
    open += !x->all.at[k].c && !x->all.at[k].is_outside;
    outside += !x->all.at[k].c && x->all.at[k].is_outside;
  }
  if (outside) say(p, "  %u of them %s no combination of these charges", outside, outside == 1 ? "is" : "are");
  if (open)
    say(p, "  %u of them %s of these charges with coefficients that were not recognised", open,
        open == 1 ? "is a combination" : "are combinations");
  const char *rest = !x->all.n ? "all Poisson brackets are 0: " : zero ? "the others are 0: " : "";
  if (!x->by_value) say(p, "  %sall proved", rest);
  else say(p, "  %s%u of %u proved, all checked at random states", rest, pairs - x->by_value, pairs);
}

/* --- effects --- */

static int is_broken(const EffectVerdict *v, const Noether *is, const Noether *before) {
  if (!is->charge) return 1;
  return is->power_unknown || (is->jumps && !before->jumps) || !expr_is_zero(v->e->g, is->power) ||
         (is->is != INVARIANT && is->is != INVARIANT_UP_TO_F);
}

/* The charge whose rate follows, where L or F of the effect changes it. */
static void other_charge(Page *p, const EffectVerdict *v, Text *of, uint32_t k) {
  if (!noether_same_charge(p->r, v, k)) text_named(of, named(p, "", k, ""), named_latex(p, k, 0), v->is[k].charge, 0);
}

/* Remark on impacts or events that the effect adds to the model. */
static void impacts(Page *p, const EffectVerdict *v) {
  const char *note = noether_note_on_impacts(v->e->m);
  if (note && !noether_note_on_impacts(p->text.e->m)) say(p, "  its %s", note);
}

static void effect(Page *p, const EffectVerdict *v) {
  Text of = {.e = v->e, .g = v->e->g, .style = p->text.style, .out = p->text.out};
  Arena *a = v->e->m->arena;
  uint32_t n = p->r->found.all.n, broken = 0, shown = 0;
  for (uint32_t k = 0; k < n; k++) broken += (uint32_t)is_broken(v, &v->is[k], &p->r->found.all.at[k].is);
  if (!broken) {
    sb_putc(p->text.out, '\n');
    say(p, "effect %s breaks none of them", v->effect);
    impacts(p, v);
    return;
  }
  text_heading(&of, arena_printf(a, "effect %s breaks %u of %u", v->effect, broken, n));
  for (uint32_t k = 0; k < n; k++) {
    const Noether *is = &v->is[k];
    if (!is_broken(v, is, &p->r->found.all.at[k].is)) continue;
    int last = ++shown == broken;
    if (is->charge) other_charge(p, v, &of, k);
    if (is->charge && is->jumps) say(p, "  %s, between jumps of L only:", named(p, "", k, ""));
    if (is->charge && !is->power_unknown)
      text_named(&of, named(p, "d", k, "/dt"), named_latex(p, k, 1), is->power, last);
    else
      sb_printf(of.out, text_latex(&of) ? "  %s &\\text{ is not known}\n" : "  %s is not known\n",
                text_latex(&of) ? named_latex(p, k, 1) : named(p, "d", k, "/dt"));
  }
  text_end(&of);
  impacts(p, v);
}

/* --- charges of higher degree in the momenta --- */

static void polynomial_charges(Page *p) {
  const PolynomialCharges *f = p->r->polynomial;
  Text *t = &p->text;
  Arena *a = t->e->m->arena;
  if (!f) return;
  sb_putc(t->out, '\n');
  for (uint32_t k = 0; k < f->ansatz.n; k++) say(p, "looked for: %s", f->ansatz.at[k]);
  if (f->why_not) say(p, "not searched to degree %u in the momenta: %s", f->degree, f->why_not);
  if (f->ansatz.n && f->all.n)
    say(p, "found: %u charge%s, each proved, beside products of charges", f->all.n, plural(f->all.n));
  else if (f->ansatz.n)
    say(p, f->unproved || f->doubtful || !p->r->found.all.n ? "found: none"
                                                            : "found: none but products of the charges above");
  if (f->unproved)
    say(p, "%u more candidate%s not written in closed form, or not proved: not listed", f->unproved,
        plural(f->unproved));
  if (f->doubtful) say(p, "  a rank was not certain: there may be more");
  Expr *roots = ARENA_ARRAY(a, Expr, f->all.n + 1);
  for (uint32_t k = 0; k < f->all.n; k++) {
    uint32_t number = p->r->found.all.n + k;
    text_heading(t, arena_printf(a, "%s: of degree %u in the momenta", named(p, "", number, ""), f->all.at[k].degree));
    text_named(t, named(p, "", number, ""), named_latex(p, number, 0), roots[k] = f->all.at[k].charge, 1);
    text_end(t);
  }
  text_definitions(t, roots, f->all.n);
}

/* --- charges in involution --- */

/* Q3, Q2^2 + Q3^2 + Q4^2, or the declared name; NULL: it has none. */
static const char *charge_name(const Page *p, const InvolutionCharge *x) {
  if (x->kind == INVOLUTION_LISTED) return named(p, "", x->number, "");
  if (x->kind == INVOLUTION_DECLARED) return x->name;
  return arena_printf(p->text.e->m->arena, "%s^2 + %s^2 + %s^2", named(p, "", x->of[0], ""), named(p, "", x->of[1], ""),
                      named(p, "", x->of[2], ""));
}

static const char *charge_names_text(const Page *p, const Involution *v) {
  StrBuf b = strbuf(p->text.e->m->arena);
  for (uint32_t k = 0; k < v->all.n; k++) {
    const char *name = charge_name(p, &v->all.at[k]);
    if (k) sb_puts(&b, ", ");
    if (name) sb_puts(&b, name);
    else expr_print(p->text.g, v->all.at[k].charge, PRINT_TEXT, &b);
  }
  return sb_text(&b);
}

/* Where further charges might be. */
static const char *not_looked_for(const Page *p) {
  const PolynomialCharges *f = p->r->polynomial;
  if (!f || f->why_not)
    return f ? "higher degrees in the momenta were not searched"
             : "higher degrees in the momenta were not searched: --degree 2, 3, 4";
  return arena_printf(p->text.e->m->arena,
                      "none is left within the coefficients above up to degree %u in the momenta; others may exist",
                      f->degree);
}

static void involution(Page *p) {
  const Involution *v = p->r->involution;
  if (!v) return;
  sb_putc(p->text.out, '\n');
  if (v->why_not) {
    say(p, "no charges in involution: %s", v->why_not);
    return;
  }
  say(p,
      v->all.n == v->n ? "in involution: %s%s%u of %u: Liouville-integrable"
                       : "in involution: %s%s%u of the %u that integrability needs",
      charge_names_text(p, v), v->all.n ? ": " : "", v->all.n, v->n);
  if (v->all.n > 1) say(p, "  all their Poisson brackets are 0, proved");
  say(p, "  %u independent charge%s in all, by the rank of gradients at random states%s", v->independent,
      plural(v->independent),
      v->all.n == v->n && v->independent > v->n
          ? v->independent == 2 * v->n - 1 ? ": maximally superintegrable" : ": superintegrable"
          : "");
  if (v->all.n == v->n) return;
  say(p, "  %s", not_looked_for(p));
  if (v->steps || v->stopped)
    say(p, "  the search for sets ended after %u tries%s%s: there may be a larger one", v->steps,
        v->stopped ? ", as " : "", v->stopped ? v->stopped : "");
  if (v->left_out) say(p, "  %u further charges were not looked at: there may be a larger set", v->left_out);
}

/* --- the page --- */

void show_noether(const NoetherReport *r, PrintStyle style, StrBuf *out) {
  Page p = {.text = {.e = r->e, .g = r->e->g, .style = style, .out = out}, .r = r, .Q = free_letter(r->e)};
  text_title(&p.text);
  text_charges(&p.text);
  sb_putc(out, '\n');
  if (r->e->ncharges) say(&p, "%s", charges_energy_text(r->e));
  show_cyclic(r->e, text_latex(&p.text) ? "% " : "", out);
  symmetries(&p);
  scaling(&p);
  algebra(&p);
  for (uint32_t k = 0; k < r->effects.n; k++) effect(&p, &r->effects.at[k]);
  polynomial_charges(&p);
  involution(&p);
}
