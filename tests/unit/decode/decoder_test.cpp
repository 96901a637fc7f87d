#include "calib/decode/decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/synth/separable.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 90;

PatternSequence both_axes() {
  return {.panel_width = 128,
          .panel_height = 64,
          .blocks = {{.kind = PatternKind::kGray, .axis = Axis::kX, .bits = 7, .inverse = true},
                     {.kind = PatternKind::kGray, .axis = Axis::kY, .bits = 6, .inverse = true},
                     {.kind = PatternKind::kWhite},
                     {.kind = PatternKind::kBlack}}};
}

synth::SeparableView small_view() {
  synth::SeparableView view;
  view.width = kWidth;
  view.height = kHeight;
  view.dx = 0.9;
  view.x0 = 4.3;
  view.dy = 0.6;
  view.y0 = 3.2;
  view.blur_px = 0.8;
  return view;
}

struct Frames {
  PatternSequence sequence;
  synth::SeparableView view = small_view();
  std::vector<Image<std::uint8_t>> images;

  explicit Frames(PatternSequence of = both_axes()) : sequence(std::move(of)) {
    const synth::SeparableCamera camera(view, sequence);
    synth::Noise noise(7);
    for (const Pattern& pattern : sequence.patterns()) {
      images.push_back(camera.frame8(pattern, noise));
    }
  }
  Result<CodeMap> push_all(const Options& options = {}) const {
    Result<Decoder> decoder = Decoder::make(sequence, kWidth, kHeight, 8, options);
    if (!decoder) {
      return std::move(decoder).error();
    }
    for (const Image<std::uint8_t>& image : images) {
      RAYSTEER_TRY(decoder->push(image.view()));
    }
    return decoder->finish();
  }
  Result<CodeMap> all_at_once(const Options& options = {}) const {
    std::vector<ImageView<const std::uint8_t>> views;
    for (const Image<std::uint8_t>& image : images) {
      views.push_back(image.view());
    }
    return decode(sequence, views, options);
  }
};

TEST(Decoder, both_axes_lie_where_the_camera_looks) {
  const Frames frames;
  const Result<CodeMap> map = frames.push_all();
  ASSERT_TRUE(map) << map.error().message();
  const synth::SeparableCamera camera(frames.view, frames.sequence);
  EXPECT_EQ(map->diagnostics.valid, map->diagnostics.pixels);
  for (int v = 8; v < kHeight - 8; ++v) {
    for (int u = 8; u < kWidth - 8; ++u) {
      ASSERT_NEAR(map->x(u, v), camera.x(u), 0.35) << u << " " << v;
      ASSERT_NEAR(map->y(u, v), camera.y(v), 0.35) << u << " " << v;
    }
  }
}

TEST(Decoder, frames_in_memory_decode_as_pushed_ones_do) {
  const Frames frames;
  const Result<CodeMap> pushed = frames.push_all();
  const Result<CodeMap> at_once = frames.all_at_once();
  ASSERT_TRUE(pushed && at_once);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      ASSERT_EQ(pushed->mask(u, v), at_once->mask(u, v)) << u << " " << v;
      ASSERT_EQ(pushed->code_x(u, v), at_once->code_x(u, v));
      ASSERT_EQ(pushed->code_y(u, v), at_once->code_y(u, v));
      ASSERT_EQ(pushed->x(u, v), at_once->x(u, v)) << u << " " << v;
      ASSERT_EQ(pushed->y(u, v), at_once->y(u, v)) << u << " " << v;
      ASSERT_EQ(pushed->variance_y(u, v), at_once->variance_y(u, v));
    }
  }
}

TEST(Decoder, codes_only_are_the_codes_of_the_full_result) {
  const Frames frames;
  const Result<CodeMap> full = frames.all_at_once();
  const Result<CodeMap> codes = frames.all_at_once({.sub_pixel = false});
  ASSERT_TRUE(full && codes);
  EXPECT_TRUE(codes->x.empty());
  EXPECT_TRUE(codes->variance_y.empty());
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      ASSERT_EQ(full->code_x(u, v), codes->code_x(u, v));
      ASSERT_EQ(full->mask(u, v), codes->mask(u, v));
    }
  }
}

TEST(Decoder, decodes_a_second_look_like_the_first) {
  const Frames frames;
  Result<Decoder> decoder = Decoder::make(frames.sequence, kWidth, kHeight);
  ASSERT_TRUE(decoder);
  std::size_t valid = 0;
  for (int look = 0; look < 2; ++look) {
    for (const Image<std::uint8_t>& image : frames.images) {
      ASSERT_TRUE(decoder->push(image.view()));
    }
    const Result<CodeMap> map = decoder->finish();
    ASSERT_TRUE(map);
    EXPECT_TRUE(look == 0 || map->diagnostics.valid == valid);
    valid = map->diagnostics.valid;
  }
}

TEST(Decoder, white_and_black_may_come_last_where_they_threshold) {
  PatternSequence late{.panel_width = 128,
                       .panel_height = 64,
                       .blocks = {{.kind = PatternKind::kGray, .axis = Axis::kX, .bits = 7},
                                  {.kind = PatternKind::kWhite},
                                  {.kind = PatternKind::kBlack}}};
  const Frames frames(late);
  const Result<CodeMap> map = frames.push_all();
  ASSERT_TRUE(map) << map.error().message();
  const synth::SeparableCamera camera(frames.view, late);
  for (int u = 8; u < kWidth - 8; ++u) {
    EXPECT_NEAR(map->x(u, 20), camera.x(u), 0.35);
  }
}

