#include "cinema/path_tracer.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

constexpr float kFar = 1e30f;

float largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

Vec3 vector_at(const std::array<std::array<float, PathBatch::kPadded>, 3>& channels, size_t i) {
  return {channels[0][i], channels[1][i], channels[2][i]};
}

}  // namespace

PathTracer::PathTracer(const CinemaScene& scene, const Camera& camera, const Cut& cut,
                       int max_bounces, const PathOptions& options)
    : scene_(scene), camera_(camera) {
  const Box& occupied = scene.majorants().occupied();
  empty_ = occupied.empty();
  view_.scene = &scene;
  view_.max_bounces = max_bounces;
  view_.camera_voxel = scene.voxel_from_world(camera.position);
  const auto axis = [&](const Vec3& of_camera) {
    return scene.frame_from_world(of_camera * camera.rotation);
  };
  view_.right = axis(Vec3(1, 0, 0));
  view_.down = axis(Vec3(0, 1, 0));
  view_.forward = axis(Vec3(0, 0, 1));
  view_.focal = {camera.fx, camera.fy};
  view_.center = {camera.cx, camera.cy};
  view_.lens_radius = options.lens.radius;
  view_.lens_focus = options.lens.focus;
  view_.features = options.features;
  view_.box_min = occupied.min;
  view_.box_max = occupied.max;
  const Vec3 spacing = scene.volume().spacing;
  const float voxel = mean_spacing(scene.volume().scanned_spacing());
  view_.face_depth = 0.5f * voxel;
  view_.face_reach = BoundaryLook::kFaceVoxels * voxel;
  for (const Plane& plane : cut.planes()) {
    const Vec3 normal = scene.frame_from_world(plane.normal);
    add_face(-normal, -normal * spacing,
             glm::dot(plane.normal, scene.volume().origin) - plane.offset);
  }
  view_.plane_count = view_.face_count;
  for (int k = 0; k < 3; ++k) {
    Vec3 outward(0);
    outward[k] = 1;
    add_face(outward, outward * spacing,
             static_cast<float>(scene.volume().dims[k] - 1) * spacing[k]);
    add_face(-outward, -outward * spacing, 0);
  }
  if (options.floor) {
    const Floor& floor = *options.floor;
    view_.has_floor = true;
    view_.floor_up = scene.frame_from_world(floor.up);
    view_.floor_middle = scene.voxel_from_world(floor.middle) * spacing;
    view_.floor_radius = floor.radius;
    view_.floor_light =
        glm::dot(scene.lights().face_radiance(view_.floor_up, Lights::Keys::kDistant), kLuminance);
  }
}

void PathTracer::add_face(const Vec3& outward, const Vec3& gradient, float offset) {
  BlockFace& face = view_.faces[view_.face_count++];
  face.outward = outward;
  face.gradient = gradient;
  face.offset = offset;
  face.radiance = scene_.lights().face_radiance(outward, Lights::Keys::kDistant);
}

std::vector<PathSample> PathTracer::trace(std::span<const PathStart> starts) const {
  std::vector<PathSample> samples(starts.size());
  if (empty_) {
    return samples;
  }
  static thread_local const auto batch = std::make_unique<PathBatch>();
  const size_t batches = (starts.size() + PathBatch::kCapacity - 1) / PathBatch::kCapacity;
  for (size_t b = 0; b < batches; ++b) {
    const size_t begin = b * starts.size() / batches;
    batch->count = (b + 1) * starts.size() / batches - begin;
    for (size_t i = 0; i < batch->count; ++i) {
      const PathStart& start = starts[begin + i];
      batch->x[i] = start.x;
      batch->y[i] = start.y;
      batch->key[i] = start.key;
      batch->index[i] = start.index;
    }
    trace_paths(view_, *batch);
    for (size_t i = 0; i < batch->count; ++i) {
      PathSample& sample = samples[begin + i];
      sample.alpha = batch->alpha[i];
      sample.radiance = vector_at(batch->radiance, i);
      if (view_.features) {
        sample.albedo = vector_at(batch->albedo, i);
        sample.normal = vector_at(batch->normal, i);
        sample.depth = batch->depth[i];
      }
    }
  }
  return samples;
}

PathTracer::Ray PathTracer::camera_ray(float x, float y) const {
  const Vec3 direction = scene_.frame_from_world(camera_.ray_direction(x, y));
  Ray ray{view_.camera_voxel, scene_.voxel_direction(direction), Vec3(0)};
  for (int k = 0; k < 3; ++k) {
    ray.inverse[k] = 1.0f / (std::abs(ray.step[k]) > 1e-20f ? ray.step[k] : 1e-20f);
  }
  return ray;
}

// Intersects [t0, t1] with the occupied box and the kept half spaces; false if nothing is left.
bool PathTracer::clip(const Ray& ray, float& t0, float& t1) const {
  for (int k = 0; k < 3; ++k) {
    const float a = (view_.box_min[k] - ray.origin[k]) * ray.inverse[k];
    const float b = (view_.box_max[k] - ray.origin[k]) * ray.inverse[k];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  for (size_t i = 0; i < view_.plane_count; ++i) {
    const float slope = -glm::dot(view_.faces[i].gradient, ray.step);
    const float depth = view_.faces[i].offset - glm::dot(view_.faces[i].gradient, ray.origin);
    if (slope > 0) {
      t0 = std::max(t0, -depth / slope);
    } else if (slope < 0) {
      t1 = std::min(t1, -depth / slope);
    } else if (depth < 0) {
      return false;
    }
  }
  return t0 < t1;
}

float PathTracer::first_hit(float x, float y) const {
  const Ray ray = camera_ray(x, y);
  float t0 = 0;
  float t1 = kFar;
  if (empty_ || !clip(ray, t0, t1)) {
    return 0;
  }
  // Two marches by half voxels: the optical depth in all, then up to the median.
  const float march = 0.5f / largest(glm::abs(ray.step));
  const auto optical_depth = [&](float stop, float& where) {
    float depth = 0;
    scene_.majorants().walk(ray.origin, ray.step, t0, t1, [&](float, float t, float end) {
      const int count = std::max(1, static_cast<int>(std::ceil((end - t) / march)));
      const float length = (end - t) / static_cast<float>(count);
      for (int i = 0; i < count; ++i) {
        const float middle = t + (static_cast<float>(i) + 0.5f) * length;
        const float more = scene_.extinction(ray.origin + middle * ray.step) * length;
        if (depth + more > stop) {
          where = middle + length * ((stop - depth) / more - 0.5f);
          return true;
        }
        depth += more;
      }
      return false;
    });
    return depth;
  };
  constexpr float kOpaque = 20;
  float where = 0;
  const float all = optical_depth(kOpaque, where);
  const float alpha = where > 0 ? 1.0f : 1.0f - std::exp(-all);
  if (alpha < 1.0f / 255.0f) {
    return 0;
  }
  optical_depth(-std::log(1.0f - 0.5f * alpha), where);
  return where;
}

}  // namespace clipgs
