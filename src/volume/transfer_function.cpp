#include "volume/transfer_function.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"

namespace clipgs {
namespace {

void check(const TransferPoint& point) {
  const Material& m = point.material;
  const auto in_unit = [](float x) { return x >= 0 && x <= 1; };  // false for NaN
  if (!std::isfinite(point.value)) {
    throw Error("transfer function: a point's value is not a finite number");
  }
  if (!std::isfinite(m.extinction) || m.extinction < 0) {
    throw Error("transfer function: extinction at value {} must be a finite number >= 0",
                point.value);
  }
  if (!in_unit(m.albedo.x) || !in_unit(m.albedo.y) || !in_unit(m.albedo.z)) {
    throw Error("transfer function: colour at value {} must lie in 0..1", point.value);
  }
  if (!in_unit(m.specular) || !in_unit(m.roughness) || m.roughness == 0) {
    throw Error(
        "transfer function: specular at value {} must lie in 0..1 and roughness above 0 up to 1",
        point.value);
  }
  if (!(std::abs(m.phase) < 1)) {
    throw Error("transfer function: phase at value {} must lie between -1 and 1", point.value);
  }
}

Material mix(const Material& a, const Material& b, float t) {
  return {glm::mix(a.albedo, b.albedo, t), glm::mix(a.extinction, b.extinction, t),
          glm::mix(a.specular, b.specular, t), glm::mix(a.roughness, b.roughness, t),
          glm::mix(a.phase, b.phase, t)};
}

// Level k of the result holds pick over the 2^k entries that start at each index.
template <typename Pick>
std::vector<std::vector<float>> sparse_table(std::vector<float> level0, const Pick& pick) {
  std::vector<std::vector<float>> levels;
  levels.push_back(std::move(level0));
  for (size_t half = 1; 2 * half <= levels[0].size(); half *= 2) {
    const std::vector<float>& below = levels.back();
    std::vector<float> level(below.size() - half);
    for (size_t i = 0; i < level.size(); ++i) {
      level[i] = pick(below[i], below[i + half]);
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

template <typename Pick>
float query(const std::vector<std::vector<float>>& levels, int first, int last, const Pick& pick) {
  const auto count = static_cast<unsigned>(last - first + 1);
  const auto k = static_cast<size_t>(std::bit_width(std::max(count, 1U))) - 1;
  return pick(levels[k][static_cast<size_t>(first)],
              levels[k][static_cast<size_t>(last) + 1 - (size_t{1} << k)]);
}

constexpr auto kLarger = [](float a, float b) { return std::max(a, b); };
constexpr auto kSmaller = [](float a, float b) { return std::min(a, b); };

}  // namespace

TransferFunction::TransferFunction(std::vector<TransferPoint> points) : points_(std::move(points)) {
  if (points_.empty()) {
    throw Error("transfer function: at least one point is needed");
  }
  std::ranges::for_each(points_, check);
  std::ranges::stable_sort(
      points_, [](const TransferPoint& a, const TransferPoint& b) { return a.value < b.value; });
  min_value_ = points_.front().value;
  max_value_ = points_.back().value;
  const float range = max_value_ - min_value_;
  scale_ = range > 0 ? (kTableSize - 1) / range : 0;

  table_.resize(kTableSize);
  std::vector<float> extinctions(kTableSize);
  size_t right = 1;  // the first point beyond the entry's value
  for (int i = 0; i < kTableSize; ++i) {
    const float value = min_value_ + range * static_cast<float>(i) / (kTableSize - 1);
    while (right < points_.size() && points_[right].value <= value) {
      ++right;
    }
    const TransferPoint& a = points_[right - 1];
    if (right == points_.size()) {
      table_[i] = a.material;
    } else {
      const TransferPoint& b = points_[right];
      table_[i] = mix(a.material, b.material, (value - a.value) / (b.value - a.value));
    }
    extinctions[i] = table_[i].extinction;
  }
  max_levels_ = sparse_table(extinctions, kLarger);
  min_levels_ = sparse_table(std::move(extinctions), kSmaller);
}

float TransferFunction::max_extinction(float low, float high) const {
  return query(max_levels_, index(low), index(high), kLarger);
}

float TransferFunction::min_extinction(float low, float high) const {
  return query(min_levels_, index(low), index(high), kSmaller);
}

}  // namespace clipgs
