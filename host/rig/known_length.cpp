#include "host/rig/known_length.hpp"

#include <cmath>
#include <cstdlib>
#include <vector>

#include "calib/datum/steady.hpp"
#include "host/rig/room.hpp"

namespace raysteer::host::rig {
namespace {

constexpr double kSigmaM = 0.5e-3;  // as good as people read a tape

/// All of `text` as a number above zero.
std::optional<double> number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == 0 && std::isfinite(value) && value > 0 ? std::optional(value) : std::nullopt;
}

std::optional<unsigned> code(const std::string& text) {
  const bool digits = !text.empty() && text.size() < 9 && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::optional(static_cast<unsigned>(std::strtoul(text.c_str(), nullptr, 10))) : std::nullopt;
}

}  // namespace

Result<MeasuredLength> read_length(const std::string& text) {
  const std::size_t dash = text.find('-');
  const std::size_t equals = text.find('=');
  if (dash != std::string::npos && equals != std::string::npos && dash < equals) {
    const auto from = code(text.substr(0, dash));
    const auto to = code(text.substr(dash + 1, equals - dash - 1));
    const auto metres = number(text.substr(equals + 1));
    if (from && to && metres && *from != *to) {
      return MeasuredLength{.metres = *metres, .datums = {{*from, *to}}};
    }
  }
  return fail(RCode::kUsage,
              "--length: expected the codes of two datums and the metres between them, as in "
              "'3-7=2.514', got '" +
                  text + "'");
}

Result<MeasuredLength> read_baseline(const std::string& text) {
  const auto metres = number(text);
  if (!metres) {
    return fail(RCode::kUsage, "--baseline: expected metres above zero, as in '0.512', got '" + text + "'");
  }
  return MeasuredLength{.metres = *metres};
}

Result<calib::steer::KnownLength> find_length(const session::Session& session, const MeasuredLength& length,
                                              int most_looks, const Tick& tick) {
  calib::steer::KnownLength known{.metres = length.metres, .sigma_m = kSigmaM, .ends = {}};
  if (!length.datums) {
    return known;
  }
  const auto views = see_datums(session, most_looks, tick);
  RAYSTEER_TRY(views);
  const auto means = calib::datum::steady(*views);
  RAYSTEER_TRY(means);
  std::array<calib::steer::LitPoint, 2> ends;
  for (std::size_t end = 0; end < 2; ++end) {
    calib::steer::LitPoint& point = ends[end];
    point.x.setZero();
    point.cov_x.setZero();
    const auto mean = means->find((*length.datums)[end]);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (mean == means->end() || !mean->second[eye]) {
        return fail(RCode::kDatumsMissing, "the known length ends at datum " + std::to_string((*length.datums)[end]) +
                                               ", which the " + (eye == 0 ? "left" : "right") +
                                               " eye did not see in any look's black frame");
      }
      point.q[eye] = mean->second[eye]->q;
      point.cov_q[eye] = mean->second[eye]->cov;
    }
  }
  known.ends = ends;
  return known;
}

}  // namespace raysteer::host::rig
