/* Internals of the writers of nests: cnest.c writes them, cnest_share.c the rows that threads share. */
#pragma once

#include "emit/cwriter_impl.h"
#include "ir/row_share.h"

typedef struct {
  const Nest *n;
  Writer body;             /* writes the turn, with names of the function */
  const char *i, *j;       /* the counters */
  /* by slot of the body: 1 if its value changes from turn to turn; 2: and it is part of the test of neighbours */
  unsigned char *each;
  const char *near;        /* the list of neighbours; NULL: there is none */
  const char **partial;    /* by store of the body: the variable that accumulates it; NULL: the element itself */
  RowShare share;
  const char *tile, *shares; /* of threads that share rows: the tile or share of each, the number of shares, */
  const char *from, *end;  /* turns of the row, in a tile or all of them */
  const char *kept;        /* and the array of sums of rows that go on in other tiles, or are added up at the end */
} Nesting;

const char *cnest_place(const Nesting *x, uint32_t k);

/* First turn of row i + behind. */
const char *cnest_turn_of_row(const Nesting *x, int behind);

void cnest_open_loop(Writer *w, const char *counter, const char *from, const char *end);
void cnest_close_loop(Writer *w);

/* Declares an array of the function. A large one has static memory, in each thread its own, as a stack has a few MB;
 * all threads that share rows use that of the first. */
void cnest_declare_array(Writer *w, const char *name, long long n);

/* Opens the loop over rows: all, or those that a thread takes; finds the turns of a row, x->from and x->end. */
void cnest_open_rows(Nesting *x);
/* Start of a row's sum, in store k. */
const char *cnest_row_begins(const Nesting *x, uint32_t k);
/* Adds the sums of the row, or keeps them. */
void cnest_end_row(Nesting *x);
/* After the loop over rows: adds the sums that were kept. */
void cnest_end_rows(Nesting *x);

/* Declares whether the member of the turn belongs to the thread's share, which adds to its sums; NULL: to all. */
const char *cnest_declare_ours(Nesting *x);

/* Writes how many neighbours a row has, and their list. */
void cnest_find_list(Nesting *x);

/* The list of neighbours, as a pointer; its members. */
const char *cnest_near_pointer(const Nesting *x);
int64_t cnest_near_members(const Nest *n);
