/* until_event STEP TIME [VALUE]: events of a header by steps of STEP, a line `index time` each. SET: what VALUE is
 * for. */
#define M_IMPLEMENTATION
#include "m.h"
#include <stdio.h>
#include <stdlib.h>
int main(int argc, char **argv) {
  m_params p;
  m_state s;
  int event = -1, stop = 0, status = 0;
  m_defaults(&p);
  if (argc > 3) SET((M_REAL)atof(argv[3]));
  m_start(&p, &s);
  while (s.t < (M_REAL)atof(argv[2]) && !stop &&
         (status = m_step_until_event(&p, &s, (M_REAL)atof(argv[1]), INPUTS & event)) == M_OK) {
    if (event < 0) continue;
    printf("%d %.17g\n", event, (double)s.t);
    m_act(event, &p, &s, INPUTS &stop);
  }
  return status != M_OK;
}
