/* --cost --where: shares of a run's time. Enters: the run that `lagc run -o FILE.csv` makes; leaves: the time of each part of it, of a call of the
 * right-hand side, and of its operations. Holds: the run is measured as it is: a timer notes five thousand times a second which function is at work,
 * and the program's own table of symbols names it. For Linux on x86-64 or aarch64. */
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"
#include "core/core.h"
#include "core/rhs.h"
#include "numeric/clock.h"

enum { MOST_SHOWN = 6 };

/* Parts of a run. */
typedef enum Part { EQUATIONS, DERIVATIVES, ALGEBRA, NEWTON, METHOD, CONSTRAINTS, EVENTS, MONITORS, OUTPUT, LIBRARY, OTHER, PARTS } Part;

static const char *const part_name[PARTS] = {"right-hand side", "derivatives of the equations", "linear algebra", "Newton's method", "method and step control",
                                             "constraints and contacts", "events", "energy, charges, monitors, error", "output: rows as CSV", "C library", "other"};
static const char *const part_id[PARTS] = {"right_hand_side", "derivatives", "linear_algebra", "newton", "method", "constraints", "events", "monitors",
                                           "output", "library", "other"};

/* A function of this program. */
typedef struct Function {
  uintptr_t begin, end;
  char name[48];
  Part part;
  long samples;
} Function;

typedef struct Profile {
  App *app;
  Function *of; /* [n], ascending; of[n]: the C library */
  int n;
  volatile int writes; /* 1: a row is being computed and written */
  long samples, output; /* all; those while a row is written */
  double time;  /* of a run, median [s] */
  lag_stats st;
  long long rows;
  int runs, order; /* order: of Taylor series */
} Profile;

#if defined __linux__ && (defined __x86_64__ || defined __aarch64__)

#include <elf.h>
#include <signal.h>
#include <sys/time.h>
#include <ucontext.h>

/* ---- Names of functions */

/* Part of a function by its file, where it is static, or else by its name; the first row that fits. */
static Part part_of(const char *file, const char *name) {
  static const struct {
    const char *file, *name; /* how they begin */
    Part part;
  } rows[] = {
      {"model_", "lag_kkt", ALGEBRA}, {"model_", "lag_solve", ALGEBRA}, {"model_", "lag_cholesky", ALGEBRA}, {"model_", "lag_reflector", ALGEBRA},
      {"model_", "energy", MONITORS}, {"model_", "charge", MONITORS}, {"model_", "exact", MONITORS},
      {"model_", "events", EVENTS}, {"model_", "act", EVENTS}, {"model_", "residuals", CONSTRAINTS}, {"model_", "matrices", CONSTRAINTS},
      {"model_", "correct", CONSTRAINTS}, {"model_", "variation", DERIVATIVES}, {"model_", "second", DERIVATIVES}, {"model_", "linear", DERIVATIVES},
      {"model_", "jumps", DERIVATIVES}, {"model_", "taylor_at", METHOD}, {"model_", "", EQUATIONS}, {"dense.", "", ALGEBRA}, {"", "lag_band_matrix", ALGEBRA}, {"algebra.", "", ALGEBRA},
      {"complementarity.", "", ALGEBRA}, {"collocation.", "", NEWTON}, {"radau.", "put_minus", NEWTON}, {"radau.", "solve", NEWTON},
      {"implicit_symplectic.", "", NEWTON}, {"discrete_lagrangian.", "", NEWTON}, {"projection.", "", CONSTRAINTS}, {"contact.", "", CONSTRAINTS},
      {"nearest_start.", "", CONSTRAINTS}, {"constraint_rank.", "", CONSTRAINTS}, {"rattle.", "", CONSTRAINTS}, {"moreau_contacts.", "", CONSTRAINTS}, {"event_location.", "", EVENTS},
      {"events.", "", EVENTS}, {"event_functions.", "", EVENTS}, {"charge_monitor.", "", MONITORS}, {"monitors.", "", MONITORS}, {"closed_form.", "", MONITORS}, {"error_estimate.", "", MONITORS},
      {"profile_run.", "", OTHER},
      {"", "lag_sincos", EQUATIONS}, {"", "lag_reduce", EQUATIONS}, {"", "lag_rhs", EQUATIONS}, {"", "lag_inputs", EQUATIONS},
      {"", "lag_variation", DERIVATIVES}, {"", "lag_second", DERIVATIVES}, {"", "lag_linear", DERIVATIVES}, {"", "lag_jacobian", DERIVATIVES},
      {"", "lag_solve", ALGEBRA}, {"", "lag_eliminate", ALGEBRA}, {"", "lag_gauss_jordan", ALGEBRA}, {"", "lag_complete_pivot", ALGEBRA},
      {"", "lag_swap", ALGEBRA}, {"", "lag_band", ALGEBRA}, {"", "lag_element", ALGEBRA}, {"", "lag_forward", ALGEBRA}, {"", "lag_backward", ALGEBRA},
      {"", "lag_collocation", NEWTON}, {"", "lag_implicit", NEWTON}, {"", "lag_substep", NEWTON}, {"", "lag_discrete", NEWTON}, {"", "lag_hessian", NEWTON},
      {"", "lag_project", CONSTRAINTS}, {"", "lag_constraint", CONSTRAINTS}, {"", "lag_least", CONSTRAINTS}, {"", "lag_residuals", CONSTRAINTS},
      {"", "lag_contact", CONSTRAINTS}, {"", "lag_rattle", CONSTRAINTS}, {"", "lag_worst", CONSTRAINTS}, {"", "lag_typical", CONSTRAINTS},
      {"", "lag_independen", CONSTRAINTS}, {"", "lag_unit", CONSTRAINTS}, {"", "lag_events", EVENTS}, {"", "lag_event_", OUTPUT}, {"", "lag_crosses", EVENTS},
      {"", "lag_charge", MONITORS}, {"", "lag_energy", MONITORS}, {"", "lag_monitors", MONITORS}, {"", "lag_closed", MONITORS}, {"", "lag_mass", MONITORS},
      {"", "lag_error_estimate", MONITORS}, {"", "lag_app", OUTPUT},
      {"", "", METHOD}};
  const size_t n = sizeof rows / sizeof *rows;
  size_t i = 0;
  while (i + 1 < n && (strncmp(file, rows[i].file, strlen(rows[i].file)) != 0 || strncmp(name, rows[i].name, strlen(rows[i].name)) != 0)) i++;
  return rows[i].part;
}

