#include <string>
#include <vector>

#include "host/cli/run.hpp"

int main(int count, char** words) {
  return raysteer::host::cli::run(raysteer::host::cli::all_commands(),
                                  std::vector<std::string>(words + 1, words + count));
}
