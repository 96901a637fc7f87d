// raysteer report: draws the page of a calibration or a scan again.
#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/rig_result.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/exchange/write_file.hpp"
#include "host/report/page.hpp"
#include "host/report/result.hpp"

namespace raysteer::host::cli {
namespace {

class Report : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Draw the page of a calibration, a scan, baked stations or a verification",
        .description =
            "Reads result.json, which 'raysteer calibrate', 'scan', 'bake' and 'verify' write with --out, and draws "
            "report.html beside it: one page that needs no network, the verdict first.\n\nWith --previous, for a "
            "rig's calibration: by how many millimetres light falls elsewhere than by an earlier one, over the reach "
            "and, with --stations, at each station.",
        .example =
            "raysteer report calibration\nraysteer report scan --html /tmp/scan.html\n"
            "raysteer report rig --previous rig-of-may --stations hall"};
  }

  void declare(Options& options) override {
    options.argument("DIR", &folder_, "folder with result.json");
    options.option("--html", "FILE", &html_, "where to write the page [DIR/report.html]");
    options.option("--previous", "FILE", &previous_, "earlier calibration of the same rig, or its folder");
    options.option("--stations", "FILE", &stations_, "with --previous: stations file, or an installed one's name");
  }

  Result<ExitCode> run(Context& context) override {
    Result<report::AnyResult> result = report::read_result(folder_);
    RAYSTEER_TRY(result);
    if (!previous_.empty()) {
      RAYSTEER_TRY(compare(*result));
    } else if (!stations_.empty()) {
      return fail(RCode::kBadValue, "--stations goes with --previous: it says where the two are compared");
    }
    const std::filesystem::path html =
        html_.empty() ? std::filesystem::path(folder_) / "report.html" : std::filesystem::path(html_);
    RAYSTEER_TRY(exchange::replace_file(html, report::page(*result, folder_)));
    context.json() = report::summary_json(*result);
    context.json()["report"] = html.string();
    const report::Judgement& judgement =
        std::visit([](const auto& known) -> const report::Judgement& { return known.judgement; }, *result);
    context.print(fmt::format("{}\n", judgement.summary));
    for (const std::string& reason : judgement.reasons) {
      context.print(fmt::format("  {}\n", reason));
    }
    for (const std::string& advice : judgement.advice) {
      context.print(fmt::format("  -> {}\n", advice));
    }
    if (const auto* rig = std::get_if<report::RigResult>(&*result)) {
      print_difference(context, *rig);
    }
    context.print(fmt::format("{}\n", html.string()));
    return ExitCode::kDone;
  }

 private:
  Status compare(report::AnyResult& result) const {
    auto* ours = std::get_if<report::RigResult>(&result);
    if (ours == nullptr || ours->kind != "rig") {
      return fail(RCode::kBadValue, "--previous compares calibrations of a rig; " + folder_ + " holds something else");
    }
    const auto now = exchange::read_rig(folder_);
    RAYSTEER_TRY(now);
    const auto before = exchange::read_rig(previous_);
    RAYSTEER_TRY(before);
    const PlacedRig here = placed(*now);
    std::vector<rig::AimedStation> aimed;
    if (!stations_.empty()) {
      auto rig = rig::read_aimed_rig(folder_, stations_);
      RAYSTEER_TRY(rig);
      aimed = std::move(rig->aimed);
      ours->stations.clear();
      add_stations(*ours, aimed);
    }
    ours->difference.clear();
    return add_difference(*ours, here, placed(*before), aimed);
  }

  std::string folder_;
  std::string html_;
  std::string previous_;
  std::string stations_;
};

}  // namespace

std::unique_ptr<Command> report() { return std::make_unique<Report>(); }

}  // namespace raysteer::host::cli
