// What hal/blob_store.hpp promises, for every back end.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using Bytes = std::vector<std::uint8_t>;

class BlobStoreContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, BlobStoreContract, testing::ValuesIn(back_ends()), name_of);

const Bytes kOld{1, 2, 3};
const Bytes kNew{9, 8, 7, 6};

/// Trouble begins after 10 ms, so that something can be stored before.
mock::Fault later(const char* what) {
  return {.device = "store", .what = what, .from = RigTime(std::chrono::milliseconds(10))};
}

TEST_P(BlobStoreContract, is_empty_at_first) {
  const auto rig = bench();
  EXPECT_TRUE(rig->rig().store.list()->empty());
  EXPECT_REFUSED(rig->rig().store.get("slot-a"), RCode::kBlobMissing);
}

TEST_P(BlobStoreContract, gives_back_what_was_put_last) {
  const auto rig = bench();
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("slot-a", kOld));
  ASSERT_OK(store.put("empty", {}));
  ASSERT_OK(store.put("slot-a", kNew));
  EXPECT_EQ(*store.get("slot-a"), kNew);
  EXPECT_TRUE(store.get("empty")->empty());
  EXPECT_EQ(*store.list(), (std::vector<std::string>{"empty", "slot-a"}));
}

TEST_P(BlobStoreContract, erases_harmlessly) {
  const auto rig = bench();
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("a", kOld));
  ASSERT_OK(store.erase("a"));
  ASSERT_OK(store.erase("a"));
  EXPECT_REFUSED(store.get("a"), RCode::kBlobMissing);
}

TEST_P(BlobStoreContract, refuses_names_that_are_none) {
  const auto rig = bench();
  BlobStore& store = rig->rig().store;
  for (const std::string& name : {std::string(), std::string(".hidden"), std::string("../up"), std::string("Upper"),
                                  std::string("a b"), std::string("nul\0", 4), std::string(65, 'a')}) {
    EXPECT_REFUSED(store.put(name, kOld), RCode::kBadValue);
    EXPECT_REFUSED(store.get(name), RCode::kBadValue);
    EXPECT_REFUSED(store.erase(name), RCode::kBadValue);
  }
  EXPECT_OK(store.put(std::string(64, 'a'), kOld));
  EXPECT_OK(store.put("0.9_z-", kOld));
}

TEST_P(BlobStoreContract, says_when_it_is_full_and_keeps_the_old_bytes) {
  const auto rig = bench();
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("slot-a", kOld));
  const Bytes large(static_cast<std::size_t>(*store.free_bytes()) + 1);
  EXPECT_REFUSED(store.put("slot-a", large), RCode::kDiskFull);
  EXPECT_EQ(*store.get("slot-a"), kOld);
}

TEST_P(BlobStoreContract, takes_as_many_bytes_as_it_says_are_free) {
  const auto rig = bench();
  BlobStore& store = rig->rig().store;
  const Bytes large(static_cast<std::size_t>(*store.free_bytes()));
  EXPECT_OK(store.put("all", large));
  EXPECT_LT(*store.free_bytes(), large.size());
}

TEST_P(BlobStoreContract, says_when_it_is_read_only_and_still_reads) {
  const auto rig = bench({later("read-only")});
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("slot-a", kOld));
  rig->run(std::chrono::milliseconds(20));
  EXPECT_REFUSED(store.put("slot-a", kNew), RCode::kStoreReadOnly);
  EXPECT_REFUSED(store.erase("slot-a"), RCode::kStoreReadOnly);
  EXPECT_EQ(*store.get("slot-a"), kOld);
}

TEST_P(BlobStoreContract, says_when_a_write_fails_and_keeps_the_old_bytes) {
  mock::Fault twice = later("io-error");
  twice.times = 2;
  const auto rig = bench({twice});
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("slot-a", kOld));
  rig->run(std::chrono::milliseconds(20));
  EXPECT_REFUSED(store.put("slot-a", kNew), RCode::kWriteFailed);
  EXPECT_REFUSED(store.erase("slot-a"), RCode::kWriteFailed);
  EXPECT_EQ(*store.get("slot-a"), kOld);
}

TEST_P(BlobStoreContract, never_passes_rotten_bytes_on) {
  const auto rig = bench({later("rot")});
  BlobStore& store = rig->rig().store;
  ASSERT_OK(store.put("slot-a", kOld));
  rig->run(std::chrono::milliseconds(20));
  EXPECT_REFUSED(store.get("slot-a"), RCode::kDataLoss);
  ASSERT_OK(store.put("slot-a", kNew));
  EXPECT_EQ(*store.get("slot-a"), kNew);
}

TEST_P(BlobStoreContract, says_when_the_medium_does_not_answer) {
  const auto rig = bench({{.device = "store", .what = "unplug"}});
  BlobStore& store = rig->rig().store;
  EXPECT_REFUSED(store.put("a", kOld), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(store.get("a"), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(store.erase("a"), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(store.list(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(store.free_bytes(), RCode::kDeviceUnavailable);
}

class SpyStore final : public BlobStore {
 public:
  int calls = 0;

 private:
  Status do_put(std::string_view, std::span<const std::uint8_t>) override { return ++calls, ok(); }
  Result<Bytes> do_get(std::string_view) override { return ++calls, Bytes(); }
  Status do_erase(std::string_view) override { return ++calls, ok(); }
  Result<std::vector<std::string>> do_list() override { return std::vector<std::string>(); }
  Result<std::uint64_t> do_free_bytes() override { return std::uint64_t{0}; }
};

TEST(BlobStoreHalf, lets_no_bad_name_reach_a_back_end) {
  SpyStore spy;
  EXPECT_FALSE(spy.put("../up", kOld));
  EXPECT_FALSE(spy.get("/etc"));
  EXPECT_FALSE(spy.erase(""));
  EXPECT_EQ(spy.calls, 0);
}

}  // namespace
}  // namespace raysteer::hal
