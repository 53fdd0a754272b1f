#include "splat/render.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "splat/behind.h"
#include "splat/rasterizer.h"
#include "splat/reference.h"

namespace clipgs {

namespace {

struct NamedOperator {
  ClipOperator clip;
  const char* name;
};

// In the order of the enumeration.
constexpr std::array kOperators = {
    NamedOperator{ClipOperator::kHard, "hard"}, NamedOperator{ClipOperator::kSoft, "soft"},
    NamedOperator{ClipOperator::kExact, "exact"}, NamedOperator{ClipOperator::kLayers, "layers"}};

/// Premultiplied → straight alpha.
template <typename T>
Image straighten(const T* premultiplied, int width, int height) {
  Image out(width, height, 4);
  for (size_t i = 0; i < out.pixels(); ++i) {
    const T alpha = premultiplied[i * 4 + 3];
    for (int c = 0; c < 3; ++c) {
      const T value = alpha > T{0} ? premultiplied[i * 4 + c] / alpha : T{0};
      out.data[i * 4 + c] = static_cast<float>(std::clamp(value, T{0}, T{1}));
    }
    out.data[i * 4 + 3] = static_cast<float>(alpha);
  }
  return out;
}

}  // namespace

ClipOperator parse_clip_operator(const std::string& name) {
  for (const NamedOperator& known : kOperators) {
    if (name == known.name) {
      return known.clip;
    }
  }
  throw Error("clip operator \"{}\" does not exist; choose hard, soft, exact or layers", name);
}

const char* clip_operator_name(ClipOperator clip) {
  return kOperators[static_cast<size_t>(clip)].name;
}

Image render(const Gaussians& gaussians, const Camera& camera, const Cut& cut, ClipOperator clip,
             const Image* front, const FaceGain& gain, const LayerSwitch& layers,
             const DepthCue& cue) {
  Rasterizer rasterizer;
  RasterOptions options;
  options.clip = clip;
  options.face_gain = gain;
  options.layers = layers;
  options.cue = cue;
  options.kept_share = clip == ClipOperator::kExact;
  const Image& image = rasterizer.forward(gaussians, camera, cut, options, front);
  return straighten(image.data.data(), image.width, image.height);
}

Image render_reference(const Gaussians& gaussians, const Camera& camera, const Cut& cut,
                       ClipOperator clip, const Image* front, const FaceGain& gain,
                       const LayerSwitch& layers, const DepthCue& cue) {
  RasterOptions options;
  options.clip = clip;
  options.face_gain = gain;
  options.layers = layers;
  options.cue = cue;
  options.kept_share = clip == ClipOperator::kExact;
  const std::vector<double> parameters(gaussians.data().begin(), gaussians.data().end());
  std::vector<double> image = reference_render(parameters, gaussians, camera, cut, options);
  for (size_t i = 0; front != nullptr && i < image.size(); i += 4) {
    put_behind(&front->data[i], &image[i], &image[i]);
  }
  return straighten(image.data(), camera.width, camera.height);
}

}  // namespace clipgs
