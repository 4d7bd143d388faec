/* An importer of FMUs, written from the FMI standard 2.0 and 3.0 (-DFMI=2 or 3): loads an unpacked FMU and compares
 * its motion with rows of a table, or tries what the standard asks of saved states, refusals and the end of a run.
 *   fmu_import FOLDER BINARY MODE TABLE.csv TOLERANCE SUBSTEPS [name=value ...]
 * me: model exchange, by the classical Runge-Kutta method with SUBSTEPS steps a row, and bisection to events. cs:
 * co-simulation, a step a row. halts: a motion that ends at t = 1, where a force loses its value: the standard's
 * answers. derivatives: directional derivatives by the variables named, beside differences. saved: co-simulation, in
 * which each row is computed anew from a saved and from a serialized state, with the same bits. @name=value: set
 * after the start. */
#ifdef _WIN32
#include <windows.h>
#define dlopen(path, flags) LoadLibraryA(path)
#define dlsym(library, name) (void *)GetProcAddress(library, name)
#define dlerror() "the library cannot be loaded"
#else
#include <dlfcn.h>
#endif
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 400, TEXT = 1 << 20 };
typedef void *Instance;
typedef unsigned Ref;
#if FMI == 2
typedef int Bool;
#define PREFIX "fmi2"
#define SPELLED(two, three) "fmi2" two
#define STATE "FMUstate"
#define DESERIALIZE "fmi2DeSerializeFMUstate"
#else
typedef bool Bool;
#define PREFIX "fmi3"
#define SPELLED(two, three) "fmi3" three
#define STATE "FMUState"
#define DESERIALIZE "fmi3DeserializeFMUState"
#endif

static char xml[TEXT];
static void *library;
static Instance c;
static double now, tolerance_of_run, next_event = HUGE_VAL; /* time of the next time event */
static int nx, nevents, stopped, messages;

static void fail(const char *what) {
  fprintf(stderr, "fmu_import: %s\n", what);
  exit(1);
}

static void *function(const char *name) {
  void *f = dlsym(library, name);
  if (!f) fprintf(stderr, "%s: ", name), fail("no such function");
  return f;
}
/* CALL(name, (types), args...): a function of the library that returns a status. */
#define CALL(name, types, ...) (((int (*) types)function(name))(__VA_ARGS__))
static void ok(int status, const char *what) {
  if (status != 0) fprintf(stderr, "status %d: ", status), fail(what);
}

/* ---- modelDescription.xml ---- */

/* The value of an attribute of the element that begins at `at`, or NULL. */
static char *attribute(const char *at, const char *name) {
  static char value[512];
  char key[64];
  snprintf(key, sizeof key, " %s=\"", name);
  const char *end = strstr(at, "/>"), *found = strstr(at, key);
  if (!found || found > end) return NULL;
  found += strlen(key);
  size_t n = strcspn(found, "\""), k = 0;
  for (size_t i = 0; i < n; i++) {
    if (strncmp(found + i, "&gt;", 4) == 0) value[k++] = '>', i += 3;
    else if (strncmp(found + i, "&lt;", 4) == 0) value[k++] = '<', i += 3;
    else if (strncmp(found + i, "&amp;", 5) == 0) value[k++] = '&', i += 4;
    else value[k++] = found[i];
  }
  value[k] = '\0';
  return value;
}

static const char *variable_named(const char *name) {
  const char *tag = FMI == 2 ? "<ScalarVariable" : "<Float64";
  for (const char *at = strstr(xml, tag); at; at = strstr(at + 1, tag)) {
    const char *is = attribute(at, "name");
    if (is && strcmp(is, name) == 0) return at;
  }
  fprintf(stderr, "%s: ", name);
  fail("no such variable");
  return NULL;
}

/* The variable that structure and derivatives name: by its number in FMI 2, by its value reference in FMI 3. */
static const char *variable_meant(Ref which) {
#if FMI == 2
  const char *at = strstr(xml, "<ScalarVariable");
  while (--which) at = strstr(at + 1, "<ScalarVariable");
#else
  const char *at = strstr(xml, "<Float64");
  while ((Ref)atoi(attribute(at, "valueReference")) != which) at = strstr(at + 1, "<Float64");
#endif
  return at;
}

