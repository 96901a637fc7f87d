// Faults as values: their words, and what each does.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/unit/mock/small_rig.hpp"

namespace raysteer::hal::mock {
namespace {

using std::chrono::milliseconds;

RigParameters with(Fault fault) {
  RigParameters parameters = small_parameters();
  parameters.faults = {std::move(fault)};
  return parameters;
}

/// Light on, white shown and lit, cameras streaming, trigger armed, 200 ms in.
void begin(MockRig& rig) {
  const hal::Rig devices = rig.rig();
  ASSERT_TRUE(devices.projector.load(white_and_black()));
  ASSERT_TRUE(devices.projector.light(true));
  ASSERT_TRUE(devices.projector.show(StoredPattern{0}, rig.now()));
  ASSERT_TRUE(devices.cameras.configure({.exposure = milliseconds(10)}));
  ASSERT_TRUE(devices.cameras.start());
  ASSERT_TRUE(devices.trigger.arm(TriggerSource::kFired));
  rig.advance_to(RigTime(milliseconds(200)));
}

std::vector<FramePair> shoot(MockRig& rig, int shots) {
  for (int i = 0; i < shots; ++i) {
    EXPECT_TRUE(rig.trigger().fire(rig.now()));
    run_for(rig, milliseconds(40));
  }
  run_for(rig, milliseconds(300));
  std::vector<FramePair> pairs;
  for (;;) {
    auto next = rig.cameras().next_pair(rig.now());
    EXPECT_TRUE(next) << next.error().message();
    if (!next || !*next) {
      return pairs;
    }
    pairs.push_back(std::move(**next));
  }
}

double mean_code(const EyeFrame& frame) {
  const auto& pixels = std::get<Image<std::uint8_t>>(frame.pixels);
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    sum += pixels.data()[i];
  }
  return sum / static_cast<double>(pixels.size());
}

Fault fault(const char* device, const char* what, double amount = 0) {
  return {.device = device, .what = what, .from = RigTime(milliseconds(100)), .amount = amount};
}

TEST(FaultWords, are_each_listed_once_with_a_meaning) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const FaultWord& word : fault_words()) {
    EXPECT_TRUE(seen.insert({word.device, word.what}).second) << word.device << "." << word.what;
    EXPECT_FALSE(word.meaning.empty());
  }
}

TEST(FaultWords, suggest_the_nearest_device_and_word) {
  const auto note = [](const char* device, const char* what) {
    const Status status = check({.device = device, .what = what});
    return status ? std::string() : status.error().note;
  };
  EXPECT_EQ(note("left", "drop"), "");
  EXPECT_NE(note("projektor", "drop").find("did you mean 'projector'"), std::string::npos);
  EXPECT_NE(note("left", "dropp").find("did you mean 'drop'"), std::string::npos);
  EXPECT_NE(note("clock", "drop").find("expected step"), std::string::npos);
  EXPECT_FALSE(check({.device = "left", .what = "drop", .times = -1}));
  EXPECT_FALSE(MockRig::make(with({.device = "left", .what = "dropp"}), {}));
}

TEST(Faults, happen_from_their_instant_on_and_so_often) {
  const std::vector<Fault> two{{.device = "left", .what = "drop", .from = RigTime(milliseconds(10)), .times = 2}};
  Faults faults(two, "left");
  EXPECT_FALSE(faults.take("drop", RigTime(milliseconds(9))));
  EXPECT_FALSE(faults.take("miss", RigTime(milliseconds(10))));
  EXPECT_TRUE(faults.take("drop", RigTime(milliseconds(10))));
  EXPECT_TRUE(faults.take("drop", RigTime(milliseconds(20))));
  EXPECT_FALSE(faults.take("drop", RigTime(milliseconds(30))));
  EXPECT_FALSE(Faults(two, "right").take("drop", RigTime(milliseconds(20))));
}

