#pragma once

#include <cmath>

#include "core/random.h"
#include "splat/scene.h"

namespace clipgs {

/// For tests: Gaussians scattered over a solid ball around `center`, every parameter in the range
/// that training gives it.
inline Gaussians random_gaussians(size_t count, int sh_degree, std::uint64_t seed,
                                  const Vec3& center = Vec3(10, -20, 1200), float radius = 120) {
  Gaussians g(count, sh_degree);
  Rng rng(seed);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 direction = glm::normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
    const Vec3 mean = center + radius * std::cbrt(rng.uniform()) * direction;
    for (int axis = 0; axis < 3; ++axis) {
      g.plane(Gaussians::kMean + axis)[i] = mean[axis];
      g.plane(Gaussians::kLogScale + axis)[i] = 0.7f * rng.normal();
      // Colour follows place, as it does in matter.
      g.plane(Gaussians::kSh + axis)[i] = std::sin(0.05f * mean[axis]) + 0.1f * rng.normal();
    }
    for (int c = 0; c < 4; ++c) {
      g.plane(Gaussians::kRotation + c)[i] = rng.normal();
    }
    g.plane(Gaussians::kOpacity)[i] = 2 * rng.normal();
    for (int p = Gaussians::kSh + 3; p < g.planes(); ++p) {
      g.plane(p)[i] =
          0.05f * rng.normal() + 0.05f * std::sin(0.03f * mean.x + static_cast<float>(p));
    }
  }
  return g;
}

/// … with face colours too.
inline Gaussians random_faces(size_t count, int sh_degree, std::uint64_t seed) {
  Gaussians g = random_gaussians(count, sh_degree, seed).reshaped(sh_degree, true);
  Rng rng(seed + 1);
  for (int p = g.face(); p < g.planes(); ++p) {
    for (size_t i = 0; i < count; ++i) {
      g.plane(p)[i] = 0.1f * rng.normal();
    }
  }
  return g;
}

inline Scene random_scene(size_t count, int sh_degree, std::uint64_t seed) {
  Scene scene;
  scene.gaussians = random_gaussians(count, sh_degree, seed);
  scene.sphere = {Vec3(10, -20, 1200), 120.25f};
  scene.bounds.add(Vec3(-110, -140, 1080));
  scene.bounds.add(Vec3(130.5f, 100, 1320));
  scene.axis = Vec3(0, 0.6f, 0.8f);
  scene.extent = Vec2(850.1f, 1050.7f);
  scene.title = "Phantom – bone";
  scene.preset = "bone";
  scene.created = "2025-01-31";
  return scene;
}

/// … with 200 plane states, and of each Gaussian the one that it comes from.
inline Scene layered_scene(size_t count, int sh_degree, std::uint64_t seed) {
  Scene scene = random_scene(count, sh_degree, seed);
  scene.states = {200, 850.5f, 1, true};
  for (size_t i = 0; i < count; ++i) {
    scene.layers.push_back(static_cast<std::uint16_t>(
        scene.states.nearest(glm::dot(scene.axis, scene.gaussians.mean(i)))));
  }
  return scene;
}

}  // namespace clipgs
