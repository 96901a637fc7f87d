#include "calib/decode/sequence_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include "calib/decode/sequence_set.hpp"
#include "calib/decode/sequence_steps.hpp"

namespace raysteer::calib::decode {

void Findings::fault(RCode rcode, std::string note, int frame) {
  report.faults.push_back(fail(rcode, std::move(note), frame));
}

void Findings::warn(RCode rcode, std::string note, int frame) {
  report.warnings.push_back(fail(rcode, std::move(note), frame));
}

void Findings::dispute(const std::vector<int>& frames) { std::ranges::copy(frames, std::back_inserter(disputed)); }

bool Findings::is_disputed(int frame) const { return std::ranges::find(disputed, frame) != disputed.end(); }

namespace {

// The cause before its consequences: a nudge makes the one pair it falls into contradict itself, and fine stripes
// miss coarse ones.
void settle(Findings& findings) {
  std::vector<Error>& faults = findings.report.faults;
  const auto first = [&](RCode rcode) {
    std::stable_partition(faults.begin(), faults.end(), [&](const Error& error) { return error.rcode == rcode; });
  };
  const bool moved = std::ranges::any_of(faults, [](const Error& error) { return error.rcode == RCode::kSceneMoved; });
  if (moved && findings.broken_pairs <= 1) {
    first(RCode::kSceneMoved);
  } else if (findings.black_frame_lit) {
    first(RCode::kFramesOutOfOrder);  // the black frame is elsewhere, where light is missing
  }
}

SequenceReport judge(const SampledSet& set) {
  Findings findings;
  if (judge_light(set, findings)) {
    judge_single_frames(set, findings);
    judge_doubled(set, findings);
    judge_complements(set, findings);
    judge_codes(set, findings);
    judge_phase(set, findings);
    judge_movement(set, findings);
    settle(findings);
  }
  return std::move(findings.report);
}

}  // namespace

SequenceCheck::SequenceCheck(const PatternSequence& sequence, const Region& within, int bits, int most_tiles)
    : sequence_(sequence), bits_(bits), side_(std::min({kTileSide, within.width, within.height})) {
  const auto [left, top, width, height] = within;
  samples_.resize(static_cast<std::size_t>(sequence.frames()));
  if (side_ < 1) {
    return;
  }
  // About square spacing; rows of tiles stand in a brick bond (by the golden section), so that no vertical edge of a
  // stripe can hide between the columns of tiles.
  const double spacing =
      std::max<double>(side_, std::sqrt(static_cast<double>(width) * height / static_cast<double>(most_tiles)));
  const int down = std::max(1, static_cast<int>(height / spacing));
  const int across = std::max(1, static_cast<int>(width / spacing));
  for (int row = 0; row < down; ++row) {
    const double offset = row * std::numbers::phi - std::floor(row * std::numbers::phi);
    for (int column = 0; column < across; ++column) {
      const double room_x = static_cast<double>(width) / across - side_;
      const double room_y = static_cast<double>(height) / down - side_;
      const double shift_y = (column * std::numbers::phi) - std::floor(column * std::numbers::phi);
      tiles_.push_back(
          {left + static_cast<int>(column * static_cast<double>(width) / across + offset * std::max(room_x, 0.0)),
           top + static_cast<int>(row * static_cast<double>(height) / down + shift_y * std::max(room_y, 0.0))});
    }
  }
}

template <class Pixel>
void SequenceCheck::take(int index, ImageView<const Pixel> frame) {
  std::vector<std::uint16_t>& out = samples_[static_cast<std::size_t>(index)];
  const auto area = static_cast<std::size_t>(side_) * side_;
  out.resize(tiles_.size() * area);
  auto to = out.begin();
  for (const Corner& corner : tiles_) {
    for (int y = 0; y < side_; ++y) {
      to = std::copy_n(frame.row(corner.y + y) + corner.x, side_, to);
    }
  }
}

void SequenceCheck::add(int index, ImageView<const std::uint8_t> frame) { take(index, frame); }
void SequenceCheck::add(int index, ImageView<const std::uint16_t> frame) { take(index, frame); }

SequenceReport SequenceCheck::report() const {
  const auto missing = std::ranges::count_if(samples_, [](const auto& frame) { return frame.empty(); });
  if (missing > 0 || samples_.empty()) {
    SequenceReport report;
    report.faults.push_back(
        fail(RCode::kFrameCount, "the sequence has " + std::to_string(samples_.size()) + " frames, " +
                                     std::to_string(static_cast<long>(samples_.size()) - missing) + " came"));
    return report;
  }
  return judge(SampledSet(sequence_, samples_, bits_, side_));
}

Status SequenceCheck::verdict() const {
  SequenceReport all = report();
  if (!all.faults.empty()) {
    return std::move(all.faults.front());
  }
  return ok();
}

}  // namespace raysteer::calib::decode
