/* --sweep on several processes. --mpi K: this one checks the command line, and becomes `mpirun -n K` of itself;
 * there, rank 0 has the files and prints. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "io/posix.h"

static const char name_variable[] = "LAG_NAME"; /* of the program in messages, where mpirun started it */

/* ---- Start */

/* words[argc + 10] := mpirun with the command line, without --mpi. */
static void command_of(const Args *a, const char *program, const char **words) {
  const char *const head[] = {"mpirun", "--bind-to", "none", "-x", name_variable, "-n", a->mpi, program};
  int n = sizeof head / sizeof *head;
  memcpy(words, head, sizeof head);
  for (int i = 1; i < a->argc; i++) {
    if (strcmp(a->argv[i], "--mpi") == 0) i++;
    else if (strncmp(a->argv[i], "--mpi=", 6) != 0) words[n++] = a->argv[i];
  }
  words[n] = NULL;
}

int lag_sweep_check_mpi(const SweepApp *s) {
  const Args *a = &s->app->args;
  long long n;
  if (!a->mpi) return 0;
  if (lag_args_count(a, "--mpi", a->mpi, "--mpi 4", &n)) return EXIT_USAGE;
  if (n == 1) return lag_app_error(a, "--mpi 1: one process is there without MPI; leave it out");
  if (!s->app->extras.ranks)
    return lag_app_error(a, "--mpi: this program was built without MPI; `lagc sweep --mpi %s` builds one that has it",
                         a->mpi);
  if (a->merge) return lag_app_error(a, "--merge and --mpi: there are no runs to share; leave --mpi out");
  return getenv("OMPI_COMM_WORLD_SIZE")
             ? lag_app_error(a, "--mpi %s: mpirun has started %s processes already; leave --mpi out", a->mpi,
                             getenv("OMPI_COMM_WORLD_SIZE"))
             : 0;
}

int lag_sweep_start(SweepApp *s) {
  const Args *a = &s->app->args;
  const char **words = calloc((size_t)a->argc + 10, sizeof *words);
  char program[4096];
  long n = lag_own_path(program, sizeof program - 1);
  if (!words || n <= 0) return lag_app_error(a, "out of memory");
  program[n] = '\0';
  command_of(a, program, words);
  setenv(name_variable, a->self, 1);
  execvp(words[0], (char *const *)words);
  int none = errno == ENOENT;
  free(words);
  return lag_app_error(a, "mpirun: %s",
                       none ? "it is not there: `apt-get install openmpi-bin`; --threads needs nothing"
                            : strerror(errno));
}

/* ---- Ranks */

int lag_sweep_join(SweepApp *s) {
  App *app = s->app;
  const char *name = getenv(name_variable);
  if (app->args.mpi) app->args.quiet = 1; /* rank 0 prints the notes */
  if (!app->extras.ranks || app->args.mpi) return 0;
  if (app->extras.ranks->join(&s->sweep.rank, &s->sweep.nranks))
    return lag_app_error(&app->args, "MPI does not start, or has no threads");
  if (s->sweep.nranks > 1) s->sweep.ranks = app->extras.ranks;
  if (s->sweep.rank) app->args.quiet = 1;
  if (name) app->args.self = name;
  return app->args.merge && s->sweep.ranks && s->sweep.rank == 0
             ? lag_app_error(&app->args, "--merge: there are no runs to share; start one process")
             : 0;
}

/* Values and options that all ranks share. */
typedef struct Agreed {
  uint64_t signature;
  long long shard, shards;
} Agreed;

int lag_sweep_agree(SweepApp *s) {
  const Sweep *w = &s->sweep;
  Agreed own = {lag_sweep_signature(s), w->shard, w->shards}, first = own;
  if (!w->ranks) return 0;
  if (w->ranks->share(&first, sizeof first))
    return lag_app_error(&s->app->args, "rank %d: rank 0 does not answer", w->rank);
  if (own.signature == first.signature && own.shard == first.shard && own.shards == first.shards) return 0;
  return lag_app_error(&s->app->args,
                       "rank %d has another sweep than rank 0: start all with the same words, files and lagc", w->rank);
}

int lag_sweep_serve(SweepApp *s) {
  lag_app_catch_interrupt();
  if (lag_sweep_agree(s)) return EXIT_USAGE;
  int status = lag_sweep_run(&s->sweep);
  if (status == LAG_INTERRUPTED) return lag_app_interrupted();
  if (status == LAG_OK) return 0;
  s->sweep.silent = status != LAG_ENOMEM; /* rank 0 */
  return lag_app_error(&s->app->args, "rank %d: %s", s->sweep.rank,
                       status == LAG_ENOMEM ? "out of memory" : "rank 0 does not answer");
}

/* Ends the launcher of this process: with --enable-recovery mpirun passes over the status of ranks, and a sweep without
 * rank 0 has no file. */
static void end_launcher(void) {
#ifndef _WIN32
  char path[40], name[16] = "";
  snprintf(path, sizeof path, "/proc/%ld/comm", (long)getppid());
  FILE *f = fopen(path, "r");
  int known = f && fgets(name, sizeof name, f) &&
              (strncmp(name, "mpi", 3) == 0 || strncmp(name, "orte", 4) == 0 || strncmp(name, "prte", 4) == 0);
  if (known) kill(getppid(), SIGTERM);
  if (f) fclose(f);
#endif
}

void lag_sweep_leave(const SweepApp *s, int rc) {
  const lag_ranks *ranks = s->app->extras.ranks;
  if (!ranks || s->app->args.mpi) return;
  fflush(stdout);
  if (rc == 0 && !s->sweep.silent) ranks->leave();
  else if (s->sweep.rank == 0) ranks->end(rc); /* another rank ends, and mpirun or rank 0 the others */
  else if (s->sweep.silent) end_launcher();
}
