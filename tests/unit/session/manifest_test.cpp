#include "proto/session/manifest.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace raysteer::proto::session {
namespace {

const std::string kWhole = R"(format = 1
name = "demo"
rig = "bench-2"
note = "first light"
frames = "captures/demo"
exposure_us = 8333.5
[projector]
width = 1920
height = 1080
[[camera]]
name = "left"
files = "{camera}/{look}/{index:03}.png"
first_index = 1
width = 640
height = 480
bits = 16
[[camera]]
name = "right"
files = "{camera}/{look}/{index:03}.png"
[[sequence]]
kind = "gray"
axis = "x"
bits = 8
stripe_px = 8
offset_px = 4
inverse = true
inverse_first = true
lsb_first = true
[[sequence]]
kind = "phase"
axis = "y"
steps = 8
period_px = 16.25
origin_px = -0.5
sign = -1
[[sequence]]
kind = "white"
[[sequence]]
kind = "black"
[[look]]
name = "a"
command_rad = [0.1, -0.25]
note = "the \"upper\" wall"
[[look]]
name = "b"
[[target]]
kind = "charuco"
columns = 25
rows = 18
square_m = 0.0075
marker_m = 0.0056
dictionary = "5X5_1000"
layout = "legacy"
looks = ["b"]
[[target]]
kind = "chessboard"
columns = 9
rows = 7
[[shot]]
look = "a"
index = 3
sequence_number = 77
rig_time_ns = 1000000000000
trigger_time_ns = 1000000001000
exposure_us = 8000
mirror_command_rad = [0.1, 0]
mirror_feedback_rad = [0.1001, 0]
camera_times_ns = [12, 13]
)";

const std::string kLeast = R"(format = 1
name = "views"
[[camera]]
name = "left"
files = "left.png"
)";

