// Steered rigs calibrated without any board: are they as good as asked, and is a flat scene refused?
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "tests/support/without_board.hpp"

namespace {

using namespace raysteer;

bool good = true;

/// One line of the table; `measured` must not exceed `asked`.
void row(const std::string& what, double asked, double measured, const char* unit) {
  const bool holds = measured <= asked;
  good = good && holds;
  std::printf("| %s | %.3g %s | %.3g %s | %s |\n", what.c_str(), asked, unit, measured, unit, holds ? "yes" : "NO");
}

void told(const std::string& what, double measured, const char* unit) {
  std::printf("| %s | – | %.3g %s | |\n", what.c_str(), measured, unit);
}

std::string codes(const support::WithoutBoard& many) {
  std::string text;
  for (const auto& [code, count] : many.refused) {
    text += (text.empty() ? ": " : ", ") + code + " " + std::to_string(count);
  }
  return text;
}

/// No chance, but another minimum: of 10^6 honest cameras one is 5 sigmas off.
int wrong(const support::WithoutBoard& many) {
  int count = 0;
  for (std::size_t i = 0; i < many.camera_focal.size(); ++i) {
    count += std::abs(many.focal_normalised[i]) > 5 || many.camera_focal[i] > 0.01 ? 1 : 0;
  }
  return count;
}

double within_95(const std::vector<double>& sigmas) {
  const auto inside = std::ranges::count_if(sigmas, [](double z) { return std::abs(z) <= 1.96; });
  return 100.0 * static_cast<double>(inside) / static_cast<double>(sigmas.size());
}

void scales(const std::string& what, const support::WithoutBoard& many) {
  told(what + ", median", 100 * support::quantile(many.scale, 0.5), "%");
  told(what + ", within the stated 95 %", within_95(many.scale_normalised), "%");
  told(what + ", a length on the floor, median", 100 * support::quantile(many.length, 0.5), "%");
  told(what + ", a length on the floor, within the stated 95 %", within_95(many.length_normalised), "%");
}

/// What is asked of one board.
void board(const char* name, std::uint64_t seed, int rigs, int refused, int points) {
  const std::string what = std::string(name) == "mock-head" ? "head" : "galvo pair";
  const auto planned = support::planned_board(name, 25);
  support::WithoutBoardOptions options;
  options.rigs = rigs;
  options.observed.points = points;
  options.threads = static_cast<int>(std::thread::hardware_concurrency());
  const auto relief = support::many_without_board(planned, seed, options);
  row(what + ", relief: refused of " + std::to_string(rigs) + codes(relief), 0, relief.refusals(), "");
  row(what + ", relief: wrong minima accepted: a focal length 5 stated sigmas off or 1 %", 0, wrong(relief), "");
  for (const std::uint64_t bad : relief.bad_seeds) {
    std::fprintf(stderr, "%s: seed %llu refused\n", what.c_str(), static_cast<unsigned long long>(bad));
  }
  if (relief.solved > 0) {
    const auto percent = [](const std::vector<double>& of, double share) { return 100 * support::quantile(of, share); };
    row(what + ", relief: cameras' focal error, median", 0.1, percent(relief.camera_focal, 0.5), "%");
    told(what + ", relief: cameras' focal error, 95 %", percent(relief.camera_focal, 0.95), "%");
    row(what + ", relief: projector's focal error, median", 0.1, percent(relief.projector_focal, 0.5), "%");
    row(what + ", relief: unseen looks, 95 %", 0.6, support::quantile(relief.unseen.px, 0.95), "px");
    told(what + ", relief: unseen looks, median", support::quantile(relief.unseen.px, 0.5), "px");
    scales(what + ", relief: eyes' distance known to 0.5 mm: it", relief);
    told(what + ", relief: unseen looks within the stated 95 %", 100 * relief.unseen.within_95(), "%");
    told(what + ", relief: cameras' focal lengths within the stated 95 %", within_95(relief.focal_normalised), "%");
  }
  options.observed.known_ends = true;
  const auto ends = support::many_without_board(planned, seed + 30000, options);
  row(what + ", relief, two places on the floor known to 0.5 mm: refused of " + std::to_string(rigs) + codes(ends), 0,
      ends.refusals(), "");
  if (ends.solved > 0) {
    scales(what + ", two places known to 0.5 mm: eyes' distance", ends);
    told(what + ", two places known to 0.5 mm: unseen looks, 95 %", support::quantile(ends.unseen.px, 0.95), "px");
    told(what + ", two places known to 0.5 mm: cameras' focal lengths within the stated 95 %",
         within_95(ends.focal_normalised), "%");
  }
  options.observed.known_ends = false;
  if (refused == 0) {
    return;
  }
  options.rigs = refused;
  const std::string of = "answered of " + std::to_string(options.rigs);
  options.observed.relief = false;
  const auto flat = support::many_without_board(planned, seed + 10000, options);
  row(what + ", bare floor: " + of + codes(flat), 0, flat.solved, "");
  // Between the two: boxes of a few centimetres and less. Refused or not, an answer must be as good as asked.
  for (const double height : {0.003, 0.01, 0.03, 0.1}) {
    options.observed.relief = true;
    options.observed.box_height = height;
    options.unseen_looks = 2;
    const auto low = support::many_without_board(planned, seed + 20000, options);
    char text[96];
    std::snprintf(text, sizeof text, ", boxes up to %.0f mm: ", 900 * height);
    told(what + text + of + codes(low), low.solved, "");
    row(what + text + "wrong minima accepted", 0, wrong(low), "");
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::uint64_t seed = 1;
  int rigs = 200;
  int refused = 20;  // scenes that are refused take longest, and all end alike
  int points = 100;
  const char* only = "";
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--rigs") == 0 && i + 1 < argc) {
      rigs = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--refused") == 0 && i + 1 < argc) {
      refused = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--board") == 0 && i + 1 < argc) {
      only = argv[++i];
    } else if (std::strcmp(argv[i], "--points") == 0 && i + 1 < argc) {
      points = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--short") == 0) {
      rigs = 7;  // the median of fewer says nothing
      refused = 1;
      points = 60;
    }
  }
  std::printf(
      "%d rigs a board, %d for scenes that should be refused; cameras, projector and mirror drawn from "
      "the board's tolerances and known only as the board file draws them; 25 planned looks with %d points each, 0.2 "
      "px of noise on each coordinate of both cameras "
      "and the panel, 20 urad of repeatability per axis and look. The distance between the eyes is measured to 0.5 mm "
      "(one sigma). "
      "Relief: boxes up to 0.9 m. Unseen looks: 10 random commands a rig, 5x5 pixels each, points as the solved "
      "cameras see them.\n\n",
      rigs, refused, points);
  std::printf("| what | asked | measured | holds |\n| --- | --- | --- | --- |\n");
  for (const char* name : {"mock-galvo", "mock-head"}) {
    if (*only == 0 || std::strcmp(only, name) == 0) {
      board(name, seed * 1000000 + (std::strcmp(name, "mock-head") == 0 ? 200000 : 0), rigs, refused, points);
    }
  }
  return good ? 0 : 1;
}
