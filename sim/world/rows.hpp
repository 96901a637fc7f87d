// pure: rows shared out to threads. Rows do not depend on each other, so the number of threads changes no bit.
#pragma once

#include <algorithm>
#include <thread>
#include <vector>

namespace raysteer::sim::world {

/// Calls work(first, end) on pieces of [0, rows). Pieces of 16 rows go round the threads, so that an expensive part of
/// a picture is shared.
template <class Work>
void for_rows(int rows, int threads, const Work& work) {
  constexpr int kPiece = 16;
  const auto share = [&](int thread) {
    for (int first = thread * kPiece; first < rows; first += threads * kPiece) {
      work(first, std::min(first + kPiece, rows));
    }
  };
  threads = std::clamp(threads, 1, (rows + kPiece - 1) / kPiece + (rows == 0 ? 1 : 0));
  std::vector<std::jthread> others;
  for (int thread = 1; thread < threads; ++thread) {
    others.emplace_back(share, thread);
  }
  share(0);
}

}  // namespace raysteer::sim::world
