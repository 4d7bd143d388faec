/* The three answers about an expression that may vanish: a proof that it does, a proof that it does not, neither. */
#pragma once

typedef enum { NOT_DECIDED, PROVED_ZERO, PROVED_NONZERO } Verdict;
