/* Models in MATLAB and Octave: a MEX function around their shared libraries (`lagc build MODEL --shared -o
 * libNAME.so`). README.md has its calls. */
#include "lag.h"
#include "mex.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

/* The library of this call. It is opened, not linked: Octave would take the functions of the first model for all
 * others, whose names are the same. */
static void *library;
#define CALL(f) ((__typeof__(f) *)find(#f))

static void *find(const char *name) {
  void *f = dlsym(library, name);
  if (!f)
    mexErrMsgIdAndTxt("lagc:library", "no %s: make the library by `lagc build MODEL --shared -o libNAME.so`", name);
  return f;
}

static void open_library(const mxArray *path) {
  char text[1000];
  if (!mxIsChar(path) || mxGetString(path, text, sizeof text))
    mexErrMsgIdAndTxt("lagc:argument", "the library is the name of a file");
  library = dlopen(text, RTLD_NOW | RTLD_LOCAL);
  if (!library) mexErrMsgIdAndTxt("lagc:library", "%s", dlerror());
  if (CALL(lag_library_abi)() != LAG_ABI)
    mexErrMsgIdAndTxt("lagc:library", "%s is from another version of lagc: make it anew", text);
}

/* Ends the call with an error; the simulation is freed first. */
static void fail(lag_sim *sim, const char *id, const char *text) {
  char copy[600];
  snprintf(copy, sizeof copy, "%s", text);
  CALL(lag_sim_free)(sim);
  mexErrMsgIdAndTxt(id, "%s", copy);
}

static const double *get_numbers(lag_sim *sim, const mxArray *a, const char *what) {
  if (!mxIsDouble(a) || mxIsComplex(a) || mxIsSparse(a)) fail(sim, "lagc:argument", what);
  return mxGetPr(a);
}

/* The scene of this name; without a name, the first. */
static const lag_scene *get_scene(const mxArray *a) {
  char name[200] = "", all[600] = "";
  const lag_scene *sc;
  if (a && !mxIsEmpty(a) && (!mxIsChar(a) || mxGetString(a, name, sizeof name)))
    mexErrMsgIdAndTxt("lagc:argument", "the scene is a name");
  for (int i = 0; (sc = CALL(lag_library_scene)(CALL(lag_library)(), i)) != NULL; i++) {
    double t0, t1, every;
    const char *is = CALL(lag_scene_span)(sc, &t0, &t1, &every);
    if (!name[0] || strcmp(name, is) == 0) return sc;
    snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", is);
  }
  mexErrMsgIdAndTxt("lagc:argument", "no scene %s; there are %s", name, all);
  return NULL;
}

static int count(const lag_scene *sc, int kind) {
  int n = 0;
  while (CALL(lag_item)(sc, kind, n, NULL, NULL, NULL)) n++;
  return n;
}

/* Sets the fields of a struct; or the pairs of a cell {'th''', 1; 'm', 2}, for names that are no identifiers. `tol`:
 * the tolerance. */
static void set_values(lag_sim *sim, const mxArray *a) {
  int fields = mxIsStruct(a), n = fields ? mxGetNumberOfFields(a) : (int)mxGetM(a);
  if (!mxIsEmpty(a) && !fields && (!mxIsCell(a) || mxGetN(a) != 2))
    fail(sim, "lagc:argument", "the values are a struct, or a cell {'name', value; ...}");
  for (int i = 0; i < n && !mxIsEmpty(a); i++) {
    char name[200] = "";
    const mxArray *key = fields ? NULL : mxGetCell(a, (mwIndex)i),
                  *v = fields ? mxGetFieldByNumber(a, 0, i) : mxGetCell(a, (mwIndex)(i + n));
    if (fields) snprintf(name, sizeof name, "%s", mxGetFieldNameByNumber(a, i));
    if (!v || !mxIsDouble(v) || mxGetNumberOfElements(v) != 1 ||
        (!fields && (!key || !mxIsChar(key) || mxGetString(key, name, sizeof name))))
      fail(sim, "lagc:argument", "each value is a name and one number");
    int status = strcmp(name, "tol") == 0 ? CALL(lag_sim_set_tolerance)(sim, mxGetScalar(v))
                                          : CALL(lag_sim_set)(sim, name, mxGetScalar(v));
    if (status < 0) fail(sim, "lagc:value", CALL(lag_sim_message)(sim));
  }
}

