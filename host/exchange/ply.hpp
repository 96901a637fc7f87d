// Point clouds and surfaces as binary little-endian PLY: what CloudCompare, MeshLab, Open3D and Blender read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace raysteer::host::exchange {

struct PlyPoint {
  float x = 0, y = 0, z = 0;     ///< metres, rig frame: x right, y down, z forward
  float nx = 0, ny = 0, nz = 0;  ///< unit length, towards the camera; zero where unknown
  float sigma = 0;               ///< root of the largest eigenvalue of the point's covariance, metres
  std::uint8_t grey = 0;         ///< of the white frame
};

/// The file's bytes: x y z nx ny nz sigma red green blue.
std::string to_ply(std::span<const PlyPoint> points);

using PlyTriangle = std::array<std::uint32_t, 3>;
/// The same and, behind them, triangles between them. `comment`: one line for the header.
std::string to_ply(std::span<const PlyPoint> points, std::span<const PlyTriangle> triangles, std::string_view comment);

}  // namespace raysteer::host::exchange
