/* Shared by fmu_archive.c and description.c: the description of an FMU, modelDescription.xml. */
#pragma once

#include "fmu/fmu_archive.h"

/* Tolerance of the experiment, if the scene has none. */
#define FMU_TOLERANCE 1e-9

/* Appends modelDescription.xml. */
void fmu_describe(const ProgramSet *u, const Fmu *f, StrBuf *out);
