#include "hal/base/nearest.hpp"

#include <algorithm>
#include <vector>

namespace raysteer {

int edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the usual table: a swap of neighbours looks two rows back.
  std::vector<int> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = static_cast<int>(j);
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  int fewest = std::max(2, static_cast<int>(word.size()) / 3) + 1;
  for (const std::string_view candidate : known) {
    const int edits = edit_distance(word, candidate);
    if (edits < fewest && edits < static_cast<int>(std::max(word.size(), candidate.size()))) {
      fewest = edits;
      best = candidate;
    }
  }
  if (best.empty()) {  // the right quantity in a wrong unit: mirror_deg for mirror_mrad
    const auto quantity = [](std::string_view name) { return name.substr(0, name.rfind('_') + 1); };
    for (const std::string_view candidate : known) {
      if (!quantity(word).empty() && quantity(candidate) == quantity(word)) {
        return candidate;
      }
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> known) {
  const std::string_view near = nearest(word, known);
  return near.empty() ? std::string() : "; did you mean '" + std::string(near) + "'?";
}

}  // namespace raysteer
