/* Graph of the file's effects: edges `requires` and `excludes`, reachability, contradictions. */
#pragma once

#include "syntax/ast.h"

typedef struct {
  const AstStmt *stmt;
  /* indices of EffectGraph.at, in order of text; unknown names are left out */
  VEC(uint32_t) requires, excludes, required_by;
} EffectNode;

/* All effects, in order of text. */
typedef struct {
  EffectNode *at;
  uint32_t n;
} EffectGraph;

EffectGraph effect_graph(const Ast *ast);

/* Breadth-first search: sets in[] to 1 for an effect and all it requires, directly or not (up: all that require it).
 * Entries that are 1 already stop the search. */
void effect_reach(const Ast *ast, const EffectGraph *g, uint32_t effect, int up, uint8_t *in);

/* Reports unknown names, cycles of `requires`, and effects that no scene can use because two effects they require
 * exclude each other. 0 if there is a cycle or such an effect. */
int effects_check(const Ast *ast);
