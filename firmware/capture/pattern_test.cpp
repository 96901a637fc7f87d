#include "firmware/capture/pattern_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace raysteer::firmware::capture {
namespace {

using Frames = std::vector<std::optional<EyeSamples>>;

constexpr float kContradiction = 0.08F;      ///< of a place's range
constexpr double kMostContradicting = 0.03;  ///< of the places
constexpr double kNoiseShare = 0.75;         ///< noise is what this share of the places stays below; the median is 0 of
                                             ///< a dim picture, whose noise is less than a level
constexpr float kNoise = 4.1F;               ///< contradictions begin at so many of it: five standard deviations
constexpr float kMostNoise = 0.25F;          ///< ... but not beyond this: half of a picture may be wrong
constexpr double kJudgedStripe_px = 8;       ///< finer ones a camera may rightly not resolve

/// The places of one eye that can be judged, and what frames say there: 0 as black, 1 as white.
class Normalised {
 public:
  Normalised(const EyeReference& reference, std::size_t eye) : reference_(reference), eye_(eye) {
    const auto least = static_cast<float>(0.3 * reference.contrast);
    for (const std::uint32_t i : reference.lit) {
      if (reference.white[i] < kSaturated && reference.white[i] - reference.black[i] >= least) {
        places_.push_back(i);
      }
    }
  }
  std::size_t size() const { return places_.size(); }
  std::vector<float> of(const EyeSamples& frame) const {
    std::vector<float> values(places_.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
      const std::uint32_t i = places_[n];
      values[n] = (frame[eye_][i] - reference_.black[i]) / (reference_.white[i] - reference_.black[i]);
    }
    return values;
  }

 private:
  const EyeReference& reference_;
  std::size_t eye_;
  std::vector<std::uint32_t> places_;
};

double share_beyond(const std::vector<float>& departures, float limit) {
  const auto beyond = std::ranges::count_if(departures, [&](float value) { return value > limit; });
  return departures.empty() ? 0 : static_cast<double>(beyond) / static_cast<double>(departures.size());
}

float limit_for(float noise) { return std::clamp(kNoise * noise, kContradiction, kMostNoise); }

void report(std::vector<WrongFrame>& wrong, WrongFrame found) {
  const auto same = std::ranges::find(wrong, found.index, &WrongFrame::index);
  if (same == wrong.end()) {
    wrong.push_back(std::move(found));
  } else if (found.share > same->share) {
    *same = std::move(found);
  }
}

struct Pair {
  int pattern = 0;
  int complement = 0;
  std::vector<float> departures;  ///< of their sum from 1
};

Pair compare(const Normalised& places, const Frames& frames, int a, int b) {
  const std::vector<float> first = places.of(*frames[static_cast<std::size_t>(a)]);
  const std::vector<float> second = places.of(*frames[static_cast<std::size_t>(b)]);
  Pair pair{a, b, std::vector<float>(first.size())};
  for (std::size_t n = 0; n < first.size(); ++n) {
    pair.departures[n] = std::abs(first[n] + second[n] - 1);
  }
  return pair;
}

void judge_complements(const std::vector<Pair>& pairs, std::vector<WrongFrame>& wrong) {
  std::vector<float> noises;
  for (const Pair& pair : pairs) {
    noises.push_back(quantile(pair.departures, kNoiseShare));
  }
  const float limit = limit_for(quantile(noises, 0.25));  // noise is what the quieter pairs have
  for (const Pair& pair : pairs) {
    const double share = share_beyond(pair.departures, limit);
    if (share > kMostContradicting) {
      report(wrong, {pair.pattern, share, "its complement, frame " + std::to_string(pair.complement)});
      report(wrong, {pair.complement, share, "its complement, frame " + std::to_string(pair.pattern)});
    }
  }
}

using Matrix = std::vector<std::vector<double>>;

/// The fit of 1, cos and sin to the steps: `fit` gives its three numbers, `deleted` what each step departs by from what
/// the other steps predict: rows of (I - H) over (1 - h_kk), H the hat matrix.
struct SinusoidFit {
  Matrix fit;      // 3 x steps
  Matrix deleted;  // steps x steps
};

SinusoidFit make_fit(const std::vector<double>& turns) {
  const std::size_t count = turns.size();
  std::array<std::array<double, 6>, 3> normal{};  // [X'X | I], made [I | inverse]
  const auto base = [&](std::size_t k) { return std::array{1.0, std::cos(turns[k]), std::sin(turns[k])}; };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        normal[i][j] += base(k)[i] * base(k)[j];
      }
    }
    normal[i][3 + i] = 1;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double pivot = normal[i][i];  // never 0: four steps or more, apart by less than a turn
    std::ranges::for_each(normal[i], [&](double& value) { value /= pivot; });
    for (std::size_t other = 0; other < 3; ++other) {
      const double factor = other == i ? 0 : normal[other][i];
      for (std::size_t j = 0; j < 6; ++j) {
        normal[other][j] -= factor * normal[i][j];
      }
    }
  }
  SinusoidFit made{Matrix(3, std::vector<double>(count)), Matrix(count, std::vector<double>(count))};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        made.fit[i][k] += normal[i][3 + j] * base(k)[j];
      }
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = 0; j < count; ++j) {
      made.deleted[k][j] = k == j ? 1 : 0;
      for (std::size_t i = 0; i < 3; ++i) {
        made.deleted[k][j] -= base(k)[i] * made.fit[i][j];
      }
    }
    const double left = made.deleted[k][k];
    std::ranges::for_each(made.deleted[k], [&](double& value) { value = left > 1e-9 ? value / left : 0; });
  }
  return made;
}

