// Each decoder against rendered views of known truth (algorithms 2.3 and 2.7). bench/campaign_decode is the long form.
#include <gtest/gtest.h>

#include <cmath>

#include "calib/synth/decode_trial.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr int kPanel = 1920;

synth::SeparableView view(double electrons, int rows = 8) {
  synth::SeparableView view;
  view.width = 600;
  view.height = rows;
  view.x0 = 500.2;
  view.white_electrons = electrons;
  return view;
}

void expect_honest(const synth::DecodeTrial& trial) {
  // Algorithms 2.7: predicted sigma and observed scatter agree within 0.8 to 1.25.
  EXPECT_GT(trial.predicted_px / trial.rms_px, 0.8);
  EXPECT_LT(trial.predicted_px / trial.rms_px, 1.25);
  EXPECT_EQ(trial.gross, 0);
  EXPECT_GT(trial.valid, 0.98);
}

TEST(Decoder, gray_with_inverse_is_sub_pixel_and_knows_how_much) {
  const auto trial = synth::decode_trial(synth::gray_sequence(kPanel, true), view(7000), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_LT(trial->rms_px, 0.05);
  EXPECT_GT(trial->rms_px, 0.01);
  EXPECT_NEAR(trial->integer_rms_px, 0.29, 0.03) << "integer codes scatter by 1 / sqrt(12)";
}

TEST(Decoder, gray_thresholded_by_white_and_black_is_sub_pixel) {
  const auto trial = synth::decode_trial(synth::gray_sequence(kPanel, false), view(7000), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_LT(trial->rms_px, 0.07);
}

TEST(Decoder, default_set_reaches_0_03_px_in_good_light) {
  const auto trial =
      synth::decode_trial(synth::gray_phase_sequence(kPanel, true, 8, 16), view(7000), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_NEAR(trial->rms_px, 0.027, 0.005);
}

TEST(Decoder, default_set_reaches_0_06_px_in_poor_light) {
  const auto trial =
      synth::decode_trial(synth::gray_phase_sequence(kPanel, true, 8, 16), view(1500), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_NEAR(trial->rms_px, 0.057, 0.008);
}

TEST(Decoder, fast_set_thresholds_by_the_mean_of_the_phase) {
  const auto trial =
      synth::decode_trial(synth::gray_phase_sequence(kPanel, false, 4, 16), view(7000), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_NEAR(trial->rms_px, 0.038, 0.007);
}

TEST(Decoder, beat_of_two_periods_orders_them) {
  const auto trial = synth::decode_trial(synth::heterodyne_sequence(kPanel, 8, kPanel / 40.0, kPanel / 41.0),
                                         view(7000), {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  expect_honest(*trial);
  EXPECT_LT(trial->order_residual, 0.1);
}

TEST(Decoder, sixteen_bits_decode_like_eight) {
  synth::SeparableView wide = view(7000);
  wide.bits = 12;
  wide.white_dn = 3200;
  wide.ambient_dn = 80;
  wide.read_sigma_dn = 8;
  for (const PatternSequence& sequence :
       {synth::gray_sequence(kPanel, true), synth::gray_phase_sequence(kPanel, true, 8, 16)}) {
    const auto trial = synth::decode_trial(sequence, wide, {}, support::seed());
    ASSERT_TRUE(trial) << trial.error().message();
    expect_honest(*trial);
    EXPECT_LT(trial->rms_px, 0.05);
  }
}

TEST(Decoder, light_that_bounced_does_not_flip_codes) {
  synth::SeparableView bounced = view(7000);
  bounced.interreflection = 0.4;
  const auto trial = synth::decode_trial(synth::gray_phase_sequence(kPanel, true, 8, 16), bounced, {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  EXPECT_EQ(trial->gross, 0);
  EXPECT_LT(trial->rms_px, 0.1);
  EXPECT_GT(trial->valid, 0.95);
}

TEST(Decoder, a_scaled_panel_is_found_out_and_measured) {
  // 1920 columns shown on 1280: of three columns the second is never seen.
  const PatternSequence sequence = synth::gray_sequence(kPanel, true);
  synth::SeparableView seen = view(7000, 64);
  seen.dx = 0.8;
  seen.blur_px = 0.8;
  seen.dropped_column = 1;
  seen.dropped_of = 3;
  const auto trial = synth::decode_trial(sequence, seen, {}, support::seed());
  ASSERT_TRUE(trial) << trial.error().message();
  EXPECT_GT(trial->border_displacement, 0.2);
  EXPECT_LT(trial->scatter_px, 0.22) << "about a smooth surface; 0.45 with borders where they should be";
}

}  // namespace
}  // namespace raysteer::calib::decode
