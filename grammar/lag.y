/* The grammar. In: the filter's tokens (src/syntax/token.h): every statement is closed by one END,
 * statement words are tokens of their own, and the filter has decided which word may stand in which
 * block, so that one rule `stmt` serves files, effects, scenes and events.
 * Out: an Ast; each action is one call of a builder (src/syntax/ast_build.h).
 *
 * A push parser: src/syntax/parse.c owns its stack, so that nothing leaks when memory runs out in
 * an action. Recovery is at the ends of statements only. */
%define api.pure full
%define api.push-pull push
%define api.prefix {lag_}
%define api.token.prefix {LAG_}
%define api.location.type {Span}
%define parse.error custom
%define parse.lac full
%define lr.type ielr
%locations
%expect 0
%parse-param {Parse *cx} {Ast *ast}

%code requires {
#include "syntax/parse_state.h"
}

%code {
/* The span of a rule joins the spans of its parts; an empty part has none. */
#define YYLLOC_DEFAULT(Current, Rhs, N)                                                     \
  do {                                                                                      \
    (Current) = (Span){0, 0};                                                               \
    for (int part = 1; part <= (N); part++) (Current) = span_join((Current), YYRHSLOC(Rhs, part)); \
  } while (0)

/* Limit of nesting: PARSE_STACK entries of about 80 bytes. */
#define YYMAXDEPTH PARSE_STACK

#define NONE_LIST ((AstList){0, 0})
#define NONE_STMTS ((StmtList){NULL, NULL})
#define NONE_TEXT ((AstText){0})
#define NONE_UNIT ((AstUnit){0})
#define NONE_IDENT ((Ident){0})

static void lag_error(const Span *span, Parse *cx, Ast *ast, const char *message);
}

%union {
  Ident ident;
  Num number;
  AstUnit unit;
  AstText text;
  AstId id;
  AstList list;
  AstDeclared declared;
  AstStmt *one;
  StmtList stmts;
  AstSign sign;
  AstDirection way;
  int yes;
}

%token FINISH 0 BEGIN_FILE BEGIN_EXPR END NEWLINE SEMICOLON BAD BADWORD
%token <ident> IDENT
%token <number> NUMBER
%token <text> STRING
%token <unit> UNIT
%token PRIME "'" LPAREN "(" RPAREN ")" INDEX "[" RBRACKET "]" LBRACE "{" RBRACE "}"
%token COMMA "," COLON ":" DOT "." RANGE ".." ARROW "->" ASSIGN "="
%token PLUS "+" MINUS "-" TIMES "*" DIVIDE "/" POWER "^"
%token LT "<" LE "<=" GT ">" GE ">=" EQ "==" NE "!=" AND "and" OR "or" NOT "not" IN "in"
%token <ident> SUM "sum" PRODUCT "product"
%token MODEL "model" INCLUDE "include" COORD "coord" MOMENTUM "momentum" PARAM "param" CONST "const" INPUT "input" STATE "state"
%token LET "let" FUNCTION "function" NETWORK "network" HAMILTONIAN "hamiltonian" LAGRANGIAN "lagrangian" KINETIC "kinetic" POTENTIAL "potential"
%token DISSIPATION "dissipation" FORCE "force" FRICTION "friction" FLOW "flow" CONSTRAINT "constraint" SYMMETRY "symmetry" CANONICAL "canonical"
%token EXPECT "expect" EVENT "event" KICK "kick" CONTACT "contact" GUIDE "guide" OBSERVE "observe" DRAW "draw" FOR "for"
%token EFFECT "effect"
%token REQUIRES "requires" EXCLUDES "excludes" SCENE "scene" START "start" EXACT "exact" USE "use"
%token SPAN "span" METHOD "method" TOLERANCE "tolerance" OUTPUT "output" MONITOR "monitor" MEASURE "measure" LIKE "like"
%token STOP "stop" PERIODIC "periodic" RISING "rising" FALLING "falling" CROSSING "crossing"
%token ON "on" OF "of" STATIC "static" RESTITUTION "restitution" SLIP "slip" TANGENTIAL "tangential" LAW "law" EXACTLY "exactly" GUESS "guess" EVERY "every" WHILE "while" FROM "from" LAYERS "layers"
%token <ident> SHAPE CLAUSE