TEST(Decoder, names_why_a_pixel_has_no_coordinate) {
  Frames frames;
  const std::size_t last = frames.images.size();
  for (std::size_t i = 0; i < last; ++i) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < 20; ++u) {
        frames.images[i](u, v) = 6;  // the projector does not reach these
        frames.images[i](kWidth - 1 - u, v) = 255;
      }
    }
  }
  const Result<CodeMap> map = frames.push_all();
  ASSERT_TRUE(map) << map.error().message();
  EXPECT_TRUE(map->mask(5, 40) & kShadow);
  EXPECT_TRUE(map->mask(5, 40) & kLowModulation);
  EXPECT_FALSE(map->mask(5, 40) & kSaturated);
  EXPECT_TRUE(map->mask(kWidth - 5, 40) & kSaturated);
  EXPECT_TRUE(std::isnan(map->x(5, 40)));
  EXPECT_EQ(map->code_x(5, 40), CodeMap::kNoCode);
  EXPECT_EQ(map->mask(60, 40), kValid);
}

TEST(Decoder, a_pixel_that_disagrees_with_all_around_it_is_an_edge) {
  Frames frames;
  // Bits 3 of x inverted at one pixel: a clean code, 15 columns away.
  const std::vector<Pattern> patterns = frames.sequence.patterns();
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    if (patterns[i].block.kind == PatternKind::kGray && patterns[i].block.axis == Axis::kX && patterns[i].bit == 4 &&
        !patterns[i].inverted) {
      std::swap(frames.images[i](60, 40), frames.images[i + 1](60, 40));
    }
  }
  const Result<CodeMap> map = frames.push_all();
  ASSERT_TRUE(map);
  EXPECT_NE(map->mask(60, 40), kValid);
  EXPECT_EQ(map->mask(63, 40), kValid);
}

TEST(Decoder, refuses_too_many_frames_and_too_few) {
  const Frames frames;
  Result<Decoder> decoder = Decoder::make(frames.sequence, kWidth, kHeight);
  ASSERT_TRUE(decoder);
  for (const Image<std::uint8_t>& image : frames.images) {
    ASSERT_TRUE(decoder->push(image.view()));
  }
  EXPECT_EQ(decoder->push(frames.images[0].view()).error().rcode, RCode::kFrameCount);
  Result<Decoder> hungry = Decoder::make(frames.sequence, kWidth, kHeight);
  ASSERT_TRUE(hungry);
  ASSERT_TRUE(hungry->push(frames.images[0].view()));
  EXPECT_EQ(hungry->finish().error().rcode, RCode::kFrameCount);
}

TEST(Decoder, refuses_frames_of_another_size_or_depth) {
  Result<Decoder> decoder = Decoder::make(both_axes(), kWidth, kHeight);
  ASSERT_TRUE(decoder);
  const Image<std::uint8_t> other(kWidth, kHeight + 1);
  EXPECT_EQ(decoder->push(other.view()).error().rcode, RCode::kFrameSize);
  const Image<std::uint16_t> deep(kWidth, kHeight);
  EXPECT_EQ(decoder->push(deep.view()).error().rcode, RCode::kFrameDepth);
  EXPECT_EQ(Decoder::make(both_axes(), 0, kHeight).error().rcode, RCode::kFrameSize);
  EXPECT_EQ(Decoder::make(both_axes(), kWidth, kHeight, 7).error().rcode, RCode::kFrameDepth);
}

TEST(Decoder, refuses_sequences_that_code_nothing_or_too_little) {
  const auto refuses = [](std::vector<PatternBlock> blocks) {
    const PatternSequence sequence{.panel_width = 128, .panel_height = 64, .blocks = std::move(blocks)};
    const Result<Decoder> decoder = Decoder::make(sequence, kWidth, kHeight);
    return !decoder && decoder.error().rcode == RCode::kBadSequence;
  };
  EXPECT_TRUE(refuses({{.kind = PatternKind::kWhite}})) << "nothing is coded";
  EXPECT_TRUE(refuses({{.kind = PatternKind::kGray, .bits = 6, .inverse = true}})) << "64 codes for 128 columns";
  EXPECT_TRUE(refuses({{.kind = PatternKind::kGray, .bits = 7}})) << "nothing to threshold by";
  EXPECT_TRUE(refuses({{.kind = PatternKind::kPhase, .steps = 8, .period_px = 16}})) << "nothing orders the periods";
  EXPECT_TRUE(refuses({{.kind = PatternKind::kPhase, .steps = 8, .period_px = 16},
                       {.kind = PatternKind::kPhase, .steps = 8, .period_px = 32}}))
      << "a beat of 32 px";
  EXPECT_TRUE(refuses({{.kind = PatternKind::kGray, .bits = 4, .stripe_px = 16, .inverse = true},
                       {.kind = PatternKind::kPhase, .steps = 8, .period_px = 16}}))
      << "stripes of a whole period";
}

TEST(Decoder, black_and_saturated_frames_are_no_result) {
  const PatternSequence sequence = both_axes();
  for (const auto& [level, rcode] :
       {std::pair{std::uint8_t{0}, RCode::kNothingDecoded}, std::pair{std::uint8_t{255}, RCode::kFramesSaturated}}) {
    Image<std::uint8_t> image(kWidth, kHeight);
    image.fill(level);
    const std::vector<ImageView<const std::uint8_t>> views(static_cast<std::size_t>(sequence.frames()), image.view());
    const Result<CodeMap> map = decode(sequence, views);
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().rcode, rcode);
  }
}

}  // namespace
}  // namespace raysteer::calib::decode
