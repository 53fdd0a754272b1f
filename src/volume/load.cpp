#include "volume/load.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/memory.h"
#include "volume/dicom_study.h"
#include "volume/identify.h"
#include "volume/image_file.h"
#include "volume/isolate_body.h"
#include "volume/orient.h"
#include "volume/padding.h"
#include "volume/segmentation.h"
#include "volume/shows_table.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

void fill_luminance(Volume& volume) {
  volume.modality = Modality::kPhoto;
  std::vector<float> values(volume.voxels());
  for (size_t i = 0; i < values.size(); ++i) {
    const std::uint8_t* rgb = &volume.rgb[3 * i];
    values[i] = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  }
  volume.values = std::move(values);
}

/// Files carry no modality: values far below zero, where only air can be, mean Hounsfield units.
Modality guess_modality(float min, float max) {
  return min <= -500 && min >= -4096 && max > 0 && max < 32768 ? Modality::kCt : Modality::kUnknown;
}

/// Throws unless all values are finite, and so are their differences, and not all are the same.
VoxelValues::Range checked_range(const Volume& volume, const std::string& where) {
  if (!std::ranges::all_of(volume.values.all(), [](float v) { return std::isfinite(v); })) {
    throw Error("{}: holds voxels that are not finite numbers (NaN or infinity); replace them",
                where);
  }
  const VoxelValues::Range range = volume.values.range();
  if (!std::isfinite(range.max - range.min)) {
    throw Error(
        "{}: its values go from {:g} to {:g}, further than single precision does; rescale them",
        where, range.min, range.max);
  }
  if (range.min == range.max) {
    throw Error("{}: every voxel has the value {}: there is nothing to show", where, range.min);
  }
  return range;
}

void take_padding_off(Volume& volume, const std::string& where,
                      std::vector<PreparationStep>& steps) {
  if (const std::optional<Padding> padding = remove_padding(volume)) {
    const double percent =
        100 * static_cast<double>(padding->voxels) / static_cast<double>(volume.voxels());
    warn(
        fmt::format("{}: {:.1f} % of the voxels have the value {} outside the picture; they are "
                    "taken for {}",
                    where, percent, padding->value,
                    volume.values.range().min <= kAirHu ? "air" : "background"));
    steps.push_back({"padding", {{"value", padding->value}, {"percent", percent}}});
  }
}

void clamp_outside_of_scan(Volume& volume) {
  volume.values.transform([](float value) { return std::max(value, kAirHu); });
}

void take_table_off(Volume& volume, const std::string& where, std::vector<PreparationStep>& steps) {
  constexpr double kWorthSaying = 1;  // ml
  const Isolation isolation = isolate_body(volume);
  if (isolation.removed >= kWorthSaying) {
    warn(fmt::format(
        "{}: took {:.0f} ml of table, cushions and the like off (--keep-table leaves them)", where,
        isolation.removed));
    steps.push_back({"table", {{"removed_ml", isolation.removed}}});
  }
  if (isolation.foreign >= kWorthSaying) {
    warn(
        fmt::format("{}: at least {:.0f} ml of something solid without fat lies beside the body, a "
                    "head holder or the "
                    "like; it is left in the pictures: cut it off with a plane, or crop the volume",
                    where, isolation.foreign));
  }
  if (isolation.unsure) {
    warn(fmt::format(
        "{}: the table cannot be told from the body, what lies beside it is more than a third of "
        "all; nothing was taken off: crop the volume if a table shows",
        where));
  }
}

void take_face_off(LoadedVolume& loaded, const LoadOptions& options, const std::string& where) {
  Volume& volume = loaded.volume;
  if (options.watch_deface) {
    options.watch_deface(volume);
  }
  loaded.face = deface(volume, where);
  const auto [removed, from_brain] = *volume.defaced;
  warn(fmt::format(
      "{}: took {:.0f} ml of face and ears off, nothing within {} mm of the brain; look at what is "
      "left before you give it away",
      where, removed, from_brain));
  loaded.prepared.push_back({"deface", {{"removed_ml", removed}, {"brain_mm", from_brain}}});
  if (options.watch_deface) {
    options.watch_deface(volume);
  }
}

void warn_of_face(const Volume& volume, const std::string& where) {
  if (shows_face(volume)) {
    warn(
        fmt::format("{}: this is a head with a face: whoever knows the person may recognise it; "
                    "--deface removes it",
                    where));
  }
}

