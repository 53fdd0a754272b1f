// Where matter ends in a picture: the twin of Outline in src/section/outline.h. The including program defines what
// face.glsl wants.

#include "face.glsl"

const float kLeastBeyond = 1e-3;  // of a face: less has no colour of its own
const float kOpaqueDepth = 5.545;  // optical: what goes through is less than 1/256
const int kOutlineSteps = 512;  // leaps included: no ray needs as many

struct Outline {
  vec3 eye;        // RAS mm
  vec3 origin;     // the same, index
  vec3 corner;     // RAS: through (x, y), 0…1 from the picture's top left, a ray goes along corner + x·right + y·down
  vec3 right;
  vec3 down;
  mat3 indexFromDirection;
  float step;       // mm: where there may be matter
  float firstStep;  // mm, that optical depths of materials are told by
};

// Part of a ray, mm from the eye, of which is kept what lies at distance + t·slope >= 0.
vec2 keptSpan(vec2 span, float distance, float slope) {
  if (slope > 0.0) {
    return vec2(max(span.x, -distance / slope), span.y);
  }
  if (slope < 0.0) {
    return vec2(span.x, min(span.y, -distance / slope));
  }
  return distance < 0.0 ? vec2(span.x) : span;
}

// How much of the light along a ray matter takes. `values`: of photographs, their colours.
float matterAlong(vec3 direction, Outline o, highp sampler3D values, sampler3D blocks, sampler2D materials,
                  vec4 planes[kMaxPlanes], int planeCount) {
  vec3 stride = o.indexFromDirection * direction;
  vec3 size = vec3(textureSize(values, 0));
  vec2 span = vec2(0.0, 1e30);
  for (int i = 0; i < planeCount; ++i) {
    span = keptSpan(span, dot(planes[i].xyz, o.eye) - planes[i].w, dot(planes[i].xyz, direction));
  }
  for (int k = 0; k < 3; ++k) {
    span = keptSpan(span, o.origin[k], stride[k]);
    span = keptSpan(span, size[k] - 1.0 - o.origin[k], -stride[k]);
  }
  // Leaps by whole steps: what is sampled does not depend on how they round.
  float depth = 0.0;  // optical
  float steps = 0.0;
  for (int i = 0; i < kOutlineSteps; ++i) {
    float begin = span.x + steps * o.step;
    if (begin >= span.y) {
      break;
    }
    float len = min(o.step, span.y - begin);
    vec3 at = o.origin + (begin + 0.5 * len) * stride;
    float leap = leapAt(at, stride, blocks);
    if (leap > 0.0) {
      steps += ceil(leap / o.step);
      continue;
    }
    vec4 voxel = texture(values, (at + 0.5) / size);
    depth += len / o.firstStep * texture(materials, vec2(materialColumn(valueOf(voxel)), kSurfaceRow)).a;
    if (depth > kOpaqueDepth) {
      return 1.0;
    }
    ++steps;
  }
  return 1.0 - exp(-depth);
}

// How much the section has to say where splats cover so much of a pixel: Outline::share(), whose ramps begin and end
// at `ramps`.
float outlineShare(float alpha, vec4 ramps) {
  return clamp((alpha - ramps.x) / (ramps.y - ramps.x), 0.0, 1.0) *
         clamp((ramps.w - alpha) / (ramps.w - ramps.z), 0.0, 1.0);
}

// Of a pixel from the top left of a picture.
float matterOf(vec2 pixel, vec2 texelsPerPixel, int rays, Outline o, highp sampler3D values, sampler3D blocks,
               sampler2D materials, vec4 planes[kMaxPlanes], int planeCount) {
  float sum = 0.0;
  for (int i = 0; i < rays; ++i) {
    vec2 at = (pixel + placeInPixel(i, rays)) * texelsPerPixel;
    vec3 direction = normalize(o.corner + at.x * o.right + at.y * o.down);
    sum += matterAlong(direction, o, values, blocks, materials, planes, planeCount);
  }
  return sum / float(rays);
}
