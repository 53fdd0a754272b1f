#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volume/transfer_function.h"
#include "volume/volume.h"

namespace clipgs {

/// How the matter of a label differs from what the transfer function says of its values.
struct LabelLook {
  std::optional<Vec3> albedo;  ///< linear RGB instead of the transfer function's
  float opacity = 1;           ///< 0…1, a factor of the extinction; 0 hides the label

  Material applied_to(Material material) const {
    material.albedo = albedo.value_or(material.albedo);
    material.extinction *= opacity;
    return material;
  }
};

/// Looks by the labels' numbers; labels that are missing look as the transfer function says.
using LabelLooks = std::map<int, LabelLook>;

/// The looks in the order of volume.label_numbers; empty if the volume has no labels.
std::vector<LabelLook> looks_of_labels(const Volume& volume, const LabelLooks& looks);

/// A colour of its own for every label but 0.
LabelLooks label_palette(const std::vector<int>& numbers);

/// Parses "N=#rrggbb", "N=OPACITY", "N=#rrggbb,OPACITY" or "N=hidden". Throws Error.
std::pair<int, LabelLook> parse_label(const std::string& text);

/// Reads a JSON file of looks (docs/presets.md). Throws Error.
LabelLooks load_label_table(const std::filesystem::path& path);

}  // namespace clipgs
