// Fills a command's options from words; the only file behind it that knows CLI11.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "host/cli/command.hpp"

namespace raysteer::host::cli {

/// The options that the framework adds to a command's own.
void declare_common(const Manual& manual, CommonOptions& common, bool& help, Options& options);

/// Errors: kUsage, naming the nearest known option for an unknown one. With `help` set by the words, what is required
/// may be missing.
Status parse(const Options& options, const bool& help, std::vector<std::string> words);

}  // namespace raysteer::host::cli
