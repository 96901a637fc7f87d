#include "hal/projector.hpp"

#include <string>

#include "hal/late.hpp"

namespace raysteer::hal {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

Status check_fits(int width, int height, const ProjectorPanel& panel) {
  if (width == panel.width && height == panel.height) {
    return ok();
  }
  return fail(RCode::kPanelSize,
              "expected " + size_text(panel.width, panel.height) + ", got " + size_text(width, height));
}

}  // namespace

Projector::Projector(const Clock& clock, Interlock& interlock, ProjectorPanel panel)
    : clock_(clock), interlock_(interlock), panel_(panel) {
  RAYSTEER_CHECK(panel.width > 0 && panel.height > 0 && panel.frame_period.count() > 0);
}

Status Projector::light(bool on) {
  if (!on) {
    lit_since_.reset();
    return do_light(false);
  }
  const Result<InterlockState> loop = interlock_.state();
  if (!loop) {
    return fail(RCode::kInterlockOpen, "light refused: the loop cannot be read (" + loop.error().message() + ")");
  }
  if (!loop->closed) {
    return fail(RCode::kInterlockOpen, "light refused");
  }
  RAYSTEER_TRY(do_light(true));
  if (!lit_since_) {
    lit_since_ = clock_.now();
  }
  return ok();
}

bool Projector::light_is_on() {
  if (!lit_since_) {
    return false;
  }
  const Result<InterlockState> loop = interlock_.state();
  if (!loop || !loop->closed || loop->since > *lit_since_) {
    lit_since_.reset();
    // The hardware has cut the light already; this keeps it from coming back. If it fails, the latch still holds.
    static_cast<void>(do_light(false));
    return false;
  }
  return true;
}

Status Projector::load(const PatternSequence& sequence) {
  RAYSTEER_TRY(check(sequence));
  RAYSTEER_TRY(check_fits(sequence.panel_width, sequence.panel_height, panel_));
  if (playing()) {
    return fail(RCode::kProjectorBusy, "patterns cannot be replaced while they play");
  }
  RAYSTEER_TRY(do_load(sequence));
  sequence_ = sequence;
  return ok();
}

Status Projector::store(int number, ImageView<const std::uint8_t> picture) {
  if (number < 0 || number >= static_cast<int>(stored_.size())) {
    return fail(RCode::kBadValue, "a content picture's number is 0 to 255, got " + std::to_string(number), number);
  }
  RAYSTEER_TRY(check_fits(picture.width(), picture.height(), panel_));
  RAYSTEER_TRY(do_store(number, picture));
  stored_[static_cast<std::size_t>(number)] = true;
  return ok();
}

Status Projector::check_stored(const Shown& what) const {
  if (const auto* pattern = std::get_if<StoredPattern>(&what)) {
    if (pattern->index < 0 || pattern->index >= sequence_.frames()) {
      return fail(RCode::kNothingStored,
                  "pattern " + std::to_string(pattern->index) + " of " + std::to_string(sequence_.frames()) + " loaded",
                  pattern->index);
    }
  }
  if (const auto* content = std::get_if<ContentFrame>(&what)) {
    if (content->number < 0 || content->number > 255 || !stored_[static_cast<std::size_t>(content->number)]) {
      return fail(RCode::kNothingStored, "content picture " + std::to_string(content->number), content->number);
    }
  }
  return ok();
}

Status Projector::show(Shown what, RigTime at) {
  RAYSTEER_TRY(check_stored(what));
  if (playing()) {
    return fail(RCode::kProjectorBusy, "nothing else can be shown while patterns play");
  }
  RAYSTEER_TRY(check_in_time("show", at, clock_.now()));
  return do_show(what, at);
}

}  // namespace raysteer::hal
