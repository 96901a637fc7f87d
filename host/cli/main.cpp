#include <string>
#include <vector>

#include "calib/solve/quiet.hpp"
#include "host/cli/run.hpp"

int main(int count, char** words) {
  raysteer::calib::solve::quiet_solver();
  return raysteer::host::cli::run(raysteer::host::cli::all_commands(),
                                  std::vector<std::string>(words + 1, words + count));
}
