#include "host/scan/match_look.hpp"

#include <thread>
#include <utility>

namespace raysteer::host::scan {
namespace {

using calib::scene::Sighting;

Result<Image<Sighting>> locate_and_drop(DecodedLook& look, int panel_width, int panel_height, int spacing) {
  Result<Image<Sighting>> sightings = calib::scene::locate(look.codes, panel_width, panel_height, spacing);
  look.codes = {};
  return sightings;
}

}  // namespace

Result<MatchedLook> match_look(std::vector<DecodedLook>& cameras, int panel_width, int panel_height) {
  const int spacing = calib::scene::node_spacing(cameras.front().codes, cameras.back().codes);
  if (cameras.size() == 1) {
    Result<Image<Sighting>> only = locate_and_drop(cameras[0], panel_width, panel_height, spacing);
    if (!only) {
      return std::move(only).error();
    }
    return MatchedLook{calib::scene::match_projector(*only, spacing), spacing};
  }
  Result<Image<Sighting>> left = Image<Sighting>();
  Result<Image<Sighting>> right = Image<Sighting>();
  {
    const std::jthread other([&] { right = locate_and_drop(cameras[1], panel_width, panel_height, spacing); });
    left = locate_and_drop(cameras[0], panel_width, panel_height, spacing);
  }
  if (!left || !right) {
    return std::move(left ? right : left).error();
  }
  return MatchedLook{calib::scene::match(*left, *right), spacing};
}

}  // namespace raysteer::host::scan
