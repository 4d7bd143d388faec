/* modelDescription.xml: variables with their units, starts and bounds, and which depends on which. Value references
 * as in core.in. */
#include "fmu/fmu_archive_impl.h"

#include <string.h>

#include "emit/cfunction.h"

/* A variable; values are in SI. */
typedef struct {
  const char *name, *unit, *display; /* SI unit and the user's own; "": none */
  double factor, offset;             /* one display unit in SI; its zero */
  signed char base[7];
  const char *causality, *variability, *initial; /* NULL: not stated */
  int has_start, sign, is_state;
  double start;
  uint32_t derivative_of; /* value reference of the state, 0: none */
} FmuVar;

typedef struct {
  const ProgramSet *u;
  const IrScene *scene;
  const Fmu *f;
  Arena *a;
  StrBuf *out;
  VEC(FmuVar) vars;   /* by value reference; without name: an output that is another variable */
  uint32_t *position; /* by value reference: number in the file, from 1 */
} Description;

/* ---- XML ---- */

/* Appends ` name="value"`, escaped; nothing for NULL and "". */
static void attribute(StrBuf *out, const char *name, const char *value) {
  if (!value || !*value) return;
  sb_printf(out, " %s=\"", name);
  for (const char *c = value; *c; c++)
    if (*c == '&') sb_puts(out, "&amp;");
    else if (*c == '<') sb_puts(out, "&lt;");
    else if (*c == '>') sb_puts(out, "&gt;");
    else if (*c == '"') sb_puts(out, "&quot;");
    else sb_putc(out, (unsigned char)*c < ' ' ? ' ' : *c);
  sb_putc(out, '"');
}

static void number(StrBuf *out, const char *name, double x) { attribute(out, name, shortest_double(out->arena, x)); }

/* ---- variables ---- */

/* Names of units: values are in SI, and shown in the user's unit. */
static void set_unit(Description *d, FmuVar *v, const IrUnit *from) {
  int angle = !from->si[0] && (from->pi_power || strstr(from->text, "rad"));
  int own = from->factor == 1 && from->offset == 0;
  v->unit = own ? from->text : angle ? "rad" : from->si[0] ? from->si : "1";
  if (from->pi_power && from->si[0])
    v->unit = from->si[0] == '1' ? arena_printf(d->a, "rad%s", from->si + 1) : arena_printf(d->a, "rad*%s", from->si);
  v->display = own ? "" : from->text;
  v->factor = from->factor;
  v->offset = from->offset;
  memcpy(v->base, from->base, sizeof v->base);
}

/* The unit of a rate: `m/s` of m, `m/s^2` of m/s. */
static const char *per_second(Arena *a, const char *unit) {
  size_t n = strlen(unit);
  return n == 0                                     ? ""
         : n > 2 && strcmp(unit + n - 2, "/s") == 0 ? arena_printf(a, "%s^2", unit)
                                                    : arena_printf(a, "%s/s", unit);
}

static FmuVar rate_of(Description *d, const FmuVar *of, uint32_t state) {
  enum { SECOND = 2 };
  FmuVar v = {.name = arena_printf(d->a, "%s'", of->name),
              .unit = per_second(d->a, of->unit), .display = per_second(d->a, of->display), .factor = of->factor,
              .causality = "local", .variability = "continuous",
              .derivative_of = state};
  if (of->offset != 0) v.display = "";
  memcpy(v.base, of->base, sizeof v.base);
  if (v.unit[0]) v.base[SECOND]--;
  return v;
}

static FmuVar local_variable(Description *d, const IrVar *from) {
  FmuVar v = {.name = from->name, .causality = "local", .variability = "continuous", .sign = from->sign};
  set_unit(d, &v, from->unit);
  return v;
}

static void start_at(FmuVar *v, long double x) {
  v->start = (double)x;
  v->has_start = 1;
}

static void add_state(Description *d, FmuVar v, long double start) {
  v.is_state = 1;
  v.initial = "exact";
  start_at(&v, start);
  vec_push(d->a, &d->vars, v);
}

/* Inputs and events of contacts are the steps' own. */
static int is_contact_input(const ProgramSet *u, uint32_t i) {
  for (uint32_t k = 0; k < u->contacts.n; k++)
    if (u->contacts.at[k].input == i || (u->contacts.at[k].is_tangent && u->contacts.at[k].force == i)) return 1;
  return 0;
}

