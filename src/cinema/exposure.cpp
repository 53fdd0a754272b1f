#include "cinema/exposure.h"

#include <algorithm>
#include <vector>

#include "cinema/picture.h"

namespace clipgs {

float automatic_exposure(const CinemaScene& scene, const Sphere& sphere) {
  constexpr int kSize = 96;  // px
  constexpr int kViews = 6;
  constexpr float kLeastAlpha = 0.5f;
  constexpr double kBright = 0.9;  // quantile of what is seen …
  constexpr float kShown = 0.6f;   // … and the share of a display's light that shows it
  PictureOptions options;
  options.spp = 16;
  std::vector<float> luminances;
  for (int i = 0; i < kViews; ++i) {
    const View view{360.0f * static_cast<float>(i) / kViews, i % 2 == 0 ? 15.0f : -15.0f, 1};
    const Camera camera = frame_sphere(sphere, view, kSize, kSize);
    const Image picture = render_picture(scene, camera, Cut(), options).mean();
    for (size_t p = 0; p < picture.pixels(); ++p) {
      const float* pixel = &picture.data[4 * p];
      if (pixel[3] > kLeastAlpha) {
        luminances.push_back(glm::dot(Vec3(pixel[0], pixel[1], pixel[2]), kLuminance) / pixel[3]);
      }
    }
  }
  if (luminances.empty()) {
    return scene.preset().exposure;  // mist: nothing to judge by
  }
  const auto bright =
      luminances.begin() +
      static_cast<std::ptrdiff_t>(kBright * static_cast<double>(luminances.size() - 1));
  std::nth_element(luminances.begin(), bright, luminances.end());
  const float shown = untoned(kShown, scene.preset().tone);
  return *bright > 0 ? std::clamp(shown / *bright, Preset::kLeastExposure, Preset::kMostExposure)
                     : scene.preset().exposure;
}

}  // namespace clipgs
