// bm_decode: a Gray sequence of 46 frames, 2048 x 1500, in memory, one thread: ours, OpenCV's, and reading it once.
//
// Frames are rendered from a seed: a wall that fills three quarters of the image, blurred, with noise, and shadow
// beside it. With RAYSTEER_BENCH_RAW naming a file of 46 raw frames, one after the other, those are decoded instead.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <opencv2/structured_light.hpp>
#include <vector>

#include "calib/decode/decoder.hpp"
#include "calib/synth/noise.hpp"

namespace {

using namespace raysteer;
using namespace raysteer::calib;

constexpr int kWidth = 2048;
constexpr int kHeight = 1500;
constexpr std::uint64_t kSeed = 20240601;

PatternSequence sequence() {
  return {.panel_width = 1920,
          .panel_height = 1080,
          .blocks = {{.kind = PatternKind::kGray, .axis = Axis::kX, .bits = 11, .inverse = true},
                     {.kind = PatternKind::kGray, .axis = Axis::kY, .bits = 11, .inverse = true},
                     {.kind = PatternKind::kWhite},
                     {.kind = PatternKind::kBlack}}};
}

/// A pattern along one axis, blurred by 1 px, at 16 places a pixel.
std::vector<float> blurred(const Pattern& pattern, int panel) {
  constexpr int kFine = 16;
  std::vector<float> line(static_cast<std::size_t>(panel * kFine));
  const bool along_x = pattern.block.axis == Axis::kX;
  for (int i = 0; i < panel * kFine; ++i) {
    const double place = (i + 0.5) / kFine - 0.5;
    double sum = 0, weights = 0;
    for (int k = -4; k <= 4; ++k) {
      const int pixel = static_cast<int>(std::lround(place)) + k;
      if (pixel >= 0 && pixel < panel) {
        const double weight = std::exp(-0.5 * (pixel - place) * (pixel - place));
        sum += weight * (along_x ? pattern.value(pixel, 0) : pattern.value(0, pixel));
        weights += weight;
      }
    }
    line[static_cast<std::size_t>(i)] = static_cast<float>(sum / weights);
  }
  return line;
}

struct Frames {
  std::vector<std::vector<std::uint8_t>> pixels;
  std::vector<ImageView<const std::uint8_t>> views;

  Frames() {
    const std::vector<Pattern> patterns = sequence().patterns();
    pixels.resize(patterns.size());
    if (const char* raw = std::getenv("RAYSTEER_BENCH_RAW")) {
      std::ifstream file(raw, std::ios::binary);
      for (std::vector<std::uint8_t>& frame : pixels) {
        frame.resize(kWidth * kHeight);
        file.read(reinterpret_cast<char*>(frame.data()), static_cast<std::streamsize>(frame.size()));
      }
    } else {
      for (std::size_t i = 0; i < patterns.size(); ++i) {
        render(patterns[i], i);
      }
    }
    for (const std::vector<std::uint8_t>& frame : pixels) {
      views.emplace_back(frame.data(), kWidth, kHeight);
    }
  }

  void render(const Pattern& pattern, std::size_t index) {
    const bool coded = pattern.block.kind == PatternKind::kGray;
    const bool along_x = pattern.block.axis == Axis::kX;
    const int panel = along_x ? 1920 : 1080;
    const std::vector<float> line = coded ? blurred(pattern, panel) : std::vector<float>();
    std::vector<std::uint8_t>& frame = pixels[index];
    frame.resize(kWidth * kHeight);
    synth::Noise noise(kSeed, index);
    std::vector<float> grain(1U << 16U);
    for (float& value : grain) {
      value = static_cast<float>(1.5 * noise.normal());
    }
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        // A wall turned a little, so that codes are slanted; the left quarter is out of reach.
        const double place = along_x ? 20 + 0.9 * u + 0.03 * v : 12 + 0.68 * v + 0.02 * u;
        float light = pattern.block.kind == PatternKind::kBlack ? 0.0F : 1.0F;
        if (coded) {
          const double at = (place + 0.5) * 16;
          light = at >= 0 && at < panel * 16 ? line[static_cast<std::size_t>(at)] : 0;
        }
        const float albedo = u < kWidth / 4 ? 0.0F : 150.0F + 40.0F * std::sin(0.01F * static_cast<float>(u + v));
        const float value = 12 + albedo * light + grain[noise.bits() & 0xffffU];
        frame[static_cast<std::size_t>(v) * kWidth + u] =
            static_cast<std::uint8_t>(std::fmin(std::fmax(value + 0.5F, 0.0F), 255.0F));
      }
    }
  }
};

