// The check of sessions on the real captures: no false alarm, and every corruption we know of is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/sequence_check.hpp"
#include "host/session/check.hpp"
#include "host/session/session.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::host::session {
namespace {

using calib::decode::SequenceCheck;
using calib::decode::SequenceReport;
// Frames are shared, so that a corrupted set costs no more than the frames that it changes.
using Frame = std::shared_ptr<const Image<std::uint8_t>>;
using Frames = std::vector<Frame>;

Frame filled(const Frame& like, std::uint8_t level) {
  Image<std::uint8_t> image(like->width(), like->height());
  image.fill(level);
  return std::make_shared<const Image<std::uint8_t>>(std::move(image));
}

class CapturedSession : public testing::Test {
 protected:
  void SetUp() override {
    if (!support::captures()) {
      GTEST_SKIP() << "the real captures are not here (RAYSTEER_DATA_DIR)";
    }
  }

  static Session open(const std::string& name) {
    Result<Session> session =
        Session::open(support::source_root() / "tests/data/sessions" / (name + ".toml"), support::captures());
    EXPECT_TRUE(session) << session.error().message();
    return std::move(*session);
  }

  static Frames load(const Session& session, int camera, int look) {
    Frames frames;
    for (int index = 0; index < session.frames_per_look(); ++index) {
      Image<std::uint8_t> image;
      EXPECT_TRUE(session.load({camera, look, index}, image));
      frames.push_back(std::make_shared<const Image<std::uint8_t>>(std::move(image)));
    }
    return frames;
  }

  static SequenceReport judge(const Session& session, const Frames& frames) {
    SequenceCheck check(session.manifest().sequence, {0, 0, session.width(0), session.height(0)}, 8);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      check.add(static_cast<int>(k), frames[k]->view());
    }
    return check.report();
  }

  static std::string text(const SequenceReport& report) {
    std::string all;
    for (const Error& error : report.faults) {
      all += to_string(error.rcode) + " " + error.message() + "\n";
    }
    return all.empty() ? "no fault\n" : all;
  }
};

// Everything moves right by `px` from frame `first` on.
void nudge(Frames& frames, std::size_t first, int px) {
  for (std::size_t k = first; k < frames.size(); ++k) {
    Image<std::uint8_t> moved = frames[k]->clone();
    for (int y = 0; y < moved.height(); ++y) {
      std::uint8_t* row = moved.row(y);
      std::copy_backward(row, row + moved.width() - px, row + moved.width());
    }
    frames[k] = std::make_shared<const Image<std::uint8_t>>(std::move(moved));
  }
}

TEST_F(CapturedSession, real_sets_raise_no_false_alarm) {
  for (const char* name : {"stereo-bag-calibration", "stereo-bag-scan", "procam-chessboard", "phaseshift-angel"}) {
    const CheckReport report = check_session(open(name));
    for (const Error& error : report.faults) {
      ADD_FAILURE() << name << ": " << error.message();
    }
    for (const LookCheck& look : report.looks) {
      const SequenceReport& r = look.report;
      std::printf(
          "%-22s %-7s %-7s lit %.3f contrast %5.1f saturated %.3f coherent %.4f in panel %.4f phase %.3f moved %.2f "
          "px\n",
          name, look.camera.c_str(), look.look.c_str(), r.lit, r.contrast, r.saturated, r.codes_coherent,
          r.codes_in_panel, r.phase_residual, r.largest_shift_px);
    }
  }
}

struct Corruption {
  std::string name;
  std::function<void(Frames&)> apply;
  std::vector<RCode> named;  // any of these may come first
};

