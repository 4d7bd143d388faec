/* Processor time by clock(), so that other programs beside this one change no result. */
#include "symmetry/search_limit.h"

#include <time.h>

static const double PER_SECOND = 4e8; /* operations on long doubles in a matrix, measured */

static const double ELEMENTS_MOST = 3e7; /* of a matrix: half a gigabyte */

static double processor_seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

SearchLimit search_limit(double seconds) {
  return (SearchLimit){.seconds = seconds, .part = 1, .begin = processor_seconds(), .doing = ""};
}

void search_stage(SearchLimit *l, double part, const char *doing) {
  l->part = part;
  l->doing = doing;
}

int search_goes_on(SearchLimit *l, double operations) {
  double spent = processor_seconds() - l->begin;
  if (l->show) l->show(l, spent);
  if (spent + operations / PER_SECOND < l->part * l->seconds) return 1;
  l->stopped = 1;
  return 0;
}

int search_fits(SearchLimit *l, double elements) {
  if (elements <= ELEMENTS_MOST) return 1;
  l->stopped = l->no_room = 1;
  return 0;
}

const char *search_stop_text(const SearchLimit *l) {
  return l->no_room ? "more than half a gigabyte would be needed for one matrix"
                    : "the time was spent; --seconds gives more";
}
