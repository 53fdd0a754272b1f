precision highp float;

in vec3 vNormal;
uniform vec3 uColor;
uniform float uHover;
out vec4 fragColor;

void main() {
  vec3 n = normalize(vNormal);
  float light = 0.55 + 0.45 * max(0.0, dot(n, normalize(vec3(-0.4, 0.7, 0.6))));
  fragColor = vec4(mix(uColor * light, vec3(1.0), 0.45 * uHover), 1.0);
}
