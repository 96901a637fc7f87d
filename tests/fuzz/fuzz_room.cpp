// Survey and stations files from anywhere: read, and if they read, written and read again to the same value.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/base/result.hpp"
#include "proto/stations/stations.hpp"
#include "proto/survey/survey.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace raysteer;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto survey = proto::survey::read_survey(text, "fuzz.toml")) {
    RAYSTEER_CHECK(proto::survey::check(*survey));
    const auto again = proto::survey::read_survey(proto::survey::write_survey(*survey), "again.toml");
    RAYSTEER_CHECK(again && *again == *survey);
  }
  if (const auto stations = proto::stations::read_stations(text, "fuzz.toml")) {
    const auto again = proto::stations::read_stations(proto::stations::write_stations(*stations), "again.toml");
    RAYSTEER_CHECK(again && *again == *stations);
  }
  return 0;
}