%type <stmts> stmts block stmt coords momenta params consts inputs states lets observed requires excludes assigns maps items
%type <stmts> options options_opt uses monitors
%type <one> single coord momentum param const input_ state let observable item map map_item each required excluded
%type <one> assign option use monitor
%type <list> members clauses several
%type <declared> declaration
%type <id> clause
%type <list> rubbing laws dims indices places_bound ranges exprs args names variables
%type <id> window
%type <id> happening expr arith primary reach place moved bound range value comparison every limit number literal declared gap sides law tuple condition
%type <text> doc weights
%type <unit> unit
%type <ident> type method_name activation
%type <sign> sign
%type <way> direction
%type <yes> periodic exactly

%left "or"
%left "and"
%precedence "not"
%left "+" "-"
%left "*" "/"
%precedence NEGATION
%right "^"

%%

input: BEGIN_FILE stmts[s]   { parse_done_file(cx, $s); }
     | BEGIN_EXPR value[v] END { parse_done_value(cx, $v); }
     ;

stmts: %empty              { $$ = NONE_STMTS; }
     | stmts[s] stmt[x] END { $$ = stmts_join($s, $x); }
     | stmts[s] error END   { $$ = $s; yyerrok; }
     ;

block: "{" stmts[s] "}" { $$ = $s; };

stmt: single[x]                       { $$ = stmts_one($x); }
    | "coord" coords[l]               { $$ = $l; }
    | "momentum" momenta[l]           { $$ = $l; }
    | "param" params[l]               { $$ = $l; }
    | "const" consts[l]               { $$ = $l; }
    | "input" inputs[l]               { $$ = $l; }
    | "state" states[l]               { $$ = $l; }
    | "let" lets[l]                   { $$ = $l; }
    | "observe" observed[l]           { $$ = $l; }
    | "flow" assigns[l]               { $$ = stmts_set_kind(ast, $l, STMT_FLOW, 0); }
    | "requires" requires[l]          { $$ = $l; }
    | "excludes" excludes[l]          { $$ = $l; }
    | "start" exactly[x] assigns[l]   { $$ = stmts_set_kind(ast, $l, STMT_START, $x); }
    | "exact" assigns[l]              { $$ = stmts_set_kind(ast, $l, STMT_EXACT, 0); }
    | "use" uses[l]                   { $$ = $l; }
    | "monitor" monitors[l]           { $$ = $l; }
    | "guide" IDENT[n] members[d] ":" sides[c] laws[r] { $$ = stmts_each(ast, $d.first, $d.last, stmts_guide(ast, @$, $n, $d, $c, $r)); }
    | "friction" IDENT[n] members[d] "on" place[q] ":" arith[f] limit[s] { $$ = stmts_each(ast, $d.first, $d.last, stmts_friction(ast, @$, $n, $d, $q, $f, $s)); }
    ;

