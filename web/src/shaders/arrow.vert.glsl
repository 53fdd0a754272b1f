precision highp float;

in vec3 position;
in vec3 normal;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
out vec3 vNormal;
out vec3 vPosition;

void main() {
  vec4 p = viewMatrix * modelMatrix * vec4(position, 1.0);
  vNormal = mat3(viewMatrix) * mat3(modelMatrix) * normal;
  vPosition = p.xyz;
  gl_Position = projectionMatrix * p;
}
