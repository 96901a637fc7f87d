#include "host/calibrate/gather.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "calib/solve/correspondences.hpp"
#include "calib/target/detect.hpp"
#include "hal/base/pattern.hpp"
#include "host/scan/decode_look.hpp"

namespace raysteer::host::calibrate {
namespace {

namespace solve = calib::solve;
namespace target = calib::target;
using session::Session;

std::string who(const Session& session, std::size_t camera, int look) {
  return "camera '" + session.manifest().cameras[camera].name + "', look '" +
         session.manifest().looks[static_cast<std::size_t>(look)].name + "'";
}

Status check_scale(const TargetSpec& target) {
  return target.square_m > 0 ? ok() : fail(RCode::kTargetScaleMissing, "[target] has no square_m");
}

// The looks that show the target, and the target. Every look of one calibration shows the same one.
struct Plan {
  TargetSpec target;
  std::vector<int> looks;
};

Result<Plan> plan_of(const Session& session) {
  const auto& manifest = session.manifest();
  if (manifest.targets.empty()) {
    return fail(RCode::kMissingKey, "the session has no [target]: which board was shown?");
  }
  Plan plan{.target = manifest.targets.front().spec, .looks = {}};
  for (int look = 0; look < session.looks(); ++look) {
    const TargetSpec* shown = manifest.target_of(manifest.looks[static_cast<std::size_t>(look)].name);
    if (shown != nullptr && *shown == plan.target) {
      plan.looks.push_back(look);
    }
  }
  RAYSTEER_TRY(check_scale(plan.target));
  return plan;
}

int lit_frame(const PatternSequence& sequence) {
  const std::vector<Pattern> patterns = sequence.patterns();
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    if (patterns[i].block.kind == PatternKind::kWhite) {
      return static_cast<int>(i);
    }
  }
  return 0;
}

Result<Image<std::uint8_t>> load_8_bit(const Session& session, const session::FrameId& id) {
  Image<std::uint8_t> frame;
  if (session.bits(id.camera) <= 8) {
    RAYSTEER_TRY(session.load(id, frame));
    return frame;
  }
  Image<std::uint16_t> deep;
  RAYSTEER_TRY(session.load(id, deep));
  // The board's contrast matters, not its absolute grey: the brightest pixel becomes 255.
  const int brightest = std::max(1, static_cast<int>(*std::max_element(deep.data(), deep.data() + deep.size())));
  frame = Image<std::uint8_t>::uninitialised(deep.width(), deep.height());
  std::transform(deep.data(), deep.data() + deep.size(), frame.data(),
                 [&](std::uint16_t grey) { return static_cast<std::uint8_t>(255 * grey / brightest); });
  return frame;
}

// Nothing found may have a plainer reason than the board.
Error plainest(Error error, ImageView<const std::uint8_t> frame) {
  if (error.rcode != RCode::kTargetNotFound || frame.empty()) {
    return error;
  }
  std::array<std::size_t, 256> histogram{};
  for (int y = 0; y < frame.height(); ++y) {
    for (const std::uint8_t grey : frame.row_span(y)) {
      ++histogram[grey];
    }
  }
  const auto pixels = static_cast<double>(frame.width()) * frame.height();
  std::size_t dark = 0;
  for (std::size_t grey = 0; grey < 16; ++grey) {
    dark += histogram[grey];
  }
  std::size_t bright = 0;
  for (std::size_t grey = 250; grey < 256; ++grey) {
    bright += histogram[grey];
  }
  if (static_cast<double>(dark) > 0.999 * pixels) {
    return fail(RCode::kFramesBlack, "no pixel reaches 16 of 255");
  }
  if (static_cast<double>(bright) > 0.9 * pixels) {
    return fail(RCode::kFramesSaturated, "nine of ten pixels are above 250 of 255");
  }
  return error;
}

struct Place {
  int camera = 0;
  int look = 0;
};

// The board in these places' lit frames, found together. Loading and finding take about as long as each other's half.
Result<std::vector<Result<target::Detection>>> detect_in(const Session& session, const TargetSpec& target,
                                                         const std::vector<Place>& places, const Tick& tick) {
  const int lit = lit_frame(session.manifest().sequence);
  std::vector<Image<std::uint8_t>> frames;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (tick && !tick(0.5 * static_cast<double>(i) / static_cast<double>(places.size()))) {
      return fail(RCode::kCancelled);
    }
    auto frame = load_8_bit(session, {places[i].camera, places[i].look, lit});
    if (!frame) {
      return frame.error();
    }
    frames.push_back(std::move(*frame));
  }
  std::vector<ImageView<const std::uint8_t>> views;
  for (const auto& frame : frames) {
    views.push_back(frame.view());
  }
  auto found = target::detect_all(target, views);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) {
      found[i] = with_context(plainest(found[i].error(), views[i]),
                              who(session, static_cast<std::size_t>(places[i].camera), places[i].look));
    }
  }
  if (tick && !tick(1)) {
    return fail(RCode::kCancelled);
  }
  return found;
}

