// bound to the caller's thread: the decoder for one type of pixel. See decoder.hpp for what it promises.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "calib/decode/decoder.hpp"
#include "calib/decode/depth_edges.hpp"
#include "calib/decode/gray_axis.hpp"
#include "calib/decode/gray_sums.hpp"
#include "calib/decode/line_samples.hpp"
#include "calib/decode/neighbours.hpp"
#include "calib/decode/noise.hpp"
#include "calib/decode/noise_samples.hpp"
#include "calib/decode/phase_rows.hpp"
#include "calib/decode/plan.hpp"

namespace raysteer::calib::decode {

template <class T>
class Engine {
 public:
  Engine(Plan plan, int width, int height, int bits, const Options& options);

  Status push(ImageView<const T> frame);
  Result<CodeMap> finish(CodeMap reused);
  /// All frames at once, a few rows at a time. Only Gray patterns with inverse, white and black.
  Result<CodeMap> decode(std::span<const ImageView<const T>> frames, CodeMap reused);

 private:
  struct GrayState {
    std::vector<BitRole> roles;  ///< by bit
    GrayStore<T> store;
    LineSamples<T> lines;
    NoiseSamples noise;
  };

  struct Pair {
    Axis axis;
    int bit;
    ImageView<const T> p;
    ImageView<const T> q;
  };
  using Placers = std::vector<std::pair<Axis, GrayAxis<T>>>;

  Status check_frame(ImageView<const T> frame, int index) const;
  void start(Axis axis, int rows);
  void restart();
  GrayState& gray(Axis axis) { return axis == Axis::kX ? gray_x_ : gray_y_; }
  void fold_frame(Axis axis, int bit, ImageView<const T> p, ImageView<const T> q);
  void fold_threshold(const Pattern& pattern, ImageView<const T> frame);
  void fold_waiting();
  bool threshold_known(const Pattern& pattern) const;
  /// Borders place the pixels of an axis unless phases do.
  bool places_borders(const AxisPlan& axis) const { return options_.sub_pixel && axis.phases.empty(); }
  void sample(Axis axis, const BitRole& role, ImageView<const T> p, ImageView<const T> q);
  void sample_phase_noise(const PhaseSums& sums);
  GrayLimits limits(const AxisPlan& axis) const;
  BorderTable learn(Axis axis);
  template <class Pixel>
  void ensure(Image<Pixel>& image, bool wanted) const;
  CodeMap make_map(CodeMap reused) const;
  void fit_noise();
  Placers make_placers(CodeMap& map);
  T inverse_of(T pattern, int sum) const;
  Placed place_phases(Axis which, CodeMap& map);
  Resemblance resemblance() const;
  Result<CodeMap> complete(CodeMap map, const RowCheck& rows) const;
  double dn(double of_255) const { return of_255 * full_scale_ / 255; }

  Plan plan_;
  int width_, height_;
  Options options_;
  double full_scale_;
  int next_ = 0;
  NoiseEstimate estimate_;
  NoiseModel noise_;
  double harmonics_ = 0;  ///< residual of a usual pixel by its modulation squared: gamma

  GrayState gray_x_, gray_y_;
  std::vector<PhaseSums> phases_;
  std::vector<int> phase_steps_;  ///< steps seen, by phase
  Image<T> white_, black_;
  bool white_seen_ = false;
  bool black_seen_ = false;
  Image<T> held_;                                      ///< the first of a pattern and its inverse
  std::vector<std::pair<Pattern, Image<T>>> waiting_;  ///< patterns whose threshold is not known yet
};

}  // namespace raysteer::calib::decode
