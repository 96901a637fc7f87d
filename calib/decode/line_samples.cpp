#include "calib/decode/line_samples.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace raysteer::calib::decode {
namespace {

constexpr int kMostLines = 96;
/// Columns are taken some together, which share cache lines; rows one by one.
constexpr int kColumnsTogether = 32;

}  // namespace

template <class T>
LineSamples<T>::LineSamples(Axis axis, int width, int height)
    : axis_(axis),
      length_(axis == Axis::kX ? width : height),
      breadth_(axis == Axis::kX ? height : width),
      count_(std::min(kMostLines, breadth_)),
      sums_(length_, count_) {
  sums_.clear_rows(0, count_);
}

template <class T>
int LineSamples<T>::place(int line) const {
  const int together = axis_ == Axis::kX ? 1 : kColumnsTogether;
  const int groups = (count_ + together - 1) / together;
  const int group = line / together;
  return std::min(static_cast<int>((group + 0.5) * breadth_ / groups) - together / 2 + line % together, breadth_ - 1);
}

template <class T>
void LineSamples<T>::add(const BitRole& role, ImageView<const T> p, ImageView<const T> q) {
  if (axis_ == Axis::kX) {
    for (int line = 0; line < count_; ++line) {
      fold(role, p.row(place(line)), q.row(place(line)), length_, sums_.row(line));
    }
    return;
  }
  p_.resize(static_cast<std::size_t>(length_) * kColumnsTogether);
  q_.resize(p_.size());
  for (int first = 0; first < count_; first += kColumnsTogether) {
    const int together = std::min(kColumnsTogether, count_ - first);
    const int column = place(first);
    for (int v = 0; v < length_; ++v) {
      const T* p_row = p.row(v);
      const T* q_row = q.row(v);
      for (int k = 0; k < together; ++k) {
        const int u = std::min(column + k, breadth_ - 1);
        const std::size_t at =
            static_cast<std::size_t>(k) * static_cast<std::size_t>(length_) + static_cast<std::size_t>(v);
        p_[at] = p_row[u];
        q_[at] = q_row[u];
      }
    }
    for (int k = 0; k < together; ++k) {
      const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(k) * length_;
      fold(role, p_.data() + start, q_.data() + start, length_, sums_.row(first + k));
    }
  }
}

template <class T>
BorderTable LineSamples<T>::learn(GrayLimits limits) const {
  limits.width = length_;
  return learn_borders(sums_, count_, limits);
}

template class LineSamples<std::uint8_t>;
template class LineSamples<std::uint16_t>;

}  // namespace raysteer::calib::decode
