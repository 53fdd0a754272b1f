#include "train/truncation.h"

#include <array>
#include <utility>

#include "core/error.h"

namespace clipgs {

namespace {

constexpr std::array<std::pair<const char*, Truncation>, 3> kNames = {
    {{"none", Truncation::kNone}, {"hard", Truncation::kHard}, {"learned", Truncation::kLearned}}};

}  // namespace

Truncation parse_truncation(const std::string& name) {
  for (const auto& [known, truncation] : kNames) {
    if (name == known) {
      return truncation;
    }
  }
  throw Error("\"{}\" is no truncation; use none, hard or learned", name);
}

const char* truncation_name(Truncation truncation) {
  return kNames[static_cast<size_t>(truncation)].first;
}

}  // namespace clipgs
