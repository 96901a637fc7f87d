#include "host/cli/parse.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "hal/base/nearest.hpp"

namespace raysteer::host::cli {
namespace {

CLI::Option* add(CLI::App& app, const Option& option) {
  return std::visit(
      [&](auto* target) -> CLI::Option* {
        using Value = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<Value, bool>) {
          return app.add_flag(option.name, *target);
        } else {
          CLI::Option* added = app.add_option(option.name, *target);
          if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
            // An option takes one value each time; an argument takes the rest of the words.
            added->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(option.positional);
          }
          return added;
        }
      },
      option.target);
}

std::string shown(const Option& option) {
  return option.positional || option.value.empty() ? std::string(option.long_name())
                                                   : std::string(option.long_name()) + " " + option.value;
}

Error unknown(const std::string& word, const Options& options) {
  if (!word.starts_with('-')) {
    return fail(RCode::kUsage, "unexpected argument '" + word + "'");
  }
  std::vector<std::string_view> known;
  for (const Option& option : options.all()) {
    if (!option.positional) {
      known.push_back(option.long_name());
    }
  }
  const std::string name = word.substr(0, word.find('='));
  return fail(RCode::kUsage, "unknown option '" + name + "'" + did_you_mean(name, known));
}

Status check_values(const Option& option) {
  if (const auto* number = std::get_if<double*>(&option.target); number != nullptr && !std::isfinite(**number)) {
    return fail(RCode::kUsage, std::string(option.long_name()) + " takes a finite number");
  }
  return ok();
}

}  // namespace

void declare_common(const Manual& manual, CommonOptions& common, bool& help, Options& options) {
  const std::size_t own = options.all().size();
  if (manual.out != TakesOut::kNo) {
    Option& out = options.option("--out", "DIR", &common.out, "folder for the results; appears whole or not at all");
    out.is_required = manual.out == TakesOut::kRequired;
  }
  if (manual.takes_frames) {
    options.option("--frames", "DIR", &common.frames, "root of the session's file names [RAYSTEER_DATA_DIR]");
  }
  if (manual.has_json) {
    options.flag("--json", common.json, "print one JSON object instead of text");
  }
  options.flag("-q,--quiet", common.quiet, "no remarks and no progress");
  options.flag("-v,--verbose", common.verbose, "more remarks");
  options.option("--color", "WHEN", &common.color, "auto, always or never [auto; NO_COLOR]")
      .choices({"auto", "always", "never"});
  options.flag("-h,--help", help, "print this help");
  std::for_each(options.all().begin() + static_cast<std::ptrdiff_t>(own), options.all().end(),
                [](Option& option) { option.is_common = true; });
}

Status parse(const Options& options, const bool& help, std::vector<std::string> words) {
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  try {
    std::vector<CLI::Option*> added;
    for (const Option& option : options.all()) {
      added.push_back(add(app, option));
    }
    std::reverse(words.begin(), words.end());  // what CLI11 expects of a vector
    app.parse(std::move(words));
    if (const std::vector<std::string> rest = app.remaining(); !rest.empty()) {
      return unknown(rest.front(), options);
    }
    for (std::size_t i = 0; i < added.size(); ++i) {
      const Option& option = options.all()[i];
      if (option.is_required && added[i]->count() == 0 && !help) {
        return fail(RCode::kUsage, "missing " + shown(option) + " (" + option.help + ")");
      }
      if (const auto* text = std::get_if<std::string*>(&option.target);
          text != nullptr && !option.words.empty() && added[i]->count() > 0) {
        const std::vector<std::string_view> known(option.words.begin(), option.words.end());
        if (std::ranges::find(known, **text) == known.end()) {
          std::string allowed;
          for (const std::string& word : option.words) {
            allowed += (allowed.empty() ? "" : ", ") + word;
          }
          return fail(RCode::kUsage, std::string(option.long_name()) + " takes one of " + allowed + ", not '" + **text +
                                         "'" + did_you_mean(**text, known));
        }
      }
      RAYSTEER_TRY(check_values(option));
    }
  } catch (const CLI::Error& error) {
    return fail(RCode::kUsage, error.what());
  }
  return ok();
}

}  // namespace raysteer::host::cli
