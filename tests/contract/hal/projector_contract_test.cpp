// What hal/projector.hpp promises, for every back end.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::milliseconds;

class ProjectorContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, ProjectorContract, testing::ValuesIn(back_ends()), name_of);

Image<std::uint8_t> content(const Projector& projector) {
  return Image<std::uint8_t>(projector.panel().width, projector.panel().height);
}

TEST_P(ProjectorContract, is_dark_and_empty_at_first) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  EXPECT_FALSE(projector.light_is_on());
  EXPECT_EQ(projector.loaded().frames(), 0);
  EXPECT_FALSE(projector.presented()->has_value());
}

TEST_P(ProjectorContract, shows_from_the_first_vblank_at_or_after_the_instant) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.load(six_patterns()));
  const RigTime at = rig->now() + milliseconds(40);
  ASSERT_OK(projector.show(StoredPattern{3}, at));
  rig->run(milliseconds(39));
  EXPECT_FALSE(projector.presented()->has_value());
  rig->run(milliseconds(40));
  const auto presented = *projector.presented();
  ASSERT_TRUE(presented);
  EXPECT_EQ(presented->what, Shown(StoredPattern{3}));
  EXPECT_GE(presented->stamp, at);
  EXPECT_LT(presented->stamp, at + projector.panel().frame_period);
}

TEST_P(ProjectorContract, counts_vblanks_a_frame_period_apart) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.load(six_patterns()));
  ASSERT_OK(projector.show(StoredPattern{0}, rig->now()));
  rig->run(milliseconds(50));
  const auto first = **projector.presented();
  ASSERT_OK(projector.show(Dark{}, rig->now()));
  rig->run(milliseconds(50));
  const auto second = **projector.presented();
  ASSERT_GT(second.vblank, first.vblank);
  EXPECT_EQ(second.stamp - first.stamp,
            static_cast<int>(second.vblank - first.vblank) * projector.panel().frame_period);
}

TEST_P(ProjectorContract, replaces_what_is_waiting) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.load(six_patterns()));
  ASSERT_OK(projector.show(StoredPattern{1}, rig->now() + milliseconds(20)));
  ASSERT_OK(projector.show(StoredPattern{2}, rig->now() + milliseconds(20)));
  rig->run(milliseconds(60));
  EXPECT_EQ((*projector.presented())->what, Shown(StoredPattern{2}));
}

TEST_P(ProjectorContract, shows_content_once_it_is_stored) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  EXPECT_REFUSED(projector.show(ContentFrame{7}, rig->now()), RCode::kNothingStored);
  ASSERT_OK(projector.store(7, content(projector).view()));
  ASSERT_OK(projector.show(ContentFrame{7}, rig->now()));
  rig->run(milliseconds(40));
  EXPECT_EQ((*projector.presented())->what, Shown(ContentFrame{7}));
}

TEST_P(ProjectorContract, refuses_to_show_what_is_not_stored) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  EXPECT_REFUSED(projector.show(StoredPattern{0}, rig->now()), RCode::kNothingStored);
  ASSERT_OK(projector.load(six_patterns()));
  for (const int index : {-1, 6, 1'000'000}) {
    EXPECT_REFUSED(projector.show(StoredPattern{index}, rig->now()), RCode::kNothingStored);
  }
  for (const int number : {-1, 0, 256}) {
    EXPECT_REFUSED(projector.show(ContentFrame{number}, rig->now()), RCode::kNothingStored);
  }
}

TEST_P(ProjectorContract, refuses_to_show_in_the_past_and_says_how_late) {
  const auto rig = bench();
  rig->run(milliseconds(10));
  const Status late = rig->rig().projector.show(Dark{}, rig->now() - milliseconds(2));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().rcode, RCode::kTooLate);
  EXPECT_EQ(late.error().detail, 2'000'000);
}

TEST_P(ProjectorContract, refuses_a_sequence_for_another_panel_or_none_at_all) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.load(six_patterns()));
  PatternSequence wrong = six_patterns();
  wrong.panel_width += 1;
  EXPECT_REFUSED(projector.load(wrong), RCode::kPanelSize);
  wrong = six_patterns();
  wrong.blocks[2].steps = 1;
  EXPECT_REFUSED(projector.load(wrong), RCode::kBadSequence);
  EXPECT_EQ(projector.loaded(), six_patterns());
}

TEST_P(ProjectorContract, refuses_content_of_another_size_or_number) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  const Image<std::uint8_t> small(3, 3);
  EXPECT_REFUSED(projector.store(0, small.view()), RCode::kPanelSize);
  EXPECT_REFUSED(projector.store(-1, content(projector).view()), RCode::kBadValue);
  EXPECT_REFUSED(projector.store(256, content(projector).view()), RCode::kBadValue);
}