static int is_contact_event(const ProgramSet *u, uint32_t i) {
  for (uint32_t k = 0; k < u->contacts.n; k++)
    if (u->contacts.at[k].impact == i || u->contacts.at[k].release == i ||
        (u->contacts.at[k].parts == 1 && u->contacts.at[k].turn == i))
      return 1;
  return 0;
}

/* Variables in the order of their value references. */
/* Outputs; those that are variables already mark these. */
static void add_outputs(Description *d) {
  uint32_t before = d->vars.n;
  for (uint32_t i = 0; i < d->scene->plain.n; i++) {
    FmuVar v = local_variable(d, &d->scene->plain.at[i]);
    v.causality = "output";
    for (uint32_t k = 0; k < before && v.name; k++) {
      FmuVar *same = &d->vars.at[k];
      if (!same->name || strcmp(same->name, v.name) != 0) continue;
      if (strcmp(same->causality, "local") == 0) same->causality = "output";
      v.name = NULL;
    }
    vec_push(d->a, &d->vars, v);
  }
}

static void add_variables(Description *d) {
  const ProgramSet *u = d->u;
  Arena *a = d->a;
  uint32_t n = u->q.n;
  long double *p = ARENA_ARRAY(a, long double, u->p.n + 1), *y = ARENA_ARRAY(a, long double, 2 * n + u->z.n + 1),
              *in = ARENA_ARRAY(a, long double, u->u.n + 1);
  scene_values(u, d->scene, p, y, in);
  FmuVar time = {.name = "t",
                 .unit = "s", .display = "", .factor = 1, .base = {0, 0, 1}, .causality = "independent",
                 .variability = "continuous"};
  vec_push(a, &d->vars, time);
  for (uint32_t i = 0; i < n; i++) add_state(d, local_variable(d, &u->q.at[i]), y[i]);
  for (uint32_t i = 0; i < n; i++) add_state(d, rate_of(d, &d->vars.at[1 + i], 1 + i), y[n + i]);
  for (uint32_t i = 0; i < u->z.n; i++) add_state(d, local_variable(d, &u->z.at[i]), y[2 * n + i]);
  for (uint32_t i = n; i < 2 * n + u->z.n; i++) vec_push(a, &d->vars, rate_of(d, &d->vars.at[1 + i], 1 + i));
  for (uint32_t i = 0; i < u->p.n; i++) {
    FmuVar v = local_variable(d, &u->p.at[i]);
    v.causality = "parameter", v.variability = "tunable", v.initial = "exact";
    start_at(&v, p[i]);
    vec_push(a, &d->vars, v);
  }
  for (uint32_t i = 0; i < u->u.n; i++) {
    FmuVar v = local_variable(d, &u->u.at[i]);
    v.causality = "input";
    start_at(&v, in[i]);
    if (is_contact_input(u, i)) v.name = NULL;
    vec_push(a, &d->vars, v);
  }
  add_outputs(d);
  for (uint32_t i = 0; i < u->events.n; i++) {
    FmuVar v = {.name = arena_printf(a, "event(%s)", u->events.at[i].name),
                .unit = "", .display = "", .factor = 1, .causality = "local",
                .variability = "continuous"};
    if (is_contact_event(u, i)) v.name = NULL;
    vec_push(a, &d->vars, v);
  }
  d->position = ARENA_ARRAY(a, uint32_t, d->vars.n);
  for (uint32_t i = 0, at = 0; i < d->vars.n; i++)
    if (d->vars.at[i].name) d->position[i] = ++at;
}

static const char *sign_text(int sign) {
  return sign == 1 ? "> 0" : sign == 2 ? ">= 0" : sign == -1 ? "< 0" : sign == -2 ? "<= 0" : "";
}

