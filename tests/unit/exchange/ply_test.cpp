// PLY bytes are laid out as the header says.
#include "host/exchange/ply.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace raysteer::host::exchange {
namespace {

float number_at(const std::string& bytes, std::size_t place) {
  float value = 0;
  std::memcpy(&value, bytes.data() + place, sizeof value);  // tests run on little-endian machines
  return value;
}

TEST(Ply, holds_each_point_as_its_header_says) {
  const std::vector<PlyPoint> points{{1, 2, 3, 0, 0, -1, 0.5F, 7}, {-1, 0.25F, 4, 0, 1, 0, 0.125F, 255}};
  const std::string bytes = to_ply(points);
  EXPECT_EQ(bytes.find("ply\nformat binary_little_endian 1.0\n"), 0U);
  EXPECT_NE(bytes.find("element vertex 2\n"), std::string::npos);
  const std::string end = "end_header\n";
  const std::size_t data = bytes.find(end) + end.size();
  ASSERT_EQ(bytes.size(), data + 2 * 31);
  EXPECT_EQ(number_at(bytes, data), 1);
  EXPECT_EQ(number_at(bytes, data + 20), -1);
  EXPECT_EQ(number_at(bytes, data + 24), 0.5F);
  EXPECT_EQ(bytes[data + 28], 7);
  EXPECT_EQ(number_at(bytes, data + 31 + 4), 0.25F);
  EXPECT_EQ(bytes[data + 31 + 30], static_cast<char>(255));
}

TEST(Ply, an_empty_cloud_is_a_file_too) {
  const std::string bytes = to_ply({});
  EXPECT_NE(bytes.find("element vertex 0\n"), std::string::npos);
  EXPECT_EQ(bytes.substr(bytes.size() - 11), "end_header\n");
}

}  // namespace
}  // namespace raysteer::host::exchange