single: "model" IDENT[n] doc[d]                 { $$ = stmt_titled(ast, STMT_MODEL, @$, $n, $d, NONE_STMTS); }
      | "include" STRING[p]                     { $$ = stmt_include(ast, @$, $p); }
      | "function" IDENT[n] "(" names[a] ")" "=" expr[e] { $$ = stmt_function(ast, @$, $n, $a, $e); }
      | "network" IDENT[n] "(" names[a] ")" weights[p] "layers" exprs[l] activation[f] { $$ = stmt_network(ast, @$, $n, $a, $p, $l, $f); }
      | "hamiltonian" "=" expr[e]               { $$ = stmt_hamiltonian(ast, @$, $e); }
      | "lagrangian" "=" expr[e]                { $$ = stmt_value(ast, STMT_LAGRANGIAN, @$, $e); }
      | "kinetic" "=" expr[e]                   { $$ = stmt_value(ast, STMT_KINETIC, @$, $e); }
      | "potential" "=" expr[e]                 { $$ = stmt_value(ast, STMT_POTENTIAL, @$, $e); }
      | "dissipation" "=" expr[e]               { $$ = stmt_value(ast, STMT_DISSIPATION, @$, $e); }
      | "force" place[q] "=" expr[e]            { $$ = stmts_each(ast, $q, $q, stmts_one(stmt_pair(ast, STMT_FORCE, @$, $q, $e))).first; }
      | "force" tuple[q] "=" expr[e]            { $$ = stmt_pair(ast, STMT_FORCE, @$, $q, $e); }
      | "constraint" IDENT[n] members[d] ":" arith[a] "=" expr[b] condition[w] { $$ = stmts_each(ast, $d.first, $d.last, stmts_one(stmt_equation(ast, STMT_CONSTRAINT, @$, $n, $d, $a, $b, $w))).first; }
      | "symmetry" IDENT[n] "(" names[a] ")" doc[d] ":" maps[m] { $$ = stmt_maps(ast, STMT_SYMMETRY, @$, $n, $a, $d, $m); }
      | "canonical" IDENT[n] variables[a] doc[d] ":" items[m] { $$ = stmt_maps(ast, STMT_CANONICAL, @$, $n, $a, $d, $m); }
      | "expect" IDENT[n] ":" arith[a] "=" expr[b] { $$ = stmt_equation(ast, STMT_EXPECT, @$, $n, NONE_LIST, $a, $b, 0); }
      | "expect" arith[a] "=" expr[b]           { $$ = stmt_equation(ast, STMT_EXPECT, @$, NONE_IDENT, NONE_LIST, $a, $b, 0); }
      | "event" IDENT[n] members[d] ":" arith[g] direction[w] block[b] { $$ = stmts_each(ast, $d.first, $d.last, stmts_one(stmt_event(ast, @$, $n, $d, $g, $w, $b))).first; }
      | "kick" IDENT[n] members[d] "every" arith[T] block[b] { $$ = stmts_each(ast, $d.first, $d.last, stmts_one(stmt_event(ast, @$, $n, $d, $T, AT_EQUAL_TIMES, $b))).first; }
      | "contact" IDENT[n] dims[d] ":" gap[g] "," "restitution" "=" expr[e] rubbing[r] { $$ = stmt_equation(ast, STMT_CONTACT, @$, $n, $d, $g, $e, $r.first); }
      | "contact" IDENT[n] "[" ranges[d] "]" ":" gap[g] "," "restitution" "=" expr[e] rubbing[r] { $$ = stmt_equation(ast, STMT_CONTACT, @$, $n, $d, $g, $e, $r.first); }
      | "for" IDENT[i] "in" arith[lo] ".." arith[hi] block[b] { $$ = stmt_for(ast, @$, $i, $lo, $hi, $b); }
      | "effect" IDENT[n] doc[d] block[b]       { $$ = stmt_titled(ast, STMT_EFFECT, @$, $n, $d, $b); }
      | "scene" IDENT[n] doc[d] block[b]        { $$ = stmt_titled(ast, STMT_SCENE, @$, $n, $d, $b); }
      | "span" arith[e]                         { $$ = stmt_value(ast, STMT_SPAN, @$, $e); }
      | "method" method_name[n] options_opt[o]  { $$ = stmt_titled(ast, STMT_METHOD, @$, $n, NONE_TEXT, $o); }
      | "tolerance" arith[e]                    { $$ = stmt_value(ast, STMT_TOLERANCE, @$, $e); }
      | "output" exprs[l] every[e]              { $$ = stmt_equation(ast, STMT_OUTPUT, @$, NONE_IDENT, NONE_LIST, 0, $e, $l.first); }
      | "measure" IDENT[n] "=" expr[e]          { $$ = stmt_equation(ast, STMT_MEASURE, @$, $n, NONE_LIST, 0, $e, 0); }
      | "draw" SHAPE[k] members[d] clauses[c]     { $$ = stmt_equation(ast, STMT_DRAW, @$, $k, $d, 0, 0, $c.first); }
      | "draw" SHAPE[k] members[d] value[e] clauses[c] { $$ = stmt_equation(ast, STMT_DRAW, @$, $k, $d, $e, 0, $c.first); }
      | "draw" SHAPE[k] members[d] IDENT[n] "=" expr[e] clauses[c] { $$ = stmt_equation(ast, STMT_DRAW, @$, $k, $d, ast_name(ast, $n), $e, $c.first); }
      | "like" IDENT[n]                         { $$ = stmt_name(ast, STMT_LIKE, @$, $n); }
      | "stop"                                  { $$ = stmt_plain(ast, STMT_STOP, @$); }
      | moved[p] "=" value[v]                   { $$ = stmt_pair(ast, STMT_SET, @$, $p, $v); }
      ;

