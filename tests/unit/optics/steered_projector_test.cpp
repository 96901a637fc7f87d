// calib/model's steered projector against closed forms and against the pretend rig's optics, which are written apart.
#include "calib/model/steered_projector.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/optics/light_path.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/optics/boards.hpp"

namespace raysteer::sim::optics {
namespace {

using calib::model::MirrorKind;
using calib::model::SteeredProjector;

SteeredProjector model_of(const TrueRig& rig) {
  SteeredProjector model;
  const LensNumbers& lens = rig.projector.lens.numbers();
  model.lens = {.width = rig.projector.width,
                .height = rig.projector.height,
                .fx = lens.focal_px.x(),
                .fy = lens.focal_px.y(),
                .cx = lens.centre_px.x(),
                .cy = lens.centre_px.y(),
                .k = {lens.distortion[0], lens.distortion[1], lens.distortion[2], lens.distortion[3]}};
  model.T_projector_rig = {Eigen::Quaterniond(rig.projector.T_projector_rig.linear()),
                           rig.projector.T_projector_rig.translation()};
  model.kind = rig.mirror.head ? MirrorKind::kHead : MirrorKind::kGalvoPair;
  for (std::size_t k = 0; k < 2; ++k) {
    const MirrorPart& part = rig.mirror.parts[k];
    model.parts[k] = {.axis = part.axis, .point = part.point, .normal = part.normal, .offset_m = part.offset_m};
  }
  model.outer_axis = rig.mirror.outer_axis;
  model.outer_point = rig.mirror.outer_point;
  return model;
}

/// No number of it special, so that a forgotten term shows.
TrueRig askew(TrueRig rig, std::mt19937_64& random) {
  const auto some = [&](double sigma) -> Eigen::Vector3d {
    std::normal_distribution<double> normal(0, sigma);
    return {normal(random), normal(random), normal(random)};
  };
  for (MirrorPart& part : rig.mirror.parts) {
    part.axis = (part.axis + some(0.05)).normalized();
    part.normal = (part.normal + some(0.05)).normalized();
    part.point += some(0.02);
    part.offset_m += some(0.01).x();
  }
  rig.mirror.outer_axis = (rig.mirror.outer_axis + some(0.05)).normalized();
  rig.mirror.outer_point += some(0.02);
  rig.projector.T_projector_rig.translate(some(0.1));
  rig.projector.T_projector_rig.rotate(Eigen::AngleAxisd(0.1, some(1).normalized()));
  return rig;
}

TEST(SteeredProjector, agrees_with_the_pretend_rigs_optics) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> share(-1, 1);
  for (const std::string name : {"mock-galvo", "mock-head"}) {
    for (int rig_count = 0; rig_count < 10; ++rig_count) {
      const TrueRig rig = askew(rig_named(name), random);
      const SteeredProjector model = model_of(rig);
      const auto range = board_named(name).mirror.most_rad;
      for (int k = 0; k < 50; ++k) {
        const Eigen::Vector2d angles(share(random) * range[0], share(random) * range[1]);
        const auto view = model.at_angles(angles);
        const LightPath path(rig, {Radians(angles.x()), Radians(angles.y())});
        ASSERT_LT((view.rotation - path.T_virtual_rig().linear()).norm(), 1e-12) << name;
        ASSERT_LT((view.translation - path.T_virtual_rig().translation()).norm(), 1e-12) << name;
        ASSERT_LT((view.centre() - path.centre()).norm(), 1e-12) << name;
        const auto out = path.leave({share(random) * 900 + 960, share(random) * 500 + 600});
        ASSERT_TRUE(out) << name;
        const Eigen::Vector3d p = out->origin + 3 * out->direction;
        const auto there = path.pixel(p);
        const auto here = view.project(p);
        ASSERT_TRUE(here && there) << name;
        ASSERT_LT((*here - *there).norm(), 1e-9) << name;
      }
    }
  }
}

TEST(SteeredProjector, one_mirror_flips_the_picture_and_two_do_not) {
  for (const auto& [name, handedness] : {std::pair{"mock-head", -1.0}, std::pair{"mock-galvo", 1.0}}) {
    const SteeredProjector model = model_of(rig_named(name));
    const auto view = model.at_angles({0.05, -0.04});
    EXPECT_NEAR(view.rotation.determinant(), handedness, 1e-12) << name;
    EXPECT_EQ(view.mirrored(), handedness < 0) << name;
    EXPECT_LT((view.rotation * view.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << name;
  }
}

// Two mirrors in the same plane undo each other: S S = 1.
TEST(SteeredProjector, reflecting_twice_in_one_plane_is_nothing) {
  SteeredProjector model = model_of(rig_named("mock-galvo"));
  model.parts[1] = model.parts[0];
  for (const double angle : {-0.2, 0.0, 0.1}) {
    const auto view = model.at_angles({angle, angle});
    EXPECT_LT((view.rotation - model.T_projector_rig.rotation()).norm(), 1e-12);
    EXPECT_LT((view.translation - model.T_projector_rig.t).norm(), 1e-12);
  }
}

// By hand: the lens in the rig's origin looks along z; one mirror at 45 degrees, 1 m ahead, folds its light towards -x:
// the plane x + z = 1, n = -(1, 0, 1)/sqrt 2. Its picture of the origin is (1, 0, 1). Turned by a about y, through the
// point (0, 0, 1), the mirror's picture of the origin turns by 2a about that point: (cos 2a, 0, 1 - sin 2a). A point
// 2 m away along -x from the fold, (-2, 0, 1), lies 3 m from (1, 0, 1), straight ahead: pixel (10, 20).
TEST(SteeredProjector, folds_light_as_worked_by_hand) {
  SteeredProjector model;
  model.lens = {.width = 400, .height = 300, .fx = 1000, .fy = 1000, .cx = 10, .cy = 20};
  model.kind = MirrorKind::kHead;
  model.parts[0] = {.axis = {0, 1, 0}, .point = {0, 0, 1}, .normal = Eigen::Vector3d(-1, 0, -1).normalized()};
  const auto rest = model.at_angles({0, 0});
  EXPECT_LT((rest.centre() - Eigen::Vector3d(1, 0, 1)).norm(), 1e-12);
  EXPECT_LT((*rest.project({-2, 0, 1}) - Eigen::Vector2d(10, 20)).norm(), 1e-9);
  // 0.3 m up there is 0.1 of the distance; 0.3 m further along z, the mirror turns into -x of the lens.
  EXPECT_LT((*rest.project({-2, 0.3, 1}) - Eigen::Vector2d(10, 120)).norm(), 1e-9);
  EXPECT_LT((*rest.project({-2, 0, 1.3}) - Eigen::Vector2d(-90, 20)).norm(), 1e-9);
  constexpr double kAngle = 0.1;
  const auto turned = model.at_angles({0, kAngle});
  const Eigen::Vector3d image(std::cos(2 * kAngle), 0, 1 - std::sin(2 * kAngle));
  EXPECT_LT((turned.centre() - image).norm(), 1e-12);
}

TEST(SteeredProjector, commands_become_angles_by_the_curve) {
  SteeredProjector model;
  model.curves[0] = {.half_range = 0.2, .gain = 0.02, .quadratic = 0.003, .cubic = -0.004, .cross_talk = 0.001};
  model.curves[1] = {.half_range = 0.4, .cross_talk = -0.002};
  // u = (0.5, -0.25)
  const Eigen::Vector2d angles = model.angles({0.1, -0.1});
  EXPECT_NEAR(angles.x(), 0.2 * (1.02 * 0.5 + 0.003 * 0.25 - 0.004 * 0.125 - 0.001 * 0.25), 1e-15);
  EXPECT_NEAR(angles.y(), 0.4 * (-0.25 - 0.002 * 0.5), 1e-15);
}

}  // namespace
}  // namespace raysteer::sim::optics
