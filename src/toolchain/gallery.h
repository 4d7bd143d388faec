/* The gallery: the models that come with lagc, in models/ of its source tree or in share/lagc/models of an
 * installation. */
#pragma once

#include "base/intern.h"
#include "base/vec.h"

typedef struct {
  const char *folder; /* NULL: no gallery is found */
  VEC(Name) names;    /* pendulum for pendulum.lag, in alphabetical order */
} Gallery;

/* The folder of files that models include; NULL without a gallery. argv0: the name that lagc was called by. */
const char *gallery_library(Arena *a, const char *argv0);
Gallery gallery_find(Arena *a, const char *argv0);

/* The file that a word on the command line means: `@pendulum` is a model of the gallery, others are files. NULL,
 * with *error. */
const char *gallery_path(Arena *a, const char *argv0, const char *word, const char **error);

/* The model of the gallery whose file `path` would name beside it: pendulum for pendulum or swings/pendulum.lag.
 * NULL: none. */
const char *gallery_name(Arena *a, const char *argv0, const char *path);

/* The title in quotes behind `model NAME`; "" for none. */
const char *gallery_title(Arena *a, const char *text);