static void write_variable(const Description *d, uint32_t vr) {
  const FmuVar *v = &d->vars.at[vr];
  StrBuf *out = d->out;
  int old = d->f->version == 2, may_jump = d->u->events.n || d->u->constraints.of.n;
  sb_puts(out, old ? "    <ScalarVariable" : "    <Float64");
  attribute(out, "name", v->name);
  sb_printf(out, " valueReference=\"%u\"", vr);
  attribute(out, "description", sign_text(v->sign));
  attribute(out, "causality", v->causality);
  attribute(out, "variability", v->variability);
  attribute(out, "initial", v->initial);
  if (old) sb_puts(out, "><Real");
  attribute(out, "unit", v->unit);
  attribute(out, "displayUnit", v->display);
  if (v->sign) number(out, v->sign > 0 ? "min" : "max", 0);
  if (v->has_start) number(out, "start", v->start);
  if (v->derivative_of) sb_printf(out, " derivative=\"%u\"", old ? d->position[v->derivative_of] : v->derivative_of);
  if (v->is_state && may_jump) attribute(out, "reinit", "true");
  sb_puts(out, old ? "/></ScalarVariable>\n" : "/>\n");
}

/* ---- units ---- */

static int same_unit(const FmuVar *x, const FmuVar *y) { return strcmp(x->unit, y->unit) == 0; }

