// The text of a function's name that a macro stands for.
#pragma once

#define GRADUS_TEXT_OF(name) #name
#define SYMBOL_NAME(macro) GRADUS_TEXT_OF(macro)
