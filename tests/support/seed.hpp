// The seed of a random test: one fixed number in the checks, so that they do not pass by luck, and any other on
// request.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

namespace raysteer::support {

/// 20261122, or what RAYSTEER_SEED says: a number, or "random". Nobody tunes on the fixed one; campaigns draw theirs.
inline std::uint64_t seed() {
  const char* asked = std::getenv("RAYSTEER_SEED");
  const std::uint64_t seed = asked == nullptr                 ? 20261122
                             : std::string(asked) == "random" ? std::random_device{}()
                                                              : std::strtoull(asked, nullptr, 10);
  std::printf("seed %llu (RAYSTEER_SEED=number|random)\n", static_cast<unsigned long long>(seed));
  return seed;
}

}  // namespace raysteer::support
