#include "asset/other_splats.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

#include "asset/spz.h"
#include "core/error.h"
#include "core/file.h"
#include "splat/ply.h"
#include "splat/similarity.h"

namespace clipgs {

namespace {

/// The interval that all but a two-hundredth of values on each side lie in.
Vec2 most_of(const float* values, size_t count) {
  std::vector<float> sorted(values, values + count);
  std::ranges::sort(sorted);
  const size_t outliers = count / 200;
  return {sorted[outliers], sorted[count - 1 - outliers]};
}

}  // namespace

Scene scene_of_splats(const Gaussians& gaussians) {
  if (gaussians.size() == 0) {
    throw Error("there are no splats in it");
  }
  Scene scene;
  scene.gaussians = transform(gaussians, scene_to_world());
  Vec3 low(0);
  Vec3 high(0);
  for (int a = 0; a < 3; ++a) {
    const Vec2 range = most_of(scene.gaussians.plane(Gaussians::kMean + a), gaussians.size());
    low[a] = range.x;
    high[a] = range.y;
  }
  scene.bounds.add(low);
  scene.bounds.add(high);
  constexpr float kLeastRadius = 1e-3f;
  scene.sphere = {0.5f * (low + high), std::max(0.5f * glm::length(high - low), kLeastRadius)};
  scene.extent = {low.z, high.z};
  return scene;
}

void warn_of_assumptions(const std::string& name) {
  warn(fmt::format(
      "{}: says neither its unit nor how it lies in a patient; taken as metres, y down", name));
}

bool is_other_splats(const std::filesystem::path& path) {
  if (path.extension() == ".spz") {
    return true;
  }
  std::filesystem::path beside = path;
  return path.extension() == ".ply" && !std::filesystem::exists(beside.replace_extension(".json"));
}

Scene read_other_splats(const std::filesystem::path& path) {
  const std::string name = path.string();
  const Gaussians gaussians =
      path.extension() == ".spz" ? decode_spz(read_file(path), name) : read_ply(path);
  if (gaussians.size() == 0) {
    throw Error("{}: there are no splats in it", name);
  }
  warn_of_assumptions(name);
  return scene_of_splats(gaussians);
}

}  // namespace clipgs
