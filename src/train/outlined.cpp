#include "train/outlined.h"

#include <algorithm>

#include "core/parallel.h"
#include "section/outline.h"

namespace clipgs {
namespace {

constexpr float kLeastBeyond = 1e-3f;  // of a face: less has no colour of its own
constexpr size_t kGrain = 4096;        // pixels

/// Calls use(i, share, face) for the pixels whose outline is the truth's.
template <typename Use>
void for_outlined(const Image& drawn, const Image* faces, const Use& use) {
  parallel_for(drawn.pixels(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float alpha = drawn.data[4 * i + 3];
      const float share = Outline::share(alpha);
      const float* const at = faces != nullptr ? &faces->data[4 * i] : nullptr;
      const Vec4 face = at != nullptr ? Vec4(at[0], at[1], at[2], at[3]) : Vec4(0);
      if (share > 0 && alpha - face.a >= kLeastBeyond) {
        use(i, share, face);
      }
    }
  });
}

}  // namespace

void outline_by_truth(const Image& drawn, const Image* faces, const Image& truth, Image& outlined) {
  outlined = drawn;
  for_outlined(drawn, faces, [&](size_t i, float share, const Vec4& face) {
    const float* const from = &drawn.data[4 * i];
    float* const to = &outlined.data[4 * i];
    const float covered = glm::mix(from[3], truth.data[4 * i + 3], share);
    const float seen = std::max(0.0f, covered - face.a) / (from[3] - face.a);
    const float left = covered < face.a ? covered / face.a : 1;
    for (int c = 0; c < 3; ++c) {
      to[c] = left * face[c] + seen * (from[c] - face[c]);
    }
    to[3] = covered;
  });
}

void outline_by_truth_backward(const Image& drawn, const Image* faces, const Image& truth,
                               float alpha_weight, Image& gradient) {
  const float of_alpha = alpha_weight / static_cast<float>(drawn.pixels());
  for_outlined(drawn, faces, [&](size_t i, float share, const Vec4& face) {
    const float* const from = &drawn.data[4 * i];
    float* const g = &gradient.data[4 * i];
    const float beyond = from[3] - face.a;
    const float covered = glm::mix(from[3], truth.data[4 * i + 3], share);
    const float seen = std::max(0.0f, covered - face.a) / beyond;
    float along = 0;  // ∂L/∂seen
    for (int c = 0; c < 3; ++c) {
      along += g[c] * (from[c] - face[c]);
      g[c] *= seen;
    }
    const float grows = covered > face.a ? (1 - share - seen) / beyond : 0;
    const float error = from[3] - truth.data[4 * i + 3];
    g[3] = (1 - share) * g[3] + along * grows +
           share * of_alpha *
               (error > 0   ? 1.0f
                : error < 0 ? -1.0f
                            : 0.0f);
  });
}

}  // namespace clipgs
