#include "calib/decode/engine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "calib/decode/depth_edges.hpp"
#include "calib/decode/neighbours.hpp"

namespace raysteer::calib::decode {
namespace {

/// Noise is estimated from a grid of at most this many pixels: enough for 1 % at each of 16 signal levels.
constexpr int kNoiseColumns = 256;
constexpr int kNoiseRows = 64;
/// Lines across the stripes from which the borders' places are learnt: each border is crossed by most of them.
constexpr int kSampledLines = 96;
constexpr int kColumnsTogether = 32;
/// Rows whose sums stay in the second-level cache: 4 x 2048 x 20 bytes.
constexpr int kBandRows = 4;
/// Where the frames tell nothing about their noise: a camera of 1.5 DN and 40 electrons a DN.
constexpr double kUsualReadSigma = 1.5;
constexpr double kUsualElectrons = 40;
/// Stripes at least this wide show direct light even where the projector is blurred by 2 px.
constexpr double kDirectStripe = 8;
/// A pixel needs this many like it of 8 neighbours: the side of a depth edge has at least three.
constexpr int kFewestNeighbours = 3;
/// A half period from Gray and the phase may disagree by this share of a period before the pixel is ambiguous.
constexpr double kMaxDisagreement = 0.45;
/// A residual above this many times what noise and the projector's harmonics explain is no sinusoid (algorithms 2.5).
constexpr double kMaxChi2 = 9;
/// Noise of phases is looked for where there is light of at least this amplitude, DN of 255.
constexpr double kLitModulation = 2;

/// Stripes of bit b are 2^(b+1) codes wide, but for the most significant.
double stripe_of(const PatternBlock& block, int bit) { return std::ldexp(block.stripe_px, bit + 1); }

/// The two finest bits with resolved stripes show direct light; those above them are coarse.
std::vector<BitRole> roles_of(const PatternBlock& block) {
  std::vector<BitRole> roles(static_cast<std::size_t>(block.bits));
  int first = 0;
  while (first + 2 < block.bits && stripe_of(block, first) < kDirectStripe) {
    ++first;
  }
  for (int bit = 0; bit < block.bits; ++bit) {
    roles[bit] = {.bit = bit, .direct = bit == first || bit == first + 1, .coarse = bit > first + 1};
  }
  return roles;
}

int codes_of(const PatternBlock& block, int panel) {
  return static_cast<int>(std::ceil((panel + block.offset_px) / block.stripe_px));
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

float median(std::vector<float>& values) {
  if (values.empty()) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
  gray_x_.sampled.clear();
  gray_y_.sampled.clear();
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
  state.lines = GrayStore<T>(axis == Axis::kX ? width_ : height_, lines(axis));
  state.lines.clear_rows(0, lines(axis));
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
  sample_noise(axis, role, p, q);
  sample_lines(axis, role, p, q);
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
void Engine<T>::sample_noise(Axis axis, const BitRole& role, ImageView<const T> p, ImageView<const T> q) {
  // Pattern plus inverse is white plus black, whatever the bit: from one coarse bit to the next only noise changes, and
  // some global light, which a neighbouring pixel shares. A pattern without inverse is compared with the last coarse
  // one that was as bright.
  if (!role.coarse) {
    return;
  }
  GrayState& state = gray(axis);
  const bool pairs = plan_.axis(axis).gray->inverse;
  const auto saturated = static_cast<int>(options_.saturation * full_scale_);
  const int step_x = (width_ + kNoiseColumns - 1) / kNoiseColumns;
  const int step_y = (height_ + kNoiseRows - 1) / kNoiseRows;
  const int columns = (width_ - 1) / step_x;
  const int rows = (height_ + step_y - 1) / step_y;
  constexpr int kUnknown = -1;
  // Two pixels side by side, each unlit and lit; pairs use the first of the two only.
  state.sampled.resize(4 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kUnknown);
  int* before = state.sampled.data();
  for (int y = 0; y < height_; y += step_y) {
    for (int k = 0; k < columns; ++k, before += 4) {
      const int x = step_x * k;
      if (std::max({p(x, y), q(x, y), p(x + 1, y), q(x + 1, y)}) >= saturated) {
        continue;
      }
      const bool lit = p(x, y) > q(x, y);
      if (!pairs && lit != (p(x + 1, y) > q(x + 1, y))) {
        continue;
      }
      int* last = before + (!pairs && lit ? 2 : 0);
      const int here = pairs ? p(x, y) + q(x, y) : p(x, y);
      const int beside = pairs ? p(x + 1, y) + q(x + 1, y) : p(x + 1, y);
      if (last[0] != kUnknown) {
        estimate_.add(pairs ? 0.5 * here : here, here - last[0] - (beside - last[1]), pairs ? 8 : 4);
      }
      last[0] = here;
      last[1] = beside;
    }
  }
}

template <class T>
int Engine<T>::lines(Axis axis) const {
  return std::min(kSampledLines, axis == Axis::kX ? height_ : width_);
}

template <class T>
int Engine<T>::line_place(Axis axis, int line) const {
  // Rows one by one; columns some together, which share cache lines.
  const int size = axis == Axis::kX ? height_ : width_;
  const int together = axis == Axis::kX ? 1 : kColumnsTogether;
  const int count = lines(axis);
  const int groups = (count + together - 1) / together;
  const int group = line / together;
  return std::min(static_cast<int>((group + 0.5) * size / groups) - together / 2 + line % together, size - 1);
}

template <class T>
void Engine<T>::sample_lines(Axis axis, const BitRole& role, ImageView<const T> p, ImageView<const T> q) {
  if (!options_.sub_pixel || !plan_.axis(axis).phases.empty()) {
    return;
  }
  GrayState& state = gray(axis);
  const int count = lines(axis);
  if (axis == Axis::kX) {
    for (int line = 0; line < count; ++line) {
      const int row = line_place(axis, line);
      fold(role, p.row(row), q.row(row), width_, state.lines.row(line));
    }
    return;
  }
  state.line_p.resize(static_cast<std::size_t>(height_) * kColumnsTogether);
  state.line_q.resize(state.line_p.size());
  for (int first = 0; first < count; first += kColumnsTogether) {
    const int together = std::min(kColumnsTogether, count - first);
    const int column = line_place(axis, first);
    for (int v = 0; v < height_; ++v) {
      const T* p_row = p.row(v);
      const T* q_row = q.row(v);
      for (int k = 0; k < together; ++k) {
        const int u = std::min(column + k, width_ - 1);
        state.line_p[static_cast<std::size_t>(k) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(v)] =
            p_row[u];
        state.line_q[static_cast<std::size_t>(k) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(v)] =
            q_row[u];
      }
    }
    for (int k = 0; k < together; ++k) {
      const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(k) * height_;
      fold(role, state.line_p.data() + start, state.line_q.data() + start, height_, state.lines.row(first + k));
    }
  }
}

template <class T>
BorderTable Engine<T>::learn(Axis axis) {
  const AxisPlan& plan = plan_.axis(axis);
  if (!options_.sub_pixel || !plan.phases.empty()) {
    return {};
  }
  GrayLimits line_limits = limits(plan);
  line_limits.width = axis == Axis::kX ? width_ : height_;
  return learn_borders(gray(axis).lines, lines(axis), line_limits);
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
      place_phases(axis, map);
      placed.push_back(axis == Axis::kX ? Placed{&map.x, &map.variance_x} : Placed{&map.y, &map.variance_y});
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
    // Where a phase refines the code, it alone places the pixel.
    const bool place = options_.sub_pixel && plan.phases.empty();
    placers.emplace_back(axis, GrayAxis<T>(axis, *plan.gray, limits(plan), std::move(borders), height_,
                                           x ? map.code_x : map.code_y, place ? (x ? &map.x : &map.y) : nullptr,
                                           place ? (x ? &map.variance_x : &map.variance_y) : nullptr));
  }
  return placers;
}

template <class T>
void Engine<T>::place_phases(Axis which, CodeMap& map) {
  const AxisPlan& axis = plan_.axis(which);
  const bool along_x = which == Axis::kX;
  Image<float>& value = along_x ? map.x : map.y;
  Image<float>& variance = along_x ? map.variance_x : map.variance_y;
  Image<std::uint16_t>& code = along_x ? map.code_x : map.code_y;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const double saturated = options_.saturation * full_scale_;
  const double least_modulation = dn(options_.min_modulation_dn);
  std::vector<float> residuals;
  std::size_t covered = 0;
  std::vector<double> places(axis.phases.size()), periods(axis.phases.size()), variances(axis.phases.size());
  for (std::size_t i = 0; i < axis.phases.size(); ++i) {
    periods[i] = plan_.phases[axis.phases[i]].period_px;
  }
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      std::uint8_t reasons = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const PhaseSums& sums = phases_[axis.phases[i]];
        const PhaseSums::Pixel pixel = sums.pixel(u, v);
        const double noise = noise_.variance(pixel.mean);
        places[i] = pixel.place;
        variances[i] = sums.variance(pixel, noise_);
        if (pixel.peak >= saturated) {
          reasons |= kSaturated;
        }
        if (pixel.modulation < least_modulation ||
            pixel.modulation * pixel.modulation < options_.min_sigma * options_.min_sigma * noise) {
          reasons |= kLowModulation;
        }
        if (pixel.residual > kMaxChi2 * (noise + harmonics_ * pixel.modulation * pixel.modulation)) {
          reasons |= kAmbiguous;
        }
      }
      covered += (reasons & (kSaturated | kLowModulation)) == 0 ? 1 : 0;
      double place = 0;
      if (axis.gray) {
        // Half periods order the phase (algorithms 2.4).
        const std::uint16_t stripe = code(u, v);
        const double rough = (stripe + 0.5) * axis.gray->stripe_px - axis.gray->offset_px - 0.5;
        place = nearest_period(places[0], periods[0], rough);
        if (stripe == CodeMap::kNoCode || std::abs(place - rough) > kMaxDisagreement * periods[0]) {
          reasons |= kAmbiguous;
        }
      } else {
        const Heterodyne found = heterodyne(places, periods, axis.panel);
        place = found.place;
        if (places.size() > 1) {
          if ((reasons & (kSaturated | kLowModulation)) == 0) {
            residuals.push_back(static_cast<float>(found.residual));
          }
          if (found.residual > options_.max_order_residual) {
            reasons |= kAmbiguous;
          }
        }
      }
      // Each period measures the same coordinate; they are weighted by what they know.
      double weights = 0;
      double sum = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        weights += 1 / variances[i];
        sum += nearest_period(places[i], periods[i], place) / variances[i];
      }
      place = sum / weights;
      if (1 / weights > options_.max_sigma_px * options_.max_sigma_px) {
        reasons |= kLowModulation;
      }
      if (place < -1 || place > axis.panel) {
        reasons |= kOutside;
      }
      map.mask(u, v) |= reasons;
      const bool valid = reasons == 0;
      value(u, v) = valid ? static_cast<float>(place) : kNan;
      variance(u, v) = valid ? static_cast<float>(1 / weights) : kNan;
      code(u, v) = valid
                       ? static_cast<std::uint16_t>(std::clamp(static_cast<int>(std::lround(place)), 0, axis.panel - 1))
                       : CodeMap::kNoCode;
    }
  }
  (along_x ? map.diagnostics.order_residual_x : map.diagnostics.order_residual_y) = median(residuals);
  map.diagnostics.coverage = static_cast<double>(covered) / static_cast<double>(map.mask.size());
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
    sample_noise(pair.axis, role, pair.p, pair.q);
    sample_lines(pair.axis, role, pair.p, pair.q);
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
