#include "calib/target/discs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/pretend_look.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::target {
namespace {

/// What one eye sees of panel pictures on the floor: for each camera pixel its square on the panel, taken affine.
class Floor {
 public:
  Floor(const support::PretendLook& look, std::size_t eye) {
    const model::Camera& camera = look.input.sights[eye].camera;
    const model::Pose T_camera_plane = look.input.sights[eye].T_camera_rig * look.truth.T_rig_plane;
    corners_ = Image<Eigen::Vector2d>(camera.width + 1, camera.height + 1);
    for (int y = 0; y <= camera.height; ++y) {
      for (int x = 0; x <= camera.width; ++x) {
        const auto p = model::on_plane(camera, T_camera_plane, {x - 0.5, y - 0.5});
        corners_(x, y) = look.truth.panel.on_panel(*p).value_or(Eigen::Vector2d(-1e3, -1e3));
      }
    }
  }

  /// `shine` is the light of the panel (0 to 1) at a fractional panel pixel.
  template <class Shine>
  Image<std::uint8_t> frame(const Shine& shine, std::mt19937_64& random, double noise_dn, int samples = 6) const {
    std::normal_distribution<double> noise(0, noise_dn);
    Image<std::uint8_t> frame(corners_.width() - 1, corners_.height() - 1);
    for (int y = 0; y < frame.height(); ++y) {
      for (int x = 0; x < frame.width(); ++x) {
        const Eigen::Vector2d origin = corners_(x, y);
        const Eigen::Vector2d right = corners_(x + 1, y) - origin;
        const Eigen::Vector2d down = corners_(x, y + 1) - origin;
        double light = 0;
        for (int v = 0; v < samples; ++v) {
          for (int u = 0; u < samples; ++u) {
            light += shine(origin + (u + 0.5) / samples * right + (v + 0.5) / samples * down);
          }
        }
        // A floor with a print: the shares must not see it.
        const double albedo = 0.6 + 0.2 * std::sin(0.05 * x + 0.08 * y);
        const double grey = 12 + 180 * albedo * light / (samples * samples);
        frame(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey + noise(random)), 0L, 255L));
      }
    }
    return frame;
  }

 private:
  Image<Eigen::Vector2d> corners_;
};

struct Shots {
  Frame black, white;
  std::vector<Frame> pictures;
};

Shots shots(const support::PretendLook& look, std::mt19937_64& random, double noise_dn) {
  const DiscGrid& grid = look.input.grid;
  const Floor floor(look, 0);
  const auto inside = [](const Eigen::Vector2d& x) {
    return x.x() >= -0.5 && x.x() < 639.5 && x.y() >= -0.5 && x.y() < 399.5 ? 1.0 : 0.0;
  };
  Shots all;
  all.black = floor.frame([](const auto&) { return 0.0; }, random, noise_dn, 1);
  all.white = floor.frame(inside, random, noise_dn, 2);
  for (int index = 0; index < grid.pictures(); ++index) {
    const Image<std::uint8_t> panel = disc_picture(grid, 640, 400, index);
    // The first picture is measured, the others are only looked at.
    all.pictures.emplace_back(floor.frame(
        [&](const Eigen::Vector2d& x) {
          const int i = static_cast<int>(std::floor(x.x() + 0.5));
          const int j = static_cast<int>(std::floor(x.y() + 0.5));
          return panel.view().contains(i, j) ? panel(i, j) / 255.0 : 0.0;
        },
        random, noise_dn, index == 0 ? 6 : 1));
  }
  return all;
}

