#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "section/section.h"

namespace clipgs {

/// A section's materials over its values, evenly: looked up without a search through the curve.
class MaterialTable {
 public:
  static constexpr size_t kEntries = 2048;

  explicit MaterialTable(const Section& section);

  size_t entry_of(float value) const {
    const float at = (value - low_) * entries_per_value_ + 0.5f;
    return std::min(static_cast<size_t>(std::max(at, 0.0f)), kEntries - 1);
  }
  const FaceMaterial& operator[](size_t entry) const { return materials_[entry]; }
  const FaceMaterial& of_value(float value) const { return materials_[entry_of(value)]; }
  float code(size_t entry) const { return codes_[entry]; }

 private:
  float low_;  // value of the first entry
  float entries_per_value_;
  std::vector<float> codes_;
  std::vector<FaceMaterial> materials_;
};

}  // namespace clipgs
