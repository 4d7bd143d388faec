/* The list of methods that liblag.a offers, the default first. A new method is entered here and
 * declared in lag.h; rows of kernels/steppers.def come by themselves. */
#include <string.h>

#include "kernels/steppers.def"
#include "lag.h"

#define DECLARE(name, general, order, flags, line, words) extern const lag_method lag_##name;
#define ENTRY(name, general, order, flags, line, words) &lag_##name,
LAG_SPLITTING_METHODS(DECLARE)

#define DECLARE_RK(name, NAME, kind, dense, order, line, words) extern const lag_method lag_##name;
#define ENTRY_RK(name, NAME, kind, dense, order, line, words) &lag_##name,
LAG_RUNGE_KUTTA_METHODS(DECLARE_RK)

const lag_method *const lag_methods[] = {LAG_RUNGE_KUTTA_METHODS(ENTRY_RK) &lag_euler,
                                         LAG_SPLITTING_METHODS(ENTRY) &lag_wisdom_holman, &lag_variational, &lag_gauss,
                                         &lag_radau, &lag_taylor_method, &lag_moreau};
const int lag_nmethods = (int)(sizeof lag_methods / sizeof *lag_methods);

const lag_method *lag_find_method(const char *name) {
  for (int i = 0; name && i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  return NULL;
}
