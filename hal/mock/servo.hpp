// bound to one mirror: how one axis follows its command.
#pragma once

#include "hal/mock/mirror_parameters.hpp"

namespace raysteer::hal::mock {

/// Rate and acceleration limit, then x'' = natural^2 (r - x) - 2 damping natural x', stepped exactly for an r that
/// stands still during the step. The pure delay is the mirror's.
class Servo {
 public:
  Servo(const AxisDynamics& dynamics, double travel) : dynamics_(dynamics), travel_(travel) {}

  void command(double target) { target_ = target; }
  /// `dt` in seconds; limits are divided by `slower`. At the mechanical stop it stands still.
  void step(double dt, double slower = 1);
  /// The command is reached and nothing moves.
  bool at_rest() const { return reference_ == target_ && position_ == reference_ && speed_ == 0; }
  /// Stands still where it is, whatever it is told.
  void freeze();

  double position() const { return position_; }
  double speed() const { return speed_; }
  double target() const { return target_; }

 private:
  void step_reference(double dt, double rate, double acceleration);

  AxisDynamics dynamics_;
  double travel_;
  double target_ = 0;
  double reference_ = 0;  ///< the limited command
  double reference_speed_ = 0;
  double position_ = 0;
  double speed_ = 0;
};

}  // namespace raysteer::hal::mock