/// HU of another scale look like CT, but no preset of CT fits them.
void warn_of_units(const Volume& volume, const std::string& where) {
  const std::optional<Rescale> hu = likely_rescale(volume);
  if (hu) {
    warn(fmt::format(
        "{}: its values gather as CT's do, but are no HU; if this is CT give --hu {:.3g},{:.0f}",
        where, hu->scale, hu->offset));
  }
}

void warn_of_table(const Volume& volume, const std::string& where) {
  if (shows_table(volume)) {
    warn(fmt::format(
        "{}: its kind is unknown, and what looks like a scanner's table lies beside the body; if "
        "this is CT give --hu SCALE,OFFSET (HU = SCALE * stored + OFFSET) to have it taken off",
        where));
  }
}

/// Throws Error where the user says of the image what cannot be.
void require_possible(const StoredImage& stored, const LoadOptions& options,
                      const std::string& where) {
  const Modality said = options.modality;
  if (said == Modality::kUnknown) {
    return;
  }
  if (!stored.rgb.empty() && said != Modality::kPhoto) {
    throw Error("{}: has colours, as photographs do; leave --modality out", where);
  }
  if (stored.rgb.empty() && said == Modality::kPhoto) {
    throw Error("{}: has one value a voxel, photographs have colours; give another --modality",
                where);
  }
  if (options.hu && said != Modality::kCt) {
    throw Error("{}: --hu makes it CT, --modality does not; leave one of them out", where);
  }
  if (stored.eight_bit && said == Modality::kCt && !options.hu) {
    throw Error(
        "{}: 8-bit values are no HU; with --modality ct give --hu SCALE,OFFSET (HU = SCALE * "
        "stored + OFFSET)",
        where);
  }
}

/// What the user says, or else the header.
BodyPart said_part(const Hints& hints, const LoadOptions& options) {
  return options.part != BodyPart::kUnknown ? options.part : hints.part;
}

/// What the user says, or else the header. Of CT, 8 bits hold no HU.
Modality said_modality(const StoredImage& stored, const LoadOptions& options) {
  if (options.hu) {
    return Modality::kCt;
  }
  if (options.modality != Modality::kUnknown) {
    return options.modality;
  }
  const Modality header = stored.hints.modality;
  return header == Modality::kCt && stored.eight_bit ? Modality::kUnknown : header;
}

/// Throws Error, or warns, where drawing a volume takes more than `available` bytes of memory.
void require_memory(VolumeSize size, std::uint64_t available, const LoadOptions& options,
                    const std::string& where) {
  if (!options.work) {
    return;
  }
  size.labels = !options.labels.empty();
  size.scanned = options.prepare.keeps_scanned();
  const std::string lack = lack_of_memory(size, options.work(size), available);
  if (!lack.empty() && !options.warn_of_size) {
    throw Error("{}: {}", where, lack);
  }
  if (!lack.empty()) {
    warn(fmt::format("{}: to draw it, {}", where, lack));
  }
}

/// Of the volume itself; that of its labels is part of it.
SizeCheck size_check(const LoadOptions& options, const std::string& where) {
  return [&options, where](const VolumeSize& size) {
    require_supported(size, where);
    require_memory(size, available_memory(), options, where);
  };
}

/// What a crop leaves may be drawn with finer voxels than the whole, and take more memory.
void check_cropped(const Volume& volume, const LoadOptions& options, const std::string& where) {
  const VolumeSize size{.dims = volume.dims,
                        .stored_bytes = volume.values.packed() ? 2 : 4,
                        .rgb = !volume.rgb.empty(),
                        .scanned = !volume.scanned.empty(),
                        .spacing = volume.spacing};
  const std::uint64_t left = available_memory();
  require_memory(size, std::max(left, left + size.loaded()), options, where);  // no wrapping round
}

