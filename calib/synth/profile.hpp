// value: a pattern along its axis as the projector's lens blurs it, ready to be averaged over any footprint.
#pragma once

#include <cstddef>
#include <vector>

namespace raysteer::calib::synth {

/// Panel pixels are boxes of constant light, convolved with a Gaussian; dark outside the panel. Stored as nodes 1/16 px
/// apart, linear between them, with its first and second antiderivative, so that means are exact for that polyline.
class Profile {
 public:
  /// `pixels`: light of panel pixel 0, 1, ... `blur_px` >= kMinLampBlurPx.
  Profile(const std::vector<double>& pixels, double blur_px);

  /// Mean over the sum of two uniform variables of widths a and b (the shadow of a parallelogram) about `centre`.
  double mean(double centre, double a, double b) const;

 private:
  struct Node {
    double value, slope, first, second;  ///< slope to the next node; antiderivatives from the left end
  };
  double second(double x) const;
  double first(double x) const;
  /// The node at or left of x, and how far x is past it; ends continue as straight lines.
  std::size_t find(double x, double& past) const;

  std::vector<Node> nodes_;
  std::vector<int> flat_until_;  ///< index of the last node that has this node's value without interruption
  double start_ = 0;
};

}  // namespace raysteer::calib::synth
