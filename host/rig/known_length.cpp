#include "host/rig/known_length.hpp"

#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

#include "calib/datum/steady.hpp"
#include "host/rig/room.hpp"

namespace raysteer::host::rig {
namespace {

constexpr double kSigmaM = 0.5e-3;  // as good as people read a tape

/// All of `text` as a number.
template <class Number>
std::optional<Number> all_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::optional<double> length(std::string_view text) {
  const auto metres = all_of<double>(text);
  return metres && std::isfinite(*metres) && *metres > 0 ? metres : std::nullopt;
}

}  // namespace

Result<MeasuredLength> read_length(std::string_view text) {
  const std::size_t dash = text.find('-');
  const std::size_t equals = text.find('=');
  if (dash != std::string::npos && equals != std::string::npos && dash < equals) {
    const auto from = all_of<unsigned>(text.substr(0, dash));
    const auto to = all_of<unsigned>(text.substr(dash + 1, equals - dash - 1));
    const auto metres = length(text.substr(equals + 1));
    if (from && to && metres && *from != *to) {
      return MeasuredLength{.metres = *metres, .datums = {{*from, *to}}};
    }
  }
  return fail(RCode::kUsage,
              "--length: expected the codes of two datums and the metres between them, as in "
              "'3-7=2.514', got '" +
                  std::string(text) + "'");
}

Result<MeasuredLength> read_baseline(std::string_view text) {
  const auto metres = length(text);
  if (!metres) {
    return fail(RCode::kUsage,
                "--baseline: expected metres above zero, as in '0.512', got '" + std::string(text) + "'");
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
