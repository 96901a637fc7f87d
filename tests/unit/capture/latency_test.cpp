#include "firmware/capture/latency.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace raysteer::firmware::capture {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds kFrame{16'666'667};

struct Display {
  nanoseconds latency;
  nanoseconds exposure = 3 * kFrame;
  int probes = 0;

  // Share of the exposure in which white, shown for four frames when as captured, is lit.
  double level(const LatencySearch::Probe& probe) {
    ++probes;
    const nanoseconds lit_end = probe.as_captured ? latency + 4 * kFrame : latency + 100 * kFrame;
    const nanoseconds begin = std::max(probe.delay, latency);
    const nanoseconds end = std::min(probe.delay + exposure, lit_end);
    return static_cast<double>(std::max(end - begin, nanoseconds(0)).count()) / static_cast<double>(exposure.count());
  }
};

TEST(Latency, is_found_in_a_few_exposures_wherever_it_lies) {
  for (const double frames : {0.0, 0.4, 1.0, 2.0, 2.5, 5.0, 11.0}) {
    Display display{.latency = nanoseconds(static_cast<long>(frames * kFrame.count()))};
    LatencySearch search(kFrame, display.exposure, 12 * kFrame);
    while (const auto probe = search.next()) {
      search.take(display.level(*probe));
    }
    ASSERT_TRUE(search.latency()) << frames;
    EXPECT_NEAR(static_cast<double>((*search.latency() - display.latency).count()), 0, 1e3) << frames;
    EXPECT_GT(search.plateau(), 0.999);
    EXPECT_LE(display.probes, 6) << frames;
  }
}

TEST(Latency, beyond_belief_is_not_found) {
  Display display{.latency = 20 * kFrame};
  LatencySearch search(kFrame, display.exposure, 12 * kFrame);
  while (const auto probe = search.next()) {
    search.take(display.level(*probe));
  }
  EXPECT_FALSE(search.latency());
}

TEST(Latency, of_a_display_that_never_holds_a_picture_is_not_found) {
  LatencySearch search(kFrame, 3 * kFrame, 12 * kFrame);
  for (int k = 0; k < 20 && search.next(); ++k) {
    search.take(0.6);
  }
  EXPECT_FALSE(search.next());
  EXPECT_FALSE(search.latency());
}

}  // namespace
}  // namespace raysteer::firmware::capture
