/* The model of a page. */
#pragma once

#include "commands/compiler.h"

/* Appends the JSON that live.js calls `model`, of the scenes that the command line names, or all. *title: the model's.
 * 0: the model is wrong. */
int page_model(Compiler *c, StrBuf *out, const char **title);
