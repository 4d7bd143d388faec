/* Steps that lead nowhere. Enters: each step that a method accepts; leaves: whether the run is to end, and why.
 *
 * Near a position where constraints become dependent, as of bars that come to lie in one line, accelerations have an error of eps/s^2, s
 * being how independent they are, and a tolerance below that makes steps shrink in front of it, accepted one by one, for ever. The rule has
 * two parts, and both must hold. In MOST steps the time went on by less than a hundred-thousandth of the run so far: at that pace the run
 * would take 10^9 steps to become twice as long; what is fast for a while (a stiff spring that is struck) takes some hundred steps, and
 * what is fast throughout has covered more. And the constraints are nearly dependent there: elsewhere short steps are not for this reason; or the
 * model jumps somewhere, as a bead on y = abs(x), which goes back and forth over the corner. */
#include <math.h>
#include <stdio.h>

#include "core/core.h"

enum { MOST = 10000 };

int lag_creeps(lag_problem *pb, lag_creep *c, double begin, double t, const double *y)
{
  const double pace = 1e-5, dependent = 1e-2;

  if (!pb->model->constraints || (c->steps > 0 && ++c->steps <= MOST)) {
    return 0;
  }
  double led = fabs(t - c->since);
  int first = !(c->steps > 0), k;
  c->steps = 1;
  c->since = t;
  if (first || led > pace * fabs(t - begin)) {
    return 0;
  }
  double s = lag_independence(pb, t, y, &k);
  if ((k < 0 || s > dependent) && lag_facts(pb) & LAG_SMOOTH) {
    return 0;
  }
  if (k < 0 || s > dependent) {
    snprintf(pb->words, sizeof pb->words, "the last %d steps led on by %.3g s only: a force or a constraint jumps here, and the motion does not leave the "
             "place; smooth it, as sqrt(x^2 + w^2) does abs(x), or let a contact or an event do what happens", MOST, led);
    pb->detail = pb->words;
    pb->bad_t = t;
    return 1;
  }
  char line[32];
  const lag_constraint *weakest = &pb->model->constraints->of[k];
  snprintf(pb->words, sizeof pb->words, "the last %d steps led on by %.3g s only: constraint %s%s is within %.1g of following from the others, "
           "and no step is accurate to the tolerance; a larger one, or steps of equal size (adapt=off, rk4, variational), may pass", MOST, led,
           weakest->name, lag_line_of(weakest, line), s);
  pb->detail = pb->words;
  pb->bad_t = t;
  return 1;
}
