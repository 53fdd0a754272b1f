#include "cinema/seed_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

#include "cinema/lights.h"
#include "cinema/matter_colors.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

// Density of points where the look changes most, relative to the even interior.
constexpr float kBoundaryGain = 6.0f;
// Bytes of a vertex: six floats, three colour bytes, a float.
constexpr size_t kVertexBytes = 6 * 4 + 3 + 4;

constexpr const char* kHeader =
    "ply\n"
    "format binary_little_endian 1.0\n"
    "element vertex {}\n"
    "property float x\n"
    "property float y\n"
    "property float z\n"
    "property float nx\n"
    "property float ny\n"
    "property float nz\n"
    "property uchar red\n"
    "property uchar green\n"
    "property uchar blue\n"
    "property float spacing\n"
    "end_header\n";

// What voxels look like.
class Looks {
 public:
  Looks(const Volume& volume, const Preset& preset)
      : volume_(volume),
        preset_(preset),
        labels_(looks_of_labels(volume, preset.labels)),
        colors_(matter_colors(volume, preset.transfer)),
        thickness_(mean_spacing(volume.spacing)) {}

  // Colour times opacity, opacity; photographs' colours do not count.
  Vec4 at(int x, int y, int z) const {
    const size_t voxel = volume_.offset(x, y, z);
    const Material m = labelled(material_at(x, y, z), voxel);
    const float factor =
        preset_.gradient_opacity ? preset_.gradient_opacity->factor(steepness(x, y, z)) : 1.0f;
    const float opacity = 1.0f - std::exp(-factor * m.extinction * thickness_);
    return {m.albedo * opacity, opacity};
  }

  Vec3 albedo_at(int x, int y, int z) const {
    const size_t voxel = volume_.offset(x, y, z);
    Material m = material_at(x, y, z);
    if (!colors_.empty()) {
      const std::uint8_t* rgb = &colors_[3 * voxel];
      for (int c = 0; c < 3; ++c) {
        m.albedo[c] *= linear_from_srgb(static_cast<float>(rgb[c]) / 255.0f);
      }
    }
    return labelled(m, voxel).albedo;
  }

 private:
  // Neither photographs' colours nor labels count.
  Material material_at(int x, int y, int z) const {
    const float value = volume_.at(x, y, z);
    const Material& plain = preset_.transfer.at(value);
    return preset_.boundary ? preset_.boundary->mixed(
                                  plain, value, preset_.boundary->range.share(steepness(x, y, z)))
                            : plain;
  }
  // ‖∇v‖ by central differences, value units per mm.
  float steepness(int x, int y, int z) const {
    const IVec3 at(x, y, z);
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
      IVec3 low = at;
      IVec3 high = at;
      low[k] = std::max(at[k] - 1, 0);
      high[k] = std::min(at[k] + 1, volume_.dims[k] - 1);
      gradient[k] = (volume_.at(high.x, high.y, high.z) - volume_.at(low.x, low.y, low.z)) /
                    (2 * volume_.spacing[k]);
    }
    return glm::length(gradient);
  }
  Material labelled(const Material& material, size_t voxel) const {
    return labels_.empty() ? material : labels_[volume_.labels[voxel]].applied_to(material);
  }

  const Volume& volume_;
  const Preset& preset_;
  std::vector<LabelLook> labels_;     // by the volume's indices; empty without labels
  std::vector<std::uint8_t> colors_;  // of photographs' matter
  float thickness_;
};

// Points per voxel, up to a common factor: opacity, more of it where the look changes. By how much
// over a mean voxel counts, so that boundaries are covered alike whichever way they look.
float weight_at(const Volume& volume, const Looks& looks, int x, int y, int z) {
  const Vec4 here = looks.at(x, y, z);
  if (here.w < 0.02f) {
    return 0;
  }
  const Vec3 steps = mean_spacing(volume.spacing) / volume.spacing;  // of a mean voxel
  float change2 = 0;                                                 // to the next voxels
  float slope2 = 0;                                                  // over a mean voxel
  const auto compare = [&](int dx, int dy, int dz, float along) {
    const Vec4 there =
        looks.at(std::clamp(x + dx, 0, volume.dims.x - 1), std::clamp(y + dy, 0, volume.dims.y - 1),
                 std::clamp(z + dz, 0, volume.dims.z - 1));
    const Vec4 change = there - here;
    change2 += glm::dot(change, change);
    slope2 += along * along * glm::dot(change, change);
  };
  for (const int way : {-1, 1}) {
    compare(way, 0, 0, steps.x);
    compare(0, way, 0, steps.y);
    compare(0, 0, way, steps.z);
  }
  const float most = std::max(1.0f, std::sqrt(change2));  // a step from nothing to all is enough
  return here.w * (1.0f + kBoundaryGain * std::sqrt(slope2) / most);
}

}  // namespace

