/* Known runs (known_run.h): names of entries, what they hold, and the start of a simulator. */
#include "commands/known_run.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "commands/simulator.h"
#include "self_check/self_check.h"
#include "toolchain/files.h"
#include "toolchain/process.h"
#include "toolchain/simulator_cache.h"

enum { LARGE = 1000 }; /* coordinates, beyond which the compiler's memory is not kept during the run */

/* Fields of an entry: a letter, a length, a space and so many bytes. */
enum {
  SIMULATOR = 's',
  EVALUATOR = 'e',
  LIBRARY = 'c',
  BYTES = 'b',
  ARGUMENT = 'a',
  NUMBER = 'n',
  READ = 'r',
  ABSENT = 'x',
  SAID = 'm',
  LISTENS = 'l'
};

struct KnownRun {
  const char *paths[2];      /* of entries, for any numbers and for these; NULL: the command is never known */
  VEC(const char *) numbers; /* words name=NUMBER */
};

/* --- names --- */

static int can_be_known(const Compiler *c) {
  return command_simulates(c->o.command) && c->o.command != CMD_COST && !c->o.dump;
}

static int is_setting_of_number(const char *word) {
  const char *eq = word[0] != '-' ? strchr(word, '=') : NULL;
  return eq && eq > word && text_is_number(eq + 1);
}

static void list_numbers(Compiler *c, KnownRun *k) {
  for (uint32_t i = 0; i < c->o.rest.n; i++) {
    const char *word = c->o.rest.at[i];
    if (word[0] == '-' && option_takes_next(c->o.command, word)) i++;
    else if (is_setting_of_number(word)) vec_push(c->arena, &k->numbers, word);
  }
}

static int is_number_of(const KnownRun *k, const char *word) {
  for (uint32_t i = 0; i < k->numbers.n; i++)
    if (k->numbers.at[i] == word) return 1;
  return 0;
}

/* The words of the command line, each on a line; of `name=NUMBER` the name, unless exact. Values may name files. */
static void add_words(const Compiler *c, const KnownRun *k, int exact, StrBuf *b) {
  for (char *const *w = c->words + 1; *w; w++) {
    const char *eq = strchr(*w, '=');
    if (!exact && is_number_of(k, *w)) sb_printf(b, "%.*s=NUMBER\n", (int)(eq - *w), *w);
    else sb_printf(b, "%s%s\n", *w, eq && file_exists(eq + 1) ? " file" : "");
  }
}

static const char *entry_path(Compiler *c, const KnownRun *k, const Toolchain *t, const char *cache, int exact) {
  StrBuf b = strbuf(c->arena);
  sb_printf(&b, "%d %s\n", exact, c->o.file);
  add_words(c, k, exact, &b);
  sb_printf(&b, "%s\n%s", toolchain_own_build(c->arena, t, c->argv0), simulator_surroundings(c));
  const char *data = options_passed(&c->o, "--data"), *why, *head = data ? data_head(c->arena, data, &why) : NULL;
  if (head) sb_printf(&b, "\n%s", head);
  if (c->o.resume) sb_printf(&b, "\n%s", method_of_state(c->arena, c->o.resume));
  SourceText texts[] = {{"words", sb_text(&b)}, {"model", c->sources->files.at[0].text}};
  return arena_printf(c->arena, "%s/%s.run", cache, toolchain_entry(c->arena, t, texts, 2));
}

static KnownRun *new_known_run(Compiler *c) {
  KnownRun *k = ARENA_NEW(c->arena, KnownRun);
  Toolchain t;
  const char *error, *cache = can_be_known(c) ? cache_folder(c->arena) : NULL;
  if (!cache || !toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &t, &error) ||
      (c->o.precision && !toolchain_precision(c->arena, &t, c->o.precision, &error)))
    return k;
  list_numbers(c, k);
  for (int exact = 0; exact < 2; exact++) k->paths[exact] = entry_path(c, k, &t, cache, exact);
  return k;
}

/* --- entries --- */

static void add_field(StrBuf *b, char kind, const char *text) {
  sb_printf(b, "%c%zu ", kind, strlen(text));
  sb_puts(b, text);
}

/* The next field; its kind, 0 at the end. */
static char next_field(Arena *a, const char **at, const char *end, const char **text) {
  char kind = *at < end ? **at : '\0', *after;
  if (!kind) return 0;
  size_t n = (size_t)strtoull(*at + 1, &after, 10);
  if (*after != ' ' || n > (size_t)(end - after - 1)) return 0;
  *text = arena_strndup(a, after + 1, n);
  *at = after + 1 + n;
  return kind;
}

