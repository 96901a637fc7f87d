#include "proto/lut/lut_set.hpp"

#include <algorithm>
#include <optional>

#include "proto/lut/bytes.hpp"
#include "proto/lut/hash.hpp"
#include "proto/lut/sections.hpp"

namespace raysteer::proto::lut {
namespace {

constexpr std::size_t kHashBytes = sizeof(Hash);

struct Section {
  SectionKind kind;
  std::vector<std::uint8_t> bytes;
};

struct Row {
  SectionKind kind{};
  std::uint64_t size = 0;
  std::span<const std::uint8_t> hash;
  std::span<const std::uint8_t> bytes;
};

std::string seen(std::uint64_t number) { return std::to_string(number); }

/// The section table, hashes compared; sections lie behind it without gaps.
Result<std::vector<Row>> read_rows(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  const auto magic = reader.take_bytes(kLutMagic.size());
  if (!std::ranges::equal(magic, kLutMagic)) {
    return fail(RCode::kTableDamaged, "a LUT set begins with 'RLUT'");
  }
  const auto version = reader.take<std::uint32_t>();
  const auto count = reader.take<std::uint32_t>();
  if (bytes.size() >= kHeaderBytes && version != kLutVersion) {
    return fail(version > kLutVersion ? RCode::kTableVersion : RCode::kTableDamaged,
                "format " + seen(version) + " came, this version reads " + seen(kLutVersion));
  }
  const std::size_t table = kHeaderBytes + std::size_t{count} * kSectionBytes;
  if (bytes.size() < kHeaderBytes || count > kMostSections || bytes.size() < table + kHashBytes) {
    return fail(RCode::kTableDamaged, "cut off: " + seen(bytes.size()) + " bytes end before the section table");
  }
  if (!std::ranges::equal(sha256(bytes.first(table)), bytes.subspan(table, kHashBytes))) {
    return fail(RCode::kTableDamaged, "the section table differs from its hash");
  }
  std::vector<Row> rows(count);
  for (Row& row : rows) {
    row.kind = static_cast<SectionKind>(reader.take<std::uint32_t>());
    const auto zero = reader.take<std::uint32_t>();
    row.size = reader.take<std::uint64_t>();
    row.hash = reader.take_bytes(kHashBytes);
    if (zero != 0) {
      return fail(RCode::kTableDamaged, "a reserved number in the section table is not zero");
    }
  }
  reader.take_bytes(kHashBytes);
  for (Row& row : rows) {
    if (!reader.has(row.size, 1)) {
      return fail(RCode::kTableDamaged, "cut off: " + seen(bytes.size()) + " bytes end within a section");
    }
    row.bytes = reader.take_bytes(row.size);
  }
  if (!reader.finished()) {
    return fail(RCode::kTableDamaged, "bytes are left over behind the last section");
  }
  for (const Row& row : rows) {
    if (!std::ranges::equal(sha256(row.bytes), row.hash)) {
      return fail(RCode::kTableDamaged, "a section differs from its hash");
    }
  }
  return rows;
}

Status check_names(const LutSet& set) {
  for (std::size_t i = 0; i < set.maps.size(); ++i) {
    const std::string& name = set.maps[i].parts().name;
    if (set.find(name) != &set.maps[i]) {
      return fail(RCode::kTableDamaged, "two warp maps have the name '" + name + "'");
    }
  }
  return ok();
}

}  // namespace

const WarpMap* LutSet::find(std::string_view name) const {
  const auto found = std::ranges::find_if(maps, [&](const WarpMap& map) { return map.parts().name == name; });
  return found == maps.end() ? nullptr : &*found;
}

std::optional<MirrorCommand> LutSet::aim(const PlanePoint& place) const {
  if (std::ranges::any_of(keep_out, [&](const KeepOut& zone) { return zone.contains(place); })) {
    return std::nullopt;
  }
  return steering.command(place);
}

Result<std::vector<std::uint8_t>> write_lut_set(const LutSet& set) {
  RAYSTEER_TRY(check_names(set));
  for (const KeepOut& zone : set.keep_out) {
    RAYSTEER_TRY(check(zone));
  }
  std::vector<Section> sections;
  if (set.calibration_id.size() > kLongestName || set.board_id.size() > kLongestName) {
    return fail(RCode::kTableDamaged, "ids of calibration and board have 1 to 64 bytes");
  }
  sections.push_back(
      {SectionKind::kIdentity, write_identity({.calibration_id = set.calibration_id, .board_id = set.board_id})});
  RAYSTEER_TRY(read_identity(sections.back().bytes));
  sections.push_back({SectionKind::kSteering, write_steering(set.steering)});
  sections.push_back({SectionKind::kKeepOut, write_keep_out(set.keep_out)});
  for (const WarpMap& map : set.maps) {
    sections.push_back({SectionKind::kWarpMap, write_warp_map(map)});
  }
  if (sections.size() > kMostSections) {
    return fail(RCode::kTableDamaged, "a LUT set has at most 4093 warp maps, got " + seen(set.maps.size()));
  }
  ByteWriter writer;
  writer.put(kLutMagic);
  writer.put(kLutVersion);
  writer.put(static_cast<std::uint32_t>(sections.size()));
  for (const Section& section : sections) {
    writer.put(static_cast<std::uint32_t>(section.kind));
    writer.put(std::uint32_t{0});
    writer.put(std::uint64_t{section.bytes.size()});
    writer.put(sha256(section.bytes));
  }
  const Hash table = sha256(writer.bytes());
  writer.put(table);
  for (const Section& section : sections) {
    writer.put(section.bytes);
  }
  return writer.take();
}

Result<LutSet> read_lut_set(std::span<const std::uint8_t> bytes) {
  const auto rows = read_rows(bytes);
  RAYSTEER_TRY(rows);
  constexpr std::array kFirst{SectionKind::kIdentity, SectionKind::kSteering, SectionKind::kKeepOut};
  for (std::size_t i = 0; i < std::max(rows->size(), kFirst.size()); ++i) {
    if (i >= rows->size() || (*rows)[i].kind != (i < kFirst.size() ? kFirst[i] : SectionKind::kWarpMap)) {
      return fail(RCode::kTableDamaged, "sections are identity, steering, keep-out zones, then warp maps only");
    }
  }
  auto identity = read_identity((*rows)[0].bytes);
  RAYSTEER_TRY(identity);
  auto steering = read_steering((*rows)[1].bytes);
  RAYSTEER_TRY(steering);
  auto keep_out = read_keep_out((*rows)[2].bytes);
  RAYSTEER_TRY(keep_out);
  LutSet set{.calibration_id = std::move(identity->calibration_id),
             .board_id = std::move(identity->board_id),
             .steering = std::move(*steering),
             .keep_out = std::move(*keep_out),
             .maps = {}};
  for (std::size_t i = kFirst.size(); i < rows->size(); ++i) {
    auto map = read_warp_map((*rows)[i].bytes);
    RAYSTEER_TRY(map);
    set.maps.push_back(std::move(*map));
  }
  RAYSTEER_TRY(check_names(set));
  return set;
}

std::string object_id(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : sha256(bytes)) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

}  // namespace raysteer::proto::lut
