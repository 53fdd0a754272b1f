#include "volume/surface_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "core/progress.h"
#include "volume/surface_flow_kernel.h"

namespace clipgs {
namespace {

// Chosen on a sphere, a torus and a face of known shape (docs/tried.md#surfaces).
constexpr size_t kRounds = 8;        // the means are put right before each
constexpr int kSteps = 10;           // of the flow, a round
constexpr int kSoftening = 3;        // steps of heat in the end, by a voxel or so
constexpr float kStep = 0.16f;       // of the squared finest spacing; 1/6 is the limit of heat
constexpr float kEvenRange = 6;      // noise levels: among 27 values of even matter the range is 4
constexpr float kSurfaceRange = 12;  // noise levels: from here on all flows
constexpr float kFaithful = 0.25f;   // of the range around a voxel: its mean may be off by so much
constexpr float kFalse = 0.4f;       // from here on it is as if nothing had flowed
constexpr size_t kBlockVoxels = size_t{kFlowBlock} * kFlowBlock * kFlowBlock;

/// Of scanned voxels.
using Field = std::vector<float>;

/// Standard deviation of the noise: of second differences along rows, by the lower quartile, which
/// edges do not move. Where all is the least value there is padding, not a scan.
float noise_level(const Volume& volume) {
  constexpr size_t kSamples = size_t{1} << 20;
  // Of its absolute value; that it is near 1/π means nothing.
  constexpr float kQuartileOfNormal = 0.3186f;  // NOLINT(modernize-use-std-numbers)
  const float padding = volume.values.range().min;
  std::vector<float> differences;
  for (size_t i = 1; i + 1 < volume.voxels(); i += volume.voxels() / kSamples + 1) {
    const std::array<float, 3> v = {volume.values[i - 1], volume.values[i], volume.values[i + 1]};
    if (*std::ranges::max_element(v) > padding) {
      differences.push_back(std::abs(v[0] - 2 * v[1] + v[2]));
    }
  }
  if (differences.empty()) {
    return 0;
  }
  const auto quartile = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 4);
  std::ranges::nth_element(differences, quartile);
  return *quartile / (kQuartileOfNormal * std::sqrt(6.0f));
}

/// Replaces each value by the least (or largest) of the 27 around it, without a second field.
template <typename Choose>
void choose_among_neighbours(Field& field, const IVec3& dims, const Choose& choose) {
  const auto width = static_cast<size_t>(dims.x);
  const size_t rows = field.size() / width;
  parallel_for(rows, 256, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      float* const values = &field[row * width];
      float before = values[0];
      for (size_t x = 0; x < width; ++x) {
        const float here = values[x];
        values[x] = choose(here, choose(before, values[std::min(x + 1, width - 1)]));
        before = here;
      }
    }
  });
  for (const int axis : {1, 2}) {
    const auto count = static_cast<size_t>(dims[axis]);
    const auto others = static_cast<size_t>(dims[3 - axis]);
    const size_t step = axis == 1 ? width : width * others;
    const size_t to_other = axis == 1 ? width * count : width;
    parallel_for(others, 1, [&](size_t other, size_t) {
      std::vector<float> before(&field[other * to_other], &field[other * to_other] + width);
      std::vector<float> here(width);
      for (size_t i = 0; i < count; ++i) {
        float* const row = &field[other * to_other + i * step];
        const float* const after = i + 1 < count ? row + step : row;
        std::copy_n(row, width, here.begin());
        for (size_t x = 0; x < width; ++x) {
          row[x] = choose(here[x], choose(before[x], after[x]));
        }
        before.swap(here);
      }
    });
  }
}

template <typename Choose>
VoxelValues chosen_among_neighbours(Field field, const IVec3& dims, const Choose& choose) {
  choose_among_neighbours(field, dims, choose);
  VoxelValues values(std::move(field));
  values.pack();
  return values;
}

