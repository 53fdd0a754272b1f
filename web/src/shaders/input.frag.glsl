// Matt, lit by the sky, the ground and a lamp of the room; linear light.
uniform vec3 uColor;
uniform vec3 uSky;
uniform vec3 uGround;
uniform vec3 uLamp;
uniform vec3 uTowardsLamp;

varying vec3 vNormal;

const float kPi = 3.14159265;

void main() {
  vec3 normal = normalize(vNormal);
  float up = dot(normal, viewMatrix[1].xyz);
  float lit = max(0.0, dot(normal, mat3(viewMatrix) * uTowardsLamp));
  vec3 light = mix(uGround, uSky, 0.5 + 0.5 * up) + uLamp * lit;
  gl_FragColor = vec4(uColor / kPi * light, 1.0);
#include <colorspace_fragment>
}
