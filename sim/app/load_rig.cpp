#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "hal/mock/fault.hpp"
#include "sim/app/find_file.hpp"
#include "sim/app/modes.hpp"
#include "sim/scene/read_scene.hpp"

namespace raysteer::sim::app {

Result<LoadedRig> load_rig(const WhichRig& which) {
  LoadedRig loaded;
  const Result<std::filesystem::path> board_file = find_file("boards", which.board);
  if (!board_file) {
    return board_file.error();
  }
  const Result<std::string> text = read_text(*board_file);
  if (!text) {
    return text.error();
  }
  Result<proto::board::Board> board = proto::board::read_board(*text, board_file->string());
  if (!board) {
    return std::move(board).error();
  }
  loaded.board = *std::move(board);
  rig::PretendOptions options{.seed = which.seed, .faults = {}, .threads = which.threads};
  if (options.threads <= 0) {
    options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  for (const std::string& asked : which.faults) {
    Result<proto::board::Fault> fault = proto::board::read_fault(asked);
    if (!fault) {
      return std::move(fault).error();
    }
    options.faults.push_back(*std::move(fault));
  }
  const Result<std::filesystem::path> scene_file = find_file("scenes", which.scene);
  if (!scene_file) {
    return scene_file.error();
  }
  Result<scene::Scene> scene = scene::load_scene(*scene_file);
  if (!scene) {
    return std::move(scene).error();
  }
  loaded.scene = scene->name;
  auto rig = rig::PretendRig::make(loaded.board, *std::move(scene), options);
  if (!rig) {
    return std::move(rig).error();
  }
  loaded.rig = *std::move(rig);
  return loaded;
}

std::chrono::nanoseconds settle_timeout(const proto::board::Board& board) {
  return std::chrono::nanoseconds(std::llround(1e9 * board.mirror.settle_timeout_s));
}

Json faults() {
  Json words = Json::array();
  for (const hal::mock::FaultWord& word : hal::mock::fault_words()) {
    const std::vector<std::string_view> devices =
        word.device == "eye" ? std::vector<std::string_view>{"left", "right"} : std::vector{word.device};
    for (const std::string_view device : devices) {
      Json row{{"fault", std::string(device) + "." + std::string(word.what)},
               {"meaning", word.meaning},
               {"unit", word.unit},
               {"amount", nullptr}};
      if (std::isfinite(word.amount)) {
        row["amount"] = word.amount;
      }
      words.push_back(std::move(row));
    }
  }
  return {{"faults", std::move(words)}};
}

}  // namespace raysteer::sim::app
