/* Prints the methods of the runtime as rows of the table in src/base/method_table.c: the compiler includes no header of
 * the runtime. Explicit Runge-Kutta methods have their rows there from kernels/steppers.def; they are compared. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lag.h"
#include "kernels/steppers.def"

/* Whether m is such a row; *differs: not as method_table.c has it. */
static int is_row(const lag_method *m, int *differs)
{
  enum { FIXED, ADAPTIVE, LATE };
#define COMPARE(id, NAME, kind, dense, of_order, line, words) \
  if (strcmp(m->name, #id) == 0) { \
    unsigned flags = LAG_METHOD_CONSTRAINTS | (kind == FIXED ? 0 : LAG_METHOD_ADAPTIVE); \
    *differs |= m->flags != flags || m->noptions != (kind == FIXED ? 1 : 4) || strcmp(m->doc, line) != 0; \
    return 1; \
  }
  LAG_RUNGE_KUTTA_METHODS(COMPARE)
  return 0;
}

static void list_options(const lag_method *m)
{
  printf("   (const MethodOption[]){");
  for (int i = 0; i < m->noptions; i++) {
    const lag_method_option *o = &m->options[i];
    printf("{\"%s\", %.17g, ", o->name, o->min);
    if (isinf(o->max)) {
      printf("HUGE_VAL, ");
    } else {
      printf("%.17g, ", o->max);
    }
    printf("%s", o->choices ? "(const char *const[]){" : "NULL");
    for (int j = 0; o->choices && o->choices[j]; j++) {
      printf("\"%s\", ", o->choices[j]);
    }
    printf("%s, %g, %g}, ", o->choices ? "NULL}" : "", o->every, o->most);
  }
  printf("{NULL, 0, 0, NULL, 0, 0}}},\n");
}

static void list(const lag_method *const *methods, int n)
{
  for (int i = 0; i < n; i++) {
    const lag_method *m = methods[i];
    int differs = 0;
    if (is_row(m, &differs)) {
      if (differs) printf("%s is not as its row says\n", m->name);
      continue;
    }
    printf("  {\"%s\", \"%.*s\", 0%s%s%s%s%s%s%s%s,\n", m->name, (int)strcspn(m->doc, "\n"), m->doc,
           m->flags & LAG_METHOD_NO_STATES ? " | METHOD_NO_STATES" : "",
           m->flags & LAG_METHOD_VARIATION ? " | METHOD_VARIATION" : "",
           m->flags & LAG_METHOD_SPLITS ? " | METHOD_SPLITS" : "",
           m->flags & LAG_METHOD_JACOBIAN ? " | METHOD_JACOBIAN" : "",
           m->flags & LAG_METHOD_TAYLOR ? " | METHOD_TAYLOR" : "", m->flags & LAG_METHOD_FLOWS ? " | METHOD_FLOWS" : "",
           m->flags & LAG_METHOD_KEPLER ? " | METHOD_KEPLER" : "",
           m->flags & LAG_METHOD_CONSTRAINTS ? " | METHOD_CONSTRAINTS" : "");
    list_options(m);
  }
}

int main(void)
{
  printf("/* The runtime's methods that are no rows of kernels/steppers.def, as liblag describes them: `make bless\n"
         " * T=golden/run_method_rows` writes this file. {name, description, flags, options} */\n");
  list(lag_methods, lag_nmethods);
#ifdef WITH_GSL
  printf("#ifdef LAGC_WITH_GSL\n");
  list(lag_gsl_methods, lag_gsl_nmethods);
  printf("#endif\n");
#endif
  return 0;
}