const Frames& frames() {
  static const Frames all;
  return all;
}

void decode_all(benchmark::State& state, bool sub_pixel) {
  const Frames& input = frames();
  const PatternSequence patterns = sequence();
  double valid = 0;
  decode::CodeMap kept;  // as for look after look of one camera
  for (auto _ : state) {
    Result<decode::CodeMap> map = decode::decode(patterns, input.views, {.sub_pixel = sub_pixel}, std::move(kept));
    if (!map) {
      state.SkipWithError("not decoded");
      return;
    }
    valid = static_cast<double>(map->diagnostics.valid) / static_cast<double>(map->diagnostics.pixels);
    kept = *std::move(map);
    benchmark::DoNotOptimize(kept.mask.data());
  }
  state.counters["valid"] = valid;
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}

void bm_decode_codes(benchmark::State& state) { decode_all(state, false); }
void bm_decode_sub_pixel(benchmark::State& state) { decode_all(state, true); }

/// The same frames pushed one by one.
void bm_decode_streamed(benchmark::State& state) {
  const Frames& input = frames();
  for (auto _ : state) {
    Result<decode::Decoder> decoder = decode::Decoder::make(sequence(), kWidth, kHeight);
    for (const ImageView<const std::uint8_t>& view : input.views) {
      if (!decoder->push(view)) {
        state.SkipWithError("not pushed");
      }
    }
    const Result<decode::CodeMap> map = decoder->finish();
    benchmark::DoNotOptimize(map->mask.data());
  }
}

void bm_read_once(benchmark::State& state) {
  const Frames& input = frames();
  for (auto _ : state) {
    std::uint64_t sum = 0;
    for (const std::vector<std::uint8_t>& frame : input.pixels) {
      sum = std::accumulate(frame.begin(), frame.end(), sum);
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetBytesProcessed(state.iterations() * 46 * std::int64_t{kWidth} * kHeight);
}

void bm_opencv_get_proj_pixel(benchmark::State& state) {
  const Frames& input = frames();
  cv::setNumThreads(1);
  std::vector<cv::Mat> images;
  for (const ImageView<const std::uint8_t>& view : input.views) {
    images.emplace_back(kHeight, kWidth, CV_8UC1, const_cast<std::uint8_t*>(view.data()));
  }
  const std::vector<cv::Mat> coded(images.begin(), images.begin() + 44);
  const auto pattern = cv::structured_light::GrayCodePattern::create(1920, 1080);
  pattern->setWhiteThreshold(5);
  for (auto _ : state) {
    // Shadow mask as OpenCV's own decode makes it: white and black further apart than 20.
    cv::Mat difference, shadow;
    cv::subtract(images[44], images[45], difference);
    cv::threshold(difference, shadow, 20, 255, cv::THRESH_BINARY);
    std::size_t decoded = 0;
    cv::Mat map(kHeight, kWidth, CV_16SC2);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        cv::Point place;
        if (shadow.at<std::uint8_t>(v, u) != 0 && !pattern->getProjPixel(coded, u, v, place)) {
          map.at<cv::Vec2s>(v, u) = {static_cast<short>(place.x), static_cast<short>(place.y)};
          ++decoded;
        }
      }
    }
    benchmark::DoNotOptimize(decoded);
    state.counters["valid"] = static_cast<double>(decoded) / (kWidth * kHeight);
  }
}

BENCHMARK(bm_read_once)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_decode_codes)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_decode_sub_pixel)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_decode_streamed)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_opencv_get_proj_pixel)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
