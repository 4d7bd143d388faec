/* The model of a page, in two texts: the JSON that live.js calls `model`, and the bytes that it points into: programs,
 * then a JSON text, its member "more". */
#pragma once

#include "commands/compiler.h"

typedef struct {
  StrBuf json, bytes;
  StrBuf programs;   /* their places in bytes, with scenes and effects, as members of a list */
  StrBuf letters;    /* members "NAME": "LATEX" of parameters */
  const Eqns *shown; /* of the first scene */
  int whole;         /* nothing is left out */
} PageModel;

PageModel page_model_begin(Arena *a);
/* The scenes that the command line names, or all; `first`: one, with its own effects. 0: the model is wrong. */
int page_model_programs(Compiler *c, PageModel *d, int first);
/* The rest, but for the last brace of the JSON. recording: JSON, or "null". */
void page_model_end(Compiler *c, PageModel *d, const char *recording);