// Every kind of corruption, each at places that `even` chooses: each set has its own.
std::vector<Corruption> gray_corruptions(int bits, bool even) {
  using Swaps = std::vector<std::pair<std::size_t, std::size_t>>;
  const auto n = static_cast<std::size_t>(bits);
  std::vector<Corruption> all;
  const auto add = [&](std::string name, std::vector<RCode> codes, std::function<void(Frames&)> apply) {
    all.push_back({std::move(name), std::move(apply), std::move(codes)});
  };
  for (const auto& [a, b] :
       even ? Swaps{{2, 4}, {3, 2 * n + 6}, {7, 4 * n + 1}} : Swaps{{5, 8}, {4, 4 * n}, {2, 2 * n - 8}}) {
    add("swap " + std::to_string(a) + " and " + std::to_string(b), {RCode::kFramesOutOfOrder},
        [a = a, b = b](Frames& f) { std::swap(f[a], f[b]); });
  }
  for (const std::size_t bit : {even ? std::size_t{2} : std::size_t{4}, n + 3}) {
    add("inverse of pair " + std::to_string(bit) + " swapped", {RCode::kInverseSwapped},
        [bit](Frames& f) { std::swap(f[2 * bit], f[2 * bit + 1]); });
    add("pairs " + std::to_string(bit) + " and the next exchanged", {RCode::kFramesOutOfOrder}, [bit](Frames& f) {
      std::swap(f[2 * bit], f[2 * bit + 2]);
      std::swap(f[2 * bit + 1], f[2 * bit + 3]);
    });
    add("frame " + std::to_string(2 * bit) + " repeated", {RCode::kFramesDoubled},
        [bit](Frames& f) { f[2 * bit + 2] = f[2 * bit]; });
    add("pair " + std::to_string(bit) + " repeated", {RCode::kFramesDoubled}, [bit](Frames& f) {
      f[2 * bit + 2] = f[2 * bit];
      f[2 * bit + 3] = f[2 * bit + 1];
    });
    add("frame " + std::to_string(2 * bit) + " black", {RCode::kFramesBlack},
        [bit](Frames& f) { f[2 * bit] = f.back(); });
    add("frame " + std::to_string(2 * bit) + " saturated", {RCode::kFramesSaturated},
        [bit](Frames& f) { f[2 * bit] = filled(f[2 * bit], 255); });
  }
  add("all inverses swapped", {RCode::kInverseSwapped}, [n](Frames& f) {
    for (std::size_t k = 0; k < 4 * n; k += 2) {
      std::swap(f[k], f[k + 1]);
    }
  });
  add("white and black exchanged", {RCode::kFramesOutOfOrder, RCode::kFramesBlack},
      [](Frames& f) { std::swap(f[f.size() - 1], f[f.size() - 2]); });
  add("one frame late", {RCode::kFramesOutOfOrder, RCode::kFramesBlack},
      [](Frames& f) { std::rotate(f.begin(), f.end() - 1, f.end()); });
  add("columns and rows exchanged", {RCode::kFramesOutOfOrder},
      [n](Frames& f) { std::rotate(f.begin(), f.begin() + static_cast<long>(2 * n), f.end() - 2); });
  add("all black", {RCode::kFramesBlack}, [](Frames& f) { std::ranges::fill(f, filled(f.front(), 3)); });
  add("projector off", {RCode::kFramesBlack}, [](Frames& f) { std::ranges::fill(f, Frame(f.back())); });
  add("all saturated", {RCode::kFramesSaturated}, [](Frames& f) { std::ranges::fill(f, filled(f.front(), 255)); });
  for (const int px : {2, 12}) {
    const std::size_t first = even == (px == 2) ? 9 : 3 * n;
    add("nudged by " + std::to_string(px) + " px at frame " + std::to_string(first), {RCode::kSceneMoved},
        [px, first](Frames& f) { nudge(f, first, px); });
  }
  return all;
}

TEST_F(CapturedSession, corrupted_gray_sets_are_refused_with_their_own_name) {
  for (const auto& [name, bits] : {std::pair{"stereo-bag-scan", 11}, std::pair{"procam-chessboard", 10}}) {
    const Session session = open(name);
    const Frames sound = load(session, 0, 0);
    for (const Corruption& corruption : gray_corruptions(bits, bits % 2 == 0)) {
      Frames frames = sound;
      corruption.apply(frames);
      const SequenceReport report = judge(session, frames);
      const bool named =
          !report.good() && std::ranges::find(corruption.named, report.faults.front().rcode) != corruption.named.end();
      EXPECT_TRUE(named) << name << ", " << corruption.name << " (moved " << report.largest_shift_px << " px, coherent "
                         << report.codes_coherent << "): " << text(report);
    }
  }
}

TEST_F(CapturedSession, corrupted_phase_sets_are_refused_with_their_own_name) {
  const Session session = open("phaseshift-angel");
  const std::vector<Corruption> corruptions = {
      {"steps 2 and 5 exchanged", [](Frames& f) { std::swap(f[4], f[7]); }, {RCode::kFramesOutOfOrder}},
      {"step repeated", [](Frames& f) { f[5] = f[4]; }, {RCode::kFramesDoubled}},
      {"step black", [](Frames& f) { f[6] = f[1]; }, {RCode::kFramesBlack}},
      {"step saturated", [](Frames& f) { f[6] = filled(f[6], 255); }, {RCode::kFramesSaturated}},
      {"one frame late",
       [](Frames& f) { std::rotate(f.begin(), f.end() - 1, f.end()); },
       {RCode::kFramesOutOfOrder, RCode::kFramesBlack, RCode::kFramesDoubled}},
      {"nudged by 3 px between the sequences", [](Frames& f) { nudge(f, 10, 3); }, {RCode::kSceneMoved}},
  };
  const Frames sound = load(session, 0, 0);
  for (const Corruption& corruption : corruptions) {
    Frames frames = sound;
    corruption.apply(frames);
    const SequenceReport report = judge(session, frames);
    const bool named =
        !report.good() && std::ranges::find(corruption.named, report.faults.front().rcode) != corruption.named.end();
    EXPECT_TRUE(named) << corruption.name << " (moved " << report.largest_shift_px << " px, phase "
                       << report.phase_residual << "): " << text(report);
  }
}

}  // namespace
}  // namespace raysteer::host::session