/// Values on the fine grid that flow where the body has surfaces. This takes the most memory of a
/// case: fine voxels come when all that goes with scanned ones is in 16 bits or gone.
class SurfaceFlow {
 public:
  SurfaceFlow(const Volume& volume, const TransferFunction& transfer, const FineGrid& grids)
      : grids_(grids), scanned_(volume.values) {
    Field scanned(grids.coarse_count());  // read faster than values in 16 bits
    for_each_voxel(grids.coarse, [&](int x, int y, int z) {
      scanned[grids.coarse_at(x, y, z)] = volume.at(x, y, z);
    });
    least_ = chosen_among_neighbours(scanned, grids.coarse,
                                     [](float a, float b) { return std::min(a, b); });
    most_ = chosen_among_neighbours(scanned, grids.coarse,
                                    [](float a, float b) { return std::max(a, b); });
    find_surfaces(transfer, noise_level(volume));
    values_.resize(freedom_.size());
    for_each_voxel(grids.fine, [&](int x, int y, int z) {
      const size_t at = grids.fine_at(x, y, z);
      const float value = grids.interpolate(scanned, x, y, z);
      const float share = static_cast<float>(freedom_[at]) / 255;
      values_[at] =
          share == 0 ? value : glm::mix(value, grids.interpolate_smoothly(scanned, x, y, z), share);
    });
    find_blocks();
  }

  void run() {
    Progress progress("finer voxels", kRounds);
    for (size_t round = 0; round < kRounds; ++round) {
      keep_means();
      flow(Along::kLevelSets, kSteps);
      progress.update(round + 1);
    }
    flow(Along::kAll, kSoftening);
    keep_thin_things();
  }

  std::vector<float> take() {
    values_.resize(grids_.fine_count());
    return std::move(values_);
  }

