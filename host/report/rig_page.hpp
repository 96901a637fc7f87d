// pure: the body of a steered rig's page.
#pragma once

#include <string>

#include "host/report/rig_result.hpp"

namespace raysteer::host::report {

/// Everything below the verdict: numbers, maps, tables.
std::string rig_body(const RigResult& result);

}  // namespace raysteer::host::report