TEST(Faults, last_so_long_so_often_with_as_long_in_between) {
  const std::vector<Fault> flaps{
      {.device = "interlock", .what = "flap", .from = RigTime(milliseconds(10)), .times = 2, .amount = 2e-3}};
  const Faults faults(flaps, "interlock");
  std::string open;
  for (int ms = 9; ms < 20; ++ms) {
    open += faults.lasting("flap", RigTime(milliseconds(ms))) ? 'x' : '.';
  }
  EXPECT_EQ(open, ".xx..xx....");
}

TEST(CameraFaults, lose_frames_and_edges_of_one_eye) {
  for (const char* what : {"drop", "miss"}) {
    const auto rig = small_rig(with(fault("right", what)));
    begin(*rig);
    const auto pairs = shoot(*rig, 2);
    ASSERT_EQ(pairs.size(), 2U) << what;
    EXPECT_TRUE(pairs[0].left && !pairs[0].right) << what;
    ASSERT_TRUE(pairs[1].right) << what;
    // A lost frame was counted, a missed edge was not.
    EXPECT_EQ(pairs[1].right->sequence, what == std::string("drop") ? 1U : 0U) << what;
  }
}

TEST(CameraFaults, change_what_a_frame_shows_and_says) {
  const auto first_left = [](const char* what) {
    const auto rig = small_rig(with(fault("left", what)));
    begin(*rig);
    auto pairs = shoot(*rig, 1);
    EXPECT_FALSE(pairs.empty()) << what;
    return std::move(*pairs.back().left);
  };
  EXPECT_LT(mean_code(first_left("black")), 5);
  EXPECT_GT(mean_code(first_left("bright")), 250);
  EXPECT_TRUE(first_left("damage").damaged);
  EXPECT_NEAR(mean_code(first_left("damage")), 0.75 * kWhiteCode, 8);
  const EyeFrame automatic = first_left("auto");
  EXPECT_TRUE(automatic.automatic);
  EXPECT_EQ(automatic.exposure, milliseconds(20));
  EXPECT_GT(mean_code(automatic), 1.4 * kWhiteCode);
  EXPECT_NEAR(mean_code(first_left("blur")), kWhiteCode, 12);
}

TEST(CameraFaults, end_automatic_exposure_when_configured_again) {
  const auto rig = small_rig(with(fault("left", "auto")));
  begin(*rig);
  EXPECT_TRUE(shoot(*rig, 1).at(0).left->automatic);
  ASSERT_TRUE(rig->cameras().stop());
  ASSERT_TRUE(rig->cameras().configure({.exposure = milliseconds(10)}));
  ASSERT_TRUE(rig->cameras().start());
  EXPECT_FALSE(shoot(*rig, 1).at(0).left->automatic);
}

TEST(CameraFaults, bring_frames_late_and_once_too_often) {
  const auto late = small_rig(with(fault("left", "late")));
  begin(*late);
  ASSERT_TRUE(late->trigger().fire(late->now()));
  run_for(*late, milliseconds(120));
  const auto right = late->cameras().next_pair(late->now());
  ASSERT_TRUE(right && *right);
  EXPECT_TRUE((*right)->right && !(*right)->left);
  run_for(*late, milliseconds(200));
  const auto left = late->cameras().next_pair(late->now());
  ASSERT_TRUE(left && *left);
  EXPECT_TRUE((*left)->left && !(*left)->right);
  const auto extra = small_rig(with({.device = "left", .what = "extra"}));
  begin(*extra);
  const auto pairs = shoot(*extra, 1);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_TRUE(pairs[0].left && !pairs[0].right);
  EXPECT_EQ(pairs[1].left->sequence, 1U);
  EXPECT_EQ(pairs[1].right->sequence, 0U);
}

