// shared: what the solver library says on its own. Programs decide, not libraries: call it first thing in main.
#pragma once

namespace raysteer::calib::solve {

/// Keeps glog, through which Ceres reports every step that it takes back, off standard error. What matters of it comes
/// back as an Error.
void quiet_solver();

}  // namespace raysteer::calib::solve
