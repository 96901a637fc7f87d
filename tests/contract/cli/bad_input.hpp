// What tests of bad input share: rendered sessions to spoil, the program to give them to, and what refusing means.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "calib/synth/stage.hpp"
#include "host/exchange/calibration_file.hpp"
#include "host/session/image_codec.hpp"
#include "tests/contract/cli/program.hpp"
#include "tests/support/pretend_sessions.hpp"
#include "tests/support/process.hpp"

namespace raysteer::bad_input {

namespace fs = std::filesystem;
using calib::synth::Stage;

struct Outcome {
  int exit_code = -1;
  std::string printed;  ///< standard output
  nlohmann::json json;  ///< the same, parsed; discarded where it is no JSON
  std::string error_code() const { return json.is_object() ? json.value("/error/code"_json_pointer, "") : ""; }
};

/// `before` goes in front of the program in a shell: "ulimit -f 8;".
inline Outcome run_raysteer(std::vector<std::string> words, const std::string& before = "") {
  words.insert(words.begin(),
               {"sh", "-c", before + " \"$@\"", "sh", (support::program_folder() / "raysteer").string()});
  const support::Finished finished = support::run_program(std::move(words));
  return {finished.exit_code, finished.out, host::cli::parse_one(finished.out)};
}

inline fs::path scan_session() {
  return support::rendered_once("scan", [] { return scan_stage(support::small_pretend_rig(), support::kPretendSeed); });
}
inline fs::path cameras_session() {
  return support::rendered_once("cameras",
                                [] { return cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 12); });
}
inline fs::path projector_session() {
  return support::rendered_once("projector",
                                [] { return projector_stage(support::small_pretend_rig(), support::kPretendSeed, 5); });
}

class BadInput : public ::testing::Test {
 protected:
  fs::path work() const { return folder_.path(); }

  /// A copy of a rendered session whose files may be spoiled.
  fs::path copy(const fs::path& session) const {
    const fs::path to = work() / session.filename();
    fs::copy(session, to, fs::copy_options::recursive);
    return to;
  }
  fs::path render(const Stage& stage) const {
    support::render(stage, work() / stage.name);
    return work() / stage.name;
  }

  /// The true rig as a calibration that claims `sigma` for each parameter.
  fs::path true_calibration(double sigma = 1e-6) const {
    calib::model::Rig rig = support::small_pretend_rig().rig();
    const int count = rig.offset(rig.devices.size());
    rig.covariance = Eigen::MatrixXd::Identity(count, count) * sigma * sigma;
    for (std::size_t i = 0; i < rig.devices.size(); ++i) {
      constexpr const char* kNames[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1",
                                        "p2", "rx", "ry", "rz", "tx", "ty", "tz"};
      for (int k = 0; k < rig.count(i); ++k) {
        rig.parameters.push_back(rig.devices[i].name + "." + kNames[k]);
      }
    }
    host::exchange::CalibrationMeta meta;
    meta.target = calib::synth::pretend_target();
    meta.verdict = "good";
    const fs::path folder = work() / "true-calibration";
    fs::create_directories(folder);
    EXPECT_TRUE(host::exchange::write_calibration(folder, rig, meta).has_value());
    return folder / "calibration.toml";
  }

  Outcome scan(const fs::path& session, const std::string& before = "") const {
    return scan_with(session, true_calibration(), before);
  }
  Outcome scan_with(const fs::path& session, const fs::path& calibration, const std::string& before = "") const {
    return run({"scan", (session / "session.toml").string(), "--calibration", calibration.string()}, before);
  }
  Outcome calibrate_cameras(const fs::path& session) const {
    return run({"calibrate", "cameras", (session / "session.toml").string()});
  }
  Outcome calibrate_projector(const fs::path& session) const {
    return run({"calibrate", "projector", (session / "session.toml").string()});
  }
  Outcome check(const fs::path& session) const {
    return run_raysteer({"session", "check", (session / "session.toml").string(), "--json"});
  }

  /// Refused with this code, and the folder for results was not made, nor anything beside it.
  void expect_refused(const Outcome& outcome, RCode rcode) const {
    EXPECT_EQ(outcome.error_code(), to_string(rcode)) << outcome.printed;
    EXPECT_GT(outcome.exit_code, 0);
    EXPECT_LT(outcome.exit_code, 10);
    EXPECT_FALSE(outcome.json.value("/error/remedy"_json_pointer, "").empty());
    EXPECT_TRUE(fs::is_empty(results())) << "left behind: " << *fs::directory_iterator(results());
  }

  fs::path results() const { return work() / "results"; }

 private:
  Outcome run(std::vector<std::string> words, const std::string& before = "") const {
    fs::create_directories(results());
    words.insert(words.end(), {"--out", (results() / "out").string(), "--json"});
    return run_raysteer(words, before);
  }

  support::ScratchFolder folder_;
};

inline fs::path frame(const fs::path& session, int index, const std::string& camera = "left") {
  return session / camera / ("look_0_" + std::string(index < 10 ? "0" : "") + std::to_string(index) + ".png");
}

inline void swap_files(const fs::path& a, const fs::path& b) {
  const fs::path aside = a.string() + ".aside";
  fs::rename(a, aside);
  fs::rename(b, a);
  fs::rename(aside, b);
}

inline void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

template <class Pixel>
void write_png(const fs::path& path, const Image<Pixel>& image) {
  const auto bytes = host::session::encode_png(image.view());
  ASSERT_TRUE(bytes && host::session::write_file(path, *bytes));
}

/// Every frame of a session changed by `change`.
template <class Change>
void rewrite_frames(const fs::path& session, const Change& change) {
  for (const auto& entry : fs::recursive_directory_iterator(session)) {
    if (entry.path().extension() == ".png") {
      const auto bytes = host::session::read_file(entry.path());
      Image<std::uint8_t> image;
      ASSERT_TRUE(bytes && host::session::decode_image(*bytes, image));
      write_png(entry.path(), change(image));
    }
  }
}

inline void edit_session(const fs::path& session, const std::string& what, const std::string& with) {
  const fs::path file = session / "session.toml";
  const std::string text = support::read_all(file);
  const std::string edited = std::regex_replace(text, std::regex(what), with);
  ASSERT_NE(text, edited) << "nothing in session.toml matches " << what;
  write_text(file, edited);
}

/// Index of the first frame of a block.
inline int first_frame(const PatternSequence& sequence, std::size_t block) {
  int first = 0;
  for (std::size_t i = 0; i < block; ++i) {
    first += sequence.blocks[i].frames();
  }
  return first;
}
inline PatternSequence scan_sequence() {
  const auto rig = support::small_pretend_rig();
  return calib::synth::half_period_sequence(rig.lamp.panel.width, rig.lamp.panel.height, true);
}

inline calib::model::Pose nudge(double angle) {
  calib::model::Pose pose;
  pose.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 0.5, 0).normalized()));
  return pose;
}

}  // namespace raysteer::bad_input
