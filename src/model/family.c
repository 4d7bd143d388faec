/* Families (indexed declarations): index ranges, offsets and names of members, and `for` loops over statements. */
#include "model/builder.h"

#include <string.h>

uint32_t member_offset(const Entity *e, const int64_t *at) {
  uint64_t i = 0;
  for (int k = 0; k < e->ndims; k++) i = i * (uint64_t)(e->hi[k] - e->lo[k] + 1) + (uint64_t)(at[k] - e->lo[k]);
  return (uint32_t)(i * (e->parts ? e->parts : 1));
}

int range_next(const IndexRange *r, int64_t *at) {
  for (uint32_t k = r->n; k-- > 0;) {
    if (++at[k] <= r->hi[k]) return 1;
    at[k] = r->lo[k];
  }
  return 0;
}

int first_member(const Entity *e, int64_t *at) {
  for (int k = 0; k < 2; k++) at[k] = k < e->ndims ? e->lo[k] : 1;
  return entity_size(e) > 0;
}

int next_member(const Entity *e, int64_t *at) {
  IndexRange r = entity_range(e);
  return range_next(&r, at);
}

Name member_name(const Ast *ast, Name name, const int64_t *at, uint32_t ndims) {
  if (ndims == 0) return name;
  char *text = ndims == 2 ? arena_printf(ast->arena, "%s[%lld,%lld]", name, (long long)at[0], (long long)at[1])
                          : arena_printf(ast->arena, "%s[%lld]", name, (long long)at[0]);
  Name member = intern(ast->names, text);
  arena_recycle(ast->arena, text, strlen(text) + 1);
  return member;
}

const Entity *find_member(const Ast *ast, const Scope *members, const Entity *e, const int64_t *at) {
  return scope_own(members, member_name(ast, e->name, at, e->ndims), e->effect);
}

int range_fits(Builder *b, int64_t from, int64_t to, Span span) {
  if (to < from || (uint64_t)to - (uint64_t)from < RANGE_MAX) return 1;
  return diag_error(b->diags, span, "a range has at most %d members", RANGE_MAX);
}

void report_many_indices(Builder *b, Span span) {
  diag_error(b->diags, span,
             "a family has one index, or two" HELP
             "combine two indices into one: `u[(i - 1)*K + j]`, in a family of N*K");
}
