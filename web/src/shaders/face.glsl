// The mathematics of drawing exposed faces from a section's volume, as docs/method.md §8 writes it down. Functions
// of their arguments only, so that any GLSL program can include this text. C++ twins: FaceRays::march in
// src/section/face_rays.h, src/section/faces.cpp, src/section/openings.cpp and src/section/face_light.cpp.
//
// Positions are voxel indices, directions are RAS. The including program defines kChannels: 1 (values) or 3 (sRGB),
// and kColumns, of the table of materials.

#include "srgb.glsl"

const int kTaps = 8;
const int kMaxKeys = 8;
const int kMaxPlanes = 6;
const float kLeastTransmittance = 1.0 / 256.0;
const float kPi = 3.14159265;

// Rows of the table of materials, whose columns are evenly spread over the values.
const float kSurfaceRow = 0.125;   // reflectance at the face; optical depth of the first step
const float kInteriorRow = 0.375;  // reflectance beneath it; optical depth of the first step
const float kGlossRow = 0.625;     // specular, roughness; grey: 0 black, 1 white, beyond them outside the window
const float kBoundaryRow = 0.875;  // reflectance of walls where values are steep

// Of codes: between these, interpolation mixes the body with the air around it.
const float kLowestInside = 4.0 / 255.0;
const float kSurelyInside = 12.0 / 255.0;

struct KeyLight {
  vec3 direction;
  vec3 radiance;
  float spread;  // half the angular radius
};

struct LightRig {
  vec3 skyTop;
  vec3 skyHorizon;
  vec3 skyBottom;
  int keyCount;
  KeyLight keys[kMaxKeys];
};

// From a point of the face inwards.
struct FaceRay {
  vec3 start;
  vec3 stride;    // voxels per mm
  float slope;    // cosine of the angle to the face's normal
  float leave;    // mm to where the ray leaves the volume or what is kept
  float surface;  // mm below the face that count as the face itself
};

// Of what cuts open (src/section/openings.h).
const int kSearchSteps = 512;  // leaps included
const float kOpaqueWall = 1.0 / 32.0;
const float kWisp = 0.3;
const float kGrazing = 0.25;  // cosine: values rise into matter unless a surface faces away by more
const int kBlock = 2;
const float kAround = 128.0;

// How closely walls are looked for.
struct WallSteps {
  float search;  // mean voxels of the traced volume: steps where there may be matter,
  int halvings;  // … to its beginning, by halves,
  float fine;    // … and through it, where they grow
  float growth;
  int count;     // of fine ones, at most
};

struct Openings {
  WallSteps steps;
  float voxel;        // mm, mean of the traced volume
  float firstStep;    // mm, that optical depths of materials are told by
  vec2 steep;         // of walls (SteepRange): where it begins and 1 / its width, of values 0…1 per mm; 0, 0: none
  vec3 sourceVoxel;   // mm, of the traced volume
  vec3 spacing;       // mm, of the section
  mat3 axes;          // RAS directions of its axes
  float cell;         // mm, of the light
  ivec3 cells;
  float lightScale;   // what 1 in the texture of the light stands for; 0 until some is computed: all walls are in …
  vec3 glow;          // … this, linear RGB
  bool glossy;
};

struct Wall {
  vec3 index;
  vec3 normal;  // RAS, towards the eye, or past it at a rim
  vec3 reflectance;
  float specular;
  float roughness;
  float depth;  // mm from where its ray starts
};

// Sums over what rays see, each weighted by transmittance times opacity.
struct FaceSum {
  vec3 reflectance;
  float alpha;
  float specular;
  float roughness;  // times specular
  vec3 opened;      // linear RGB of walls, lit
  vec4 behind;      // the same of those behind grey faces, and their alpha
};

// What grey shows in gaps that the window has black (FaceStyle::Openings of src/section/faces.h).
const int kNeutralWalls = 1;
const int kGapValues = 2;
const float kGap = 0.4;  // of a ray's light that goes on: less is tissue …
const float kClearGap = 0.6;  // … and more an opening
const float kDark = 0.1;  // of the window, below black: as dark is an opening, brighter is a value
const vec3 kClay = vec3(0.16, 0.26, 0.42);  // of neutral walls, linear RGB

