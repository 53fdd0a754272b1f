#include "core/parallel.h"

#include <memory>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

namespace clipgs {

namespace {
std::unique_ptr<tbb::global_control>& limit() {
  static std::unique_ptr<tbb::global_control> control;
  return control;
}
}  // namespace

void set_thread_count(int threads) {
  limit().reset();
  if (threads > 0) {
    limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<size_t>(threads));
  }
}

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void give_way() {
  constexpr int kNiceness = 10;  // what the command nice adds: a tenth of who asks beside it
  // Of Linux's threads each has its own; one that is nicer already, or may not, stays as it is.
  [[maybe_unused]] const int niceness = ::nice(kNiceness);
}

}  // namespace clipgs
