// A display shows what it is told from the next vblank on. When that was, it says afterwards; so each vblank is
// predicted from the last one, the trigger scheduled with it, and the shot rejected when the picture came at another.
#include <cmath>
#include <string>

#include "firmware/capture/timeline.hpp"

namespace raysteer::firmware::capture {
namespace {

using std::chrono::nanoseconds;

/// A picture that is not presented so many frames after its vblank never will be.
constexpr int kPatience = 4;
/// A command for the very instant may come too late.
constexpr nanoseconds kNotice{2'000'000};

class DisplayTimeline : public Timeline {
 public:
  explicit DisplayTimeline(const hal::Rig& rig) : rig_(rig), frame_(rig.projector.panel().frame_period) {}

  Status begin(std::vector<Slot>& slots, nanoseconds, RigTime now) override {
    slots_ = &slots;
    current_ = 0;
    stage_ = Stage::kNothingShown;
    if (slots.empty()) {
      return ok();
    }
    // Where the vblanks are is not known: the first picture is shown once without a shot.
    asked_ = now + kNotice;
    return rig_.projector.show(hal::StoredPattern{slots.front().order.pattern}, asked_);
  }

  Status tick(RigTime now) override {
    if (done()) {
      return ok();
    }
    auto presented = rig_.projector.presented();
    if (!presented) {
      return std::move(presented).error();
    }
    const std::optional<hal::Presented>& newest = *presented;
    const bool mine = newest && newest->what == hal::Shown(hal::StoredPattern{slot().order.pattern});
    if (stage_ == Stage::kNothingShown) {
      if (mine && newest->stamp >= asked_) {
        vblank_ = newest->stamp;
        return ask(next_vblank(now));
      }
      if (now > asked_ + 2 * kPatience * frame_) {
        return fail(RCode::kDeviceUnavailable,
                    "the display presented nothing within " + std::to_string(2 * kPatience) + " frames");
      }
      return ok();
    }
    if (!slot().shown) {
      if (mine && newest->stamp >= vblank_ - frame_ / 2) {
        judge(newest->stamp);
      } else if (now > vblank_ + kPatience * frame_) {
        slot().fault = fail(RCode::kFlipLate, "pattern " + std::to_string(slot().order.pattern) +
                                                  " was asked for, and the display never showed it");
        slot().shown = vblank_;
      }
    }
    if (slot().shown) {
      slot().over = true;
      const RigTime wanted = vblank_ + slot().order.length;
      if (current_ + 1 == slots_->size()) {
        ++current_;
      } else {
        ++current_;
        return ask(std::max(wanted, next_vblank(now)));
      }
    }
    return ok();
  }

  Slot* slot_of(const hal::TriggerEdge& edge) override {
    for (Slot& slot : *slots_) {
      if (slot.order.shot && slot.expected && belongs(edge, slot)) {
        return &slot;
      }
    }
    return nullptr;
  }

  bool done() const override { return current_ >= slots_->size(); }

 private:
  enum class Stage { kNothingShown, kRunning };

  Slot& slot() { return (*slots_)[current_]; }

  // A vblank that can still be met: half a frame of notice.
  RigTime next_vblank(RigTime now) const {
    const auto frames = (now - vblank_) / frame_ + 2;
    return vblank_ + std::max<nanoseconds::rep>(frames, 1) * frame_;
  }

  Status ask(RigTime vblank) {
    stage_ = Stage::kRunning;
    vblank_ = vblank;
    RAYSTEER_TRY(rig_.projector.show(hal::StoredPattern{slot().order.pattern}, vblank - frame_ / 2));
    if (slot().order.shot) {
      slot().expected = vblank + slot().order.delay;
      RAYSTEER_TRY(rig_.trigger.fire(*slot().expected));
    }
    return ok();
  }

  void judge(RigTime stamp) {
    const nanoseconds off = stamp - vblank_;
    if (std::chrono::abs(off) > frame_ / 4) {
      slot().fault = fail(RCode::kFlipLate, "pattern " + std::to_string(slot().order.pattern) + " was shown " +
                                                std::to_string(std::llround(static_cast<double>(off.count()) /
                                                                            static_cast<double>(frame_.count()))) +
                                                " frames late");
    }
    slot().shown = stamp;
    vblank_ = stamp;
  }

  const hal::Rig rig_;
  const nanoseconds frame_;
  std::vector<Slot>* slots_ = nullptr;
  std::size_t current_ = 0;
  Stage stage_ = Stage::kNothingShown;
  RigTime asked_{};
  RigTime vblank_{};  ///< of the current slot, predicted; afterwards as presented
};

}  // namespace

std::unique_ptr<Timeline> make_display_timeline(const hal::Rig& rig) { return std::make_unique<DisplayTimeline>(rig); }

}  // namespace raysteer::firmware::capture