/* ---- lists of declarations: one statement each ---- */

coords: coord[x]               { $$ = stmts_one($x); }
      | coords[l] "," coord[x] { $$ = stmts_add($l, $x); }
      ;
coord: declaration[x] periodic[p] { $$ = stmt_coord(ast, STMT_COORD, @$, $x, $p); };
declaration: IDENT[n] members[d] type[t] unit[u] { $$ = (AstDeclared){$n, $t, $d, $u}; };

momenta: momentum[x]                { $$ = stmts_one($x); }
       | momenta[l] "," momentum[x] { $$ = stmts_add($l, $x); }
       ;
momentum: IDENT[n] dims[d] type[t] "of" IDENT[q] unit[u] { $$ = stmt_momentum(ast, @$, $n, $d, $t, $q, $u); };

params: param[x]               { $$ = stmts_one($x); }
      | params[l] "," param[x] { $$ = stmts_add($l, $x); }
      ;
param: declaration[x] "=" arith[v] sign[s] { $$ = stmt_param(ast, @$, $x, $v, $s); };

consts: const[x]               { $$ = stmts_one($x); }
      | consts[l] "," const[x] { $$ = stmts_add($l, $x); }
      ;
const: IDENT[n] unit[u] "=" arith[v] { $$ = stmt_valued(ast, STMT_CONST, @$, $n, $u, $v); };

inputs: input_[x]               { $$ = stmts_one($x); }
      | inputs[l] "," input_[x] { $$ = stmts_add($l, $x); }
      ;
input_: IDENT[n] unit[u] "=" value[v] { $$ = stmt_valued(ast, STMT_INPUT, @$, $n, $u, $v); };

states: state[x]               { $$ = stmts_one($x); }
      | states[l] "," state[x] { $$ = stmts_add($l, $x); }
      ;
state: declaration[x] { $$ = stmt_coord(ast, STMT_STATE, @$, $x, 0); };

lets: let[x]             { $$ = stmts_one($x); }
    | lets[l] "," let[x] { $$ = stmts_add($l, $x); }
    ;
let: IDENT[n] "=" expr[e]                       { $$ = stmt_define(ast, STMT_LET, @$, $n, NONE_LIST, NONE_UNIT, $e); }
   | IDENT[n] "[" places_bound[d] "]" "=" expr[e] { $$ = stmt_define(ast, STMT_LET, @$, $n, $d, NONE_UNIT, $e); }
   ;

observed: observable[x]                   { $$ = stmts_one($x); }
        | observed[l] "," observable[x] { $$ = stmts_add($l, $x); }
        ;
observable: IDENT[n] members[d] unit[u] "=" expr[e] { $$ = stmts_each(ast, $d.first, $d.last, stmts_one(stmt_define(ast, STMT_OBSERVE, @$, $n, $d, $u, $e))).first; };

requires: required[x]                 { $$ = stmts_one($x); }
        | requires[l] "," required[x] { $$ = stmts_add($l, $x); }
        ;
required: IDENT[n] { $$ = stmt_name(ast, STMT_REQUIRES, @$, $n); };

excludes: excluded[x]                 { $$ = stmts_one($x); }
        | excludes[l] "," excluded[x] { $$ = stmts_add($l, $x); }
        ;
excluded: IDENT[n] { $$ = stmt_name(ast, STMT_EXCLUDES, @$, $n); };

/* ---- networks ---- */

weights: %empty           { $$ = (AstText){0}; }
       | "from" STRING[p] { $$ = $p; }
       ;
activation: %empty   { $$ = NONE_IDENT; }
          | IDENT[f] { $$ = $f; }
          ;

/* ---- drawings ---- */

clauses: %empty { $$ = NONE_LIST; }
       | several
       ;
several: clause[x]              { $$ = ast_list($x); }
       | several[l] clause[x]   { $$ = ast_list_add(ast, $l, $x); }
       ;
clause: CLAUSE[w] expr[e] { $$ = ast_option(ast, @$, $w.name, $e); }
      | CLAUSE[w] IDENT[i] "in" arith[lo] ".." arith[hi] { $$ = ast_option(ast, @$, $w.name, ast_bind(ast, @$, $i, $lo, $hi)); }
      ;