/* Names of the components of y (kinds "qvz"), or of parameters and inputs. */
static mxArray *names(const lag_scene *sc, const char *kinds) {
  int n = 0;
  for (const char *k = kinds; *k; k++) n += count(sc, *k == 'v' ? 'q' : *k);
  mxArray *cell = mxCreateCellMatrix((mwSize)n, 1);
  n = 0;
  for (const char *k = kinds; *k; k++) {
    const char *name;
    for (int i = 0; (name = CALL(lag_item)(sc, *k == 'v' ? 'q' : *k, i, NULL, NULL, NULL)) != NULL; i++) {
      char text[300];
      snprintf(text, sizeof text, "%s%s", name, *k == 'v' ? "'" : "");
      mxSetCell(cell, (mwIndex)n++, mxCreateString(text));
    }
  }
  return cell;
}

/* Rows x[rows][n] as a matrix. */
static mxArray *matrix(const double *x, int rows, int n) {
  mxArray *a = mxCreateDoubleMatrix((mwSize)rows, (mwSize)n, mxREAL);
  for (int i = 0; i < rows * n; i++) mxGetPr(a)[i % n * rows + i / n] = x[i];
  return a;
}

static void run(const lag_scene *sc, lag_sim *sim, int n, const mxArray *times, int nout, mxArray **out) {
  const double *t = get_numbers(sim, times, "times are real doubles");
  int rows = (int)mxGetNumberOfElements(times), width = CALL(lag_sim_noutputs)(sim), done = 0;
  char why[400];
  if (rows && !CALL(lag_scene_method)(sc) &&
      CALL(lag_sim_choose_method)(sim, t[rows - 1], 0, NULL, 0, why, sizeof why) < 0)
    fail(sim, "lagc:run", CALL(lag_sim_message)(sim));
  double *y = mxMalloc(sizeof *y * (size_t)(rows * n + 1)), *o = mxMalloc(sizeof *o * (size_t)(rows * width + 1));
  if (CALL(lag_sim_rows)(sim, rows, t, y, o, &done) < 0) fail(sim, "lagc:run", CALL(lag_sim_message)(sim));
  out[0] = matrix(y, done, n);
  if (nout > 1) out[1] = matrix(o, done, width);
}

static void rhs(lag_sim *sim, int n, const mxArray *time, const mxArray *states, mxArray **out) {
  const double *t = get_numbers(sim, time, "t is a real double"), *y = get_numbers(sim, states, "y has real doubles");
  int many = (int)mxGetN(states);
  if ((int)mxGetM(states) != n || mxGetNumberOfElements(time) != 1)
    fail(sim, "lagc:argument",
         "rhs takes one time, and y with a state (coordinates, velocities, states) in each column");
  double *all = mxMalloc(sizeof *all * (size_t)(many + 1));
  for (int k = 0; k < many; k++) all[k] = t[0];
  out[0] = mxCreateDoubleMatrix((mwSize)n, (mwSize)many, mxREAL);
  if (CALL(lag_sim_rhs)(sim, many, all, y, mxGetPr(out[0]))) fail(sim, "lagc:run", CALL(lag_sim_message)(sim));
}

void mexFunction(int nout, mxArray **out, int nin, const mxArray **in) {
  char what[20] = "";
  if (nin && mxIsChar(in[0])) mxGetString(in[0], what, sizeof what);
  int is_run = strcmp(what, "run") == 0 && nin >= 3, is_rhs = strcmp(what, "rhs") == 0 && nin >= 4,
      next = 2 + is_run + 2 * is_rhs;
  if (!is_run && !is_rhs && (strcmp(what, "names") != 0 || nin < 2))
    mexErrMsgIdAndTxt(
        "lagc:argument",
        "give ('run', library, times), ('rhs', library, t, y) or ('names', library), then values and a scene");
  open_library(in[1]);
  const lag_scene *sc = get_scene(nin > next + 1 ? in[next + 1] : NULL);
  if (!is_run && !is_rhs) {
    out[0] = names(sc, "qvz");
    if (nout > 1) out[1] = names(sc, "pu");
    return;
  }
  lag_sim *sim = CALL(lag_sim_new)(sc);
  if (!sim) mexErrMsgIdAndTxt("lagc:run", "no memory");
  if (nin > next) set_values(sim, in[next]);
  int n = 2 * count(sc, 'q') + count(sc, 'z');
  if (is_run) run(sc, sim, n, in[2], nout, out);
  else rhs(sim, n, in[2], in[3], out);
  CALL(lag_sim_free)(sim);
}
