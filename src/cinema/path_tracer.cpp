#include "cinema/path_tracer.h"

#include <cmath>
#include <numbers>

#include "cinema/scatter.h"

namespace clipgs {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFar = 1e30f;

// Optical depth to the next collision for uniform u in [0, 1).
float free_path(float u) { return -std::log(1.0f - u); }

// Fractional parts of the square roots of primes: irrational and independent of each other.
constexpr std::array<double, PathDraws::kDimensions> kRoots = {
    std::numbers::sqrt2, std::numbers::sqrt3, 2.23606797749979,   2.6457513110645907,
    3.3166247903554,     3.605551275463989,   4.123105625617661,  4.358898943540674,
    4.795831523312719,   5.385164807134504,   5.5677643628300215, 6.082762530298219,
    6.4031242374328485,  6.557438524302,      6.855654600401044};

constexpr std::array<std::uint32_t, PathDraws::kDimensions> recurrence_steps() {
  std::array<std::uint32_t, PathDraws::kDimensions> steps{};
  for (size_t i = 0; i < steps.size(); ++i) {
    const double fraction = kRoots[i] - static_cast<int>(kRoots[i]);
    steps[i] = static_cast<std::uint32_t>(fraction * 4294967296.0);
  }
  return steps;
}

float largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

const std::array<std::uint32_t, PathDraws::kDimensions> PathDraws::kSteps = recurrence_steps();

PathDraws::PathDraws(std::uint64_t seed, std::uint64_t stream, std::uint32_t first)
    : index_(first), rng_(Rng::mix(seed) + first, stream) {
  Rng starts(seed, stream);
  for (std::uint32_t& start : starts_) {
    start = starts.next();
  }
}

PathTracer::PathTracer(const CinemaScene& scene, const Camera& camera, const Cut& cut,
                       int max_bounces, const Lens& lens)
    : scene_(scene),
      camera_(camera),
      max_bounces_(max_bounces),
      lens_(lens),
      camera_voxel_(scene.voxel_from_world(camera.position)) {
  const Box& occupied = scene.majorants().occupied();
  empty_ = occupied.empty();
  box_min_ = occupied.min;
  box_max_ = occupied.max;
  const Vec3 spacing = scene.volume().spacing;
  for (const Plane& plane : cut.planes()) {
    const Vec3 normal = scene.frame_from_world(plane.normal);
    add_face(-normal, -normal * spacing,
             glm::dot(plane.normal, scene.volume().origin) - plane.offset);
  }
  plane_count_ = face_count_;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 outward(0);
    outward[axis] = 1;
    add_face(outward, outward * spacing,
             static_cast<float>(scene.volume().dims[axis] - 1) * spacing[axis]);
    add_face(-outward, -outward * spacing, 0);
  }
}

void PathTracer::add_face(const Vec3& outward, const Vec3& gradient, float offset) {
  Face face;
  face.outward = outward;
  face.gradient = gradient;
  face.offset = offset;
  face.half_voxel = 0.5f * glm::length(gradient);
  face.radiance = scene_.lights().face_radiance(outward);
  faces_[face_count_++] = face;
}

PathTracer::Ray PathTracer::camera_ray(float x, float y) const {
  return make_ray(camera_voxel_, scene_.frame_from_world(camera_.ray_direction(x, y)));
}

// Every ray of a pixel meets the others where the pinhole's meets the plane of the focus.
PathTracer::Ray PathTracer::lens_ray(float x, float y, float u, float v) const {
  const Vec3 through((x - camera_.cx) / camera_.fx, (y - camera_.cy) / camera_.fy, 1);
  const float r = lens_.radius * std::sqrt(u);
  const float phi = 2 * kPi * v;
  const Vec3 offset(r * std::cos(phi), r * std::sin(phi), 0);
  const Vec3 direction = glm::normalize((lens_.focus * through - offset) * camera_.rotation);
  return make_ray(scene_.voxel_from_world(camera_.position + offset * camera_.rotation),
                  scene_.frame_from_world(direction));
}

