// A capture that goes well, and what it measures on the way.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <variant>

#include "firmware/capture/session_writer.hpp"
#include "proto/session/raw_frame.hpp"
#include "tests/rig/capture/capture_bench.hpp"

namespace raysteer::support {
namespace {

namespace fs = std::filesystem;
using firmware::capture::Findings;
using firmware::capture::SessionWriter;
using firmware::capture::State;

class CaptureRun : public testing::TestWithParam<Kind> {};

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  return info.param == Kind::kDisplay ? "display" : "trigger_master";
}

INSTANTIATE_TEST_SUITE_P(Both, CaptureRun, testing::Values(Kind::kDisplay, Kind::kTriggerMaster), name_of);

// All files of a folder and what is in them.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      std::ifstream in(entry.path(), std::ios::binary);
      files[fs::relative(entry.path(), folder).string()] = std::string(std::istreambuf_iterator<char>(in), {});
    }
  }
  return files;
}

struct Folder {
  fs::path path;
  Folder() {
    std::string text = (fs::temp_directory_path() / "raysteer-capture-XXXXXX").string();
    path = ::mkdtemp(text.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }
};

TEST_P(CaptureRun, takes_every_pattern_at_every_look_once) {
  CaptureBench bench(GetParam());
  bench.add_look("aside", -0.05, 0.03);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  ASSERT_TRUE(bench.memory.finished);
  const auto frames = static_cast<std::size_t>(bench.sequence.frames());
  EXPECT_EQ(bench.memory.finished->shots.size(), 2 * frames);
  EXPECT_EQ(bench.memory.shots.size(), 2 * frames);
  EXPECT_EQ(bench.memory.puts, static_cast<int>(2 * frames));
  EXPECT_TRUE(bench.capture->findings().retakes.empty()) << bench.story();
  EXPECT_EQ(bench.capture->progress().shots_done, bench.capture->progress().shots_total);
  EXPECT_FALSE(bench.rig->projector().light_is_on());
  // Patterns of four frames each, and about two seconds of measuring.
  EXPECT_LT(bench.seconds(), 12);
}

TEST_P(CaptureRun, records_what_each_shot_was_taken_with) {
  CaptureBench bench(GetParam());
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  std::int64_t before = 0;
  for (const proto::session::Shot& shot : bench.memory.finished->shots) {
    ASSERT_TRUE(shot.trigger_time_ns && shot.rig_time_ns && shot.mirror_feedback && shot.exposure_us);
    EXPECT_EQ(shot.camera_times_ns.size(), 2U);
    EXPECT_GE(*shot.trigger_time_ns, *shot.rig_time_ns);
    EXPECT_GT(*shot.trigger_time_ns, before);
    before = *shot.trigger_time_ns;
    EXPECT_NEAR((*shot.mirror_feedback)[0], 0.01, 100e-6);
    EXPECT_NEAR((*shot.mirror_feedback)[1], -0.02, 100e-6);
  }
}

TEST_P(CaptureRun, gives_the_same_session_byte_for_byte_from_the_same_seed) {
  std::array<Folder, 2> folders;
  std::size_t frames = 0;
  const std::uint64_t same = seed();
  for (const Folder& folder : folders) {
    CaptureBench bench(GetParam(), same);
    SessionWriter writer(folder.path);
    bench.sink = &writer;
    ASSERT_TRUE(bench.make());
    ASSERT_EQ(bench.run(), State::kDone) << bench.story();
    frames = static_cast<std::size_t>(bench.sequence.frames());
  }
  const auto files = files_of(folders[0].path);
  EXPECT_EQ(files.size(), 2 * frames + 1);
  EXPECT_TRUE(files.contains("session.toml"));
  EXPECT_EQ(files, files_of(folders[1].path));
  const std::string& raw = files.at("left/straight/000.rsf");
  const auto frame = proto::session::read_raw_frame({reinterpret_cast<const std::uint8_t*>(raw.data()), raw.size()});
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<Image<std::uint8_t>>(*frame).width(), 64);
}

TEST(CaptureLatency, is_measured_whatever_the_display_has) {
  for (const double frames : {0.3, 1.0, 2.0, 2.6, 7.0}) {
    CaptureBench bench(Kind::kDisplay);
    bench.parameters.projector.latency_frames = frames;
    ASSERT_TRUE(bench.make());
    ASSERT_GT(bench.run_to("capture.latency"), 0) << bench.story();
    const double measured = static_cast<double>(bench.capture->findings().latency->count()) / 16'666'667;
    EXPECT_NEAR(measured, frames, 0.03) << bench.story();
  }
}

TEST(CaptureLatency, beyond_belief_is_not_believed) {
  CaptureBench bench(Kind::kDisplay);
  bench.parameters.projector.latency_frames = 9;
  bench.options.longest_latency_frames = 5;
  bench.options.most_retakes = 1;
  ASSERT_TRUE(bench.make());
  EXPECT_EQ(bench.run(), State::kFailed);
}

TEST_P(CaptureRun, notices_flicker_and_exposes_for_whole_periods) {
  for (const double hz : {100.0, 120.0}) {
    CaptureBench bench(GetParam());
    bench.plane.flicker = 0.4;
    bench.plane.flicker_hz = hz;
    bench.plane.ambient_e_per_s = 60e3;
    ASSERT_TRUE(bench.make());
    ASSERT_EQ(bench.run(), State::kDone) << bench.story();
    const Findings& findings = bench.capture->findings();
    ASSERT_TRUE(findings.flicker && findings.flicker->noticed) << bench.story();
    EXPECT_EQ(findings.flicker->hz, hz);
    // The sensor's black level counts as light: at least a third of the truth is left here.
    EXPECT_GT(findings.flicker->modulation, 0.13);
    EXPECT_LT(findings.flicker->modulation, 0.42);
    const double periods = static_cast<double>(findings.exposure.count()) * 1e-9 * hz;
    EXPECT_NEAR(periods, std::round(periods), 0.01);
  }
}

