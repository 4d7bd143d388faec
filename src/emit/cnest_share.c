/* Nests whose rows threads share, compiled with OpenMP: which rows a thread takes, and when their sums are added, so
 * that each sum gets its terms in the order of one thread (row_share.c). Without OpenMP the text is serial. */
#include "emit/cnest_impl.h"

static void begin_openmp(Writer *w) { sb_printf(w->out, "#ifdef %s_OPENMP\n", w->style->prefix); }
static void end_openmp(Writer *w) { sb_puts(w->out, "#endif\n"); }

const char *cnest_near_pointer(const Nesting *x) {
  return x->share == SHARE_LISTS ? x->near : arena_printf(x->body.a, "&%s", x->near);
}

int64_t cnest_near_members(const Nest *n) {
  const IrNear *near = &n->near;
  const int64_t ahead = n->at[near->at_i[0]].first - n->at[near->at_j[0]].first;
  return ahead / n->at[near->at_j[0]].by_turn + n->rows;
}

/* Whether the turns of some row meet the sum at[k]; k -1: whether turns have sums of their own. */
static int turns_meet(const Nesting *x, int64_t k) {
  const Prog *p = x->n->body;
  int some = 0;
  for (uint32_t m = 0; m < p->stores.n; m++) {
    const uint32_t at = p->stores.at[m].index;
    some |= p->stores.at[m].array != NEST_TEST && nest_moves(x->n, at) &&
            (k < 0 || !nest_never_meet(x->n, (uint32_t)k, at));
  }
  return some;
}

/* Whether store k adds to a sum of the row that goes on in another tile, or is added up after the shares. */
static int is_kept(const Nesting *x, uint32_t k) {
  const Store *st = &x->n->body->stores.at[k];
  if (st->array == NEST_TEST || nest_moves(x->n, st->index)) return 0;
  return x->share == SHARE_TILES || (x->share == SHARE_LISTS && !turns_meet(x, st->index));
}

static const char *kept_place(const Nesting *x, uint32_t k) {
  uint32_t before = 0;
  for (uint32_t m = 0; m < k; m++) before += is_kept(x, m) != 0;
  return arena_printf(x->body.a, "%s[%s]", x->kept,
                      cloop_index(x->body.a, (int64_t)before * x->n->rows, 1, x->i, 0, x->j));
}

static void declare_kept(Nesting *x) {
  Writer *w = &x->body;
  const char *real = w->style->prefix;
  long long n = 0;
  for (uint32_t k = 0; k < w->p->stores.n; k++) n += is_kept(x, k) ? x->n->rows : 0;
  if (!n) return;
  x->kept = cnames_take(&w->names, "kept");
  cnest_declare_array(w, x->kept, n);
  cwriter_line(w, arena_printf(w->a, "for (int %s = 0; %s < %lld; %s++) %s[%s] = %s_C(0.0);", x->i, x->i, n, x->i,
                               x->kept, x->i, real));
}

/* Tiles, each by the thread that takes it; the loop over the rows of one tile follows. */
static void open_tiles(Nesting *x) {
  Writer *w = &x->body;
  const Nest *n = x->n;
  const int64_t first = nest_to(n, 0), last = nest_to(n, (int64_t)n->rows - 1), turns = first > last ? first : last;
  const char *real = w->style->prefix, *tiles = cnames_take(&w->names, "tiles"), *done = cnames_take(&w->names, "done");
  x->tile = cnames_take(&w->names, "tile");
  begin_openmp(w);
  declare_kept(x);
  cwriter_line(w, arena_printf(w->a, "int %s[%s_SIDES(%u)] = {0};", done, real, n->rows));
  cwriter_line(w, arena_printf(w->a, "%s_TILES %s = {%s_SIDES(%u), %s_SIDES(%lld), 0, %s};", real, tiles, real, n->rows,
                               real, (long long)turns, done));
  sb_printf(w->out, "#pragma omp parallel %s_TEAM\n", real);
  cwriter_line(w, arena_printf(w->a, "for (%s_TILE %s = {-1, 0, 0, 0, 0}; %s_NEXT_TILE(&%s, &%s);)", real, x->tile,
                               real, tiles, x->tile));
  end_openmp(w);
}

/* Shares of a list, each by one thread; the loop over their rows follows. */
static void open_shares(Nesting *x) {
  Writer *w = &x->body;
  const char *real = w->style->prefix;
  x->tile = cnames_take(&w->names, "share"), x->shares = cnames_take(&w->names, "shares");
  begin_openmp(w);
  declare_kept(x);
  cwriter_line(w, arena_printf(w->a, "const int %s = %s_SHARES;", x->shares, real));
  sb_printf(w->out, "#pragma omp parallel for schedule(static, 1) num_threads(%s)\n", x->shares);
  cwriter_line(w, arena_printf(w->a, "for (int %s = 0; %s < %s; %s++)", x->tile, x->tile, x->shares, x->tile));
  end_openmp(w);
}

/* Where the row is that of a member of a later share: there is nothing left to add to its own sums. */
static const char *is_later(const Nesting *x, const char *then) {
  return arena_printf(x->body.a, "if (%s >= %s_SHARE_OF(%lld, %s + 1, %s)) %s;", cnest_turn_of_row(x, 1),
                      x->body.style->prefix, (long long)cnest_near_members(x->n), x->tile, x->shares, then);
}