TEST(Discs, are_numbered_right_and_placed_within_a_twentieth_of_a_pixel_in_a_mirror_too) {
  for (const bool mirrored : {false, true}) {
    std::mt19937_64 random(support::seed());
    const support::PretendLook look = support::pretend_look(random, mirrored);
    const Shots all = shots(look, random, 1.0);
    const auto found = detect_discs(look.input.grid, all.black, all.white, all.pictures);
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_GE(static_cast<int>(found->size()), look.input.grid.discs() * 2 / 3);
    Eigen::Vector2d bias = Eigen::Vector2d::Zero();
    double squares = 0, chi_square = 0;
    for (const Disc& disc : *found) {
      const Eigen::Vector2d x = look.input.grid.centre(disc.id);
      // The middle of the light: the mean over the disc, each sample with its area in the camera.
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double area = 0;
      const double radius = look.input.grid.radius_px;
      for (double v = -radius; v <= radius; v += radius / 12) {
        for (double u = -radius; u <= radius; u += radius / 12) {
          if (std::hypot(u, v) <= 1.001 * radius) {
            const auto at = [&](double du, double dv) {
              return *support::seen(look, 0, *look.truth.panel.on_plane(x + Eigen::Vector2d(u + du, v + dv)));
            };
            const Eigen::Vector2d right = at(0.5, 0) - at(-0.5, 0);
            const Eigen::Vector2d down = at(0, 0.5) - at(0, -0.5);
            const double weight = std::abs(right.x() * down.y() - right.y() * down.x());
            sum += weight * at(0, 0);
            area += weight;
          }
        }
      }
      const Eigen::Vector2d miss = disc.q - sum / area;
      bias += miss / static_cast<double>(found->size());
      squares += miss.squaredNorm();
      chi_square += miss.squaredNorm() / (disc.sigma_px * disc.sigma_px);
      EXPECT_LT(miss.norm(), 0.15) << "disc " << disc.id;
    }
    const auto n = static_cast<double>(found->size());
    EXPECT_LT(bias.norm(), 0.05);
    EXPECT_LT(std::sqrt(squares / (2 * n)), 0.05);
    EXPECT_GT(chi_square / (2 * n), 0.3);
    EXPECT_LT(chi_square / (2 * n), 2.5);
  }
}

TEST(Discs, are_not_found_in_the_dark) {
  const DiscGrid grid = fill_panel(640, 400, 9);
  const Frame dark = Image<std::uint8_t>(64, 48);
  std::vector<Frame> pictures;
  for (int i = 0; i < grid.pictures(); ++i) {
    pictures.emplace_back(Image<std::uint8_t>(64, 48));
  }
  const auto found = detect_discs(grid, dark, dark, pictures);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().rcode, RCode::kFramesBlack);
}

TEST(Discs, are_not_found_where_only_the_white_panel_shows) {
  const DiscGrid grid = fill_panel(640, 400, 9);
  const Frame dark = Image<std::uint8_t>(64, 48);
  Image<std::uint8_t> lit(64, 48);
  lit.fill(200);
  std::vector<Frame> pictures;
  for (int i = 0; i < grid.pictures(); ++i) {
    pictures.emplace_back(Image<std::uint8_t>(64, 48));
  }
  const auto found = detect_discs(grid, dark, Frame(std::move(lit)), pictures);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().rcode, RCode::kDiscsNotFound);
}

TEST(Discs, need_all_their_frames_in_one_size_and_depth) {
  const DiscGrid grid = fill_panel(640, 400, 9);
  const Frame frame = Image<std::uint8_t>(64, 48);
  std::vector<Frame> pictures;
  EXPECT_EQ(detect_discs(grid, frame, frame, pictures).error().rcode, RCode::kFrameCount);
  for (int i = 0; i < grid.pictures(); ++i) {
    pictures.emplace_back(Image<std::uint8_t>(64, i == 3 ? 47 : 48));
  }
  EXPECT_EQ(detect_discs(grid, frame, frame, pictures).error().rcode, RCode::kFrameSize);
  pictures[3] = Image<std::uint16_t>(64, 48);
  EXPECT_EQ(detect_discs(grid, frame, frame, pictures).error().rcode, RCode::kFrameDepth);
}

TEST(DiscGrid, fills_the_panel_with_discs_apart_from_each_other_and_the_edge) {
  for (const auto& [width, height] : {std::pair(640, 400), std::pair(1280, 800), std::pair(1920, 1080)}) {
    const DiscGrid grid = fill_panel(width, height, 9);
    EXPECT_GE(grid.discs(), 40);
    EXPECT_GE(grid.pitch_px, 4 * grid.radius_px - 1e-9);
    EXPECT_GE(grid.left_px, grid.radius_px + 1);
    EXPECT_GE(grid.top_px, grid.radius_px + 1);
    EXPECT_LE(grid.centre(grid.discs() - 1).x() + grid.radius_px + 1, width - 1);
    EXPECT_LE(grid.centre(grid.discs() - 1).y() + grid.radius_px + 1, height - 1);
  }
}

}  // namespace
}  // namespace raysteer::calib::target
