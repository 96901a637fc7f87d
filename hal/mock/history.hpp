// value: what something was, and since when.
#pragma once

#include <algorithm>
#include <deque>
#include <utility>

#include "hal/base/time.hpp"

namespace raysteer::hal::mock {

/// A value that changes at instants. Changes are told in order of time; a change at an instant already told of
/// replaces what was said from there on.
template <class T>
class History {
 public:
  struct Change {
    RigTime at;
    T value;
  };

  explicit History(T at_first) { changes_.push_back({RigTime::min(), std::move(at_first)}); }

  void set(RigTime at, T value) {
    while (changes_.size() > 1 && changes_.back().at >= at) {
      changes_.pop_back();
    }
    changes_.push_back({at, std::move(value)});
  }

  /// The value at `at`: that of the last change not after it.
  const T& at(RigTime at) const { return (after(at) - 1)->value; }
  const T& last() const { return changes_.back().value; }
  RigTime last_change() const { return changes_.back().at; }

  /// When the value at `at` began.
  RigTime change_before(RigTime at) const { return (after(at) - 1)->at; }
  /// The first change after `at`, or RigTime::max().
  RigTime next_change(RigTime at) const {
    const auto next = after(at);
    return next == changes_.end() ? RigTime::max() : next->at;
  }

  /// Forgets what was before `at`, but not the value it left.
  void forget(RigTime at) {
    while (changes_.size() > 1 && changes_[1].at <= at) {
      changes_.pop_front();
    }
  }

 private:
  auto after(RigTime at) const {
    return std::ranges::upper_bound(changes_, at, {}, [](const Change& change) { return change.at; });
  }

  std::deque<Change> changes_;
};

}  // namespace raysteer::hal::mock
