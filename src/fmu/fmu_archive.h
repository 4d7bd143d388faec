/* ProgramSet -> FMU (Functional Mock-up Unit): the archive that the FMI standard 2.0 or 3.0 defines, of C sources,
 * their description and a binary. */
#pragma once

#include "base/strbuf.h"
#include "ir/program_set.h"

typedef struct {
  int version;             /* of FMI: 2 or 3 */
  const char *identifier;  /* C identifier of the model: the name of its binary */
  int has_derivatives;     /* directional derivatives; not of models with constraints, nor with more than 300 states */
  int moreau;              /* co-simulation by steps of Moreau's method: contacts, or dry friction */
  const char *token;       /* hash of the sources: description and binary belong together */
  const char *header;      /* sources/model.h */
  const char *wrapper;     /* sources/fmu.c, which includes it */
  const char *description; /* modelDescription.xml */
  const char *build;       /* sources/buildDescription.xml of FMI 3, or NULL */
} Fmu;

/* Programs WANT_... that FMUs use. */
unsigned fmu_wants(void);

/* Texts of the FMU of the unit's first scene. equations: text for the head comment of the header. Returns 0, with
 * *error, for a model that cannot be an FMU. */
int fmu_make(const ProgramSet *u, int version, const char *equations, Fmu *f, const char **error);

/* A shared library made of f->wrapper, and what its compiler compiles for: x86_64-linux-gnu. */
typedef struct {
  StrBuf library;
  const char *machine;
} FmuBinary;

/* Appends the archive with n binaries. Returns 0, with *error, where FMI has no name for a machine, or two are one,
 * or the archive is not written. */
int fmu_pack(const Fmu *f, const FmuBinary *of, uint32_t n, StrBuf *out, const char **error);
