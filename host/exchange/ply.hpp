// Point clouds as binary little-endian PLY: what CloudCompare, MeshLab, Open3D and Blender read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysteer::host::exchange {

struct PlyPoint {
  float x = 0, y = 0, z = 0;     ///< metres, rig frame: x right, y down, z forward
  float nx = 0, ny = 0, nz = 0;  ///< unit length, towards the camera; zero where unknown
  float sigma = 0;               ///< root of the largest eigenvalue of the point's covariance, metres
  std::uint8_t grey = 0;         ///< of the white frame
};

/// The file's bytes: x y z nx ny nz sigma red green blue.
std::string to_ply(std::span<const PlyPoint> points);

}  // namespace raysteer::host::exchange
