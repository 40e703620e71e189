#define table_name shifts_in_float
#include "tests/kernels/shift_functions.inc"
