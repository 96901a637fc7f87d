#include "host/report/page.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/exchange/write_file.hpp"
#include "host/report/figures.hpp"
#include "host/report/html.hpp"
#include "host/report/numbers.hpp"
#include "host/report/rig_page.hpp"
#include "host/report/style.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {
namespace {

constexpr double kDegrees = 57.29577951308232;  // per radian

std::string list(const std::vector<std::string>& items, const char* title) {
  if (items.empty()) {
    return {};
  }
  std::string text = fmt::format("<h3>{}</h3>\n<ul>\n", title);
  for (const std::string& item : items) {
    text += fmt::format("<li>{}</li>\n", escape(item));
  }
  return text + "</ul>\n";
}

/// Numbers stay on the line of their units.
std::string unbroken(std::string text) {
  for (const std::string_view unit : {" %", " mm", " px"}) {
    for (std::size_t at = text.find(unit); at != std::string::npos; at = text.find(unit, at + 1)) {
      text.replace(at, 1, "\u00a0");
    }
  }
  return text;
}

std::string judgement_section(const Judgement& judgement) {
  return fmt::format("<header class=\"{0}\">\n<p class=\"verdict\">{0}</p>\n<h1>{1}</h1>\n", escape(judgement.verdict),
                     unbroken(escape(judgement.summary))) +
         list(judgement.reasons, "Why") + list(judgement.advice, "What to do") + "</header>\n";
}

std::string with_thousands(std::int64_t count) {
  std::string digits = std::to_string(count);
  for (int at = static_cast<int>(digits.size()) - 3; at > (count < 0 ? 1 : 0); at -= 3) {
    digits.insert(static_cast<std::size_t>(at), " ");  // narrow no-break space
  }
  return digits;
}

Numbers calibration_numbers(const CalibrationResult& result) {
  Numbers numbers;
  numbers.add(result.rms_px, "px", "RMS of all kept corners, two-dimensional");
  numbers.add(result.held_out_p95_px, "px", "95 % of corners the solve had not seen are hit within this");
  numbers.add(result.leave_one_out_px, "px", "on the panel, each pose left out in turn");
  numbers.add(result.pixel_rms_px, "px", "RMS of single decoded pixels");
  if (std::isfinite(result.baseline_m)) {
    numbers.add(fmt::format("{:.2f} mm", 1000 * result.baseline_m), "between the first two devices");
  }
  std::int64_t used = 0;
  for (const ViewRow& view : result.views) {
    used += view.used ? 1 : 0;
  }
  numbers.add(fmt::format("{} of {}", used, result.views.size()), "views used");
  std::int64_t kept = 0, seen = 0;
  for (const DeviceResult& device : result.devices) {
    kept += device.corners_kept;
    seen += device.corners_seen;
  }
  if (seen > 0) {
    numbers.add(fmt::format("{:.1f} %", 100.0 * static_cast<double>(kept) / static_cast<double>(seen)),
                fmt::format("of {} corners kept", with_thousands(seen)));
  }
  return numbers;
}

std::string range_words(double range_m) {
  return std::isinf(range_m) ? "far away" : fmt::format("at {} m", brief(range_m));
}

std::string device_figures(const DeviceResult& device, const std::vector<DifferenceResult>& differences) {
  std::string figures;
  const auto map = [&](const Grid& grid, std::string_view unit, Palette palette, const Caption& caption) {
    if (!grid.empty()) {
      figures += heat_map(grid, device.width, device.height, unit, palette, caption);
    }
  };
  if (!device.residuals.empty()) {
    figures += residual_field(device.residuals, device.width, device.height, "Residuals");
    map(residual_grid(device.residuals, device.width, device.height), "px", Palette::kSingle,
        {"Residuals by place", "RMS of the corners in each cell. One dark corner means the lens model ends there."});
  }
  map(device.coverage, "corners", Palette::kSequential,
      {"Coverage", "Kept corners per cell. Cells with fewer than 100 want more views there."});
  map(device.uncertainty_px, "px", Palette::kSingle,
      {"Uncertainty of the projection",
       fmt::format("One standard deviation of where a point {} is seen, the calibration's own motion taken out.",
                   range_words(device.uncertainty_range_m))});
  map(device.odd_even_px, "px", Palette::kSingle,
      {"Odd against even views",
       fmt::format("Two calibrations from half the views each: pixels differ by {} px (median) and {} px (95 %).",
                   brief(device.odd_even_median_px), brief(device.odd_even_p95_px))});
  for (const DifferenceResult& difference : differences) {
    if (difference.device == device.name) {
      map(difference.px, "px", Palette::kSingle,
          {"Against the earlier calibration", fmt::format("Pixels moved by {} px (median), {} px (95 %).",
                                                          brief(difference.median_px), brief(difference.p95_px))});
      map(difference.mm, "mm", Palette::kSingle,
          {"The same in millimetres", fmt::format("{}.", range_words(difference.range_m))});
    }
  }
  return "<div class=\"figures\">\n" + figures + "</div>\n";
}

std::string parameter_table(const std::vector<ParameterRow>& rows) {
  std::string text =
      "<table>\n<tr><th>parameter</th><th class=\"n\">value</th><th class=\"n\">± 1 σ</th><th></th></tr>\n";
  for (const ParameterRow& row : rows) {
    // As many decimals as the sigma's second digit deserves.
    const bool sure = std::isfinite(row.sigma) && row.sigma > 0;
    const int decimals = sure ? std::clamp(1 - static_cast<int>(std::floor(std::log10(row.sigma))), 0, 9) : 4;
    text += fmt::format("<tr><td>{}</td><td class=\"n\">{:.{}f}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                        escape(row.name), row.value, decimals, sure ? fmt::format("{:.2g}", row.sigma) : "fixed",
                        escape(row.unit));
  }
  return text + "</table>\n";
}

std::string parameters_section(const CalibrationResult& result) {
  std::string tables;
  for (const DeviceResult& device : result.devices) {
    if (!device.parameters.empty()) {
      tables += "<div>" + parameter_table(device.parameters) + "</div>\n";
    }
  }
  if (tables.empty()) {
    return {};
  }
  std::string text = "<h2>Parameters</h2>\n<div class=\"columns\">\n" + tables + "</div>\n";
  if (!result.correlated.empty()) {
    text += list(result.correlated, "Hard to tell apart (correlation)");
  }
  if (result.sag_m.size() == 2 && result.sag_sigma_m.size() == 2) {
    text += fmt::format(
        "<p>The target's middle stands out by {:.0f} ± {:.0f} µm along columns and {:.0f} ± {:.0f} µm "
        "along rows.</p>\n",
        1e6 * result.sag_m[0], 1e6 * result.sag_sigma_m[0], 1e6 * result.sag_m[1], 1e6 * result.sag_sigma_m[1]);
  }
  return text;
}

std::string lens_section(const std::vector<LensRow>& rows) {
  if (rows.empty()) {
    return {};
  }
  std::string text =
      "<h2>Lens models tried <small>chosen by corners held out</small></h2>\n<table>\n<tr><th>device</th><th>model</th>"
      "<th class=\"n\">held-out RMS, px</th><th></th></tr>\n";
  for (const LensRow& row : rows) {
    text += fmt::format("<tr{}><td>{}</td><td>{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                        row.chosen ? " class=\"chosen\"" : "", escape(row.device), escape(row.lens),
                        std::isfinite(row.held_out_px) ? fmt::format("{:.4f}", row.held_out_px) : "–",
                        row.chosen      ? "chosen"
                        : row.monotonic ? ""
                                        : "folds back within the image");
  }
  return text + "</table>\n";
}

std::string views_section(const CalibrationResult& result) {
  if (result.views.empty()) {
    return {};
  }
  std::string text = "<h2>Views</h2>\n" + view_bars(result.views, result.devices) + "<table>\n<tr><th>view</th>";
  for (const DeviceResult& device : result.devices) {
    text += fmt::format("<th class=\"n\">{}, px</th>", escape(device.name));
  }
  text += "<th class=\"n\">tilt, °</th><th class=\"n\">distance, m</th><th></th></tr>\n";
  for (const ViewRow& view : result.views) {
    text += fmt::format("<tr{}><td>{}</td>", view.used ? "" : " class=\"unused\"", escape(view.name));
    for (std::size_t i = 0; i < result.devices.size(); ++i) {
      const double rms = i < view.rms_px.size() ? view.rms_px[i] : kUnknown;
      text += fmt::format("<td class=\"n\">{}</td>", std::isfinite(rms) ? fmt::format("{:.3f}", rms) : "–");
    }
    const std::string tilt = std::isfinite(view.tilt_rad) ? fmt::format("{:.0f}", kDegrees * view.tilt_rad) : "–";
    const std::string distance = std::isfinite(view.distance_m) ? fmt::format("{:.2f}", view.distance_m) : "–";
    const std::string why =
        view.used ? std::string()
                  : fmt::format("not used: {} {}", view.why, view.code.empty() ? "" : "(" + view.code + ")");
    text += fmt::format("<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"why\">{}</td></tr>\n", tilt,
                        distance, escape(why));
  }
  return text + "</table>\n";
}

std::string body(const CalibrationResult& result, const std::filesystem::path&) {
  std::string text = calibration_numbers(result).take();
  for (const DeviceResult& device : result.devices) {
    text += fmt::format("<h2>{} <small>{}, {} × {} px, lens {}, RMS {} px</small></h2>\n", escape(device.name),
                        escape(device.kind), device.width, device.height, escape(device.lens), brief(device.rms_px));
    text += device_figures(device, result.differences);
  }
  text += views_section(result) + parameters_section(result) + lens_section(result.lenses);
  return text + fmt::format("<footer>Session {}. Target: {}. Calibration {}. Made by raysteer {}.</footer>\n",
                            escape(result.session), escape(result.target), escape(result.calibration_id),
                            RAYSTEER_VERSION);
}

Numbers scan_numbers(const ScanResult& result) {
  Numbers numbers;
  numbers.add(with_thousands(result.points), "points");
  numbers.add(with_thousands(result.matched_projector_pixels), "projector pixels seen by both, none filled in");
  if (std::isfinite(result.decoded_fraction)) {
    numbers.add(fmt::format("{:.1f} %", 100 * result.decoded_fraction), "of camera pixels decoded");
  }
  numbers.add(result.epipolar_sigma_px, "px", "epipolar disagreement, nothing left out");
  numbers.add(result.epipolar_within_cell_px, "px", "of it noise");
  numbers.add(result.epipolar_systematic_px, "px", "of it systematic");
  if (std::isfinite(result.patch_rms_m)) {
    numbers.add(fmt::format("{:.0f} µm", 1e6 * result.patch_rms_m), "RMS to a plane within 10 mm patches");
  }
  return numbers;
}

std::string pose_sentence(const ScanResult& result) {
  if (!std::isfinite(result.pose_moved_rad)) {
    return {};
  }
  std::string text = fmt::format("<p>Against the calibration, the pair's rotation differs by {:.2f} mrad",
                                 1000 * result.pose_moved_rad);
  if (std::isfinite(result.pose_moved_sigma_rad)) {
    text += fmt::format(" ± {:.2f} mrad (1 σ)", 1000 * result.pose_moved_sigma_rad);
  }
  text += result.pose_moved ? ": <b>left and right moved since calibration</b>." : ": no movement beyond chance.";
  if (result.pose_refitted && std::isfinite(result.held_out_after_px)) {
    text += fmt::format(
        " The pose was fitted again; on matches held out of the fit the disagreement went from {} px to "
        "{} px.",
        brief(result.held_out_before_px), brief(result.held_out_after_px));
  }
  return text + "</p>\n";
}

std::string picture_of(const ScanResult& result, const std::filesystem::path& folder) {
  // Only a plain name: a result file must not make the report read elsewhere.
  const std::filesystem::path name = result.picture;
  if (name.empty() || name != name.filename() || name == "..") {
    return {};
  }
  const Result<std::string> bytes = exchange::read_file(folder / name);
  if (!bytes) {
    return {};
  }
  return fmt::format(
      "<figure class=\"wide\">\n<img alt=\"The scanned surface\" src=\"data:image/png;base64,{}\">\n"
      "<figcaption>The cloud as the projector sees it. Colour is depth, from near (violet) to far "
      "(yellow); brightness is slope.</figcaption>\n</figure>\n",
      base64(*bytes));
}

std::string body(const ScanResult& result, const std::filesystem::path& folder) {
  std::string text = scan_numbers(result).take() + pose_sentence(result);
  if (const std::string picture = picture_of(result, folder); !picture.empty()) {
    text += "<h2>Surface</h2>\n" + picture;
  }
  std::string figures;
  if (!result.epipolar_cells_px.empty()) {
    figures += heat_map(result.epipolar_cells_px, 32 * result.epipolar_cells_px.columns,
                        32 * result.epipolar_cells_px.rows, "px", Palette::kDiverging,
                        {"Epipolar disagreement by place",
                         "Median per cell of the left image, signed. Noise would be pale all over; a pattern means the "
                         "pair moved or its lenses are described wrongly."});
  }
  figures += histogram(result.epipolar_histogram, "px",
                       {"Epipolar disagreement", "Of all matches. A peak beside zero is systematic."});
  figures += histogram(result.depth_histogram, "m", {"Depth", "Points by distance from the left camera's plane."});
  text += "<h2>Agreement of the two views</h2>\n<div class=\"figures\">\n" + figures + "</div>\n";
  text += "<h2>Details</h2>\n<table>\n";
  const auto fact = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape(name), escape(value));
  };
  fact("projector pixels that only neighbours would add", with_thousands(result.interpolated_projector_pixels));
  if (std::isfinite(result.patch_rms_m)) {
    fact("flatness: patches of 10 mm", with_thousands(result.patches));
    fact("flatness: RMS to a plane, median patch", fmt::format("{:.1f} µm", 1e6 * result.patch_rms_m));
  }
  if (std::isfinite(result.patch_predicted_rms_m)) {
    fact("flatness: predicted from the points' covariance",
         fmt::format("{:.1f} µm", 1e6 * result.patch_predicted_rms_m));
  }
  for (const Fact& more : result.facts) {
    fact(more.name, more.value);
  }
  text += "</table>\n";
  return text + fmt::format("<footer>Session {}. Calibration {} ({}). Made by raysteer {}.</footer>\n",
                            escape(result.session), escape(result.calibration), escape(result.calibration_id),
                            RAYSTEER_VERSION);
}