// Value of a sample, 0…1.
float valueOf(vec4 voxel) {
  return kChannels == 1 ? voxel.r : dot(voxel.rgb, vec3(0.2126, 0.7152, 0.0722));
}

// Value of a voxel, 0…1: that of its code.
float valueAt(ivec3 voxel, highp sampler3D voxels, highp sampler2D curve) {
  int code = int(255.0 * texelFetch(voxels, voxel, 0).r + 0.5);
  return texelFetch(curve, ivec2(code, 0), 0).r;
}

// What is at an index: a value, 0…1, or sRGB. Values are interpolated, not codes: the curve bends, and matter would
// end elsewhere than in the volume.
vec4 sampleAt(vec3 index, highp sampler3D voxels, highp sampler2D curve) {
  ivec3 size = textureSize(voxels, 0);
  if (kChannels == 3) {
    return texture(voxels, (index + 0.5) / vec3(size));
  }
  vec3 at = clamp(index, vec3(0.0), vec3(size - 1));
  ivec3 a = ivec3(at);
  ivec3 b = min(a + 1, size - 1);
  vec3 share = at - vec3(a);
  vec4 near = vec4(valueAt(a, voxels, curve), valueAt(ivec3(a.x, b.y, a.z), voxels, curve),
                   valueAt(ivec3(a.xy, b.z), voxels, curve), valueAt(ivec3(a.x, b.yz), voxels, curve));
  vec4 far = vec4(valueAt(ivec3(b.x, a.yz), voxels, curve), valueAt(ivec3(b.xy, a.z), voxels, curve),
                  valueAt(ivec3(b.x, a.y, b.z), voxels, curve), valueAt(b, voxels, curve));
  vec4 alongX = mix(near, far, share.x);
  vec2 alongY = mix(alongX.xz, alongX.yw, share.y);
  return vec4(mix(alongY.x, alongY.y, share.z), 0.0, 0.0, 1.0);
}

// Where the table of materials has a value.
float materialColumn(float value) { return (value * float(kColumns - 1) + 0.5) / float(kColumns); }

// How much of what is behind a gap is seen in grey, where `share` of a ray's light goes on at an index.
float openness(float share, vec3 index, highp sampler3D voxels, highp sampler2D curve, sampler2D materials) {
  float gap = clamp((share - kGap) / (kClearGap - kGap), 0.0, 1.0);
  if (kChannels == 3) {
    return gap;
  }
  float column = materialColumn(valueOf(sampleAt(index, voxels, curve)));
  return gap * clamp(-texture(materials, vec2(column, kGlossRow)).b / kDark, 0.0, 1.0);
}

// What a ray meets on the face in grey: premultiplied display sRGB and alpha.
vec4 greyAt(vec3 index, highp sampler3D voxels, highp sampler2D curve, sampler2D materials) {
  vec3 at = (index + 0.5) / vec3(textureSize(voxels, 0));
  vec4 voxel = texture(voxels, at);
  float code = valueOf(voxel);
  float alpha = clamp((code - kLowestInside) / (kSurelyInside - kLowestInside), 0.0, 1.0);
  float value = valueOf(sampleAt(index, voxels, curve));
  vec3 shade = vec3(clamp(texture(materials, vec2(materialColumn(value), kGlossRow)).b, 0.0, 1.0));
  return alpha * vec4(kChannels == 3 ? voxel.rgb : shade, 1.0);
}

// Where in a pixel ray i of count goes, 0…1 from its top left.
vec2 placeInPixel(int i, int count) {
  return vec2(fract(0.5 + 0.618034 * float(i)), (float(i) + 0.5) / float(count));
}

// Whether a face may be at an index.
bool isInBox(vec3 index, vec3 last) {
  const float kSlack = 1e-3;  // voxels: a side may be the face
  return all(greaterThanEqual(index, vec3(-kSlack))) && all(lessThanEqual(index, last + kSlack));
}

// Whether all planes, which keep xyz·x >= w, keep a point of one of them (RAS mm).
bool isKept(vec3 position, vec4 planes[kMaxPlanes], int count) {
  const float kSlack = 1e-3;  // mm
  bool kept = true;
  for (int i = 0; i < count; ++i) {
    kept = kept && dot(planes[i].xyz, position) - planes[i].w >= -kSlack;
  }
  return kept;
}

