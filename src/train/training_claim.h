#pragma once

#include "core/claim.h"
#include "train/trainer.h"

namespace clipgs {

/// All settings of a training run; not the pictures, nor what it starts from.
Claim claim_of(const TrainOptions& options);

}  // namespace clipgs
