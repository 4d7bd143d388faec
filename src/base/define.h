/* A constant given on the command line: -D NAME=VALUE. */
#ifndef LAGC_DEFINE_H
#define LAGC_DEFINE_H

#include <stdint.h>

typedef struct {
  const char *name, *value;
  uint32_t expr; /* AstId of the value; 0: not parsed yet, or a mistake */
} Define;

#endif
