/* The documents that lagc carries: the reference of the language, README, the tutorial, and the page on Python. */
#pragma once

#include "base/arena.h"

typedef struct {
  const char *topic; /* of `lagc help`; "" for the reference, whose chapters are topics */
  const char *title;
  const char *const *lines; /* each ends with a newline */
  size_t n;
} Document;

enum { LANGUAGE, N_DOCUMENTS = 4 };

extern const Document documents[N_DOCUMENTS];

/* Whether the line is a heading of a chapter. */
int document_heading(const char *line);

/* "scenes scene start span" of the line <!-- help: scenes scene start span -->; "" of others. */
const char *document_words(Arena *a, const char *line);
