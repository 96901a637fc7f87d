#include "host/report/rig_page.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/report/figures.hpp"
#include "host/report/floor_map.hpp"
#include "host/report/html.hpp"
#include "host/report/numbers.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {
namespace {

Numbers numbers_of(const RigResult& result) {
  Numbers numbers;
  numbers.add(result.held_out_p95_mm, "mm", "95 % of light at looks that were not calibrated falls within this");
  numbers.add(result.held_out_median_px, "px", "median there");
  numbers.add(result.reach_median_95_mm, "mm", "half of the reach is surer than this (95 %)");
  numbers.add(result.reach_worst_95_mm, "mm", "bound at the worst place of the reach (95 %)");
  if (!result.stations.empty()) {
    const auto within = std::ranges::count_if(result.stations, &StationRow::within);
    numbers.add(fmt::format("{} of {}", within, result.stations.size()), "stations within tolerance, 95 % sure");
  }
  numbers.add(result.whitened_rms, "", "whitened RMS: 1 when the noise is as stated");
  numbers.add(result.repeatability_urad, "µrad", "the mirror comes back within (1 σ)");
  if (std::isfinite(result.scale)) {
    numbers.add(fmt::format("{:.2f} mm", 1000 * result.scale), "where the room has 1000 mm");
  }
  for (const RigDifferenceResult& difference : result.difference) {
    numbers.add(difference.p95_mm, "mm", "95 % of the light moved less than this since the earlier calibration");
  }
  return numbers;
}

std::vector<FloorOutline> outlines_of(const RigResult& result) {
  std::vector<FloorOutline> outlines;
  for (const StationRow& station : result.stations) {
    outlines.push_back({.corners_m = station.outline_m, .label = station.name, .good = station.within});
  }
  return outlines;
}

std::string reach_section(const RigResult& result) {
  if (result.floor.empty()) {
    return {};
  }
  FloorDrawing drawing{.cells = result.reach,
                       .unit = "mm",
                       .outlines = outlines_of(result),
                       .marks = {},
                       .arrows = {},
                       .arrows_are = "",
                       .outlines_are = "station (red: not sure to be within tolerance)",
                       .dots_are = "look solved with",
                       .rings_are = "look held out",
                       .crosses_are = "datum"};
  for (const LookRow& look : result.looks) {
    drawing.marks.push_back(
        {.x_m = look.x_m, .y_m = look.y_m, .symbol = look.held_out ? Symbol::kRing : Symbol::kDot, .label = ""});
  }
  for (const DatumRow& datum : result.datums) {
    drawing.marks.push_back({.x_m = datum.x_m, .y_m = datum.y_m, .symbol = Symbol::kCross, .label = datum.name});
  }
  const std::string where = result.tied_to_room
                                ? "Places are the room's, so the datums' errors are part of it."
                                : "Places are as the rig's own cameras see them: it is not tied to the room.";
  return "<h2>How sure, and where</h2>\n" +
         floor_map(drawing, {"Reach on " + result.floor,
                             "95 % of light falls nearer than this to where it is sent, at the worst of the picture's "
                             "middle and corners; each cell is where the picture's middle falls. " +
                                 where});
}

std::string held_out_section(const RigResult& result) {
  if (result.held_out.empty()) {
    return {};
  }
  FloorDrawing drawing;
  drawing.arrows = result.held_out;
  drawing.arrows_are = "from a place to where light sent there falls";
  drawing.rings_are = "look held out";
  for (const LookRow& look : result.looks) {
    if (look.held_out) {
      drawing.marks.push_back({.x_m = look.x_m, .y_m = look.y_m, .symbol = Symbol::kRing, .label = look.name});
    }
  }
  return "<h2>Looks that were not calibrated</h2>\n" +
         floor_map(drawing,
                   {"Predicted against measured",
                    fmt::format("The model had not seen these looks. Median {} mm ({} px), 95 % {} mm ({} px); the "
                                "measurement's own noise is averaged out. Arrows of one look that all point one way "
                                "are the mirror's repeatability.",
                                brief(result.held_out_median_mm), brief(result.held_out_median_px),
                                brief(result.held_out_p95_mm), brief(result.held_out_p95_px))});
}

std::string difference_section(const RigDifferenceResult& difference) {
  FloorDrawing drawing;
  drawing.cells = difference.cells;
  drawing.unit = "mm";
  drawing.arrows = difference.arrows;
  drawing.arrows_are = "where light falls now, from where it fell";
  std::string text =
      fmt::format("<h2>Against the earlier calibration <small>{}, compared in {}</small></h2>\n<p>{}</p>\n",
                  escape(difference.earlier), escape(difference.frame), escape(difference.sentence));
  text += floor_map(
      drawing,
      {"Where the light moved",
       fmt::format("By {} mm in the mean, {} mm (95 %), {} mm at most. The rig moving as a whole explains {} mm "
                   "(RMS), a change inside the rig the other {} mm.",
                   brief(difference.mean_mm), brief(difference.p95_mm), brief(difference.max_mm),
                   brief(difference.whole_rms_mm), brief(difference.inside_rms_mm))});
  return text;
}

std::string cell(double value, int decimals) {
  return fmt::format("<td class=\"n\">{}</td>", std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "–");
}

std::string stations_section(const RigResult& result) {
  if (result.stations.empty()) {
    return {};
  }
  const bool measured = std::ranges::any_of(result.stations, [](const auto& s) { return std::isfinite(s.error_mm); });
  const bool moved = std::ranges::any_of(result.stations, [](const auto& s) { return std::isfinite(s.moved_mm); });
  std::string text = "<h2>Stations <small>worst corner, mm</small></h2>\n";
  FloorDrawing drawing;
  for (const StationRow& station : result.stations) {
    drawing.arrows.insert(drawing.arrows.end(), station.off.begin(), station.off.end());
  }
  if (!drawing.arrows.empty()) {
    drawing.outlines = outlines_of(result);
    drawing.outlines_are = "station (red: not sure to be within tolerance)";
    drawing.arrows_are = "from where a corner was wanted to where it is lit";
    text += floor_map(drawing, {"Where the corners fell", "As the rig's cameras and datums measure it."});
  }
  text += "<table>\n<tr><th>station</th>";
  text += measured ? "<th class=\"n\">measured</th><th class=\"n\">sure to</th>" : "";
  text += "<th class=\"n\">95 % bound</th><th class=\"n\">allowed</th><th></th>";
  text += moved ? "<th class=\"n\">moved since</th>" : "";
  text += "</tr>\n";
  for (const StationRow& station : result.stations) {
    text += fmt::format("<tr><td>{}</td>", escape(station.name));
    text += measured ? cell(station.error_mm, 2) + cell(station.sure_mm, 2) : "";
    text += cell(station.bound_95_mm, 2) + cell(station.tolerance_mm > 0 ? station.tolerance_mm : kUnknown, 1);
    text += fmt::format("<td class=\"{}\">{}</td>", station.within ? "" : "bad",
                        station.within                            ? "within"
                        : station.error_mm > station.tolerance_mm ? "off"
                                                                  : "not sure");
    text += moved ? cell(station.moved_mm, 2) : "";
    text += "</tr>\n";
  }
  return text + "</table>\n";
}

std::string datums_section(const RigResult& result) {
  if (result.datums.empty()) {
    return {};
  }
  FloorDrawing drawing;
  drawing.arrows_are = "from surveyed to measured";
  drawing.crosses_are = "datum";
  std::string table =
      "<table>\n<tr><th>datum</th><th class=\"n\">x</th><th class=\"n\">y</th><th class=\"n\">z</th><th "
      "class=\"n\">miss, mm</th><th class=\"n\">± 1 σ</th></tr>\n";
  for (const DatumRow& datum : result.datums) {
    table += fmt::format("<tr><td>{}</td>", escape(datum.name));
    for (std::size_t k = 0; k < 3; ++k) {
      table += cell(k < datum.miss_mm.size() ? datum.miss_mm[k] : kUnknown, 2);
    }
    table += cell(datum.size_mm, 2) + cell(datum.sigma_mm, 2) + "</tr>\n";
    drawing.marks.push_back({.x_m = datum.x_m, .y_m = datum.y_m, .symbol = Symbol::kCross, .label = datum.name});
    if (datum.miss_mm.size() == 3) {
      drawing.arrows.push_back(
          {.x_m = datum.x_m, .y_m = datum.y_m, .dx_mm = datum.miss_mm[0], .dy_mm = datum.miss_mm[1]});
    }
  }
  std::string text = "<h2>Datums <small>what ties the rig to the room</small></h2>\n" +
                     floor_map(drawing, {"What datums are missed by",
                                         "Measured by the cameras alone against the survey, after the best tie. Up and "
                                         "down (z) is in the table only."}) +
                     table + "</table>\n";
  if (std::isfinite(result.scale)) {
    text += fmt::format(
        "<p>Metric check, which the calibration never used: by {} the rig measures <b>{:.2f} ± {:.2f} "
        "mm</b> where there are 1000.</p>\n",
        result.scale_by_lengths ? "known lengths" : "the surveyed places", 1000 * result.scale,
        1000 * result.scale_sigma);
  }
  if (!result.lengths.empty()) {
    text +=
        "<table>\n<tr><th>length</th><th class=\"n\">measured, mm</th><th class=\"n\">known, mm</th><th "
        "class=\"n\">± 1 σ</th></tr>\n";
    for (const LengthRow& length : result.lengths) {
      text += fmt::format("<tr><td>{}</td>", escape(length.between)) + cell(length.measured_mm, 2) +
              cell(length.known_mm, 2) + cell(length.sigma_mm, 2) + "</tr>\n";
    }
    text += "</table>\n";
  }
  return text;
}

std::string residuals_section(const RigResult& result) {
  if (result.residuals.empty() || result.panel_width <= 0 || result.panel_height <= 0) {
    return {};
  }
  return "<h2>Residuals <small>of the looks solved with, on the projector's panel</small></h2>\n<div "
         "class=\"figures\">\n" +
         residual_field(result.residuals, result.panel_width, result.panel_height, "Residuals") +
         heat_map(residual_grid(result.residuals, result.panel_width, result.panel_height), result.panel_width,
                  result.panel_height, "px", Palette::kSingle,
                  {"Residuals by place",
                   "RMS of the points in each cell. One dark corner means the lens model ends "
                   "there."}) +
         "</div>\n";
}

/// Bars to the right, longest first; the solve refuses far beyond them.
std::string off_drawing_section(const RigResult& result) {
  if (result.off_drawing.empty()) {
    return result.kind == "rig" ? "<h2>Against the drawing</h2>\n<p>Every part is where its drawing says, within its "
                                  "tolerance.</p>\n"
                                : "";
  }
  std::vector<OffDrawingRow> rows = result.off_drawing;
  std::ranges::sort(rows, std::greater<>(), [](const OffDrawingRow& row) { return std::abs(row.sigmas); });
  rows.resize(std::min<std::size_t>(rows.size(), 12));
  constexpr double kRow = 20, kNames = 210, kFull = 960;
  const double most = std::max(1.0, std::abs(rows.front().sigmas));
  Svg svg(kFull, kRow * static_cast<double>(rows.size()) + 8, "Parameters off their drawing");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = kRow * static_cast<double>(i) + 4;
    const double width = (kFull - kNames - 60) * std::abs(rows[i].sigmas) / most;
    svg.text(kNames - 8, y + 12, rows[i].parameter, Anchor::kEnd);
    svg.rect(kNames, y + 2, width, kRow - 6, "#d55e00");
    svg.text(kNames + width + 6, y + 12, fmt::format("{:.1f} σ", rows[i].sigmas));
  }
  return "<h2>Against the drawing</h2>\n" +
         figure_of({"Parts off their drawing by more than its tolerance explains",
                    "In standard deviations of the board file's [tolerance]. The result holds where the residuals do; "
                    "the drawing, or a mount, does not."},
                   svg.take(), true);
}

