/* setjmp where there is none: lagc jumps only where memory ran out, which ends the module's work (playground.js makes
 * a new instance for each answer). Copied by make to where it hides <setjmp.h>. */
#pragma once

typedef int jmp_buf[1];
#define setjmp(here) ((void)(here), 0)
_Noreturn void longjmp(jmp_buf here, int value);
