// pure: SHA-256 by OpenSSL's libcrypto, which the device carries for its connections anyway.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace raysteer::proto::lut {

using Hash = std::array<std::uint8_t, 32>;

Hash sha256(std::span<const std::uint8_t> bytes);

}  // namespace raysteer::proto::lut