std::string looks_table(const RigResult& result) {
  if (result.looks.empty()) {
    return {};
  }
  std::string text =
      "<h2>Looks</h2>\n<table>\n<tr><th>look</th><th></th><th class=\"n\">command, mrad</th><th class=\"n\">mirror off "
      "its curve, µrad</th><th class=\"n\">whitened RMS</th><th class=\"n\">median, px</th><th class=\"n\">95 %, "
      "px</th></tr>\n";
  const auto pair = [](const std::vector<double>& values, int decimals) {
    return values.size() == 2 ? fmt::format("{:.{}f}, {:.{}f}", values[0], decimals, values[1], decimals)
                              : std::string("–");
  };
  for (const LookRow& look : result.looks) {
    text +=
        fmt::format("<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>", escape(look.name),
                    look.held_out ? "held out" : "solved with", pair(look.command_mrad, 1), pair(look.latent_urad, 0)) +
        cell(look.whitened_rms, 3) + cell(look.median_px, 3) + cell(look.p95_px, 3) + "</tr>\n";
  }
  return text + "</table>\n";
}

}  // namespace

std::string rig_body(const RigResult& result) {
  std::string text = numbers_of(result).take();
  for (const RigDifferenceResult& difference : result.difference) {
    text += difference_section(difference);
  }
  // What was measured comes before what is expected.
  const bool verification = result.kind == "verification";
  text += verification ? stations_section(result) + reach_section(result)
                       : reach_section(result) + stations_section(result);
  text += held_out_section(result) + datums_section(result) + residuals_section(result) + off_drawing_section(result) +
          looks_table(result);
  if (!result.facts.empty()) {
    text += "<h2>Details</h2>\n<table>\n";
    for (const Fact& fact : result.facts) {
      text += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape(fact.name), escape(fact.value));
    }
    text += "</table>\n";
  }
  std::string footer;
  footer += result.session.empty() ? "" : fmt::format("Session {}. ", escape(result.session));
  footer += result.board.empty() ? "" : fmt::format("Board {}. ", escape(result.board));
  return text + fmt::format("<footer>{}Calibration {}. Made by raysteer {}.</footer>\n", footer,
                            escape(result.calibration_id), RAYSTEER_VERSION);
}

}  // namespace raysteer::host::report