static const char *hash_and_path(Arena *a, const Source *f) {
  uint64_t h = lag_fnv1a(LAG_FNV1A_START, f->text, f->len);
  return arena_printf(a, "%016llx %s", (unsigned long long)h, f->path);
}

/* Reads the file of a field, as another file of the model; whether it is still the same. */
static int is_still(Compiler *c, const char *field) {
  const char *space = strchr(field, ' '), *error;
  const Source *f = space ? source_read(c->sources, space + 1, &error) : NULL;
  return f && strcmp(hash_and_path(c->arena, f), field) == 0;
}

typedef struct {
  const char *simulator; /* in the cache */
  const char *said;      /* messages */
  const char *bytes;     /* hash of the program's bytes */
  int listens;
  EvaluatedRun by; /* evaluator NULL: the run is compiled */
} Found;

/* Takes a field of an entry; whether the run is still known. */
static int take_field(Compiler *c, char kind, const char *text, Found *f) {
  uint32_t k;
  switch (kind) {
  case SIMULATOR: f->by.simulator = text; return 1;
  case EVALUATOR: f->by.evaluator = text; return 1;
  case LIBRARY: f->by.library = text; return 1;
  case BYTES: f->bytes = text; return 1;
  case ARGUMENT: vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, text)); return 1;
  case NUMBER:
    if ((k = (uint32_t)atoi(text)) >= c->known->numbers.n) return 0;
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, c->known->numbers.at[k]));
    return 1;
  case READ: return is_still(c, text);
  case ABSENT: return !source_is_readable(text);
  case SAID: f->said = text; return 1;
  case LISTENS: return f->listens = 1;
  default: return 0;
  }
}

/* Programs of an entry as bytes, where they are evaluated. */
static const char *program_path(Compiler *c, const char *entry) {
  return arena_printf(c->arena, "%.*s.bytes", (int)(strrchr(entry, '.') - entry), entry);
}

/* An entry and its bytes are two files, of which an interruption, or another process, may have written one. */
static const char *hash_of(Arena *a, const StrBuf *bytes) {
  return arena_printf(a, "%016llx", (unsigned long long)lag_fnv1a(LAG_FNV1A_START, sb_text(bytes), bytes->n));
}

static int has_bytes(Compiler *c, const char *entry, Found *f) {
  return cache_read(program_path(c, entry), &f->by.bytes) && strcmp(hash_of(c->arena, &f->by.bytes), f->bytes) == 0;
}

/* Whether there is an entry, and all is as it was; then its arguments are in c->picture.argv. */
static int find(Compiler *c, const char *entry, Found *f) {
  StrBuf text = strbuf(c->arena);
  const char *field;
  *f = (Found){.said = "", .bytes = "", .by.bytes = strbuf(c->arena)};
  c->picture.argv.n = 0;
  c->sources->files.n = 1;
  if (!cache_read(entry, &text)) return 0;
  const char *at = sb_text(&text), *end = at + text.n;
  for (char kind; (kind = next_field(c->arena, &at, end, &field)) != 0;)
    if (!take_field(c, kind, field, f)) return 0;
  if (!c->picture.argv.n) return 0;
  vec_push(c->arena, &c->picture.argv, NULL);
  f->simulator = simulator_compiled(c, &f->by);
  if (f->simulator) f->by.evaluator = NULL;
  else f->simulator = has_bytes(c, entry, f) ? f->by.evaluator : NULL;
  return f->simulator != NULL;
}

/* Which of the numbers the argument is; -1: none. */
static int number_of(const KnownRun *k, const char *word) {
  for (uint32_t i = 0; i < k->numbers.n; i++)
    if (strcmp(k->numbers.at[i], word) == 0) return (int)i;
  return -1;
}

/* The arguments; *all: each number is one of them. */
static void add_arguments(Compiler *c, StrBuf *b, int exact, uint32_t *numbers) {
  char index[16];
  *numbers = 0;
  for (uint32_t i = 0; i < c->picture.argv.n && c->picture.argv.at[i]; i++) {
    int k = exact ? -1 : number_of(c->known, c->picture.argv.at[i]);
    snprintf(index, sizeof index, "%d", k);
    add_field(b, k < 0 ? ARGUMENT : NUMBER, k < 0 ? c->picture.argv.at[i] : index);
    *numbers += k >= 0;
  }
}

