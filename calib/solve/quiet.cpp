#include "calib/solve/quiet.hpp"

#include <glog/logging.h>

namespace raysteer::calib::solve {

void quiet_solver() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace raysteer::calib::solve