/* Turns of the row: in a tile, or all of them. */
static void find_turns(Nesting *x) {
  Writer *w = &x->body;
  const char *real = w->style->prefix;
  if (x->share == SHARE_NONE || (x->share == SHARE_LISTS && turns_meet(x, -1))) return;
  if (x->share == SHARE_TILES) {
    const char *from = cnames_take(&w->names, "from"), *end = cnames_take(&w->names, "end");
    cwriter_line(w, arena_printf(w->a, "const int %s = %s_FROM(%s, %s.turn), %s = %s_TO(%s, %s.turn);", from, real,
                                 x->from, x->tile, end, real, x->end, x->tile));
    x->from = from, x->end = end;
  }
  begin_openmp(w);
  cwriter_line(w, x->share == SHARE_TILES ? arena_printf(w->a, "if (%s >= %s) continue;", x->from, x->end)
                                          : is_later(x, "break"));
  end_openmp(w);
}

/* Sums of the row that go on elsewhere. */
static void keep_sums(Nesting *x) {
  Writer *w = &x->body;
  if (x->share == SHARE_NONE) return;
  begin_openmp(w);
  if (x->share == SHARE_LISTS && turns_meet(x, -1)) cwriter_line(w, is_later(x, "continue"));
  for (uint32_t k = 0; k < w->p->stores.n; k++)
    if (is_kept(x, k)) cwriter_line(w, arena_printf(w->a, "%s = %s;", kept_place(x, k), x->partial[k]));
  if (x->share == SHARE_TILES)
    cwriter_line(w, arena_printf(w->a, "if (%s < %s) continue;", x->end, cnest_turn_of_row(x, 1)));
  if (x->share == SHARE_LISTS && x->kept) sb_puts(w->out, "#else\n");
  else end_openmp(w);
}

/* Adds the sums of the row; kept: those that wait for the end, of all rows. */
static void add_partial(Nesting *x, int kept) {
  Writer *w = &x->body;
  for (uint32_t k = 0; k < w->p->stores.n; k++)
    if (x->partial[k] && (x->share == SHARE_LISTS && is_kept(x, k)) == kept)
      cwriter_line(w, arena_printf(w->a, "%s[%s] += %s;", w->cells, cnest_place(x, w->p->stores.at[k].index),
                                   x->partial[k]));
}

void cnest_end_row(Nesting *x) {
  Writer *w = &x->body;
  keep_sums(x);
  if (x->share == SHARE_LISTS && x->kept) {
    add_partial(x, 1);
    end_openmp(w);
  }
  add_partial(x, 0);
}

/* The sums that threads have kept, in the order of rows. */
void cnest_end_rows(Nesting *x) {
  Writer *w = &x->body;
  if (x->share != SHARE_LISTS || !x->kept) return;
  begin_openmp(w);
  cnest_open_loop(w, x->i, "0", arena_printf(w->a, "%u", x->n->rows));
  for (uint32_t k = 0; k < w->p->stores.n; k++)
    if (is_kept(x, k)) x->partial[k] = kept_place(x, k);
  add_partial(x, 1);
  cnest_close_loop(w);
  end_openmp(w);
}

const char *cnest_declare_ours(Nesting *x) {
  Writer *w = &x->body;
  if (x->share != SHARE_LISTS || !turns_meet(x, -1)) return NULL;
  const char *ours = cnames_take(&w->names, "ours");
  cwriter_line(w, arena_printf(w->a, "const int %s = %s_SHARE_HAS(%lld, %s, %s, %s);", ours, w->style->prefix,
                               (long long)cnest_near_members(x->n), x->tile, x->shares, x->j));
  return ours;
}

void cnest_open_rows(Nesting *x) {
  Writer *w = &x->body;
  const char *from = "0", *end = arena_printf(w->a, "%u", x->n->rows), *real = w->style->prefix;
  if (x->share == SHARE_TILES) {
    open_tiles(x);
    from = arena_printf(w->a, "%s_FROM(0, %s.row)", real, x->tile);
    end = arena_printf(w->a, "%s_TO(%s, %s.row)", real, end, x->tile);
  } else if (x->share == SHARE_LISTS) {
    open_shares(x);
    const int64_t members = cnest_near_members(x->n);
    from = arena_printf(w->a, "%s_SHARE_FROM(%lld, %s, %s, %lld)", real, (long long)members, x->tile, x->shares,
                        (long long)(members - x->n->rows));
  }
  cnest_open_loop(w, x->i, from, end);
  find_turns(x);
}

const char *cnest_row_begins(const Nesting *x, uint32_t k) {
  const Writer *w = &x->body;
  return x->share == SHARE_TILES ? arena_printf(w->a, "%s_KEPT(%s)", w->style->prefix, kept_place(x, k))
                                 : arena_printf(w->a, "%s_C(0.0)", w->style->prefix);
}

void cnest_find_list(Nesting *x) {
  Writer *w = &x->body;
  const char *list = x->near;
  if (x->share == SHARE_LISTS) {
    begin_openmp(w);
    cwriter_line(w, arena_printf(w->a, "const int %s_n = lag_near_shared(%s, %s, %s, %s, &%s_j);", list, list,
                                 cnest_turn_of_row(x, 1), x->tile, x->shares, list));
    sb_puts(w->out, "#else\n");
  }
  cwriter_line(w, arena_printf(w->a, "const int %s_n = lag_near_of(%s, %s, &%s_j);", list, cnest_near_pointer(x),
                               cnest_turn_of_row(x, 1), list));
  if (x->share == SHARE_LISTS) end_openmp(w);
}
