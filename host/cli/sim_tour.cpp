#include "host/cli/sim_tour.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "host/cli/pretend.hpp"
#include "host/exchange/write_file.hpp"
#include "host/tour/tour.hpp"

namespace raysteer::host::cli {
namespace {

namespace fs = std::filesystem;

/// A folder for recordings that nobody keeps.
class Scratch {
 public:
  Scratch() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "raysteer-tour-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) {
      path_ = name;
    }
  }
  ~Scratch() {
    std::error_code error;
    if (!path_.empty()) {
      fs::remove_all(path_, error);
    }
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void fill(Context& context, const tour::TourResult& result, const fs::path& picture) {
  Json& json = context.json();
  json["corner_mean_mm"] = result.corner_mean_mm;
  json["corner_max_mm"] = result.corner_max_mm;
  json["before_mean_mm"] = result.before_mean_mm;
  json["picture"] = picture.string();
  json["before_max_mm"] = result.before_max_mm;
  json["corners_mm"] = result.corners_mm;
  json["sides_mm"] = result.sides_mm;
  json["predicted_mean_mm"] = result.predicted_mean_mm;
  json["chi_square"] = result.chi_square;
  json["leave_one_out_mm"] = result.leave_one_out_mm;
  json["camera_rms_px"] = result.camera_rms_px;
  json["corner_rms_px"] = result.corner_rms_px;
  json["disc_rms_px"] = result.disc_rms_px;
  json["discs"] = result.discs;
  json["left_out"] = result.left_out;
  json["mirrored"] = result.mirrored;
  json["middle_m"] = result.middle_m;

  context.print(
      fmt::format("the corners of a rectangle of 500 x 312.5 mm miss their places by {:.2f} mm (mean), {:.2f} "
                  "mm (max)\n",
                  result.corner_mean_mm, result.corner_max_mm));
  context.print(fmt::format("expected         {:.2f} mm (mean) by the covariance; chi-square {:.1f} of about 8\n",
                            result.predicted_mean_mm, result.chi_square));
  context.print(
      fmt::format("before           {:.1f} mm (mean), {:.1f} mm (max), sent straight at the drawing's throw\n",
                  result.before_mean_mm, result.before_max_mm));
  context.print(fmt::format("sides            {:.2f} {:.2f} {:.2f} {:.2f} mm\n", result.sides_mm[0], result.sides_mm[1],
                            result.sides_mm[2], result.sides_mm[3]));
  context.print(fmt::format("discs            {} seen, {:.3f} px RMS; each without itself {:.2f} mm RMS{}\n",
                            result.discs, result.disc_rms_px, result.leave_one_out_mm,
                            result.mirrored ? "; in a mirror" : ""));
  context.print(fmt::format("cameras          {:.3f} px RMS waved, {:.3f} px on the floor\n", result.camera_rms_px,
                            result.corner_rms_px));
  context.print(fmt::format("picture          {}\n", picture.string()));
}

}  // namespace

Result<ExitCode> run_tour(Context& context, const sim::PretendOptions& pretend, std::array<double, 2> mirror_rad,
                          const fs::path& picture) {
  const Scratch scratch;
  const fs::path folder = context.has_out() ? context.out() : scratch.path();
  if (folder.empty()) {
    return fail(RCode::kWriteFailed, "no folder for temporary files");
  }
  const auto result =
      tour::tour({.pretend = pretend, .mirror_rad = mirror_rad, .plan = "cameras", .folder = folder}, listen(context));
  if (!result) {
    return result.error();
  }
  fs::path shown_as = context.has_out() ? context.final_out() / result->picture.filename() : picture;
  if (!context.has_out()) {
    const auto bytes = exchange::read_file(result->picture);
    if (!bytes) {
      return bytes.error();
    }
    RAYSTEER_TRY(exchange::replace_file(picture, *bytes));
  }
  fill(context, *result, shown_as);
  return ExitCode::kDone;
}

}  // namespace raysteer::host::cli