static Ref reference_of(const char *name) { return (Ref)atoi(attribute(variable_named(name), "valueReference")); }

static int count(const char *from, const char *to, const char *what) {
  int n = 0;
  for (const char *at = strstr(from, what); at && (!to || at < to); at = strstr(at + 1, what)) n++;
  return n;
}

/* ---- the interface ---- */

static void logged(void) { messages++; }
#if FMI == 2
static const struct {
  void (*logger)(void);
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void);
  void *environment;
} callbacks = {logged, calloc, free, NULL, NULL};
static Instance instance_new(const char *token, int cosim) {
  return ((Instance(*)(const char *, int, const char *, const char *, const void *, int, int))function(
      "fmi2Instantiate"))("one", cosim, token, "", &callbacks, 0, 0);
}
static int set_up(double tolerance, double start) {
  return CALL("fmi2SetupExperiment", (Instance, int, double, double, int, double), c, 1, tolerance, start, 0, 0.0);
}
static void initialize(double tolerance, double start) {
  ok(CALL("fmi2SetupExperiment", (Instance, int, double, double, int, double), c, 1, tolerance, start, 0, 0.0),
     "SetupExperiment");
  ok(CALL("fmi2EnterInitializationMode", (Instance), c), "EnterInitializationMode");
}
static int get_real(const Ref *r, int n, double *x) {
  return CALL("fmi2GetReal", (Instance, const Ref *, size_t, double *), c, r, (size_t)n, x);
}
static int set_real(const Ref *r, int n, const double *x) {
  return CALL("fmi2SetReal", (Instance, const Ref *, size_t, const double *), c, r, (size_t)n, x);
}
static int step(double from, double by) {
  int status = CALL("fmi2DoStep", (Instance, double, double, int), c, from, by, 1), terminated = 0;
  now = from + by;
  if (status != 2) return status;
  ok(CALL("fmi2GetBooleanStatus", (Instance, int, int *), c, 3, &terminated), "GetBooleanStatus");
  ok(CALL("fmi2GetRealStatus", (Instance, int, double *), c, 2, &now), "GetRealStatus");
  stopped = terminated;
  return terminated ? 0 : status;
}
static int discrete_states(int *states) {
  struct {
    int again, terminate, nominals, states, has_next;
    double next;
  } info = {1, 0, 0, 0, 0, 0};
  for (*states = 0; info.again; *states |= info.states)
    ok(CALL("fmi2NewDiscreteStates", (Instance, void *), c, &info), "NewDiscreteStates");
  next_event = info.has_next ? info.next : HUGE_VAL;
  return info.terminate;
}
#else
static Instance instance_new(const char *token, int cosim) {
  if (!cosim)
    return ((Instance(*)(const char *, const char *, const char *, bool, bool, void *, void (*)(void)))function(
        "fmi3InstantiateModelExchange"))("one", token, "", false, false, NULL, logged);
  return ((Instance(*)(const char *, const char *, const char *, bool, bool, bool, bool, const Ref *, size_t, void *,
                       void (*)(void), void *))function("fmi3InstantiateCoSimulation"))(
      "one", token, "", false, false, false, false, NULL, 0, NULL, logged, NULL);
}
static int set_up(double tolerance, double start) {
  return CALL("fmi3EnterInitializationMode", (Instance, bool, double, double, bool, double), c, true, tolerance, start,
              false, 0.0);
}
static void initialize(double tolerance, double start) {
  ok(CALL("fmi3EnterInitializationMode", (Instance, bool, double, double, bool, double), c, true, tolerance, start,
          false, 0.0),
     "EnterInitializationMode");
}
static int get_real(const Ref *r, int n, double *x) {
  return CALL("fmi3GetFloat64", (Instance, const Ref *, size_t, double *, size_t), c, r, (size_t)n, x, (size_t)n);
}
static int set_real(const Ref *r, int n, const double *x) {
  return CALL("fmi3SetFloat64", (Instance, const Ref *, size_t, const double *, size_t), c, r, (size_t)n, x, (size_t)n);
}
static int step(double from, double by) {
  bool event, terminate, early;
  int status = CALL("fmi3DoStep", (Instance, double, double, bool, bool *, bool *, bool *, double *), c, from, by, true,
                    &event, &terminate, &early, &now);
  stopped = terminate;
  return status;
}
static int discrete_states(int *states) {
  bool again = true, terminate = false, nominals, changed, has_next = false;
  double next = 0;
  for (*states = 0; again; *states |= changed)
    ok(CALL("fmi3UpdateDiscreteStates", (Instance, bool *, bool *, bool *, bool *, bool *, double *), c, &again,
            &terminate, &nominals, &changed, &has_next, &next),
       "UpdateDiscreteStates");
  next_event = has_next ? next : HUGE_VAL;
  return terminate;
}
#endif