/// Everything between an image as stored and a volume that can be trusted and traced.
LoadedVolume make_volume(StoredImage stored, const LoadOptions& options, const std::string& where) {
  require_possible(stored, options, where);
  const Modality modality = said_modality(stored, options);
  const Hints hints = stored.hints;
  LoadedVolume loaded;
  Volume& volume = loaded.volume = oriented(std::move(stored), where);
  volume.modality = modality;
  volume.hints = hints;
  if (!volume.rgb.empty()) {
    fill_luminance(volume);
  } else if (options.hu) {
    const Rescale hu = *options.hu;
    volume.values.transform([hu](float value) { return value * hu.scale + hu.offset; });
  }
  VoxelValues::Range range = checked_range(volume, where);
  if (volume.rgb.empty()) {
    take_padding_off(volume, where, loaded.prepared);
    range = checked_range(volume, where);
  }
  if (volume.modality == Modality::kUnknown) {
    volume.modality = guess_modality(range.min, range.max);
  }
  warn_of_units(volume, where);
  if (volume.modality == Modality::kCt) {
    clamp_outside_of_scan(volume);
    if (!options.keep_table) {
      take_table_off(volume, where, loaded.prepared);
    }
  } else if (volume.modality == Modality::kUnknown && !options.keep_table) {
    warn_of_table(volume, where);
  }
  volume.part = said_part(hints, options);
  if (options.deface) {
    take_face_off(loaded, options, where);
  } else if (options.warn_of_face) {
    warn_of_face(volume, where);
  }
  prepare(volume, options.prepare, where, loaded.prepared);
  if (options.prepare.crops()) {
    check_cropped(volume, options, where);
  }
  if (volume.part == BodyPart::kUnknown) {
    volume.part = seen_part(volume);
  }
  return loaded;
}

std::vector<SeriesInfo> choices_of(const DicomStudy& study, size_t chosen) {
  std::vector<SeriesInfo> list;
  for (size_t i = 0; i < study.stacks.size(); ++i) {
    const DicomStack& stack = study.stacks[i];
    const DicomHeader& first = stack.slices.front();
    const auto slices = static_cast<int>(stack.slices.size());
    list.push_back({stack.uid, stack.modality, stack.series_number, stack.phase,
                    IVec3(first.columns, first.rows, slices), i == chosen});
  }
  return list;
}

LoadedVolume load_dicom(const DicomStudy& study, const LoadOptions& options) {
  const size_t chosen = choose_stack(study, options.series);
  const DicomStack& stack = study.stacks[chosen];
  const Modality modality = stack.slices.front().hints.modality;
  if (options.modality != Modality::kUnknown && modality != Modality::kUnknown &&
      options.modality != modality) {
    throw Error("{}: its header says {}; leave --modality out, or choose another --series",
                study.where, modality_name(modality));
  }
  const bool ct = modality == Modality::kCt || options.modality == Modality::kCt;
  const float fill = ct ? kAirHu : 0.0f;
  LoadedVolume loaded = make_volume(
      read_stack(stack, fill, options.gaps, study.where, size_check(options, study.where)), options,
      study.where);
  loaded.series = choices_of(study, chosen);
  return loaded;
}

/// Whether the path is one of DICOM; throws Error if there is nothing, or nothing that `options`
/// fit.
bool is_given_as_dicom(const fs::path& path, const LoadOptions& options) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw Error("{}: no such file or folder", path.string());
  }
  const bool dicom = is_dicom(path);
  if (dicom && options.frame != 0) {
    throw Error("{}: --frame picks a volume of a 4D file; for DICOM give --series", path.string());
  }
  return dicom;
}

VolumeSize stored_size(const fs::path& path, const LoadOptions& options) {
  if (!is_given_as_dicom(path, options)) {
    return image_file_size(path, options.frame);
  }
  const DicomStudy study = open_study(path);
  return stack_size(study.stacks[choose_stack(study, options.series)], options.gaps, study.where);
}

LoadedVolume load_values(const fs::path& path, const LoadOptions& options) {
  const std::string where = path.string();
  if (is_given_as_dicom(path, options)) {
    return load_dicom(open_study(path), options);
  }
  return make_volume(read_image_file(path, options.frame, size_check(options, where)), options,
                     where);
}

}  // namespace

VolumeSize volume_size(const fs::path& path, const LoadOptions& options) {
  VolumeSize size = stored_size(path, options);
  size.labels = !options.labels.empty();
  size.scanned = options.prepare.keeps_scanned();
  return size;
}

LoadedVolume load_with_series(const fs::path& path, const LoadOptions& options) {
  LoadedVolume loaded = load_values(path, options);
  if (!options.labels.empty()) {
    add_labels(loaded.volume, options.labels);
    if (loaded.face) {
      deface_labels(loaded.volume, *loaded.face);
    }
  }
  return loaded;
}

Volume load_volume(const fs::path& path, const LoadOptions& options) {
  return load_with_series(path, options).volume;
}

}  // namespace clipgs
