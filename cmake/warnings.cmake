# The warnings every target of the project is compiled with; they never reach those who use the library.
function(tmcl_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
    -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
    # g++ 12 takes the two halves of a coroutine frame's allocation for strangers when it inlines one.
    $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond -Wlogical-op -Wno-mismatched-new-delete>
    # g++'s library uses what it calls deprecated itself, and clang tells of that.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations>
    $<$<BOOL:${TMCL_WERROR}>:-Werror>)
endfunction()