std::vector<SeedPoint> sample_seed_points(const Volume& volume, const Preset& preset, size_t count,
                                          std::uint64_t seed) {
  const Looks looks(volume, preset);
  const auto slices = static_cast<size_t>(volume.dims.z);
  std::vector<double> slice_weight(slices, 0);
  parallel_for(slices, 1, [&](size_t z, size_t) {
    double sum = 0;
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        sum += weight_at(volume, looks, x, y, static_cast<int>(z));
      }
    }
    slice_weight[z] = sum;
  });
  double total = 0;
  for (const double w : slice_weight) {
    total += w;
  }
  if (total <= 0) {
    throw Error("nothing of the volume is visible with preset {}; choose another", preset.name);
  }

  // Light on a face that looks at the middling light: half of what an open one gets.
  const Lights lights(preset.rig, Mat3(1), Vec3(volume.dims - 1) * volume.spacing);
  Vec3 light(0);
  constexpr int kDirections = 64;
  for (int i = 0; i < kDirections; ++i) {
    light += lights.face_radiance(fibonacci_sphere(i, kDirections)) / float{kDirections};
  }

  const double density = static_cast<double>(count) / total;  // points a unit of weight
  const float voxel_volume = volume.spacing.x * volume.spacing.y * volume.spacing.z;
  std::vector<std::vector<SeedPoint>> found(slices);
  parallel_for(slices, 1, [&](size_t z, size_t) {
    Rng rng(seed, z);
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const float weight = weight_at(volume, looks, x, y, static_cast<int>(z));
        if (weight <= 0) {
          continue;
        }
        const double expected = density * weight;
        const int points = static_cast<int>(expected + rng.uniform());
        for (int p = 0; p < points; ++p) {
          const Vec3 jitter(rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f);
          const Vec3 index =
              glm::clamp(Vec3(x, y, static_cast<int>(z)) + jitter, Vec3(0), Vec3(volume.dims - 1));
          const Vec3 albedo = looks.albedo_at(x, y, static_cast<int>(z));
          SeedPoint point;
          point.position = volume.world_from_index(index);
          for (int c = 0; c < 3; ++c) {
            point.color[c] =
                display_from_linear(preset.exposure * albedo[c] * light[c], preset.tone);
          }
          point.spacing = static_cast<float>(std::cbrt(voxel_volume / expected));
          found[z].push_back(point);
        }
      }
    }
  });
  std::vector<SeedPoint> points;
  for (const std::vector<SeedPoint>& slice : found) {
    points.insert(points.end(), slice.begin(), slice.end());
  }
  return points;
}

void save_seed_points(const std::filesystem::path& path, const std::vector<SeedPoint>& points) {
  const std::string header = fmt::format(fmt::runtime(kHeader), points.size());
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.resize(header.size() + points.size() * kVertexBytes);
  std::uint8_t* out = bytes.data() + header.size();
  for (const SeedPoint& point : points) {
    const std::array<float, 6> vertex = {
        point.position.x, point.position.y, point.position.z, 0, 0, 0};
    std::memcpy(out, vertex.data(), sizeof vertex);
    out += sizeof vertex;
    for (int c = 0; c < 3; ++c) {
      *out++ =
          static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(point.color[c], 0.0f, 1.0f)));
    }
    std::memcpy(out, &point.spacing, sizeof point.spacing);
    out += sizeof point.spacing;
  }
  write_file(path, bytes.data(), bytes.size());
}

std::vector<SeedPoint> load_seed_points(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "points.ply";
  const std::vector<std::uint8_t> bytes = read_file(path);
  // The one header that save_seed_points writes, with any count.
  const std::string head(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(
                                                            std::min<size_t>(bytes.size(), 512)));
  constexpr const char* kElement = "element vertex ";
  const size_t at = head.find(kElement);
  size_t count = 0;
  if (at != std::string::npos) {
    count = std::strtoull(head.c_str() + at + std::strlen(kElement), nullptr, 10);
  }
  const std::string header = fmt::format(fmt::runtime(kHeader), count);
  if (!head.starts_with(header) || count == 0 || count > bytes.size() / kVertexBytes ||
      bytes.size() != header.size() + count * kVertexBytes) {
    throw Error("{}: not a whole file of seed points; make the dataset again", path.string());
  }
  std::vector<SeedPoint> points(count);
  const std::uint8_t* in = bytes.data() + header.size();
  for (SeedPoint& point : points) {
    std::array<float, 3> position{};
    std::memcpy(position.data(), in, sizeof position);
    point.position = {position[0], position[1], position[2]};
    for (int c = 0; c < 3; ++c) {
      point.color[c] = static_cast<float>(in[24 + c]) / 255.0f;
    }
    std::memcpy(&point.spacing, in + 27, sizeof point.spacing);
    const float sum = position[0] + position[1] + position[2] + point.spacing;
    if (!std::isfinite(sum) || !(point.spacing > 0)) {
      throw Error("{}: a seed point is not a finite number; make the dataset again", path.string());
    }
    in += kVertexBytes;
  }
  return points;
}

}  // namespace clipgs
