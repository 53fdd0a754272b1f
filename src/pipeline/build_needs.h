#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/build_case.h"

#include "volume/volume_size.h"

namespace clipgs {

/// What one step of a build takes: memory at most, as far as headers tell, and usual time.
struct StepNeeds {
  const char* step;          ///< "dataset", "train", "refine", "pack" or "eval", as the commands
  std::uint64_t memory = 0;  ///< bytes
  double seconds = 0;        ///< on two cores
};

/// What a build of such a volume takes, step by step, and the measuring of its case after that. A
/// build in one takes the most of their memory, and the sum of their times.
std::vector<StepNeeds> build_needs(const VolumeSize& size, const BuildOptions& options);

/// The same of a build of an instant case, which has but one step, "build".
std::vector<StepNeeds> instant_needs(const VolumeSize& size, const SectionChoice& section,
                                     bool upsample);

}  // namespace clipgs