/* ---- symmetries: maps after `for ...:` belong to it, up to the next `for` ---- */

maps: map_item[x]             { $$ = stmts_one($x); }
    | maps[l] "," map_item[x] { $$ = maps_add($l, $x); }
    ;
map_item: map[m]  { $$ = $m; }
        | each[m] { $$ = $m; }
        | "for" IDENT[i] "in" arith[lo] ".." arith[hi] ":" each[m] { $$ = stmt_for(ast, @$, $i, $lo, $hi, stmts_one($m)); }
        ;
each: "for" IDENT[i] "in" arith[lo] ".." arith[hi] ":" map[m] { $$ = stmt_for(ast, @$, $i, $lo, $hi, stmts_one($m)); };
map: place[q] "->" expr[e] { $$ = stmts_each(ast, $q, $q, stmts_one(stmt_pair(ast, STMT_MAP, @$, $q, $e))).first; };

/* ---- canonical transformations ---- */

variables: %empty            { $$ = NONE_LIST; }
         | "(" names[l] ")"  { $$ = $l; }
         ;
items: item[x]               { $$ = stmts_one($x); }
     | items[l] "," item[x]  { $$ = stmts_add($l, $x); }
     ;
item: IDENT[n] "=" expr[e]                    { $$ = stmt_define(ast, STMT_SET, @$, $n, NONE_LIST, NONE_UNIT, $e); }
    | IDENT[n] "(" names[a] ")" "=" expr[e]   { $$ = stmt_function(ast, @$, $n, $a, $e); }
    ;

/* ---- scenes ---- */

assigns: assign[x]                { $$ = stmts_one($x); }
       | assigns[l] "," assign[x] { $$ = stmts_add($l, $x); }
       ;
assign: moved[p] "=" expr[e] { $$ = stmt_pair(ast, STMT_SET, @$, $p, $e); };

uses: use[x]             { $$ = stmts_one($x); }
    | uses[l] "," use[x] { $$ = stmts_add($l, $x); }
    ;
use: IDENT[n] options_opt[o] { $$ = stmt_titled(ast, STMT_USE, @$, $n, NONE_TEXT, $o); };

options_opt: %empty             { $$ = NONE_STMTS; }
           | "(" ")"            { $$ = NONE_STMTS; }
           | "(" options[o] ")" { $$ = $o; }
           ;
options: option[x]                { $$ = stmts_one($x); }
       | options[l] "," option[x] { $$ = stmts_add($l, $x); }
       ;
option: place[p] "=" value[v] { $$ = stmt_pair(ast, STMT_SET, @$, $p, $v); };

monitors: monitor[x]                 { $$ = stmts_one($x); }
        | monitors[l] "," monitor[x] { $$ = stmts_add($l, $x); }
        ;
monitor: primary[w] number[e] { $$ = stmt_pair(ast, STMT_MONITOR, @$, $w, $e); }
       | IDENT[n]             { $$ = stmt_name(ast, STMT_MONITOR, @$, $n); }
       ;

number: literal[n]         { $$ = $n; }
      | literal[n] UNIT[u] { $$ = ast_unit(ast, @$, $n, $u); }
      ;
literal: NUMBER[n] { $$ = ast_number(ast, @$, $n); };

method_name: IDENT[n]                     { $$ = $n; }
           | method_name[a] "-" IDENT[b]  { $$ = ident_dashed(ast, @$, $a, $b); }
           ;

/* ---- parts of statements ---- */

doc: %empty    { $$ = NONE_TEXT; }
   | STRING[s] { $$ = $s; }
   ;
dims: %empty               { $$ = NONE_LIST; }
    | "[" indices[l] "]"   { $$ = $l; }
    ;
members: %empty                  { $$ = NONE_LIST; }
       | "[" places_bound[l] "]" { $$ = $l; }
       ;
limit: %empty                      { $$ = 0; }
     | "," "static" "=" arith[s] { $$ = $s; }
     ;
type: %empty       { $$ = NONE_IDENT; }
    | ":" IDENT[n] { $$ = $n; }
    ;
