#include "hal/blob_store.hpp"

#include <algorithm>

namespace raysteer::hal {
namespace {

Status check_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  };
  if (!name.empty() && name.size() <= 64 && name.front() != '.' && std::ranges::all_of(name, allowed)) {
    return ok();
  }
  return fail(RCode::kBadValue, "a blob's name is 1 to 64 of a-z, 0-9, '.', '_', '-', not beginning with '.'; got '" +
                                    std::string(name.substr(0, 80)) + "'");
}

}  // namespace

Status BlobStore::put(std::string_view name, std::span<const std::uint8_t> bytes) {
  RAYSTEER_TRY(check_name(name));
  return do_put(name, bytes);
}

Result<std::vector<std::uint8_t>> BlobStore::get(std::string_view name) {
  RAYSTEER_TRY(check_name(name));
  return do_get(name);
}

Status BlobStore::erase(std::string_view name) {
  RAYSTEER_TRY(check_name(name));
  return do_erase(name);
}

}  // namespace raysteer::hal