std::vector<double> times(const Matrix& matrix, const std::vector<double>& values) {
  std::vector<double> product(matrix.size());
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      product[i] += matrix[i][k] * values[k];
    }
  }
  return product;
}

struct Steps {
  std::vector<int> frames;
  std::vector<double> turns;
};

Steps steps_of(const std::vector<Pattern>& patterns, const Frames& frames, int first, int count) {
  Steps steps;
  for (int k = first; k < first + count; ++k) {
    if (frames[static_cast<std::size_t>(k)]) {
      const Pattern& pattern = patterns[static_cast<std::size_t>(k)];
      steps.frames.push_back(k);
      steps.turns.push_back(2 * std::numbers::pi * pattern.step / pattern.block.steps);
    }
  }
  return steps;
}

// How far each step departs from the others' sinusoid, [step][place]. A projector's gamma makes a second harmonic whose
// part of the first is the same everywhere: one number, taken out.
std::vector<std::vector<float>> departures_of(const Normalised& places, const Frames& frames, const Steps& steps) {
  const std::size_t count = steps.frames.size();
  const SinusoidFit fit = make_fit(steps.turns);
  std::vector<std::vector<float>> values;
  for (const int frame : steps.frames) {
    values.push_back(places.of(*frames[static_cast<std::size_t>(frame)]));
  }
  std::vector<std::vector<float>> left(count, std::vector<float>(places.size()));
  std::vector<std::vector<float>> harmonic = left;
  double along = 0;
  double length = 0;
  std::vector<double> seen(count);
  std::vector<double> second(count);
  for (std::size_t n = 0; n < places.size(); ++n) {
    for (std::size_t k = 0; k < count; ++k) {
      seen[k] = values[k][n];
    }
    const std::vector<double> sinusoid = times(fit.fit, seen);
    const double amplitude = std::hypot(sinusoid[1], sinusoid[2]);
    const double phase = std::atan2(sinusoid[2], sinusoid[1]);
    for (std::size_t k = 0; k < count; ++k) {
      second[k] = amplitude * std::cos(2 * (phase - steps.turns[k]));
    }
    const std::vector<double> departure = times(fit.deleted, seen);
    const std::vector<double> by_gamma = times(fit.deleted, second);
    for (std::size_t k = 0; k < count; ++k) {
      left[k][n] = static_cast<float>(departure[k]);
      harmonic[k][n] = static_cast<float>(by_gamma[k]);
      along += departure[k] * by_gamma[k];
      length += by_gamma[k] * by_gamma[k];
    }
  }
  const auto gamma = static_cast<float>(length > 0 ? along / length : 0);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t n = 0; n < places.size(); ++n) {
      left[k][n] = std::abs(left[k][n] - gamma * harmonic[k][n]);
    }
  }
  return left;
}

// Takes out the frame that contradicts the others most, and looks again.
void judge_steps(const Normalised& places, const Frames& frames, Steps steps, std::vector<WrongFrame>& wrong) {
  while (steps.frames.size() >= 4) {
    const std::vector<std::vector<float>> departures = departures_of(places, frames, steps);
    std::vector<float> noises;
    for (const std::vector<float>& departure : departures) {
      noises.push_back(quantile(departure, kNoiseShare));
    }
    const float limit = limit_for(quantile(noises, 0.25));  // noise is what the quieter steps have
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < departures.size(); ++k) {
      const double share = share_beyond(departures[k], limit);
      if (share > most) {
        most = share;
        worst = k;
      }
    }
    if (most <= kMostContradicting) {
      return;
    }
    if (steps.frames.size() == 4) {
      for (const int frame : steps.frames) {  // four steps have one way to contradict: any of them may be wrong
        report(wrong, {frame, most, "the other steps of its sinusoid"});
      }
      return;
    }
    report(wrong, {steps.frames[worst], most, "the other steps of its sinusoid"});
    steps.frames.erase(steps.frames.begin() + static_cast<std::ptrdiff_t>(worst));
    steps.turns.erase(steps.turns.begin() + static_cast<std::ptrdiff_t>(worst));
  }
}