unit: %empty  { $$ = NONE_UNIT; }
    | UNIT[u] { $$ = $u; }
    ;
periodic: %empty     { $$ = 0; }
        | "periodic" { $$ = 1; }
        ;
exactly: %empty    { $$ = 0; }
       | "exactly" { $$ = START_EXACTLY; }
       | "guess"   { $$ = START_GUESS; }
       ;
sign: %empty          { $$ = SIGN_ANY; }
    | ">" NUMBER[n]   { $$ = sign_of(ast, @n, SIGN_GT, $n); }
    | ">=" NUMBER[n]  { $$ = sign_of(ast, @n, SIGN_GE, $n); }
    | "<" NUMBER[n]   { $$ = sign_of(ast, @n, SIGN_LT, $n); }
    | "<=" NUMBER[n]  { $$ = sign_of(ast, @n, SIGN_LE, $n); }
    ;
direction: %empty     { $$ = CROSS_BOTH; }
         | "crossing" { $$ = CROSS_BOTH; }
         | "rising"   { $$ = CROSS_RISING; }
         | "falling"  { $$ = CROSS_FALLING; }
         ;
rubbing: %empty { $$ = NONE_LIST; }
       | laws
       ;
laws: "," law[x]          { $$ = ast_list($x); }
    | laws[r] "," law[x]  { $$ = ast_list_add(ast, $r, $x); }
    ;
law: "friction" "=" expr[e]   { $$ = ast_option(ast, @$, "friction", $e); }
   | "static" "=" expr[e]     { $$ = ast_option(ast, @$, "static", $e); }
   | "slip" "=" expr[e]       { $$ = ast_option(ast, @$, "slip", $e); }
   | "tangential" "=" expr[e] { $$ = ast_option(ast, @$, "tangential", $e); }
   | "law" "=" IDENT[n]       { $$ = ast_option(ast, @$, "law", ast_name(ast, $n)); }
   ;
sides: arith[a] "=" expr[b] { $$ = ast_sides(ast, @$, @b, $a, $b); };
gap: arith[a] ">="[op] arith[b] { $$ = ast_contact_gap(ast, @$, @op, $a, $b); }
   | arith[a] "<="[op] arith[b] { $$ = ast_contact_gap(ast, @$, @op, $b, $a); };
condition: %empty       { $$ = 0; }
         | "while" expr[e] { $$ = $e; }
         ;
every: %empty          { $$ = 0; }
     | "every" arith[e] { $$ = $e; }
     ;

/* The left side of a setting: a name, a member of a family or all of them, a component, a derivative. */
place: IDENT[n]                          { $$ = ast_name(ast, $n); }
     | place[a] "[" places_bound[l] "]"  { $$ = ast_index(ast, @$, $a, $l); }
     | place[a] "." IDENT[m]             { $$ = ast_member(ast, @$, $a, $m); }
     | place[a] "'"[op]                  { $$ = ast_prime(ast, @$, @op, $a); }
     ;
/* A place, or the angular velocity of a rotation: omega(R). */
moved: place[p]                       { $$ = $p; }
     | IDENT[n] "(" place[p] ")"       { $$ = ast_call(ast, @$, $n, ast_list($p)); }
     ;
places_bound: bound[x]                   { $$ = ast_list($x); }
            | places_bound[l] "," bound[x] { $$ = ast_list_add(ast, $l, $x); }
            ;
bound: arith[a]                                   { $$ = $a; }
     | IDENT[i] "in" arith[lo] ".." arith[hi]     { $$ = ast_bind(ast, @$, $i, $lo, $hi); }
     ;
/* Members of a family of contacts. */
ranges: range[x]                { $$ = ast_list($x); }
      | ranges[l] "," range[x]  { $$ = ast_list_add(ast, $l, $x); }
      ;
range: IDENT[i] "in" arith[lo] ".." arith[hi] { $$ = ast_bind(ast, @$, $i, $lo, $hi); }
     | IDENT[j] "in" arith[near]              { $$ = ast_near_bind(ast, @$, $j, $near); }
     ;

names: declared[n]              { $$ = ast_list($n); }
     | names[l] "," declared[n] { $$ = ast_list_add(ast, $l, $n); }
     ;
declared: IDENT[n] { $$ = ast_declared(ast, $n); };

