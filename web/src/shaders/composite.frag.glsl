// The splats' picture, premultiplied and possibly brighter than its alpha, onto the page. Straight alpha
// where kStraight is set: what `clipgs render` writes.
precision highp float;
precision highp sampler2D;

uniform sampler2D uPicture;
uniform vec2 uTexelsPerPixel;  // of the picture, where it is drawn at another size

out vec4 fragColor;

void main() {
  vec4 c = texture(uPicture, gl_FragCoord.xy * uTexelsPerPixel);
  c.rgb = min(c.rgb, c.a);
  if (kStraight == 1) {
    c.rgb /= max(c.a, 1e-6);
  }
  fragColor = c;
}