static int by_address(const void *a, const void *b) {
  uintptr_t x = ((const Function *)a)->begin, y = ((const Function *)b)->begin;
  return (x > y) - (x < y);
}

/* p := the functions in this table of symbols, at their addresses in memory: this function tells how far the program was moved. LAG_OK or LAG_ENOMEM. */
static int take_symbols(Profile *p, const Elf64_Sym *symbol, size_t n, const char *names) {
  const char *file = "";
  uintptr_t moved = 0;
  p->of = calloc(n + 1, sizeof *p->of);
  if (!p->of) return LAG_ENOMEM;
  for (size_t i = 0; i < n; i++) {
    const char *name = names + symbol[i].st_name;
    int type = ELF64_ST_TYPE(symbol[i].st_info), local = ELF64_ST_BIND(symbol[i].st_info) == STB_LOCAL;
    if (type == STT_FILE) file = name;
    if (type != STT_FUNC || symbol[i].st_size == 0) continue;
    Function *f = &p->of[p->n++];
    *f = (Function){.begin = symbol[i].st_value, .end = symbol[i].st_value + symbol[i].st_size};
    snprintf(f->name, sizeof f->name, "%.*s", (int)strcspn(name, "."), name); /* without the compiler's ".constprop.0" */
    f->part = part_of(local ? file : "", f->name);
    if (strcmp(name, "lag_app_where") == 0) moved = (uintptr_t)lag_app_where - f->begin;
  }
  for (int i = 0; i < p->n; i++) {
    p->of[i].begin += moved;
    p->of[i].end += moved;
  }
  qsort(p->of, (size_t)p->n, sizeof *p->of, by_address);
  p->of[p->n] = (Function){.name = "C library", .part = LIBRARY};
  return LAG_OK;
}

/* n bytes of the file from `at` on, to be freed; NULL: there are none. */
static void *read_part(FILE *f, size_t at, size_t n) {
  void *bytes = calloc(n + 1, 1);
  if (bytes && (fseek(f, (long)at, SEEK_SET) != 0 || fread(bytes, 1, n, f) != n)) {
    free(bytes);
    return NULL;
  }
  return bytes;
}

