// pure: a loop whose turns do not touch each other, on several threads. What it leaves does not depend on how many.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace raysteer::calib::bake {

/// body(i) for each i from 0 to count - 1, in any order. `body` throws nothing.
template <class Body>
void in_parallel(int count, int threads, const Body& body) {
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      body(i);
    }
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < std::min(threads, count); ++i) {
    others.emplace_back(work);
  }
  work();
}

}  // namespace raysteer::calib::bake
