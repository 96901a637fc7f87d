#include "proto/stations/stations.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "proto/document/fixed_numbers.hpp"
#include "proto/document/parse.hpp"
#include "proto/document/paths.hpp"
#include "proto/document/toml_text.hpp"
#include "proto/stations/polygon.hpp"

namespace raysteer::proto::stations {

using document::Faults;
using document::TomlTable;
namespace {

// Bounds that only nonsense exceeds.
constexpr std::size_t kMostStations = 10'000;
constexpr std::size_t kMostZones = 1000;
constexpr std::size_t kMostCorners = 1000;
constexpr document::Range<double> kPlace{-1000, 1000};
constexpr std::string_view kMetres = "lengths are in metres (25 mm is 0.025)";
constexpr Vec3 kUnturned{};

Vec3 read_rotation(TomlTable& table) {
  if (!table.has("turn_deg")) {
    table.number("turn_deg", {-360, 360}, 0.0);  // known
    return document::read_numbers<3>(table, "rotation_deg", {-360, 360}, &kUnturned);
  }
  if (table.has("rotation_deg")) {
    table.fault(RCode::kBadValue, "turn_deg", "and rotation_deg are two ways to say one thing; keep one");
  }
  table.numbers("rotation_deg");  // known
  return {0, 0, table.number("turn_deg", {-360, 360})};
}

Station read_station(TomlTable& table) {
  Station station;
  station.name = table.text("name");
  // Names become names of files.
  if (!document::is_file_name(station.name) && table.has("name")) {
    table.fault(RCode::kBadValue, "name", "is '" + station.name + "', which cannot be part of a file name");
  }
  station.position_m = document::read_numbers<3>(table, "position_m", kPlace, nullptr, kMetres);
  station.rotation_deg = read_rotation(table);
  station.size_m = document::read_numbers<2>(table, "size_m", {1e-3, 100}, nullptr, kMetres);
  station.surface = table.choice("surface", {"plane", "scan"}, 0) == 0 ? Surface::kPlane : Surface::kScan;
  station.content = table.text("content", "");
  // Beside the file or below, as a session's frames are; and no drive of Windows'.
  if (document::leaves_folder(station.content) || station.content.find(':') != std::string::npos) {
    table.fault(RCode::kPathOutside, "content", "is '" + station.content + "'; pictures lie beside this file or below");
  }
  station.tolerance_mm = table.number("tolerance_mm", {1e-3, 1e4}, {}, "in millimetres");
  if (table.has("eye_m")) {
    station.eye_m = document::read_numbers<3>(table, "eye_m", kPlace, nullptr, kMetres);
  }
  table.numbers("eye_m");  // known, there or not
  table.finish();
  return station;
}

KeepOut read_keep_out(TomlTable& table) {
  KeepOut zone;
  zone.name = table.text("name", "");
  const bool given = table.has("corners_m");
  const std::vector<std::vector<double>> rows = table.matrix("corners_m");
  if (!given) {
    table.fault(RCode::kMissingKey, "corners_m", "is needed: three corners or more, as in [[0, 0], [1, 0], [1, 1]]");
  } else if (rows.size() < 3 || rows.size() > kMostCorners) {
    table.fault(RCode::kBadValue, "corners_m", "must be 3 to " + std::to_string(kMostCorners) + " corners");
  } else if (rows[0].size() != 2 && rows[0].size() != 3) {
    table.fault(RCode::kBadValue, "corners_m", "must be [x, y] on the floor or [x, y, z]");
  } else {
    for (const std::vector<double>& row : rows) {
      const Vec3 corner{row[0], row[1], row.size() == 3 ? row[2] : 0};
      if (!std::ranges::all_of(corner, [](double c) { return c >= kPlace.least && c <= kPlace.most; })) {
        table.fault(RCode::kBadValue, "corners_m", "has a corner more than 1000 m away; " + std::string(kMetres));
        break;
      }
      zone.corners_m.push_back(corner);
    }
    const std::string fault = zone.corners_m.size() == rows.size() ? polygon_fault(zone.corners_m) : "";
    if (!fault.empty()) {
      table.fault(RCode::kBadValue, "corners_m", fault);
    }
  }
  table.finish();
  return zone;
}

void read(TomlTable& root, Stations& stations, Faults&) {
  stations.name = root.text("name");
  std::vector<TomlTable> tables = root.tables("station");
  if (!root.has("station")) {
    root.fault(RCode::kMissingKey, "station", "is needed: at least one [[station]]");
  } else if (tables.empty() || tables.size() > kMostStations) {
    root.fault(RCode::kBadValue, "station", "must be 1 to " + std::to_string(kMostStations));
    tables.clear();
  }
  std::set<std::string> names;
  for (TomlTable& table : tables) {
    stations.stations.push_back(read_station(table));
    if (!names.insert(stations.stations.back().name).second) {
      table.fault(RCode::kBadValue, "name", "is '" + stations.stations.back().name + "' a second time");
    }
  }
  std::vector<TomlTable> zones = root.tables("keep_out");
  if (zones.size() > kMostZones) {
    root.fault(RCode::kBadValue, "keep_out", "are more than " + std::to_string(kMostZones));
    zones.clear();
  }
  for (TomlTable& table : zones) {
    stations.keep_out.push_back(read_keep_out(table));
  }
}

}  // namespace

Result<const Station*> Stations::find(std::string_view station) const {
  const auto found = std::ranges::find(stations, station, &Station::name);
  if (found != stations.end()) {
    return &*found;
  }
  std::string known;
  for (const Station& each : stations) {
    known += ' ' + each.name;
  }
  return fail(RCode::kStationUnknown, "'" + std::string(station) + "'; there are" + known);
}

Result<Stations> read_stations(std::string_view text, const std::string& file) {
  return document::read_document<Stations>(text, file, read);
}

std::string write_stations(const Stations& stations) {
  using document::array;
  using document::number;
  using document::quoted;
  std::string text = "format = 1\nname = " + quoted(stations.name) + "\n";
  for (const Station& station : stations.stations) {
    text += "\n[[station]]\nname = " + quoted(station.name) + "\nposition_m = " + array(station.position_m) + "\n";
    if (station.rotation_deg[0] != 0 || station.rotation_deg[1] != 0) {
      text += "rotation_deg = " + array(station.rotation_deg) + "\n";
    } else if (station.rotation_deg[2] != 0) {
      text += "turn_deg = " + number(station.rotation_deg[2]) + "\n";
    }
    text += "size_m = " + array(station.size_m) + "\n";
    text += station.surface == Surface::kScan ? "surface = \"scan\"\n" : "";
    text += station.content.empty() ? "" : "content = " + quoted(station.content) + "\n";
    text += "tolerance_mm = " + number(station.tolerance_mm) + "\n";
    text += station.eye_m ? "eye_m = " + array(*station.eye_m) + "\n" : "";
  }
  for (const KeepOut& zone : stations.keep_out) {
    text += "\n[[keep_out]]\n" + (zone.name.empty() ? "" : "name = " + quoted(zone.name) + "\n") + "corners_m = [";
    for (std::size_t i = 0; i < zone.corners_m.size(); ++i) {
      text += (i > 0 ? ", " : "") + array(zone.corners_m[i]);
    }
    text += "]\n";
  }
  return text;
}

}  // namespace raysteer::proto::stations
