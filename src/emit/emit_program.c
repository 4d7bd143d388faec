/* The program behind the last model of a simulator or library: the table of its scenes, and main(). */
#include "emit/emit_impl.h"
#include "emit/emit_model.h"

static void emit_main(const char *names_first, ProgramKind kind, StrBuf *out) {
  if (kind & PROGRAM_LIBRARY) {
    sb_puts(out, "const lag_program *lag_library(void) { return &program; }\n");
    return;
  }
  int gsl = (kind & PROGRAM_WITH_GSL) != 0,
      more = (kind & (PROGRAM_WITH_PNG | PROGRAM_WITH_HDF5 | PROGRAM_WITH_MPI)) != 0;
  sb_printf(out, "int main(int argc, char **argv) {\n%s", names_first);
  if (more) sb_printf(out, "  lag_extras extras = %s;\n", gsl ? "lag_gsl" : "{0}");
  if (kind & PROGRAM_WITH_PNG) sb_puts(out, "  extras.png = lag_png_write;\n");
  if (kind & PROGRAM_WITH_HDF5) sb_puts(out, "  extras.hdf5 = lag_hdf5_write;\n");
  if (kind & PROGRAM_WITH_MPI) sb_puts(out, "  extras.ranks = &lag_mpi;\n");
  sb_printf(out, "  return lag_app_main(argc, argv, &program, %s);\n}\n", more ? "&extras" : gsl ? "&lag_gsl" : "NULL");
}

void emit_program(const ProgramSet *const *units, const char *const *names, uint32_t n, ProgramKind kind, StrBuf *out) {
  const ProgramSet *first = units[0];
  Arena *a = first->arena;
  int lanes = (kind & PROGRAM_WITH_LANES) != 0;
  sb_puts(out, lanes ? "\n#ifndef LAG_LANES\n#include \"lag.h\"\n\n" : "\n#include \"lag.h\"\n\n");
  uint32_t scenes = 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++, scenes++)
      sb_printf(out, "extern const lag_scene %s_%s;\n", names[i], scene_id(units[i], k));
  sb_puts(out, "\n#ifndef LAG_BUILD /* compiler and flags */\n#define LAG_BUILD NULL\n#endif\n");
  sb_puts(out, "\nstatic const lag_scene *const scenes[] = {\n");
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++)
      sb_printf(out, "  &%s_%s,\n", names[i], scene_id(units[i], k));
  sb_puts(out, "};\n\n");
  const char *name = c_string(a, first->name), *doc = c_string(a, first->doc), *source = c_string(a, first->source);
  for (int k = 4; k <= 8 && lanes; k *= 2) emit_lane_scenes(units, names, n, k, out);
  sb_printf(out,
            "static const lag_program program = {\n  .name = %s,\n  .doc = %s,\n  .source = %s,\n  .effects = %s,\n  "
            ".build = LAG_BUILD,\n  .nscenes = %u, .scenes = scenes,\n%s};\n\n",
            name, doc, source, c_string(a, first->all_effects), scenes,
            lanes ? "  .lanes_4 = lanes_4, .lanes_8 = lanes_8,\n" : "");
  StrBuf first_calls = strbuf(a);
  for (uint32_t i = 0; i < n && program_names_late(kind); i++)
    if (model_has_long_tables(units[i])) {
      sb_printf(out, "void %s_names(void);\n", names[i]);
      sb_printf(&first_calls, "  %s_names();\n", names[i]);
    }
  emit_main(sb_text(&first_calls), kind, out);
  if (lanes) sb_puts(out, "#endif\n");
}
