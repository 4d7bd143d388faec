/* FMUs: sources, token, archive. */
#include "fmu/fmu_archive.h"

#include <string.h>

#include "base/hash.h"
#include "emit/cfunction.h"
#include "emit/emit_model.h"
#include "emit/late_text.h"
#include "fmu/core_text.h" /* static const char *const core_text[]: generated from core.in */
#include "fmu/cosimulation_text.h"
#include "fmu/exchange_text.h"
#include "fmu/fmu_archive_impl.h"
#include "fmu/fmi2_text.h"
#include "fmu/fmi3_text.h"
#include "fmu/zip.h"
#include "kernels/steppers.def"

/* ---- sources/fmu.c ---- */

static void define(StrBuf *out, const char *name, uint32_t n) { sb_printf(out, "#define %s %u\n", name, n); }

/* The step of the scene's method, or 1/10000 of its span. */
static double step_size(const IrScene *s) {
  for (uint32_t i = 0; i < s->options.n; i++)
    if (strcmp(s->options.at[i].name, "step") == 0 && s->options.at[i].value > 0) return s->options.at[i].value;
  return (s->t1 > s->t0 ? s->t1 - s->t0 : 10) / 1e4;
}

/* The explicit Runge-Kutta method of the scene, with *is_fixed, where its steps alone make the motion; else dop853:
 * events lie on its dense output. */
static const char *step_method(const ProgramSet *u, int moreau, int *is_fixed) {
  enum { FIXED, ADAPTIVE, LATE };
#define STEP_ROW(name, table, kind, dense, order, line, words) {#name, kind},
  static const struct { const char *name; int kind; } rows[] = {LAG_RUNGE_KUTTA_METHODS(STEP_ROW)};
  const IrScene *s = &u->scenes.at[0];
  int chosen = s->method && !u->events.n && !moreau;
  *is_fixed = 0;
  for (uint32_t i = 0; i < s->options.n; i++) chosen &= strcmp(s->options.at[i].name, "adapt") != 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows && chosen; i++) {
    if (strcmp(rows[i].name, s->method) != 0) continue;
    *is_fixed = rows[i].kind == FIXED;
    return rows[i].name;
  }
  return "dop853";
}

static const char *with_inputs(const ProgramSet *u) {
  return u->u.n ? "_with(&(m)->p, &(m)->s, h, set_inputs, m)" : "(&(m)->p, &(m)->s, h)";
}

/* Macros that call functions of the header with the arguments that it has. */
static void write_calls(const ProgramSet *u, const Fmu *f, StrBuf *out) {
  sb_printf(out, "#define ARGUMENTS(s, p, u) (s)->t%s%s, p%s\n", u->q.n ? ", (s)->q, (s)->v" : "",
            u->z.n ? ", (s)->z" : "", u->u.n ? ", u" : "");
  sb_printf(out, "#define WITH_MODES(s, p, u) (s)->t%s%s, p, u\n", u->q.n ? ", (s)->q, (s)->v" : "",
            u->z.n ? ", (s)->z" : "");
  sb_printf(out, "#define GIVEN(m, u)%s\n", u->u.n ? " &(m)->p, (m)->s.t, u, NULL, NULL," : "");
  sb_printf(out, "#define AND_INPUTS(u)%s\n#define BY_TIME(m)%s\n", u->u.n ? " , u" : "",
            u->u.n ? " NULL, set_inputs, m," : "");
  sb_printf(out, "#define BY_INPUTS(m)%s\n", u->u.n ? " , NULL, set_inputs, m" : "");
  int keeps = u->events.n && !f->moreau, some = u->u.n > 0, is_fixed;
  const char *method = step_method(u, f->moreau, &is_fixed);
  if (is_fixed)
    sb_printf(out, "#define EQUAL_STEP %.17g\n#define EQUAL(m, h) model_%s_step%s\n"
                   "#define STEP(m, until, path) equal_step(m, until)\n",
              step_size(&u->scenes.at[0]), method, with_inputs(u));
  else
    sb_printf(out, "#define STEP(m, until, path) model_%s_%s(&(m)->p, &(m)->s, &(m)->w, until%s%s%s)\n", method,
            keeps ? "keep" : some ? "step_with" : "step", keeps && some ? ", NULL" : "", some ? ", set_inputs, m" : "",
            keeps ? ", (path)->k" : "");
}

