#include "volume/image_file.h"

#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/letter_case.h"
#include "volume/header_text.h"
#include "volume/image_header.h"
#include "volume/inflater.h"
#include "volume/meta_header.h"
#include "volume/nifti_header.h"
#include "volume/nrrd_header.h"
#include "volume/voxel_file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostHeaderBytes = size_t{1} << 20;  // of text; lists of files are long

/// The first bytes of a file, unpacked if it is packed by gzip.
struct Beginning {
  std::vector<std::uint8_t> bytes;
  bool packed = false;
};

Beginning read_beginning(const fs::path& path, size_t most) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    throw Error("{}: no such file", path.string());
  }
  std::ifstream file(path, std::ios::binary);
  Beginning beginning;
  beginning.bytes.resize(most);
  file.read(reinterpret_cast<char*>(beginning.bytes.data()), static_cast<std::streamsize>(most));
  beginning.bytes.resize(static_cast<size_t>(file.gcount()));
  beginning.packed = begins_gzip(beginning.bytes);
  if (beginning.packed) {
    file.clear();
    file.seekg(0);
    Inflater inflater(file);
    beginning.bytes.resize(most);
    beginning.bytes.resize(inflater.read(beginning.bytes));
  }
  return beginning;
}

/// The file beside `path` with one of these extensions in place of its own, or "".
fs::path sibling(const fs::path& path, std::initializer_list<const char*> extensions) {
  fs::path stem = path;
  if (lower_case(stem.extension().string()) == ".gz") {
    stem.replace_extension();
  }
  std::error_code ignored;
  for (const char* extension : extensions) {
    fs::path other = stem;
    other.replace_extension();
    other += extension;
    if (fs::is_regular_file(other, ignored)) {
      return other;
    }
  }
  return {};
}

struct Opened {
  ImageHeader header;
  fs::path path;  // of the header
};

Opened open_nifti(const fs::path& given) {
  const std::string name = lower_case(given.filename().string());
  const bool image = name.ends_with(".img") || name.ends_with(".img.gz");
  const fs::path path = image ? sibling(given, {".hdr", ".hdr.gz"}) : given;
  if (path.empty()) {
    throw Error("{}: its header, the .hdr file beside it, is missing", given.string());
  }
  const Beginning beginning = read_beginning(path, kNiftiHeaderBytes);
  NiftiHeader nifti = parse_nifti_header(beginning.bytes, path.string());
  VoxelSource& source = nifti.image.source;
  bool packed = beginning.packed;
  if (nifti.detached) {
    const fs::path voxels = image ? given : sibling(path, {".img", ".img.gz"});
    if (voxels.empty()) {
      throw Error("{}: its voxels, the .img file beside it, are missing", path.string());
    }
    source.files = {voxels.filename().string()};
    packed = read_beginning(voxels, 2).packed;
  }
  source.encoding = packed ? VoxelSource::Encoding::kDeflate : VoxelSource::Encoding::kRaw;
  return {std::move(nifti.image), path};
}

Opened open_image(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  const auto is = [&](std::initializer_list<const char*> ends) {
    return std::ranges::any_of(ends, [&](const char* end) { return name.ends_with(end); });
  };
  if (is({".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"})) {
    return open_nifti(path);
  }
  const std::string where = path.string();
  if (is({".nrrd", ".nhdr"})) {
    return {parse_nrrd_header(read_beginning(path, kMostHeaderBytes).bytes, where), path};
  }
  if (is({".mha", ".mhd"})) {
    return {parse_meta_header(read_beginning(path, kMostHeaderBytes).bytes, where), path};
  }
  throw Error(
      "{}: unknown kind of volume; use a DICOM folder, .nii(.gz), .nrrd, .nhdr, .mha or .mhd",
      where);
}

VolumeSize volume_size(const ImageHeader& header) {
  return {.dims = header.dims,
          .stored_bytes = static_cast<int>(size_of(header.type)),
          .rgb = header.channels > 1,
          .spacing = Vec3(header.spacing)};
}

/// The header of a file that holds such a frame. Throws Error.
Opened open_frame(const fs::path& path, int frame) {
  Opened opened = open_image(path);
  const int frames = opened.header.frames;
  if (frame == 0 && frames > 1) {
    throw Error(
        "{}: a series of {} volumes; choose one with --frame 1 to {}, or store it as a 3D file",
        path.string(), frames, frames);
  }
  if (frame > frames) {
    throw Error("{}: no frame {}: it holds {}", path.string(), frame, frames);
  }
  return opened;
}

}  // namespace

VolumeSize image_file_size(const fs::path& path, int frame) {
  return volume_size(open_frame(path, frame).header);
}

StoredImage read_image_file(const fs::path& path, int frame, const SizeCheck& check) {
  const Opened opened = open_frame(path, frame);
  for (const std::string& warning : opened.header.warnings) {
    warn(warning);
  }
  if (check) {
    check(volume_size(opened.header));
  }
  StoredImage image = read_voxels(opened.header, opened.path, std::max(0, frame - 1));
  image.hints = opened.header.hints;
  return image;
}

}  // namespace clipgs
