#include "calib/plan/order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::calib::plan {
namespace {

std::vector<Eigen::Vector2d> ordered(const std::vector<Eigen::Vector2d>& commands) {
  std::vector<Eigen::Vector2d> result;
  for (const std::size_t i : visiting_order(commands, {1, 1})) {
    result.push_back(commands[i]);
  }
  return result;
}

TEST(Order, a_rising_chain_is_visited_upwards) {
  const auto way = ordered({{0.9, 0.8}, {0.1, 0.1}, {0.5, 0.5}, {0.3, 0.2}});
  EXPECT_EQ(approached_from_above(way), 0);
  EXPECT_EQ(way.front(), Eigen::Vector2d(0.1, 0.1));
  EXPECT_EQ(way.back(), Eigen::Vector2d(0.9, 0.8));
}

TEST(Order, a_grid_is_visited_row_by_row) {
  std::vector<Eigen::Vector2d> grid;
  for (int i = 0; i < 16; ++i) {
    grid.push_back({i % 4 / 3.0, i / 4 / 3.0});  // NOLINT(bugprone-integer-division)
  }
  EXPECT_EQ(approached_from_above(ordered(grid)), 3);
}

// No order does better than chains of looks that rise on both axes, and there are at least as many of those as the
// largest set of looks of which none is above another on both axes (Dilworth). Found here by the longest falling run.
TEST(Order, hardly_more_looks_are_approached_from_above_than_must_be) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> some(0, 1);
  int beyond = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Eigen::Vector2d> commands(24);
    for (Eigen::Vector2d& command : commands) {
      command = {some(random), some(random)};
    }
    std::ranges::sort(commands, {}, [](const Eigen::Vector2d& c) { return c.x(); });
    std::vector<int> run(commands.size(), 1);
    for (std::size_t i = 0; i < commands.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        run[i] = commands[j].y() > commands[i].y() ? std::max(run[i], run[j] + 1) : run[i];
      }
    }
    const int least = *std::ranges::max_element(run) - 1;
    const int found = approached_from_above(ordered(commands));
    EXPECT_GE(found, least);
    beyond += found - least;
  }
  std::printf("%d approaches from above more than needed in 20 orders\n", beyond);
  EXPECT_LE(beyond, 10);
}

TEST(Order, every_look_is_visited_once) {
  EXPECT_TRUE(visiting_order({}, {1, 1}).empty());
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> some(-1, 1);
  std::vector<Eigen::Vector2d> commands(17);
  for (Eigen::Vector2d& command : commands) {
    command = {some(random), some(random)};
  }
  auto order = visiting_order(commands, {2, 2});
  std::ranges::sort(order);
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(order[i], i);
  }
}

}  // namespace
}  // namespace raysteer::calib::plan