/* Sizes, and arguments of the header's functions, which leave out what the model lacks. */
static void write_head(const ProgramSet *u, const Fmu *f, StrBuf *out) {
  const IrScene *s = &u->scenes.at[0];
  sb_printf(out, "/* fmu_archive.c: the model %s, scene %s, as an FMU of FMI %d.0. All that is to be compiled.\n",
            u->name, s->name, f->version);
  sb_puts(out, " * This text may be used for any purpose without conditions (0BSD). */\n");
  sb_puts(out,
          "#include <math.h>\n#include <stdbool.h>\n#include <stdint.h>\n#include <stdlib.h>\n#include <string.h>\n\n");
  sb_puts(out, "#define MODEL_STATIC\n#include \"model.h\"\n\n");
  sb_puts(out, "#if defined(_WIN32)\n#define EXPORTED __declspec(dllexport)\n#elif defined(__GNUC__)\n#define EXPORTED "
               "__attribute__((visibility(\"default\")))\n"
               "#else\n#define EXPORTED\n#endif\n\n");
  define(out, "NQ", u->q.n);
  define(out, "NZ", u->z.n);
  sb_puts(out, "#define NY (2*NQ + NZ)\n");
  define(out, "NP", u->p.n);
  define(out, "NU", u->u.n);
  define(out, "NEV", u->events.n);
  define(out, "NOUT", s->plain.n);
  define(out, "HOLDS", u->constraints.of.n > 0);
  define(out, "CONTACTS", program_set_contacts(u));
  define(out, "GUIDES", program_set_guides(u));
  if (u->constraints.of.n)
    sb_printf(out, "#define CORRECT model_correct%s\n",
              u->constraints.position == u->constraints.velocity ? "" : "_velocities");
  define(out, "FRICTION", (uint32_t)(f->moreau && header_rubs(u)));
  if (f->moreau)
    sb_printf(out, "#define MOREAU_STEP %.17g\n#define MOREAU(m, h) model_moreau_step%s\n", step_size(s),
              with_inputs(u));
  define(out, "HELD", u->held_accel != NULL);
  if (f->moreau)
    sb_printf(out, "#define SURFACE(m) (m)->s.%s\n#define ACCELERATIONS model_%saccel\n#define DERIVED(f) %s\n",
              program_set_contacts(u) ? "holds" : "touch", u->held_accel ? "held_" : "",
              u->q.n && u->z.n ? "f + NQ, f + 2*NQ" : "f + NQ");
  define(out, "NMODES", u->nmodes);
  define(out, "KICKS", program_set_kick(u) != NULL);
  define(out, "DERIVATIVES", (uint32_t)f->has_derivatives);
  define(out, "OUTPUT_DERIVATIVES", u->outputs_at.n);
  sb_printf(out, "#define TOKEN \"%s\"\n", f->token);
  sb_printf(out, "#define START_TIME %.17g\n#define TOLERANCE %.17g\n", s->t0,
            s->tolerance > 0 ? s->tolerance : FMU_TOLERANCE);
  write_calls(u, f, out);
}

