#include "section/section.h"

#include "core/image.h"

namespace clipgs {

const std::array<float, ValueCurve::kCodes> Section::kIdentity = ValueCurve().values();

FaceMaterial mix(const FaceMaterial& a, const FaceMaterial& b, float t) {
  return {glm::mix(a.extinction, b.extinction, t), glm::mix(a.specular, b.specular, t),
          glm::mix(a.roughness, b.roughness, t),   glm::mix(a.surface, b.surface, t),
          glm::mix(a.interior, b.interior, t),     glm::mix(a.boundary, b.boundary, t)};
}

std::optional<Section::Reading> Section::read(const Vec3& world) const {
  const Vec3 index = index_from_world(world);
  const bool inside = glm::all(glm::greaterThanEqual(index, Vec3(0))) &&
                      glm::all(glm::lessThanEqual(index, Vec3(dims - 1)));
  const float c = code(index);
  if (!inside || c < kFirstInside) {
    return std::nullopt;
  }
  const float read = value(sample(index));
  return Reading{read, value_errors[error_band(curve.code(read))]};
}

float Section::code_at(const IVec3& voxel) const {
  const std::uint8_t* v = &voxels[offset(voxel.x, voxel.y, voxel.z) * channels];
  return channels == 1 ? v[0] : value(Vec3(v[0], v[1], v[2]));
}

std::vector<Plane> Section::ends() const {
  const auto has_matter = [&](int axis, int at) {
    IVec3 first(0);
    IVec3 last = dims - 1;
    first[axis] = last[axis] = at;
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          if (materials[static_cast<size_t>(code_at({x, y, z}))].extinction > 0) {
            return true;
          }
        }
      }
    }
    return false;
  };
  std::vector<Plane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& normal = direction[axis];
    if (has_matter(axis, 0)) {
      planes.push_back({normal, glm::dot(normal, origin)});
    }
    if (has_matter(axis, dims[axis] - 1)) {
      planes.push_back({-normal, glm::dot(-normal, world_from_index(Vec3(dims - 1)))});
    }
  }
  return planes;
}

Vec3 gradient_at(const Section& section, const Vec3& index) {
  Vec3 slope;
  for (int k = 0; k < 3; ++k) {
    Vec3 step(0);
    step[k] = section.source_spacing[k] / section.spacing[k];
    slope[k] = (section.value(section.sample(index + step)) -
                section.value(section.sample(index - step))) /
               (2 * section.source_spacing[k]);
  }
  return section.direction * slope;
}

Vec3 photo_albedo(const Vec3& sampled) {
  return {linear_from_srgb(sampled.r / 255), linear_from_srgb(sampled.g / 255),
          linear_from_srgb(sampled.b / 255)};
}

}  // namespace clipgs
