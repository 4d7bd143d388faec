/* Ranked search: every passage (a paragraph, item or row of a document, a command, an option) gets a weight for each
 * word of the question, more where the word is rare, stands in the title, or is the user's own and not a synonym;
 * passages that have all words come first. */
#include "commands/help_search.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/words.h"
#include "commands/command_table.h"
#include "commands/manual.h"
#include "commands/terminal_page.h"

/* ---- passages ---- */

typedef struct {
  const char *head, *title; /* as printed; the words of it that rank */
  const char *topic;        /* `lagc help TOPIC` shows its surroundings */
  const char *text, *all;   /* all: with the code that follows */
  const char *const *code;  /* NULL: none */
  double score, bonus;
  uint32_t order;
} Passage;

typedef VEC(Passage) Passages;

static Passage *add_passage(Arena *a, Passages *to, const char *title, const char *topic, const char *text) {
  vec_push(a, to,
           ((Passage){
               .head = title, .title = title, .topic = topic, .text = text, .all = text, .bonus = 1, .order = to->n}));
  return &to->at[to->n - 1];
}

static void add_code(Arena *a, Passage *p, const char *const *code, size_t n) {
  StrBuf all = strbuf(a);
  sb_puts(&all, p->text);
  page_code(&all, code, n);
  p->all = sb_text(&all);
  p->code = code;
}

static void add_document(Arena *a, Passages *to, const Document *d) {
  const char *title = d->title, *topic = d->topic;
  for (size_t i = 0, n; i < d->n; i += n) {
    StrBuf text = strbuf(a);
    int code;
    n = page_block(&text, d->lines + i, d->n - i, &code);
    if (document_heading(d->lines[i])) {
      const char *heading = d->lines[i] + strspn(d->lines[i], "# "),
                 *word = i + 1 < d->n ? word_at(a, document_words(a, d->lines[i + 1]), 0) : NULL;
      title = arena_strndup(a, heading, strcspn(heading, "\n"));
      topic = word ? word : d->topic;
    }
    if (code && to->n && to->at[to->n - 1].head == title) add_code(a, &to->at[to->n - 1], d->lines + i, n);
    if (text.n) add_passage(a, to, title, topic, sb_text(&text));
  }
}

static void add_commands(Arena *a, Passages *to) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (!row->does) continue;
    const char *title = arena_printf(a, "lagc %s", row->name);
    add_passage(a, to, title, row->name, row->does)->bonus = 1.5;
    for (const char *s = row->help, *end; *s; s = end + strspn(end, "\n")) {
      if (!(end = strstr(s, "\n\n"))) end = s + strlen(s);
      add_passage(a, to, title, row->name, arena_strndup(a, s, (size_t)(end - s)));
    }
    for (size_t k = 0; option_row(k); k++) {
      const OptionRow *o = option_row(k);
      /* listed once */
      if (!(o->commands & command_bit(row->command)) || o->commands & (command_bit(row->command) - 1)) continue;
      Passage *p = add_passage(a, to, o->name, row->name, o->does);
      p->head = arena_printf(a, "lagc %s %s%s%s", row->name, o->name, o->value ? " " : "", o->value ? o->value : "");
    }
  }
}

/* ---- words ---- */

/* A word of the question and its synonyms, as stems. */
typedef struct {
  VEC(const char *) stems; /* the first one is the user's own */
  double rarity;
} Question;

static const struct {
  const char *words, *means, *way;
} ways[] = {
#define WORDS(words, means, way) {words, means, way},
#include "commands/help_words.def"
#undef WORDS
};

static int is_letter(char c) { return isalnum((unsigned char)c) || c == '_' || (unsigned char)c >= 0x80; }

static const char *const endings[] = {"isations", "izations", "isation", "ization", "ations", "ising", "izing", "ation",
                                      "ised",     "ized",     "ises",    "izes",    "ings",   "ise",   "ize",   "ies",
                                      "ing",      "ed",       "es",      "ic",      "s",      "e",     "y"};
