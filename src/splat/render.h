#pragma once

#include <string>

#include "core/camera.h"
#include "core/cut.h"
#include "core/depth_cue.h"
#include "core/image.h"
#include "splat/face_gain.h"
#include "splat/gaussians.h"
#include "splat/layer_switch.h"

namespace clipgs {

/// The clip operators of method.md §3; `kLayers` is for scenes with layers, and not trained with.
enum class ClipOperator { kHard, kSoft, kExact, kLayers };

ClipOperator parse_clip_operator(const std::string& name);  ///< throws Error listing the names
const char* clip_operator_name(ClipOperator clip);

/// A picture of the scene: RGBA, display sRGB, straight alpha, in [0, 1].
/// `front`: what the Gaussians lie behind, of the same size, premultiplied display sRGB and alpha;
/// null: nothing. `gain`: of the splats at a face. `layers`: as the cut switches them, for kLayers.
/// `cue`: splats that are far away fade to black, and cover as much as ever.
Image render(const Gaussians& gaussians, const Camera& camera, const Cut& cut, ClipOperator clip,
             const Image* front = nullptr, const FaceGain& gain = {},
             const LayerSwitch& layers = {}, const DepthCue& cue = {});

/// The same from the slow double-precision reference that the fast rasteriser is held to.
Image render_reference(const Gaussians& gaussians, const Camera& camera, const Cut& cut,
                       ClipOperator clip, const Image* front = nullptr, const FaceGain& gain = {},
                       const LayerSwitch& layers = {}, const DepthCue& cue = {});

}  // namespace clipgs
