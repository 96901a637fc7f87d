// raysteer report: draws the page of a calibration or a scan again.
#include <fmt/core.h>

#include <filesystem>
#include <string>

#include "host/cli/commands.hpp"
#include "host/exchange/write_file.hpp"
#include "host/report/page.hpp"
#include "host/report/result.hpp"

namespace raysteer::host::cli {
namespace {

class Report : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Draw the page of a calibration or a scan",
            .description =
                "Reads result.json, which 'raysteer calibrate' and 'raysteer scan' write with --out, and draws "
                "report.html beside it: one page that needs no network, the verdict first.",
            .example = "raysteer report calibration\nraysteer report scan --html /tmp/scan.html"};
  }

  void declare(Options& options) override {
    options.argument("DIR", &folder_, "folder with result.json");
    options.option("--html", "FILE", &html_, "where to write the page [DIR/report.html]");
  }

  Result<ExitCode> run(Context& context) override {
    const Result<report::AnyResult> result = report::read_result(folder_);
    RAYSTEER_TRY(result);
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
    context.print(fmt::format("{}\n", html.string()));
    return ExitCode::kDone;
  }

 private:
  std::string folder_;
  std::string html_;
};

}  // namespace

std::unique_ptr<Command> report() { return std::make_unique<Report>(); }

}  // namespace raysteer::host::cli
