/* C identifiers for the user's names: th1' is th1_dot, a Greek letter its name (theta), drag.c is drag_c. */
#pragma once

#include "base/id_table.h"
#include "base/vec.h"
#include "ir/program_set.h"

/* An identifier taken in a C scope. */
typedef struct {
  const char *name;
  int next; /* suffix to try first when the name is requested again */
} CName;

typedef struct {
  Arena *arena;
  VEC(CName) taken; /* in the order they were taken */
  IdTable table;    /* of `taken` */
} CNames;

CNames cnames_new(Arena *a);

/* Reserves an identifier as it is (arrays, macros of the caller). */
void cnames_reserve(CNames *c, const char *name);
void cnames_reserve_words(CNames *c, const char *head, const char *words); /* head and each word */

/* All taken names, NULL at the end. */
const char *const *cnames_list(const CNames *c);

/* Takes a free identifier for a user's name: no keyword and no function of <math.h>. */
const char *cnames_take(CNames *c, const char *name);

/* Identifier for a user's name, without a scope: taken names are not avoided. */
const char *cname(Arena *a, const char *name);

/* User's name in the letters of an identifier, for use after a prefix: may begin with a digit, and be a keyword. */
const char *cname_letters(Arena *a, const char *name);

/* Identifiers of the events of a unit: names that C spells alike get suffixes. */
const char *const *cnames_of_events(const ProgramSet *u);

/* Whether id is a function of the C library, whose name an object with external linkage must not have. */
int cname_is_library(const char *id);
