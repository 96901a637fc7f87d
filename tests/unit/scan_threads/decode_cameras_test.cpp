// Cameras decoded side by side: what the thread sanitizer looks at.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>

#include "host/scan/decode_look.hpp"
#include "tests/unit/scan/rendered_session.hpp"

namespace raysteer::host::scan {
namespace {

bool same_bytes(const Image<float>& a, const Image<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(DecodeCameras, side_by_side_gives_what_each_gives_alone) {
  const RenderedSession rendered(small_rig(), {{0, "left"}, {1, "right"}});
  const session::Session session = rendered.open();
  std::atomic<int> ticks = 0;
  const auto together = decode_cameras(session, 0, {}, [&](double) { return ++ticks > 0; });
  ASSERT_TRUE(together) << together.error().message();
  ASSERT_EQ(together->size(), 2U);
  EXPECT_GT(ticks, 10);
  for (int camera = 0; camera < 2; ++camera) {
    const auto alone = decode_look(session, camera, 0);
    ASSERT_TRUE(alone);
    const DecodedLook& other = (*together)[static_cast<std::size_t>(camera)];
    EXPECT_TRUE(same_bytes(alone->codes.x, other.codes.x));
    EXPECT_TRUE(same_bytes(alone->codes.variance_y, other.codes.variance_y));
    EXPECT_TRUE(std::equal(alone->white.data(), alone->white.data() + alone->white.size(), other.white.data()));
  }
}

TEST(DecodeCameras, a_fault_in_one_camera_is_named_and_stops_the_other) {
  const RenderedSession rendered(small_rig(), {{0, "left"}, {1, "right"}});
  const session::Session session = rendered.open();
  std::filesystem::resize_file(session.path({1, 0, 3}), 100);
  const auto decoded = decode_cameras(session, 0);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().rcode, RCode::kFileTruncated);
  EXPECT_NE(decoded.error().note.find("right"), std::string::npos) << decoded.error().note;
}

}  // namespace
}  // namespace raysteer::host::scan
