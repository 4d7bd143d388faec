/* The table of passes, and the loop over it. */
#include "ir/passes.h"

#include "ir/roll.h"

enum { PAGE = 200 }; /* instructions; shorter programs fit a processor's window in any order, and keep the readable one */

typedef struct {
  const PassPlan *plan;
  Prog *p;
  int is_short;     /* with every_step: too short for loops, so that products may be taken apart */
} Passes;

static Prog *tidy(Passes *s) { return prog_tidy(s->p); }

static Prog *factor(Passes *s) {
  Prog *p = prog_factor(s->p);
  s->is_short = p->ins.n <= ROLL_FROM;
  return p;
}

static Prog *product_cse(Passes *s) { return prog_product_cse(s->p); }
static Prog *reassociate(Passes *s) { return prog_reassociate_fma(s->p); }
static Prog *schedule_by_path(Passes *s) { return prog_schedule_by_path(s->p, s->plan->libm); }
static Prog *schedule_by_store(Passes *s) { return prog_schedule_by_store(s->p); }

static Prog *nests(Passes *s) { return prog_find_nests(s->p, s->plan->nests_from); }

static int always(const Passes *s) { return s != NULL; }
static int every_step(const Passes *s) { return s->plan->every_step; }
static int is_short(const Passes *s) { return s->is_short; }
static int is_page(const Passes *s) { return s->is_short && s->p->ins.n > PAGE; }
static int may_nest(const Passes *s) { return s->plan->nests_from && !s->is_short; }
static int is_long_uncoupled(const Passes *s) { return s->plan->every_step && s->plan->uncoupled && !s->is_short; }

static const struct {
  const char *name;
  int (*wanted)(const Passes *s);
  Prog *(*run)(Passes *s);
} passes[] = {
  {"tidy", always, tidy},
  {"factor", every_step, factor},
  {"product_cse", is_short, product_cse},
  {"reassociate_fma", is_short, reassociate},
  {"schedule_by_path", is_page, schedule_by_path},
  {"find_nests", may_nest, nests},
  {"schedule_by_store", is_long_uncoupled, schedule_by_store},
};

static int is_sound(Prog *p, const char *after, StrBuf *trace) {
  const char *wrong = prog_verify(p);
  if (trace) {
    sb_printf(trace, "after %s: %u instructions\n", after, p->ins.n);
    prog_dump(p, trace);
  }
  if (wrong && !p->fault) p->fault = arena_printf(p->arena, "after %s: %s", after, wrong);
  return !wrong;
}

Prog *passes_run(Prog *p, const PassPlan *plan, StrBuf *trace) {
  Passes s = {.plan = plan, .p = p};
  if (!is_sound(p, "lowering", trace)) return p;
  for (size_t i = 0; i < sizeof passes / sizeof *passes; i++) {
    if (!passes[i].wanted(&s)) continue;
    s.p = passes[i].run(&s);
    if (!is_sound(s.p, passes[i].name, trace)) break;
  }
  return s.p;
}
