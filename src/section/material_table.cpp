#include "section/material_table.h"

namespace clipgs {

MaterialTable::MaterialTable(const Section& section)
    : low_(section.curve.values().front()),
      entries_per_value_((kEntries - 1) / (section.curve.values().back() - low_)) {
  for (size_t i = 0; i < kEntries; ++i) {
    const float code = section.curve.code(low_ + static_cast<float>(i) / entries_per_value_);
    const size_t low = std::min(static_cast<size_t>(code), ValueCurve::kCodes - 2);
    codes_.push_back(code);
    materials_.push_back(
        mix(section.materials[low], section.materials[low + 1], code - static_cast<float>(low)));
  }
}

}  // namespace clipgs
