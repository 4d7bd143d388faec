/* A range of `lagc sweep`, name=A..B:N and the like, as its numbers and the text between them. */
#pragma once

#include <stdint.h>

#include "base/arena.h"
#include "base/vec.h"

typedef struct {
  uint32_t word;             /* the caller's: its place on the command line */
  const char *name, *unit;   /* "th", "=" or "~" included; "[deg]", or "" */
  VEC(const char *) between; /* text before, between and after the numbers: one more than numbers */
  VEC(const char *) numbers; /* each as name=NUMBER[unit], for the conversion of settings */
  const char *zero;          /* name=0[unit] of a deviation, which is a difference: 1 K is 1 degC; NULL: none */
} Range;

/* The range in a word of the command line; NULL: it is none. Forms that are wrong are left to the simulator, which
 * says so. */
Range *range_split(Arena *a, const char *word);

/* The word again, with each number as its converted setting has it. */
const char *range_joined(Arena *a, const Range *r);
