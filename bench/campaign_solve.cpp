// Are the solvers' covariances honest? Normalised error squared of every parameter over many known rigs.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "calib/solve/solve.hpp"
#include "tests/support/solver_case.hpp"

namespace {

using namespace raysteer;

struct Row {
  support::Devices devices;
  const char* name;
};
constexpr std::array kRows{Row{support::Devices::kMono, "one camera"}, Row{support::Devices::kStereo, "two cameras"},
                           Row{support::Devices::kProjector, "camera and projector"}};

bool run(const Row& row, std::uint64_t seed, int trials) {
  calib::solve::SolveOptions options;
  options.lens = calib::model::LensModel::kBc4;
  double sum = 0;
  double freedom = 0;
  double whitened = 0;
  int failed = 0;
  for (int i = 0; i < trials; ++i) {
    const auto known = support::solver_case(row.devices, seed + static_cast<std::uint64_t>(i), 10);
    const auto solution = calib::solve::solve(known.observations, options);
    if (!solution) {
      ++failed;
      continue;
    }
    sum += support::normalised_error_squared(*solution, known.truth);
    freedom += static_cast<double>(solution->rig.covariance.rows());
    whitened += solution->whitened_rms / trials;
  }
  const double low = support::chi_square_quantile(freedom, -support::kSigma9999);
  const double high = support::chi_square_quantile(freedom, support::kSigma9999);
  const bool good = failed == 0 && sum > low && sum < high;
  std::printf("| %s | %d | %d | %.0f | %.4f | %.4f to %.4f | %.3f | %s |\n", row.name, trials, failed, freedom,
              sum / freedom, low / freedom, high / freedom, whitened, good ? "yes" : "NO");
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t seed = 1;
  int trials = 200;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--short") == 0) {
      trials = 8;
    }
  }
  std::printf(
      "Known rigs, 10 poses of a 9x6 chessboard, corners with 0.1 px of noise per coordinate; trial i has seed + i. "
      "Normalised error squared per degree of freedom must lie within the two-sided 99.99 %% bounds of "
      "chi-square.\n\n");
  std::printf("| solver | trials | failed | degrees of freedom | error squared | bounds | whitened RMS | within |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  bool good = true;
  for (const Row& row : kRows) {
    good = run(row, seed * 100000, trials) && good;
  }
  return good ? 0 : 1;
}
