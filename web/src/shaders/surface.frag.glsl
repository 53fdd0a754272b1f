// What is seen of the volume's surfaces, faces left out: display sRGB times the share of rays that meet any, and that; and
// the depth of what is seen nearest of them, or of a face.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;

#include "depth_cue.glsl"
#include "surface.glsl"
#include "tone.glsl"

uniform sampler2D uDepth;  // less than 1 where there is an opaque face
uniform vec2 uSize;        // px
uniform float uPixel;      // side of one, in those of the picture
uniform int uRays;         // a pixel
uniform vec2 uDepthToClip;  // depth in clip space is x + y / mm
uniform Outline uOutline;
uniform Openings uOpenings;
uniform float uLightScale;
uniform float uSurfaceDepth;
uniform LightRig uRig;
uniform float uExposure;
uniform highp sampler3D uValues;
uniform sampler3D uBlocks;
uniform sampler2D uMaterials;
uniform highp sampler3D uLight;
uniform vec4 uPlanes[kMaxPlanes];
uniform int uPlaneCount;
uniform DepthCue uCue;
uniform Backdrop uBackdrop;

out vec4 fragColor;

void main() {
  gl_FragDepth = texture(uDepth, gl_FragCoord.xy / uSize).r;
  if (gl_FragDepth < 1.0) {
    fragColor = vec4(0.0);
    return;
  }
  vec2 pixel = vec2(gl_FragCoord.x, uSize.y - gl_FragCoord.y) - vec2(0.5, 0.5);
  Openings openings = uOpenings;
  openings.lightScale = uLightScale;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < uRays; ++i) {
    vec3 direction = directionThrough((pixel + placeInPixel(i, uRays)) / uSize, uOutline);
    Wall wall;
    if (meetsSurface(direction, uOutline, openings, uSurfaceDepth, uValues, uBlocks, uMaterials, uPlanes, uPlaneCount,
                     wall)) {
      vec3 light = wallRadiance(wall, direction, uRig, openings, uLight);
      vec3 color = displayFromLinear(uExposure * light, kFilmic == 1);
      vec3 at = uOutline.eye + wall.depth * direction;
      float mm = wall.depth * dot(direction, uOutline.forward);
      gl_FragDepth = min(gl_FragDepth, 0.5 + 0.5 * (uDepthToClip.x + uDepthToClip.y / mm));
      sum += vec4(cued(color, at, uOutline.eye, uPixel * gl_FragCoord.xy, uCue, uBackdrop), 1.0);
    }
  }
  fragColor = sum / float(uRays);
}