TEST_P(ProjectorContract, says_when_its_memory_is_full_and_keeps_what_it_has) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.load(six_patterns()));
  Status status = ok();
  int stored = 0;
  for (; status && stored < 256; ++stored) {
    status = projector.store(stored, content(projector).view());
  }
  ASSERT_LT(stored, 256) << "this back end's memory holds all numbers there are";
  EXPECT_EQ(status.error().rcode, RCode::kDeviceFull);
  EXPECT_OK(projector.store(0, content(projector).view()));  // replacing needs no room
  PatternSequence more = six_patterns();
  more.blocks[2].steps = 60;
  EXPECT_REFUSED(projector.load(more), RCode::kDeviceFull);
  EXPECT_EQ(projector.loaded(), six_patterns());
  EXPECT_OK(projector.show(StoredPattern{5}, rig->now()));
}

TEST_P(ProjectorContract, gives_light_only_while_the_interlock_is_closed) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  rig->open_switch(true);
  EXPECT_REFUSED(projector.light(true), RCode::kInterlockOpen);
  EXPECT_FALSE(projector.light_is_on());
  rig->open_switch(false);
  ASSERT_OK(projector.light(true));
  EXPECT_TRUE(projector.light_is_on());
  ASSERT_OK(projector.light(false));
  EXPECT_FALSE(projector.light_is_on());
}

TEST_P(ProjectorContract, stays_dark_after_the_interlock_opened_until_asked_again) {
  const auto rig = bench();
  Projector& projector = rig->rig().projector;
  ASSERT_OK(projector.light(true));
  rig->run(milliseconds(5));
  rig->open_switch(true);
  rig->run(milliseconds(5));
  rig->open_switch(false);  // nobody looked while it was open
  rig->run(milliseconds(5));
  EXPECT_FALSE(projector.light_is_on());
  ASSERT_OK(projector.light(true));
  EXPECT_TRUE(projector.light_is_on());
}

TEST_P(ProjectorContract, takes_an_interlock_that_cannot_be_read_for_open) {
  const auto rig = bench({{.device = "interlock", .what = "unplug"}});
  EXPECT_REFUSED(rig->rig().projector.light(true), RCode::kInterlockOpen);
  EXPECT_FALSE(rig->rig().projector.light_is_on());
}

TEST_P(ProjectorContract, says_when_the_device_does_not_answer) {
  const auto rig = bench({{.device = "projector", .what = "unplug"}});
  Projector& projector = rig->rig().projector;
  EXPECT_REFUSED(projector.light(true), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(projector.light(false), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(projector.load(six_patterns()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(projector.store(0, content(projector).view()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(projector.show(Dark{}, rig->now()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(projector.presented(), RCode::kDeviceUnavailable);
  EXPECT_FALSE(projector.light_is_on());
  EXPECT_EQ(projector.loaded().frames(), 0);
}

class SpyProjector final : public Projector {
 public:
  using Projector::Projector;
  int calls = 0;
  bool busy = false;
  std::vector<bool> light_calls;

 private:
  bool playing() const override { return busy; }
  Status do_light(bool on) override {
    light_calls.push_back(on);
    return ok();
  }
  Status do_load(const PatternSequence&) override { return ++calls, ok(); }
  Status do_store(int, ImageView<const std::uint8_t>) override { return ++calls, ok(); }
  Status do_show(Shown, RigTime) override { return ++calls, ok(); }
  Result<std::optional<Presented>> do_presented() override { return std::optional<Presented>(); }
};

TEST_P(ProjectorContract, lets_no_unsafe_request_reach_a_back_end) {
  const auto rig = bench();
  rig->run(milliseconds(1));
  SpyProjector spy(rig->rig().clock, rig->rig().interlock, rig->rig().projector.panel());
  rig->open_switch(true);
  EXPECT_FALSE(spy.light(true));
  EXPECT_TRUE(spy.light_calls.empty());
  EXPECT_FALSE(spy.show(StoredPattern{0}, rig->now()));
  EXPECT_FALSE(spy.show(Dark{}, rig->now() - kEarlier));
  const Image<std::uint8_t> small(3, 3);
  EXPECT_FALSE(spy.store(0, small.view()));
  EXPECT_FALSE(spy.load(PatternSequence{}));
  EXPECT_EQ(spy.calls, 0);
  EXPECT_TRUE(spy.light(false));  // off always reaches it
  EXPECT_EQ(spy.light_calls, std::vector{false});
}

TEST_P(ProjectorContract, switches_the_device_off_when_it_finds_the_interlock_open) {
  const auto rig = bench();
  SpyProjector spy(rig->rig().clock, rig->rig().interlock, rig->rig().projector.panel());
  ASSERT_OK(spy.light(true));
  rig->rig().interlock.trip();
  EXPECT_FALSE(spy.light_is_on());
  EXPECT_EQ(spy.light_calls, (std::vector{true, false}));
}

TEST_P(ProjectorContract, refuses_to_show_or_load_while_a_sequence_plays) {
  const auto rig = bench();
  SpyProjector spy(rig->rig().clock, rig->rig().interlock, rig->rig().projector.panel());
  spy.busy = true;
  EXPECT_REFUSED(spy.show(Dark{}, rig->now()), RCode::kProjectorBusy);
  EXPECT_REFUSED(spy.load(six_patterns()), RCode::kProjectorBusy);
  EXPECT_EQ(spy.calls, 0);
}

}  // namespace
}  // namespace raysteer::hal
