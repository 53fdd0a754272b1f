// Exposed faces: premultiplied display sRGB. Drawn twice: before the splats where no splat is seen behind the face
// (kOpaque 1), which then keeps them away by its depth, and after them elsewhere.
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
uniform sampler3D uVoxels;
uniform sampler2D uMaterials;
uniform vec2 uSteps[kTaps];
uniform vec4 uPlanes[kMaxPlanes];
uniform int uPlaneCount;
uniform int uRays;  // a pixel, along either side
uniform bool uGlossy;
uniform LightRig uRig;
uniform float uExposure;

out vec4 fragColor;

void main() {
  vec3 eye = (uPatientFromWorld * vec4(cameraPosition, 1.0)).xyz;
  vec3 right = dFdx(vPosition);
  vec3 up = dFdy(vPosition);
  vec3 last = vec3(textureSize(uVoxels, 0) - 1);
  FaceSum sum = FaceSum(vec3(0.0), 0.0, 0.0, 0.0);
  for (int i = 0; i < uRays * uRays; ++i) {
    vec2 offset = (vec2(i % uRays, i / uRays) + 0.5) / float(uRays) - 0.5;
    vec3 position = vPosition + offset.x * right + offset.y * up;
    vec3 direction = normalize(position - eye);
    FaceRay ray;
    ray.start = (uIndexFromPatient * vec4(position, 1.0)).xyz;
    ray.stride = mat3(uIndexFromPatient) * direction;
    ray.slope = -dot(vOutward, direction);
    ray.leave = min(distanceToSide(ray.start, ray.stride, last),
                    distanceToCut(position, direction, uPlanes, uPlaneCount));
    ray.surface = vLight.a;
    march(ray, uVoxels, uMaterials, uSteps, uGlossy, sum);
  }
  float rays = float(uRays * uRays);
  float alpha = sum.alpha / rays;
  bool opaque = alpha > 0.999;
  if (alpha <= 0.0 || opaque != (kOpaque == 1)) {
    discard;
  }
  vec3 light = sum.reflectance * vLight.rgb;
  if (sum.specular > 0.0) {
    light += sum.specular * faceGloss(uRig, vOutward, normalize(eye - vPosition), sum.roughness / sum.specular);
  }
  fragColor = vec4(alpha * srgbFromLinear(uExposure / sum.alpha * light), alpha);
}
