#define GRADUS_DOUBLE
#define table_name double_functions
#include "tests/kernels/function_table.inc"
