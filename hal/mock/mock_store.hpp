// bound to control: blobs in memory, on a medium that fills up, rots and loses power.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hal/blob_store.hpp"
#include "hal/clock.hpp"
#include "hal/mock/fault.hpp"

namespace raysteer::hal::mock {

struct StoreParameters {
  std::uint64_t capacity = std::uint64_t{1} << 30U;  ///< bytes
  std::uint64_t page = 4'096;                        ///< one write takes so many bytes
};

/// A put writes the pages aside, then one more page that makes them the blob: power may fail at any of these writes.
class MockStore final : public BlobStore {
 public:
  MockStore(const Clock& clock, const StoreParameters& parameters, Faults faults);

  /// Power fails at the `nth` write from now on; 1 is the next.
  void cut_power_at(std::uint64_t nth) { writes_left_ = nth; }
  bool has_power() const { return power_; }
  void power_on();
  std::uint64_t writes() const { return writes_; }

 private:
  struct Blob {
    std::vector<std::uint8_t> bytes;
    std::uint64_t sum = 0;
  };

  Status do_put(std::string_view name, std::span<const std::uint8_t> bytes) override;
  Result<std::vector<std::uint8_t>> do_get(std::string_view name) override;
  Status do_erase(std::string_view name) override;
  Result<std::vector<std::string>> do_list() override;
  Result<std::uint64_t> do_free_bytes() override;

  Status check_medium();
  Status check_writable();
  Status write_page();
  std::uint64_t pages(std::uint64_t bytes) const { return (bytes + parameters_.page - 1) / parameters_.page; }
  std::uint64_t used() const;

  const Clock& clock_;
  StoreParameters parameters_;
  Faults faults_;
  std::map<std::string, Blob, std::less<>> blobs_;
  bool power_ = true;
  std::uint64_t writes_ = 0;
  std::uint64_t writes_left_ = 0;  ///< until power fails; 0: it does not
};

}  // namespace raysteer::hal::mock