 private:
  /// Where what is shown meets what is not, and values change by more than noise.
  void find_surfaces(const TransferFunction& transfer, float noise) {
    Field surface(scanned_.size());  // 0…1: how far each voxel is at one
    at_surface_.resize(scanned_.size());
    const float even = kEvenRange * noise;
    const float steep = std::max(kSurfaceRange * noise, std::numeric_limits<float>::min());
    parallel_for(scanned_.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const bool seen = !(transfer.min_extinction(least_[i], most_[i]) > 0) &&
                          transfer.max_extinction(least_[i], most_[i]) > 0;
        surface[i] = seen ? glm::smoothstep(even, steep, most_[i] - least_[i]) : 0;
        at_surface_[i] = surface[i] > 0 ? 1 : 0;
      }
    });
    freedom_.resize(grids_.fine_count() + kFlowBlock);
    for_each_voxel(grids_.fine, [&](int x, int y, int z) {
      freedom_[grids_.fine_at(x, y, z)] =
          static_cast<std::uint8_t>(std::lround(255 * grids_.interpolate(surface, x, y, z)));
    });
  }

  /// The blocks in which anything may flow. Voxels at the grid's sides have no neighbours beyond,
  /// and stay.
  void find_blocks() {
    const IVec3 count = (grids_.fine + kFlowBlock - 1) / kFlowBlock;
    for (int z = 0; z < count.z; ++z) {
      layers_.push_back(blocks_.size());
      for (int y = 0; y < count.y; ++y) {
        for (int x = 0; x < count.x; ++x) {
          const Block block{glm::max(kFlowBlock * IVec3(x, y, z), IVec3(1)),
                            glm::min(kFlowBlock * IVec3(x + 1, y + 1, z + 1), grids_.fine - 1)};
          if (glm::any(glm::lessThanEqual(block.end, block.begin))) {
            continue;
          }
          bool any = false;
          for_each_row(block, [&](size_t row, size_t) {
            const auto first = freedom_.begin() + static_cast<std::ptrdiff_t>(row);
            any = any || std::any_of(first, first + (block.end.x - block.begin.x),
                                     [](std::uint8_t freedom) { return freedom > 0; });
          });
          if (any) {
            blocks_.push_back(block);
          }
        }
      }
    }
    layers_.push_back(blocks_.size());
  }

  struct Block {
    IVec3 begin, end;
  };

  /// Calls use(first fine voxel of the row, its place in a block's storage).
  template <typename Use>
  void for_each_row(const Block& block, const Use& use) const {
    size_t place = 0;
    for (int z = block.begin.z; z < block.end.z; ++z) {
      for (int y = block.begin.y; y < block.end.y; ++y, place += kFlowBlock) {
        use(grids_.fine_at(block.begin.x, y, z), place);
      }
    }
  }

  /// The scan between its voxels: straight within matter, without kinks at surfaces.
  float interpolated(int x, int y, int z) const {
    const float straight = grids_.interpolate(scanned_, x, y, z);
    const std::uint8_t freedom = freedom_[grids_.fine_at(x, y, z)];
    return freedom == 0
               ? straight
               : glm::mix(straight,
                          in_range(grids_.interpolate_smoothly(scanned_, x, y, z), x, y, z),
                          static_cast<float>(freedom) / 255);
  }

  /// The value, or the nearest that the scanned ones around it span.
  float in_range(float value, int x, int y, int z) const {
    return std::clamp(value, grids_.interpolate(least_, x, y, z),
                      grids_.interpolate(most_, x, y, z));
  }

  /// Mean of the fine values over a scanned voxel: half of it reaches to either side.
  float mean_over(int x, int y, int z) const {
    const IVec3 centre = IVec3(x, y, z) * grids_.factors;
    const IVec3 reach = grids_.factors / 2;
    const IVec3 low = glm::max(centre - reach, IVec3(0));
    const IVec3 high = glm::min(centre + reach, grids_.fine - 1);
    // The outermost of an even number are shared with the neighbour.
    const auto weight = [&](int axis, int i) {
      const bool shared =
          grids_.factors[axis] % 2 == 0 && std::abs(i - centre[axis]) == reach[axis];
      return shared ? 0.5f : 1.0f;
    };
    float sum = 0;
    float weights = 0;
    for (int k = low.z; k <= high.z; ++k) {
      for (int j = low.y; j <= high.y; ++j) {
        for (int i = low.x; i <= high.x; ++i) {
          const float w = weight(0, i) * weight(1, j) * weight(2, k);
          sum += w * values_[grids_.fine_at(i, j, k)];
          weights += w;
        }
      }
    }
    return sum / weights;
  }

  /// What is missing in the mean of every scanned voxel at a surface.
  Field missing() const {
    Field missing(scanned_.size());
    for_each_voxel(grids_.coarse, [&](int x, int y, int z) {
      const size_t at = grids_.coarse_at(x, y, z);
      missing[at] = at_surface_[at] != 0 ? scanned_[at] - mean_over(x, y, z) : 0;
    });
    return missing;
  }

  /// Calls use(x, y, z) for every voxel that may flow, blocks in parallel.
  template <typename Use>
  void for_each_free(const Use& use) const {
    parallel_for(blocks_.size(), 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto& [low, high] = blocks_[i];
        for (int z = low.z; z < high.z; ++z) {
          for (int y = low.y; y < high.y; ++y) {
            for (int x = low.x; x < high.x; ++x) {
              if (freedom_[grids_.fine_at(x, y, z)] > 0) {
                use(x, y, z);
              }
            }
          }
        }
      }
    });
  }

  /// Gives back to every scanned voxel the mean that was measured.
  void keep_means() {
    const Field field = missing();
    for_each_free([&](int x, int y, int z) { give_back(field, x, y, z); });
  }

  /// Thin things (vessels, lids) vanish by their curvature; there the interpolated scan stays.
  void keep_thin_things() {
    Field lost = missing();
    for (size_t i = 0; i < lost.size(); ++i) {
      lost[i] = at_surface_[i] != 0
                    ? glm::smoothstep(kFaithful, kFalse, std::abs(lost[i]) / (most_[i] - least_[i]))
                    : 0;
    }
    choose_among_neighbours(lost, grids_.coarse, [](float a, float b) { return std::max(a, b); });
    for_each_free([&](int x, int y, int z) {
      const float share = grids_.interpolate(lost, x, y, z);
      if (share > 0) {
        float& value = values_[grids_.fine_at(x, y, z)];
        value = glm::mix(value, interpolated(x, y, z), share);
      }
    });
  }

  void give_back(const Field& missing, int x, int y, int z) {
    const size_t at = grids_.fine_at(x, y, z);
    const float share = static_cast<float>(freedom_[at]) / 255;
    values_[at] = in_range(values_[at] + share * grids_.interpolate(missing, x, y, z), x, y, z);
  }

  enum class Along {
    kLevelSets,  ///< ∂v/∂t = Δv − ∂²v/∂n², n the gradient's direction: twice their mean curvature
    kAll,        ///< ∂v/∂t = Δv: a surface is as steep wherever it passes between scanned voxels
  };

  /// Values of two layers of blocks.
  using Layers = std::array<std::vector<float>, 2>;

  /// So many explicit steps.
  void flow(Along along, int steps) {
    const Vec3& spacing = grids_.spacing;
    const float finest = std::min({spacing.x, spacing.y, spacing.z});
    const std::ptrdiff_t across = grids_.fine.x;
    const FlowStep step{across,
                        across * grids_.fine.y,
                        0.5f / spacing,
                        1.0f / (spacing * spacing),
                        kStep * finest * finest / 255,
                        along == Along::kLevelSets ? 1.0f : 0.0f};
    Layers next;
    for (std::vector<float>& layer : next) {
      layer.resize(largest_layer() * kBlockVoxels);
    }
    for (int i = 0; i < steps; ++i) {
      // Layer by layer: what a layer has been is needed until the one above has flowed.
      for (size_t layer = 0; layer + 1 < layers_.size(); ++layer) {
        flow(step, layer, next[layer % 2]);
        if (layer > 0) {
          put_back(layer - 1, next[(layer - 1) % 2]);
        }
      }
      put_back(layers_.size() - 2, next[layers_.size() % 2]);
    }
  }

  void flow(const FlowStep& step, size_t layer, std::vector<float>& next) {
    const size_t from = layers_[layer];
    parallel_for(layers_[layer + 1] - from, 8, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto& [first, last] = blocks_[from + i];
        const size_t at = grids_.fine_at(first.x, first.y, first.z);
        flow_block(step, &values_[at], &freedom_[at], last - first, &next[i * kBlockVoxels]);
      }
    });
  }

  void put_back(size_t layer, const std::vector<float>& next) {
    const size_t from = layers_[layer];
    parallel_for(layers_[layer + 1] - from, 32, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Block& block = blocks_[from + i];
        const int width = block.end.x - block.begin.x;
        for_each_row(block, [&](size_t row, size_t place) {
          std::copy_n(&next[i * kBlockVoxels + place], width, &values_[row]);
        });
      }
    });
  }

  size_t largest_layer() const {
    size_t most = 0;
    for (size_t layer = 0; layer + 1 < layers_.size(); ++layer) {
      most = std::max(most, layers_[layer + 1] - layers_[layer]);
    }
    return most;
  }

  const FineGrid& grids_;
  const VoxelValues& scanned_;
  VoxelValues least_, most_;
  std::vector<std::uint8_t> at_surface_;  // of scanned voxels: whether anything there may flow
  std::vector<float> values_;          // of fine voxels, and as many as flow_block() reads beyond
  std::vector<std::uint8_t> freedom_;  // of those: 255 may flow, 0 stay
  std::vector<Block> blocks_;
  std::vector<size_t> layers_;  // where in blocks_ each layer across z begins; the end
};

}  // namespace

std::vector<float> flow_surfaces(const Volume& volume, const TransferFunction& transfer,
                                 const FineGrid& grid) {
  SurfaceFlow flow(volume, transfer, grid);
  flow.run();
  return flow.take();
}

}  // namespace clipgs
