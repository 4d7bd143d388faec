/* C identifiers for the user's names: th1' is th1_dot, θ1 is theta1, drag.c is drag_c. */
#ifndef LAGC_CNAMES_H
#define LAGC_CNAMES_H

#include "base/intern.h"
#include "base/strbuf.h"
#include "base/vec.h"

/* The identifiers taken in one C scope. */
typedef struct {
  const char *name;
  int next; /* the number to try first when the name is wanted again */
} CName;

typedef struct {
  Arena *arena;
  VEC(const char *) taken; /* in the order they were taken */
  CName *table;            /* the same; open addressing */
  uint32_t cap;
} CNames;

CNames cnames_new(Arena *a);

/* Takes a name as it is (the caller's own: arrays, macros). */
void cnames_reserve(CNames *c, const char *name);

/* An identifier for a user's name that is not taken, no keyword and no function of <math.h>. */
const char *cnames_take(CNames *c, const char *name);

/* The same spelling without looking at what is taken. */
const char *cname(Arena *a, const char *name);

/* Only the letters: may begin with a digit, and be a keyword. For the rest of an identifier. */
const char *cname_spelled(Arena *a, const char *name);

/* Whether C knows a function of that name: an object with external linkage may not be called so. */
int cname_is_library(const char *id);

#endif
