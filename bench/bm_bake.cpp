// bm_bake: what a calibration's tables cost: baked on the laptop, looked up for every frame on the device.
//
//   bm_bake                         # two threads bake; one looks up
//
// Fifteen stations of 50 x 31.25 cm over 6 x 4 m of floor with three boxes on it, a panel of 1920 x 1200, the head
// that reaches them. The baselines are what one would write first: every pixel of the same maps exactly, lens undone by
// Newton each time; and a frame warped from a map of a coordinate pair for every pixel.
#include <benchmark/benchmark.h>

#include <cstdio>

#include "calib/bake/aim.hpp"
#include "calib/bake/in_parallel.hpp"
#include "calib/bake/lut_set.hpp"
#include "proto/lut/evaluate.hpp"
#include "tests/support/steered_rig.hpp"

namespace {

using namespace raysteer;
using namespace raysteer::calib;
using namespace raysteer::calib::bake;

constexpr std::uint64_t kSeed = 20261122;

struct Job {
  support::SteeredRig rig;
  LutSetRequest request;
  std::unique_ptr<RayCaster> scene;
};

/// Floor and boxes: heights at 10 mm, as a scan gives them.
TriangleMesh scanned(const model::Pose& T_rig_floor) {
  Image<double> heights(701, 501);
  for (int j = 0; j < heights.height(); ++j) {
    for (int i = 0; i < heights.width(); ++i) {
      const double x = 0.01 * i - 3.5;
      const double y = 0.01 * j - 2.5;
      for (const Eigen::Vector2d& box :
           {Eigen::Vector2d(-1.5, -0.8), Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(1.4, 0.9)}) {
        if (std::abs(x - box.x()) < 0.15 && std::abs(y - box.y()) < 0.15) {
          heights(i, j) = -0.3;
        }
      }
    }
  }
  return height_field(T_rig_floor * model::Pose{.t = {-3.5, -2.5, 0}}, 0.01, heights.view());
}

const Job& job() {
  static const Job job = [] {
    std::mt19937_64 random(kSeed);
    Job made{.rig = support::steered_rig("mock-head", random), .request = {}, .scene = nullptr};
    const model::Pose T_rig_floor = support::floor_pose(random, 0.02);
    made.request.calibration_id = "bench";
    made.request.board_id = "mock-head";
    made.request.steering.T_rig_plane = T_rig_floor;
    made.request.steering.T_frame_plane = T_rig_floor;
    made.request.steering.farthest_m = 4;
    made.request.keep_out = {{.name = "seat", .corners = {{-0.2, -0.2}, {0.1, -0.2}, {0.1, 0}}}};
    made.scene = std::make_unique<RayCaster>(std::move(*RayCaster::make(scanned(T_rig_floor))));
    made.request.scene = made.scene.get();
    for (int i = 0; i < 15; ++i) {
      Station station = support::station_at("station " + std::to_string(i), T_rig_floor, 1.25 * (i % 5) - 2.5,
                                            0.75 * (i / 5) - 0.9, 0.4 * i);
      if (auto command = station_command(made.rig.projector, station); !command) {
        std::printf("left out: %s\n", command.error().note.c_str());
        continue;
      }
      made.request.stations.push_back(std::move(station));
    }
    return made;
  }();
  return job;
}

/// All of it: steering table, 15 maps with outlines, shadow, zone, edge and gain, every pixel checked; bytes and
/// hashes.
void bm_fifteen_maps_bake(benchmark::State& state) {
  LutSetRequest request = job().request;
  request.threads = static_cast<int>(state.range(0));
  std::size_t bytes = 0;
  std::size_t dense = 0;
  double worst = 0;
  for (auto _ : state) {
    const auto set = bake_lut_set(job().rig.projector, request);
    bytes = write_lut_set(*set)->size();
    dense = 0;
    for (const auto& map : set->maps) {
      worst = std::max(worst, map.parts().worst_px);
      dense += map.parts().dense.size();
    }
  }
  state.counters["maps"] = static_cast<double>(request.stations.size());
  state.counters["kB"] = static_cast<double>(bytes) / 1e3;
  state.counters["worst_px"] = worst;
  state.counters["dense_px"] = static_cast<double>(dense);
}
BENCHMARK(bm_fifteen_maps_bake)->Arg(2)->Arg(1)->Iterations(3)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The baseline: the same masks and coordinates, pixel by pixel, from the model alone; two floats a pixel.
void bm_fifteen_dense_maps_bake(benchmark::State& state) {
  const auto& [rig, request, scene] = job();
  const model::Camera& lens = rig.projector.lens;
  const KeepOutFloor floor{.T_plane_rig = request.steering.T_rig_plane.inverse(), .zones = request.keep_out};
  for (auto _ : state) {
    in_parallel(static_cast<int>(request.stations.size()), static_cast<int>(state.range(0)), [&](int i) {
      const Station& station = request.stations[static_cast<std::size_t>(i)];
      const auto command = station_command(rig.projector, station);
      const StationView view(rig.projector, *command, metric_content(station), scene.get(), floor, {});
      Image<Eigen::Vector2f> map(lens.width, lens.height);
      std::vector<PanelRay> row(static_cast<std::size_t>(lens.width));
      std::vector<std::optional<Placed>> placed;
      for (int y = 0; y < lens.height; ++y) {
        for (int x = 0; x < lens.width; ++x) {
          row[static_cast<std::size_t>(x)] = panel_ray(lens, Eigen::Vector2d(x, y));
        }
        view.lit(row, placed);
        for (int x = 0; x < lens.width; ++x) {
          const auto& here = placed[static_cast<std::size_t>(x)];
          map(x, y) = here ? here->content().cast<float>() : Eigen::Vector2f(-9, -9);
        }
      }
      benchmark::DoNotOptimize(map.data());
    });
  }
  state.counters["kB"] = static_cast<double>(request.stations.size()) * lens.width * lens.height * 8 / 1e3;
}
BENCHMARK(bm_fifteen_dense_maps_bake)->Arg(2)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A map that shows something at every pixel of the panel.
const proto::lut::WarpMap& full_map() {
  static const proto::lut::WarpMap map = [] {
    Station station = support::station_at("all", job().request.steering.T_rig_plane, 0, 0, 0.1, {6, 4});
    station.content_px = {6000, 4000};
    const Eigen::Vector2d command = Eigen::Vector2d::Zero();
    const StationView view(job().rig.projector, command, metric_content(station), nullptr, {}, {});
    return *bake_warp(view, PanelRays(job().rig.projector.lens, 2), command, {});
  }();
  return map;
}

template <class Use>
void for_each_tile(const proto::lut::WarpMap& map, proto::lut::WarpTile& tile, const Use& use) {
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      evaluate(map, column, row, tile);
      use();
    }
  }
}

