#include "calib/bake/lut_set.hpp"

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"
#include "tests/support/steered_rig.hpp"
#include "tests/unit/bake/baked.hpp"

namespace raysteer::calib::bake {
namespace {

LutSetRequest request(std::mt19937_64& random) {
  LutSetRequest request;
  request.calibration_id = "pretended";
  request.board_id = "mock-small";
  request.steering.T_rig_plane = support::floor_pose(random);
  request.steering.T_frame_plane = request.steering.T_rig_plane;
  request.steering.bound_m = 2e-3;
  request.keep_out = {{.name = "seat", .corners = {{0, 0}, {0.3, 0}, {0, 0.3}}}};
  for (int i = 0; i < 4; ++i) {
    request.stations.push_back(support::station_at("station " + std::to_string(i), request.steering.T_rig_plane,
                                                   0.6 * i - 0.9, 0.2 * i, 0.7 * i));
    request.stations.back().tolerance_mm = 1.5;
  }
  return request;
}

TEST(LutSet, is_the_same_bytes_with_any_number_of_threads_and_reads_back_as_it_was) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small", random);
  LutSetRequest asked = request(random);
  const RayCaster scene = valid(RayCaster::make(
      height_field(asked.steering.T_rig_plane * model::Pose{.t = {-1, -1, 0}}, 0.5, Image<double>(5, 5).view())));
  asked.scene = &scene;
  asked.further.push_back({.content = draped_content(asked.stations[1]), .command_rad = {0.01, 0.02}});
  asked.further.back().content.name = "draped";
  std::vector<std::uint8_t> first;
  for (const int threads : {1, 2, 5}) {
    asked.threads = threads;
    const proto::lut::LutSet set = valid(bake_lut_set(rig.projector, asked));
    const auto bytes = valid(write_lut_set(set));
    if (first.empty()) {
      first = bytes;
      EXPECT_EQ(valid(proto::lut::read_lut_set(bytes)), set);
      ASSERT_EQ(set.maps.size(), 5U);
      EXPECT_EQ(set.maps[2].parts().name, "station 2");
      EXPECT_EQ(set.maps[4].parts().name, "draped");
      EXPECT_NEAR(set.maps[0].parts().tolerance_m, 0.0015, 1e-12);
      EXPECT_NEAR(set.maps[0].parts().metres_per_px, 0.000625, 1e-12);
    }
    EXPECT_EQ(bytes, first) << threads << " threads";
  }
}

TEST(LutSet, names_the_station_that_cannot_be) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small", random);
  const auto error_of = [&](const auto& change) {
    std::mt19937_64 again(1);
    LutSetRequest asked = request(again);
    change(asked);
    const auto set = bake_lut_set(rig.projector, asked);
    return set ? fail(RCode::kNone) : set.error();
  };
  const Error far = error_of([](LutSetRequest& asked) { asked.stations[2].T_rig_plane.t.x() = 9; });
  EXPECT_EQ(far.rcode, RCode::kStationOutOfReach);
  EXPECT_NE(far.note.find("'station 2'"), std::string::npos);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].name = "station 1"; }).rcode, RCode::kTableDamaged);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].name.clear(); }).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].size_m.x() = 0; }).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].content_px.x() = 20000; }).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].T_rig_plane.t.x() = std::nan(""); }).rcode,
            RCode::kNotFinite);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.stations[2].command_rad = Eigen::Vector2d(std::nan(""), 0); }).rcode,
            RCode::kNotFinite);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.keep_out[0].corners.pop_back(); }).rcode, RCode::kTableDamaged);
  EXPECT_EQ(error_of([](LutSetRequest& a) {
              a.further.push_back({.content = draped_content(a.stations[0]), .command_rad = {0, 0}});
            }).rcode,
            RCode::kBadValue);
  EXPECT_EQ(error_of([](LutSetRequest& a) { a.warp.boost = 0.5; }).rcode, RCode::kBadValue);
}

}  // namespace
}  // namespace raysteer::calib::bake
