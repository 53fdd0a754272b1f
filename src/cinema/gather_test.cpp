// Compiled once per instruction set by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cinema/gather_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands:
#include <cstring>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include "cinema/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace {

// The same index in all lanes but one.
void gather_at(const std::uint16_t* pairs, const std::uint8_t* bytes, std::int32_t index,
               std::int32_t other, std::uint32_t* pair, std::uint32_t* byte) {
  alignas(64) std::int32_t at[lanes::kMost];
  for (size_t i = 0; i < lanes::kMost; ++i) {
    at[i] = i == 1 ? other : index;
  }
  const lanes::Int indices = lanes::load(at);
  lanes::store(lanes::gather_pair(pairs, indices), pair);
  lanes::store(lanes::as_uint(lanes::gather_byte(bytes, indices)), byte);
}

size_t lane_count() { return lanes::count(); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clipgs {
namespace {

HWY_EXPORT(gather_at);
HWY_EXPORT(lane_count);

// Memory that is there only where it is written to.
class Sparse {
 public:
  explicit Sparse(size_t bytes)
      : bytes_(bytes),
        data_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)) {}
  ~Sparse() { munmap(data_, bytes_); }
  Sparse(const Sparse&) = delete;
  Sparse& operator=(const Sparse&) = delete;
  bool there() const { return data_ != MAP_FAILED; }
  std::uint8_t* data() const { return static_cast<std::uint8_t*>(data_); }

 private:
  size_t bytes_;
  void* data_;
};

TEST(Gather, ReachesBothEndsOf4GiVoxelsOnEveryInstructionSet) {
  constexpr std::int64_t kHalf = std::int64_t{1} << 31;
  const Sparse codes(static_cast<size_t>(4 * kHalf) + 64);
  const Sparse labels(static_cast<size_t>(2 * kHalf) + 64);
  ASSERT_TRUE(codes.there() && labels.there());
  auto* const pairs = reinterpret_cast<std::uint16_t*>(codes.data()) + kHalf;
  std::uint8_t* const bytes = labels.data() + kHalf;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    std::uint16_t number = 1;
    for (const std::int64_t at : {-kHalf, -kHalf + 1, -kHalf / 2 - 1, -kHalf / 2, std::int64_t{-1},
                                  std::int64_t{0}, kHalf / 2 - 1, kHalf / 2, kHalf - 1}) {
      const auto left = static_cast<std::uint16_t>(number * 7919);
      const auto right = static_cast<std::uint16_t>(number * 104729);
      std::memcpy(pairs + at, &left, sizeof left);
      std::memcpy(pairs + at + 1, &right, sizeof right);
      bytes[at] = static_cast<std::uint8_t>(200 + number);
      const std::int64_t beside = at < 0 ? at + 1000 : at - 1000;  // zeros
      alignas(64) std::uint32_t pair[16] = {};
      alignas(64) std::uint32_t byte[16] = {};
      HWY_DYNAMIC_DISPATCH(gather_at)
      (pairs, bytes, static_cast<std::int32_t>(at), static_cast<std::int32_t>(beside), pair, byte);
      const size_t count = HWY_DYNAMIC_DISPATCH(lane_count)();
      for (size_t i = 0; i < count; ++i) {
        const bool here = i != 1;
        ASSERT_EQ(pair[i], here ? left | static_cast<std::uint32_t>(right) << 16U : 0U)
            << hwy::TargetName(target) << " at " << at << ", lane " << i;
        ASSERT_EQ(byte[i], here ? bytes[at] : 0U)
            << hwy::TargetName(target) << " at " << at << ", lane " << i;
      }
      std::memset(pairs + at, 0, 2 * sizeof left);
      bytes[at] = 0;
      ++number;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace clipgs
#endif
