#include "proto/lut/hash.hpp"

#include <openssl/evp.h>

#include "hal/base/result.hpp"

namespace raysteer::proto::lut {

Hash sha256(std::span<const std::uint8_t> bytes) {
  Hash hash{};
  unsigned size = 0;
  RAYSTEER_CHECK(EVP_Digest(bytes.data(), bytes.size(), hash.data(), &size, EVP_sha256(), nullptr) == 1);
  RAYSTEER_CHECK(size == hash.size());
  return hash;
}

}  // namespace raysteer::proto::lut
