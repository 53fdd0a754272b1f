#include "cinema/environment_map.h"

#include <algorithm>
#include <cmath>

#include "core/geometry.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr int kSide = EnvironmentMap::kSide;
constexpr int kTexels = kSide * kSide;
constexpr int kBlock = 8;       // texels along a block whose light is summed up for faces
constexpr int kSubsamples = 4;  // along a texel, of the panorama

// Nearest pixel: the subsamples average.
Vec3 look_up(const Image& panorama, const Vec3& world, float turn) {
  // Anterior (+y) in the middle, the patient's right (+x) to the left of it: the view from inside.
  const float longitude = std::atan2(-world.x, world.y) + turn;
  const float across = longitude / (2 * kPi) + 0.5f;
  const float down = std::acos(std::clamp(world.z, -1.0f, 1.0f)) / kPi;
  const int x =
      static_cast<int>((across - std::floor(across)) * static_cast<float>(panorama.width));
  const int y = static_cast<int>(down * static_cast<float>(panorama.height));
  const float* pixel =
      panorama.at(std::min(x, panorama.width - 1), std::min(y, panorama.height - 1));
  return {pixel[0], pixel[1], pixel[2]};
}

float sum_of(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

size_t texel(const Vec2& at) {
  const int x = std::min(static_cast<int>(at.x * kSide), kSide - 1);
  const int y = std::min(static_cast<int>(at.y * kSide), kSide - 1);
  return static_cast<size_t>(y) * kSide + static_cast<size_t>(x);
}

}  // namespace

Vec2 EnvironmentMap::square_from_direction(const Vec3& direction) {
  const Vec3 p = direction / sum_of(direction);
  Vec2 at(p.x, p.y);
  if (p.z < 0) {  // the lower half folds outwards
    at = Vec2(std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y));
  }
  return 0.5f * at + 0.5f;
}

Vec3 EnvironmentMap::direction_from_square(const Vec2& at) {
  Vec3 p(2 * at.x - 1, 2 * at.y - 1, 0);
  p.z = 1 - std::abs(p.x) - std::abs(p.y);
  if (p.z < 0) {
    p = Vec3(std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y), p.z);
  }
  return glm::normalize(p);
}

EnvironmentMap::EnvironmentMap(const Image& panorama, float turn, const Mat3& frame_from_world) {
  for (std::vector<float>& channel : tables_.radiance) {
    channel.resize(kTexels);
  }
  const Mat3 world_from_frame = glm::transpose(frame_from_world);
  parallel_for(kSide, 4, [&](size_t begin, size_t end) {
    constexpr int kFine = kSide * kSubsamples;
    for (size_t y = begin; y < end; ++y) {
      for (size_t x = 0; x < kSide; ++x) {
        Vec3 sum(0);
        for (size_t i = 0; i < size_t{kSubsamples} * kSubsamples; ++i) {
          const size_t column = x * kSubsamples + i % kSubsamples;
          const size_t row = y * kSubsamples + i / kSubsamples;
          const Vec2 at((static_cast<float>(column) + 0.5f) / kFine,
                        (static_cast<float>(row) + 0.5f) / kFine);
          sum += look_up(panorama, world_from_frame * direction_from_square(at), turn);
        }
        for (int c = 0; c < 3; ++c) {
          tables_.radiance[static_cast<size_t>(c)][y * kSide + x] =
              sum[c] / (kSubsamples * kSubsamples);
        }
      }
    }
  });

  // dω = 4·(|x| + |y| + |z|)³·d(square): the octahedron's faces all have the same distance.
  constexpr int kBlocks = kSide / kBlock;
  flux_.resize(size_t{kBlocks} * kBlocks);
  std::vector<double> power(kTexels);
  for (int i = 0; i < kTexels; ++i) {
    const int x = i % kSide;
    const int y = i / kSide;
    const Vec3 direction = direction_from_square((Vec2(x, y) + 0.5f) / static_cast<float>(kSide));
    const float angle = 4 * std::pow(sum_of(direction), 3.0f) / kTexels;
    const Vec3 light = radiance(direction);
    std::array<Vec3, 3>& block =
        flux_[static_cast<size_t>(y / kBlock) * kBlocks + static_cast<size_t>(x / kBlock)];
    for (int c = 0; c < 3; ++c) {
      block[static_cast<size_t>(c)] += light[c] * angle * direction;
    }
    power[static_cast<size_t>(i)] = static_cast<double>(light.x + light.y + light.z) * angle;
  }
  make_alias_table(power);
}

// Vose 1991: texels below the mean are filled up from those above it.
void EnvironmentMap::make_alias_table(const std::vector<double>& power) {
  double sum = 0;
  for (const double p : power) {
    sum += p;
  }
  tables_.density.resize(kTexels);
  tables_.keep.assign(kTexels, 1.0f);
  tables_.alias.resize(kTexels);
  std::vector<double> left(kTexels);
  std::vector<int> poor;
  std::vector<int> rich;
  for (int i = 0; i < kTexels; ++i) {
    const auto at = static_cast<size_t>(i);
    left[at] = sum > 0 ? power[at] / sum * kTexels : 1.0;
    tables_.density[at] = static_cast<float>(left[at] / 4);  // P·texels/4
    tables_.alias[at] = i;
    (left[at] < 1 ? poor : rich).push_back(i);
  }
  while (!poor.empty() && !rich.empty()) {
    const auto from = static_cast<size_t>(rich.back());
    const auto to = static_cast<size_t>(poor.back());
    poor.pop_back();
    tables_.keep[to] = static_cast<float>(left[to]);
    tables_.alias[to] = rich.back();
    left[from] -= 1 - left[to];
    if (left[from] < 1) {
      rich.pop_back();
      poor.push_back(static_cast<int>(from));
    }
  }
}

Vec3 EnvironmentMap::radiance(const Vec3& direction) const {
  const size_t at = texel(square_from_direction(direction));
  return {tables_.radiance[0][at], tables_.radiance[1][at], tables_.radiance[2][at]};
}

Vec3 EnvironmentMap::face_radiance(const Vec3& normal) const {
  Vec3 sum(0);
  for (const std::array<Vec3, 3>& block : flux_) {
    for (int c = 0; c < 3; ++c) {
      sum[c] += std::max(0.0f, glm::dot(normal, block[static_cast<size_t>(c)]));
    }
  }
  return sum / kPi;
}

}  // namespace clipgs
