#include "calib/decode/engine.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/decode/bit_roles.hpp"
#include "calib/decode/median.hpp"
#include "calib/decode/phase_axis.hpp"

namespace raysteer::calib::decode {
namespace {

/// Rows whose sums stay in the second-level cache: 4 x 2048 x 20 bytes.
constexpr int kBandRows = 4;
/// Where the frames tell nothing about their noise: a camera of 1.5 DN and 40 electrons a DN.
constexpr double kUsualReadSigma = 1.5;
constexpr double kUsualElectrons = 40;
/// A pixel needs this many like it of 8 neighbours: the side of a depth edge has at least three.
constexpr int kFewestNeighbours = 3;
/// Noise of phases is looked for where there is light of at least this amplitude, DN of 255.
constexpr double kLitModulation = 2;

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

}  // namespace

template <class T>
Engine<T>::Engine(Plan plan, int width, int height, int bits, const Options& options)
    : plan_(std::move(plan)),
      width_(width),
      height_(height),
      options_(options),
      full_scale_(std::ldexp(1.0, bits) - 1),
      estimate_(full_scale_) {
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    if (plan_.axis(axis).gray) {
      gray(axis).roles = roles_of(*plan_.axis(axis).gray);
    }
  }
  noise_ = {.read_sigma_dn = dn(kUsualReadSigma), .electrons_per_dn = kUsualElectrons / dn(1)};
}

template <class T>
void Engine<T>::restart() {
  next_ = 0;
  white_seen_ = black_seen_ = false;
  waiting_.clear();
  estimate_ = NoiseEstimate(full_scale_);
  harmonics_ = 0;
  gray_x_.noise.clear();
  gray_y_.noise.clear();
  for (PhaseSums& phase : phases_) {
    phase.clear();
  }
  std::ranges::fill(phase_steps_, 0);
}

template <class T>
Status Engine<T>::check_frame(ImageView<const T> frame, int index) const {
  if (frame.width() != width_ || frame.height() != height_) {
    return fail(RCode::kFrameSize,
                "frame " + std::to_string(index + 1) + " is " + size_text(frame.width(), frame.height()) +
                    ", expected " + size_text(width_, height_),
                index);
  }
  return ok();
}

template <class T>
void Engine<T>::start(Axis axis, int rows) {
  GrayState& state = gray(axis);
  state.store = GrayStore<T>(width_, rows);
  state.store.clear_rows(0, rows);
  state.lines = places_borders(plan_.axis(axis)) ? LineSamples<T>(axis, width_, height_) : LineSamples<T>();
}

template <class T>
Status Engine<T>::push(ImageView<const T> frame) {
  RAYSTEER_TRY(check_frame(frame, next_));
  if (next_ >= static_cast<int>(plan_.frames.size())) {
    return fail(RCode::kFrameCount,
                "the sequence has " + std::to_string(plan_.frames.size()) + " frames, one more came", next_);
  }
  if (next_ == 0) {
    for (const Axis axis : {Axis::kX, Axis::kY}) {
      if (plan_.axis(axis).gray) {
        start(axis, height_);
      }
    }
    if (phases_.empty()) {
      for (const PatternBlock& block : plan_.phases) {
        phases_.emplace_back(block, width_, height_);
        phase_steps_.push_back(0);
      }
    }
  }
  const Pattern& pattern = plan_.frames[static_cast<std::size_t>(next_)];
  const auto copy = [&](Image<T>& image) {
    if (image.empty()) {
      image = Image<T>::uninitialised(width_, height_);
    }
    for (int y = 0; y < height_; ++y) {
      std::copy(frame.row(y), frame.row(y) + width_, image.row(y));
    }
  };
  switch (pattern.block.kind) {
    case PatternKind::kWhite:
      copy(white_);
      white_seen_ = true;
      break;
    case PatternKind::kBlack:
      copy(black_);
      black_seen_ = true;
      break;
    case PatternKind::kGray:
      if (pattern.block.inverse) {
        if (pattern.inverted != pattern.block.inverse_first) {
          const ImageView<const T> first = held_.view();
          fold_frame(pattern.block.axis, pattern.bit, pattern.inverted ? first : frame,
                     pattern.inverted ? frame : first);
        } else {
          copy(held_);
        }
      } else if (threshold_known(pattern)) {
        fold_threshold(pattern, frame);
      } else {
        waiting_.emplace_back(pattern, Image<T>());
        copy(waiting_.back().second);
      }
      break;
    case PatternKind::kPhase: {
      const int phase = plan_.phase_of_block[pattern.block_index];
      phases_[phase].add(pattern.step, frame);
      ++phase_steps_[phase];
      break;
    }
  }
  ++next_;
  if (!waiting_.empty()) {
    fold_waiting();
  }
  return ok();
}