TEST(TriggerFaults, lose_double_and_delay_edges) {
  const auto edges = [](const char* what) {
    const auto rig = small_rig(with(fault("trigger", what)));
    begin(*rig);
    EXPECT_TRUE(rig->trigger().fire(rig->now()));
    run_for(*rig, milliseconds(20));
    return *rig->trigger().edges();
  };
  EXPECT_EQ(edges("miss").size(), 0U);
  EXPECT_EQ(edges("double").size(), 2U);
  ASSERT_EQ(edges("late").size(), 1U);
  EXPECT_GT(edges("late")[0].stamp, RigTime(milliseconds(205)));
}

TEST(ProjectorFaults, show_something_else_than_was_presented) {
  const auto shot = [](const char* what) {
    const auto rig = small_rig(with(fault("projector", what)));
    begin(*rig);
    EXPECT_TRUE(rig->projector().show(StoredPattern{1}, rig->now()));
    run_for(*rig, milliseconds(100));
    EXPECT_TRUE(rig->projector().show(StoredPattern{0}, rig->now()));
    run_for(*rig, milliseconds(100));
    return mean_code(*shoot(*rig, 1).at(0).left);
  };
  EXPECT_NEAR(shot("drop"), kWhiteCode, 8) << "only a first frame is lost";
  EXPECT_LT(shot("lamp-off"), 5);
  EXPECT_NEAR(shot("wrong-screen"), kWhiteCode * 90 / 255.0, 8);
}

TEST(ProjectorFaults, drop_tear_and_delay_the_first_frame_of_a_picture) {
  const auto lit = [](const char* what, int frame) {
    const auto rig = small_rig(with(fault("projector", what)));
    begin(*rig);
    EXPECT_TRUE(rig->projector().show(StoredPattern{1}, rig->now()));
    run_for(*rig, milliseconds(150));
    const auto period = rig->projector().panel().frame_period;
    const RigTime first = (*rig->projector().presented())->stamp + 2 * period;
    return rig->light_between(first + frame * period, first + (frame + 1) * period);
  };
  constexpr float kDark = 0.01F;
  EXPECT_GT(lit("drop", 0).at(0).picture->light(0, 0), 1 - kDark);
  EXPECT_LT(lit("drop", 1).at(0).picture->light(0, 0), kDark);
  EXPECT_GT(lit("latency", 0).at(0).picture->light(0, 0), 1 - kDark);
  EXPECT_LT(lit("latency", 1).at(0).picture->light(0, 0), kDark);
  const auto torn = lit("tear", 0);
  ASSERT_EQ(torn.size(), 2U);
  EXPECT_EQ(torn[0].end_row, 20);
  EXPECT_EQ(torn[1].first_row, 20);
  EXPECT_GT(torn[0].picture->light(0, 0), 1 - kDark);
  EXPECT_LT(torn[1].picture->light(0, 0), kDark);
  EXPECT_EQ(lit("tear", 1).size(), 1U);
}

TEST(ProjectorFaults, refuse_one_command_and_miss_one_vblank) {
  const auto deaf = small_rig(with(fault("projector", "nak")));
  begin(*deaf);
  EXPECT_FALSE(deaf->projector().show(StoredPattern{1}, deaf->now()));
  EXPECT_TRUE(deaf->projector().show(StoredPattern{1}, deaf->now()));
  const auto vblank = [](const RigParameters& parameters) {
    const auto rig = small_rig(parameters);
    begin(*rig);
    EXPECT_TRUE(rig->projector().show(StoredPattern{1}, rig->now()));
    run_for(*rig, milliseconds(100));
    return (*rig->projector().presented())->vblank;
  };
  EXPECT_EQ(vblank(with(fault("projector", "late"))), vblank(small_parameters()) + 1) << "and it is said";
}

TEST(InterlockFaults, open_the_loop_for_as_long_as_they_say) {
  const auto rig = small_rig(with(fault("interlock", "open", 0.01)));
  const auto closed_at = [&](int ms) {
    rig->advance_to(RigTime(milliseconds(ms)));
    return rig->interlock().state()->closed;
  };
  EXPECT_TRUE(closed_at(99));
  EXPECT_FALSE(closed_at(101));
  EXPECT_FALSE(closed_at(109));
  EXPECT_TRUE(closed_at(111));
}

