/* The passes, in their order; each result is verified and, for --dump=passes, listed. */
#include "ir/passes.h"

#include "ir/roll.h"

/* instructions; shorter programs fit a processor's window in any order, and keep the readable one */
enum { PAGE = 200 };

/* Takes p for the program after the pass `name`, and releases the one before. Returns whether p is sound; if not, it
 * has the fault. */
static int take(Prog **to, Prog *p, const char *name, StrBuf *trace) {
  const char *wrong = prog_verify(p);
  if (trace) {
    sb_printf(trace, "after %s: %u instructions\n", name, p->ins.n);
    prog_dump(p, trace);
  }
  if (wrong && !p->fault) p->fault = arena_printf(p->arena, "after %s: %s", name, wrong);
  if (*to != p) prog_release(*to);
  *to = p;
  return !wrong;
}

Prog *passes_run(Prog *p, const PassPlan *plan, StrBuf *trace) {
  /* is_short: too short for loops, so that products may be taken apart */
  const double times = plan->times > 0 ? plan->times : 1;
  int sound = take(&p, p, "lowering", trace), is_short = 0;
  if (sound) sound = take(&p, prog_tidy(p), "tidy", trace);
  if (sound && plan->every_step) sound = take(&p, prog_factor(p), "factor", trace);
  is_short = plan->every_step && p->ins.n*times <= ROLL_FROM && !p->nests.n;
  if (sound && is_short) sound = take(&p, prog_product_cse(p), "product_cse", trace);
  if (sound && is_short) sound = take(&p, prog_reassociate_fma(p), "reassociate_fma", trace);
  if (sound && is_short && p->ins.n > PAGE)
    sound = take(&p, prog_schedule_by_path(p, plan->libm), "schedule_by_path", trace);
  if (sound && !is_short && plan->nests_from)
    sound = take(&p, prog_find_nests(p, 1 + (uint32_t)((plan->nests_from - 1)/times)), "find_nests", trace);
  if (sound && !is_short && plan->every_step && plan->uncoupled)
    take(&p, prog_schedule_by_store(p), "schedule_by_store", trace);
  return p;
}
