/* The processor time and memory that a search for symmetries may take. */
#pragma once

typedef struct SearchLimit {
  double seconds;     /* in all */
  double part;        /* of them, for the stage at work and those before it: 0 to 1 */
  double begin;       /* processor time when the search began */
  const char *doing;  /* the stage, in words */
  int stopped;        /* a stage was cut short, */
  int no_room;        /* for want of memory */
  void (*show)(struct SearchLimit *l, double spent); /* or NULL: shows progress; called often */
  const char *shown;
} SearchLimit;

SearchLimit search_limit(double seconds);

/* Names the next stage and its part of the time. */
void search_stage(SearchLimit *l, double part, const char *doing);

/* Whether the stage may go on, with work that takes about this many operations in long double. */
int search_goes_on(SearchLimit *l, double operations);

/* Whether a matrix of that many long doubles may be made. */
int search_fits(SearchLimit *l, double elements);

/* Why a stage was cut short. */
const char *search_stop_text(const SearchLimit *l);