static void keep(Compiler *c, const Found *f) {
  StrBuf b = strbuf(c->arena), arguments = strbuf(c->arena);
  uint32_t numbers;
  if (f->by.simulator) add_field(&b, SIMULATOR, f->by.simulator);
  if (f->by.library) add_field(&b, LIBRARY, f->by.library);
  if (f->by.evaluator) {
    add_field(&b, EVALUATOR, f->by.evaluator);
    add_field(&b, BYTES, hash_of(c->arena, &f->by.bytes));
  }
  for (uint32_t i = 1; i < c->sources->files.n; i++)
    if (c->sources->files.at[i].is_file) add_field(&b, READ, hash_and_path(c->arena, &c->sources->files.at[i]));
  for (uint32_t i = 0; i < c->sources->absent.n; i++) add_field(&b, ABSENT, c->sources->absent.at[i]);
  add_field(&b, SAID, f->said);
  if (f->listens) add_field(&b, LISTENS, "");
  add_arguments(c, &arguments, 0, &numbers);
  int exact = numbers != c->known->numbers.n;
  if (exact) {
    arguments.n = 0;
    add_arguments(c, &arguments, exact, &numbers);
  }
  sb_putn(&b, sb_text(&arguments), arguments.n);
  const char *path = c->known->paths[exact];
  if (!f->by.evaluator || cache_write(program_path(c, path), &f->by.bytes)) cache_write(path, &b);
}

/* --- the start --- */

/* Whether an output of the simulator would overwrite a file of the model. */
static int writes_source(Compiler *c) {
  for (char *const *a = c->picture.argv.at; *a; a++) {
    const char *eq = strncmp(*a, "--", 2) == 0 ? strchr(*a, '=') : NULL;
    if (compiler_is_source(c, eq ? eq + 1 : *a)) return 1;
  }
  return 0;
}

/* After a run that lacked a finite value: reports the expression of the text that has none. A known run is derived
 * only now. */
static void tell_last_state(void *compiler, const double *number, uint32_t n) {
  Compiler *c = compiler;
  Units units = {0};
  if (!c->run && !simulator_derive_again(c, &units)) return;
  c->diags->list.n = 0; /* they have been printed */
  if (nonfinite_note(c->run, c->run_by, number, n)) compiler_print_messages(c);
}

/* A thread that waits for others sleeps soon (libgomp: after 15 ms by itself), so that a machine with other work to do
 * does it. */
static void let_threads_sleep(void) {
  if (!getenv("GOMP_SPINCOUNT") && !getenv("OMP_WAIT_POLICY")) process_set("GOMP_SPINCOUNT", "1000");
  if (!getenv("KMP_BLOCKTIME") && !getenv("OMP_WAIT_POLICY")) process_set("KMP_BLOCKTIME", "0");
}

static int start(Compiler *c, const Found *f, const Units *units) {
  if (writes_source(c)) return STATUS_USAGE;
  int status = f->by.evaluator ? simulator_hand_over(c, &f->by, units) : STATUS_OK;
  if (status != STATUS_OK) return status;
  fflush(stdout);
  fputs(f->said, stderr); /* before: the simulator does not come back */
  if (c->o.threads) let_threads_sleep();
  if (f->listens) last_state_listen(c->arena, tell_last_state, c);
  process_become(f->simulator, c->picture.argv.at);
  const char *why = strerror(errno);
  return usage_error(arena_printf(c->arena, "cannot run %s: %s; set XDG_CACHE_HOME to a folder where programs may run",
                                  f->simulator, why));
}

int known_run_start(Compiler *c, int *known) {
  Found f;
  c->known = new_known_run(c);
  for (int exact = 0; exact < 2 && !*known; exact++)
    *known = c->known->paths[exact] && find(c, c->known->paths[exact], &f);
  if (*known) return start(c, &f, NULL);
  c->picture = (RunRequest){0};
  c->sources->files.n = 1;
  return STATUS_OK;
}

static Found new_run(Compiler *c, const char *path) {
  StrBuf said = strbuf(c->arena);
  if (!simulator_is_later_rank(c)) compiler_messages(c, &said);
  if (c->picture.note) sb_printf(&said, "%s\n", c->picture.note);
  return (Found){
      .simulator = path, .said = sb_text(&said), .listens = c->run && c->run->n <= LARGE && c->o.command != CMD_SWEEP};
}

int known_run_keep_and_start(Compiler *c, const char *path) {
  Found f = new_run(c, path);
  f.by.simulator = file_name(path);
  if (c->known->paths[0]) keep(c, &f);
  return start(c, &f, NULL);
}

int known_run_evaluate(Compiler *c, const EvaluatedRun *by, const Units *units) {
  Found f = new_run(c, by->evaluator);
  f.by = *by;
  if (c->known->paths[0] && c->o.command != CMD_SWEEP) keep(c, &f); /* a sweep is compiled once there is a compiler */
  return start(c, &f, units);
}
