/* State and parts of an emitted header, shared by emit_header.c (names, head comment), header_declarations.c and
 * header_definitions.c. */
#pragma once

#include "emit/cfunction.h"
#include "emit/emit_model.h"
#include "ir/program_set.h"

typedef struct {
  const ProgramSet *u;
  const IrScene *scene;
  Arena *a;
  StrBuf *out;
  const char *file;            /* name of the file without .h */
  const char *upper, *lower;   /* prefix of all names, in upper and lower case */
  const char *const *event_ids; /* cnames_of_events */
  CNames taken;                /* global names of the header */
  const char **q, **z, **p, **in, **ev, **outputs, **contacts, **surfaces; /* enumerators by index */
  const char *const *fields;   /* members of the struct of parameters */
  const char *const *globals;
  HeaderParts parts;
} Header;

static inline const char *header_contact_name(const Header *h, uint32_t i) {
  return h->u->constraints.of.at[h->u->contacts.at[i].constraint].name;
}

/* Functions of a header; whether this model has function f; its prototype without `;`. */
typedef enum {
  FN_DEFAULTS, FN_PARAM, FN_START, FN_INPUTS, FN_ACCEL, FN_ENERGY, FN_CHARGES, FN_POWERS, FN_OBSERVE, FN_EVENTS, FN_ACT,
  FN_HOLD, FN_RK4_STEP, FN_RK4_STEP_WITH, FN_UNTIL_EVENT, FN_RHS, FN_MASS, FN_BIAS, FN_INVERSE, FN_JAC, FN_JVP, FN_VJP,
  FN_LINEARIZE, FN_DPARAMS, FN_CONSTRAINTS, FN_CONSTRAINT_JACOBIAN, FN_MULTIPLIERS, FN_OUTPUT_JACOBIAN,
  FN_ADJOINT_STEP,
  FN_COUNT
} HeaderFn;
int header_has(const Header *h, HeaderFn f);
const char *header_prototype(const Header *h, HeaderFn f);

/* Append the declarations (macros, enums, structs, prototypes) and the definitions. */
void header_declarations(const Header *h);
void header_implementation(const Header *h);

/* header_steps.c: the methods of the header. */
void header_steps_declare(const Header *h);
void header_steps_define(const Header *h);

/* header_adaptive.c: the memory of adaptive methods and its filling; what failures do within their trial steps;
 * moves of lanes; the control of their sizes. */
void header_adaptive_declare(const Header *h);
void header_move(const Header *h);
void header_adaptive_define(const Header *h, const char *longest);

/* header_taylor.c, header_variational.c: the memory of a method and its prototypes; its functions. longest: constant
 * of the longest step. */
void header_taylor_declare(const Header *h);
void header_taylor_overloads(const Header *h); /* functions that C++98 lacks; outside of extern "C" */
void header_taylor_define(const Header *h, const char *longest);
void header_variational_declare(const Header *h);
void header_variational_define(const Header *h);

/* header_text.c: parameters of a function that takes inputs; sentences about inputs and lanes. */
extern const char *const header_held_parameters, *const header_held_inputs, *const header_adaptive_lanes;

/* Lines of a template whose mark is wanted, with a blank in its place; other lines stay. The list ends with 0. */
typedef struct {
  char mark;
  int wanted;
} LineChoice;
const char *header_chosen(const Header *h, const char *text, const LineChoice *choices);

/* header_moreau.c: NULL, or what a model needs; indices of contacts and surfaces, what the state says of them, its
 * start; the prototypes and functions of the steps; the change of the middle of a step. */
const char *header_moreau_lacks(const ProgramSet *u);
void header_moreau_start(const Header *h);
void header_moreau_indices(const Header *h);
void header_moreau_members(const Header *h);
void header_moreau_declare(const Header *h);
void header_moreau_define(const Header *h);

