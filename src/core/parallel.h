#pragma once

#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <future>
#endif

namespace clipgs {

/// Limits all parallel work of the process to `threads` (0: every core). Results never depend on
/// it.
void set_thread_count(int threads);
int thread_count();

/// Lets other programs, a browser say, have the cores first: this thread from now on, and the
/// threads that it starts. Call it before the first parallel work.
void give_way();

/// Calls body(begin, end) over pieces of [0, count) of at most `grain` elements, on all threads.
/// The pieces are the same at any thread count, so that a body may keep per-piece results.
template <typename Body>
void parallel_for(size_t count, size_t grain, const Body& body) {
  if (grain == 0) {
    grain = 1;
  }
  const size_t pieces = (count + grain - 1) / grain;
  const auto run = [&](size_t piece) {
    const size_t begin = piece * grain;
    body(begin, begin + grain < count ? begin + grain : count);
  };
#ifdef __SANITIZE_THREAD__
  // The thread sanitizer cannot see how the library of oneTBB synchronises; plain threads it can.
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t piece = next++; piece < pieces; piece = next++) {
      run(piece);
    }
  };
  std::future<void> helper = std::async(std::launch::async, work);
  work();
  helper.get();
#else
  tbb::parallel_for(size_t{0}, pieces, run);
#endif
}

}  // namespace clipgs
