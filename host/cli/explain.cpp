// raysteer explain: what an error code means and what to do about it.
#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "hal/base/nearest.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/manual.hpp"

namespace raysteer::host::cli {
namespace {

Json to_json(RCode rcode) {
  const Explanation& row = raysteer::explain(rcode);
  return {{"code", to_string(rcode)}, {"name", row.name},     {"sentence", row.sentence},
          {"cause", row.cause},       {"remedy", row.remedy}, {"exit_code", static_cast<int>(exit_code(rcode))}};
}

// "R0110", "r110", "110" or "frame-missing"
Result<RCode> find(const std::string& word) {
  std::string digits = word;
  if (digits.starts_with('R') || digits.starts_with('r')) {
    digits.erase(0, 1);
  }
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
  std::vector<std::string> names;
  for (const RCode rcode : all_rcodes()) {
    if (digits == std::to_string(static_cast<int>(rcode)) || word == raysteer::explain(rcode).name) {
      return rcode;
    }
    names.emplace_back(raysteer::explain(rcode).name);
    names.push_back(to_string(rcode));
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  return fail(RCode::kUnknownCode, "'" + word + "'" + did_you_mean(word, known));
}

class Explain : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Say what an error code means and what to do",
            .description = "Error codes look like R0110. Their list is also in docs/errors.md.",
            .example = "raysteer explain R0110\nraysteer explain --list"};
  }

  void declare(Options& options) override {
    options.argument("CODE", &code_, "an error code or its name").is_required = false;
    options.flag("--list", list_, "list all codes");
    options.flag("--markdown", markdown_, "print docs/errors.md");
  }

  Result<ExitCode> run(Context& context) override {
    if (markdown_) {
      context.print(errors_markdown());
    }
    if (list_ || markdown_) {
      context.json()["errors"] = Json::array();
      for (const RCode rcode : all_rcodes()) {
        const Explanation& row = raysteer::explain(rcode);
        context.json()["errors"].push_back(to_json(rcode));
        if (list_) {
          context.print(fmt::format("{}  {:<28} {}\n", to_string(rcode), row.name, row.sentence));
        }
      }
      return ExitCode::kDone;
    }
    if (code_.empty()) {
      return fail(RCode::kUsage, "raysteer explain: give a CODE such as R0110, or --list");
    }
    const Result<RCode> rcode = find(code_);
    RAYSTEER_TRY(rcode);
    const Explanation& row = raysteer::explain(*rcode);
    context.json() = to_json(*rcode);
    context.print(fmt::format("{} ({}): {}\n\ncause: {}\nremedy: {}\nexit code: {}\n", to_string(*rcode), row.name,
                              row.sentence, row.cause, row.remedy, static_cast<int>(exit_code(*rcode))));
    return ExitCode::kDone;
  }

 private:
  std::string code_;
  bool list_ = false;
  bool markdown_ = false;
};

}  // namespace

std::unique_ptr<Command> explain() { return std::make_unique<Explain>(); }

}  // namespace raysteer::host::cli
