// A trigger-master steps through stored patterns by itself. Patterns that follow one another are one run; its edges
// come a period apart, the first at an unknown small time after the command.
#include <algorithm>
#include <cmath>
#include <string>

#include "firmware/capture/timeline.hpp"

namespace raysteer::firmware::capture {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

/// A run that is so much later than it should have ended hangs.
constexpr nanoseconds kPatience{1'000'000'000};

class PlayerTimeline : public Timeline {
 public:
  explicit PlayerTimeline(const hal::Rig& rig) : rig_(rig) {}

  Status begin(std::vector<Slot>& slots, nanoseconds exposure, RigTime now) override {
    slots_ = &slots;
    exposure_ = exposure;
    first_ = 0;
    count_ = 0;
    rest_since_ = now;
    return rig_.player->trigger_output(true);
  }

  Status tick(RigTime now) override {
    if (done()) {
      return ok();
    }
    if (count_ == 0) {
      return begin_run(now);
    }
    auto state = rig_.player->state();
    if (!state) {
      return std::move(state).error();
    }
    for (std::size_t i = first_; i < first_ + count_; ++i) {
      Slot& slot = (*slots_)[i];
      slot.over = now > *slot.expected + exposure_ || !state->playing;
    }
    if (state->playing) {
      if (now > began_ + count_ * period() + kPatience) {
        return fail(RCode::kDeviceUnavailable, "a run of " + std::to_string(count_) + " patterns does not end");
      }
      return ok();
    }
    first_ += count_;
    count_ = 0;
    rest_since_ = now;
    return ok();
  }

  Slot* slot_of(const hal::TriggerEdge& edge) override {
    if (last_count_ == 0 || edge.stamp < began_ - period() / 3) {
      return nullptr;
    }
    const double periods = static_cast<double>((edge.stamp - began_).count()) / static_cast<double>(period().count());
    if (!offset_) {
      // An edge of the run's pattern k comes k periods after the first, which comes within a period.
      const auto whole = static_cast<int>(std::floor(periods + 0.1));
      offset_ = edge.stamp - began_ - whole * period();
      expect_edges();
    }
    for (std::size_t i = last_; i < last_ + last_count_; ++i) {
      Slot& slot = (*slots_)[i];
      if (belongs(edge, slot)) {
        return &slot;
      }
    }
    return nullptr;
  }

  bool done() const override { return first_ >= slots_->size(); }

 private:
  nanoseconds period() const { return (*slots_)[last_].order.length; }

  Status begin_run(RigTime now) {
    while (first_ < slots_->size() && !(*slots_)[first_].order.shot) {
      (*slots_)[first_++].over = true;
    }
    if (done() || now < rest_since_ + (*slots_)[first_].order.delay) {
      return ok();
    }
    const Order& lead = (*slots_)[first_].order;
    std::size_t count = 1;
    for (; first_ + count < slots_->size(); ++count) {
      const Order& next = (*slots_)[first_ + count].order;
      if (!next.shot || next.delay.count() != 0 || next.length != lead.length ||
          next.pattern != lead.pattern + static_cast<int>(count)) {
        break;
      }
    }
    const auto lit = std::chrono::floor<microseconds>(exposure_);
    RAYSTEER_TRY(rig_.player->play({.first = lead.pattern,
                                    .count = static_cast<int>(count),
                                    .exposure = lit,
                                    .period = std::chrono::ceil<microseconds>(lead.length)}));
    began_ = now;
    count_ = count;
    last_ = first_;
    last_count_ = count;
    offset_.reset();
    expect_edges();
    return ok();
  }

  void expect_edges() {
    for (std::size_t i = 0; i < last_count_; ++i) {
      Slot& slot = (*slots_)[last_ + i];
      slot.shown = began_;
      slot.expected = began_ + offset_.value_or(nanoseconds(0)) + static_cast<int>(i) * period();
    }
  }

  const hal::Rig rig_;
  std::vector<Slot>* slots_ = nullptr;
  nanoseconds exposure_{};
  std::size_t first_ = 0;  ///< of the present run, or of the next
  std::size_t count_ = 0;  ///< 0: none is playing
  std::size_t last_ = 0;   ///< of the newest run, whose edges may still come
  std::size_t last_count_ = 0;
  RigTime began_{};
  RigTime rest_since_{};
  std::optional<nanoseconds> offset_;
};

}  // namespace

std::unique_ptr<Timeline> make_player_timeline(const hal::Rig& rig) { return std::make_unique<PlayerTimeline>(rig); }

}  // namespace raysteer::firmware::capture
