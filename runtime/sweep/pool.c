/* Chunks that are not made yet (run_chunks_impl.h). A chunk is taken once, and again only after its rank was silent
 * past the deadline; rows that come twice are the same. */
#include "sweep/run_chunks_impl.h"

#include <errno.h>
#include <math.h>

#include "numeric/clock.h"

long long lag_pool_take(Pool *p, int for_rank) {
  const Journal *j = p->s->journal;
  lag_lock_take(&p->lock);
  while (p->next < j->chunks && j->at[p->next]) p->next += p->s->shards;
  long long c = p->rc == LAG_OK && p->next < j->chunks ? p->next : -1;
  p->next += p->s->shards;
  if (c >= 0 && for_rank) {
    p->taken[c] = lag_clock_seconds();
    p->out++;
  }
  lag_lock_give(&p->lock);
  return c;
}

/* No rank has chunk c any more. */
static void take_back(Pool *p, long long c) {
  if (!p->taken || p->taken[c] == 0) return;
  p->taken[c] = 0;
  p->out--;
}

void lag_pool_give(Pool *p, long long c, const double *row, int rc, double time) {
  Sweep *s = p->s;
  long long runs = lag_sweep_chunk_runs(s, c);
  lag_lock_take(&p->lock);
  int fresh = rc == LAG_OK && !s->journal->at[c];
  if (fresh && lag_journal_put(s->journal, c, row, (size_t)runs * lag_sweep_numbers(s))) {
    rc = LAG_EIO;
    p->error = errno;
  }
  take_back(p, c);
  p->longest = fmax(p->longest, time);
  p->made += fresh && rc == LAG_OK ? runs : 0;
  if (rc == LAG_OK && s->note(s->context, p->made)) rc = LAG_INTERRUPTED;
  if (p->rc == LAG_OK) p->rc = rc;
  lag_lock_give(&p->lock);
}

void lag_pool_end(Pool *p, int rc) {
  lag_lock_take(&p->lock);
  if (p->rc == LAG_OK) p->rc = rc;
  lag_lock_give(&p->lock);
}

double lag_pool_deadline(const Pool *p) {
  const double least = 2, times = 10; /* [s]; runs of one sweep differ in length */
  return least + times * p->longest;
}

long long lag_pool_lost(Pool *p) {
  for (int waits = p->taken != NULL; waits;) {
    long long lost = -1;
    lag_lock_take(&p->lock);
    double oldest = lag_clock_seconds() - lag_pool_deadline(p);
    waits = p->out && p->rc == LAG_OK;
    for (long long c = 0; c < p->s->journal->chunks && waits && lost < 0; c++)
      if (p->taken[c] > 0 && p->taken[c] < oldest) lost = c;
    if (lost >= 0) take_back(p, lost);
    lag_lock_give(&p->lock);
    if (lost >= 0) return lost;
    if (waits) lag_nap(0.01);
  }
  return -1;
}
