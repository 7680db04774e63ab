/// Included first by what programs begin with: what else an older language makes of these headers
/// is pages long.
#pragma once

#if __cplusplus < 202002L
#error "tmcl needs C++20: give the compiler -std=c++20"
#endif