TEST_P(CaptureRun, chooses_an_exposure_that_saturates_almost_nothing) {
  for (const double light : {30e3, 120e3, 400e3}) {
    CaptureBench bench(GetParam());
    bench.plane.white_e_per_s = light;
    ASSERT_TRUE(bench.make());
    ASSERT_EQ(bench.run(), State::kDone) << bench.story();
    const hal::FramePair& white = bench.memory.shots.at({"straight", 0});
    for (const hal::Eye eye : hal::kEyes) {
      const auto& pixels = std::get<Image<std::uint8_t>>(white.eye(eye)->pixels);
      const auto saturated =
          std::count_if(pixels.data(), pixels.data() + pixels.size(), [](int p) { return p >= 250; });
      EXPECT_LE(saturated, 0.005 * static_cast<double>(pixels.size())) << light << "\n" << bench.story();
      EXPECT_GT(*std::max_element(pixels.data(), pixels.data() + pixels.size()), 75) << light;
    }
  }
}

TEST_P(CaptureRun, waits_for_a_person_where_the_plan_says_so) {
  CaptureBench bench(GetParam());
  bench.plan.looks[0].prepare = "target pose 1";
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kWaiting);
  EXPECT_EQ(bench.capture->prepare(), "target pose 1");
  EXPECT_EQ(bench.run(), State::kWaiting);
  bench.capture->go_on(bench.now);
  EXPECT_EQ(bench.run(), State::kDone) << bench.story();
}

TEST_P(CaptureRun, shows_white_and_black_though_the_sequence_lacks_them) {
  CaptureBench bench(GetParam());
  bench.sequence.blocks.erase(bench.sequence.blocks.begin(), bench.sequence.blocks.begin() + 2);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_EQ(bench.memory.shots.size(), static_cast<std::size_t>(bench.sequence.frames()));
}

TEST_P(CaptureRun, goes_on_where_it_was_interrupted) {
  Folder folder;
  const auto begin = [&](CaptureBench& bench, SessionWriter& writer) {
    bench.add_look("aside", -0.05, 0.03);
    bench.sink = &writer;
  };
  SessionWriter writer(folder.path);
  {
    CaptureBench bench(GetParam());
    begin(bench, writer);
    ASSERT_TRUE(bench.make());
    ASSERT_GT(bench.run_to("capture.look_done"), 0) << bench.story();
    bench.run(1.2);  // and then the power goes
  }
  EXPECT_FALSE(fs::exists(folder.path / "session.toml"));
  ASSERT_TRUE(fs::exists(folder.path / "capture.toml"));
  const auto before = files_of(folder.path);
  CaptureBench bench(GetParam(), 77);
  begin(bench, writer);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_TRUE(bench.said("kept_shots=" + std::to_string(bench.sequence.frames()))) << bench.story();
  const auto after = files_of(folder.path);
  EXPECT_FALSE(after.contains("capture.toml"));
  EXPECT_EQ(before.at("left/straight/007.rsf"), after.at("left/straight/007.rsf"));
  const auto no_includes = [](const std::string& path) -> Result<std::string> {
    return fail(RCode::kFileMissing, path);
  };
  const auto manifest = proto::session::read_manifest(after.at("session.toml"), "session.toml", no_includes);
  ASSERT_TRUE(manifest) << manifest.error().message();
  EXPECT_EQ(manifest->shots.size(), 2 * static_cast<std::size_t>(bench.sequence.frames()));

  CaptureBench again(GetParam());
  begin(again, writer);
  ASSERT_TRUE(again.make());
  EXPECT_EQ(again.run(), State::kFailed);
  EXPECT_EQ(again.capture->error()->rcode, RCode::kOutputExists);
}

TEST_P(CaptureRun, does_not_go_on_with_another_plans_beginning) {
  Folder folder;
  SessionWriter writer(folder.path);
  {
    CaptureBench bench(GetParam());
    bench.add_look("aside", -0.05, 0.03);
    bench.sink = &writer;
    ASSERT_TRUE(bench.make());
    ASSERT_GT(bench.run_to("capture.look_done"), 0) << bench.story();
  }
  CaptureBench bench(GetParam());
  bench.sink = &writer;
  ASSERT_TRUE(bench.make());
  EXPECT_EQ(bench.run(), State::kFailed);
  EXPECT_EQ(bench.capture->error()->rcode, RCode::kCaptureForeign);
}

TEST_P(CaptureRun, refuses_what_the_rig_cannot_do_before_anything_moves) {
  const auto code_of = [](CaptureBench& bench) {
    const Status status = bench.make();
    return status ? RCode::kNone : status.error().rcode;
  };
  CaptureBench outside(GetParam());
  outside.plan.looks[0].mirror_rad[1] = 0.5;
  EXPECT_EQ(code_of(outside), RCode::kMirrorOutOfRange);
  EXPECT_FALSE(outside.rig->mirror().last_commanded());
  CaptureBench no_number(GetParam());
  no_number.plan.looks[0].mirror_rad[0] = std::nan("");
  EXPECT_EQ(code_of(no_number), RCode::kMirrorOutOfRange);
  CaptureBench panel(GetParam());
  panel.sequence.panel_width = 60;
  EXPECT_EQ(code_of(panel), RCode::kPanelSize);
  CaptureBench empty(GetParam());
  empty.plan.looks.clear();
  EXPECT_EQ(code_of(empty), RCode::kBadValue);
}

}  // namespace
}  // namespace raysteer::support