/* ---- expressions ---- */

value: expr[e]   { $$ = $e; }
     | STRING[s] { $$ = ast_string(ast, $s); }
     | IDENT[n] "(" STRING[s] ")" { $$ = ast_call(ast, @$, $n, ast_list(ast_string(ast, $s))); }
     ;

expr: comparison[e]                 { $$ = $e; }
    | "not"[op] expr[a]             { $$ = ast_unary(ast, AST_NOT, @$, @op, $a); }
    | expr[a] "and"[op] expr[b]     { $$ = ast_binary(ast, AST_AND, @$, @op, $a, $b); }
    | expr[a] "or"[op] expr[b]      { $$ = ast_binary(ast, AST_OR, @$, @op, $a, $b); }
    ;

comparison: arith[a]                     { $$ = $a; }
          | arith[a] "<"[op] arith[b]    { $$ = ast_binary(ast, AST_LT, @$, @op, $a, $b); }
          | arith[a] "<="[op] arith[b]   { $$ = ast_binary(ast, AST_LE, @$, @op, $a, $b); }
          | arith[a] ">"[op] arith[b]    { $$ = ast_binary(ast, AST_GT, @$, @op, $a, $b); }
          | arith[a] ">="[op] arith[b]   { $$ = ast_binary(ast, AST_GE, @$, @op, $a, $b); }
          | arith[a] "=="[op] arith[b]   { $$ = ast_binary(ast, AST_EQ, @$, @op, $a, $b); }
          | arith[a] "!="[op] arith[b]   { $$ = ast_binary(ast, AST_NE, @$, @op, $a, $b); }
          ;

arith: primary[e]                    { $$ = $e; }
     | arith[a] "+"[op] arith[b]     { $$ = ast_binary(ast, AST_ADD, @$, @op, $a, $b); }
     | arith[a] "-"[op] arith[b]     { $$ = ast_binary(ast, AST_SUB, @$, @op, $a, $b); }
     | arith[a] "*"[op] arith[b]     { $$ = ast_binary(ast, AST_MUL, @$, @op, $a, $b); }
     | arith[a] "/"[op] arith[b]     { $$ = ast_binary(ast, AST_DIV, @$, @op, $a, $b); }
     | arith[a] "^"[op] arith[b]     { $$ = ast_binary(ast, AST_POW, @$, @op, $a, $b); }
     | "-"[op] arith[a] %prec NEGATION { $$ = ast_unary(ast, AST_NEG, @$, @op, $a); }
     | "+" arith[a] %prec NEGATION   { $$ = $a; }
     ;

primary: NUMBER[n]                          { $$ = ast_number(ast, @n, $n); }
       | IDENT[n]                           { $$ = ast_name(ast, $n); }
       | IDENT[f] "(" args[l] ")"           { $$ = ast_call(ast, @$, $f, $l); }
       | "sum"[op] "(" IDENT[i] "in" arith[lo] ".." arith[hi] "," expr[e] ")"     { $$ = ast_reduce(ast, AST_SUM, @$, @op, (AstTurns){$i, $lo, $hi}, $e); }
       | "sum"[op] "(" IDENT[i] "in" arith[lo] ".." arith[hi] "," expr[e] "," IDENT[by] IDENT[way] "(" expr[theta] ")" ")"
           { $$ = ast_far(ast, @$, @op, (AstTurns){$i, $lo, $hi}, $e, (FarWay){$by, $way, $theta}); }
       | "sum"[op] "(" IDENT[j] "in" arith[near] "," expr[e] ")"                  { $$ = ast_near(ast, @$, $j, $near, $e, @op); }
       | "product"[op] "(" IDENT[i] "in" arith[lo] ".." arith[hi] "," expr[e] ")" { $$ = ast_reduce(ast, AST_PRODUCT, @$, @op, (AstTurns){$i, $lo, $hi}, $e); }
       | "(" expr[e] ")"                    { $$ = $e; }
       | tuple[e]                           { $$ = $e; }
       | "{" exprs[l] "}"                   { $$ = ast_collect(ast, AST_LIST, @$, $l); }
       | reach[e]                           { $$ = $e; }
       | reach[a] "(" expr[b] ")"           { $$ = ast_at(ast, @$, $a, $b); }
       | primary[a] UNIT[u]                 { $$ = ast_unit(ast, @$, $a, $u); }
       ;
