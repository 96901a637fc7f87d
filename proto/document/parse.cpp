#include "proto/document/parse.hpp"

#include <limits>
#include <utility>

namespace raysteer::proto::document {
namespace {

constexpr std::int64_t kFormat = 1;
constexpr Range<std::int64_t> kAnyInteger{std::numeric_limits<std::int64_t>::min(),
                                          std::numeric_limits<std::int64_t>::max()};

}  // namespace

Result<toml::table> parse(std::string_view text, const std::string& file) {
  toml::parse_result parsed = toml::parse(text, std::string_view(file));
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return fail(RCode::kTomlSyntax,
                file + ":" + std::to_string(error.source().begin.line) + ": " + std::string(error.description()));
  }
  toml::table table = std::move(parsed).table();
  Faults faults;
  TomlTable root({&table}, "", faults);
  const std::int64_t format = root.integer("format", kAnyInteger, kFormat);
  if (format != kFormat) {
    root.fault(RCode::kFormatVersion, "format",
               "is " + std::to_string(format) + ", this program knows " + std::to_string(kFormat));
  }
  RAYSTEER_TRY(faults.status());
  return table;
}

}  // namespace raysteer::proto::document
