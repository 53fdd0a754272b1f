// The first surface that rays meet, lit: the twin of src/section/surface.h. The including program defines what face.glsl
// wants.

#include "outline.glsl"

// Mean of max(0, n·ω) over a key light's disc with that sine of its radius, at a cosine; exact for a flat disc.
float discCosine(float cosine, float sine) {
  if (abs(cosine) >= sine) {
    return max(cosine, 0.0);
  }
  float u = cosine / sine;
  float root = sqrt(max(0.0, 1.0 - u * u));
  return sine * (u * (0.5 + (asin(u) + u * root) / kPi) + 2.0 / (3.0 * kPi) * root * root * root);
}

// (1/π)·∫ max(0, a·ω)·max(0, b·ω) dω over the sphere, by the cosine of the angle between a and b.
float skyOverlap(float cosine) {
  float c = clamp(cosine, -1.0, 1.0);
  float angle = acos(c);
  return 2.0 / (3.0 * kPi) * (sin(angle) + (kPi - angle) * c);
}

// What a white surface that nothing stands around radiates, linear RGB: the twin of face_diffuse() in
// src/section/face_light.h.
vec3 openLight(LightRig rig, vec3 normal) {
  vec3 sum = rig.skyHorizon + skyOverlap(normal.z) * (rig.skyTop - rig.skyHorizon) +
             skyOverlap(-normal.z) * (rig.skyBottom - rig.skyHorizon);
  for (int i = 0; i < rig.keyCount; ++i) {
    KeyLight key = rig.keys[i];
    sum += discCosine(dot(normal, key.direction), sin(2.0 * key.spread)) * key.radiance;
  }
  return sum;
}

// What a wall radiates towards the eye, linear RGB before exposure. As much of the gloss is seen as of the light that
// would fall on the wall if nothing stood around it.
vec3 wallRadiance(Wall wall, vec3 direction, LightRig rig, Openings o, highp sampler3D light) {
  vec3 white = wallLight(wall, o, light);
  vec3 sum = wall.reflectance * white;
  if (wall.specular > 0.0) {
    vec3 open = openLight(rig, wall.normal);
    float lit = dot(white, vec3(1.0)) / max(dot(open, vec3(1.0)), 1e-6);
    sum += min(lit, 1.0) * wall.specular * faceGloss(rig, wall.normal, -direction, wall.roughness);
  }
  return sum;
}

// The wall that a ray meets, with its depth from the eye: whether there is one that is not seen as a face, or through a
// gap of one. `depth`: mm below a face that count as the face.
bool meetsSurface(vec3 direction, Outline view, Openings o, float depth, highp sampler3D values, sampler3D blocks,
                  sampler2D materials, vec4 planes[kMaxPlanes], int planeCount, out Wall wall) {
  vec3 stride = view.indexFromDirection * direction;
  vec3 span = keptSpan(direction, stride, view, vec3(textureSize(values, 0)), planes, planeCount);
  FaceRay ray;
  ray.start = view.origin + span.x * stride;
  ray.stride = stride;
  ray.leave = span.y - span.x;
  if (ray.leave <= 0.0 || (planeCount > 0 && isInside(ray.start, blocks))) {
    return false;
  }
  if (!firstWall(ray, direction, 0.0, o, values, blocks, materials, wall) || wall.depth * span.z < depth) {
    return false;
  }
  wall.depth += span.x;
  return true;
}