template <class T>
bool Engine<T>::threshold_known(const Pattern& pattern) const {
  const AxisPlan& axis = plan_.axis(pattern.block.axis);
  if (axis.threshold == Threshold::kPhaseMean) {
    const int phase = axis.phases.front();
    return phase_steps_[phase] == plan_.phases[phase].steps;
  }
  return white_seen_ && black_seen_;
}

template <class T>
void Engine<T>::fold_waiting() {
  std::erase_if(waiting_, [&](const std::pair<Pattern, Image<T>>& item) {
    if (!threshold_known(item.first)) {
      return false;
    }
    fold_threshold(item.first, item.second.view());
    return true;
  });
}

template <class T>
void Engine<T>::fold_frame(Axis axis, int bit, ImageView<const T> p, ImageView<const T> q) {
  const BitRole& role = gray(axis).roles[bit];
  for (int y = 0; y < height_; ++y) {
    fold(role, p.row(y), q.row(y), width_, gray(axis).store.row(y));
  }
  sample(axis, role, p, q);
}

template <class T>
void Engine<T>::fold_threshold(const Pattern& pattern, ImageView<const T> frame) {
  // The inverse that was not taken: the threshold lies half-way between it and the pattern.
  const AxisPlan& plan = plan_.axis(pattern.block.axis);
  Image<T> inverse = Image<T>::uninitialised(width_, height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const int sum = plan.threshold == Threshold::kPhaseMean
                          ? static_cast<int>(std::lround(2 * phases_[plan.phases.front()].mean(x, y)))
                          : white_(x, y) + black_(x, y);
      inverse(x, y) = inverse_of(frame(x, y), sum);
    }
  }
  fold_frame(pattern.block.axis, pattern.bit, frame, inverse.view());
}

template <class T>
T Engine<T>::inverse_of(T pattern, int sum) const {
  return static_cast<T>(std::clamp(sum - pattern, 0, static_cast<int>(full_scale_)));
}

template <class T>
void Engine<T>::sample(Axis axis, const BitRole& role, ImageView<const T> p, ImageView<const T> q) {
  const AxisPlan& plan = plan_.axis(axis);
  GrayState& state = gray(axis);
  if (role.coarse) {
    state.noise.add(p, q, plan.gray->inverse, static_cast<int>(options_.saturation * full_scale_), estimate_);
  }
  if (places_borders(plan)) {
    state.lines.add(role, p, q);
  }
}

template <class T>
BorderTable Engine<T>::learn(Axis axis) {
  const AxisPlan& plan = plan_.axis(axis);
  return places_borders(plan) ? gray(axis).lines.learn(limits(plan)) : BorderTable();
}

template <class T>
void Engine<T>::sample_phase_noise(const PhaseSums& sums) {
  if (sums.block().steps < 4) {
    return;
  }
  const int step = std::max(1, std::min(width_ / kNoiseColumns, height_ / kNoiseRows) / 2);
  std::vector<float> departures;
  for (int y = 0; y < height_; y += step) {
    for (int x = 0; x < width_; x += step) {
      const PhaseSums::Pixel pixel = sums.pixel(x, y);
      if (pixel.peak < options_.saturation * full_scale_ && pixel.modulation > dn(kLitModulation)) {
        estimate_.add(pixel.mean, pixel.noise, 1);
        departures.push_back(static_cast<float>(pixel.residual / (pixel.modulation * pixel.modulation)));
      }
    }
  }
  if (!departures.empty()) {
    harmonics_ = std::max(harmonics_, static_cast<double>(median(departures)));
  }
}

template <class T>
GrayLimits Engine<T>::limits(const AxisPlan& axis) const {
  // Variance of p - q at a border, where p = q = s / 2. The inverse made of white and black is w + b - p, so that
  // p - q = 2 p - w - b; that made of the mean A of n steps is 2 A - p.
  double share = 2;
  if (axis.threshold == Threshold::kWhiteAndBlack) {
    share = 6;
  } else if (axis.threshold == Threshold::kPhaseMean) {
    share = 4 * (1 + 1.0 / plan_.phases[axis.phases.front()].steps);
  }
  GrayLimits limits;
  limits.difference_floor = static_cast<float>(share * noise_.floor());
  limits.difference_slope = static_cast<float>(share * noise_.slope() / 2);
  limits.min_sigma2 = static_cast<float>(options_.min_sigma * options_.min_sigma);
  limits.min_difference2 = static_cast<float>(dn(options_.min_difference_dn) * dn(options_.min_difference_dn));
  limits.min_contrast = static_cast<float>(dn(options_.min_contrast_dn));
  limits.saturation = static_cast<float>(options_.saturation * full_scale_);
  limits.coarse = axis.gray->bits > 2;
  limits.codes = codes_of(*axis.gray, axis.panel);
  limits.width = width_;
  return limits;
}

