/* Deriver: the callback by which a command derives several models of one text: its scenes, its effects one by one. */
#ifndef LAGC_COMMANDS_DERIVER_H
#define LAGC_COMMANDS_DERIVER_H

#include "mech/eqns.h"

typedef struct {
  Eqns *(*derive)(void *data, const ModelChoice *choice); /* NULL with the reasons in the diags of the text */
  void *data;
} Deriver;

#endif
