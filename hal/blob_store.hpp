// bound to control: named bytes that survive power cuts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::hal {

/// Contract. Names are 1 to 64 of a-z, 0-9, '.', '_' and '-', and do not begin with '.'.
/// Every operation: kBadValue: not such a name; kDeviceUnavailable: the medium does not answer.
class BlobStore {
 public:
  BlobStore() = default;
  BlobStore(const BlobStore&) = delete;
  BlobStore& operator=(const BlobStore&) = delete;
  virtual ~BlobStore() = default;

  /// Replaces `name` as a whole; when it returns, the bytes survive a power cut; when it fails or power is cut, the old
  /// bytes are still there. kDiskFull; kStoreReadOnly; kWriteFailed.
  Status put(std::string_view name, std::span<const std::uint8_t> bytes);
  /// kBlobMissing: no such name; kDataLoss: the bytes are not those that were put.
  Result<std::vector<std::uint8_t>> get(std::string_view name);
  /// Harmless when there is none. kStoreReadOnly; kWriteFailed.
  Status erase(std::string_view name);
  /// All names, in order of their bytes.
  Result<std::vector<std::string>> list() { return do_list(); }
  /// Bytes that still fit, at most.
  Result<std::uint64_t> free_bytes() { return do_free_bytes(); }

 private:
  virtual Status do_put(std::string_view name, std::span<const std::uint8_t> bytes) = 0;
  virtual Result<std::vector<std::uint8_t>> do_get(std::string_view name) = 0;
  virtual Status do_erase(std::string_view name) = 0;
  virtual Result<std::vector<std::string>> do_list() = 0;
  virtual Result<std::uint64_t> do_free_bytes() = 0;
};

}  // namespace raysteer::hal