template <class T>
template <class Pixel>
void Engine<T>::ensure(Image<Pixel>& image, bool wanted) const {
  if (!wanted) {
    image = {};
  } else if (image.width() != width_ || image.height() != height_) {
    image = Image<Pixel>::uninitialised(width_, height_);
  }
}

template <class T>
CodeMap Engine<T>::make_map(CodeMap reused) const {
  CodeMap map = std::move(reused);
  map.diagnostics = {};
  ensure(map.mask, true);
  map.mask.fill(0);
  for (const Axis which : {Axis::kX, Axis::kY}) {
    const AxisPlan& axis = plan_.axis(which);
    const bool x = which == Axis::kX;
    const bool placed = axis.used() && (options_.sub_pixel || !axis.phases.empty());
    ensure(x ? map.code_x : map.code_y, axis.used());
    ensure(x ? map.x : map.y, placed);
    ensure(x ? map.variance_x : map.variance_y, placed);
  }
  return map;
}

template <class T>
Result<CodeMap> Engine<T>::finish(CodeMap reused) {
  const int expected = static_cast<int>(plan_.frames.size());
  if (next_ != expected) {
    const int came = next_;
    restart();
    return fail(RCode::kFrameCount,
                "the sequence has " + std::to_string(expected) + " frames, " + std::to_string(came) + " came", came);
  }
  for (const PhaseSums& phase : phases_) {
    sample_phase_noise(phase);
  }
  fit_noise();
  CodeMap map = make_map(std::move(reused));
  Placers placers = make_placers(map);
  const bool references = plan_.white && plan_.black;
  for (auto& [axis, placer] : placers) {
    for (int v = 0; v < height_; ++v) {
      placer.row(gray(axis).store.row(v), references ? white_.row(v) : nullptr, references ? black_.row(v) : nullptr,
                 map.mask.row(v));
    }
    placer.finish();
  }
  std::vector<Placed> placed;
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    if (!plan_.axis(axis).phases.empty()) {
      placed.push_back(place_phases(axis, map));
    }
  }
  restart();
  RowCheck check(map, resemblance());
  for (int v = 0; v < height_; ++v) {
    check.ask_neighbours(v);
  }
  if (options_.neighbours && !placed.empty()) {
    mark_depth_edges(placed, map.mask);
  }
  for (int v = 0; v < height_; ++v) {
    check.settle(v);
  }
  return complete(std::move(map), check);
}

template <class T>
void Engine<T>::fit_noise() {
  if (options_.read_sigma_dn > 0 || options_.electrons_per_dn > 0) {
    noise_.read_sigma_dn = options_.read_sigma_dn;
    noise_.electrons_per_dn =
        options_.electrons_per_dn > 0 ? options_.electrons_per_dn : std::numeric_limits<double>::infinity();
  } else {
    noise_ = estimate_.fit(noise_);
  }
}

template <class T>
typename Engine<T>::Placers Engine<T>::make_placers(CodeMap& map) {
  Placers placers;
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    const AxisPlan& plan = plan_.axis(axis);
    if (!plan.gray) {
      continue;
    }
    const bool x = axis == Axis::kX;
    BorderTable borders = learn(axis);
    (x ? map.diagnostics.border_displacement_x : map.diagnostics.border_displacement_y) = borders.displacement;
    const bool place = places_borders(plan);
    placers.emplace_back(axis, GrayAxis<T>(axis, *plan.gray, limits(plan), std::move(borders), height_,
                                           x ? map.code_x : map.code_y, place ? (x ? &map.x : &map.y) : nullptr,
                                           place ? (x ? &map.variance_x : &map.variance_y) : nullptr));
  }
  return placers;
}

template <class T>
Placed Engine<T>::place_phases(Axis which, CodeMap& map) {
  const PhaseLimits limits{.noise = noise_,
                           .harmonics = harmonics_,
                           .saturation = options_.saturation * full_scale_,
                           .min_modulation = dn(options_.min_modulation_dn),
                           .min_sigma = options_.min_sigma,
                           .max_sigma_px = options_.max_sigma_px,
                           .max_order_residual = options_.max_order_residual};
  const bool along_x = which == Axis::kX;
  Image<float>& value = along_x ? map.x : map.y;
  Image<float>& variance = along_x ? map.variance_x : map.variance_y;
  const PhaseFindings findings = decode::place_phases(plan_.axis(which), phases_, limits,
                                                      {value, variance, along_x ? map.code_x : map.code_y, map.mask});
  (along_x ? map.diagnostics.order_residual_x : map.diagnostics.order_residual_y) = findings.order_residual;
  map.diagnostics.coverage = static_cast<double>(findings.covered) / static_cast<double>(map.mask.size());
  return {&value, &variance};
}

