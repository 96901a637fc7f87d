// What commands print as JSON fits the schemas in docs/json. The checker knows the few words our schemas use.
#include <gtest/gtest.h>

#include <limits>

#include "host/report/result.hpp"
#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

using nlohmann::json;
using support::ScratchFolder;

bool is_of_type(const json& value, const std::string& type) {
  return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
         (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
         (type == "integer" && value.is_number_integer()) || (type == "number" && value.is_number()) ||
         (type == "null" && value.is_null());
}

// The first fault, or nothing.
std::string fault(const json& schema, const json& value, const std::string& place) {
  if (schema.contains("type")) {
    const json& type = schema.at("type");
    bool fits = type.is_string() && is_of_type(value, type.get<std::string>());
    for (std::size_t i = 0; type.is_array() && i < type.size(); ++i) {
      fits = fits || is_of_type(value, type[i].get<std::string>());
    }
    if (!fits) {
      return place + " is " + value.dump() + ", not " + type.dump();
    }
  }
  if (schema.contains("enum") && std::ranges::find(schema.at("enum"), value) == schema.at("enum").end()) {
    return place + " is " + value.dump() + ", not one of " + schema.at("enum").dump();
  }
  const json required = schema.value("required", json::array());
  for (const json& key : required) {
    if (!value.contains(key.get<std::string>())) {
      return place + " lacks " + key.dump();
    }
  }
  const json properties = schema.value("properties", json::object());
  for (const auto& [key, child] : properties.items()) {
    if (value.contains(key)) {
      if (std::string found = fault(child, value.at(key), place + "." + key); !found.empty()) {
        return found;
      }
    }
  }
  for (std::size_t i = 0; schema.contains("items") && i < value.size(); ++i) {
    if (std::string found = fault(schema.at("items"), value.at(i), place + "[" + std::to_string(i) + "]");
        !found.empty()) {
      return found;
    }
  }
  return {};
}

std::string fault_of(const std::string& schema, const std::string& text) {
  const auto path = support::source_root() / "docs" / "json" / (schema + ".schema.json");
  const json rules = json::parse(support::read_all(path), nullptr, false);
  const json value = json::parse(text, nullptr, false);
  return rules.is_discarded()   ? "no schema " + path.string()
         : value.is_discarded() ? "no JSON: " + text.substr(0, 200)
                                : fault(rules, value, "$");
}

TEST(Schema, checker_sees_faults) {
  EXPECT_EQ(fault_of("error", R"({"error":{"code":"R0101","message":"m","remedy":"r"}})"), "");
  EXPECT_EQ(fault_of("error", R"({"error":{"code":"R0101","message":"m"}})"), "$.error lacks \"remedy\"");
  EXPECT_EQ(fault_of("error", R"({"error":{"code":1,"message":"m","remedy":"r"}})"),
            "$.error.code is 1, not \"string\"");
  EXPECT_NE(fault_of("report", R"({"kind":"scan","verdict":"superb","summary":"","report":""})"), "");
}

TEST(Schema, fits_errors_explain_and_target_print) {
  EXPECT_EQ(fault_of("error", raysteer({"report", "/no/such", "--json"}).out), "");
  EXPECT_EQ(fault_of("explain", raysteer({"explain", "R0110", "--json"}).out), "");
  EXPECT_EQ(fault_of("explain", raysteer({"explain", "--list", "--json"}).out), "");
  EXPECT_EQ(fault_of("target-print",
                     raysteer({"target", "print", "--columns", "8", "--rows", "5", "--square-mm", "22", "--json"}).out),
            "");
  EXPECT_EQ(
      fault_of("target-print", raysteer({"target", "print", "--kind", "datum", "--radius-mm", "5", "--json"}).out), "");
}

TEST(Schema, fits_results) {
  report::CalibrationResult calibration;
  calibration.judgement.verdict = "good";
  calibration.devices.resize(2);
  calibration.devices[0].kind = calibration.devices[1].kind = "camera";
  calibration.devices[0].lens = calibration.devices[1].lens = "bc4";
  calibration.views.push_back({"0", false, "R0306", "foreign", {0.1}, 0, 1});
  report::ScanResult scan;
  scan.judgement.verdict = "redo";
  for (const report::AnyResult& result : {report::AnyResult(calibration), report::AnyResult(scan)}) {
    const ScratchFolder folder;
    ASSERT_TRUE(report::write_result(folder.path(), result));
    EXPECT_EQ(fault_of("result", support::read_all(folder / "result.json")), "");
    EXPECT_EQ(fault_of("report", raysteer({"report", folder.path().string(), "--json"}).out), "");
    const bool is_scan = std::holds_alternative<report::ScanResult>(result);
    EXPECT_EQ(fault_of(is_scan ? "scan" : "calibrate-cameras", report::summary_json(result).dump()), "");
  }
}

}  // namespace
}  // namespace raysteer::host::cli
