#include "proto/board/board.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/paths.hpp"

namespace raysteer::proto::board {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string whole() { return text_of(support::source_root() / "tests" / "data" / "boards" / "whole.toml"); }

// The whole board with its first `from` written as `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = whole();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Error error_of(const std::string& text) {
  const Result<Board> board = read_board(text, "rig.toml");
  EXPECT_FALSE(board);
  return board ? Error{} : board.error();
}

TEST(Board, every_board_of_ours_is_read) {
  int boards = 0;
  for (const auto& entry : std::filesystem::directory_iterator(support::source_root() / "boards")) {
    const Result<Board> board = read_board(text_of(entry.path()), entry.path().filename().string());
    ASSERT_TRUE(board) << board.error().message();
    EXPECT_EQ(board->name, entry.path().stem().string());
    EXPECT_EQ(board->cameras.size(), 2U);
    ++boards;
  }
  EXPECT_GE(boards, 1);
}

TEST(Board, numbers_come_in_metres_radians_and_seconds) {
  const Result<Board> board =
      read_board(changed("min_angle_mrad = [-209.44, -209.44]", "min_angle_mrad = [-200, -100]"), "rig.toml");
  ASSERT_TRUE(board) << board.error().message();
  EXPECT_DOUBLE_EQ(board->mirror.least_rad[0], -0.2);
  EXPECT_DOUBLE_EQ(board->mirror.least_rad[1], -0.1);
  EXPECT_DOUBLE_EQ(board->mirror.settle_window_s, 1e-3);
  EXPECT_DOUBLE_EQ(board->cameras[0].pixel_m, 3.45e-6);
  EXPECT_EQ(board->cameras[0].T_camera_rig, Pose{});
}

TEST(Board, unknown_key_is_refused_with_the_nearest_one_and_its_line) {
  const Error error = error_of(changed("lumens = 3000", "lumen = 3000"));
  EXPECT_EQ(error.rcode, RCode::kUnknownKey);
  EXPECT_NE(error.note.find("rig.toml:14"), std::string::npos) << error.note;
  EXPECT_NE(error.note.find("did you mean 'lumens'"), std::string::npos) << error.note;
}

TEST(Board, wrong_unit_in_a_key_is_told_the_right_one) {
  const Error error = error_of(changed("max_angle_mrad", "max_angle_deg"));
  EXPECT_EQ(error.rcode, RCode::kUnknownKey);
  EXPECT_NE(error.note.find("'max_angle_mrad'"), std::string::npos) << error.note;
  EXPECT_NE(error.note.find("unit"), std::string::npos) << error.note;
}

TEST(Board, lengths_in_millimetres_are_refused_with_a_hint) {
  const Error error = error_of(changed("focus_m = 3.6", "focus_m = 3600"));
  EXPECT_EQ(error.rcode, RCode::kBadValue);
  EXPECT_NE(error.note.find("metres"), std::string::npos) << error.note;
}

TEST(Board, nonsense_is_refused_each_by_its_own_note) {
  EXPECT_EQ(error_of("format = 2").rcode, RCode::kFormatVersion);
  EXPECT_EQ(error_of("format = ").rcode, RCode::kTomlSyntax);
  EXPECT_EQ(error_of("format = 1").rcode, RCode::kMissingKey);
  EXPECT_EQ(error_of(changed("axis = [1, 0, 0]", "axis = [1, 1, 0]")).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of(changed("axis = [1, 0, 0]", "axis = [nan, 0, 0]")).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of(changed("min_angle_mrad = [-209.44", "min_angle_mrad = [300")).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of(changed("kind = \"galvo-pair\"", "kind = \"head\"")).rcode, RCode::kMissingKey);
  EXPECT_EQ(error_of(changed("name = \"right\"", "name = \"left\"")).rcode, RCode::kBadValue);
  EXPECT_EQ(error_of(changed("format = 1", "format = 1\nfaults = [\"left.drop@2\"]")).rcode, RCode::kBadValue);
}

TEST(Board, half_a_file_is_never_a_board) {
  const std::string text = whole();
  // A cut within the last table, which may be left out, can leave a whole board; everything before cannot.
  const std::size_t last = text.find("[tolerance]");
  for (std::size_t length = 0; length < last - 40; length += 97) {
    EXPECT_FALSE(read_board(text.substr(0, length), "rig.toml")) << length;
  }
}

TEST(ReadFault, takes_the_long_and_the_short_way_of_writing) {
  const Result<Fault> full = read_fault("left.drop=1.5@2s*3");
  ASSERT_TRUE(full) << full.error().message();
  EXPECT_EQ(*full, (Fault{.device = "left", .what = "drop", .at_s = 2, .times = 3, .amount = 1.5}));
  const Result<Fault> brief = read_fault("interlock.open");
  ASSERT_TRUE(brief) << brief.error().message();
  EXPECT_EQ(*brief, (Fault{.device = "interlock", .what = "open"}));
}

TEST(ReadFault, refuses_what_it_would_have_to_guess) {
  for (const char* text :
       {"", ".", "drop", "left.", ".drop", "lefty.drop", "left.drop@2", "left.drop@2ms", "left.drop*x", "left.drop*-1",
        "left.drop=nan", "left.Drop", "left.drop@-1s", "left.drop*3@2s"}) {
    const Result<Fault> fault = read_fault(text);
    ASSERT_FALSE(fault) << text;
    EXPECT_EQ(fault.error().rcode, RCode::kBadValue) << text;
  }
  EXPECT_NE(read_fault("lefty.drop").error().note.find("did you mean 'left'"), std::string::npos);
}

}  // namespace
}  // namespace raysteer::proto::board