enum { N_ENDINGS = sizeof endings / sizeof *endings };

/* The word in small letters without its ending: linearizing, linearisation -> linear; at least four letters
 * stay, before a y five: unity is no unit. */
static const char *stem(Arena *a, const char *word) {
  char *w = arena_strdup(a, word);
  size_t n = strlen(w);
  for (char *s = w; *s; s++) *s = (char)tolower((unsigned char)*s);
  for (size_t i = 0; i < N_ENDINGS; i++) {
    size_t m = strlen(endings[i]);
    if (n < m + 4 + (*endings[i] == 'y') || strcmp(w + n - m, endings[i]) != 0) continue;
    w[n - m] = '\0';
    break;
  }
  return w;
}

/* Whether n letters may follow a stem: an ending; behind five letters and more any few. */
static int continues(const char *letters, size_t n, size_t stem_length) {
  if (!n || (stem_length > 4 && n <= 7)) return 1;
  for (size_t i = 0; i < N_ENDINGS; i++)
    if (strlen(endings[i]) == n && strncmp(letters, endings[i], n) == 0) return 1;
  return 0;
}

/* Number of words of the text that begin with the stem. */
static unsigned count(const char *text, const char *stem_) {
  size_t n = strlen(stem_);
  unsigned found = 0;
  for (const char *s = text; *s; s++) {
    if (s > text && is_letter(s[-1])) continue;
    size_t i = 0, more = 0;
    while (i < n && tolower((unsigned char)s[i]) == stem_[i]) i++;
    if (i < n) continue;
    while (is_letter(s[n + more])) more++;
    found += (unsigned)continues(s + n, more, n);
  }
  return found;
}

static size_t way_of(Arena *a, const char *word) {
  const char *want = stem(a, word), *w = NULL;
  size_t found = 0, n = sizeof ways / sizeof *ways;
  for (; found < n && !w; found += !w) {
    size_t k = 0;
    while ((w = word_at(a, ways[found].words, k)) != NULL && strcmp(stem(a, w), want) != 0) k++;
  }
  return found;
}

const char *help_way(Arena *a, const char *word) {
  size_t i = way_of(a, word);
  return i < sizeof ways / sizeof *ways ? ways[i].way : NULL;
}

static Question question(Arena *a, const char *word) {
  Question q = {0};
  size_t way = way_of(a, word);
  vec_push(a, &q.stems, stem(a, word));
  for (size_t k = 0; way < sizeof ways / sizeof *ways && word_at(a, ways[way].means, k); k++)
    vec_push(a, &q.stems, word_at(a, ways[way].means, k));
  return q;
}

/* ---- ranking ---- */

/* Weight of a word in a passage, 0 to about 4. */
static double weight(const Passage *p, const Question *q) {
  double best = 0;
  for (uint32_t i = 0; i < q->stems.n; i++) {
    const char *s = q->stems.at[i];
    double n = count(p->all, s), title = count(p->title, s) != 0, topic = count(p->topic, s) != 0;
    double w = (i ? 0.5 : 1) * (n / (n + 0.5 + (double)strlen(p->all) / 1000) + 1.5 * title + topic);
    if (w > best) best = w;
  }
  return best;
}

static int by_score(const void *x, const void *y) {
  const Passage *p = x, *q = y;
  return p->score != q->score ? (p->score < q->score ? 1 : -1) : (p->order > q->order) - (p->order < q->order);
}

static void rank(Passages *in, Question *asked, uint32_t n) {
  for (uint32_t k = 0; k < n; k++) {
    double with = 1;
    for (uint32_t i = 0; i < in->n; i++) with += weight(&in->at[i], &asked[k]) > 0;
    asked[k].rarity = log(1 + in->n / with);
  }
  for (uint32_t i = 0; i < in->n; i++) {
    double sum = 0, has = 0;
    for (uint32_t k = 0; k < n; k++) {
      double w = weight(&in->at[i], &asked[k]);
      sum += asked[k].rarity * w;
      has += w > 0;
    }
    in->at[i].score = in->at[i].bonus * sum * has * has / n / n;
  }
  if (in->n) qsort(in->at, in->n, sizeof *in->at, by_score);
}