static void write_tables(const ProgramSet *u, StrBuf *out) {
  sb_puts(out, "\nstatic const char *const param_name[] = {");
  for (uint32_t i = 0; i < u->p.n; i++) sb_printf(out, "%s, ", c_string(u->arena, u->p.at[i].name));
  sb_puts(out, "NULL};\nstatic const signed char param_sign[] = {"); /* 1: > 0, 2: >= 0, -1: < 0, -2: <= 0 */
  for (uint32_t i = 0; i < u->p.n; i++) sb_printf(out, "%d, ", u->p.at[i].sign);
  sb_puts(out, "0}; /* 1: > 0, 2: >= 0, -1: < 0, -2: <= 0 */\nstatic const signed char event_direction[] = {");
  for (uint32_t i = 0; i < u->events.n; i++) sb_printf(out, "%d, ", u->events.at[i].direction);
  sb_puts(out, "0};\n");
  if (!u->contacts.n) return;
  if (program_set_contacts(u)) {
    sb_puts(out, "static const int contact_input[][2] = {");
    for (uint32_t i = 0; i < program_set_contacts(u); i++) {
      const IrContact *c = &u->contacts.at[i];
      sb_printf(out, "%s{%u, %d}", i ? ", " : "", c->input, c->is_tangent ? (int)c->force : -1);
    }
    sb_puts(out, "}; /* input that closes it; input of its force, -1: it is a gap */\n");
  }
  sb_puts(out, "static const int contact_event[] = {");
  for (uint32_t i = 0; i < u->contacts.n; i++) {
    const IrContact *c = &u->contacts.at[i];
    sb_printf(out, "%s%u, %u", i ? ", " : "", c->impact, c->release);
    if (c->parts == 1) sb_printf(out, ", %u", c->turn);
  }
  sb_puts(out, "};\n");
}

#define APPEND(text, out) \
  for (size_t line = 0; line < sizeof text / sizeof *text; line++) sb_puts(out, text[line])

/* 128 bits of hash, written as a UUID is. */
static const char *token_of(Arena *a, const StrBuf *text) {
  uint64_t x = lag_fnv1a(LAG_FNV1A_START, text->at, text->n), y = lag_fnv1a(0x9e3779b97f4a7c15u, text->at, text->n);
  return arena_printf(a, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(x >> 32), (unsigned)(x >> 16 & 0xffff),
                      (unsigned)(x & 0xffff), (unsigned)(y >> 48), (unsigned long long)(y & 0xffffffffffffu));
}

static void write_wrapper(const ProgramSet *u, const Fmu *f, StrBuf *out) {
  write_head(u, f, out);
  write_tables(u, out);
  APPEND(core_text, out);
  APPEND(exchange_text, out);
  APPEND(cosimulation_text, out);
  if (f->version == 2) APPEND(fmi2_text, out);
  else APPEND(fmi3_text, out);
}

static const char *build_description(Arena *a, const char *identifier) {
  return arena_printf(a,
                      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  "
                      "<BuildConfiguration modelIdentifier=\"%s\">\n"
                      "    <SourceFileSet language=\"C11\"><SourceFile name=\"fmu_archive.c\"/></SourceFileSet>\n  "
                      "</BuildConfiguration>\n</fmiBuildDescription>\n",
                      identifier);
}

#define DERIVATIVES "jac,linear"

unsigned fmu_wants(void) { return header_wants(DERIVATIVES ",params") | WANT_OUTPUTS | WANT_HELD; }

