#include "cinema/reference_tracer.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "cinema/matter_colors.h"
#include "cinema/scatter.h"
#include "core/image.h"

namespace clipgs {

ReferenceTracer::ReferenceTracer(const Volume& volume, const Preset& preset, const Camera& camera,
                                 const Cut& cut, int max_bounces)
    : volume_(volume),
      preset_(preset),
      labels_(looks_of_labels(volume, preset.labels)),
      photo_(matter_colors(volume, preset.transfer)),
      camera_(camera),
      max_bounces_(max_bounces),
      lights_(preset.rig, glm::transpose(volume.direction), Vec3(volume.dims - 1) * volume.spacing),
      spacing_(volume.spacing),
      voxel_(mean_spacing(volume.scanned_spacing())),
      last_(volume.dims - 1),
      majorant_(preset.transfer.max_extinction(std::numeric_limits<float>::lowest(),
                                               std::numeric_limits<float>::max())) {
  for (const Plane& plane : cut.planes()) {
    planes_.push_back(
        {plane.normal * volume.direction, plane.offset - glm::dot(plane.normal, volume.origin)});
    outward_.push_back(-planes_.back().normal);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      Vec3 normal(0);
      normal[axis] = sign;
      outward_.push_back(normal);
    }
  }
}

// Calls use(weight, offset) for the eight voxels about a position.
template <typename Use>
void ReferenceTracer::interpolate(const DVec3& voxel, const Use& use) const {
  const DVec3 p = glm::clamp(voxel, DVec3(0), last_);
  const IVec3 low = glm::min(IVec3(p), volume_.dims - 1);
  const IVec3 high = glm::min(low + 1, volume_.dims - 1);
  const DVec3 f = p - DVec3(low);
  for (int corner = 0; corner < 8; ++corner) {
    const IVec3 bit(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    double weight = 1;
    IVec3 at;
    for (int k = 0; k < 3; ++k) {
      weight *= bit[k] != 0 ? f[k] : 1 - f[k];
      at[k] = bit[k] != 0 ? high[k] : low[k];
    }
    use(weight, volume_.offset(at.x, at.y, at.z));
  }
}

double ReferenceTracer::value_at(const DVec3& voxel) const {
  double value = 0;
  interpolate(voxel, [&](double weight, size_t at) {
    value += weight * static_cast<double>(volume_.values[at]);
  });
  return value;
}

// Linear RGB; white without colours.
Vec3 ReferenceTracer::photo_at(const DVec3& voxel) const {
  if (photo_.empty()) {
    return Vec3(1);
  }
  DVec3 color(0);
  interpolate(voxel, [&](double weight, size_t at) {
    for (int c = 0; c < 3; ++c) {
      const float srgb = static_cast<float>(photo_[3 * at + static_cast<size_t>(c)]) / 255.0f;
      color[c] += weight * static_cast<double>(linear_from_srgb(srgb));
    }
  });
  return Vec3(color);
}

// Central differences over one voxel to either side, value units per mm, in the grid frame.
glm::dvec3 ReferenceTracer::gradient_at(const DVec3& voxel) const {
  DVec3 gradient;
  for (int k = 0; k < 3; ++k) {
    DVec3 step(0);
    step[k] = 1;
    gradient[k] = (value_at(voxel + step) - value_at(voxel - step)) / (2 * spacing_[k]);
  }
  return gradient;
}

double ReferenceTracer::extinction_at(const DVec3& voxel, double value,
                                      const LabelLook& label) const {
  const double extinction =
      label.applied_to(preset_.transfer.at(static_cast<float>(value))).extinction;
  if (!preset_.gradient_opacity) {
    return extinction;
  }
  const auto steepness = static_cast<float>(glm::length(gradient_at(voxel)));
  return extinction * preset_.gradient_opacity->factor(steepness);
}

// Of one of the eight voxels about the position, drawn with its trilinear weight.
LabelLook ReferenceTracer::draw_label(const DVec3& voxel, Rng& rng) const {
  if (labels_.empty()) {
    return {};
  }
  const DVec3 p = glm::clamp(voxel, DVec3(0), last_);
  IVec3 at(p);
  for (int k = 0; k < 3; ++k) {
    at[k] += static_cast<double>(rng.uniform()) < p[k] - at[k] ? 1 : 0;
  }
  return labels_[volume_.labels[volume_.offset(at.x, at.y, at.z)]];
}

bool ReferenceTracer::clip(const DVec3& origin, const DVec3& direction, double& t0,
                           double& t1) const {
  for (int k = 0; k < 3; ++k) {
    const double step = direction[k] / spacing_[k];
    if (step == 0) {
      if (origin[k] < 0 || origin[k] > last_[k]) {
        return false;
      }
      continue;
    }
    const double a = -origin[k] / step;
    const double b = (last_[k] - origin[k]) / step;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  for (const Plane& plane : planes_) {
    const double slope = glm::dot(DVec3(plane.normal), direction);
    const double distance =
        glm::dot(DVec3(plane.normal), origin * spacing_) - static_cast<double>(plane.offset);
    if (slope > 0) {
      t0 = std::max(t0, -distance / slope);
    } else if (slope < 0) {
      t1 = std::min(t1, -distance / slope);
    } else if (distance < 0) {
      return false;
    }
  }
  return t0 < t1;
}

bool ReferenceTracer::track(const DVec3& origin, const DVec3& direction, double t0, double t1,
                            Rng& rng, Collision& collision) const {
  for (double t = t0;;) {
    t -= std::log(1.0 - static_cast<double>(rng.uniform())) / majorant_;
    if (!(t < t1)) {
      return false;
    }
    const DVec3 voxel = voxel_at(origin, direction, t);
    const double value = value_at(voxel);
    const LabelLook label = draw_label(voxel, rng);
    if (static_cast<double>(rng.uniform()) * majorant_ < extinction_at(voxel, value, label)) {
      collision = {t, value, label};
      return true;
    }
  }
}

double ReferenceTracer::visibility(const DVec3& voxel, const Vec3& direction, Rng& rng) const {
  double t0 = 0;
  double t1 = std::numeric_limits<double>::max();
  Collision collision;
  const bool inside = clip(voxel, DVec3(direction), t0, t1);
  return inside && track(voxel, DVec3(direction), t0, t1, rng, collision) ? 0.0 : 1.0;
}

// Of a face of the kept block, mm.
double ReferenceTracer::depth_below(size_t face, const DVec3& voxel) const {
  const DVec3 outward(outward_[face]);
  const double offset = face < planes_.size()
                            ? -static_cast<double>(planes_[face].offset)
                            : glm::dot(glm::max(outward, DVec3(0)), last_ * spacing_);
  return offset - glm::dot(outward, voxel * spacing_);
}

// Whether a camera ray came here through matter that begins at a face, and not far.
bool ReferenceTracer::is_behind_face(const DVec3& voxel, const DVec3& direction) const {
  double nearest = std::numeric_limits<double>::max();
  for (size_t i = 0; i < outward_.size(); ++i) {
    const double slope = -glm::dot(DVec3(outward_[i]), direction);
    if (slope > 0) {
      nearest = std::min(nearest, depth_below(i, voxel) / slope);
    }
  }
  if (nearest >= double{BoundaryLook::kFaceVoxels} * voxel_) {
    return false;
  }
  const double entered = value_at(voxel_at(voxel, direction, -nearest));
  return preset_.transfer.at(static_cast<float>(entered)).extinction > 0;
}

Material ReferenceTracer::material_at(const DVec3& voxel, double value, bool by_value_alone) const {
  const auto v = static_cast<float>(value);
  Material m = preset_.transfer.at(v);
  if (preset_.boundary && !by_value_alone) {
    const auto steepness = static_cast<float>(glm::length(gradient_at(voxel)));
    m = preset_.boundary->mixed(m, v, preset_.boundary->range.share(steepness));
  }
  m.albedo *= photo_at(voxel);
  return m;
}

const Vec3* ReferenceTracer::face_at(const DVec3& voxel, const DVec3& direction) const {
  const Vec3* passed = nullptr;
  double nearest = std::numeric_limits<double>::max();
  for (size_t i = 0; i < outward_.size(); ++i) {
    const double depth = depth_below(i, voxel);
    const double slope = -glm::dot(DVec3(outward_[i]), direction);
    if (depth < 0.5 * voxel_ && slope > 0 && depth / slope < nearest) {
      nearest = depth / slope;
      passed = &outward_[i];
    }
  }
  return passed;
}

PathSample ReferenceTracer::trace(float x, float y, Rng& rng) const {
  PathSample sample;
  DVec3 origin = volume_.index_from_world(camera_.position);
  Vec3 direction = camera_.ray_direction(x, y) * volume_.direction;
  double t0 = 0;
  double t1 = std::numeric_limits<double>::max();
  if (!clip(origin, DVec3(direction), t0, t1)) {
    return sample;
  }
  Vec3 throughput(1);
  for (int bounce = 0; bounce < max_bounces_; ++bounce) {
    Collision collision;
    if (!track(origin, DVec3(direction), t0, t1, rng, collision)) {
      if (bounce > 0) {
        sample.radiance += throughput * lights_.sky(direction);
      }
      return sample;
    }
    sample.alpha = 1;
    const DVec3 voxel = voxel_at(origin, DVec3(direction), collision.t);
    const Vec3 out = -direction;
    const bool behind_face = bounce == 0 && is_behind_face(voxel, DVec3(direction));
    Material m = collision.label.applied_to(material_at(voxel, collision.value, behind_face));

    const Vec3* const face = bounce == 0 ? face_at(voxel, DVec3(direction)) : nullptr;
    DVec3 start = voxel;
    bool surface = face != nullptr;
    Vec3 normal = surface ? *face : Vec3(0);
    if (!surface) {
      const DVec3 gradient = gradient_at(voxel);
      const double steepness = glm::length(gradient);
      surface = static_cast<double>(rng.uniform()) <
                1.0 - std::exp(-static_cast<double>(preset_.surface_strength) * steepness);
      if (surface) {
        normal = Vec3(-gradient / steepness);
        normal = glm::dot(normal, out) < 0 ? -normal : normal;
        start += DVec3(normal) * voxel_ / spacing_;
      }
    }
    if (surface && bounce > 0) {
      m.albedo = (1.0f - m.specular) * m.albedo + m.specular;
      m.specular = 0;
    }
    // A face has nothing before it; elsewhere light is followed through the matter.
    const auto light_from = [&](const Vec3& towards) {
      return face != nullptr ? 1.0f : static_cast<float>(visibility(start, towards, rng));
    };
    for (const Lights::Key& key : lights_.keys()) {
      const auto [towards, irradiance] =
          key.sample(Vec3(start * spacing_), rng.uniform(), rng.uniform());
      Vec3 scattered(0);
      if (surface) {
        const float cosine = std::max(0.0f, glm::dot(normal, towards));
        scattered = (1.0f - m.specular) * cosine * std::numbers::inv_pi_v<float> * m.albedo +
                    m.specular * ggx::evaluate(normal, out, towards, m.roughness);
      } else {
        scattered = m.albedo * henyey_greenstein(glm::dot(direction, towards), m.phase);
      }
      if (scattered != Vec3(0)) {
        sample.radiance += throughput * scattered * irradiance * light_from(towards);
      }
    }

    const float u = rng.uniform();
    const float v = rng.uniform();
    if (!surface) {
      direction = sample_henyey_greenstein(direction, m.phase, u, v);
      throughput *= m.albedo;
    } else if (rng.uniform() < m.specular) {
      float weight = 0;
      direction = ggx::sample(normal, out, m.roughness, u, v, weight);
      throughput *= weight;
    } else {
      direction = sample_cosine(normal, u, v);
      throughput *= m.albedo;
    }
    if (face != nullptr) {
      sample.radiance += throughput * lights_.sky(direction);
      return sample;
    }
    origin = start;
    t0 = 0;
    t1 = std::numeric_limits<double>::max();
    if (!clip(origin, DVec3(direction), t0, t1)) {
      sample.radiance += throughput * lights_.sky(direction);
      return sample;
    }
  }
  // The last vertex's own light from the sky.
  Collision collision;
  if (!track(origin, DVec3(direction), t0, t1, rng, collision)) {
    sample.radiance += throughput * lights_.sky(direction);
  }
  return sample;
}

}  // namespace clipgs
