/* Effects of a file: what they require and exclude. */
#ifndef LAGC_EFFECT_H
#define LAGC_EFFECT_H

#include "syntax/ast.h"

typedef struct {
  const AstStmt *stmt;
  VEC(uint32_t) requires, excludes, required_by; /* places in the list, in order of text; names that are no effect are left out */
} EffectNode;

/* All effects, in order of text. */
typedef struct {
  EffectNode *at;
  uint32_t n;
} EffectGraph;

EffectGraph effect_graph(const Ast *ast);

/* in[n] := 1 for the effect and, however indirectly, what it requires (for those that require it, with up set); others are left
 * as they are. */
void effect_reach(const Ast *ast, const EffectGraph *g, uint32_t effect, int up, uint8_t *in);

/* Reports effects that require themselves, however indirectly, and those that no scene could use, as what they require excludes
 * each other. 0 when there are such. */
int effects_check(const Ast *ast);

#endif
