// The first straight rectangle, many times: pretend rigs with a galvo pair and with a mirror head, corners against the
// truth.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "calib/solve/quiet.hpp"
#include "host/tour/tour.hpp"

namespace {

using namespace raysteer;
namespace fs = std::filesystem;

struct Totals {
  int tours = 0;
  int failed = 0;
  double mean_sum = 0;  ///< of corner means
  double worst = 0;
  double predicted_sum = 0;
  double before_sum = 0;
  double chi_square = 0;
  double slowest_s = 0;
};

void run(const std::string& board, int seed, const fs::path& scratch, Totals& totals) {
  const fs::path folder = scratch / (board + "-" + std::to_string(seed));
  fs::create_directories(folder);
  const auto begin = std::chrono::steady_clock::now();
  const auto result =
      host::tour::tour({.pretend = {.board = board, .scene = "floor", .seed = seed, .faults = {}, .threads = 0},
                        .mirror_rad = {0.040, -0.030},
                        .plan = "cameras",
                        .folder = folder},
                       {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  fs::remove_all(folder);
  if (!result) {
    ++totals.failed;
    std::printf("| %s | %d | %s | | | | | |\n", board.c_str(), seed, result.error().message().c_str());
    return;
  }
  ++totals.tours;
  totals.mean_sum += result->corner_mean_mm;
  totals.worst = std::max(totals.worst, result->corner_max_mm);
  totals.predicted_sum += result->predicted_mean_mm;
  totals.before_sum += result->before_mean_mm;
  totals.chi_square += result->chi_square;
  totals.slowest_s = std::max(totals.slowest_s, seconds);
  std::printf("| %s | %d | %.2f | %.2f | %.2f | %.1f | %.1f | %.0f |\n", board.c_str(), seed, result->corner_mean_mm,
              result->corner_max_mm, result->predicted_mean_mm, result->chi_square, result->before_mean_mm, seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  calib::solve::quiet_solver();
  std::uint64_t seed = 1;
  bool brief = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--short") == 0) {
      brief = true;
    }
  }
  std::printf(
      "`raysteer sim --tour` on the floor, look (40, -30) mrad; trial i has seed + i; ten poses of a waved board for "
      "the cameras. Asked: corners 1.5 mm in the "
      "mean, 4 mm at most, 40 s from 0 to the picture.\n\n");
  std::printf(
      "| board | seed | corners, mean mm | max mm | predicted mean mm | chi-square (8) | before, mean mm | s |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  const fs::path scratch = fs::temp_directory_path() / ("raysteer-campaign-tour-" + std::to_string(::getpid()));
  Totals totals;
  const std::array boards = brief ? std::array<std::string, 2>{"mock-small", "mock-small-head"}
                                  : std::array<std::string, 2>{"mock-galvo", "mock-head"};
  const int trials = brief ? 1 : 20;
  for (int i = 0; i < trials; ++i) {
    for (const std::string& board : boards) {
      run(board, static_cast<int>((seed + static_cast<std::uint64_t>(i)) % 1000000000U), scratch, totals);
    }
  }
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  const double n = std::max(1, totals.tours);
  std::printf(
      "\nTours: %d, failed %d. Corners %.2f mm in the mean, %.2f mm at most (predicted mean %.2f mm, chi-square %.1f "
      "of 8 "
      "a tour); before %.1f mm. Slowest %.0f s.\n",
      totals.tours, totals.failed, totals.mean_sum / n, totals.worst, totals.predicted_sum / n, totals.chi_square / n,
      totals.before_sum / n, totals.slowest_s);
  // Small boards have pixels four times as wide.
  const double scale = brief ? 4 : 1;
  return totals.failed == 0 && totals.mean_sum / n <= scale * 1.5 && totals.worst <= scale * 4.0 ? 0 : 1;
}
