#define GRADUS_DOUBLE
#define table_name shifts_in_double
#include "tests/kernels/shift_functions.inc"
