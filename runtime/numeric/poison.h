/* Poisoned memory, whose use the address sanitizer reports: the gap after each block of an arena or part of a work
 * space, the unused room of a vector. Without the sanitizer these macros do nothing and there is no gap. */
#pragma once

#include <stddef.h>
#include <stdlib.h>

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1
#endif
#endif

#ifdef __SANITIZE_ADDRESS__
void __asan_poison_memory_region(void const volatile *p, size_t n);
void __asan_unpoison_memory_region(void const volatile *p, size_t n);
#define POISON __asan_poison_memory_region
#define UNPOISON __asan_unpoison_memory_region
#define MUST_BE_BELOW(i, n) ((i) < (n) ? (void)0 : abort())
enum { POISON_GAP = sizeof(max_align_t) };
#else
#define POISON(p, n) ((void)(p), (void)(n))
#define UNPOISON(p, n) ((void)(p), (void)(n))
#define MUST_BE_BELOW(i, n) ((void)0)
enum { POISON_GAP = 0 };
#endif
