#pragma once

#include <algorithm>

namespace clipgs {

// One pixel of splats behind one of faces, each premultiplied RGB and alpha. Where both cover the
// pixel in part, it is the same part: the matter behind a face ends where the face does, at the rim
// of the body. What is seen of the splats is therefore what they cover beyond the face, α − α_face,
// not the (1 − α_face)·α of surfaces that know nothing of each other.

/// From this alpha on nothing behind is seen.
constexpr float kOpaqueFace = 0.999f;

/// Puts `splats` behind `face`, in `out`; any of them may be the same.
template <typename T, typename F>
void put_behind(const F* face, const T* splats, T* out) {
  const T covered = face[3];
  const T seen = splats[3] > covered ? (splats[3] - covered) / splats[3] : T{0};
  for (int c = 0; c < 3; ++c) {
    out[c] = face[c] + seen * splats[c];
  }
  out[3] = std::max(covered, splats[3]);
}

/// ∂L/∂splats from ∂L/∂out.
inline void put_behind_backward(const float* face, const float* splats, const float* gradient,
                                float* out) {
  const float covered = face[3];
  if (splats[3] <= covered) {
    std::fill(out, out + 4, 0.0f);
    return;
  }
  const float seen = (splats[3] - covered) / splats[3];
  float along = 0;
  for (int c = 0; c < 3; ++c) {
    out[c] = seen * gradient[c];
    along += gradient[c] * splats[c];
  }
  out[3] = gradient[3] + along * covered / (splats[3] * splats[3]);
}

}  // namespace clipgs
