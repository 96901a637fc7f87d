// A published protocol that does not trust the rig: discs thrown into a printed board's squares. Rendered.
#include <gtest/gtest.h>

#include "calib/bake/aim.hpp"
#include "host/exchange/rig_file.hpp"
#include "tests/support/circle_protocol.hpp"
#include "tests/support/technician.hpp"

namespace raysteer::support {
namespace {

TEST(Circles, fall_into_the_squares_of_a_printed_board) {
  Technician technician("mock-small");
  technician.calibrate();
  const auto rig = host::exchange::read_rig(technician.made("rig"));
  ASSERT_TRUE(rig) << rig.error().message();
  const calib::steer::Solution& solution = rig->solution;
  const TargetSpec board = printed_board();
  const auto command =
      calib::bake::command_for(solution.projector, {0.4, -0.35, 3.5}, calib::bake::panel_middle(solution.projector));
  ASSERT_TRUE(command);
  host::sim::PretendOptions pretend;
  pretend.board = "mock-small";
  pretend.scene = Technician::data("circles/data/printed.toml");
  pretend.seed = 20261122;
  const auto errors = circle_errors(pretend, solution, board, *command, technician.in("circles"));
  ASSERT_TRUE(errors) << errors.error().message();
  RecordProperty("rmse_mm", std::to_string(errors->rmse_mm));
  EXPECT_EQ(errors->discs, 27);
  // Asked: 0.5 px of the reference rig, whose pixels are 0.91 mm wide here. These cameras' are 10 mm.
  EXPECT_LT(errors->rmse_mm, 4 * 0.5 * 0.91);

  // A rig that stands 2 mm off does not pass.
  calib::steer::Solution off = solution;
  off.projector.T_projector_rig.t.x() += 0.002;
  const auto worse = circle_errors(pretend, off, board, *command, technician.in("circles-off"));
  ASSERT_TRUE(worse) << worse.error().message();
  EXPECT_GT(worse->rmse_mm, 4 * 0.5 * 0.91);
}

}  // namespace
}  // namespace raysteer::support