static void get_states(double *x) {
  ok(CALL(PREFIX "GetContinuousStates", (Instance, double *, size_t), c, x, (size_t)nx), "GetContinuousStates");
}
static void put(double t, const double *x) {
  ok(CALL(PREFIX "SetTime", (Instance, double), c, t), "SetTime");
  ok(CALL(PREFIX "SetContinuousStates", (Instance, const double *, size_t), c, x, (size_t)nx), "SetContinuousStates");
}
static void rates_at(double t, const double *x, double *f) {
  put(t, x);
  ok(CALL(SPELLED("GetDerivatives", "GetContinuousStateDerivatives"), (Instance, double *, size_t), c, f, (size_t)nx),
     "derivatives");
}
static void indicators_at(double t, const double *x, double *g) {
  put(t, x);
  if (nevents)
    ok(CALL(PREFIX "GetEventIndicators", (Instance, double *, size_t), c, g, (size_t)nevents), "GetEventIndicators");
}

/* ---- model exchange ---- */

static void rk4(double t, const double *x, double h, double *y) {
  double k[4][MOST], z[MOST];
  rates_at(t, x, k[0]);
  for (int s = 1; s < 4; s++) {
    double part = s == 3 ? h : h/2;
    for (int i = 0; i < nx; i++) z[i] = x[i] + part*k[s - 1][i];
    rates_at(t + part, z, k[s]);
  }
  for (int i = 0; i < nx; i++) y[i] = x[i] + h/6*(k[0][i] + 2*k[1][i] + 2*k[2][i] + k[3][i]);
}

static int crosses(const double *a, const double *b) {
  for (int k = 0; k < nevents; k++)
    if ((a[k] > 0) != (b[k] > 0)) return 1;
  return 0;
}

static void event_mode(void) {
  int states;
  ok(CALL(PREFIX "EnterEventMode", (Instance), c), "EnterEventMode");
  stopped |= discrete_states(&states);
  ok(CALL(PREFIX "EnterContinuousTimeMode", (Instance), c), "EnterContinuousTimeMode");
}

/* Integrates to the time `end`; a crossing of an event indicator within a step is found by bisection of the step.
 * Steps end at time events; one at `end` happens in the next call. */
static void exchange(double end, int substeps) {
  const double h = (end - now)/substeps;
  double x[MOST], y[MOST], g[MOST], after[MOST];
  get_states(x);
  while (now < end - 1e-9*h && !stopped) {
    if (now >= next_event) event_mode(), get_states(x);
    double by = fmin(end - now < h*(1 + 1e-9) ? end - now : h, next_event - now);
    Bool wants = 0, terminate = 0;
    indicators_at(now, x, g);
    rk4(now, x, by, y);
    indicators_at(now + by, y, after);
    int event = crosses(g, after);
    if (event) {
      double low = 0, high = by;
      for (int i = 0; i < 60; i++) {
        double middle = (low + high)/2;
        rk4(now, x, middle, y);
        indicators_at(now + middle, y, after);
        if (crosses(g, after)) high = middle;
        else low = middle;
      }
      by = high;
      rk4(now, x, by, y);
    }
    now += by;
    put(now, y);
    ok(CALL(PREFIX "CompletedIntegratorStep", (Instance, Bool, Bool *, Bool *), c, 1, &wants, &terminate),
       "CompletedIntegratorStep");
    stopped |= terminate;
    if (event || wants) event_mode();
    get_states(x);
  }
}

