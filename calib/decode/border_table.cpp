#include "calib/decode/border_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "calib/decode/code_map.hpp"
#include "calib/decode/find_borders.hpp"

namespace raysteer::calib::decode {
namespace {

/// A border between two pixels of a line.
struct Crossing {
  float place;     ///< px along the line
  int border;      ///< its number
  float variance;  ///< of place, px^2
};

using Segment = std::vector<Crossing>;  ///< crossings of one unbroken piece of a line

/// Straight line through this many crossings before and after the one that is judged.
constexpr std::ptrdiff_t kWindow = 9;
/// A window that scatters more crosses a depth edge, stripes.
constexpr double kMaxScatter = 0.8;
constexpr double kMaxResidual = 1.5;
/// Slower changes than this many borders belong to the surface.
constexpr int kSlow = 24;
/// Displacements below this RMS are not those of a scaled picture (3:2 gives 0.3, 5:4 gives 0.14) and are left.
constexpr double kLeastDisplacement = 0.1;
/// ... nor are those that the two halves of the image do not agree upon (correlation; the bag's: 0.9).
constexpr double kLeastAgreement = 0.7;
constexpr int kRounds = 12;
constexpr double kRelaxation = 1.5;
constexpr int kFewestCrossings = 8;
/// One crossing of this many is enough for the median of the scatter.
constexpr int kScatterShare = 7;
/// Between one crossing and the next of a line, in borders and in pixels.
constexpr int kMaxStep = 6;
constexpr float kMaxPause = 64;

/// `half`: the first segment of the second half of the lines.
template <class T>
std::vector<Segment> find_segments(const GrayStore<T>& lines, int count, const GrayLimits& limits, std::size_t& half) {
  const int width = limits.width;
  const auto size = static_cast<std::size_t>(width);
  std::vector<std::uint16_t> code(size);
  std::vector<std::uint8_t> mask(size);
  std::vector<float> noise(size);
  std::array<std::vector<float>, 6> store;
  for (std::vector<float>& part : store) {
    part.resize(size);
  }
  const GapRow gaps{store[0].data(), store[1].data(), store[2].data(),
                    store[3].data(), store[4].data(), store[5].data()};
  std::vector<Segment> segments;
  for (int line = 0; line < count; ++line) {
    if (line == count / 2) {
      half = segments.size();
    }
    const GraySums<T> sums = lines.row(line);
    std::ranges::fill(mask, std::uint8_t{0});
    classify(sums, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr), limits, code.data(), mask.data(),
             noise.data());
    const EdgeSource<T> a{code.data(), sums.finest, sums.weakest, sums.weakest_bit, noise.data()};
    const EdgeSource<T> b{code.data() + 1, sums.finest + 1, sums.weakest + 1, sums.weakest_bit + 1, noise.data() + 1};
    find_borders(a, b, width - 1, gaps);
    Segment segment;
    const auto close = [&] {
      if (segment.size() > 2 * static_cast<std::size_t>(kWindow)) {
        segments.push_back(std::move(segment));
      }
      segment = {};
    };
    // A pixel or two that are not decoded leave a line whole; a jump of the code breaks it.
    const auto push = [&](const Crossing& crossing) {
      if (!segment.empty() && (std::abs(crossing.border - segment.back().border) > kMaxStep ||
                               crossing.place - segment.back().place > kMaxPause)) {
        close();
      }
      segment.push_back(crossing);
    };
    for (int i = 0; i + 1 < width; ++i) {
      if (gaps.variance_a[i] == GapRow::kLost || gaps.variance_a[i] == GapRow::kNone) {
        continue;
      }
      const auto place = static_cast<float>(i);
      push({place + gaps.place_a[i], static_cast<int>(gaps.number_a[i]), gaps.variance_a[i]});
      if (gaps.number_a[i] != gaps.number_b[i]) {
        push({place + gaps.place_b[i], static_cast<int>(gaps.number_b[i]), gaps.variance_b[i]});
      }
    }
    close();
  }
  return segments;
}

/// Residuals of every crossing from a straight line through its neighbours: `visit(crossing, residual, slope)`,
/// residual in stripes (line minus table), slope in stripes per px.
template <class Visit>
void judge(const std::vector<Segment>& segments, const std::vector<double>& table, const Visit& visit) {
  struct Moments {
    double u = 0, uu = 0, n = 0, un = 0, nn = 0;
  };
  std::vector<Moments> sums;
  for (const Segment& segment : segments) {
    // Running sums about the segment's beginning; windows are differences of them.
    sums.assign(segment.size() + 1, {});
    const double u0 = segment.front().place;
    const double n0 = segment.front().border;
    for (std::size_t i = 0; i < segment.size(); ++i) {
      const double u = segment[i].place - u0;
      const double n = table[static_cast<std::size_t>(segment[i].border)] - n0;
      const Moments& m = sums[i];
      sums[i + 1] = {m.u + u, m.uu + u * u, m.n + n, m.un + u * n, m.nn + n * n};
    }
    constexpr double kCount = 2 * kWindow + 1;
    for (std::size_t i = kWindow; i + kWindow < segment.size(); ++i) {
      const Moments& low = sums[i - kWindow];
      const Moments& high = sums[i + kWindow + 1];
      const double mu = (high.u - low.u) / kCount;
      const double mn = (high.n - low.n) / kCount;
      const double uu = (high.uu - low.uu) / kCount - mu * mu;
      const double un = (high.un - low.un) / kCount - mu * mn;
      const double nn = (high.nn - low.nn) / kCount - mn * mn;
      if (uu <= 0) {
        continue;
      }
      const double slope = un / uu;
      const double scatter2 = nn - slope * un;
      const double line = mn + slope * (segment[i].place - u0 - mu);
      const double residual = line - (table[static_cast<std::size_t>(segment[i].border)] - n0);
      if (scatter2 < kMaxScatter * kMaxScatter && std::abs(residual) < kMaxResidual) {
        visit(segment[i], residual, slope);
      }
    }
  }
}

/// Shifts of all borders from where they should be, stripes, and how many crossings each was learnt from.
struct Shifts {
  std::vector<double> shift;
  std::vector<int> seen;

