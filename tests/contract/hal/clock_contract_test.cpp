// What hal/clock.hpp promises, for every back end.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

class ClockContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, ClockContract, testing::ValuesIn(back_ends()), name_of);

TEST_P(ClockContract, goes_on_and_never_back_whatever_the_wall_clock_does) {
  const auto rig =
      bench({{.device = "clock", .what = "step", .from = RigTime(std::chrono::milliseconds(5)), .amount = -7'200}});
  RigTime before = rig->now();
  for (int i = 0; i < 20; ++i) {
    rig->run(std::chrono::milliseconds(1));
    EXPECT_EQ(rig->now() - before, std::chrono::milliseconds(1));
    before = rig->now();
  }
}

}  // namespace
}  // namespace raysteer::hal
