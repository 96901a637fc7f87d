#include "firmware/rig/devices.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "hal/base/nearest.hpp"

namespace raysteer::firmware::rig {
namespace {

class MockDevices : public Devices {
 public:
  explicit MockDevices(std::unique_ptr<hal::mock::MockRig> rig) : rig_(std::move(rig)) {}
  hal::Rig rig() override { return rig_->rig(); }
  hal::mock::MockRig* pretend() override { return rig_.get(); }

 private:
  std::unique_ptr<hal::mock::MockRig> rig_;
};

Result<std::unique_ptr<Devices>> make_mock(const proto::board::Board& board, Pretend pretend) {
  const Result<hal::mock::RigParameters> parameters = mock_parameters(board, pretend);
  if (!parameters) {
    return parameters.error();
  }
  auto rig = hal::mock::MockRig::make(*parameters, std::move(pretend.scene));
  if (!rig) {
    return std::move(rig).error();
  }
  return std::unique_ptr<Devices>(std::make_unique<MockDevices>(*std::move(rig)));
}

struct BackEnd {
  std::string_view name;  ///< in the board file
  Result<std::unique_ptr<Devices>> (*make)(const proto::board::Board& board, Pretend pretend);
};

constexpr std::array kBackEnds{
    BackEnd{"mock", make_mock},
};

}  // namespace

std::vector<std::string_view> back_ends() {
  std::vector<std::string_view> names;
  std::ranges::transform(kBackEnds, std::back_inserter(names), &BackEnd::name);
  return names;
}

Result<std::unique_ptr<Devices>> make_devices(const proto::board::Board& board, Pretend pretend) {
  const auto found = std::ranges::find(kBackEnds, std::string_view(board.back_end), &BackEnd::name);
  if (found != kBackEnds.end()) {
    return found->make(board, std::move(pretend));
  }
  const std::vector<std::string_view> known = back_ends();
  std::string note = "board '" + board.name + "': back_end is '" + board.back_end + "'";
  note += did_you_mean(board.back_end, known) + " Known:";
  for (const std::string_view name : known) {
    note += " " + std::string(name);
  }
  return fail(RCode::kBadValue, note);
}

}  // namespace raysteer::firmware::rig
