#include "volume/prepare.h"

#include <algorithm>

#include "core/error.h"
#include "volume/bias_field.h"
#include "volume/crop.h"
#include "volume/denoise_values.h"
#include "volume/metal.h"

namespace clipgs {
namespace {

std::string size_text(const IVec3& dims) {
  return fmt::format("{} x {} x {}", dims.x, dims.y, dims.z);
}

PreparationStep crop_to(Volume& volume, const VoxelBox& box, const char* what,
                        const std::string& where) {
  const IVec3 before = volume.dims;
  const Box bounds = volume.bounds();
  const IVec3 dims = box.dims();
  if (std::min({dims.x, dims.y, dims.z}) < 2) {
    throw Error(
        "{}: --crop leaves {} voxels, at least 2 along every axis are needed; the volume reaches "
        "from {:.0f} to {:.0f} mm R, {:.0f} to {:.0f} A, {:.0f} to {:.0f} S",
        where, size_text(dims), bounds.min.x, bounds.max.x, bounds.min.y, bounds.max.y,
        bounds.min.z, bounds.max.z);
  }
  crop(volume, box);
  const VoxelValues::Range range = volume.values.range();
  if (range.min == range.max) {
    throw Error("{}: --crop leaves nothing but the value {}; take a box that holds matter", where,
                range.min);
  }
  warn(fmt::format("{}: cropped to {}, {} of {} voxels", where, what, size_text(volume.dims),
                   size_text(before)));
  const Box left = volume.bounds();
  return {"crop",
          {{"from_r_mm", left.min.x},
           {"to_r_mm", left.max.x},
           {"from_a_mm", left.min.y},
           {"to_a_mm", left.max.y},
           {"from_s_mm", left.min.z},
           {"to_s_mm", left.max.z}}};
}

PreparationStep even_out_bias(Volume& volume, const std::string& where) {
  if (volume.modality != Modality::kMr && volume.modality != Modality::kUnknown) {
    throw Error("{}: --bias is for MR, not for {}; leave it out", where,
                modality_name(volume.modality));
  }
  const BiasField field = correct_bias(volume, where);
  warn(fmt::format("{}: evened out a field of {:.2f} to {:.2f} (bias of the coils)", where,
                   field.least, field.most));
  return {"bias", {{"least", field.least}, {"most", field.most}}};
}

void keep_scanned(Volume& volume) {
  if (volume.scanned.empty()) {
    volume.scanned = volume.values;
  }
}

PreparationStep soften_streaks(Volume& volume, float least, const std::string& where) {
  if (volume.modality != Modality::kCt) {
    throw Error(
        "{}: --soften-metal is for CT; if this is CT give --modality ct, or --hu SCALE,OFFSET",
        where);
  }
  keep_scanned(volume);
  const MetalSoftening done = soften_metal(volume, least);
  warn(fmt::format(
      "{}: softened the streaks of {:.3g} ml of metal ({:.0f} HU or more) in {} slices; "
      "pictures look better for it, the data are not",
      where, done.metal_ml, least, done.slices));
  return {"metal", {{"least_hu", least}, {"metal_ml", done.metal_ml}, {"slices", done.slices}}};
}

PreparationStep average_noise(Volume& volume, float noise, const std::string& where) {
  if (!volume.rgb.empty()) {
    throw Error("{}: --denoise-volume is for values, and these are photographs; leave it out",
                where);
  }
  keep_scanned(volume);
  const float sigma = noise > 0 ? noise : estimate_noise(volume);
  if (sigma > 0) {
    denoise_values(volume, sigma);
  }
  warn(fmt::format("{}: averaged noise of {:.3g}{} away", where, sigma,
                   volume.modality == Modality::kCt ? " HU" : ""));
  return {"denoise", {{"sigma", sigma}}};
}

}  // namespace

void prepare(Volume& volume, const PrepareOptions& options, const std::string& where,
             std::vector<PreparationStep>& steps) {
  if (options.crop) {
    steps.push_back(crop_to(volume, voxels_within(volume, *options.crop), "a box", where));
  }
  if (options.crop_to_matter) {
    steps.push_back(crop_to(volume, voxels_of_matter(volume), "what is matter", where));
  }
  if (options.metal) {
    steps.push_back(soften_streaks(volume, *options.metal, where));
  }
  if (options.bias) {
    steps.push_back(even_out_bias(volume, where));
  }
  if (options.noise) {
    steps.push_back(average_noise(volume, *options.noise, where));
  }
}

}  // namespace clipgs
