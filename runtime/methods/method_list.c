/* The list of methods that liblag.a offers, the default first. A new method is entered here and declared in lag.h. */
#include <string.h>

#include "lag.h"

const lag_method *const lag_methods[] = {&lag_rk45, &lag_dop853, &lag_rk4, &lag_euler, &lag_symplectic_euler, &lag_verlet,
                                         &lag_verlet4, &lag_verlet6, &lag_verlet8, &lag_variational, &lag_gauss, &lag_radau,
                                         &lag_taylor_method, &lag_moreau};
const int lag_nmethods = (int)(sizeof lag_methods / sizeof *lag_methods);

const lag_method *lag_find_method(const char *name) {
  for (int i = 0; name && i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  return NULL;
}
