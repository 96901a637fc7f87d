#include "hal/mock/fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hal/base/nearest.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {
namespace {

constexpr double kEver = std::numeric_limits<double>::infinity();

// "eye" rows hold for "left" and for "right".
constexpr std::array kWords{
    FaultWord{"mirror", "unplug", "answers nothing and stands still", "s", kEver},
    FaultWord{"mirror", "refuse", "does not answer one command", "", 0},
    FaultWord{"mirror", "nan", "one reading of the sensor is not a number", "", 0},
    FaultWord{"mirror", "rail", "one reading of the sensor is beyond what it can read", "", 0},
    FaultWord{"mirror", "stuck", "stands still whatever it is told", "s", kEver},
    FaultWord{"mirror", "ring", "oscillates, seen by its sensor", "rad", 500e-6},
    FaultWord{"mirror", "bump", "was knocked: truly stands off, unseen by its sensor", "rad", 1e-3},
    FaultWord{"mirror", "sensor", "the sensor reads off by so much", "rad", 500e-6},
    FaultWord{"mirror", "hot", "the servo folds back: so much slower", "times", 4},
    FaultWord{"projector", "unplug", "answers nothing and shows nothing", "s", kEver},
    FaultWord{"projector", "nak", "does not answer one command", "", 0},
    FaultWord{"projector", "late", "a picture misses its vblank, and is said to", "", 0},
    FaultWord{"projector", "drop", "a picture's first frame is not lit, though said to be shown", "", 0},
    FaultWord{"projector", "tear", "a picture's first frame is torn at this part of its height", "of height", 0.5},
    FaultWord{"projector", "wrong-screen", "the panel shows a grey desktop", "", 0},
    FaultWord{"projector", "lamp-off", "the lamp sleeps", "s", kEver},
    FaultWord{"projector", "latency", "light comes so much later", "frames", 1},
    FaultWord{"eye", "unplug", "answers nothing", "s", kEver},
    FaultWord{"eye", "miss", "does not see one trigger edge", "", 0},
    FaultWord{"eye", "drop", "one frame is lost, and counted", "", 0},
    FaultWord{"eye", "late", "one frame arrives so much later", "s", 0.2},
    FaultWord{"eye", "damage", "part of one frame is missing, and flagged", "of rows", 0.25},
    FaultWord{"eye", "stamp", "the stamp of one frame is off", "s", 5e-3},
    FaultWord{"eye", "extra", "one frame that nobody asked for at stream start", "", 0},
    FaultWord{"eye", "auto", "exposure controls itself until configured again: so much longer", "times", 2},
    FaultWord{"eye", "ignore", "keeps an exposure so much longer than asked, and says so", "times", 2},
    FaultWord{"eye", "black", "one frame is black", "", 0},
    FaultWord{"eye", "bright", "one frame gets so much light", "times", 50},
    FaultWord{"eye", "blur", "out of focus: a box of so many pixels", "px", 15},
    FaultWord{"cameras", "swap", "left and right change places", "", 0},
    FaultWord{"cameras", "bandwidth", "the bus carries only this part", "of bus", 0.1},
    FaultWord{"trigger", "unplug", "answers nothing, lets nothing through", "s", kEver},
    FaultWord{"trigger", "miss", "one edge is missing", "", 0},
    FaultWord{"trigger", "double", "one edge bounces so much later", "s", 200e-6},
    FaultWord{"trigger", "late", "one edge comes so much later", "s", 5e-3},
    FaultWord{"interlock", "open", "a switch opens", "s", kEver},
    FaultWord{"interlock", "flap", "a switch opens, so often, with as long in between", "s", 2e-3},
    FaultWord{"interlock", "unplug", "the loop cannot be read", "s", kEver},
    FaultWord{"store", "unplug", "the medium does not answer", "s", kEver},
    FaultWord{"store", "full", "no byte fits any more", "s", kEver},
    FaultWord{"store", "read-only", "takes no write", "s", kEver},
    FaultWord{"store", "io-error", "one write fails", "", 0},
    FaultWord{"store", "rot", "one bit of what is read next has flipped", "", 0},
    FaultWord{"store", "power-cut", "power fails at the n-th write from then on", "n", 1},
    FaultWord{"clock", "step", "the wall clock steps", "s", 3'600},
};

/// The row of a word, or the first of what to suggest.
bool is_eye(std::string_view device) { return device == "left" || device == "right"; }

std::string_view row_name(std::string_view device) { return is_eye(device) ? "eye" : device; }

const FaultWord* find(std::string_view device, std::string_view what) {
  const auto found = std::ranges::find_if(
      kWords, [&](const FaultWord& word) { return word.device == row_name(device) && word.what == what; });
  return found == kWords.end() ? nullptr : &*found;
}

constexpr std::array<std::string_view, 9> kDevices{"mirror",  "projector", "left",  "right", "cameras",
                                                   "trigger", "interlock", "store", "clock"};

std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) {
    text += (text.empty() ? "" : ", ") + std::string(word);
  }
  return text;
}

}  // namespace

std::span<const FaultWord> fault_words() { return kWords; }

Status check(const Fault& fault) {
  if (std::ranges::find(kDevices, fault.device) == kDevices.end()) {
    return fail(RCode::kBadValue, "no device '" + fault.device + "' has faults; expected " +
                                      listed({kDevices.begin(), kDevices.end()}) +
                                      did_you_mean(fault.device, kDevices));
  }
  if (find(fault.device, fault.what) == nullptr) {
    std::vector<std::string_view> known;
    for (const FaultWord& word : kWords) {
      if (word.device == row_name(fault.device)) {
        known.push_back(word.what);
      }
    }
    return fail(RCode::kBadValue, "'" + fault.device + "' knows no fault '" + fault.what + "'; expected " +
                                      listed(known) + did_you_mean(fault.what, known));
  }
  if (fault.times < 0 || !std::isfinite(fault.amount)) {
    return fail(RCode::kBadValue, fault.device + "." + fault.what + ": expected a count from 0 on and a finite amount");
  }
  return ok();
}

Faults::Faults(std::span<const Fault> all, std::string_view device) {
  for (const Fault& fault : all) {
    if (fault.device == device) {
      const FaultWord* word = find(fault.device, fault.what);
      RAYSTEER_CHECK(word != nullptr);
      pending_.push_back(
          {.fault = fault, .amount = fault.amount != 0 ? fault.amount : word->amount, .in_seconds = word->unit == "s"});
    }
  }
}

std::optional<double> Faults::take(std::string_view what, RigTime at) {
  for (Pending& pending : pending_) {
    const Fault& fault = pending.fault;
    if (fault.what == what && at >= fault.from && (fault.times == 0 || pending.taken < fault.times)) {
      ++pending.taken;
      return pending.amount;
    }
  }
  return std::nullopt;
}

std::optional<double> Faults::lasting(std::string_view what, RigTime at) const {
  for (const Pending& pending : pending_) {
    const Fault& fault = pending.fault;
    if (fault.what != what || at < fault.from) {
      continue;
    }
    if (!pending.in_seconds || std::isinf(pending.amount)) {
      return pending.amount;
    }
    const double cycles = seconds(at - fault.from) / (2 * pending.amount);
    const bool over = fault.times != 0 && cycles >= fault.times;
    if (!over && cycles - std::floor(cycles) < 0.5) {
      return pending.amount;
    }
  }
  return std::nullopt;
}

}  // namespace raysteer::hal::mock