int fmu_make(const ProgramSet *u, int version, const char *equations, Fmu *f, const char **error) {
  Arena *a = u->arena;
  HeaderParts parts = {.prefix = "model", .follows = 1};
  for (uint32_t i = 0; i < u->contacts.n; i++)
    if (u->contacts.at[i].conditional)
      return fail_with(error, "an FMU has no constraints with `while`, which need a solver of their own: `lagc build "
                              "--shared` makes a library that has them");
  HeaderParts steps = parts;
  int moreau = header_parts(u, "dop853,moreau", &steps, error), is_fixed;
  const char *method = step_method(u, moreau, &is_fixed);
  if (moreau) parts = steps;
  else if (u->contacts.n || !header_parts(u, arena_printf(a, "dop853,%s", method), &parts, error)) return 0;
  HeaderParts more = parts;
  int has_derivatives = u->outputs && header_parts(u, u->p.n ? DERIVATIVES ",params" : DERIVATIVES, &more, error);
  if (u->events.n) parts.parts |= PART_PATH, more.parts |= PART_PATH;
  if (has_derivatives) parts = more, parts.parts |= u->outputs_at.n ? PART_OUTPUTS : 0;
  *f = (Fmu){.version = version,
             .identifier = cname(a, u->name),
             .token = "",
             .has_derivatives = has_derivatives,
             .moreau = moreau};
  StrBuf header = strbuf(a), all = strbuf(a), wrapper = strbuf(a), description = strbuf(a);
  emit_header(u, "model", parts, equations, &header);
  header = late_text_write(&header);
  f->header = sb_text(&header);
  sb_puts(&all, f->header);
  write_wrapper(u, f, &all);
  fmu_describe(u, f, &all);
  f->token = token_of(a, &all);
  write_wrapper(u, f, &wrapper);
  f->wrapper = sb_text(&wrapper);
  fmu_describe(u, f, &description);
  f->description = sb_text(&description);
  f->build = version == 3 ? build_description(a, f->identifier) : NULL;
  return 1;
}

/* ---- the archive ---- */

typedef struct {
  const char *machine, *system; /* parts of the compiler's name of its machine */
  const char *fmi2, *fmi3;      /* folders of binaries */
  const char *ending;
} Platform;

static const Platform platforms[] = {
  {"x86_64", "linux", "linux64", "x86_64-linux", "so"},    {"86", "linux", "linux32", "x86-linux", "so"},
  {"aarch64", "linux", "aarch64-linux", "aarch64-linux", "so"}, {"x86_64", "mingw", "win64", "x86_64-windows", "dll"},
  {"86", "mingw", "win32", "x86-windows", "dll"},          {"x86_64", "darwin", "darwin64", "x86_64-darwin", "dylib"},
  {"arm64", "darwin", "aarch64-darwin", "aarch64-darwin", "dylib"},
};

/* The path of the binary in the archive; NULL, with *error. */
static const char *binary_path(Arena *a, const Fmu *f, const char *machine, const char **error) {
  const Platform *p = platforms, *end = platforms + sizeof platforms / sizeof *platforms;
  while (p < end && !(strstr(machine, p->machine) && strstr(machine, p->system))) p++;
  if (p < end)
    return arena_printf(a, "binaries/%s/%s.%s", f->version == 2 ? p->fmi2 : p->fmi3, f->identifier, p->ending);
  *error = arena_printf(a, "FMI has no name for the machine %.*s: take a compiler for Linux, Windows or macOS",
                        (int)strcspn(machine, "\n"), machine);
  return NULL;
}

static ZipFile text_file(const char *name, const char *text) { return (ZipFile){name, text, strlen(text)}; }

int fmu_pack(const Fmu *f, const FmuBinary *of, uint32_t n, StrBuf *out, const char **error) {
  Arena *a = out->arena;
  VEC(ZipFile) files = {0};
  for (uint32_t i = 0; i < n; i++) {
    const char *path = binary_path(a, f, of[i].machine, error);
    if (!path) return 0;
    for (uint32_t k = 0; k < i; k++)
      if (strcmp(files.at[k].name, path) == 0)
        return fail_with(error, arena_printf(a, "two compilers make %s: name each machine once", path));
    vec_push(a, &files, ((ZipFile){path, of[i].library.at, of[i].library.n}));
  }
  vec_push(a, &files, text_file("modelDescription.xml", f->description));
  if (f->build) vec_push(a, &files, text_file("sources/buildDescription.xml", f->build));
  vec_push(a, &files, text_file("sources/fmu.c", f->wrapper));
  vec_push(a, &files, text_file("sources/model.h", f->header));
  return zip_write(files.at, files.n, out, error);
}