// Intersects [t0, t1] with the occupied box and the kept half spaces; false if nothing is left.
bool PathTracer::clip(const Ray& ray, float& t0, float& t1) const {
  for (int k = 0; k < 3; ++k) {
    const float a = (box_min_[k] - ray.origin[k]) * ray.inverse[k];
    const float b = (box_max_[k] - ray.origin[k]) * ray.inverse[k];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  for (size_t i = 0; i < plane_count_; ++i) {
    const float slope = -glm::dot(faces_[i].gradient, ray.step);
    const float depth = faces_[i].offset - glm::dot(faces_[i].gradient, ray.origin);
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

// Where a ray leaves the unit cube of voxel space with its low corner at `low`.
float PathTracer::leave(const Ray& ray, const IVec3& low) {
  float t = kFar;
  for (int k = 0; k < 3; ++k) {
    const auto side = static_cast<float>(low[k] + (ray.step[k] > 0 ? 1 : 0));
    t = std::min(t, (side - ray.origin[k]) * ray.inverse[k]);
  }
  return t;
}

// Delta tracking: the first real collision after `optical_depth` of tentative ones.
bool PathTracer::track(const Ray& ray, float t0, float t1, float optical_depth, Rng& rng,
                       Collision& collision) const {
  if (t0 >= t1) {
    return false;
  }
  const VoxelGrid& grid = scene_.grid();
  const MajorantGrid& majorants = scene_.majorants();
  const auto visit = [&](float majorant, float t, float end) {
    while (true) {
      const float next = t + optical_depth / majorant;
      if (!(next < end)) {
        optical_depth -= majorant * (end - t);
        return false;
      }
      t = next;
      const Vec3 voxel = ray.origin + t * ray.step;
      const IVec3 low(voxel);
      if (!majorants.has_matter(low.x, low.y, low.z)) {
        // Air: on to where the ray leaves these eight voxels. Free paths have no memory.
        t = std::max(t, leave(ray, low));
      } else {
        const float code = grid.sample(voxel);
        if (rng.uniform() * majorant < scene_.extinction(code)) {
          collision = {t, code};
          return true;
        }
      }
      optical_depth = free_path(rng.uniform());
    }
  };
  return majorants.walk(ray.origin, ray.step, t0, t1, visit);
}

// Unbiased estimate of the transmittance to the light: 1 or 0. (Ratio tracking would be less noisy
// in mist, but looks up much more in solid tissue.)
float PathTracer::transmittance(const Ray& ray, Rng& rng) const {
  float t0 = 0;
  float t1 = kFar;
  Collision collision;
  const bool blocked =
      clip(ray, t0, t1) && track(ray, t0, t1, free_path(rng.uniform()), rng, collision);
  return blocked ? 0.0f : 1.0f;
}

// The face through which a camera ray along `direction` came when it met matter at `voxel` less
// than half a voxel deep: near an edge, of those the one that it passed last.
const PathTracer::Face* PathTracer::face_at(const Vec3& voxel, const Vec3& direction) const {
  const Face* passed = nullptr;
  float nearest = kFar;
  for (size_t i = 0; i < face_count_; ++i) {
    const Face& face = faces_[i];
    const float depth = face.offset - glm::dot(face.gradient, voxel);
    const float slope = -glm::dot(direction, face.outward);
    if (depth < face.half_voxel && slope > 0 && depth < nearest * slope) {
      nearest = depth / slope;
      passed = &face;
    }
  }
  return passed;
}

// Kept matter is convex about its faces, so a point of a face sees its whole hemisphere free: its
// diffuse light is known, and only the highlight is sampled.
Vec3 PathTracer::shade_face(const Face& face, const Material& material, const Vec3& out,
                            PathDraws& draws) const {
  Vec3 light = (1.0f - material.specular) * material.albedo * face.radiance;
  if (material.specular > 0) {
    const Lights& lights = scene_.lights();
    float weight = 0;
    const Vec3 in = ggx::sample(face.outward, out, material.roughness, draws(PathDraws::kAngle),
                                draws(PathDraws::kTurn), weight);
    Vec3 highlight = weight > 0 ? weight * lights.sky(in) : Vec3(0);
    for (const Lights::Key& key : lights.keys()) {
      const Vec3 towards = key.sample(draws(PathDraws::kDiscU), draws(PathDraws::kDiscV));
      highlight += ggx::evaluate(face.outward, out, towards, material.roughness) * key.irradiance;
    }
    light += material.specular * highlight;
  }
  return light;
}

PathTracer::Vertex PathTracer::vertex_at(const Ray& ray, const Collision& collision, bool first,
                                         PathDraws& draws) const {
  Vertex vertex;
  vertex.voxel = ray.origin + collision.t * ray.step;
  vertex.before = ray.direction;
  vertex.material = scene_.material(collision.code, vertex.voxel);
  vertex.first = first;
  // Surface or phase: P = 1 − exp(−k·‖∇v‖).
  const Vec3 gradient = scene_.gradient(vertex.voxel);
  const float steepness = glm::length(gradient);
  const float u = first ? draws(PathDraws::kSurface) : draws.uniform();
  vertex.surface = scene_.preset().surface_strength * steepness > free_path(u);
  if (vertex.surface) {
    vertex.normal = gradient / -steepness;
    if (glm::dot(vertex.normal, ray.direction) > 0) {
      vertex.normal = -vertex.normal;
    }
    // The boundary is blurred over about a voxel and would shadow itself: light leaves from above.
    vertex.voxel += vertex.normal;
  }
  if (!vertex.surface) {
    vertex.material.specular = 0;
  } else if (!first) {
    // Highlights of later vertices would only be noise: there the lobe's energy is spread evenly.
    Material& m = vertex.material;
    m.albedo = (1.0f - m.specular) * m.albedo + m.specular;
    m.specular = 0;
  }
  return vertex;
}

// What one steradian of unit radiance from `towards` adds to the light that leaves the vertex.
Vec3 PathTracer::scattered(const Vertex& vertex, const Vec3& towards) const {
  const Material& m = vertex.material;
  if (!vertex.surface) {
    return henyey_greenstein(glm::dot(vertex.before, towards), scene_.preset().phase_g) * m.albedo;
  }
  const float cosine = std::max(0.0f, glm::dot(vertex.normal, towards));
  Vec3 sum = (1.0f - m.specular) * cosine / kPi * m.albedo;
  if (m.specular > 0) {
    sum += m.specular * ggx::evaluate(vertex.normal, -vertex.before, towards, m.roughness);
  }
  return sum;
}

// Next-event estimation: one key, chosen by what each would give unshadowed.
Vec3 PathTracer::key_light(const Vertex& vertex, PathDraws& draws) const {
  struct Candidate {
    Vec3 towards;
    Vec3 light;
    float upto;
  };
  std::array<Candidate, Lights::kMaxKeys> candidates;
  const std::vector<Lights::Key>& keys = scene_.lights().keys();
  const size_t count = keys.size();
  const float u = vertex.first ? draws(PathDraws::kDiscU) : draws.uniform();
  const float v = vertex.first ? draws(PathDraws::kDiscV) : draws.uniform();
  float total = 0;
  for (size_t k = 0; k < count; ++k) {
    Candidate& c = candidates[k];
    c.towards = keys[k].sample(u, v);
    c.light = scattered(vertex, c.towards) * keys[k].irradiance;
    total += largest(c.light);
    c.upto = total;
  }
  if (total <= 0) {
    return Vec3(0);
  }
  const float pick = (vertex.first ? draws(PathDraws::kKey) : draws.uniform()) * total;
  size_t k = 0;
  while (k + 1 < count && candidates[k].upto <= pick) {
    ++k;
  }
  const Candidate& chosen = candidates[k];
  const float weight = largest(chosen.light);
  if (weight <= 0) {
    return Vec3(0);
  }
  return chosen.light *
         (total / weight * transmittance(make_ray(vertex.voxel, chosen.towards), draws.rng()));
}

// A new direction; `throughput` is multiplied by what the vertex lets through that way.
Vec3 PathTracer::turn(const Vertex& vertex, float u, float v, PathDraws& draws,
                      Vec3& throughput) const {
  const Material& m = vertex.material;
  if (vertex.surface && m.specular > 0 && draws(PathDraws::kLobe) < m.specular) {
    float weight = 0;
    const Vec3 direction = ggx::sample(vertex.normal, -vertex.before, m.roughness, u, v, weight);
    throughput *= weight;
    return direction;
  }
  throughput *= m.albedo;
  return vertex.surface ? sample_cosine(vertex.normal, u, v)
                        : sample_henyey_greenstein(vertex.before, scene_.preset().phase_g, u, v);
}

PathSample PathTracer::trace(float x, float y, PathDraws& draws) const {
  PathSample sample;
  Ray ray = lens_.radius > 0 ? lens_ray(x, y, draws(PathDraws::kLensU), draws(PathDraws::kLensV))
                             : camera_ray(x, y);
  float t0 = 0;
  float t1 = kFar;
  Collision collision;
  if (empty_ || !clip(ray, t0, t1) ||
      !track(ray, t0, t1, free_path(draws(PathDraws::kDistance)), draws.rng(), collision)) {
    return sample;
  }
  sample.hit = true;
  const Vec3 met = ray.origin + collision.t * ray.step;
  if (const Face* face = face_at(met, ray.direction)) {
    const Material material = scene_.material(collision.code, met);
    sample.albedo = material.albedo;
    sample.radiance = shade_face(*face, material, -ray.direction, draws);
    return sample;
  }

  Vec3 throughput(1);
  for (int bounce = 0; bounce < max_bounces_; ++bounce) {
    const bool first = bounce == 0;
    const Vertex vertex = vertex_at(ray, collision, first, draws);
    if (first) {
      sample.albedo = vertex.material.albedo;
    }
    sample.radiance += throughput * key_light(vertex, draws);

    // Onwards; the sky is met where a path leaves.
    const bool early = bounce < 2;
    const float u = early ? draws(first ? PathDraws::kAngle : PathDraws::kAngle2) : draws.uniform();
    const float v = early ? draws(first ? PathDraws::kTurn : PathDraws::kTurn2) : draws.uniform();
    const Vec3 direction = turn(vertex, u, v, draws, throughput);
    if (!first) {
      const float survival = std::min(1.0f, largest(throughput));
      if (draws.uniform() >= survival) {
        return sample;
      }
      throughput /= survival;
    }
    ray = make_ray(vertex.voxel, direction);
    t0 = 0;
    t1 = kFar;
    const float depth = free_path(first ? draws(PathDraws::kDistance2) : draws.uniform());
    if (!clip(ray, t0, t1) || !track(ray, t0, t1, depth, draws.rng(), collision)) {
      sample.radiance += throughput * scene_.lights().sky(direction);
      return sample;
    }
  }
  return sample;
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
        const float code = scene_.grid().sample(ray.origin + middle * ray.step);
        const float more = scene_.extinction(code) * length;
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
