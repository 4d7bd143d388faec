/* Events of a header until TIME, by steps of STEP: a line `index time` each, with 17 digits. */
#define M_IMPLEMENTATION
#include "m.h"
#include <stdio.h>
int main(void) {
  m_params p;
  m_state s;
  int event = -1, stop = 0, status = 0;
  m_defaults(&p);
  m_start(&p, &s);
  BEFORE
  while (s.t < TIME && !stop && (status = m_step_until_event(&p, &s, STEP, INPUTS &event)) == M_OK) {
    if (event < 0) continue;
    printf("%d %.17g\n", event, (double)s.t);
    m_act(event, &p, &s, INPUTS &stop);
  }
  return status != M_OK;
}