// How far a ray runs from inside the volume to its side, mm.
float distanceToSide(vec3 start, vec3 stride, vec3 last) {
  vec3 s = mix(stride, vec3(1e-6), lessThan(abs(stride), vec3(1e-6)));
  vec3 t = (mix(vec3(0.0), last, greaterThan(s, vec3(0.0))) - start) / s;
  return min(t.x, min(t.y, t.z));
}

// How far a ray runs from a point (RAS mm) until one of the planes, which keep xyz·x >= w, ends what is kept, mm.
float distanceToCut(vec3 position, vec3 direction, vec4 planes[kMaxPlanes], int count) {
  float nearest = 1e30;
  for (int i = 0; i < count; ++i) {
    float slope = dot(planes[i].xyz, direction);
    if (slope < 0.0) {
      nearest = min(nearest, (planes[i].w - dot(planes[i].xyz, position)) / slope);
    }
  }
  return nearest;
}

// Adds what one ray sees. `steps` are the middles of the steps (mm) and their lengths in units of the first. Returns
// how much of the light goes on into a gap, and where (mm) that begins; 0: there is none.
vec2 march(FaceRay ray, highp sampler3D voxels, highp sampler2D curve, sampler2D materials, vec2 steps[kTaps],
           bool glossy, inout FaceSum sum) {
  float transmittance = 1.0;
  vec2 gap = vec2(0.0);
  for (int i = 0; i < kTaps; ++i) {
    float depth = steps[i].x;
    if (depth > ray.leave) {
      break;
    }
    bool surface = depth * ray.slope < ray.surface;
    vec4 voxel = sampleAt(ray.start + depth * ray.stride, voxels, curve);
    float column = materialColumn(valueOf(voxel));
    vec4 material = texture(materials, vec2(column, surface ? kSurfaceRow : kInteriorRow));
    if (material.a <= 0.0 || (!surface && transmittance == 1.0)) {
      // Matter beyond a gap is another surface, with light of its own.
      gap = vec2(transmittance, depth);
      if (!surface || transmittance < 1.0) {
        break;
      }
      continue;
    }
    gap = vec2(0.0);
    float left = transmittance * exp(-material.a * steps[i].y);
    left = left < kLeastTransmittance ? 0.0 : left;  // as good as opaque: the rest is this tissue's
    float weight = transmittance - left;
    transmittance = left;
    sum.reflectance += weight * material.rgb * (kChannels == 3 ? linearFromSrgb(voxel.rgb) : vec3(1.0));
    if (glossy && surface) {
      vec2 gloss = texture(materials, vec2(column, kGlossRow)).rg;
      sum.specular += weight * gloss.x;
      sum.roughness += weight * gloss.x * gloss.y;
    }
    if (transmittance == 0.0) {
      break;
    }
  }
  sum.alpha += 1.0 - transmittance;
  return gap;
}

// How a block lies: how many blocks around it are empty and one more, 0 where there may be matter; with kAround, near
// the air around the body.
float blockAt(ivec3 block, sampler3D blocks) { return floor(255.0 * texelFetch(blocks, block, 0).r + 0.5); }

ivec3 blockOf(vec3 index, sampler3D blocks) {
  return clamp(ivec3(index) / kBlock, ivec3(0), textureSize(blocks, 0) - 1);
}

// Whether nothing around an index is air around the body: a gap there is an opening.
bool isInside(vec3 index, sampler3D blocks) { return blockAt(blockOf(index, blocks), blocks) < kAround; }

// How far (mm) a ray may go from an index without missing matter; 0 where there may be matter.
float leapAt(vec3 index, vec3 stride, sampler3D blocks) {
  const float kBeyond = 0.01;  // voxels: into the next block
  ivec3 block = blockOf(index, blocks);
  int distance = int(mod(blockAt(block, blocks), kAround));
  if (distance == 0) {
    return 0.0;
  }
  vec3 low = vec3((block - (distance - 1)) * kBlock) - kBeyond;
  vec3 high = vec3((block + distance) * kBlock) + kBeyond;
  vec3 s = mix(stride, vec3(1e-6), lessThan(abs(stride), vec3(1e-6)));
  vec3 sides = (mix(low, high, greaterThan(s, vec3(0.0))) - index) / s;
  return max(min(sides.x, min(sides.y, sides.z)), kBeyond / length(stride));
}

