// raysteer target print: a calibration target on paper, true to scale.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "hal/base/datum_code.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/datum_sheet.hpp"
#include "host/cli/target_sheet.hpp"
#include "host/exchange/write_file.hpp"

namespace raysteer::host::cli {
namespace {

// Rounded to a nanometre: 30 / 1000 should read 0.03 in the session.
double to_metres(double mm) { return std::round(mm * 1e6) / 1e9; }

class TargetPrint : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Draw a calibration target on paper, true to scale",
        .description =
            "Writes a PDF or SVG with a bar to measure, finds the target in its own drawing before it writes it, and\n"
            "prints the block that describes the target in a session file. Print at 100 %, measure the bar with a\n"
            "steel rule, and give its length with --measured-mm: the block then has the size that was printed.\n\n"
            "--kind datum draws coded datums for the floor, --code says which, and the block is that of a survey file.",
        .example =
            "raysteer target print --kind charuco --columns 14 --rows 9 --square-mm 18 --out target.pdf\n"
            "raysteer target print --columns 9 --rows 6 --square-mm 25 --paper A3 --out target.svg\n"
            "raysteer target print --columns 9 --rows 6 --square-mm 25 --paper A3 --measured-mm 199.4\n"
            "raysteer target print --kind datum --code 23 --code 79 --radius-mm 18 --out datums.pdf"};
  }

  void declare(Options& options) override {
    options.option("--kind", "KIND", &kind_, "chessboard, charuco or datum [chessboard]")
        .choices({"chessboard", "charuco", "datum"});
    options.option("--columns", "N", &target_.columns, "chessboard: inner corners along x; charuco: squares");
    options.option("--rows", "N", &target_.rows, "the same along y");
    options.option("--square-mm", "MM", &square_mm_, "side of a square");
    options.option("--code", "N", &codes_, "datum: which; may be given again [all 16]");
    options.option("--radius-mm", "MM", &radius_mm_, "datum: radius of its white disc; its black square has 7 radii");
    options.option("--marker-mm", "MM", &marker_mm_, "charuco: side of a marker [3/4 of a square]");
    options.option("--dictionary", "NAME", &target_.dictionary, "charuco: dictionary [5X5_1000]");
    options.option("--layout", "WHICH", &layout_, "charuco: OpenCV's layout since or before 4.6 [current]")
        .choices({"current", "legacy"});
    options.option("--paper", "SIZE", &paper_, "A4, A3, A2, A1, A0, letter or WIDTHxHEIGHT in mm [A4]");
    options.option("--measured-mm", "MM", &measured_mm_, "length of the printed bar as measured");
    options.option("--out", "FILE", &out_, "what to write, ending in .pdf or .svg");
  }

  Result<ExitCode> run(Context& context) override {
    const bool svg = out_.ends_with(".svg");
    if (!out_.empty() && !svg && !out_.ends_with(".pdf")) {
      return fail(RCode::kUsage, "raysteer target print: --out must end in .pdf or .svg, not '" + out_ + "'");
    }
    const Result<Paper> size = paper(paper_);
    RAYSTEER_TRY(size);
    if (kind_ == "datum") {
      return print_datums(context, *size, svg);
    }
    RAYSTEER_TRY(complete_target());
    const Result<TargetSheet> laid = lay_out(target_, *size);
    RAYSTEER_TRY(laid);
    RAYSTEER_TRY(check_sheet(target_, *laid));
    if (!out_.empty()) {
      RAYSTEER_TRY(write(context, laid->sheet, svg, size->name, laid->bar_mm));
    }
    const auto scale = scale_by_bar(context, laid->bar_mm);
    RAYSTEER_TRY(scale);
    target_.square_m = to_metres(1000 * target_.square_m * *scale);
    target_.marker_m = to_metres(1000 * target_.marker_m * *scale);
    const std::string block = session_block(target_);
    context.print(block);
    context.json() = {
        {"kind", kind_},
        {"columns", target_.columns},
        {"rows", target_.rows},
        {"square_m", target_.square_m},
        {"paper", {{"name", size->name}, {"width_mm", laid->sheet.width_mm}, {"height_mm", laid->sheet.height_mm}}},
        {"bar_mm", laid->bar_mm},
        {"file", out_},
        {"session_block", block}};
    return ExitCode::kDone;
  }

 private:
  Result<ExitCode> print_datums(Context& context, const Paper& size, bool svg) {
    if (target_.columns != 0 || target_.rows != 0 || square_mm_ != 0) {
      return fail(RCode::kUsage,
                  "raysteer target print: a datum has --radius-mm, not --columns, --rows or --square-mm");
    }
    if (!(radius_mm_ >= 1 && radius_mm_ <= 500)) {
      return fail(RCode::kUsage,
                  fmt::format("raysteer target print: --radius-mm takes 1 to 500, not {:g}", radius_mm_));
    }
    std::vector<unsigned> codes(datum_codes().begin(), datum_codes().end());
    if (!codes_.empty()) {
      codes.clear();
    }
    for (const std::string& text : codes_) {
      unsigned code = 0;
      if (std::from_chars(text.data(), text.data() + text.size(), code).ptr != text.data() + text.size()) {
        return fail(RCode::kUsage, "raysteer target print: --code takes a number, not '" + text + "'");
      }
      if (std::ranges::find(codes, code) != codes.end()) {
        return fail(RCode::kUsage, "raysteer target print: code " + text + " is given twice; datums are told by it");
      }
      codes.push_back(code);
    }
    const auto laid = lay_out_datums(codes, radius_mm_, size);
    RAYSTEER_TRY(laid);
    RAYSTEER_TRY(check_datums(codes, radius_mm_, *laid));
    if (!out_.empty()) {
      RAYSTEER_TRY(write(context, laid->sheet, svg, size.name, laid->bar_mm));
    }
    const auto scale = scale_by_bar(context, laid->bar_mm);
    RAYSTEER_TRY(scale);
    const double radius_m = to_metres(radius_mm_ * *scale);
    const std::string block = survey_block(codes, radius_m);
    context.print(block);
    context.json() = {
        {"kind", kind_},
        {"codes", codes},
        {"radius_m", radius_m},
        {"paper", {{"name", size.name}, {"width_mm", laid->sheet.width_mm}, {"height_mm", laid->sheet.height_mm}}},
        {"bar_mm", laid->bar_mm},
        {"file", out_},
        {"survey_block", block}};
    return ExitCode::kDone;
  }

  Status write(Context& context, const exchange::Sheet& sheet, bool svg, const std::string& paper_name,
               double bar_mm) const {
    RAYSTEER_TRY(exchange::replace_file(out_, svg ? exchange::to_svg(sheet) : exchange::to_pdf(sheet)));
    context.note(fmt::format("{}: {} on {}; print at 100 %, the bar must measure {:.0f} mm", out_, sheet.title,
                             paper_name, bar_mm));
    return ok();
  }

  Status complete_target() {
    if (target_.columns == 0 || target_.rows == 0 || square_mm_ == 0) {
      return fail(RCode::kUsage, "raysteer target print: " + kind_ + " needs --columns, --rows and --square-mm");
    }
    if (!(square_mm_ >= 0.5 && square_mm_ <= 1000)) {
      return fail(RCode::kUsage,
                  fmt::format("raysteer target print: --square-mm takes 0.5 to 1000, not {:g}", square_mm_));
    }
    target_.square_m = to_metres(square_mm_);
    if (kind_ == "charuco") {
      target_.kind = TargetKind::kCharuco;
      target_.marker_m = to_metres(marker_mm_ > 0 ? marker_mm_ : 0.75 * square_mm_);
      target_.layout = layout_ == "legacy" ? CharucoLayout::kLegacy : CharucoLayout::kCurrent;
    } else {
      target_.dictionary.clear();
    }
    return ok();
  }

  // Printers scale: the bar says by how much.
  Result<double> scale_by_bar(Context& context, double bar_mm) const {
    if (measured_mm_ <= 0) {
      return 1.0;
    }
    const double scale = measured_mm_ / bar_mm;
    if (!(std::abs(scale - 1) < 0.2)) {
      return fail(RCode::kUsage,
                  fmt::format("raysteer target print: the bar of this sheet is {:.0f} mm long; {:g} mm is "
                              "no measurement of it",
                              bar_mm, measured_mm_));
    }
    if (std::abs(scale - 1) > 0.005) {
      context.note(fmt::format("the printer scaled by {:.2f} %; the block has the printed size", 100 * scale));
    }
    return scale;
  }

  TargetSpec target_{.dictionary = "5X5_1000"};
  std::string kind_ = "chessboard";
  std::string layout_ = "current";
  std::string paper_ = "A4";
  std::string out_;
  std::vector<std::string> codes_;
  double radius_mm_ = 0;
  double square_mm_ = 0;
  double marker_mm_ = 0;
  double measured_mm_ = 0;
};

}  // namespace

std::unique_ptr<Command> target_print() { return std::make_unique<TargetPrint>(); }

}  // namespace raysteer::host::cli
