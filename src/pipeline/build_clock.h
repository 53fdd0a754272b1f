#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/build_case.h"

namespace clipgs {

/// Seconds that a build takes on two cores to trace its pictures, and to train and refine, as they
/// were measured.
struct ExpectedSeconds {
  double dataset = 0;
  double loading = 0;   ///< of the pictures, before training
  double training = 0;  ///< of the papers' way the neural model
  double refining = 0;  ///< of the papers' way alone
};
ExpectedSeconds expected_seconds(const BuildOptions& options);

/// How long a build will still take. What its pieces took up to now tells how fast this machine is;
/// how long they take beside each other was measured. Safe to use from several threads.
class BuildClock {
 public:
  explicit BuildClock(const BuildOptions& options);

  /// As a Progress::Watcher; `now`: seconds of any steady clock. Labels of other work are passed
  /// over.
  void update(const std::string& label, double share, double now);
  /// Seconds until the build is done; nothing before there is anything to tell by.
  std::optional<double> left(double now) const;

 private:
  struct Piece {
    std::string label;
    double expected;  ///< seconds on the machine that it was measured on
    double done = 0;  ///< share
    bool begun = false;
  };

  mutable std::mutex mutex_;
  std::vector<Piece> pieces_;  // in their order
  double worked_ = 0;          // of `expected`, since the first update
  double began_ = -1;
  double updated_ = 0;
  std::optional<double> left_;  // when it was updated
};

}  // namespace clipgs
