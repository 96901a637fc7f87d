#include "hal/mock/mock_store.hpp"

#include "hal/base/noise.hpp"
#include "hal/mock/device_number.hpp"

namespace raysteer::hal::mock {
namespace {

/// FNV-1a: enough to notice a flipped bit.
std::uint64_t sum_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const std::uint8_t byte : bytes) {
    sum = (sum ^ byte) * 0x100000001b3U;
  }
  return sum;
}

}  // namespace

MockStore::MockStore(const Clock& clock, const StoreParameters& parameters, Faults faults)
    : clock_(clock), parameters_(parameters), faults_(std::move(faults)) {
  RAYSTEER_CHECK(parameters.page > 0);
}

void MockStore::power_on() {
  power_ = true;
  writes_left_ = 0;
}

Status MockStore::check_medium() {
  if (!power_) {
    return fail(RCode::kDeviceUnavailable, "the store has no power");
  }
  return faults_.lasting("unplug", clock_.now()) ? Status(fail(RCode::kDeviceUnavailable, "the store's medium")) : ok();
}

Status MockStore::check_writable() {
  RAYSTEER_TRY(check_medium());
  return faults_.lasting("read-only", clock_.now()) ? Status(fail(RCode::kStoreReadOnly)) : ok();
}

Status MockStore::write_page() {
  if (const std::optional<double> nth = faults_.take("power-cut", clock_.now())) {
    cut_power_at(static_cast<std::uint64_t>(*nth));
  }
  if (writes_left_ > 0 && --writes_left_ == 0) {
    power_ = false;
    return fail(RCode::kDeviceUnavailable, "power failed during a write");
  }
  ++writes_;
  if (faults_.take("io-error", clock_.now())) {
    return fail(RCode::kWriteFailed, "the medium reports an input/output error");
  }
  return ok();
}

std::uint64_t MockStore::used() const {
  std::uint64_t total = 0;
  for (const auto& [name, blob] : blobs_) {
    total += (pages(blob.bytes.size()) + 1) * parameters_.page;
  }
  return total;
}

Result<std::uint64_t> MockStore::do_free_bytes() {
  RAYSTEER_TRY(check_medium());
  const std::uint64_t taken = used() + parameters_.page;  // a blob's last page names it
  const bool full = faults_.lasting("full", clock_.now()).has_value();
  return full || taken >= parameters_.capacity ? 0 : parameters_.capacity - taken;
}

Status MockStore::do_put(std::string_view name, std::span<const std::uint8_t> bytes) {
  RAYSTEER_TRY(check_writable());
  const Result<std::uint64_t> room = do_free_bytes();
  if (!room) {
    return room.error();
  }
  // The old bytes stay until the new ones are safe, so both must fit.
  if (pages(bytes.size()) * parameters_.page > *room) {
    return fail(RCode::kDiskFull, "'" + std::string(name) + "' needs " + std::to_string(bytes.size()) + " bytes, " +
                                      std::to_string(*room) + " are free");
  }
  for (std::uint64_t page = 0; page <= pages(bytes.size()); ++page) {
    RAYSTEER_TRY(write_page());
  }
  blobs_.insert_or_assign(std::string(name), Blob{.bytes = {bytes.begin(), bytes.end()}, .sum = sum_of(bytes)});
  return ok();
}

Result<std::vector<std::uint8_t>> MockStore::do_get(std::string_view name) {
  RAYSTEER_TRY(check_medium());
  const auto found = blobs_.find(name);
  if (found == blobs_.end()) {
    return fail(RCode::kBlobMissing, "'" + std::string(name) + "'");
  }
  Blob& blob = found->second;
  if (!blob.bytes.empty() && faults_.take("rot", clock_.now())) {
    Noise noise(blob.sum, DeviceNumber::kStore);
    blob.bytes[noise.bits() % blob.bytes.size()] ^= static_cast<std::uint8_t>(1U << (noise.bits() % 8));
  }
  if (sum_of(blob.bytes) != blob.sum) {
    return fail(RCode::kDataLoss, "'" + std::string(name) + "': the bytes read do not have the sum that was written");
  }
  return blob.bytes;
}

Status MockStore::do_erase(std::string_view name) {
  RAYSTEER_TRY(check_writable());
  const auto found = blobs_.find(name);
  if (found != blobs_.end()) {
    RAYSTEER_TRY(write_page());
    blobs_.erase(found);
  }
  return ok();
}

Result<std::vector<std::string>> MockStore::do_list() {
  RAYSTEER_TRY(check_medium());
  std::vector<std::string> names;
  for (const auto& [name, blob] : blobs_) {
    names.push_back(name);
  }
  return names;
}

}  // namespace raysteer::hal::mock
