#define table_name float_functions
#include "tests/kernels/function_table.inc"
