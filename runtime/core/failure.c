/* Statuses and messages: what a simulation, a method or the model notes of a failure. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

const char *lag_status_name(int status) {
  static const struct {
    int status;
    const char *name;
  } names[] = {{LAG_OK, "ok"}, {LAG_STOPPED, "stopped"}, {LAG_INTERRUPTED, "interrupted"},
               {LAG_ERETRY, "outside the domain"}, {LAG_ESINGULAR, "singular mass matrix"}, {LAG_ENAN, "not a number"},
               {LAG_EDOMAIN, "outside the domain"}, {LAG_ESTEP, "step too small"}, {LAG_EINVAL, "invalid argument"},
               {LAG_ENOMEM, "out of memory"}, {LAG_EMONITOR, "monitor"}, {LAG_EMODEL, "model failed"},
               {LAG_EZENO, "events accumulate"}, {LAG_EMETHOD, "method failed"}, {LAG_EIO, "input or output failed"},
               {LAG_EDRIFT, "energy lost"}, {LAG_ESTALL, "stalled"}};

  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (names[i].status == status) return names[i].name;
  return "failed";
}

int lag_fail(lag_sim *s, int status, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(s->message, sizeof s->message, format, args);
  va_end(args);
  return status;
}

int lag_note(lag_problem *pb, int status, double t, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(pb->words, sizeof pb->words, format, args);
  va_end(args);
  pb->detail = pb->words;
  pb->bad_t = t;
  return status;
}
