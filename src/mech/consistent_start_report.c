/* Messages for starts that are refused. */
#include <math.h>

#include "mech/consistent_start.h"

const char *start_residual_text(const Eqns *e, const StartResult *r) {
  const Model *m = e->m;
  Dim dim = e->constraints.of[r->constraint]->dim;
  int rate = r->velocities && r->constraint < e->constraints.nholonomic;
  const char *unit = dim_text(m->dims, dim); /* "1", "?" where units are not known */
  int bare = *unit == '1' || *unit == '?';
  if (!isfinite(r->residual)) return "";
  return arena_printf(m->arena, "; it is off by %.3Lg%s%s%s%s", fabsl(r->residual), bare ? "" : " [", bare ? "" : unit, bare ? "" : "]",
                      rate ? " in its rate" : r->velocities ? " in its velocities" : "");
}

void start_report(const Eqns *e, const StartResult *r) {
  const Model *m = e->m;
  const Constraint *k = e->constraints.of[r->constraint];
  const char *scene = m->scene.name, *off = start_residual_text(e, r);
  switch (r->kind) {
    case LAG_START_FOUND: return;
    case LAG_START_NO_VALUE:
      diag_error(m->diags, k->span, "scene %s: the constraint `%s` has no value at the start", scene, k->name);
      diag_help(m->diags, "start where it has one");
      return;
    case LAG_START_BROKEN:
      diag_error(m->diags, k->span, "scene %s: the start contradicts the constraint `%s`%s", scene, k->name, off);
      diag_help(m->diags, "without `exactly` the nearest start is taken");
      return;
    case LAG_START_FLAT:
      diag_error(m->diags, k->span, "scene %s: the derivatives of the constraint `%s` vanish where it holds, so that no force can hold it", scene, k->name);
      diag_help(m->diags, "write a constraint whose derivatives do not vanish: x = 0 in place of x^2 = 0");
      return;
    case LAG_START_STEEP:
      diag_error(m->diags, k->span, "scene %s: the derivatives of the constraint `%s` have no value where it holds", scene, k->name);
      diag_help(m->diags, "write a constraint whose derivatives have values: x = 1 in place of sqrt(x - 1) = 0");
      return;
    case LAG_START_NONE:
      diag_error(m->diags, k->span, "scene %s: no state near its start obeys the constraint `%s`%s", scene, k->name, off);
      diag_help(m->diags, "start nearer to a state that obeys it; where its derivatives vanish no direction leads there");
  }
}