/* ---- answers ---- */

/* The end of the sentence at s: a full stop before a space and a capital letter, outside code. */
static const char *sentence_end(const char *s) {
  int code = 0;
  for (; *s; s++) {
    code ^= *s == '`';
    if (!code && *s == '.' && isspace((unsigned char)s[1]) && isupper((unsigned char)s[2])) return s + 2;
  }
  return s;
}

/* A passage; of a long one the first sentence, and those with the words. */
static void put_text(StrBuf *out, const Passage *p, const Question *asked, uint32_t n) {
  enum { LONG = 480 };
  StrBuf text = strbuf(out->arena);
  int gap = 0;
  for (const char *s = p->text, *end; *s && text.n < LONG; s = end) {
    end = sentence_end(s);
    Passage one = {.title = "", .topic = "", .all = arena_strndup(out->arena, s, (size_t)(end - s))};
    int has = strlen(p->text) <= LONG || s == p->text;
    for (uint32_t k = 0; k < n; k++) has |= weight(&one, &asked[k]) > 0;
    if (has) sb_printf(&text, "%s%s", gap ? "... " : "", one.all);
    gap = !has;
  }
  sb_puts(out, "  ");
  page_words(out, sb_text(&text), text.n, 2, 2);
}

static void put_code(StrBuf *out, const Passage *p) {
  enum { LONGEST = 20 };
  size_t n = 1;
  while (n <= LONGEST && strncmp(p->code[n], "```", 3) != 0) n++;
  if (n <= LONGEST) page_code(out, p->code, n + 1);
}

static void put_answers(StrBuf *out, const Passages *in, const Question *asked, uint32_t n) {
  enum { MOST = 5, OF_A_TOPIC = 2 };
  for (uint32_t i = 0, shown = 0; i < in->n && shown < MOST && in->at[i].score > 0.3 * in->at[0].score; i++) {
    const Passage *p = &in->at[i];
    int same = 0;
    for (uint32_t k = 0; k < i; k++) same += strcmp(in->at[k].topic, p->topic) == 0;
    if (same >= OF_A_TOPIC) continue;
    sb_printf(out, "%s%s: `lagc help %s`\n", out->n ? "\n" : "", p->head, p->topic);
    put_text(out, p, asked, n);
    if (p->code && shown < 2) put_code(out, p);
    shown++;
  }
}

int help_search(StrBuf *out, const char *words) {
  static const char idle[] = "a an the how to do does i is are of for with and or in on my me can what find make get "
                             "use using lagc it from by as at";
  enum { MOST = 8 };
  Arena *a = out->arena;
  Question asked[MOST];
  uint32_t n = 0;
  int said = 0; /* the way of the word before names this one, too */
  Passages all = {0};
  StrBuf told = strbuf(a);
  for (const char *s = words; *s && n < MOST;) {
    size_t len = strcspn(s, " "), next = strcspn(s + len + (s[len] == ' '), " ");
    const char *word = arena_strndup(a, s, len),
               *both = arena_printf(a, "%s%.*s", word, (int)next, s + len + (s[len] == ' '));
    /* time step: timestep */
    const char *joint = next ? help_way(a, both) : NULL, *way = joint ? joint : said ? NULL : help_way(a, word);
    s += len + (s[len] == ' ');
    said = joint != NULL;
    if (!len || (has_word(idle, word) && !joint)) continue;
    asked[n++] = question(a, word);
    if (way && !strstr(sb_text(&told), way)) sb_printf(&told, "%s%s", told.n ? "\n\n" : "", way);
  }
  if (!n) return 0;
  page_paragraphs(out, sb_text(&told));
  for (size_t i = 0; i < N_DOCUMENTS; i++) add_document(a, &all, &documents[i]);
  add_commands(a, &all);
  rank(&all, asked, n);
  put_answers(out, &all, asked, n);
  return out->n != 0;
}
