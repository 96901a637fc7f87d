#include "host/cli/manual.hpp"

#include <fmt/core.h>

#include <string_view>

#include "host/cli/help.hpp"
#include "host/cli/parse.hpp"

namespace raysteer::host::cli {
namespace {

// Text for roff: a backslash, a leading dot or quote and every hyphen would be read as something else.
std::string roff(std::string_view text) {
  std::string safe;
  for (const char letter : text) {
    const bool line_starts = safe.empty() || safe.back() == '\n';
    if (letter == '\\') {
      safe += "\\e";
    } else if (letter == '-') {
      safe += "\\-";
    } else if (line_starts && (letter == '.' || letter == '\'')) {
      safe += "\\&";
      safe += letter;
    } else {
      safe += letter;
    }
  }
  return safe;
}

// Paragraphs separated by empty lines.
std::string roff_paragraphs(std::string_view text) {
  std::string out = roff(text);
  for (std::size_t at = out.find("\n\n"); at != std::string::npos; at = out.find("\n\n", at)) {
    out.replace(at, 2, "\n.PP\n");
  }
  return out;
}

std::string option_name(const Option& option) {
  std::string name = option.name;
  if (const std::size_t comma = name.find(','); comma != std::string::npos) {
    name.insert(comma + 1, " ");
  }
  return name;
}

std::string roff_option(const Option& option) {
  const std::string value = option.positional || option.value.empty() ? "" : " \\fI" + roff(option.value) + "\\fR";
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}{}.\n", roff(option_name(option)), value, roff(option.help),
                     option.is_required && !option.positional ? " (required)" : "");
}

struct Variable {
  std::string_view name;
  std::string_view meaning;
};

constexpr Variable kEnvironment[] = {
    {"RAYSTEER_DATA_DIR", "root of a session's file names when --frames is not given"},
    {"NO_COLOR", "when set and not empty, no colours"},
};

}  // namespace

std::string man_page(const CommandTable& table) {
  std::string text = fmt::format(
      ".TH RAYSTEER 1 \"\" \"raysteer {}\" \"User Commands\"\n"
      ".SH NAME\nraysteer \\- from frames of a projector and cameras to a calibration and a scan\n"
      ".SH SYNOPSIS\n.B raysteer\n\\fICOMMAND\\fR [\\fIoptions\\fR]\n"
      ".SH DESCRIPTION\nResults go to standard output, everything else to standard error. With\n.B \\-\\-json\n"
      "a command prints exactly one JSON object, also when it fails. A folder named with\n.B \\-\\-out\n"
      "appears whole or not at all.\n.SH COMMANDS\n",
      RAYSTEER_VERSION);
  Options common;
  for (const CommandRow& row : table.commands) {
    const std::unique_ptr<Command> command = row.make();
    const std::unique_ptr<Declared> declared = declare(*command);
    const Manual manual = command->manual();
    text += fmt::format(".SS {}\n{}.\n", roff(usage_of_command(row.path, declared->options)), roff(manual.summary));
    if (!manual.description.empty()) {
      text += ".PP\n" + roff_paragraphs(manual.description) + "\n";
    }
    for (const Option& option : declared->options.all()) {
      if (!option.is_common) {
        text += roff_option(option);
      }
    }
    text += fmt::format(".PP\nExample:\n.PP\n.nf\n.RS\n{}\n.RE\n.fi\n", roff(manual.example));
  }
  text += ".SH COMMON OPTIONS\n";
  CommonOptions values;
  bool help = false;
  declare_common({.summary = "", .description = "", .example = "", .out = TakesOut::kOptional, .takes_frames = true},
                 values, help, common);
  for (const Option& option : common.all()) {
    text += roff_option(option);
  }
  text += ".SH EXIT STATUS\n";
  for (const ExitCodeRow& row : all_exit_codes()) {
    text += fmt::format(".TP\n.B {}\n{}.\n", static_cast<int>(row.code), roff(row.meaning));
  }
  text += ".SH ENVIRONMENT\n";
  for (const Variable& variable : kEnvironment) {
    text += fmt::format(".TP\n.B {}\n{}.\n", variable.name, roff(variable.meaning));
  }
  return text + ".SH ERRORS\nMessages carry a code such as R0110;\n.B raysteer explain\nsays its cause and remedy.\n";
}

std::string errors_markdown() {
  std::string text =
      "# Errors\n\nWritten by `raysteer explain --markdown`; a test compares the two. The first digit after R0 groups "
      "by\n"
      "the way of the light: 1 files and sessions, 2 decoding, 3 calibration, 4 scanning, 5 the tool itself, 6 "
      "devices, 7 "
      "capture, 8 the pretend world, 9 the steered rig and its room, 10 tables and stations, 11 the "
      "device's state, 12 its store, 13 the wire.\n\n"
      "| code | name | what | usual cause | remedy | exit |\n|---|---|---|---|---|---|\n";
  for (const RCode rcode : all_rcodes()) {
    const Explanation& row = raysteer::explain(rcode);
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", to_string(rcode), row.name, row.sentence, row.cause,
                        row.remedy, static_cast<int>(exit_code(rcode)));
  }
  return text;
}

}  // namespace raysteer::host::cli
