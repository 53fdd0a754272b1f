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
  vec3 forward;  // unit, RAS: what is seen in the picture's middle lies there
  mat3 indexFromDirection;
  vec3 spacing;     // mm
  float step;       // mm: where there may be matter
  float firstStep;  // mm, that optical depths of materials are told by
};

// Part of a ray, mm from the eye, and the slope at which it is entered, of which is kept what lies at
// height + t·rise >= 0.
vec3 keep(vec3 span, float height, float rise) {
  if (rise > 0.0) {
    float enter = -height / rise;
    return enter > span.x ? vec3(enter, span.y, rise) : span;
  }
  if (rise < 0.0) {
    return vec3(span.x, min(span.y, -height / rise), span.z);
  }
  return height < 0.0 ? span.xxz : span;
}

// The part of a ray that planes and the volume's box leave.
vec3 keptSpan(vec3 direction, vec3 stride, Outline o, vec3 size, vec4 planes[kMaxPlanes], int planeCount) {
  vec3 span = vec3(0.0, 1e30, 0.0);
  for (int i = 0; i < planeCount; ++i) {
    span = keep(span, dot(planes[i].xyz, o.eye) - planes[i].w, dot(planes[i].xyz, direction));
  }
  for (int k = 0; k < 3; ++k) {
    float mm = o.spacing[k];
    span = keep(span, mm * o.origin[k], mm * stride[k]);
    span = keep(span, mm * (size[k] - 1.0 - o.origin[k]), -mm * stride[k]);
  }
  return span;
}

// Of a place in the picture, 0…1 from its top left.
vec3 directionThrough(vec2 at, Outline o) { return normalize(o.corner + at.x * o.right + at.y * o.down); }

// How much of the light along a ray matter takes. `values`: of photographs, their colours.
float matterAlong(vec3 direction, Outline o, highp sampler3D values, sampler3D blocks, sampler2D materials,
                  vec4 planes[kMaxPlanes], int planeCount) {
  vec3 stride = o.indexFromDirection * direction;
  vec3 size = vec3(textureSize(values, 0));
  vec3 span = keptSpan(direction, stride, o, size, planes, planeCount);
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
    sum += matterAlong(directionThrough(at, o), o, values, blocks, materials, planes, planeCount);
  }
  return sum / float(rays);
}