// Value at an index, interpolated: 0…1. `values`: a volume of them; of photographs, their colours.
float valueNear(vec3 index, highp sampler3D values) {
  return valueOf(texture(values, (index + 0.5) / vec3(textureSize(values, 0))));
}

// How values, 0…1, change around an index: per mm, RAS.
vec3 slopeAt(vec3 index, Openings o, highp sampler3D values) {
  vec3 s = o.sourceVoxel / o.spacing;
  vec3 x = vec3(s.x, 0.0, 0.0), y = vec3(0.0, s.y, 0.0), z = vec3(0.0, 0.0, s.z);
  vec3 above = vec3(valueNear(index + x, values), valueNear(index + y, values), valueNear(index + z, values));
  vec3 below = vec3(valueNear(index - x, values), valueNear(index - y, values), valueNear(index - z, values));
  return o.axes * ((above - below) / (2.0 * o.sourceVoxel));
}

bool isMatter(vec3 index, highp sampler3D values, sampler2D materials) {
  return texture(materials, vec2(materialColumn(valueNear(index, values)), kSurfaceRow)).a > 0.0;
}

// How far along a ray a step meets matter at or after `from` mm; ray.leave if none does. `left` are the steps that it
// may take.
float searchMatter(FaceRay ray, float from, Openings o, highp sampler3D values, sampler3D blocks, sampler2D materials,
                   inout int left) {
  float t = from;
  for (; left > 0 && t < ray.leave; --left) {
    vec3 at = ray.start + t * ray.stride;
    float leap = leapAt(at, ray.stride, blocks);
    if (leap == 0.0) {
      if (isMatter(at, values, materials)) {
        return t;
      }
      leap = o.steps.search * o.voxel;
    }
    t += leap;
  }
  return ray.leave;
}

// The first wall along a ray from `from` mm on: whether there is one. Rays of neighbouring pixels search and look
// closely together: what only one of them does costs as much as if all did.
bool firstWall(FaceRay ray, vec3 direction, float from, Openings o, highp sampler3D values, sampler3D blocks,
               sampler2D materials, out Wall wall) {
  vec3 sum;
  vec3 steepSum;
  vec2 gloss;  // specular, and that times roughness
  float depth;
  float alpha = 0.0;
  float t = from;
  float begin = from;  // nothing before is looked at again
  int left = kSearchSteps;
  while (alpha < kWisp) {
    t = searchMatter(ray, t, o, values, blocks, materials, left);
    if (left <= 0 || t >= ray.leave) {
      return false;
    }
    --left;
    // Matter began within the last step.
    float before = max(begin, t - o.steps.search * o.voxel);
    for (int k = 0; k < o.steps.halvings; ++k) {
      float middle = 0.5 * (before + t);
      if (isMatter(ray.start + middle * ray.stride, values, materials)) {
        t = middle;
      } else {
        before = middle;
      }
    }
    t = before;
    sum = vec3(0.0);
    steepSum = vec3(0.0);
    gloss = vec2(0.0);
    depth = 0.0;
    float transmittance = 1.0;
    float stepLength = o.steps.fine * o.voxel;
    for (int k = 0; k < o.steps.count && transmittance > kOpaqueWall; ++k) {
      vec3 middle = ray.start + (t + 0.5 * stepLength) * ray.stride;
      vec4 voxel = texture(values, (middle + 0.5) / vec3(textureSize(values, 0)));
      float column = materialColumn(valueOf(voxel));
      vec4 material = texture(materials, vec2(column, kSurfaceRow));
      if (material.a <= 0.0 && transmittance < 1.0) {
        break;  // what is seen beyond a gap is another wall
      }
      float weight = transmittance * (1.0 - exp(-material.a * stepLength / o.firstStep));
      vec3 tint = kChannels == 3 ? linearFromSrgb(voxel.rgb) : vec3(1.0);
      sum += weight * material.rgb * tint;
      if (o.steep.y > 0.0) {
        steepSum += weight * texture(materials, vec2(column, kBoundaryRow)).rgb * tint;
      }
      if (o.glossy) {
        vec2 lobe = texture(materials, vec2(column, kGlossRow)).rg;
        gloss += weight * lobe.x * vec2(1.0, lobe.y);
      }
      depth += weight * (t + 0.5 * stepLength);
      transmittance -= weight;
      t += stepLength;
      stepLength *= o.steps.growth;
    }
    alpha = 1.0 - transmittance;
    t += stepLength;
    begin = t;
  }
  wall.depth = depth / alpha;
  wall.index = ray.start + wall.depth * ray.stride;
  vec3 slope = slopeAt(wall.index, o, values);
  float steepness = length(slope);
  wall.reflectance = mix(sum, steepSum, clamp((steepness - o.steep.x) * o.steep.y, 0.0, 1.0)) / alpha;
  bool away = dot(slope, direction) < -kGrazing * steepness;
  wall.normal = steepness > 0.0 ? (away ? 1.0 : -1.0) / steepness * slope : -direction;
  wall.specular = gloss.x / alpha;
  wall.roughness = gloss.x > 0.0 ? gloss.y / gloss.x : 1.0;
  return true;
}

