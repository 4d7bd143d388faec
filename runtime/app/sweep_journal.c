/* Journals of sweeps: their names, the sweep that they belong to, and parts that are merged. Enters: a sweep; leaves:
 * its open journal. */
#include "app/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "io/posix.h"
#include "numeric/fnv1a.h"

static uint64_t hash_variant(uint64_t h, const SweepApp *s, const SweepVariant *v) {
  const lag_sim *sim = v->like;
  unsigned long long model = lag_sim_signature(sim);
  h = lag_fnv1a(h, (const char *)&model, sizeof model);
  h = lag_hash_numbers(h, sim->scene->model->np, sim->p);
  h = lag_hash_numbers(h, sim->pb.n, sim->start);
  h = lag_hash_numbers(h, sim->scene->model->nu, sim->hold);
  h = lag_hash_numbers(h, lag_sim_method(sim)->noptions, lag_sim_options(sim));
  for (int k = 0; k < s->sweep.nmeasures; k++) h = lag_hash_text(h, v->measure[k]);
  return h;
}

/* Values, method, end and measures: what two processes of one sweep share. */
uint64_t lag_sweep_signature(const SweepApp *s) {
  const SweepPlan *p = &s->plan;
  const double numbers[] = {lag_sim_tolerance(s->app->sim),
                            s->sweep.until,
                            isnan(s->sweep.skip) ? s->app->scene->t0 : s->sweep.skip,
                            (double)p->runs,
                            (double)p->samples,
                            (double)p->seed,
                            p->sampling,
                            p->zip};
  /* sines and sums have other last digits */
  uint64_t h = lag_hash_text(lag_hash_text(LAG_FNV1A_START, LAG_PRECISION), s->app->program->lanes_4 ? "lanes" : "");
  for (int v = 0; v < s->sweep.nvariants; v++) h = hash_variant(h, s, &s->variants[v]);
  h = s->times ? lag_hash_numbers(h, s->sweep.nrows, s->times)
               : lag_hash_text(h, s->app->args.section ? s->app->args.section : "");
  h = lag_hash_numbers(h, sizeof numbers / sizeof *numbers, numbers);
  for (const Factor *f = p->factor; f < p->factor + p->n; f++) {
    const double range[] = {f->kind, f->a, f->b, (double)f->n};
    h = lag_hash_numbers(lag_hash_text(h, f->name), sizeof range / sizeof *range, range);
    if (f->list) h = lag_hash_numbers(h, f->n, f->list);
  }
  return h;
}

/* ---- Journals */

const char *lag_sweep_result_file(const Args *a) { return a->out ? a->out : a->svg ? a->svg : a->motions; }

/* Whether the rows go to a stream or a device. The journal has no name then, and ends with this process. */
int lag_sweep_is_stream(const char *file) {
  struct stat st;
  return strcmp(file, "-") == 0 || lag_is_null_device(file) ||
         (stat(file, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode));
}

static int journal_path(const SweepApp *s, long long shard, char path[4200]) {
  const Args *a = &s->app->args;
  const char *folder = getenv(TEMPORARY_FOLDER);
  const char *file = lag_sweep_result_file(a);
  if (lag_sweep_is_stream(file))
    return snprintf(path, 4200, "%s/lagc-sweep-%ld.journal", folder ? folder : "/tmp", (long)getpid());
  if (s->sweep.shards == 1) return snprintf(path, 4200, "%s.journal", file);
  return snprintf(path, 4200, "%s.%lld-of-%lld.journal", file, shard + 1, s->sweep.shards);
}

int lag_sweep_open_journal(SweepApp *s, int resume) {
  const SweepPlan *p = &s->plan;
  char path[4200], why[4400];
  journal_path(s, s->sweep.shard, path);
  s->journal = (Journal){.signature = lag_sweep_signature(s), .chunks = (p->runs - 1) / s->sweep.chunk + 1,
                         .size = (size_t)s->sweep.chunk * lag_sweep_numbers(&s->sweep)};
  int rc = lag_journal_open(&s->journal, path, resume, why, sizeof why);
  if (rc == 0 && lag_sweep_is_stream(lag_sweep_result_file(&s->app->args))) unlink(path);
  if (rc == 0 && why[0] && !s->app->args.quiet) fprintf(stderr, "%s: note: %s\n", s->app->args.self, why);
  return rc ? lag_app_error(&s->app->args, "%s", why) : 0;
}

/* --shard i/n; --merge n. */
int lag_sweep_read_shard(SweepApp *s) {
  const Args *a = &s->app->args;
  long long i = 1, n = 1;
  char end;
  s->sweep.shards = 1;
  if (a->shard && (sscanf(a->shard, "%lld/%lld%c", &i, &n, &end) != 2 || i < 1 || n < i || n > 1000000))
    return lag_app_error(a, "--shard %s: part i of n, for example --shard 1/4", a->shard);
  s->sweep.shard = i - 1;
  s->sweep.shards = n;
  return 0;
}

/* Copies the chunks of shard number k of n into the journal. */
static int merge_shard(SweepApp *s, long long k, long long n, double *row) {
  SweepApp part = *s;
  part.sweep.shard = k;
  part.sweep.shards = n;
  char path[4200];
  struct stat st;
  journal_path(&part, k, path);
  if (stat(path, &st))
    return lag_app_error(&s->app->args,
                         "%s is missing: make it by --shard %lld/%lld in place of --merge, or bring it here", path,
                         k + 1, n);
  if (lag_sweep_open_journal(&part, 1)) return EXIT_USAGE;
  int rc = 0;
  for (long long c = k; c < part.journal.chunks && rc == 0; c += n) {
    size_t size = (size_t)lag_sweep_chunk_runs(&s->sweep, c) * lag_sweep_numbers(&s->sweep);
    if (!part.journal.at[c])
      rc = lag_app_error(&s->app->args, "%s: %lld of its runs are missing; go on with --shard %lld/%lld --resume",
                         part.journal.path, lag_sweep_chunk_runs(&s->sweep, c), k + 1, n);
    else if (lag_journal_get(&part.journal, c, row, size) || lag_journal_put(&s->journal, c, row, size))
      rc = lag_app_io_error(s->app, s->journal.path);
  }
  lag_journal_close(&part.journal, 0);
  return rc;
}

int lag_sweep_merge(SweepApp *s) {
  const Args *a = &s->app->args;
  long long n = 0;
  double *row = malloc((size_t)s->sweep.chunk * lag_sweep_numbers(&s->sweep) * sizeof *row);
  int rc = row ? lag_args_count(a, "--merge", a->merge, "--merge 4", &n) : lag_app_error(a, "out of memory");
  if (rc == 0 && n == 1) rc = lag_app_error(a, "--merge 1: one part is the whole; leave --merge out");
  rc = rc ? rc : lag_sweep_open_journal(s, 0);
  for (long long k = 0; k < n && rc == 0; k++) rc = merge_shard(s, k, n, row);
  if (rc) lag_journal_close(&s->journal, 1);
  for (long long k = 0; k < n && rc == 0; k++) { /* all are in the new one */
    char path[4200];
    SweepApp part = *s;
    part.sweep.shards = n;
    journal_path(&part, k, path);
    unlink(path);
  }
  free(row);
  return rc;
}