/* Reads this program's table of symbols. LAG_OK; LAG_EINVAL: there is none; LAG_ENOMEM. */
static int read_functions(Profile *p) {
  Elf64_Ehdr head;
  FILE *f = fopen("/proc/self/exe", "r");
  int rc = LAG_EINVAL;
  if (!f || fread(&head, sizeof head, 1, f) != 1) head.e_shnum = 0;
  Elf64_Shdr *section = head.e_shnum ? read_part(f, head.e_shoff, head.e_shnum * sizeof *section) : NULL;
  for (int i = 0; section && i < head.e_shnum && rc == LAG_EINVAL; i++) {
    if (section[i].sh_type != SHT_SYMTAB) continue;
    const Elf64_Shdr *text = &section[section[i].sh_link];
    Elf64_Sym *symbol = read_part(f, section[i].sh_offset, section[i].sh_size);
    char *names = read_part(f, text->sh_offset, text->sh_size);
    rc = symbol && names ? take_symbols(p, symbol, section[i].sh_size / sizeof *symbol, names) : LAG_ENOMEM;
    free(symbol);
    free(names);
  }
  free(section);
  if (f) fclose(f);
  return rc;
}

/* The profile that samples go to: a signal handler can reach nothing else. */
static Profile *sampled;

static void note_sample(int signal_number, siginfo_t *info, void *context) {
  const ucontext_t *at = context;
#ifdef __x86_64__
  uintptr_t pc = (uintptr_t)at->uc_mcontext.gregs[REG_RIP];
#else
  uintptr_t pc = (uintptr_t)at->uc_mcontext.pc;
#endif
  int low = 0, high = sampled->n; /* the last function that begins at or before pc lies in [low, high) */
  (void)signal_number;
  (void)info;
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (sampled->of[middle].begin <= pc) low = middle;
    else high = middle;
  }
  int inside = sampled->n && sampled->of[low].begin <= pc && pc < sampled->of[low].end;
  sampled->samples++;
  if (sampled->writes) sampled->output++;
  else sampled->of[inside ? low : sampled->n].samples++;
}

/* Starts or stops the timer. Its period is no multiple of a millisecond, so that it cannot follow what a system does in such steps. */
static void sample(Profile *p, int on) {
  const struct itimerval every = {.it_interval = {.tv_usec = on ? 197 : 0}, .it_value = {.tv_usec = on ? 197 : 0}};
  struct sigaction action = {.sa_flags = SA_SIGINFO | SA_RESTART};
  action.sa_sigaction = note_sample;
  sigemptyset(&action.sa_mask);
  sampled = p;
  sigaction(SIGALRM, &action, NULL);
  setitimer(ITIMER_REAL, &every, NULL);
}

#else

static int read_functions(Profile *p) {
  (void)p;
  return LAG_EINVAL;
}
static void sample(Profile *p, int on) {
  (void)p;
  (void)on;
}

#endif

/* ---- The run */

