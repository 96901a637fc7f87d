#include "host/exchange/surface_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "host/exchange/ply.hpp"
#include "host/exchange/write_file.hpp"

namespace raysteer::host::exchange {
namespace {

constexpr std::string_view kRigComment = "raysteer surface 1, rig ";
constexpr std::size_t kPointBytes = 7 * sizeof(float) + 3;
constexpr std::size_t kTriangleBytes = 1 + 3 * sizeof(std::uint32_t);

/// Of every point by the triangles around it, towards the eye; zero where there are none.
std::vector<Eigen::Vector3f> normals(const SurfaceFile& surface) {
  std::vector<Eigen::Vector3f> normals(surface.points.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3f normal =
        (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]).normalized().cast<float>();
    for (const std::uint32_t corner : {a, b, c}) {
      normals[corner] += normal;
    }
  }
  for (Eigen::Vector3f& normal : normals) {
    normal = normal.norm() > 1e-6F ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f(0, 0, 0);
  }
  return normals;
}

/// What stands between `before` and the line's end, where it first stands in the header.
std::optional<std::string_view> line_of(std::string_view header, std::string_view before) {
  const std::size_t at = header.find(before);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view rest = header.substr(at + before.size());
  return rest.substr(0, rest.find('\n'));
}

std::optional<std::size_t> count_of(std::string_view header, std::string_view before) {
  const auto text = line_of(header, before);
  std::size_t count = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), count).ec != std::errc()) {
    return std::nullopt;
  }
  return count;
}

std::uint32_t word(const char* bytes) {
  std::uint32_t value = 0;
  for (unsigned k = 0; k < 4; ++k) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) << (8 * k);
  }
  return value;
}

}  // namespace

std::string to_ply(const SurfaceFile& surface, const std::vector<std::uint8_t>& grey) {
  const std::vector<Eigen::Vector3f> facing = normals(surface);
  std::vector<PlyPoint> points;
  points.reserve(surface.points.size());
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    const Eigen::Vector3f p = surface.points[k].cast<float>();
    points.push_back({.x = p.x(),
                      .y = p.y(),
                      .z = p.z(),
                      .nx = facing[k].x(),
                      .ny = facing[k].y(),
                      .nz = facing[k].z(),
                      .sigma = surface.sigma_m[k],
                      .grey = grey.empty() ? std::uint8_t{200} : grey[k]});
  }
  return to_ply(points, surface.triangles, std::string(kRigComment) + surface.rig_id);
}

Result<SurfaceFile> surface_from_ply(std::string_view bytes, std::string_view name) {
  const auto broken = [&](const std::string& why) {
    return fail(RCode::kMeshSyntax,
                std::string(name) + ": expected a surface.ply that 'raysteer scan --rig' wrote; " + why);
  };
  constexpr std::string_view kEnd = "end_header\n";
  const std::size_t end = bytes.substr(0, 4096).find(kEnd);
  if (!bytes.starts_with("ply\n") || end == std::string_view::npos) {
    return broken("it has no PLY header");
  }
  const std::string_view header = bytes.substr(0, end);
  const auto rig = line_of(header, std::string("comment ") + std::string(kRigComment));
  const auto vertices = count_of(header, "element vertex ");
  const auto faces = count_of(header, "element face ");
  if (!rig || !vertices) {
    return broken("its header lacks the rig's id or the number of points");
  }
  if (!faces || *faces == 0) {
    return fail(RCode::kMeshEmpty, std::string(name) + " has no triangles; scan looks that see the surface");
  }
  const std::string_view body = bytes.substr(end + kEnd.size());
  // Neither may be so large that their bytes overflow.
  if (*vertices > body.size() || *faces > body.size() ||
      body.size() != *vertices * kPointBytes + *faces * kTriangleBytes) {
    return broken("it holds " + std::to_string(body.size()) + " bytes, not those of " + std::to_string(*vertices) +
                  " points and " + std::to_string(*faces) + " triangles");
  }
  SurfaceFile surface{.rig_id = std::string(*rig), .points = {}, .sigma_m = {}, .triangles = {}};
  const char* at = body.data();
  for (std::size_t k = 0; k < *vertices; ++k, at += kPointBytes) {
    std::array<float, 7> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = std::bit_cast<float>(word(at + 4 * i));
    }
    if (!std::ranges::all_of(values, [](float value) { return std::isfinite(value); })) {
      return fail(RCode::kMeshNotFinite, std::string(name) + ": point " + std::to_string(k) + " is not finite");
    }
    surface.points.emplace_back(values[0], values[1], values[2]);
    surface.sigma_m.push_back(std::abs(values[6]));
  }
  for (std::size_t k = 0; k < *faces; ++k, at += kTriangleBytes) {
    const std::array<std::uint32_t, 3> corners{word(at + 1), word(at + 5), word(at + 9)};
    if (*at != 3) {
      return broken("face " + std::to_string(k) + " is no triangle");
    }
    if (std::ranges::max(corners) >= *vertices) {
      return fail(RCode::kMeshIndex, std::string(name) + ": triangle " + std::to_string(k) +
                                         " names a point that is not there; scan the surface again");
    }
    surface.triangles.push_back(corners);
  }
  return surface;
}

Result<SurfaceFile> read_surface(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / kSurfaceFile : path;
  const auto bytes = read_file(file);
  RAYSTEER_TRY(bytes);
  return surface_from_ply(*bytes, file.string());
}

}  // namespace raysteer::host::exchange
