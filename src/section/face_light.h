#pragma once

#include "core/geometry.h"
#include "volume/preset.h"

// The light on an exposed face. All kept matter lies behind the plane, so every point of the face
// sees the whole hemisphere, unshadowed: its light depends on the plane's normal alone, and follows
// from the light rig in closed form. web/src/model/face_light.ts is the viewer's twin.
namespace clipgs {

/// What a white Lambert face with unit `normal` (RAS, away from the kept side) radiates, linear
/// RGB: (1/π)·∫ L(ω)·max(0, n·ω) dω over the sky and the discs of the key lights.
Vec3 face_diffuse(const LightRig& rig, const Vec3& normal);

/// What the GGX lobe of such a face radiates towards unit `out` (from the face to the camera) for a
/// white specular colour, linear RGB. Discs count as points with a rougher face; the sky as its
/// radiance in the mirror's direction times the lobe's reflectance. 0 seen from below.
Vec3 face_gloss(const LightRig& rig, const Vec3& normal, const Vec3& out, float roughness);

}  // namespace clipgs
