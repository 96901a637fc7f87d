// value: faults that were asked for, and the words for them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace raysteer::hal::mock {

/// Which device, what, from when, how often. Text form on command lines and in board files: "left.drop@2s*3".
struct Fault {
  std::string device;
  std::string what;
  RigTime from{};     ///< may happen from then on
  int times = 1;      ///< so often; 0: for ever
  double amount = 0;  ///< unit depends on the word; 0: the word's own
  bool operator==(const Fault&) const = default;
};

/// One word that a device knows.
struct FaultWord {
  std::string_view device;  ///< "eye" stands for "left" and "right"
  std::string_view what;
  std::string_view meaning;
  std::string_view unit;  ///< of the amount; empty: it has none
  double amount = 0;      ///< when none is given; infinity: for ever
};

/// Every word, grouped by device: what `--fault help` prints.
std::span<const FaultWord> fault_words();

/// kBadValue: no such device or word (with the nearest known), or a negative count or an amount that is not a number.
Status check(const Fault& fault);

/// The faults of one device, counted down as they happen.
class Faults {
 public:
  /// Those of `all` that name `device`, which must have passed check().
  Faults(std::span<const Fault> all, std::string_view device);

  /// Something of this kind may go wrong at `at`: the amount if it does, which uses it up by one.
  std::optional<double> take(std::string_view what, RigTime at);

  /// A condition: the amount while a fault of this kind lasts. With a unit of seconds it lasts that long, `times` times
  /// with as long a pause in between; otherwise for ever from its beginning on.
  std::optional<double> lasting(std::string_view what, RigTime at) const;

 private:
  struct Pending {
    Fault fault;
    double amount = 0;
    bool in_seconds = false;
    int taken = 0;
  };
  std::vector<Pending> pending_;
};

}  // namespace raysteer::hal::mock