/* ---- saved states ---- */

static void again_from(void *state, double t, double by, const Ref *r, int n, const double *expected) {
  double x[MOST];
  ok(CALL(PREFIX "Set" STATE, (Instance, void *), c, state), "set a saved state");
  ok(step(t, by), "DoStep");
  ok(get_real(r, n, x), "get");
  if (memcmp(x, expected, (size_t)n*sizeof *x) != 0) fail("a step from a saved state has other bits");
}

static void saved_step(double by, const Ref *r, int n) {
  void *state = NULL, *copy = NULL;
  double t = now, x[MOST];
  size_t size = 0;
  ok(CALL(PREFIX "Get" STATE, (Instance, void **), c, &state), "get the state");
  ok(CALL(PREFIX "Serialized" STATE "Size", (Instance, void *, size_t *), c, state, &size),
     "size of a serialized state");
  char *bytes = malloc(size);
  ok(CALL(PREFIX "Serialize" STATE, (Instance, void *, char *, size_t), c, state, bytes, size), "serialize");
  ok(step(t, by), "DoStep");
  ok(get_real(r, n, x), "get");
  again_from(state, t, by, r, n, x);
  ok(CALL(DESERIALIZE, (Instance, const char *, size_t, void **), c, bytes, size, &copy), "deserialize");
  void *none = NULL;
  bytes[0] ^= 1;
  if (CALL(DESERIALIZE, (Instance, const char *, size_t, void **), c, bytes, size, &none) == 0)
    fail("the state of another FMU is taken");
  if (messages != 1) fail("a refusal without a message");
  messages = 0;
  again_from(copy, t, by, r, n, x); /* which the standards allow after an error */
  ok(CALL(PREFIX "Free" STATE, (Instance, void **), c, &state), "free the state");
  ok(CALL(PREFIX "Free" STATE, (Instance, void **), c, &copy), "free the state");
  if (state || copy) fail("a freed state is not NULL");
  free(bytes);
}

/* ---- directional derivatives ---- */

/* Directional derivative of unknown[n] by one variable. */
static int derivative(const Ref *unknown, int n, Ref known, double seed, double *exact) {
#if FMI == 2
  return CALL("fmi2GetDirectionalDerivative",
              (Instance, const Ref *, size_t, const Ref *, size_t, const double *, double *), c, unknown, (size_t)n,
              &known, 1, &seed, exact);
#else
  return CALL("fmi3GetDirectionalDerivative",
              (Instance, const Ref *, size_t, const Ref *, size_t, const double *, size_t, double *, size_t), c,
              unknown, (size_t)n, &known, 1, &seed, 1, exact, (size_t)n);
#endif
}

/* Outputs and rates with the known variable moved by `by`: component `at` of the state, or, for at < 0, an input or
 * a parameter. */
static void moved(const double *x, int at, Ref input, double value, double by, const Ref *r, int n, double *out) {
  double y[MOST], u = value + by;
  memcpy(y, x, sizeof y);
  if (at >= 0) y[at] += by;
  else ok(set_real(&input, 1, &u), "set an input or a parameter");
  rates_at(0.7, y, out);
  ok(get_real(r, n, out + nx), "get");
}

