// campaign_decode [--seed N] [--short]: sub-pixel error of each decoder on rendered views, as algorithms 2.3 tabulates
// it.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "calib/synth/decode_trial.hpp"

namespace {

using namespace raysteer;
using namespace raysteer::calib;

struct Code {
  std::string name;
  PatternSequence sequence;
};

struct Condition {
  std::string name;
  synth::SeparableView view;
};

synth::SeparableView view(int rows, double electrons, double blur_px, double interreflection) {
  synth::SeparableView view;
  view.width = 2000;
  view.height = rows;
  view.bend = 0;
  view.blur_px = blur_px;
  view.white_electrons = electrons;
  view.interreflection = interreflection;
  return view;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t seed = 1;
  int rows = 16;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--short") == 0) {
      rows = 4;
    }
  }
  bool decoded = true;
  constexpr int kPanel = 1920;
  const std::vector<Code> codes{
      {"Gray 11 bit + complement", synth::gray_sequence(kPanel, true)},
      {"Gray 11 bit, thresholded by white and black", synth::gray_sequence(kPanel, false)},
      {"Gray of half periods + complement + 4 steps T16", synth::gray_phase_sequence(kPanel, true, 4, 16)},
      {"same + 8 steps T16 (default)", synth::gray_phase_sequence(kPanel, true, 8, 16)},
      {"same + 8 steps T32", synth::gray_phase_sequence(kPanel, true, 8, 32)},
      {"Gray of half periods, no complement, + 4 steps T16 (fast)", synth::gray_phase_sequence(kPanel, false, 4, 16)},
      {"heterodyne 40 and 41 periods, 8 steps", synth::heterodyne_sequence(kPanel, 8, kPanel / 40.0, kPanel / 41.0)},
  };
  const std::vector<Condition> conditions{
      {"7000 e", view(rows, 7000, 1.2, 0)},         {"1500 e", view(rows, 1500, 1.2, 0)},
      {"300 e", view(rows, 300, 1.2, 0)},           {"blur 4 px", view(rows, 7000, 4, 0)},
      {"bounced 40 %", view(rows, 7000, 1.2, 0.4)},
  };
  std::printf(
      "RMS px of pixels less than 1.5 px off / predicted; gross %%; valid %%. Seed %llu, %d rows of 2000 px.\n\n",
      static_cast<unsigned long long>(seed), rows);
  std::printf("| code | images |");
  for (const Condition& condition : conditions) {
    std::printf(" %s |", condition.name.c_str());
  }
  std::printf("\n| --- | --- |");
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    std::printf(" --- |");
  }
  std::printf("\n");
  for (std::size_t i = 0; i < codes.size(); ++i) {
    std::printf("| %s | %d |", codes[i].name.c_str(), codes[i].sequence.frames() - 2);
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      const Result<synth::DecodeTrial> trial =
          synth::decode_trial(codes[i].sequence, conditions[k].view, {}, seed + 1000 * i + 100 * k);
      if (trial) {
        std::printf(" %.3f / %.3f; %.2f; %.1f |", trial->rms_px, trial->predicted_px, 100 * trial->gross,
                    100 * trial->valid);
      } else {
        decoded = false;
        std::printf(" %s |", trial.error().message().c_str());
      }
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return decoded ? 0 : 1;
}