/* header_friction.c: the same for models without contacts whose motion may stick; the number of surfaces. */
uint32_t header_surfaces(const ProgramSet *u);
uint32_t header_guides(const ProgramSet *u); /* guides, beside no contact */
const char *header_friction_lacks(const ProgramSet *u);
void header_friction_indices(const Header *h);
void header_friction_members(const Header *h);
void header_friction_define(const Header *h);

/* A word of a template, and its text. */
typedef struct {
  const char *mark, *text;
} HeaderWord;

/* Appends text, in which LAG_ and lag_ become the prefix. */
void header_printf(const Header *h, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Appends a section of the runtime's kernels, or several: "friction, mean". */
void header_section(const Header *h, const char *name);
void header_sections(const Header *h, const char *names);

/* Appends a template: its lines begin with a mark, q, z or u for models with coordinates, states or inputs, n for
 * those without inputs, and `|`. HELD, PASS: parameters and arguments for inputs, CALL: arguments of _accel, ARGS:
 * of functions of the state; further words end with {NULL, NULL}. LAG_ and lag_ become the prefix. */
void header_template(const Header *h, const char *text, const HeaderWord *more);

/* header_definitions.c: functions of models with constraints. */
void header_hold_define(const Header *h);

/* A number as a word; the head of a function of the header. */
#define LIST(v) (v).at, (v).n
HeaderWord header_number(const Header *h, const char *mark, uint32_t n);
void header_begin(const Header *h, HeaderFn f);

/* header_outputs.c: derivatives of outputs, steps in reverse. */
void header_outputs_define(const Header *h);

/* header_dynamics.c: matrices and derivatives; the table of names. */
void header_dynamics_define(const Header *h);
void header_name_tables(const Header *h);
/* Text of a table of positions: "{0, 1}, {0, 2}". */
const char *header_positions(const Header *h, const IrEntry *at, uint32_t n);

/* header_callbacks.c: includes, functions for the libraries of `--for`; what the header includes besides <math.h>:
 * ", GSL's headers". */
void header_callbacks_include(const Header *h);
void header_callbacks_declare(const Header *h);
void header_callbacks_define(const Header *h);
const char *header_libraries(const Header *h);

/* Names in the C of a function around a program with these further parameters and output arrays. */
CStyle header_style(const Header *h, const char *const *own, const char *const *out);
/* A function of the state around p. params: its further parameters, as text; out: its output arrays by number; NULL:
 * those parameters that are not const. */
void header_state_function(const Header *h, const Prog *p, const char *comment, const char *head, const char *params,
                           const char *const *out, int returns);
/* `static int lag_NAME(state, params)` around p; function f of the interface, if the model has it. */
void header_internal_function(const Header *h, const Prog *p, const char *name, const char *comment, const char *params,
                              const char *const *out);
void header_api_function(const Header *h, const Prog *p, HeaderFn f);
/* A double as a constant of the scalar's type, with a point, so that it takes suffixes. */
const char *header_constant(const Header *h, double x);
const char *header_api(const Header *h, HeaderFn f);
/* The accelerations and rates that a model has, as parameters. */
const char *header_rates(const Header *h);

/* Index of the method with this name of n letters, or -1; programs WANT_... that it needs; NULL, or what a model
 * needs that it steps. */
int header_method(const char *name, size_t n);
unsigned header_method_wants(int method);
const char *header_method_refusal(const ProgramSet *u, int method);
unsigned header_methods(const ProgramSet *u); /* bits of those that step the model */
int header_has_method(const Header *h, const char *name);

/* Prototype with the prefix, broken into lines at its commas. */
const char *header_wrapped(const Header *h, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* Declares a function that has no lanes, so that a call of it over lanes does not compile, and says the way out. */
void header_one_state(const Header *h, const char *name, const char *way);

/* "t, q, v, z, p, u" without arrays that the model lacks: as typed parameters, or as arguments with `from` ("s->")
 * before the members of the state. */
const char *header_state_args(const Header *h, int typed, const char *from);