/* Derivatives of outputs r[n] and rates by one variable, beside extrapolated differences. */
static int derivatives_by(const char *name, const Ref *r, int n, double tolerance) {
  double x[MOST], a[MOST], b[MOST], d[2][MOST], exact[MOST], seed = 0.5, value;
  Ref known = reference_of(name), unknown[MOST];
  int at = -1, bad = 0;
  for (int i = 0; i < nx; i++) x[i] = 0.31 + 0.17*i;
  put(0.7, x);
  ok(get_real(&known, 1, &value), "get");
  for (int i = 0; i < nx; i++)
    if (x[i] == value) at = i;
  const char *from = strstr(xml, FMI == 2 ? "<Derivatives>" : "<ContinuousStateDerivative ");
  for (int i = 0; i < nx; i++, from++) {
    from = strstr(from, FMI == 2 ? "<Unknown" : "<ContinuousStateDerivative ");
    const char *rate = variable_meant((Ref)atoi(attribute(from, FMI == 2 ? "index" : "valueReference")));
    const char *state = variable_meant((Ref)atoi(attribute(rate, "derivative")));
    unknown[i] = (Ref)atoi(attribute(rate, "valueReference"));
    Ref of = (Ref)atoi(attribute(state, "valueReference"));
    ok(get_real(&of, 1, &value), "get");
    if (value != x[i]) fail("a derivative names another state");
  }
  ok(get_real(&known, 1, &value), "get");
  memcpy(unknown + nx, r, (size_t)n*sizeof *r);
  ok(derivative(unknown, nx + n, known, seed, exact), "derivative");
  for (int half = 0; half < 2; half++) {
    const double h = half ? 5e-4 : 1e-3;
    moved(x, at, known, value, h, r, n, a);
    moved(x, at, known, value, -h, r, n, b);
    for (int k = 0; k < nx + n; k++) d[half][k] = (a[k] - b[k])/(2*h);
  }
  for (int k = 0; k < nx + n; k++) {
    double expected = seed*(4*d[1][k] - d[0][k])/3;
    printf("by %s: %.9g, by differences %.9g\n", name, exact[k], expected);
    bad |= !(fabs(exact[k] - expected) <= tolerance*(1 + fabs(expected)));
  }
  return bad;
}

/* ---- refusals ---- */

static void *whole; /* state before a refusal, which leaves nothing but a reset or a saved state; NULL: none */

static void keep(void) { ok(CALL(PREFIX "Get" STATE, (Instance, void **), c, &whole), "get the state"); }

static void refuses(const char *what, int status) {
  double x;
  if (status != 3) fprintf(stderr, "status %d: ", status), fail(what);
  if (!messages) fail("a refusal without a message");
  messages = 0;
  if (!whole) return;
  if (step(now, 0.1) != 3 || set_real((const Ref[]){1}, 1, &x) != 3) fprintf(stderr, "after a refusal: "), fail(what);
  messages = 0;
  ok(CALL(PREFIX "Set" STATE, (Instance, void *), c, whole), "set a saved state");
}

static void refusals(const char *token) {
  double x = 1, y = -1, nothing = NAN, endless = HUGE_VAL;
  Ref none = 9999, time = 0, p = reference_of("m"), rate = reference_of("th''"), start = reference_of("th");
  if (instance_new("{another}", 0)) fail("the token of another FMU is taken");
  messages = 0;
  c = instance_new(token, 1);
  keep();
  refuses("a value of no variable", get_real(&none, 1, &x));
  refuses("a set variable that there is not", set_real(&none, 1, &x));
  refuses("time is set as a variable", set_real(&time, 1, &x));
  refuses("a computed variable is set", set_real(&rate, 1, &x));
  refuses("a parameter against its sign", set_real(&p, 1, &y));
  refuses("a parameter that is infinite", set_real(&p, 1, &endless));
  refuses("a start that is not a number", set_real(&start, 1, &nothing));
  refuses("an integer", CALL(SPELLED("GetInteger", "GetInt32"), (Instance, const Ref *, size_t, int *, size_t), c, &p,
                             1, (int *)&x, 1));
  refuses("values without an array", get_real(&p, 1, NULL));
  refuses("a start time that is not a number", set_up(1e-9, nothing));
  refuses("an infinite start time", set_up(1e-9, endless));
  refuses("a negative tolerance", set_up(-1e-9, 0));
  refuses("a step before the initialization", step(0, 0.1));
  refuses("an end of the initialization before its beginning", CALL(PREFIX "ExitInitializationMode", (Instance), c));
  refuses("an end before the beginning", CALL(PREFIX "Terminate", (Instance), c));
  initialize(1e-9, 0);
  keep();
  refuses("a derivative by a parameter before the initialization ends", derivative(&rate, 1, p, 1, &x));
  ok(CALL(PREFIX "ExitInitializationMode", (Instance), c), "ExitInitializationMode");
  keep();
  refuses("a start after the initialization", set_real(&start, 1, &x));
  refuses("a step from another time", step(5, 0.1));
  double a[2];
  ok(step(0, 0.1), "DoStep");
  ok(get_real(&start, 1, &a[0]), "get");
  ok(CALL(PREFIX "Reset", (Instance), c), "Reset");
  initialize(1e-9, 0);
  ok(CALL(PREFIX "ExitInitializationMode", (Instance), c), "ExitInitializationMode");
  ok(step(0, 0.1), "DoStep");
  ok(get_real(&start, 1, &a[1]), "get");
  if (a[0] != a[1]) fail("a run after a reset has other bits");
  keep();
  refuses("an infinite step", step(0.1, endless));
  refuses("a step that is not a number", step(0.1, nothing));
  refuses("a step that would not end", step(0.1, 1e300));
  whole = NULL;
  ok(CALL(PREFIX "Terminate", (Instance), c), "Terminate");
  refuses("a step after the end", step(0.1, 0.1));
  refuses("events after the end", CALL(PREFIX "EnterEventMode", (Instance), c));
  Instance was = c;
  c = NULL;
  if (step(0, 0.1) != 3 || get_real(&p, 1, &x) != 3 || CALL(PREFIX "Reset", (Instance), c) != 3 ||
      CALL(PREFIX "Terminate", (Instance), c) != 3)
    fail("no instance");
  c = was;
}

