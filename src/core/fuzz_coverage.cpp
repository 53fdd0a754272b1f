// Which way the code took, for libFuzzer: GCC calls this at every basic block that it compiles with
// -fsanitize-coverage=trace-pc, and libFuzzer looks at the counters of this section after each
// input.
#include <cstddef>
#include <cstdint>

namespace {

constexpr int kCounterBits = 16;

// No std::array: its functions would be counted themselves.
__attribute__((section("__libfuzzer_extra_counters"))) std::uint8_t
    counters[std::size_t{1} << kCounterBits];  // NOLINT(modernize-avoid-c-arrays)

}  // namespace

extern "C" __attribute__((no_sanitize("address", "undefined"), no_sanitize_coverage)) void
__sanitizer_cov_trace_pc() {
  // Fibonacci hashing: two blocks that share a counter only make the fuzzer a little blinder.
  const std::uint64_t block = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  std::uint8_t& counter = counters[(block * 0x9E3779B97F4A7C15U) >> (64 - kCounterBits)];
  if (counter < 0xFF) {
    ++counter;
  }
}
