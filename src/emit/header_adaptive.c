/* Control of the adaptive steps of an emitted header, for one state and for the lanes of vectors. Enters: trial
 * steps with error estimates (header_steps.c). Holds: sizes as runtime/methods/adaptive_rk.c chooses them; a lane
 * has the digits of a state alone. */
#include "emit/header_impl.h"
#include "emit/header_adaptive_text.h"

void header_adaptive_declare(const Header *h) { header_printf(h, "%s", type); }

void header_move(const Header *h) { header_template(h, move, NULL); }

void header_adaptive_define(const Header *h, const char *longest) {
  const HeaderWord words[] = {{"LONGEST", longest},
                              {"USES", h->u->u.n ? "(void)p, (void)u, (void)input, (void)context, " : "(void)p, "},
                              {NULL, NULL}};
  header_template(h, begin, words);
  header_section(h, "first_step");
  header_template(h, adapt, NULL);
  header_printf(h, "\nLAG_API void lag_adaptive_begin(lag_adaptive *w, LAG_REAL tolerance)");
  header_template(h, adaptive_begin, words);
}
