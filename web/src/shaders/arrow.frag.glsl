// Premultiplied. The outline fades where the surface turns away, which smooths it without multisampling.
precision highp float;

in vec3 vNormal;
in vec3 vPosition;
uniform vec3 uColor;
uniform float uHover;
out vec4 fragColor;

void main() {
  vec3 n = normalize(vNormal);
  float light = 0.55 + 0.45 * max(0.0, dot(n, normalize(vec3(-0.4, 0.7, 0.6))));
  float facing = dot(n, normalize(-vPosition));
  float alpha = clamp(facing / max(1.5 * fwidth(facing), 1e-4), 0.0, 1.0);
  fragColor = vec4(mix(uColor * light, vec3(1.0), 0.45 * uHover) * alpha, alpha);
}
