// The polygons of exposed faces, in front of everything else.
precision highp float;

in vec3 position;  // RAS mm
in vec3 outward;   // unit, RAS: away from the kept side
in vec4 light;     // what a white face radiates, linear RGB, and FaceRay.surface

uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;

out vec3 vPosition;
flat out vec3 vOutward;
flat out vec4 vLight;

void main() {
  vPosition = position;
  vOutward = outward;
  vLight = light;
  gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
  gl_Position.z = -0.9999 * gl_Position.w;
}