/* A whole run, with rows to /dev/null. LAG_OK, LAG_STOPPED, or a failure, after a message. */
static int run_once(Profile *p, double *time) {
  App *app = p->app;
  lag_sim *own = app->sim, *sim = app->sim = lag_app_fresh_sim(app);
  Table table = {0};
  Rows rows = {0};
  double dir = app->until < app->scene->t0 ? -1 : 1, t0 = app->scene->t0, every = app->scene->every;
  int rc = sim ? lag_app_copy_method(own, sim, 1) : LAG_ENOMEM, k = 0;
  if (!(every > 0)) every = fabs(app->until - t0) / 1000;
  if (rc == LAG_OK && (lag_table_init(&table, sim, 0) || !(app->row = realloc(app->row, (size_t)table.ncols * sizeof *app->row)))) rc = LAG_ENOMEM;
  if (rc == LAG_OK && lag_rows_open(&rows, "/dev/null", &table)) rc = LAG_EIO;
  double begin = lag_processor_seconds();
  if (rc == LAG_OK) lag_sim_balance(sim);
  for (double t = t0; rc == LAG_OK && dir * (app->until - t) >= 0; t = t0 + dir * ++k * every) {
    rc = lag_sim_advance(sim, t);
    if (rc < 0) break;
    app->row[0] = lag_sim_time(sim);
    p->writes = 1;
    int bad = lag_sim_outputs(sim, app->row + 1);
    rc = bad ? bad : lag_rows_write(&rows, app->row) ? LAG_EIO : rc;
    p->writes = 0;
  }
  rc = rc == LAG_OK ? lag_sim_advance(sim, app->until) : rc;
  *time = lag_processor_seconds() - begin;
  p->rows = k;
  if (sim) lag_sim_stats(sim, &p->st);
  if (sim && app->scene->model->taylor && lag_sim_method(sim) == &lag_taylor_method) p->order = (int)lag_taylor_order(sim->method_work);
  if (rows.open) lag_rows_close(&rows, 0);
  lag_table_free(&table);
  if (rc < 0) lag_app_error(&app->args, "%s", rc == LAG_ENOMEM || !sim ? "out of memory" : rc == LAG_EIO ? "cannot write to /dev/null" : lag_sim_message(sim));
  lag_sim_free(sim);
  app->sim = own;
  return rc;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Runs for half of `seconds` without the timer, for the time of a run, and for half with it. */
static int profile(Profile *p, double seconds) {
  enum { MOST = 101 };
  double times[MOST], used = 0, time = 0;
  int rc = 0;
  while (rc >= 0 && p->runs < MOST && (p->runs == 0 || used < seconds / 2) && lag_app_interrupted() == EXIT_SIGNAL)
    if ((rc = run_once(p, &time)) >= 0) used += times[p->runs++] = time;
  qsort(times, (size_t)p->runs, sizeof *times, ascending);
  p->time = p->runs ? times[p->runs / 2] : NAN;
  for (used = 0; rc >= 0 && (p->samples == 0 || used < seconds / 2) && lag_app_interrupted() == EXIT_SIGNAL; used += time) {
    sample(p, 1);
    rc = run_once(p, &time);
    sample(p, 0);
  }
  return rc;
}

/* Operations in a nanosecond where each is independent of others: multiplications and additions of numbers of this program, as this compiler makes them. */
static double peak(void) {
  enum { CHAINS = 12, TURNS = 200000 };
  volatile double seed = 1 - 1e-9;
  double x = seed, y = 1e-9 * seed, best = HUGE_VAL;
  for (int repeat = 0; repeat < 5; repeat++) {
    double a = x, b = x + 1, c = x + 2, d = x + 3, e = x + 4, f = x + 5, g = x + 6, h = x + 7, i = x + 8, j = x + 9, k = x + 10, l = x + 11;
    double begin = lag_processor_seconds();
    for (int turn = 0; turn < TURNS; turn++) {
      a = a * x + y, b = b * x + y, c = c * x + y, d = d * x + y, e = e * x + y, f = f * x + y;
      g = g * x + y, h = h * x + y, i = i * x + y, j = j * x + y, k = k * x + y, l = l * x + y;
    }
    best = fmin(best, lag_processor_seconds() - begin);
    seed = x + 1e-30 * (a + b + c + d + e + f + g + h + i + j + k + l);
  }
  return 1e-9 * 2 * CHAINS * TURNS / best;
}

/* ---- Report */

static double share_of(const Profile *p, Part part) {
  long n = part == OUTPUT ? p->output : 0;
  for (int i = 0; i <= p->n; i++)
    if (p->of[i].part == part) n += p->of[i].samples;
  return (double)n / (double)p->samples;
}

/* Processor time of a call of what the method calls: accelerations, a Taylor series, or derivatives of the Lagrangian; NaN: too few samples tell. */
static double call_time(const Profile *p) {
  const double fewest = 100; /* samples, of which a time is known to a tenth */
  if (fmax(share_of(p, EQUATIONS), share_of(p, DERIVATIVES)) * (double)p->samples < fewest) return NAN;
  return fmax(share_of(p, EQUATIONS), share_of(p, DERIVATIVES)) * p->time / (double)p->st.rhs_calls;
}

/* Its operations; NaN: of derivatives, which are not counted. */
static double operations(const Profile *p) {
  const lag_taylor *s = p->app->scene->model->taylor;
  if (share_of(p, DERIVATIVES) > share_of(p, EQUATIONS)) return NAN;
  double n = p->order;
  return n > 0 ? s->cost_first + n * s->cost_next + s->sums * n * (n - 1) : p->app->scene->model->ops;
}

static int by_samples(const void *a, const void *b) {
  long x = ((const Function *)a)->samples, y = ((const Function *)b)->samples;
  return (x < y) - (x > y);
}

static void put_text(const Profile *p, double most) {
  const App *app = p->app;
  char method[256];
  lag_report_method(app, method, sizeof method);
  printf("model %s, scene %s, to t = %.15g s by %s\n%.4g ms of processor time: %lld steps, %lld rows (median of %d runs)\n\n", app->scene->model->name,
         app->scene->name, (double)p->st.t, method, 1e3 * p->time, p->st.steps, p->rows, p->runs);
  printf("  %-34s %8s %12s\n", "", "share", "time [ms]");
  for (Part k = 0; k < PARTS; k++)
    if (share_of(p, k) >= 0.0005) printf("  %-34s %6.1f %% %12.4g\n", part_name[k], 100 * share_of(p, k), 1e3 * p->time * share_of(p, k));
  double ops = operations(p);
  printf(isnan(call_time(p)) ? "\n%s: %lld calls; too few samples tell how long they take: rows further apart leave it more" : "\n%s: %lld calls of %.3g ns", p->order ? "Taylor series" : isnan(ops) ? "derivatives of the equations" : "right-hand side", p->st.rhs_calls, 1e9 * call_time(p));
  if (!isnan(ops) && !isnan(call_time(p))) printf("; %.0f operations (a function counts as one), %.2g in a ns", ops, 1e-9 * ops / call_time(p));
  printf("\nthis processor makes at most %.2g operations in a ns, if all are independent: multiplications and additions, as this compiler makes them\n", most);
  printf("functions with the largest shares, rows apart:");
  for (int i = 0; i < MOST_SHOWN && i <= p->n && p->of[i].samples; i++)
    printf("%s %s %.0f %%", i ? "," : "", p->of[i].name, 100. * (double)p->of[i].samples / (double)p->samples);
  printf("\n%ld samples: a share is uncertain by %.1f %% at most. The mass matrix is solved within the right-hand side, unless it stands under linear\n"
         "algebra; the C library has the functions of <math.h> that the model calls\n", p->samples, 100 / sqrt((double)p->samples));
}

static void put_json(const Profile *p, double most) {
  const App *app = p->app;
  char method[256];
  Json j = {.f = stdout};
  lag_report_method(app, method, sizeof method);
  lag_json_begin(&j, NULL, '{');
  lag_json_string(&j, "model", app->scene->model->name);
  lag_json_string(&j, "scene", app->scene->name);
  lag_json_string(&j, "method", method);
  lag_json_number(&j, "seconds", p->time);
  lag_json_count(&j, "steps", p->st.steps);
  lag_json_count(&j, "calls", p->st.rhs_calls);
  lag_json_number(&j, "call_s", call_time(p));
  lag_json_number(&j, "operations", operations(p));
  lag_json_number(&j, "peak_per_ns", most);
  lag_json_count(&j, "samples", p->samples);
  lag_json_begin(&j, "shares", '{');
  for (Part k = 0; k < PARTS; k++) lag_json_number(&j, part_id[k], share_of(p, k));
  lag_json_end(&j, '}');
  lag_json_end(&j, '}');
  putchar('\n');
}

int lag_app_where(App *app) {
  Profile p = {.app = app};
  double seconds = 10;
  const Args *a = &app->args;
  int rc = lag_app_set_up(app);
  if (rc == 0 && app->until == app->scene->t0)
    rc = lag_app_error(a, "nothing to compute: the run begins and ends at t = %g s; write --until with another time", (double)app->until);
  if (rc == 0 && a->seconds && (!lag_args_number(a, "--seconds", a->seconds, "--seconds 60", &seconds) || seconds <= 0))
    rc = lag_app_error(a, "--seconds %s: the time to spend, for example --seconds 60", a->seconds);
  if (rc) return rc;
  rc = read_functions(&p);
  if (rc) return lag_app_error(a, rc == LAG_ENOMEM ? "out of memory" : "--where needs the names of this program's functions: Linux on x86-64 or aarch64, and no strip");
  lag_app_catch_interrupt();
  rc = profile(&p, fmin(seconds, 3)); /* more shows no more */
  if (rc >= 0 && p.samples) {
    double most = peak();
    qsort(p.of, (size_t)p.n + 1, sizeof *p.of, by_samples);
    if (a->json) put_json(&p, most);
    else if (!a->quiet) put_text(&p, most);
    rc = EXIT_FINE;
  } else {
    rc = rc < 0 ? EXIT_RUN : lag_app_interrupted();
  }
  free(p.of);
  return rc;
}