/* ---- a motion that comes to a halt ---- */

static void begin(const char *token, int cosim) {
  c = instance_new(token, cosim);
  initialize(1e-9, 0);
  ok(CALL(PREFIX "ExitInitializationMode", (Instance), c), "ExitInitializationMode");
}

/* DISCARD where part of the step is made, or a smaller one may be; ERROR where none is: an importer that tried again
 * would do so without end. */
static void halts(const char *token) {
  double x[2] = {0}, f[2], beyond = 1.5;
  begin(token, 1);
  ok(step(0, 0.75), "DoStep");
  if (step(0.75, 0.75) != 2) fail("a step into the place is not discarded");
  if (!(now > 0.99 && now <= 1)) fail("the time reached is not the end of the motion");
  messages = 0;
  refuses("a step that cannot begin", step(now, 0.75));
  refuses("a step after a failure", step(now, 0.01));
  refuses("a value after a failure", set_real((const Ref[]){1}, 1, x));
  refuses("an end after a failure", CALL(PREFIX "Terminate", (Instance), c));
  begin(token, 0);
  nx = 2;
  put(0.75, x);
  ok(CALL(SPELLED("GetDerivatives", "GetContinuousStateDerivatives"), (Instance, double *, size_t), c, f, (size_t)2),
     "GetDerivatives");
  if (f[1] != 0.5) fail("the rate is another");
  put(beyond, x);
  if (CALL(SPELLED("GetDerivatives", "GetContinuousStateDerivatives"), (Instance, double *, size_t), c, f, (size_t)2) !=
      2)
    fail("rates without a value are not discarded");
}

/* ---- tables ---- */

static void set_named(const char *word) {
  char name[128];
  size_t n = strcspn(word, "=");
  snprintf(name, sizeof name, "%.*s", (int)n, word);
  Ref r = reference_of(name);
  double x = atof(word + n + 1);
  ok(set_real(&r, 1, &x), word);
}

