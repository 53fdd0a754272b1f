// Exposed faces: premultiplied display sRGB. Drawn twice: before the splats where no splat is seen behind the face
// (kOpaque 1), which then keeps them away by its depth, and elsewhere into a picture of their own, where the faces
// that share a pixel add up: each ray meets one.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;

#include "face.glsl"

in vec3 vPosition;
flat in vec3 vOutward;
flat in vec4 vLight;

uniform vec3 cameraPosition;  // world
uniform mat4 uPatientFromWorld;
uniform mat4 uIndexFromPatient;
uniform sampler3D uVoxels;  // codes, or sRGB
uniform highp sampler2D uCurve;  // values of the codes, from 0 to 1
uniform sampler2D uMaterials;
uniform vec2 uSteps[kTaps];
uniform vec4 uPlanes[kMaxPlanes];
uniform int uPlaneCount;
uniform int uRays;  // a pixel
uniform bool uGlossy;
uniform float uGrey;  // 0 cinematic … 1 values through the window
uniform LightRig uRig;
uniform float uExposure;
uniform bool uOpened;  // whether walls behind gaps are drawn; splats show them else
uniform Openings uOpenings;
uniform sampler3D uBlocks;
uniform highp sampler3D uLight;

out vec4 fragColor;

// Premultiplied display sRGB of what `rays` rays saw of lit tissue.
vec4 cinematic(FaceSum sum, vec3 towardsEye, float rays) {
  if (sum.alpha <= 0.0) {
    return vec4(0.0);
  }
  vec3 light = sum.reflectance * vLight.rgb + sum.opened;
  if (sum.specular > 0.0) {
    light += sum.specular * faceGloss(uRig, vOutward, towardsEye, sum.roughness / sum.specular);
  }
  return sum.alpha / rays * vec4(srgbFromLinear(uExposure / sum.alpha * light), 1.0);
}

void main() {
  vec3 eye = (uPatientFromWorld * vec4(cameraPosition, 1.0)).xyz;
  if (!gl_FrontFacing) {
    eye -= 2.0 * dot(eye - vPosition, vOutward) * vOutward;  // from behind a face is seen as in a mirror
  }
  vec3 right = dFdx(vPosition);
  vec3 up = dFdy(vPosition);
  vec3 last = vec3(textureSize(uVoxels, 0) - 1);
  FaceSum sum = FaceSum(vec3(0.0), 0.0, 0.0, 0.0, vec3(0.0));
  vec4 grey = vec4(0.0);
  for (int i = 0; i < uRays; ++i) {
    vec2 offset = placeInPixel(i, uRays) - 0.5;
    vec3 position = vPosition + offset.x * right - offset.y * up;
    vec3 direction = normalize(position - eye);
    FaceRay ray;
    ray.start = (uIndexFromPatient * vec4(position, 1.0)).xyz;
    if (!isInBox(ray.start, last) || !isKept(position, uPlanes, uPlaneCount)) {
      continue;  // at the edge of the face: it meets another one, or none
    }
    ray.stride = mat3(uIndexFromPatient) * direction;
    ray.slope = -dot(vOutward, direction);
    ray.leave = min(distanceToSide(ray.start, ray.stride, last),
                    distanceToCut(position, direction, uPlanes, uPlaneCount));
    ray.surface = vLight.a;
    if (uGrey < 1.0) {
      vec2 gap = march(ray, uVoxels, uCurve, uMaterials, uSteps, uGlossy, sum);
      Wall wall;
      if (uOpened && gap.x > 0.0 && isInside(ray.start, uBlocks) &&
          firstWall(ray, direction, gap.y, uOpenings, uVoxels, uBlocks, uMaterials, wall)) {
        sum.opened += gap.x * wall.reflectance * wallLight(wall, uOpenings, uLight);
        sum.alpha += gap.x;
      }
    }
    if (uGrey > 0.0) {
      grey += greyAt(ray.start, uVoxels, uCurve, uMaterials);
    }
  }
  float rays = float(uRays);
  vec4 color = mix(cinematic(sum, normalize(eye - vPosition), rays), grey / rays, uGrey);
  bool opaque = color.a > 0.999;
  if (color.a <= 0.0 || opaque != (kOpaque == 1)) {
    discard;
  }
  fragColor = color;
}
