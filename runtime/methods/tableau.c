/* Tables of kernels/runge_kutta_tables.h as numbers, for tangents, errors along constraints and tests. */
#include "methods/tableau.h"

#include "kernels/runge_kutta_tables.h"

#define LAG_LEAD(j, weight) [j] = weight
#define LAG_TERM(j, weight) , [j] = weight
#define LAG_LEAD_OF LAG_LEAD
#define LAG_TERM_OF LAG_TERM
#define LAG_STAGE_1(s, part, newest) .c[s] = part, .a[s] = {[(s) - 1] = newest},
#define LAG_STAGE(s, part, older, newest) .c[s] = part, .a[s] = {older, [(s) - 1] = newest},
#define LAG_RESULT_1(s, newest) .c[s] = 1, .a[s] = {[(s) - 1] = newest},
#define LAG_RESULT(s, older, newest) .c[s] = 1, .a[s] = {older, [(s) - 1] = newest},
#define LAG_ERROR(e, terms) .errors[e] = {terms},
#define LAG_DENSE(j, terms) .d[j] = {terms},

const lag_tableau lag_euler_tableau = {.stages = 2, .order = 1, LAG_EULER_RESULT};

#define FIXED_NUMBERS(NAME, order)
#define ADAPTIVE_NUMBERS(NAME, order) .order_embedded = order - 1, LAG_##NAME##_ERRORS
#define LATE_NUMBERS ADAPTIVE_NUMBERS
#define OWN_TABLEAU(name, NAME, kind, of_order)
#define HERMITE_TABLEAU(name, NAME, kind, of_order)                                                  \
  const lag_tableau lag_##name##_tableau = {.stages = LAG_##NAME##_LAST + 1, .order = of_order,       \
                                            LAG_##NAME##_STAGES LAG_##NAME##_RESULT kind##_NUMBERS(NAME, of_order)};
#define TABLEAU(name, NAME, kind, dense, order, line, words) dense##_TABLEAU(name, NAME, kind, order)
LAG_RUNGE_KUTTA_METHODS(TABLEAU)
const lag_tableau lag_rk45_tableau = {.stages = 7, .order = 5, .order_embedded = 4, LAG_RK45_STAGES LAG_RK45_RESULT
                                      LAG_RK45_ERRORS LAG_RK45_DENSE};
const lag_tableau lag_dop853_tableau = {
    .stages = 13, .extra = 3, .order = 8, .order_embedded = 5, LAG_DOP853_STAGES LAG_DOP853_RESULT LAG_DOP853_EXTRA
    LAG_DOP853_ERRORS LAG_DOP853_DENSE};