Result<Manifest> read(const std::string& text, const std::map<std::string, std::string>& files = {}) {
  return read_manifest(text, "demo.toml", [&](const std::string& path) -> Result<std::string> {
    const auto found = files.find(path);
    return found == files.end() ? Result<std::string>(fail(RCode::kFileMissing, path))
                                : Result<std::string>(found->second);
  });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_fault(const std::string& text, RCode rcode, const std::string& words) {
  const Result<Manifest> manifest = read(text);
  ASSERT_FALSE(manifest) << words;
  EXPECT_EQ(to_string(manifest.error().rcode), to_string(rcode)) << manifest.error().message();
  EXPECT_NE(manifest.error().note.find(words), std::string::npos) << manifest.error().note;
}

TEST(Manifest, says_every_key_of_the_format) {
  const Result<Manifest> manifest = read(kWhole);
  ASSERT_TRUE(manifest) << manifest.error().message();
  EXPECT_EQ(manifest->cameras[0].bits, 16);
  EXPECT_EQ(manifest->sequence.frames(), 16 + 8 + 2);
  EXPECT_EQ(manifest->sequence.blocks[1].sign, -1);
  EXPECT_TRUE(manifest->sequence.blocks[0].lsb_first);
  EXPECT_EQ(manifest->looks[0].command->at(1), -0.25);
  EXPECT_EQ(manifest->looks[0].note, "the \"upper\" wall");
  EXPECT_EQ(manifest->target_of("b")->kind, TargetKind::kCharuco);
  EXPECT_EQ(manifest->target_of("a")->kind, TargetKind::kChessboard);
  EXPECT_EQ(manifest->target_of("a")->square_m, 0) << "missing scale is calibrate's business";
  EXPECT_EQ(manifest->shots[0].camera_times_ns[1], 13);
  EXPECT_EQ(file_name(*manifest, manifest->cameras[1], manifest->looks[0], 7), "captures/demo/right/a/007.png");
  EXPECT_EQ(file_name(*manifest, manifest->cameras[0], manifest->looks[1], 7), "captures/demo/left/b/008.png");
}

TEST(Manifest, written_text_reads_back_as_the_same_session) {
  for (const std::string& text : {kWhole, kLeast}) {
    const Manifest manifest = *read(text);
    const std::string written = write_manifest(manifest);
    const Result<Manifest> again = read(written);
    ASSERT_TRUE(again) << again.error().message() << "\n" << written;
    EXPECT_EQ(*again, manifest) << written;
    EXPECT_EQ(write_manifest(*again), written);
  }
}

TEST(Manifest, without_sequence_and_looks_is_one_white_frame) {
  const Manifest manifest = *read(kLeast);
  EXPECT_EQ(manifest.sequence.frames(), 1);
  EXPECT_EQ(manifest.sequence.blocks[0].kind, PatternKind::kWhite);
  EXPECT_EQ(manifest.looks.size(), 1U);
  EXPECT_EQ(manifest.cameras[0].bits, 8);
}

TEST(Manifest, periods_across_the_panel_stand_for_a_period) {
  const Manifest manifest = *read(replaced(kWhole, "period_px = 16.25", "periods = 40"));
  EXPECT_DOUBLE_EQ(manifest.sequence.blocks[1].period_px, 1080 / 40.0);
  expect_fault(replaced(kWhole, "period_px = 16.25", "periods = 40\nperiod_px = 27"), RCode::kBadValue, "one of them");
}

TEST(Manifest, names_the_line_and_the_nearest_key) {
  expect_fault(replaced(kWhole, "inverse_first", "inverse_frist"), RCode::kUnknownKey,
               "demo.toml:27: 'inverse_frist' in [[sequence]] 1; did you mean 'inverse_first'?");
  expect_fault(replaced(kWhole, "[projector]", "[projektor]"), RCode::kUnknownKey, "did you mean 'projector'?");
  expect_fault(replaced(kWhole, "square_m = 0.0075", "square_mm = 7.5"), RCode::kUnknownKey, "'square_m'");
  expect_fault(replaced(kWhole, "kind = \"white\"", "kind = \"white\"\nbits = 3"), RCode::kUnknownKey, "'bits'");
}

TEST(Manifest, every_bad_value_has_its_own_message) {
  expect_fault("format = 1\nname = ", RCode::kTomlSyntax, "demo.toml:2");
  expect_fault("format = 1\n[[@camera]]\n", RCode::kTomlSyntax, "demo.toml:2");
  expect_fault("format = 1\n\u00e9 = 2\n", RCode::kTomlSyntax, "demo.toml:2");
  expect_fault(replaced(kWhole, "format = 1", "format = 2"), RCode::kFormatVersion, "this program knows 1");
  expect_fault(replaced(kWhole, "format = 1\n", ""), RCode::kMissingKey, "'format'");
  expect_fault(replaced(kWhole, "name = \"left\"\n", ""), RCode::kMissingKey, "demo.toml:10: 'name' of [[camera]] 1");
  expect_fault(replaced(kWhole, "bits = 16", "bits = 12"), RCode::kBadValue, "8 or 16");
  expect_fault(replaced(kWhole, "bits = 16", "bits = \"16\""), RCode::kBadValue, "a whole number, got text");
  expect_fault(replaced(kWhole, "width = 1920", "width = 0"), RCode::kBadValue, "1 to 65535, got 0");
  expect_fault(replaced(kWhole, "square_m = 0.0075", "square_m = 7.5"), RCode::kBadValue, "metres");
  expect_fault(replaced(kWhole, "square_m = 0.0075", "square_m = -0.01"), RCode::kBadValue, "got -0.01");
  expect_fault(replaced(kWhole, "square_m = 0.0075", "square_m = nan"), RCode::kBadValue, "got nan");
  expect_fault(replaced(kWhole, "marker_m = 0.0056", "marker_m = 0.0076"), RCode::kBadValue, "smaller");
  expect_fault(replaced(kWhole, "marker_m = 0.0056\n", ""), RCode::kMissingKey, "'marker_m'");
  expect_fault(replaced(kWhole, "\"5X5_1000\"", "\"5X5_100O\""), RCode::kBadValue, "did you mean '5X5_100'?");
  expect_fault(replaced(kWhole, "kind = \"gray\"", "kind = \"grey\""), RCode::kBadValue, "did you mean 'gray'?");
  expect_fault(replaced(kWhole, "steps = 8", "steps = 2"), RCode::kBadValue, "3 to 64");
  expect_fault(replaced(kWhole, "sign = -1", "sign = 0"), RCode::kBadValue, "1 or -1");
  expect_fault(replaced(kWhole, "bits = 8", "bits = 7"), RCode::kBadSequence, "7 bits code 128 stripes");
  expect_fault(replaced(kWhole, "looks = [\"b\"]", "looks = [\"c\"]"), RCode::kBadValue, "no look of this session");
  expect_fault(replaced(kWhole, "name = \"b\"", "name = \"a\""), RCode::kBadValue, "'a' twice");
  expect_fault(replaced(kWhole, "index = 3", "index = 26"), RCode::kBadValue, "0 to 25");
  expect_fault(replaced(kWhole, "{index:03}", "{indx}"), RCode::kBadValue, "'{indx}'");
  expect_fault(replaced(kWhole, "{index:03}", "{index"), RCode::kBadValue, "'{index.png'");
  expect_fault(replaced(kWhole, "/{index:03}", ""), RCode::kBadValue, "lacks {index}");
  expect_fault(replaced(kWhole, "/{look}", ""), RCode::kBadValue, "lacks {look}");
  expect_fault(replaced(kWhole, "[projector]\nwidth = 1920\nheight = 1080\n", ""), RCode::kMissingKey, "projector");
  expect_fault("format = 1\nname = \"x\"\n", RCode::kMissingKey, "one [[camera]] or two");
}

TEST(Manifest, paths_that_leave_the_session_are_refused) {
  expect_fault(replaced(kWhole, "{camera}/", "../{camera}/"), RCode::kPathOutside, "goes up with '..'");
  expect_fault(replaced(kWhole, "{camera}/", "/etc/{camera}/"), RCode::kPathOutside, "absolute");
  expect_fault(replaced(kWhole, "captures/demo", "captures/../.."), RCode::kPathOutside, "goes up");
  expect_fault(replaced(kWhole, "captures/demo", "C:\\\\demo"), RCode::kPathOutside, "backslash");
  expect_fault(replaced(kWhole, "name = \"b\"", "name = \"..\""), RCode::kBadValue, "part of a file name");
  expect_fault("include = \"../other.toml\"\n" + kWhole, RCode::kPathOutside, "goes up");
}

TEST(Manifest, own_keys_go_before_included_ones) {
  const std::string own = "include = \"sub/rig.toml\"\n" + replaced(kLeast, "name = \"views\"", "name = \"own\"");
  const Result<Manifest> manifest =
      read(own, {{"sub/rig.toml", "name = \"shared\"\nrig = \"bench\"\ninclude = \"panel.toml\"\n"},
                 {"sub/panel.toml", "[projector]\nwidth = 64\nheight = 32\n"}});
  ASSERT_TRUE(manifest) << manifest.error().message();
  EXPECT_EQ(manifest->name, "own");
  EXPECT_EQ(manifest->rig, "bench");
  EXPECT_EQ(manifest->sequence.panel_width, 64);
}

TEST(Manifest, faults_in_included_files_name_that_file) {
  const Result<Manifest> manifest =
      read("include = \"rig.toml\"\n" + kLeast, {{"rig.toml", "rig = \"a\"\n[projector]\nwidht = 64\nheight = 2\n"}});
  ASSERT_FALSE(manifest);
  EXPECT_EQ(manifest.error().rcode, RCode::kUnknownKey);
  EXPECT_NE(manifest.error().note.find("rig.toml:3"), std::string::npos) << manifest.error().note;
  EXPECT_EQ(read("include = \"gone.toml\"\n" + kLeast).error().rcode, RCode::kFileMissing);
}

TEST(Manifest, circular_includes_are_named) {
  const Result<Manifest> manifest = read("include = \"a.toml\"\n" + kLeast, {{"a.toml", "include = \"b.toml\"\n"},
                                                                             {"b.toml", "include = \"./a.toml\"\n"}});
  ASSERT_FALSE(manifest);
  EXPECT_EQ(manifest.error().rcode, RCode::kCircularInclude);
  EXPECT_NE(manifest.error().note.find("a.toml -> b.toml -> a.toml"), std::string::npos) << manifest.error().note;
  EXPECT_EQ(read("include = \"demo.toml\"\n" + kLeast).error().rcode, RCode::kCircularInclude);
}

TEST(Manifest, any_beginning_of_a_file_is_read_or_refused) {
  for (std::size_t size = 0; size < kWhole.size(); ++size) {
    const Result<Manifest> manifest = read(kWhole.substr(0, size));
    if (manifest) {
      EXPECT_FALSE(manifest->cameras.empty());
    }
  }
}

}  // namespace
}  // namespace raysteer::proto::session