template <class T>
Resemblance Engine<T>::resemblance() const {
  // Codes a camera pixel if the camera saw just the panel, twice that for a slanted surface, and two for noise.
  const auto reach = [](const AxisPlan& axis, int camera) {
    const int codes = axis.gray && axis.phases.empty() ? codes_of(*axis.gray, axis.panel) : axis.panel;
    return 2 + (2 * codes + camera - 1) / camera;
  };
  return {.reach_x = reach(plan_.x, width_),
          .reach_y = reach(plan_.y, height_),
          .fewest = options_.neighbours ? kFewestNeighbours : 0};
}

template <class T>
Result<CodeMap> Engine<T>::complete(CodeMap map, const RowCheck& rows) const {
  Diagnostics& diagnostics = map.diagnostics;
  diagnostics.pixels = map.mask.size();
  diagnostics.valid = rows.valid();
  diagnostics.read_sigma_dn = noise_.read_sigma_dn;
  diagnostics.electrons_per_dn = noise_.electrons_per_dn;
  if (plan_.phases.empty()) {
    diagnostics.coverage = static_cast<double>(rows.covered()) / static_cast<double>(diagnostics.pixels);
  }
  if (diagnostics.valid == 0) {
    if (2 * rows.saturated() > diagnostics.pixels) {
      return fail(RCode::kFramesSaturated, std::to_string(100 * rows.saturated() / diagnostics.pixels) +
                                               " % of the pixels are saturated and none could be decoded");
    }
    return fail(RCode::kNothingDecoded, "none of " + std::to_string(diagnostics.pixels) + " pixels has a usable code");
  }
  return map;
}

template <class T>
Result<CodeMap> Engine<T>::decode(std::span<const ImageView<const T>> frames, CodeMap reused) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    RAYSTEER_TRY(check_frame(frames[i], static_cast<int>(i)));
  }
  std::vector<Pair> pairs;
  ImageView<const T> white, black;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Pattern& pattern = plan_.frames[i];
    if (pattern.block.kind == PatternKind::kWhite) {
      white = frames[i];
    } else if (pattern.block.kind == PatternKind::kBlack) {
      black = frames[i];
    } else if (pattern.inverted != pattern.block.inverse_first) {
      const bool second = pattern.inverted;
      pairs.push_back({pattern.block.axis, pattern.bit, frames[second ? i - 1 : i], frames[second ? i : i - 1]});
    }
  }
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    if (plan_.axis(axis).gray) {
      start(axis, kBandRows);
    }
  }
  for (const Pair& pair : pairs) {
    const BitRole& role = gray(pair.axis).roles[pair.bit];
    sample(pair.axis, role, pair.p, pair.q);
  }
  fit_noise();
  CodeMap map = make_map(std::move(reused));
  Placers placers = make_placers(map);
  RowCheck check(map, resemblance());
  int lag = 1;  // a row is checked against the one below it
  for (const auto& [axis, placer] : placers) {
    lag = std::max(lag, placer.lag());
  }
  const bool references = plan_.white && plan_.black;
  for (int first = 0; first < height_; first += kBandRows) {
    const int last = std::min(first + kBandRows, height_);
    for (const Axis axis : {Axis::kX, Axis::kY}) {
      if (plan_.axis(axis).gray) {
        gray(axis).store.clear_rows(0, last - first);
      }
    }
    for (const Pair& pair : pairs) {
      const BitRole& role = gray(pair.axis).roles[pair.bit];
      const GrayStore<T>& store = gray(pair.axis).store;
      for (int v = first; v < last; ++v) {
        fold(role, pair.p.row(v), pair.q.row(v), width_, store.row(v - first));
      }
    }
    for (int v = first; v < last; ++v) {
      for (auto& [axis, placer] : placers) {
        placer.row(gray(axis).store.row(v - first), references ? white.row(v) : nullptr,
                   references ? black.row(v) : nullptr, map.mask.row(v));
      }
      if (v >= lag) {
        check.row(v - lag);
      }
    }
  }
  for (auto& [axis, placer] : placers) {
    placer.finish();
  }
  for (int v = std::max(0, height_ - lag); v < height_; ++v) {
    check.row(v);
  }
  restart();
  return complete(std::move(map), check);
}

template class Engine<std::uint8_t>;
template class Engine<std::uint16_t>;

}  // namespace raysteer::calib::decode