int main(int argc, char **argv) {
  static char line[1 << 16];
  char path[4096], token[128];
  if (argc < 4) fail("FOLDER BINARY MODE TABLE TOLERANCE SUBSTEPS [name=value ...]");
  snprintf(path, sizeof path, "%s/modelDescription.xml", argv[1]);
  FILE *f = fopen(path, "r");
  if (!f || !fread(xml, 1, sizeof xml - 1, f)) fail("no modelDescription.xml");
  fclose(f);
  library = dlopen(argv[2], RTLD_NOW | RTLD_LOCAL);
  if (!library) fail(dlerror());
  const char *head = strstr(xml, "<fmiModelDescription"), *tail = strstr(xml, "</ModelStructure>");
  snprintf(token, sizeof token, "%s", attribute(head, FMI == 2 ? "guid" : "instantiationToken"));
  const char *mode = argv[3];
  if (strcmp(mode, "refusals") == 0) return refusals(token), 0;
  if (strcmp(mode, "halts") == 0) return halts(token), 0;

  const char *derivatives = strstr(xml, "<Derivatives>");
  nx = FMI == 2 ? count(derivatives, strstr(derivatives, "</Derivatives>"), "<Unknown")
                : count(xml, tail, "<ContinuousStateDerivative ");
  nevents = FMI == 2 ? atoi(attribute(head, "numberOfEventIndicators")) : count(xml, tail, "<EventIndicator ");
  if (nx > MOST || nevents > MOST) fail("too many states");
  FILE *table = fopen(argv[4], "r");
  if (!table || !fgets(line, sizeof line, table)) fail("no table");
  Ref r[MOST];
  double largest[MOST] = {0}, worst[MOST] = {0}, x[MOST];
  char names[MOST][128];
  int n = 0, cosim = strcmp(mode, "me") != 0 && strcmp(mode, "derivatives") != 0, rows = 0;
  strtok(line, ",\n");
  for (char *w; (w = strtok(NULL, ",\n"));) { /* "th' [rad/s]" */
    char *unit = strstr(w, " [");
    if (unit) *unit = '\0';
    /* an input among the columns */
    if (strcmp(mode, "derivatives") == 0 && strcmp(attribute(variable_named(w), "causality"), "output") != 0) continue;
    snprintf(names[n], sizeof names[n], "%s", w);
    r[n++] = reference_of(w);
  }
  c = instance_new(token, cosim);
  if (!c) fail("no instance");
  tolerance_of_run = atof(attribute(strstr(xml, "<DefaultExperiment"), "tolerance"));
  for (int i = 7; i < argc && strcmp(mode, "derivatives") != 0; i++)
    if (argv[i][0] != '@') set_named(argv[i]);
  if (strcmp(mode, "derivatives") == 0) {
    int bad = 0;
    initialize(tolerance_of_run, 0);
    ok(CALL(PREFIX "ExitInitializationMode", (Instance), c), "ExitInitializationMode");
    event_mode();
    for (int i = 7; i < argc; i++) bad |= derivatives_by(argv[i], r, n, atof(argv[5]));
    return bad || !strstr(xml, FMI == 2 ? " providesDirectionalDerivative=\"true\""
                                        : " providesDirectionalDerivatives=\"true\"");
  }
  int started = 0;
  while (fgets(line, sizeof line, table) && !stopped) {
    char *w = strtok(line, ",");
    double t = atof(w);
    if (!started) {
      initialize(tolerance_of_run, t);
      ok(CALL(PREFIX "ExitInitializationMode", (Instance), c), "ExitInitializationMode");
      if (!cosim) event_mode();
      for (int i = 7; i < argc; i++)
        if (argv[i][0] == '@') set_named(argv[i] + 1);
      now = t;
      started = 1;
    } else if (!cosim) {
      exchange(t, atoi(argv[6]));
    } else if (strcmp(mode, "saved") == 0) {
      saved_step(t - now, r, n);
    } else {
      ok(step(now, t - now), "DoStep");
    }
    if (stopped) {
      printf("stopped at %.9g\n", now);
      break;
    }
    now = t;
    ok(get_real(r, n, x), "get");
    for (int k = 0; k < n && (w = strtok(NULL, ",\n")); k++) {
      double expected = atof(w);
      largest[k] = fmax(largest[k], fabs(expected));
      worst[k] = fmax(worst[k], !isfinite(x[k]) ? HUGE_VAL : fabs(x[k] - expected));
    }
    rows++;
  }
  int bad = rows < 2 && !stopped;
  for (int k = 0; k < n; k++) {
    double scale = largest[k] > 1e-3 ? largest[k] : 1;
    printf("%s: off by %.2e of %.3g\n", names[k], worst[k], largest[k]);
    bad |= !(worst[k] <= atof(argv[5])*scale);
  }
  ((void (*)(Instance))function(PREFIX "FreeInstance"))(c);
  if (messages) fail("messages in a run without mistakes");
  return bad;
}