static void write_unit(const Description *d, uint32_t at) {
  static const char *const si[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  const FmuVar *v = &d->vars.at[at];
  StrBuf *out = d->out;
  sb_puts(out, "    <Unit");
  attribute(out, "name", v->unit);
  sb_puts(out, "><BaseUnit");
  for (int i = 0; i < 7; i++)
    if (v->base[i]) sb_printf(out, " %s=\"%d\"", si[i], v->base[i]);
  int angle = strncmp(v->unit, "rad", 3) == 0 && strchr("/*", v->unit[3]);
  if (angle) attribute(out, "rad", "1");
  sb_puts(out, "/>");
  for (uint32_t i = at; i < d->vars.n; i++) {
    const FmuVar *w = &d->vars.at[i];
    int told = !w->name || !w->display[0] || !same_unit(v, w);
    for (uint32_t k = at; k < i && !told; k++)
      told = d->vars.at[k].name && same_unit(w, &d->vars.at[k]) && strcmp(d->vars.at[k].display, w->display) == 0;
    if (told) continue;
    sb_puts(out, "<DisplayUnit");
    attribute(out, "name", w->display);
    number(out, "factor", 1 / w->factor);
    if (w->offset != 0) number(out, "offset", -w->offset / w->factor);
    sb_puts(out, "/>");
  }
  sb_puts(out, "</Unit>\n");
}

static void write_units(const Description *d) {
  sb_puts(d->out, "  <UnitDefinitions>\n");
  for (uint32_t i = 0; i < d->vars.n; i++) {
    int told = !d->vars.at[i].name || !d->vars.at[i].unit[0];
    for (uint32_t k = 0; k < i && !told; k++) told = d->vars.at[k].name && same_unit(&d->vars.at[i], &d->vars.at[k]);
    if (!told) write_unit(d, i);
  }
  sb_puts(d->out, "  </UnitDefinitions>\n");
}

/* ---- the structure ---- */

/* An unknown; on: the one variable that it depends on, 0: any. */
static void write_unknown(const Description *d, const char *name, uint32_t vr, uint32_t on) {
  int old = d->f->version == 2;
  sb_printf(d->out, "    <%s %s=\"%u\"", old ? "Unknown" : name, old ? "index" : "valueReference",
            old ? d->position[vr] : vr);
  if (on) sb_printf(d->out, " dependencies=\"%u\" dependenciesKind=\"constant\"", old ? d->position[on] : on);
  sb_puts(d->out, "/>\n");
}

static int is_output(const FmuVar *v) { return v->name && strcmp(v->causality, "output") == 0; }

static void open_list(const Description *d, const char *name) {
  if (d->f->version == 2) sb_printf(d->out, "    <%s>\n", name);
}
static void close_list(const Description *d, const char *name) {
  if (d->f->version == 2) sb_printf(d->out, "    </%s>\n", name);
}

static void write_structure(const Description *d) {
  uint32_t n = d->u->q.n, ny = 2 * n + d->u->z.n, some = 0;
  sb_puts(d->out, "  <ModelStructure>\n");
  for (uint32_t i = 0; i < d->vars.n; i++) some += is_output(&d->vars.at[i]) != 0;
  if (some) open_list(d, "Outputs");
  for (uint32_t i = 0; i < d->vars.n; i++)
    if (is_output(&d->vars.at[i])) write_unknown(d, "Output", i, d->vars.at[i].is_state ? i : 0);
  if (some) close_list(d, "Outputs");
  open_list(d, "Derivatives");
  for (uint32_t i = 0; i < n; i++) write_unknown(d, "ContinuousStateDerivative", 1 + n + i, 1 + n + i);
  for (uint32_t i = n; i < ny; i++) write_unknown(d, "ContinuousStateDerivative", 1 + ny + i - n, 0);
  close_list(d, "Derivatives");
  open_list(d, "InitialUnknowns");
  for (uint32_t i = 1; i < d->vars.n; i++) {
    const FmuVar *v = &d->vars.at[i];
    if (v->name && !v->initial && (is_output(v) || v->derivative_of)) write_unknown(d, "InitialUnknown", i, 0);
  }
  close_list(d, "InitialUnknowns");
  for (uint32_t i = d->vars.n - d->u->events.n; i < d->vars.n && d->f->version == 3 && !d->u->contacts.n; i++)
    write_unknown(d, "EventIndicator", i, 0);
  sb_puts(d->out, "  </ModelStructure>\n");
}

/* ---- the file ---- */

static void write_interface(const Description *d, const char *kind, const char *more) {
  int old = d->f->version == 2;
  sb_printf(d->out, "  <%s", kind);
  attribute(d->out, "modelIdentifier", d->f->identifier);
  sb_printf(d->out, " %s=\"true\" %s=\"true\"%s", old ? "canGetAndSetFMUstate" : "canGetAndSetFMUState",
            old ? "canSerializeFMUstate" : "canSerializeFMUState", more);
  if (d->f->has_derivatives)
    attribute(d->out, old ? "providesDirectionalDerivative" : "providesDirectionalDerivatives", "true");
  if (!old) sb_puts(d->out, "/>\n");
  else
    sb_printf(d->out,
              " canNotUseMemoryManagementFunctions=\"true\">\n    <SourceFiles><File "
              "name=\"fmu_archive.c\"/></SourceFiles>\n  </%s>\n",
              kind);
}

void fmu_describe(const ProgramSet *u, const Fmu *f, StrBuf *out) {
  Description d = {.u = u, .scene = &u->scenes.at[0], .f = f, .a = u->arena, .out = out};
  int old = f->version == 2;
  add_variables(&d);
  sb_puts(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription");
  attribute(out, "fmiVersion", old ? "2.0" : "3.0");
  attribute(out, "modelName", u->name);
  attribute(out, old ? "guid" : "instantiationToken", f->token);
  attribute(out, "description",
            arena_printf(d.a, "%s; scene %s; effects in use: %s", u->doc[0] ? u->doc : u->name, d.scene->name,
                         u->effects[0] ? u->effects : "none"));
  attribute(out, "license", "0BSD: any use, without conditions");
  attribute(out, "generationTool", "lagc");
  attribute(out, "variableNamingConvention", "flat");
  if (old) sb_printf(out, " numberOfEventIndicators=\"%u\"", u->contacts.n ? 0 : u->events.n);
  sb_puts(out, ">\n");
  if (!u->contacts.n)
    write_interface(&d, "ModelExchange",
                    old || !(u->events.n || u->constraints.of.n) ? "" : " needsCompletedIntegratorStep=\"true\"");
  int stops = 0;
  for (uint32_t i = 0; i < u->events.n; i++) stops |= u->events.at[i].stop;
  const char *early = !old && stops ? " mightReturnEarlyFromDoStep=\"true\"" : "";
  write_interface(&d, "CoSimulation", arena_printf(d.a, " canHandleVariableCommunicationStepSize=\"true\"%s", early));
  write_units(&d);
  sb_puts(out, "  <DefaultExperiment");
  number(out, "startTime", d.scene->t0);
  if (d.scene->t1 > d.scene->t0) number(out, "stopTime", d.scene->t1);
  number(out, "tolerance", d.scene->tolerance > 0 ? d.scene->tolerance : FMU_TOLERANCE);
  if (d.scene->every > 0) number(out, "stepSize", d.scene->every);
  sb_puts(out, "/>\n  <ModelVariables>\n");
  for (uint32_t i = 0; i < d.vars.n; i++)
    if (d.vars.at[i].name) write_variable(&d, i);
  sb_puts(out, "  </ModelVariables>\n");
  write_structure(&d);
  sb_puts(out, "</fmiModelDescription>\n");
}
