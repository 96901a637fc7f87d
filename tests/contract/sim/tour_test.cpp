// The keys of `raysteer sim --tour --json` that are relied on outside, and that the rectangle is straight.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

TEST(Tour, puts_a_rectangle_where_it_was_wanted_with_two_mirrors_and_with_one) {
  for (const bool head : {false, true}) {
    support::ScratchFolder folder;
    const std::string out = (folder.path() / "tour").string();
    const auto finished = raysteer({"sim", "--tour", "--board", head ? "mock-small-head" : "mock-small", "--seed",
                                    "20261122", "--out", out, "--json", "--quiet"});
    ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
    const auto json = parse_one(finished.out);
    ASSERT_TRUE(json.is_object()) << finished.out;
    EXPECT_EQ(json.at("mirrored"), head);
    // A camera pixel of the small board is 10 mm wide on the floor, four times that of the reference rig: so are the
    // limits.
    EXPECT_LT(json.at("corner_mean_mm"), 4 * 1.5);
    EXPECT_LT(json.at("corner_max_mm"), 4 * 4.0);
    EXPECT_GT(json.at("before_mean_mm"), json.at("corner_mean_mm"));
    EXPECT_TRUE(std::filesystem::is_regular_file(json.at("picture").get<std::string>()));
  }
}

TEST(Tour, takes_no_other_task_beside_it_and_no_look_that_is_none) {
  EXPECT_EQ(raysteer({"sim", "--tour", "--faults"}).exit_code, 2);
  EXPECT_EQ(raysteer({"sim", "--tour", "--look", "20"}).exit_code, 2);
}

}  // namespace
}  // namespace raysteer::host::cli