// Light times whether there is any, of what faces a side around a texel.
vec4 lightOfSide(vec3 texel, float side, Openings o, highp sampler3D light) {
  return texture(light, vec3(texel.xy, texel.z + side * float(o.cells.z)) / vec3(o.cells.xy, 12 * o.cells.z));
}

// What a white wall radiates, linear RGB: of cells around it, by the sides of their patches that it faces. The light
// of splats' surfaces lies above that of walls.
vec3 wallLight(Wall wall, Openings o, highp sampler3D light) {
  if (o.lightScale <= 0.0) {
    return o.glow;
  }
  vec3 n = wall.normal * o.axes;
  vec3 at = clamp(wall.index * o.spacing / o.cell, vec3(0.0), vec3(o.cells - 1)) + 0.5;
  vec4 sum = vec4(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    float side = float(2 * axis + (n[axis] < 0.0 ? 1 : 0));
    sum += n[axis] * n[axis] * lightOfSide(at, side, o, light);
  }
  if (sum.a <= 0.0) {
    // Slivers whose normals say little: the light of whatever is there.
    for (int side = 0; side < 6; ++side) {
      sum += lightOfSide(at, float(side), o, light);
    }
  }
  return sum.a > 0.0 ? o.lightScale / sum.a * sum.rgb : vec3(0.0);
}

float ggxLambda(float cosine, float alpha) {
  float c2 = cosine * cosine;
  return 0.5 * (sqrt(1.0 + alpha * alpha * max(0.0, 1.0 - c2) / max(c2, 1e-8)) - 1.0);
}

// The GGX lobe with a white specular colour: BRDF times the cosine of `towards`.
float ggx(vec3 normal, vec3 eye, vec3 towards, float alpha) {
  float cosEye = dot(normal, eye);
  float cosTowards = dot(normal, towards);
  if (cosEye <= 0.0 || cosTowards <= 0.0) {
    return 0.0;
  }
  float cosHalf = dot(normal, normalize(eye + towards));
  float a2 = alpha * alpha;
  float s = cosHalf * cosHalf * (a2 - 1.0) + 1.0;
  float masking = 1.0 / (1.0 + ggxLambda(cosEye, alpha) + ggxLambda(cosTowards, alpha));
  return a2 / (kPi * s * s) * masking / (4.0 * cosEye);
}

// What the GGX lobe of a face radiates towards unit `eye` for a white specular colour, linear RGB.
vec3 faceGloss(LightRig rig, vec3 normal, vec3 eye, float roughness) {
  float cosine = dot(normal, eye);
  if (cosine <= 0.0) {
    return vec3(0.0);
  }
  float up = 2.0 * cosine * normal.z - eye.z;
  vec3 sky = mix(rig.skyHorizon, up >= 0.0 ? rig.skyTop : rig.skyBottom, abs(up));
  vec3 sum = (1.0 - 0.55 * sqrt(roughness)) * sky;  // the lobe's share of a uniform sky
  for (int i = 0; i < rig.keyCount; ++i) {
    float spread = rig.keys[i].spread;
    float wider = min(1.0, sqrt(roughness * roughness + spread * spread));
    sum += kPi * ggx(normal, eye, rig.keys[i].direction, wider) * rig.keys[i].radiance;
  }
  return sum;
}
