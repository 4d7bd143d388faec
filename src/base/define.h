/* A constant given on the command line: -D NAME=VALUE. The value is a decimal number as text. */
#ifndef LAGC_DEFINE_H
#define LAGC_DEFINE_H

typedef struct {
  const char *name, *value;
} Define;

#endif
