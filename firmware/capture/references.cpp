#include "firmware/capture/references.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>

namespace raysteer::firmware::capture {
namespace {

constexpr float kLit = 0.03F;             ///< of full scale, between white and black
constexpr double kLeastLitShare = 0.005;  ///< of the view: less is a reflection somewhere
constexpr double kBrightShare = 0.995;    ///< at most 0.5 % of the lit places may saturate
constexpr double kTarget = 0.85;          ///< where those 0.5 % should begin
constexpr double kDim = 0.35;             ///< below, a longer exposure is worth its time
constexpr double kMostSaturated = 0.05;   ///< of the lit places, when no shorter exposure is possible
constexpr double kLeastContrast = 0.05;   ///< of full scale: 12 levels of 255
constexpr double kMostChanged = 0.03;     ///< of the lit places
constexpr float kChange = 0.08F;          ///< of a place's white

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

EyeReference make_eye(Samples white, Samples black) {
  EyeReference eye{.white = std::move(white), .black = std::move(black), .lit = {}};
  std::vector<float> whites;
  std::vector<float> ranges;
  std::vector<float> blacks;
  for (std::size_t i = 0; i < eye.white.size(); ++i) {
    if (eye.white[i] - eye.black[i] > kLit) {
      eye.lit.push_back(static_cast<std::uint32_t>(i));
      whites.push_back(eye.white[i]);
      ranges.push_back(eye.white[i] - eye.black[i]);
      blacks.push_back(eye.black[i]);
    }
  }
  if (eye.lit.empty()) {
    return eye;
  }
  const auto number = static_cast<double>(whites.size());
  eye.lit_share = number / static_cast<double>(eye.white.size());
  eye.saturated_share =
      static_cast<double>(std::ranges::count_if(whites, [](float level) { return level >= kSaturated; })) / number;
  eye.bright = quantile(std::move(whites), kBrightShare);
  eye.contrast = quantile(std::move(ranges), 0.5);
  eye.ambient = quantile(std::move(blacks), 0.5);
  return eye;
}

double brightest(const References& references) {
  return std::max(references.eyes[0].bright, references.eyes[1].bright);
}

double most_saturated(const References& references) {
  return std::max(references.eyes[0].saturated_share, references.eyes[1].saturated_share);
}

std::string eye_name(std::size_t eye) { return eye == 0 ? "left" : "right"; }

}  // namespace

References make_references(EyeSamples white, EyeSamples black) {
  return {{make_eye(std::move(white[0]), std::move(black[0])), make_eye(std::move(white[1]), std::move(black[1]))}};
}

ExposureVerdict judge_exposure(const References& references) {
  if (most_saturated(references) > 1 - kBrightShare) {
    return ExposureVerdict::kTooLong;
  }
  return brightest(references) < kDim ? ExposureVerdict::kTooShort : ExposureVerdict::kGood;
}

double exposure_factor(const References& references) {
  const double saturated = most_saturated(references);
  if (saturated > 0.5) {
    return 0.25;
  }
  if (saturated > 1 - kBrightShare) {
    return 0.6;  // how far beyond full scale is not known
  }
  const double bright = brightest(references);
  return bright > 0.02 ? std::min(kTarget / bright, 4.0) : 4.0;
}

Status judge_light(const References& references) {
  for (const std::size_t e : {0U, 1U}) {
    const EyeReference& eye = references.eyes[e];
    if (eye.lit_share < kLeastLitShare) {
      const double darkest = quantile(eye.black, 0.5);
      if (darkest >= kSaturated) {
        return fail(RCode::kTooBright, "the " + eye_name(e) + " eye is saturated even under black light");
      }
      return fail(RCode::kNothingLit, "the " + eye_name(e) + " eye sees white and black alike but for " +
                                          percent(eye.lit_share) + " of its view, expected at least " +
                                          percent(kLeastLitShare));
    }
    if (eye.saturated_share > kMostSaturated) {
      return fail(RCode::kTooBright, percent(eye.saturated_share) + " of what the " + eye_name(e) +
                                         " eye sees lit is saturated, at most " + percent(kMostSaturated) +
                                         " are allowed");
    }
    if (eye.contrast < kLeastContrast) {
      return fail(RCode::kTooDark, "white is only " + percent(eye.contrast) +
                                       " of full scale brighter than black in the " + eye_name(e) +
                                       " eye, expected at least " + percent(kLeastContrast));
    }
  }
  return ok();
}

double uniform_level(const References& references, const EyeSamples& seen) {
  double light = 0;
  double whole = 0;
  for (const std::size_t e : {0U, 1U}) {
    const EyeReference& eye = references.eyes[e];
    for (const std::uint32_t i : eye.lit) {
      if (eye.white[i] < kSaturated) {
        light += seen[e][i] - eye.black[i];
        whole += eye.white[i] - eye.black[i];
      }
    }
  }
  return whole > 0 ? light / whole : 0;
}

Status judge_stillness(const References& references, const EyeSamples& white) {
  for (const std::size_t e : {0U, 1U}) {
    const EyeReference& eye = references.eyes[e];
    std::vector<float> ratios;
    for (const std::uint32_t i : eye.lit) {
      ratios.push_back(white[e][i] / std::max(eye.white[i], 1e-3F));
    }
    if (ratios.empty()) {
      continue;
    }
    const float lamp = quantile(ratios, 0.5);
    // Noise decides what a change is where pixels are noisy.
    std::vector<float> departures(ratios.size());
    std::ranges::transform(ratios, departures.begin(), [&](float ratio) { return std::abs(ratio - lamp); });
    const float change = std::max(kChange, 6 * quantile(departures, 0.5));
    const auto changed = std::ranges::count_if(departures, [&](float departure) { return departure > change; });
    const double share = static_cast<double>(changed) / static_cast<double>(ratios.size());
    if (share > kMostChanged) {
      return fail(RCode::kSceneMoved, "white at the end differs from white at the beginning in " + percent(share) +
                                          " of what the " + eye_name(e) + " eye sees lit, at most " +
                                          percent(kMostChanged) + " are allowed");
    }
  }
  return ok();
}

}  // namespace raysteer::firmware::capture
