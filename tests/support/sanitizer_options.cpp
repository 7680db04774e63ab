// gtest keeps no frame pointers. Beyond it, a stack that a sanitizer keeps with an allocation has
// other words each time, and a process would keep millions of such stacks: a third of its time, and
// gigabytes.

/// Called by the address sanitizer before anything else; ASAN_OPTIONS still win.
extern "C" const char* __asan_default_options();  // NOLINT: its name is given
extern "C" const char* __asan_default_options() { return "malloc_context_size=8"; }
