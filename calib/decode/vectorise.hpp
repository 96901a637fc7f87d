// Lets the compiler make a second copy of a loop for processors with AVX2; which one runs is chosen at load time.
//
// No -march flags: one binary runs on every x86-64 and, with the plain copy, on AArch64. Sanitizers and function
// multiversioning do not go together (the choice is made before they are up).
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RAYSTEER_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define RAYSTEER_CLONES
#endif

/// Defined where code for AVX2 may be written out, to be chosen with __builtin_cpu_supports.
#if defined(__x86_64__) && defined(__GNUC__)
#define RAYSTEER_AVX2
#endif

/// Before a loop: its rows do not overlap, and none of its turns reads what another wrote.
#if defined(__clang__)
#define RAYSTEER_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define RAYSTEER_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace raysteer::calib::decode {

/// Not std::min and std::max: references keep GCC 12 from vectorising.
template <class T>
[[gnu::always_inline]] inline T lesser(T a, T b) {
  return a < b ? a : b;
}
template <class T>
[[gnu::always_inline]] inline T greater(T a, T b) {
  return a < b ? b : a;
}

}  // namespace raysteer::calib::decode
