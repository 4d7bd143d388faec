#!/bin/sh
# Energy over 10^6 steps of every symplectic method in its implicit form: tests/unit/test_rt_energy.c.
. tests/exec/lib_long.sh
long rt_energy