/// Calls `pair(pattern, complement, stripe)` and `steps(first, count)`.
template <class PairOf, class StepsOf>
void for_partners(const std::vector<Pattern>& patterns, const PairOf& pair, const StepsOf& steps) {
  for (int k = 0; k < static_cast<int>(patterns.size()); ++k) {
    const Pattern& pattern = patterns[static_cast<std::size_t>(k)];
    if (pattern.block.kind == PatternKind::kGray && pattern.block.inverse && pattern.step % 2 == 0) {
      pair(k, k + 1, pattern.block.stripe_px * std::ldexp(1.0, pattern.bit));
    } else if (pattern.block.kind == PatternKind::kPhase && pattern.step == 0) {
      steps(k, pattern.block.steps);
    }
  }
}

}  // namespace

std::vector<WrongFrame> find_wrong_frames(const PatternSequence& sequence, const References& references,
                                          const Frames& frames) {
  const std::vector<Pattern> patterns = sequence.patterns();
  std::vector<WrongFrame> wrong;
  for (const std::size_t eye : {0U, 1U}) {
    const Normalised places(references.eyes[eye], eye);
    if (places.size() == 0) {
      continue;
    }
    std::vector<Pair> pairs;
    for_partners(
        patterns,
        [&](int a, int b, double) {
          if (frames[static_cast<std::size_t>(a)] && frames[static_cast<std::size_t>(b)]) {
            pairs.push_back(compare(places, frames, a, b));
          }
        },
        [&](int first, int count) { judge_steps(places, frames, steps_of(patterns, frames, first, count), wrong); });
    judge_complements(pairs, wrong);
  }
  std::ranges::sort(wrong, {}, &WrongFrame::index);
  return wrong;
}

std::optional<double> finest_contrast(const PatternSequence& sequence, const References& references,
                                      const Frames& frames) {
  const std::vector<Pattern> patterns = sequence.patterns();
  std::optional<double> worst;
  for (const std::size_t eye : {0U, 1U}) {
    const Normalised places(references.eyes[eye], eye);
    const auto note = [&](const std::vector<float>& contrasts) {
      const double contrast = quantile(contrasts, 0.5);
      worst = std::min(worst.value_or(contrast), contrast);
    };
    const auto there = [&](int k) { return frames[static_cast<std::size_t>(k)].has_value(); };
    for_partners(
        patterns,
        [&](int a, int b, double stripe) {
          if (stripe < kJudgedStripe_px || stripe >= 2 * kJudgedStripe_px || !there(a) || !there(b)) {
            return;
          }
          std::vector<float> contrasts = places.of(*frames[static_cast<std::size_t>(a)]);
          const std::vector<float> other = places.of(*frames[static_cast<std::size_t>(b)]);
          for (std::size_t n = 0; n < contrasts.size(); ++n) {
            contrasts[n] = std::abs(contrasts[n] - other[n]);
          }
          note(contrasts);
        },
        [&](int first, int count) {
          const Steps steps = steps_of(patterns, frames, first, count);
          if (static_cast<int>(steps.frames.size()) < count ||
              patterns[static_cast<std::size_t>(first)].block.period_px < kJudgedStripe_px) {
            return;
          }
          std::vector<float> cosine(places.size());
          std::vector<float> sine(places.size());
          for (std::size_t k = 0; k < steps.frames.size(); ++k) {
            const std::vector<float> values = places.of(*frames[static_cast<std::size_t>(steps.frames[k])]);
            const auto c = static_cast<float>(4 * std::cos(steps.turns[k]) / count);
            const auto s = static_cast<float>(4 * std::sin(steps.turns[k]) / count);
            for (std::size_t n = 0; n < values.size(); ++n) {
              cosine[n] += c * values[n];
              sine[n] += s * values[n];
            }
          }
          for (std::size_t n = 0; n < cosine.size(); ++n) {
            cosine[n] = std::hypot(cosine[n], sine[n]);
          }
          note(cosine);
        });
  }
  return worst;
}

}  // namespace raysteer::firmware::capture
