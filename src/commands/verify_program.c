/* The program of `lagc verify`: the emitted model and the function by hand, behind one interface. Enters: a text of C;
 * leaves: its results, or what the text lacks. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/words.h"
#include "commands/verify.h"
#include "commands/verify_driver.h" /* static const char *const verify_driver[]: generated from verify_driver.in */
#include "emit/emit_model.h"
#include "emit/late_text.h"
#include "toolchain/simulator_cache.h"

/* Text with comments and literals blanked, so that braces and names are those of code. */
static char *code_only(Arena *a, const char *text) {
  char *s = arena_strdup(a, text);
  for (size_t i = 0; s[i];) {
    size_t n = 1;
    if (s[i] == '/' && s[i + 1] == '/') n = strcspn(s + i, "\n");
    else if (s[i] == '/' && s[i + 1] == '*')
      n = strstr(s + i + 2, "*/") ? (size_t)(strstr(s + i + 2, "*/") - (s + i)) + 2 : strlen(s + i);
    else if (s[i] == '"' || s[i] == '\'') {
      while (s[i + n] && s[i + n] != s[i] && s[i + n] != '\n') n += s[i + n] == '\\' && s[i + n + 1] ? 2 : 1;
      n += s[i + n] != '\0';
    } else {
      i++;
      continue;
    }
    for (size_t k = 0; k < n; k++)
      if (s[i + k] != '\n') s[i + k] = ' ';
    i += n;
  }
  return s;
}

typedef VEC(Name) Names;

/* Functions that the file defines: a name and a list in parentheses before a brace, outside all braces. */
static Names functions_of(Arena *a, const char *text) {
  Names names = {0};
  const char *s = code_only(a, text), *name = NULL, *end = NULL;
  int braces = 0, parentheses = 0, listed = 0;
  for (const char *c = s; *c; c++) {
    if (*c == '#' && (c == s || c[-1] == '\n')) { /* a directive */
      while (c[1] && (c[1] != '\n' || *c == '\\')) c++;
    } else if (braces) {
      braces += (*c == '{') - (*c == '}');
    } else if (isalpha((unsigned char)*c) || *c == '_') {
      const char *from = c;
      while (isalnum((unsigned char)c[1]) || c[1] == '_') c++;
      if (!parentheses && !listed) name = from, end = c + 1;
    } else if (*c == '(' || *c == ')') {
      parentheses += *c == '(' ? 1 : -1;
      listed |= name && *c == ')' && !parentheses;
    } else if (*c == '{') {
      braces = 1;
      if (listed && !parentheses) vec_push(a, &names, arena_strndup(a, name, (size_t)(end - name)));
      listed = 0;
    } else if (*c == ';') {
      listed = 0;
    }
  }
  return names;
}

const char *verify_function_missing(Verification *v, const char *text) {
  Names names = functions_of(v->arena, text);
  StrBuf b = strbuf(v->arena);
  for (uint32_t i = 0; i < names.n; i++) {
    if (strcmp(names.at[i], v->function) == 0) return NULL;
    sb_printf(&b, "%s%s", i ? ", " : "", names.at[i]);
  }
  Name near = suggest(v->function, names.at, names.n);
  const char *help = near      ? arena_printf(v->arena, ": did you mean `%s`?", near)
                     : names.n ? arena_printf(v->arena, "; it has %s", sb_text(&b))
                               : "";
  return arena_printf(v->arena, "%s has no function `%s`%s", v->file, v->function, help);
}

/* The function behind one interface, whether it returns void or a number; names of macros in the file cannot collide
 * with these. */
static const char *adapter_text(const Verification *v, const char *path) {
  const char *f = v->function;
  return arena_printf(
      v->arena,
      "#define main lag_against_main\n#include \"%s\"\n#undef main\n"
      "#define LAG_IS(result, Y) __builtin_types_compatible_p(__typeof__(&%s), result (*)(double, Y, const double *, "
      "double *))\n"
      "_Static_assert(!LAG_IS(void, const double *) && !LAG_IS(int, const double *) && !LAG_IS(void, double *) && "
      "!LAG_IS(int, double *),\n"
      "               \"its third argument should be dydt, which it writes, and is a pointer to const\");\n"
      "int lag_against(double lag_t, double *lag_y, double *lag_dydt, double *lag_p) {\n"
      "  return __builtin_choose_expr(__builtin_types_compatible_p(__typeof__(%s(lag_t, lag_y, lag_dydt, lag_p)), "
      "void),\n"
      "    (%s(lag_t, lag_y, lag_dydt, lag_p), 0), %s(lag_t, lag_y, lag_dydt, lag_p));\n}\n",
      path, f, f, f, f);
}

/* The model for another scalar: flags -D and -include of the toolchain as text, since the function is compiled by
 * the same command. */
static const char *model_text(const Verification *v, const ProgramSet *u, const Toolchain *t) {
  StrBuf b = strbuf(v->arena);
  for (const char *const *f = t->flags; *f; f++) {
    if (strcmp(*f, "-include") == 0) sb_printf(&b, "#include <%s>\n", *++f);
    const char *equals = strchr(*f, '=');
    if (strncmp(*f, "-D", 2) == 0 && equals)
      sb_printf(&b, "#define %.*s %s\n", (int)(equals - *f - 2), *f + 2, equals + 1);
  }
  emit_model(u, "lag_derived", MODEL_PLAIN, &b); /* a function by hand often has the model's name */
  for (size_t i = 0; i < sizeof verify_driver / sizeof *verify_driver; i++) sb_puts(&b, verify_driver[i]);
  sb_puts(&b, "\nint main(void) { return lag_compare(&lag_derived); }\n");
  const StrBuf whole = late_text_write(&b);
  return sb_text(&whole);
}

int verify_run(Verification *v, const char *precision) {
  static const char *const flags[] = {"-std=gnu11",
                                      "-Werror=incompatible-pointer-types", "-Werror=int-conversion",
                                      "-Werror=implicit-function-declaration", "-Wfatal-errors",
                                      NULL};
  Toolchain t;
  if (!toolchain_find(v->arena, v->c->argv0, 0, &t, &v->run.error)) return 0;
  toolchain_scalar(&t, precision);
  SourceText texts[] = {{"model.c", model_text(v, v->program, &t)}, {"against.c", adapter_text(v, v->path)}};
  t.flags = flags;
  cache_remove_stale_builds(v->arena);
  return toolchain_run_once(v->arena, &t, texts, 2, &v->run);
}