TEST(InterlockFaults, cut_the_light_on_the_instant_between_ticks) {
  const auto rig = small_rig();
  begin(*rig);
  const RigTime tripped = rig->now() + std::chrono::nanoseconds(123'456);
  rig->advance_to(tripped);
  rig->interlock().trip();
  run_for(*rig, milliseconds(5));
  const auto spans = rig->light_between(tripped - milliseconds(1), rig->now());
  ASSERT_FALSE(spans.empty());
  EXPECT_EQ(spans.back().end, tripped);
}

TEST(InterlockFaults, open_the_loop_when_the_watchdog_starves) {
  RigParameters parameters = small_parameters();
  parameters.interlock.watchdog = milliseconds(100);
  const auto rig = small_rig(parameters);
  run_for(*rig, milliseconds(90));
  ASSERT_TRUE(rig->interlock().feed());
  run_for(*rig, milliseconds(99));
  EXPECT_TRUE(rig->interlock().state()->closed);
  run_for(*rig, milliseconds(2));
  EXPECT_FALSE(rig->interlock().state()->closed);
  EXPECT_EQ(rig->interlock().state()->since, RigTime(milliseconds(190)));
  EXPECT_FALSE(rig->interlock().feed());
  ASSERT_TRUE(rig->interlock().reset());
  EXPECT_TRUE(rig->interlock().state()->closed);
}

TEST(StoreFaults, leave_old_or_new_bytes_whichever_write_loses_power) {
  const std::vector<std::uint8_t> before{1, 2, 3};
  const std::vector<std::uint8_t> after(3 * 4'096, 7);
  bool finished = false;
  for (std::uint64_t nth = 1; !finished; ++nth) {
    ASSERT_LT(nth, 10U);
    const auto rig = small_rig();
    MockStore& store = rig->store();
    ASSERT_TRUE(store.put("slot-a", before));
    store.cut_power_at(nth);
    finished = store.put("slot-a", after).has_value();
    EXPECT_EQ(store.has_power(), finished);
    store.power_on();
    EXPECT_EQ(*store.get("slot-a"), finished ? after : before);
  }
}

TEST(ClockFaults, step_only_the_wall_clock) {
  const auto rig = small_rig(with(fault("clock", "step", -86'400)));
  run_for(*rig, milliseconds(200));
  EXPECT_EQ(rig->now(), RigTime(milliseconds(200)));
  EXPECT_EQ(rig->clock().wall_offset(), -std::chrono::hours(24));
}

TEST(MockRig, gives_the_same_bytes_with_the_same_seed_ticks_and_threads_aside) {
  const auto bytes = [](std::uint64_t seed, int threads, std::chrono::nanoseconds tick) {
    RigParameters parameters = small_parameters();
    parameters.seed = seed;
    parameters.cameras.threads = threads;
    parameters.tick = tick;
    const auto rig = small_rig(parameters);
    begin(*rig);
    const auto pairs = shoot(*rig, 2);
    const auto& pixels = std::get<Image<std::uint8_t>>(pairs.at(1).right->pixels);
    return std::pair(std::vector(pixels.data(), pixels.data() + pixels.size()), pairs[1].right->stamp);
  };
  const auto once = bytes(1, 1, std::chrono::microseconds(100));
  EXPECT_EQ(once, bytes(1, 1, std::chrono::microseconds(100)));
  EXPECT_EQ(once, bytes(1, 2, std::chrono::microseconds(100)));
  EXPECT_EQ(once, bytes(1, 1, std::chrono::microseconds(250)));
  EXPECT_NE(once, bytes(2, 1, std::chrono::microseconds(100)));
}

}  // namespace
}  // namespace raysteer::hal::mock
