// What a scan found, as result.json, --json and the report say it.
#pragma once

#include <string>

#include "host/cli/context.hpp"
#include "host/report/result.hpp"
#include "host/scan/scan.hpp"

namespace raysteer::host::cli {

/// Names used in sentences: "left and right", "camera and projector".
struct ScanNames {
  std::string session;         ///< path as the user gave it
  std::string calibration;     ///< likewise
  std::string calibration_id;  ///< of calibration.toml
  std::string left, right;     ///< devices
};

/// The report's data, with the verdict and its reasons. `picture` is left empty.
report::ScanResult scan_result(const scan::Scan& scan, const ScanNames& names);

/// What only --json has: depth, plane, refit, rejected, decoded by camera.
void add_scan_details(Json& json, const scan::Scan& scan);

/// "left and right moved by 6.8 mrad since calibration (one sigma 0.4 mrad)"
std::string moved_sentence(const scan::Scan& scan, const ScanNames& names);

}  // namespace raysteer::host::cli
