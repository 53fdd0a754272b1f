#include "train/training_claim.h"

#include "core/json_reader.h"

namespace clipgs {
namespace {

// Raised whenever the same pictures and settings give another scene.
constexpr int kRevision = 5;

// Structured bindings name every setting: whoever adds one finds that nothing compiles here.

Claim claim_of(const UniaxialOptions& options) {
  const auto& [truncation, adjust, adjustment, coarse_share] = options;
  const auto& [position_octaves, plane_octaves, width, hidden_layers, window, shape] = adjustment;
  return {{"truncation", static_cast<int>(truncation)},
          {"adjustment", adjust},
          {"adjustment's_encoding", {position_octaves, plane_octaves}},
          {"adjustment's_layers", {width, hidden_layers}},
          {"window", json_number(window)},
          {"adjustment's_inputs", shape ? "shape" : "position"},
          {"adjustment's_start", json_number(coarse_share)}};
}

}  // namespace

Claim claim_of(const TrainOptions& options) {
  const auto& [budget, start, steps, sh_degree, seed, clip, loss, mean_rate, gain_rate, rate_decay,
               coarse_share, overdraw_penalty, least_pixels, relocate_every, relocate_until,
               idle_steps, uniaxial] = options;
  const auto& [dssim, alpha] = loss;
  Claim claim = claim_of_step("training", kRevision);
  claim.update({{"budget", budget},
                {"number_at_the_start", start},
                {"steps", steps},
                {"SH_degree", sh_degree},
                {"seed", seed},
                {"clip_operator", static_cast<int>(clip)},
                {"loss", {json_number(dssim), json_number(alpha)}},
                {"rate_of_means", json_number(mean_rate)},
                {"rate_of_the_gain", json_number(gain_rate)},
                {"rates'_decay", json_number(rate_decay)},
                {"share_of_coarse_steps", json_number(coarse_share)},
                {"overdraw_penalty", json_number(overdraw_penalty)},
                {"least_pixels", json_number(least_pixels)},
                {"relocation", {relocate_every, json_number(relocate_until)}},
                {"idle_steps", idle_steps},
                {"model", uniaxial ? "clipgs" : "explicit"}});
  if (uniaxial) {
    claim.update(claim_of(*uniaxial));
  }
  return claim;
}

}  // namespace clipgs