std::string body(const RigResult& result, const std::filesystem::path&) { return rig_body(result); }

std::string title(const CalibrationResult&) { return "Calibration"; }
std::string title(const ScanResult&) { return "Scan"; }
std::string title(const RigResult& result) {
  return result.kind == "tables" ? "Stations" : result.kind == "verification" ? "Verification" : "Rig";
}

// Cells without a value; shared by all drawings of the page.
constexpr const char* kHatch =
    "<svg width=\"0\" height=\"0\" style=\"position:absolute\" aria-hidden=\"true\"><defs><pattern id=\"hatch\" "
    "width=\"6\" "
    "height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\"><rect width=\"6\" height=\"6\" "
    "fill=\"#f4f6f8\"/><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"6\" stroke=\"#d5dce2\" "
    "stroke-width=\"2\"/></pattern></defs>"
    "</svg>\n";

}  // namespace

std::string page(const AnyResult& result, const std::filesystem::path& folder) {
  const Judgement& judgement =
      std::visit([](const auto& known) -> const Judgement& { return known.judgement; }, result);
  const std::string kind = std::visit([](const auto& known) { return title(known); }, result);
  return fmt::format(
             "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
             "content=\"width=device-width, initial-scale=1\">\n<title>{}: "
             "{}</title>\n<style>{}</style>\n</head>\n<body>\n{}",
             kind, escape(judgement.verdict), kStyle, kHatch) +
         judgement_section(judgement) + std::visit([&](const auto& known) { return body(known, folder); }, result) +
         "</body>\n</html>\n";
}

}  // namespace raysteer::host::report
