// Before anything else where clang compiles ITK's headers: Debian's know the compiler that they
// were built with, GCC, and refuse every other, although clang compiles them as they are.
#pragma once

#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
