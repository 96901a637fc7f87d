// value: what several kinds of result are made of. Plain numbers only; NaN (null in the file) means "not known".
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace raysteer::host::report {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A value per equal cell of a device's image, row by row from the top left. NaN: nothing known there.
struct Grid {
  int columns = 0;
  int rows = 0;
  std::vector<double> values{};
  bool empty() const { return values.empty(); }
  double at(int column, int row) const { return values[static_cast<std::size_t>(row * columns + column)]; }
};

/// The first sentence of every report, and why.
struct Judgement {
  std::string verdict{};               ///< "good", "usable", "redo"
  std::string summary{};               ///< one sentence in plain words
  std::vector<std::string> reasons{};  ///< why not better, each a sentence
  std::vector<std::string> advice{};   ///< what to add or change, each a sentence
};

/// One corner: where it was seen and by how much the model misses it, px of the device.
struct ResidualVector {
  int view = 0;
  double x = 0, y = 0, dx = 0, dy = 0;
  bool kept = true;
};

struct ParameterRow {
  std::string name{};  ///< "left.fx"
  double value = 0;
  double sigma = kUnknown;
  std::string unit{};  ///< "px", "rad", "m", ""
};

/// Counts in equal bins from `low` to `high`.
struct Histogram {
  double low = 0;
  double high = 0;
  std::vector<std::int64_t> counts{};
};

/// A named length of time or a count worth a line: {"left: decoded", "31.2 %"}.
struct Fact {
  std::string name{};
  std::string value{};
};

}  // namespace raysteer::host::report
