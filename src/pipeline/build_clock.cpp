#include "pipeline/build_clock.h"

#include <algorithm>

namespace clipgs {

namespace {

// Seconds on 2 cores of an AMD EPYC, of pictures of heads, chests and abdomens.
constexpr double kPerSample = 0.35e-6;
constexpr double kPerPicture = 0.01;
constexpr double kPerPixelLoaded = 0.3e-6;
constexpr double kPerPixelLearnt = 0.7e-6;
// Less of what was expected tells nothing yet of how fast a machine is.
constexpr double kEnough = 3;

}  // namespace

ExpectedSeconds expected_seconds(const BuildOptions& options) {
  const DatasetOptions& pictures = options.pictures;
  const double pixels = static_cast<double>(pictures.size) * pictures.size;
  const double frames = pictures.train_frames;
  const double learning = static_cast<double>(options.training.steps) * kPerPixelLearnt * pixels;
  ExpectedSeconds expected;
  expected.dataset = frames * (kPerPicture + kPerSample * pixels * pictures.train_spp);
  expected.loading = frames * kPerPixelLoaded * pixels;
  expected.training = options.papers_way ? 0.5 * learning : learning;
  expected.refining = learning - expected.training;
  return expected;
}

BuildClock::BuildClock(const BuildOptions& options) {
  const ExpectedSeconds expected = expected_seconds(options);
  pieces_ = {{"dataset", expected.dataset},
             {"loading", expected.loading},
             {"training", expected.training}};
  if (options.papers_way) {
    pieces_.push_back({"refining", expected.refining});
  }
}

void BuildClock::update(const std::string& label, double share, double now) {
  const std::scoped_lock lock(mutex_);
  const auto current = std::ranges::find(pieces_, label, &Piece::label);
  if (current == pieces_.end()) {
    return;
  }
  if (began_ < 0) {
    began_ = now;
  }
  // Pieces that were there already, and what of one was, took no time now.
  std::for_each(pieces_.begin(), current, [](Piece& piece) { piece.done = 1; });
  if (current->begun) {
    worked_ += std::max(0.0, share - current->done) * current->expected;
  }
  current->begun = true;
  current->done = std::max(current->done, share);
  updated_ = now;
  if (worked_ < kEnough) {
    return;
  }
  double ahead = 0;
  for (const Piece& piece : pieces_) {
    ahead += (1 - piece.done) * piece.expected;
  }
  left_ = ahead * (now - began_) / worked_;
}

std::optional<double> BuildClock::left(double now) const {
  const std::scoped_lock lock(mutex_);
  return left_ ? std::optional(std::max(0.0, *left_ - (now - updated_))) : std::nullopt;
}

}  // namespace clipgs
