// value: which pretend rig: what every use of raysteer-sim is told.
#pragma once

#include <string>
#include <vector>

namespace raysteer::host::sim {

struct PretendOptions {
  std::string board = "mock-galvo";  ///< a file, or the name of one that is installed
  std::string scene = "step";
  int seed = 1;
  std::vector<std::string> faults;
  int threads = 0;  ///< 0: as many as there are cores

  /// As raysteer-sim takes them.
  std::vector<std::string> arguments() const {
    std::vector<std::string> words{"--board", board, "--scene", scene, "--seed", std::to_string(seed)};
    if (threads > 0) {
      words.insert(words.end(), {"--threads", std::to_string(threads)});
    }
    for (const std::string& fault : faults) {
      words.insert(words.end(), {"--fault", fault});
    }
    return words;
  }
};

}  // namespace raysteer::host::sim
