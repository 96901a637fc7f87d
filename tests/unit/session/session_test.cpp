#include "host/session/session.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "host/session/check.hpp"

namespace raysteer::host::session {
namespace {

namespace fs = std::filesystem;

// A session of two looks, one camera and 2 x 4 bits, in a folder of its own.
class OnDisk : public testing::Test {
 protected:
  void SetUp() override {
    unsetenv("RAYSTEER_DATA_DIR");
    folder_ = fs::temp_directory_path() / ("raysteer-session-" + std::to_string(getpid()) + "-" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_ / "a");
    fs::create_directories(folder_ / "b");
    write_text("session.toml", R"(format = 1
name = "small"
looks = ["a", "b"]
[projector]
width = 16
height = 8
[[camera]]
name = "left"
files = "{look}/{index}.pgm"
[[sequence]]
kind = "gray"
axis = "x"
bits = 4
[[sequence]]
kind = "white"
)");
    for (const char* look : {"a", "b"}) {
      for (int index = 0; index < 5; ++index) {
        write_frame(std::string(look) + "/" + std::to_string(index) + ".pgm", 20, 10);
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write_text(const std::string& name, const std::string& text) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    ASSERT_TRUE(write_file(folder_ / name, {bytes, text.size()}));
  }
  void write_frame(const std::string& name, int width, int height) {
    ASSERT_TRUE(write_file(folder_ / name, encode_pgm(Image<std::uint8_t>(width, height).view())));
  }
  Result<Session> open(const std::optional<fs::path>& root = {}) {
    return Session::open(folder_ / "session.toml", root);
  }
  void expect_fault(RCode rcode, const std::string& words) {
    const Result<Session> session = open();
    ASSERT_FALSE(session);
    EXPECT_EQ(to_string(session.error().rcode), to_string(rcode)) << session.error().message();
    EXPECT_NE(session.error().note.find(words), std::string::npos) << session.error().note;
  }

  fs::path folder_;
};

TEST_F(OnDisk, opens_by_file_and_by_folder) {
  ASSERT_TRUE(open()) << open().error().message();
  const Result<Session> session = Session::open(folder_);
  ASSERT_TRUE(session);
  EXPECT_EQ(session->frames_per_look(), 5);
  EXPECT_EQ(session->width(0), 20);
  EXPECT_EQ(session->look_number("b"), 1);
  EXPECT_EQ(session->path({0, 1, 3}), folder_ / "b/3.pgm");
  Image<std::uint8_t> image;
  EXPECT_TRUE(session->load({0, 1, 3}, image));
  Image<std::uint16_t> wide;
  EXPECT_EQ(session->load({0, 1, 3}, wide).error().rcode, RCode::kFrameDepth);
}

TEST_F(OnDisk, missing_frames_are_named_and_counted) {
  fs::remove(folder_ / "a/2.pgm");
  fs::remove(folder_ / "b/4.pgm");
  expect_fault(RCode::kFrameMissing, "frame 2 of camera 'left', look 'a' (a/2.pgm); 1 others are missing, too");
}

TEST_F(OnDisk, frames_of_another_size_or_depth_are_refused) {
  write_frame("b/1.pgm", 20, 11);
  Image<std::uint8_t> image;
  EXPECT_EQ(open()->load({0, 1, 1}, image).error().rcode, RCode::kFrameSize);
  EXPECT_EQ(check_session(*open()).faults.back().rcode, RCode::kFrameSize);
  ASSERT_TRUE(write_file(folder_ / "a/0.pgm", encode_pgm(Image<std::uint16_t>(20, 10).view())));
  expect_fault(RCode::kFrameDepth, "the session says 8 bits, the file holds 16");
}

TEST_F(OnDisk, a_truncated_frame_is_named) {
  fs::resize_file(folder_ / "a/3.pgm", 60);
  Image<std::uint8_t> image;
  const Status status = open()->load({0, 0, 3}, image);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().rcode, RCode::kFileTruncated);
  EXPECT_NE(status.error().note.find("a/3.pgm"), std::string::npos);
}

TEST_F(OnDisk, frames_may_lie_under_the_frames_root) {
  const fs::path elsewhere = folder_ / "elsewhere";
  fs::create_directories(elsewhere);
  fs::rename(folder_ / "a", elsewhere / "a");
  fs::rename(folder_ / "b", elsewhere / "b");
  EXPECT_EQ(open().error().rcode, RCode::kFrameMissing);
  const Result<Session> session = open(elsewhere);
  ASSERT_TRUE(session) << session.error().message();
  EXPECT_EQ(session->frames_folder(), elsewhere);
  setenv("RAYSTEER_DATA_DIR", elsewhere.c_str(), 1);
  EXPECT_TRUE(open());
  unsetenv("RAYSTEER_DATA_DIR");
}

TEST_F(OnDisk, symbolic_links_out_of_the_session_are_refused) {
  const fs::path outside = folder_.string() + "-outside.pgm";
  fs::rename(folder_ / "a/1.pgm", outside);
  fs::create_symlink(outside, folder_ / "a/1.pgm");
  expect_fault(RCode::kPathOutside, "a/1.pgm");
  fs::remove(outside);
}

TEST_F(OnDisk, black_frames_are_refused_by_the_check) {
  const CheckReport report = check_session(*open());
  ASSERT_FALSE(report.good());
  EXPECT_EQ(report.faults.front().rcode, RCode::kFramesBlack);
  EXPECT_EQ(report.frames, 10);
  EXPECT_EQ(check_look(*open(), 0, 1).error().rcode, RCode::kFramesBlack);
}

TEST_F(OnDisk, writing_where_it_cannot_leaves_nothing) {
  const std::vector<std::uint8_t> bytes(10);
  EXPECT_EQ(write_file(folder_ / "none/x.bin", bytes).error().rcode, RCode::kWriteFailed);
  EXPECT_FALSE(fs::exists(folder_ / "none"));
  if (fs::exists("/dev/full")) {
    EXPECT_EQ(read_file(folder_ / "a").error().rcode, RCode::kFileUnreadable) << "a folder is no file";
  }
}

}  // namespace
}  // namespace raysteer::host::session
