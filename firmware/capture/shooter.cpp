#include "firmware/capture/shooter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace raysteer::firmware::capture {
namespace {

using std::chrono::nanoseconds;

/// Read-out, bus and the wait for a partner.
constexpr nanoseconds kTransfer{150'000'000};
/// Jitter of an edge, at most.
constexpr nanoseconds kEdgeOff{1'000'000};
/// The two eyes of one trigger (StereoCamera pairs within as much).
constexpr nanoseconds kApart{500'000};

const char* name_of(std::size_t eye) { return eye == 0 ? "left" : "right"; }

std::string milliseconds(nanoseconds time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f ms", static_cast<double>(time.count()) * 1e-6);
  return text;
}

}  // namespace

Shooter::Shooter(const hal::Rig& rig)
    : rig_(rig), timeline_(rig.player != nullptr ? make_player_timeline(rig) : make_display_timeline(rig)) {}

void Shooter::streams_started() { base_ = {}; }

Status Shooter::begin(const std::vector<Order>& orders, nanoseconds exposure, bool learn, RigTime now) {
  slots_.clear();
  outcomes_.clear();
  given_ = 0;
  exposure_ = exposure;
  learning_ = learn;
  unplaced_ = {};
  allowance_ = kTransfer;
  for (const hal::Eye eye : hal::kEyes) {
    auto info = rig_.cameras.info(eye);
    if (!info) {
      return std::move(info).error();
    }
    allowance_ = std::max<nanoseconds>(allowance_, kTransfer + info->least_period);
  }
  for (const Order& order : orders) {
    slots_.push_back(
        {.order = order, .shown = {}, .expected = {}, .fault = {}, .edges = {}, .frames = {}, .mirror = {}});
  }
  return timeline_->begin(slots_, exposure, now);
}

Status Shooter::tick(RigTime now) {
  if (idle()) {
    return ok();
  }
  RAYSTEER_TRY(read_edges());
  RAYSTEER_TRY(read_frames(now));
  if (learning_ && all_frames_due(now)) {
    std::vector<RigTime> edges;
    for (const Slot& slot : slots_) {
      for (const hal::TriggerEdge& edge : slot.edges) {
        edges.push_back(edge.stamp);
      }
    }
    std::array<std::vector<CameraTime>, 2> stamps;
    for (const std::size_t eye : {0U, 1U}) {
      std::ranges::transform(unplaced_[eye], std::back_inserter(stamps[eye]), &hal::EyeFrame::stamp);
    }
    // Both eyes share one clock.
    if (!match_.learn(edges, stamps[0])) {
      match_.learn(edges, stamps[1]);
    }
    learning_ = false;
    for (const std::size_t eye : {0U, 1U}) {
      for (hal::EyeFrame& frame : std::exchange(unplaced_[eye], {})) {
        place(eye, std::move(frame));
      }
    }
  }
  while (!learning_ && given_ < slots_.size()) {
    Slot& slot = slots_[given_];
    if (slot.order.shot) {
      if (!slot.over || !(complete(slot) || now > deadline(slot))) {
        break;
      }
      Outcome outcome{.order = slot.order, .mirror = slot.mirror, .pair = {}, .fault = slot.fault};
      judge(slot, outcome);
      outcomes_.push_back(std::move(outcome));
    } else if (!slot.over) {
      break;
    }
    slot.frames = {};
    ++given_;
  }
  return timeline_->tick(now);
}

std::optional<Outcome> Shooter::next() {
  if (outcomes_.empty()) {
    return std::nullopt;
  }
  Outcome outcome = std::move(outcomes_.front());
  outcomes_.pop_front();
  return outcome;
}

Status Shooter::read_edges() {
  auto edges = rig_.trigger.edges();
  if (!edges) {
    return std::move(edges).error();
  }
  for (const hal::TriggerEdge& edge : *edges) {
    Slot* slot = timeline_->slot_of(edge);
    if (slot == nullptr) {
      continue;
    }
    slot->edges.push_back(edge);
    auto reading = rig_.mirror.feedback();
    if (reading) {
      slot->mirror = *reading;
    } else if (reading.error().rcode == RCode::kDeviceUnavailable) {
      return std::move(reading).error();
    } else {
      slot->fault = std::move(reading).error();
    }
  }
  return ok();
}

Status Shooter::read_frames(RigTime now) {
  while (true) {
    auto pair = rig_.cameras.next_pair(now);
    if (!pair) {
      return std::move(pair).error();
    }
    if (!pair->has_value()) {
      return ok();
    }
    auto [left, right] = std::move(**pair);
    if (left) {
      place(0, std::move(*left));
    }
    if (right) {
      place(1, std::move(*right));
    }
  }
}

void Shooter::place(std::size_t eye, hal::EyeFrame frame) {
  if (learning_) {
    unplaced_[eye].push_back(std::move(frame));
    return;
  }
  if (match_.known()) {
    const RigTime stamp = match_.to_rig(frame.stamp);
    Slot* nearest = nullptr;
    nanoseconds least{};
    for (Slot& slot : slots_) {
      if (slot.order.shot && slot.expected) {
        const RigTime edge = slot.edges.empty() ? *slot.expected : slot.edges.front().stamp;
        const nanoseconds off = std::chrono::abs(stamp - edge);
        if (nearest == nullptr || off < least) {
          nearest = &slot;
          least = off;
        }
      }
    }
    // A stamp that is off by some milliseconds is still this slot's, and said to be off.
    if (nearest != nullptr && least < std::max(nearest->order.length / 3, match_.tolerance(stamp)) &&
        nearest >= &slots_[given_]) {
      nearest->frames[eye].push_back(std::move(frame));
      return;
    }
  }
  ++extra_frames_;
}

bool Shooter::complete(const Slot& slot) const {
  return !slot.edges.empty() && !slot.frames[0].empty() && !slot.frames[1].empty();
}

RigTime Shooter::deadline(const Slot& slot) const {
  const RigTime edge = slot.expected.value_or(slot.shown.value_or(RigTime{}));
  return edge + exposure_ + allowance_;
}

bool Shooter::all_frames_due(RigTime now) const {
  return timeline_->done() &&
         std::ranges::all_of(slots_, [&](const Slot& slot) { return !slot.order.shot || now > deadline(slot); });
}

void Shooter::judge(Slot& slot, Outcome& outcome) {
  outcome.shown = slot.shown.value_or(RigTime{});
  judge_edges(slot, outcome);
  judge_frames(slot, outcome);
  if (!outcome.fault) {
    outcome.pair = {.left = std::move(slot.frames[0].front()), .right = std::move(slot.frames[1].front())};
  }
}

void Shooter::judge_edges(const Slot& slot, Outcome& outcome) const {
  if (!slot.edges.empty()) {
    outcome.edge = slot.edges.front().stamp;
  }
  if (outcome.fault) {
    return;
  }
  if (slot.edges.empty()) {
    outcome.fault = fail(RCode::kTriggerEdgeMissing,
                         "the line '" + std::string(rig_.player != nullptr ? "projector to cameras" : "trigger out") +
                             "' showed no edge within " + milliseconds(exposure_ + allowance_) + " of its due time");
  } else if (slot.edges.size() > 1) {
    outcome.fault = fail(RCode::kTriggerEdgeExtra,
                         std::to_string(slot.edges.size()) + " edges came for one shot, " +
                             milliseconds(slot.edges[1].stamp - slot.edges[0].stamp) + " apart",
                         static_cast<std::int64_t>(slot.edges.size()));
  } else if (const nanoseconds late = slot.edges.front().stamp - *slot.expected; std::chrono::abs(late) > kEdgeOff) {
    outcome.fault = fail(RCode::kShotApart, "the trigger edge came " + milliseconds(late) + " after its due time");
  }
}

void Shooter::judge_frames(const Slot& slot, Outcome& outcome) {
  for (const std::size_t eye : {0U, 1U}) {
    if (slot.frames[eye].empty()) {
      if (!outcome.fault) {
        outcome.fault =
            fail(RCode::kShotIncomplete, "no frame of the " + std::string(name_of(eye)) + " eye came within " +
                                             milliseconds(allowance_) + " of its exposure");
      }
      continue;
    }
    const hal::EyeFrame& frame = slot.frames[eye].front();
    if (slot.frames[eye].size() > 1 && !outcome.fault) {
      outcome.fault =
          fail(RCode::kTriggerEdgeExtra, "two frames of the " + std::string(name_of(eye)) + " eye came for one shot");
    }
    if (slot.edges.empty()) {
      continue;
    }
    const nanoseconds off = match_.to_rig(frame.stamp) - slot.edges.front().stamp;
    if (std::chrono::abs(off) > match_.tolerance(slot.edges.front().stamp) && !outcome.fault) {
      outcome.fault = fail(RCode::kShotApart, "the " + std::string(name_of(eye)) + " eye's stamp is " +
                                                  milliseconds(off) + " off its trigger edge");
    }
    const std::int64_t base =
        static_cast<std::int64_t>(frame.sequence) - static_cast<std::int64_t>(slot.edges.front().number);
    if (base_[eye] && *base_[eye] != base && !outcome.fault) {
      outcome.fault = fail(RCode::kShotSequence, "the " + std::string(name_of(eye)) + " eye's frame has number " +
                                                     std::to_string(frame.sequence) + ", expected " +
                                                     std::to_string(frame.sequence - base + *base_[eye]));
    }
    base_[eye] = base;
  }
  if (outcome.fault) {
    return;
  }
  const nanoseconds apart = slot.frames[0].front().stamp - slot.frames[1].front().stamp;
  if (std::chrono::abs(apart) > kApart) {
    outcome.fault = fail(RCode::kShotApart, "the eyes' stamps are " + milliseconds(apart) + " apart, at most " +
                                                milliseconds(kApart) + " are allowed");
    return;
  }
  match_.follow(slot.edges.front().stamp, slot.frames[0].front().stamp);
}

}  // namespace raysteer::firmware::capture