/* Operands that may be taken at a time, th'(0); a name at a time, x(0), parses as a call. */
reach: primary[a] "[" indices[l] "]"        { $$ = ast_index(ast, @$, $a, $l); }
     | primary[a] "." IDENT[m]              { $$ = ast_member(ast, @$, $a, $m); }
     | primary[a] "'"[op]                   { $$ = ast_prime(ast, @$, @op, $a); }
     ;

tuple: "(" expr[e] "," exprs[l] ")" { $$ = ast_tuple(ast, @$, $e, $l); };
args: %empty   { $$ = NONE_LIST; }
    | exprs[l] { $$ = $l; }
    | exprs[l] "," window[w]     { $$ = ast_list_add(ast, $l, $w); }
    | happening[e]               { $$ = ast_list($e); }
    | happening[e] "," exprs[l]  { $$ = ast_list_before(ast, $e, $l); }
    ;
window: arith[lo] ".." arith[hi] { $$ = ast_window(ast, @$, $lo, $hi); }
      | arith[lo] ".."            { $$ = ast_window(ast, @$, $lo, 0); }
      | ".." arith[hi]            { $$ = ast_window(ast, @$, 0, $hi); }
      ;
/* The part of a contact that an event is of, in hit(floor sticks). */
happening: IDENT[n] IDENT[does] { $$ = ast_happening(ast, @$, $n, $does); }
         | reach[a] IDENT[does] { (void)$a; $$ = ast_happening(ast, @$, $does, $does); }
         ;
exprs: expr[e]              { $$ = ast_list($e); }
     | exprs[l] "," expr[e] { $$ = ast_list_add(ast, $l, $e); }
     ;
indices: arith[e]                { $$ = ast_list($e); }
       | indices[l] "," arith[e] { $$ = ast_list_add(ast, $l, $e); }
       ;

%%

/* Bison's numbers for the token kinds, in the order of token.h. */
#define YYSYMBOL_FINISH YYSYMBOL_YYEOF
#define TOKEN_(name, word, flags) [TOK_##name] = LAG_##name,
#define KIND_(name, word, flags) case YYSYMBOL_##name: return TOK_##name;

static const short bison_token[TOK_COUNT] = {TOKENS(TOKEN_)};

static TokKind kind_of(yysymbol_kind_t symbol) {
  switch (symbol) {
    TOKENS(KIND_)
    default: return TOK_COUNT;
  }
}

/* On an unexpected token: passes the set of expected ones to errors.c. */
static int yyreport_syntax_error(const yypcontext_t *yyctx, Parse *cx, Ast *ast) {
  yysymbol_kind_t symbols[YYNTOKENS];
  TokKind kinds[YYNTOKENS];
  (void)ast;
  int n = yypcontext_expected_tokens(yyctx, symbols, YYNTOKENS);
  if (n < 0) return n;
  for (int i = 0; i < n; i++) kinds[i] = kind_of(symbols[i]);
  parse_report(cx, kinds, n);
  return 0;
}

/* Called only when the stack cannot grow: at its limit, or out of memory. */
static void lag_error(const Span *span, Parse *cx, Ast *ast, const char *message) {
  (void)message;
  if (cx->stack->yystacksize < YYMAXDEPTH) arena_fail(ast->arena);
  parse_too_deep(cx, *span);
}

void parse_open(Parse *cx) {
  cx->stack = lag_pstate_new();
  if (!cx->stack) arena_fail(cx->ast->arena);
}

int parse_push(Parse *cx, const Token *t) {
  LAG_STYPE value = {0};
  Span span = t->span;
  switch (t->kind) {
    case TOK_NUMBER: value.number = t->number; break;
    case TOK_STRING: value.text = (AstText){t->text, span}; break;
    case TOK_UNIT: value.unit = t->unit; break;
    default: value.ident = (Ident){t->name, span}; break;
  }
  return lag_push_parse(cx->stack, bison_token[t->kind], &value, &span, cx, cx->ast) == YYPUSH_MORE;
}

void parse_close(Parse *cx) {
  lag_pstate_delete(cx->stack);
  cx->stack = NULL;
}