/// Coordinates and gain of all 2.3 million pixels.
void bm_frame_evaluate(benchmark::State& state) {
  const auto tile = std::make_unique<proto::lut::WarpTile>();
  const proto::lut::WarpMap& map = full_map();
  for (auto _ : state) {
    for_each_tile(map, *tile, [&] { benchmark::DoNotOptimize(tile->u.data()); });
  }
  state.SetItemsProcessed(state.iterations() * 1920 * 1200);
}
BENCHMARK(bm_frame_evaluate)->Unit(benchmark::kMillisecond);

struct Dense {
  Image<std::int32_t> u{1920, 1200};
  Image<std::int32_t> v{1920, 1200};
  Image<std::uint16_t> gain{1920, 1200};
};

const Dense& dense_map() {
  static const Dense dense = [] {
    Dense made;
    const auto tile = std::make_unique<proto::lut::WarpTile>();
    for_each_tile(full_map(), *tile, [&] {
      for (int j = 0; j < tile->height; ++j) {
        for (int i = 0; i < tile->width; ++i) {
          const std::size_t at = proto::lut::WarpTile::at(i, j);
          made.u(tile->x + i, tile->y + j) = tile->u[at];
          made.v(tile->x + i, tile->y + j) = tile->v[at];
          made.gain(tile->x + i, tile->y + j) = tile->gain[at];
        }
      }
    });
    return made;
  }();
  return dense;
}

Image<std::uint8_t> content() {
  Image<std::uint8_t> picture(6001, 4001);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      picture(x, y) = static_cast<std::uint8_t>((x * 7) ^ (y * 13));
    }
  }
  return picture;
}

[[gnu::always_inline]] inline std::uint8_t sampled(const Image<std::uint8_t>& picture, int u, int v, int gain) {
  const int x = u >> 8;
  const int y = v >> 8;
  const int fx = u & 255;
  const int fy = v & 255;
  const std::uint8_t* top = picture.row(y) + x;
  const std::uint8_t* bottom = top + picture.width();
  const int mixed = (top[0] * (256 - fx) + top[1] * fx) * (256 - fy) + (bottom[0] * (256 - fx) + bottom[1] * fx) * fy;
  return static_cast<std::uint8_t>((static_cast<std::int64_t>(mixed) * gain) >> 31);
}

/// A grey frame warped with bilinear samples: coordinates from the map's cells.
void bm_frame_warp_from_cells(benchmark::State& state) {
  const Image<std::uint8_t> picture = content();
  Image<std::uint8_t> frame(1920, 1200);
  const auto tile = std::make_unique<proto::lut::WarpTile>();
  const proto::lut::WarpMap& map = full_map();
  for (auto _ : state) {
    for_each_tile(map, *tile, [&] {
      for (int j = 0; j < tile->height; ++j) {
        std::uint8_t* to = frame.row(tile->y + j) + tile->x;
        for (int i = 0; i < tile->width; ++i) {
          const std::size_t at = proto::lut::WarpTile::at(i, j);
          to[i] = sampled(picture, tile->u[at], tile->v[at], tile->gain[at]);
        }
      }
    });
    benchmark::DoNotOptimize(frame.data());
  }
  state.SetItemsProcessed(state.iterations() * 1920 * 1200);
}
BENCHMARK(bm_frame_warp_from_cells)->Unit(benchmark::kMillisecond);

/// The baseline: the same from 23 MB of stored coordinates.
void bm_frame_warp_from_dense_map(benchmark::State& state) {
  const Image<std::uint8_t> picture = content();
  Image<std::uint8_t> frame(1920, 1200);
  const Dense& map = dense_map();
  for (auto _ : state) {
    for (int y = 0; y < frame.height(); ++y) {
      for (int x = 0; x < frame.width(); ++x) {
        frame(x, y) = sampled(picture, map.u(x, y), map.v(x, y), map.gain(x, y));
      }
    }
    benchmark::DoNotOptimize(frame.data());
  }
  state.SetItemsProcessed(state.iterations() * 1920 * 1200);
}
BENCHMARK(bm_frame_warp_from_dense_map)->Unit(benchmark::kMillisecond);

void bm_place_steer(benchmark::State& state) {
  const auto table = bake_steering(job().rig.projector, job().request.steering);
  double x = 0;
  for (auto _ : state) {
    x = x < 1 ? x + 0.001 : -1;
    benchmark::DoNotOptimize(table->command({x, 0.3}));
  }
}
BENCHMARK(bm_place_steer);

}  // namespace

BENCHMARK_MAIN();