// Boards of one camera in all looks.
Result<std::vector<Result<target::Detection>>> detect_camera(const Session& session, const Plan& plan, int camera,
                                                             const Tick& tick) {
  std::vector<Place> places;
  for (const int look : plan.looks) {
    places.push_back({camera, look});
  }
  return detect_in(session, plan.target, places, tick);
}

// More than half of what one device should have seen failed: then it is the set, not a view.
Status refuse_mostly_missed(const Gathered& gathered, int device) {
  std::map<RCode, std::vector<const Error*>> reasons;
  std::size_t missed = 0;
  for (const MissedView& view : gathered.missed) {
    if (view.device == device) {
      reasons[view.error.rcode].push_back(&view.error);
      ++missed;
    }
  }
  const std::size_t views = gathered.observations.views.size();
  if (2 * missed <= views) {
    return ok();
  }
  const auto most = std::ranges::max_element(reasons, {}, [](const auto& reason) { return reason.second.size(); });
  Error error = *most->second.front();
  error.note += " (and " + std::to_string(missed - 1) + " of the " + std::to_string(views - 1) + " other views)";
  return error;
}

Gathered empty(const Session& session, const Plan& plan) {
  Gathered gathered;
  gathered.observations.target = plan.target;
  for (int camera = 0; camera < session.cameras(); ++camera) {
    gathered.observations.devices.push_back({.name = session.manifest().cameras[static_cast<std::size_t>(camera)].name,
                                             .kind = calib::model::DeviceKind::kCamera,
                                             .width = session.width(camera),
                                             .height = session.height(camera)});
  }
  for (const int look : plan.looks) {
    gathered.observations.views.push_back(
        {.name = session.manifest().looks[static_cast<std::size_t>(look)].name,
         .corners = std::vector<std::vector<target::Corner>>(gathered.observations.devices.size()),
         .pixels = {}});
  }
  return gathered;
}

void add(Gathered& gathered, int camera, std::vector<Result<target::Detection>> found) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) {
      gathered.observations.target.layout = found[i]->layout;
      gathered.observations.views[i].corners[static_cast<std::size_t>(camera)] = std::move(found[i]->corners);
    } else {
      gathered.missed.push_back({static_cast<int>(i), camera, found[i].error()});
    }
  }
}

}  // namespace

Result<BoardInLook> find_board(const Session& session, int look, const Tick& tick) {
  const std::string& name = session.manifest().looks[static_cast<std::size_t>(look)].name;
  const TargetSpec* target = session.manifest().target_of(name);
  if (target == nullptr) {
    return fail(RCode::kMissingKey, "no [target] of the session is shown in look '" + name + "'");
  }
  RAYSTEER_TRY(check_scale(*target));
  std::vector<Place> places;
  for (int camera = 0; camera < session.cameras(); ++camera) {
    places.push_back({camera, look});
  }
  auto found = detect_in(session, *target, places, tick);
  RAYSTEER_TRY(found);
  BoardInLook board{.target = *target, .cameras = *std::move(found)};
  for (const auto& detection : board.cameras) {
    if (detection) {
      board.target.layout = detection->layout;
    }
  }
  return board;
}

