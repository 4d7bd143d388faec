/* Time of a message at rank 0: takes the rows of N chunks of 8 runs and 4 numbers into its journal, hands out N
 * others. Rank 1 makes no runs, and asks at once. */
#include <stdio.h>
#include <stdlib.h>

#include "numeric/clock.h"
#include "sweep/run_chunks_impl.h"

enum { MEASURES = 3, RUNS = 8 };

static int note(void *context, long long runs) {
  (void)context, (void)runs;
  return 0;
}

static double serve(Sweep *s, Journal *j, const char *path, size_t size) {
  char why[4400];
  *j = (Journal){.signature = 1, .chunks = s->plan->runs / RUNS, .size = size};
  if (lag_journal_open(j, path, 0, why, sizeof why)) fprintf(stderr, "%s\n", why), exit(2);
  double begin = lag_clock_seconds();
  if (lag_sweep_run(s)) exit(2);
  double time = lag_clock_seconds() - begin;
  if (j->finished != j->chunks) exit(2);
  lag_journal_close(j, 1);
  return time;
}

/* time: what rank 1 says that a chunk takes; long ones come one a message, short ones 64. */
static void ask(Sweep *s, double time) {
  Pool p = {.s = s, .lock = LAG_UNLOCKED};
  Batch *b = lag_batch_new(s);
  for (lag_ranks_ask(&p, b); b->n; lag_ranks_ask(&p, b)) b->time = time * (double)b->n;
  lag_ranks_leave(&p, b);
  free(b);
}

int main(int argc, char **argv) {
  int rank, n, word = 0;
  long long chunks = 20000;
  SweepPlan plan = {.runs = chunks * RUNS};
  Journal j = {.fd = -1};
  if (argc < 2 || lag_mpi.join(&rank, &n)) return 2;
  for (int k = 0; k < 2; k++) {
    Sweep s = {.plan = &plan,
               .nmeasures = MEASURES, .chunk = RUNS, .shards = 1, .journal = &j, .ranks = &lag_mpi, .rank = rank,
               .nranks = n,
               .note = note};
    lag_mpi.share(&word, sizeof word);
    if (rank) ask(&s, k ? 1e-6 : 1);
    else
      printf("%s %.2f us a chunk\n", k ? "64 chunks a message" : "1 chunk a message",
             1e6 / (double)chunks * serve(&s, &j, argv[1], (size_t)RUNS * (MEASURES + 1)));
  }
  lag_mpi.leave();
  return 0;
}
