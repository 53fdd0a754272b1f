#include "volume/load.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/itk_reader.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

/// For each patient axis (R, A, S): which stored axis runs closest to it, and its sign.
struct AxisMap {
  std::array<int, 3> axis{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};
};

AxisMap closest_axes(const glm::dmat3& ras) {
  AxisMap best;
  double best_score = -1;
  std::array<int, 3> order{0, 1, 2};
  do {
    double score = 0;
    for (int world = 0; world < 3; ++world) {
      score += std::abs(ras[order[world]][world]);
    }
    if (score > best_score + 1e-9) {
      best_score = score;
      best.axis = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  for (int world = 0; world < 3; ++world) {
    best.sign[world] = ras[best.axis[world]][world] < 0 ? -1 : 1;
  }
  return best;
}

void require_perpendicular(const glm::dmat3& direction, const std::string& where) {
  const glm::dmat3 product = glm::transpose(direction) * direction;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(std::abs(product[i][j] - (i == j ? 1 : 0)) < 1e-3)) {
        throw Error("{}: its axes are not perpendicular; resample it to a regular grid", where);
      }
    }
  }
}

/// Copies `channels` numbers a voxel into the new order of the axes.
template <typename T>
std::vector<T> reorder(const std::vector<T>& from, int channels, const IVec3& from_dims,
                       const IVec3& dims, const AxisMap& map) {
  const std::array<std::ptrdiff_t, 3> from_stride{1, from_dims.x,
                                                  std::ptrdiff_t{from_dims.x} * from_dims.y};
  std::array<std::ptrdiff_t, 3> step{};
  std::ptrdiff_t start = 0;
  for (int i = 0; i < 3; ++i) {
    step[i] = from_stride[map.axis[i]] * map.sign[i];
    start += map.sign[i] < 0 ? from_stride[map.axis[i]] * (dims[i] - 1) : 0;
  }
  std::vector<T> to(from.size());
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t begin, size_t end) {
    for (size_t z = begin; z < end; ++z) {
      size_t out = z * dims.x * dims.y * channels;
      for (int y = 0; y < dims.y; ++y) {
        std::ptrdiff_t in = start + static_cast<std::ptrdiff_t>(z) * step[2] + y * step[1];
        for (int x = 0; x < dims.x; ++x, in += step[0]) {
          for (int c = 0; c < channels; ++c) {
            to[out++] = from[static_cast<size_t>(in) * channels + c];
          }
        }
      }
    }
  });
  return to;
}

/// LPS to RAS, axes permuted and flipped to run closest to R, A, S.
Volume oriented(const StoredImage& stored, const std::string& where) {
  require_perpendicular(stored.direction, where);
  const glm::dvec3 ras_sign(-1, -1, 1);
  glm::dmat3 ras;
  for (int i = 0; i < 3; ++i) {
    ras[i] = stored.direction[i] * ras_sign;
  }
  const AxisMap map = closest_axes(ras);

  Volume volume;
  glm::dvec3 origin = stored.origin * ras_sign;
  glm::dmat3 direction;
  for (int i = 0; i < 3; ++i) {
    const int from = map.axis[i];
    volume.dims[i] = stored.dims[from];
    volume.spacing[i] = static_cast<float>(stored.spacing[from]);
    direction[i] = ras[from] * static_cast<double>(map.sign[i]);
    if (map.sign[i] < 0) {
      origin += ras[from] * stored.spacing[from] * static_cast<double>(stored.dims[from] - 1);
    }
  }
  if (glm::determinant(direction) < 0) {
    throw Error("{}: its axes mirror the patient; give it a right-handed orientation", where);
  }
  volume.origin = Vec3(origin);
  volume.direction = Mat3(glm::mat3_cast(glm::normalize(glm::quat_cast(direction))));
  volume.values = reorder(stored.values, 1, stored.dims, volume.dims, map);
  volume.rgb = reorder(stored.rgb, 3, stored.dims, volume.dims, map);
  return volume;
}

void fill_luminance(Volume& volume) {
  volume.modality = Modality::kPhoto;
  volume.values.resize(volume.voxels());
  for (size_t i = 0; i < volume.voxels(); ++i) {
    const std::uint8_t* rgb = &volume.rgb[3 * i];
    volume.values[i] = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  }
}

/// Files carry no modality: values far below zero, where only air can be, mean Hounsfield units.
Modality guess_modality(float min, float max) {
  return min <= -500 && min >= -4096 && max > 0 && max < 32768 ? Modality::kCt : Modality::kUnknown;
}

void finish(Volume& volume, const StoredImage& stored, const LoadOptions& options,
            const std::string& where) {
  if (!volume.rgb.empty()) {
    fill_luminance(volume);
  } else if (options.hu) {
    for (float& value : volume.values) {
      value = value * options.hu->scale + options.hu->offset;
    }
    volume.modality = Modality::kCt;
  }
  float min = volume.values[0];
  float max = volume.values[0];
  for (const float value : volume.values) {
    if (!std::isfinite(value)) {
      throw Error("{}: holds voxels that are not finite numbers (NaN or infinity); replace them",
                  where);
    }
    min = std::min(min, value);
    max = std::max(max, value);
  }
  if (min == max) {
    throw Error("{}: every voxel has the value {}: there is nothing to show", where, min);
  }
  if (volume.modality == Modality::kUnknown) {
    volume.modality = guess_modality(min, max);
  }
  if (stored.eight_bit && !options.hu) {
    warn(fmt::format("{}: 8-bit values taken as stored; if this is CT give --hu 16,-1024", where));
  }
}

}  // namespace

Volume load_volume(const fs::path& path, const LoadOptions& options) {
  const std::string where = path.string();
  if (!fs::exists(path)) {
    throw Error("{}: no such file or folder", where);
  }
  const StoredImage stored = read_image_file(path);
  if (glm::any(glm::lessThan(stored.dims, IVec3(2)))) {
    throw Error("{}: {} x {} x {} voxels; at least 2 along every axis are needed", where,
                stored.dims.x, stored.dims.y, stored.dims.z);
  }
  Volume volume = oriented(stored, where);
  finish(volume, stored, options, where);
  return volume;
}

}  // namespace clipgs