Result<Gathered> gather_cameras(const Session& session, const Tick& tick) {
  const auto plan = plan_of(session);
  if (!plan) {
    return plan.error();
  }
  const auto cameras = static_cast<std::size_t>(session.cameras());
  std::vector<std::optional<Result<std::vector<Result<target::Detection>>>>> found(cameras);
  {
    std::vector<std::jthread> threads;
    for (std::size_t camera = 0; camera < cameras; ++camera) {
      // The first camera's progress stands for all: they run side by side.
      threads.emplace_back([&, camera] {
        found[camera] = detect_camera(session, *plan, static_cast<int>(camera), camera == 0 ? tick : Tick{});
      });
    }
  }
  Gathered gathered = empty(session, *plan);
  for (std::size_t camera = 0; camera < cameras; ++camera) {
    if (!found[camera]->has_value()) {
      return found[camera]->error();
    }
    add(gathered, static_cast<int>(camera), std::move(**found[camera]));
    RAYSTEER_TRY(refuse_mostly_missed(gathered, static_cast<int>(camera)));
  }
  return gathered;
}

Result<Gathered> gather_projector(const Session& session, const Tick& tick) {
  const auto plan = plan_of(session);
  if (!plan) {
    return plan.error();
  }
  const PatternSequence& sequence = session.manifest().sequence;
  const auto codes = [&](Axis axis) {
    return std::ranges::any_of(sequence.blocks, [&](const PatternBlock& block) {
      return (block.kind == PatternKind::kGray || block.kind == PatternKind::kPhase) && block.axis == axis;
    });
  };
  if (!codes(Axis::kX) || !codes(Axis::kY)) {
    return fail(RCode::kBadSequence, "a projector is calibrated from patterns along both axes");
  }
  Gathered gathered = empty(session, *plan);
  solve::Observations& observations = gathered.observations;
  const int projector = session.cameras();
  observations.devices.push_back({.name = "projector",
                                  .kind = calib::model::DeviceKind::kProjector,
                                  .width = sequence.panel_width,
                                  .height = sequence.panel_height});

  for (int camera = 0; camera < session.cameras(); ++camera) {
    auto found = detect_camera(session, *plan, camera, {});
    if (!found) {
      return found.error();
    }
    add(gathered, camera, std::move(*found));
    RAYSTEER_TRY(refuse_mostly_missed(gathered, camera));
  }
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    solve::View& view = observations.views[v];
    view.corners.emplace_back();
    for (int camera = 0; camera < session.cameras(); ++camera) {
      const auto& corners = view.corners[static_cast<std::size_t>(camera)];
      if (corners.empty()) {
        continue;
      }
      const double begin =
          static_cast<double>(v * static_cast<std::size_t>(session.cameras()) + static_cast<std::size_t>(camera));
      const double all = static_cast<double>(observations.views.size()) * session.cameras();
      const auto decoded = scan::decode_look(session, camera, plan->looks[v], {},
                                             [&](double done) { return !tick || tick((begin + done) / all); });
      if (!decoded) {
        return decoded.error();
      }
      auto seen = solve::correspondences(decoded->codes, observations.target, corners, camera);
      if (!seen) {
        gathered.missed.push_back(
            {static_cast<int>(v), projector,
             with_context(seen.error(), who(session, static_cast<std::size_t>(camera), plan->looks[v]))});
        continue;
      }
      view.pixels.insert(view.pixels.end(), seen->pixels.begin(), seen->pixels.end());
      // Two cameras give a corner twice; the surer value stays.
      for (const target::Corner& corner : seen->panel_corners) {
        auto& panel = view.corners[static_cast<std::size_t>(projector)];
        const auto same = std::ranges::find(panel, corner.id, &target::Corner::id);
        if (same == panel.end()) {
          panel.push_back(corner);
        } else if (corner.sigma_px < same->sigma_px) {
          *same = corner;
        }
      }
    }
  }
  RAYSTEER_TRY(refuse_mostly_missed(gathered, projector));
  return gathered;
}

void explain_missed(const std::vector<MissedView>& missed, solve::Solution& solution) {
  for (const MissedView& view : missed) {
    solve::ViewFit& fit = solution.views[static_cast<std::size_t>(view.view)];
    if (!fit.used && fit.why == RCode::kTargetNotFound) {
      // A board of another kind among views that agree is a foreign view.
      fit.why = view.error.rcode == RCode::kWrongTarget ? RCode::kForeignView : view.error.rcode;
      fit.why_note = view.error.message();
    }
  }
}

}  // namespace raysteer::host::calibrate
