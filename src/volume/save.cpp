#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>
#include <zlib.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"

// The three headers are written here rather than through ITK: they are short, and so a file is made
// in memory and lands on the disk whole or not at all.

namespace clipgs {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

using Bytes = std::vector<std::uint8_t>;

/// HU are whole numbers in nearly all scans: 16-bit integers then hold them exactly.
bool fits_int16(const Volume& volume) {
  return std::ranges::all_of(volume.values.all(), [](float v) {
    return v == std::round(v) && v >= std::numeric_limits<std::int16_t>::min() &&
           v <= std::numeric_limits<std::int16_t>::max();
  });
}

Bytes voxel_bytes(const Volume& volume, bool int16) {
  if (!int16) {
    Bytes bytes(volume.values.size() * sizeof(float));
    for (size_t i = 0; i < volume.values.size(); ++i) {
      const float value = volume.values[i];
      std::memcpy(&bytes[i * sizeof value], &value, sizeof value);
    }
    return bytes;
  }
  Bytes bytes(volume.values.size() * sizeof(std::int16_t));
  for (size_t i = 0; i < volume.values.size(); ++i) {
    const auto value = static_cast<std::int16_t>(volume.values[i]);
    std::memcpy(&bytes[i * sizeof value], &value, sizeof value);
  }
  return bytes;
}

Bytes gzip(const Bytes& data) {
  constexpr int kGzipWindow = 15 + 16;  // zlib: 16 more asks for a gzip header
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  Bytes packed(deflateBound(&stream, data.size()));
  size_t in = 0;
  size_t out = 0;
  int status = Z_OK;
  while (status == Z_OK) {  // zlib counts in 32 bits: go on in pieces
    constexpr size_t kPiece = size_t{1} << 30;
    const size_t in_piece = std::min(kPiece, data.size() - in);
    const size_t out_piece = std::min(kPiece, packed.size() - out);
    stream.next_in = const_cast<Bytef*>(data.data() + in);
    stream.avail_in = static_cast<uInt>(in_piece);
    stream.next_out = packed.data() + out;
    stream.avail_out = static_cast<uInt>(out_piece);
    status = deflate(&stream, in + in_piece == data.size() ? Z_FINISH : Z_NO_FLUSH);
    in += in_piece - stream.avail_in;
    out += out_piece - stream.avail_out;
  }
  deflateEnd(&stream);
  packed.resize(out);
  return packed;
}

void append(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// NIfTI-1 (nifti1.h): 348 bytes, 4 bytes of "no extensions", voxels. Its world is RAS, as ours.
Bytes nifti_bytes(const Volume& volume, bool int16) {
  constexpr size_t kVoxelOffset = 352;
  Bytes bytes(kVoxelOffset, 0);
  const auto put = [&](size_t at, auto value) { std::memcpy(&bytes[at], &value, sizeof value); };
  const auto put_short = [&](size_t at, int value) { put(at, static_cast<std::int16_t>(value)); };
  put(0, std::int32_t{348});
  put_short(40, 3);
  for (int i = 0; i < 3; ++i) {
    if (volume.dims[i] > std::numeric_limits<std::int16_t>::max()) {
      throw Error("NIfTI holds at most 32767 voxels along an axis; write .nrrd instead");
    }
    put_short(42 + 2 * i, volume.dims[i]);
    put(80 + 4 * i, volume.spacing[i]);
  }
  for (int i = 3; i < 7; ++i) {
    put_short(42 + 2 * i, 1);
  }
  put_short(70, int16 ? 4 : 16);  // datatype: INT16 or FLOAT32
  put_short(72, int16 ? 16 : 32);
  put(76, 1.0f);  // pixdim[0]: a right-handed grid
  put(108, static_cast<float>(kVoxelOffset));
  put(112, 1.0f);     // scl_slope
  bytes[123] = 2;     // millimetres
  put_short(252, 1);  // qform: scanner coordinates
  put_short(254, 1);  // sform: the same
  Quat q = glm::normalize(glm::quat_cast(volume.direction));
  if (q.w < 0) {
    q = -q;
  }
  put(256, q.x);
  put(260, q.y);
  put(264, q.z);
  for (int row = 0; row < 3; ++row) {
    put(268 + 4 * row, volume.origin[row]);
    for (int axis = 0; axis < 3; ++axis) {
      put(280 + 16 * row + 4 * axis, volume.direction[axis][row] * volume.spacing[axis]);
    }
    put(292 + 16 * row, volume.origin[row]);
  }
  std::memcpy(&bytes[344], "n+1", 4);
  append(bytes, voxel_bytes(volume, int16));
  return bytes;
}

Bytes nrrd_bytes(const Volume& volume, bool int16) {
  const auto vector = [](const Vec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); };
  Bytes bytes;
  append(bytes,
         fmt::format("NRRD0005\ntype: {}\ndimension: 3\nspace: right-anterior-superior\n"
                     "sizes: {} {} {}\n",
                     int16 ? "short" : "float", volume.dims.x, volume.dims.y, volume.dims.z));
  append(bytes,
         fmt::format("space directions: {} {} {}\nkinds: domain domain domain\n"
                     "endian: little\nencoding: gzip\nspace origin: {}\n\n",
                     vector(volume.direction[0] * volume.spacing[0]),
                     vector(volume.direction[1] * volume.spacing[1]),
                     vector(volume.direction[2] * volume.spacing[2]), vector(volume.origin)));
  append(bytes, gzip(voxel_bytes(volume, int16)));
  return bytes;
}

/// MetaImage: its readers take the world as LPS.
Bytes metaimage_bytes(const Volume& volume, bool int16) {
  const Vec3 lps(-1, -1, 1);
  const Bytes voxels = gzip(voxel_bytes(volume, int16));
  const Vec3 origin = volume.origin * lps;
  Bytes bytes;
  append(bytes,
         "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n");
  append(bytes, fmt::format("CompressedData = True\nCompressedDataSize = {}\nTransformMatrix =",
                            voxels.size()));
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = volume.direction[axis] * lps;
    append(bytes, fmt::format(" {} {} {}", d.x, d.y, d.z));
  }
  append(bytes, fmt::format("\nOffset = {} {} {}\nElementSpacing = {} {} {}\nDimSize = {} {} {}\n"
                            "ElementType = {}\nElementDataFile = LOCAL\n",
                            origin.x, origin.y, origin.z, volume.spacing.x, volume.spacing.y,
                            volume.spacing.z, volume.dims.x, volume.dims.y, volume.dims.z,
                            int16 ? "MET_SHORT" : "MET_FLOAT"));
  append(bytes, voxels);
  return bytes;
}

}  // namespace

void save_volume(const fs::path& path, const Volume& volume) {
  const std::string name = path.filename().string();
  const bool int16 = fits_int16(volume);
  Bytes bytes;
  if (name.ends_with(".nii.gz")) {
    bytes = gzip(nifti_bytes(volume, int16));
  } else if (name.ends_with(".nii")) {
    bytes = nifti_bytes(volume, int16);
  } else if (name.ends_with(".nrrd")) {
    bytes = nrrd_bytes(volume, int16);
  } else if (name.ends_with(".mha")) {
    bytes = metaimage_bytes(volume, int16);
  } else {
    throw Error("{}: unknown kind of volume; write .nii, .nii.gz, .nrrd or .mha", path.string());
  }
  write_file(path, bytes.data(), bytes.size());
}

}  // namespace clipgs
