/* Names: each distinct spelling is stored once, so names compare by pointer. */
#pragma once

#include "base/arena.h"

typedef const char *Name; /* interned, NUL-terminated UTF-8; NULL means no name */

typedef struct Interner Interner;

Interner *interner_new(Arena *a);
Name intern(Interner *in, const char *s);
Name intern_n(Interner *in, const char *s, size_t n);
