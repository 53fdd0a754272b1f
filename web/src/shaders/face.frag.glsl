// Exposed faces: premultiplied display sRGB. Drawn twice: before the splats where no splat is seen behind the face
// (kOpaque 1), which then keeps them away by its depth, and elsewhere into a picture of their own, where the faces
// that share a pixel add up: each ray meets one.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;

#include "depth_cue.glsl"
#include "face.glsl"
#include "tone.glsl"

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
uniform int uGreyOpenings;
uniform bool uOpened;  // whether walls behind gaps are drawn; splats show them else
uniform Openings uOpenings;
uniform sampler3D uBlocks;
uniform highp sampler3D uValues;  // that walls are found by: 0 to 1, or sRGB
uniform highp sampler3D uLight;
uniform DepthCue uCue;
uniform Backdrop uBackdrop;

out vec4 fragColor;

// Premultiplied display sRGB of a sum of linear RGB.
vec4 exposed(vec3 light, float alpha) {
  return alpha > 0.0 ? alpha * vec4(displayFromLinear(uExposure / alpha * light, kFilmic == 1), 1.0) : vec4(0.0);
}

// Premultiplied display sRGB of lit tissue, and of walls that are seen as such.
vec4 cinematic(FaceSum sum, vec3 towardsEye) {
  vec3 light = sum.reflectance * vLight.rgb + sum.opened;
  if (sum.specular > 0.0) {
    light += sum.specular * faceGloss(uRig, vOutward, towardsEye, sum.roughness / sum.specular);
  }
  return exposed(light, sum.alpha);
}

void main() {
  vec3 eye = (uPatientFromWorld * vec4(cameraPosition, 1.0)).xyz;
  vec3 viewer = eye;
  if (!gl_FrontFacing) {
    eye -= 2.0 * dot(eye - vPosition, vOutward) * vOutward;  // from behind a face is seen as in a mirror
  }
  vec3 right = dFdx(vPosition);
  vec3 up = dFdy(vPosition);
  vec3 last = vec3(textureSize(uVoxels, 0) - 1);
  FaceSum sum = FaceSum(vec3(0.0), 0.0, 0.0, 0.0, vec3(0.0), vec4(0.0));
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
    float open = 0.0;  // of a grey ray
    if (uGrey < 1.0 || uGreyOpenings != kGapValues) {
      vec2 gap = march(ray, uVoxels, uCurve, uMaterials, uSteps, uGlossy, sum);
      Wall wall;
      if (uOpened && gap.x > 0.0 && isInside(ray.start, uBlocks) &&
          firstWall(ray, direction, gap.y, uOpenings, uValues, uBlocks, uMaterials, wall)) {
        if (uGrey > 0.0 && uGreyOpenings != kGapValues) {
          open = openness(gap.x, ray.start, uVoxels, uCurve, uMaterials);
        }
        vec3 light = wallLight(wall, uOpenings, uLight);
        vec3 behind = uGreyOpenings == kNeutralWalls ? mix(wall.reflectance, kClay, uGrey) : wall.reflectance;
        sum.opened += (1.0 - open) * gap.x * wall.reflectance * light;
        sum.alpha += (1.0 - open) * gap.x;
        sum.behind += open * (1.0 - (1.0 - uGrey) * (1.0 - gap.x)) * vec4(behind * light, 1.0);
      }
    }
    if (uGrey > 0.0) {
      grey += (1.0 - open) * greyAt(ray.start, uVoxels, uCurve, uMaterials);
    }
  }
  vec4 seen = mix(cinematic(sum, normalize(eye - vPosition)), grey, uGrey);
  vec4 color = (seen + exposed(sum.behind.rgb, sum.behind.a)) / float(uRays);
  bool opaque = color.a > 0.999;
  if (color.a <= 0.0 || opaque != (kOpaque == 1)) {
    discard;
  }
  vec3 straight = cued(color.rgb / color.a, vPosition, viewer, gl_FragCoord.xy, uCue, uBackdrop);
  fragColor = vec4(color.a * straight, color.a);
}
