#include "host/exchange/ply.hpp"

#include <bit>
#include <cstddef>

namespace raysteer::host::exchange {
namespace {

constexpr std::size_t kPointBytes = 7 * sizeof(float) + 3;
constexpr std::size_t kTriangleBytes = 1 + 3 * sizeof(std::uint32_t);

char* put(char* out, std::uint32_t bits) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    *out++ = static_cast<char>(bits >> shift & 0xff);
  }
  return out;
}

}  // namespace

std::string to_ply(std::span<const PlyPoint> points) { return to_ply(points, {}, ""); }

std::string to_ply(std::span<const PlyPoint> points, std::span<const PlyTriangle> triangles, std::string_view comment) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment metres; x right, y down, z forward\n";
  if (!comment.empty()) {
    bytes += "comment " + std::string(comment) + "\n";
  }
  bytes += "element vertex " + std::to_string(points.size()) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "sigma"}) {
    bytes += std::string("property float ") + name + "\n";
  }
  for (const char* name : {"red", "green", "blue"}) {
    bytes += std::string("property uchar ") + name + "\n";
  }
  if (!triangles.empty()) {
    bytes += "element face " + std::to_string(triangles.size()) + "\nproperty list uchar uint vertex_indices\n";
  }
  bytes += "end_header\n";
  const std::size_t header = bytes.size();
  bytes.resize(header + points.size() * kPointBytes + triangles.size() * kTriangleBytes);
  char* out = bytes.data() + header;
  for (const PlyPoint& point : points) {
    for (const float value : {point.x, point.y, point.z, point.nx, point.ny, point.nz, point.sigma}) {
      out = put(out, std::bit_cast<std::uint32_t>(value));
    }
    for (int channel = 0; channel < 3; ++channel) {
      *out++ = static_cast<char>(point.grey);
    }
  }
  for (const PlyTriangle& triangle : triangles) {
    *out++ = 3;
    for (const std::uint32_t corner : triangle) {
      out = put(out, corner);
    }
  }
  return bytes;
}

}  // namespace raysteer::host::exchange
