#include "volume/segmentation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "volume/image_file.h"
#include "volume/orient.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostLabels = 255;        // beside 0: indices are bytes
constexpr float kLargestNumber = 0x1p24f;  // above it floats do not tell whole numbers apart

/// The labels as a volume of values, in patient space.
Volume read_labels(const fs::path& path) {
  const std::string where = path.string();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    throw Error("{}: no such file; labels are one .nii(.gz), .nrrd or .mha file", where);
  }
  const SizeCheck check = [&](const VolumeSize& size) {
    require_supported(size, where);
    if (const std::string lack = lack_of_memory(size, 0, available_memory()); !lack.empty()) {
      throw Error("{}: {}", where, lack);
    }
  };
  StoredImage stored = read_image_file(path, 0, check);
  if (stored.values.empty()) {
    throw Error("{}: a colour image; labels are one whole number a voxel", where);
  }
  return oriented(std::move(stored), where);
}

/// The labels that occur, 0 first.
std::vector<int> find_numbers(const Volume& labels, const std::string& where) {
  std::set<int> found;
  float last = 0;
  for (const float value : labels.values.all()) {
    if (value == last) {
      continue;
    }
    const bool whole = std::abs(value) <= kLargestNumber && value == std::trunc(value);
    if (!whole) {  // NaN too
      throw Error("{}: holds the value {}; labels are whole numbers: is it a segmentation?", where,
                  value);
    }
    last = value;
    if (value != 0) {
      found.insert(static_cast<int>(value));
    }
    if (found.size() > kMostLabels) {
      throw Error("{}: more than {} labels; merge some, or is it no segmentation?", where,
                  kMostLabels);
    }
  }
  if (found.empty()) {
    throw Error("{}: holds no label, every voxel is 0", where);
  }
  std::vector<int> numbers{0};
  numbers.insert(numbers.end(), found.begin(), found.end());
  return numbers;
}

/// Index of every voxel's label in `numbers`.
std::vector<std::uint8_t> indices_of(const Volume& labels, const std::vector<int>& numbers) {
  std::map<float, std::uint8_t> index_of;
  for (size_t i = 0; i < numbers.size(); ++i) {
    index_of[static_cast<float>(numbers[i])] = static_cast<std::uint8_t>(i);
  }
  std::vector<std::uint8_t> indices(labels.voxels());
  parallel_for(indices.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
    auto known = index_of.begin();  // neighbours mostly have the same label
    for (size_t i = begin; i < end; ++i) {
      const float value = labels.values[i];
      known = value == known->first ? known : index_of.find(value);
      indices[i] = known->second;
    }
  });
  return indices;
}

/// Nearest neighbour on the volume's grid; 0 outside of `labels`.
std::vector<std::uint8_t> resampled(const std::vector<std::uint8_t>& indices, const Volume& labels,
                                    const Volume& volume) {
  std::vector<std::uint8_t> result(volume.voxels(), 0);
  parallel_for(static_cast<size_t>(volume.dims.z), 1, [&](size_t slice, size_t) {
    const int z = static_cast<int>(slice);
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec3 there = labels.index_from_world(volume.world_from_index(Vec3(x, y, z)));
        const Vec3 nearest = glm::round(there);
        const bool inside = glm::all(glm::greaterThanEqual(nearest, Vec3(0))) &&
                            glm::all(glm::lessThan(nearest, Vec3(labels.dims)));
        if (inside) {
          const IVec3 at(nearest);
          result[volume.offset(x, y, z)] = indices[labels.offset(at.x, at.y, at.z)];
        }
      }
    }
  });
  return result;
}

}  // namespace

void add_labels(Volume& volume, const fs::path& path) {
  const Volume labels = read_labels(path);
  volume.label_numbers = find_numbers(labels, path.string());
  volume.labels = resampled(indices_of(labels, volume.label_numbers), labels, volume);
  if (std::ranges::count(volume.labels, 0) == static_cast<std::ptrdiff_t>(volume.voxels())) {
    throw Error(
        "{}: none of its labels lies within the volume; give a segmentation of the same scan, in "
        "the same patient space",
        path.string());
  }
}

}  // namespace clipgs