  bool knows(std::size_t n) const { return seen[n] >= kFewestCrossings; }
};

std::vector<double> even_table(std::size_t borders) {
  std::vector<double> table(borders);
  std::iota(table.begin(), table.end(), 0.0);
  return table;
}

/// Without what changes slowly from border to border.
void keep_fast_part(Shifts& shifts) {
  const std::vector<double> all = shifts.shift;
  const auto borders = static_cast<std::ptrdiff_t>(all.size());
  for (std::ptrdiff_t n = 0; n < borders; ++n) {
    double sum = 0;
    int number = 0;
    for (std::ptrdiff_t at = std::max(std::ptrdiff_t{0}, n - kSlow / 2); at <= std::min(borders - 1, n + kSlow / 2);
         ++at) {
      if (shifts.seen[static_cast<std::size_t>(at)] > 0) {
        sum += all[static_cast<std::size_t>(at)];
        ++number;
      }
    }
    const auto here = static_cast<std::size_t>(n);
    shifts.shift[here] = shifts.knows(here) && number > kSlow / 2 ? all[here] - sum / number : 0;
  }
}

double rms(const Shifts& shifts) {
  double sum = 0, number = 0;
  for (std::size_t n = 0; n < shifts.shift.size(); ++n) {
    if (shifts.knows(n)) {
      sum += shifts.shift[n] * shifts.shift[n];
      number += 1;
    }
  }
  return number > 0 ? std::sqrt(sum / number) : 0;
}

/// Moves every border towards where its neighbours say, again and again.
Shifts learn_shifts(const std::vector<Segment>& segments, std::size_t borders) {
  Shifts shifts{std::vector<double>(borders), std::vector<int>(borders)};
  std::vector<double> table = even_table(borders);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sum(borders);
    std::ranges::fill(shifts.seen, 0);
    judge(segments, table, [&](const Crossing& crossing, double residual, double) {
      sum[static_cast<std::size_t>(crossing.border)] += residual;
      ++shifts.seen[static_cast<std::size_t>(crossing.border)];
    });
    for (std::size_t n = 0; n < borders; ++n) {
      if (shifts.knows(n)) {
        shifts.shift[n] += kRelaxation * sum[n] / shifts.seen[n];
      }
    }
    keep_fast_part(shifts);
    for (std::size_t n = 0; n < borders; ++n) {
      table[n] = static_cast<double>(n) + shifts.shift[n];
    }
    if (round == 0 && rms(shifts) < kLeastDisplacement / 2) {
      break;
    }
  }
  return shifts;
}

/// Do two parts of the image tell the same? The panel is one, the surface is not.
double correlation(const Shifts& a, const Shifts& b) {
  double aa = 0, ab = 0, bb = 0;
  for (std::size_t n = 0; n < a.shift.size(); ++n) {
    if (a.knows(n) && b.knows(n)) {
      aa += a.shift[n] * a.shift[n];
      ab += a.shift[n] * b.shift[n];
      bb += b.shift[n] * b.shift[n];
    }
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

template <class T>
BorderTable learn_borders(const GrayStore<T>& lines, int count, const GrayLimits& limits) {
  std::size_t half = 0;
  const std::vector<Segment> segments = find_segments(lines, count, limits, half);
  const std::size_t borders = static_cast<std::size_t>(limits.codes) + 2;
  const Shifts shifts = learn_shifts(segments, borders);
  BorderTable result;
  std::vector<double> table = even_table(borders);
  if (rms(shifts) >= kLeastDisplacement) {
    const auto middle_segment = segments.begin() + static_cast<std::ptrdiff_t>(half);
    const Shifts first = learn_shifts({segments.begin(), middle_segment}, borders);
    const Shifts second = learn_shifts({middle_segment, segments.end()}, borders);
    if (correlation(first, second) >= kLeastAgreement) {
      result.displacement = static_cast<float>(rms(shifts));
      for (std::size_t n = 0; n < borders; ++n) {
        table[n] += shifts.shift[n];
      }
      result.place.assign(table.begin(), table.end());
    }
  }
  // Scatter beyond noise, by medians: robust against the crossings of edges.
  std::vector<float> squares;
  std::vector<float> expected;
  int judged = 0;
  judge(segments, table, [&](const Crossing& crossing, double residual, double slope) {
    if (++judged % kScatterShare != 0) {
      return;
    }
    squares.push_back(static_cast<float>(residual * residual));
    expected.push_back(static_cast<float>(slope * slope) * crossing.variance);
  });
  if (squares.size() >= 100) {
    const auto middle = static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), squares.begin() + middle, squares.end());
    std::nth_element(expected.begin(), expected.begin() + middle, expected.end());
    constexpr float kMedianOfChi2 = 0.4549F;  ///< of one degree of freedom
    result.excess_variance = std::max(
        0.0F, squares[static_cast<std::size_t>(middle)] / kMedianOfChi2 - expected[static_cast<std::size_t>(middle)]);
  }
  return result;
}

template BorderTable learn_borders(const GrayStore<std::uint8_t>&, int, const GrayLimits&);
template BorderTable learn_borders(const GrayStore<std::uint16_t>&, int, const GrayLimits&);

}  // namespace raysteer::calib::decode
