/* Widest vectors of doubles that the processor computes with. */
#pragma once

/* 8: AVX-512; 4: AVX2, or a processor whose vectors of two need no question; 1: none. */
int lag_processor_lanes(void);
