#pragma once

#include <string>

#include "asset/case.h"
#include "core/cut.h"
#include "core/depth_cue.h"
#include "section/faces.h"
#include "splat/render.h"

namespace clipgs {

/// What draws the faces that a plane exposes.
enum class FaceSource { kVolume, kSplats };

FaceSource parse_face_source(const std::string& name);  ///< throws Error listing the names
const char* face_source_name(FaceSource source);

/// How a case is drawn.
struct DrawOptions {
  ClipOperator clip = ClipOperator::kExact;
  FaceSource faces = FaceSource::kVolume;  ///< splats where the case has no section
  FaceStyle style = {};
  DepthCue cue = {};       ///< what is far away becomes transparent
  bool body = true;        ///< without it faces of a cut from the volume stand alone
  bool reference = false;  ///< by the slow double-precision renderers (style: cinematic)
};

/// Whether the case can be drawn with the cut. A model: it is empty, or one plane that keeps the
/// side that the model keeps. Layers: the scene has some, and the cut switches them
/// (switches_layers). Scenes can draw any by the other operators.
bool can_draw(const Case& contents, const Cut& cut, ClipOperator clip);

/// Whether draw_case() shows the surface of a case's section in the splats' colours, and no splats
/// in front of it; see prepare_openings().
bool draws_surface(const Case& contents);

/// A picture of the case: RGBA, display sRGB, straight alpha, in [0, 1]. A model truncates and
/// adjusts as it has learnt to, whatever the operator; throws Error for a cut that it cannot draw.
Image draw_case(const Case& contents, const Camera& camera, const Cut& cut,
                const DrawOptions& options = {});

/// A picture of the whole case for a list of cases: 256 × 256, RGBA, straight alpha.
Image make_thumbnail(const Case& contents);

}  // namespace clipgs
