#include "volume/image_file.h"

#include <bit>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <zlib.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

Volume small_volume() {
  Volume volume;
  volume.dims = {9, 8, 7};
  volume.spacing = {4, 5, 6};
  volume.modality = Modality::kCt;
  std::vector<float> values;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    values.push_back(static_cast<float>(i * 7919 % 2000) - 1000);
  }
  volume.values = values;
  return volume;
}

Bytes first(const Bytes& bytes, size_t count) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)};
}

Bytes joined(const Bytes& a, const Bytes& b) {
  Bytes both = a;
  both.insert(both.end(), b.begin(), b.end());
  return both;
}

Bytes text_bytes(const std::string& text) { return {text.begin(), text.end()}; }

/// `window`: zlib's code of the format, 15 for zlib's own and 31 for gzip.
Bytes packed(const Bytes& data, int window) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
  Bytes out(deflateBound(&stream, data.size()));
  stream.next_in = const_cast<Bytef*>(data.data());
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}
Bytes gzip(const Bytes& data) { return packed(data, 31); }

std::string read_error(const fs::path& path, int frame = 0) {
  const std::string error = error_of([&] { read_image_file(path, frame); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  EXPECT_EQ(error.find("0x"), std::string::npos) << error;
  return error;
}

constexpr size_t kVoxelBytes = 9 * 8 * 7 * 2;

/// A volume in some format, and the file of it that holds the voxels.
struct Format {
  const char* name;
  const char* header;  // file to read
  const char* voxels;  // file to damage
  bool packed;
};

const char* const kNrrdFields =
    "NRRD0004\ntype: short\ndimension: 3\nspace: right-anterior-superior\nsizes: 9 8 7\n"
    "space directions: (4,0,0) (0,5,0) (0,0,6)\nspace origin: (0,0,0)\nendian: little\n";
const char* const kMetaFields =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    "TransformMatrix = -1 0 0 0 -1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 4 5 6\n"
    "DimSize = 9 8 7\nElementType = MET_SHORT\n";

void write_format(const TestFolder& folder, const Format& format) {
  const std::string name = format.name;
  const Volume volume = small_volume();
  save_volume(folder / "whole.nii", volume);
  const Bytes nifti = read_file(folder / "whole.nii");
  const Bytes voxels(nifti.begin() + 352, nifti.end());
  const auto write = [&](const char* file, const Bytes& bytes) {
    write_plainly(folder / file, bytes);
  };
  if (name == "nii") {
    write("v.nii", nifti);
  } else if (name == "nii_gz") {
    write("v.nii.gz", gzip(nifti));
  } else if (name == "hdr_img" || name == "hdr_img_gz") {
    Bytes header = first(nifti, 352);
    const float offset = 0;
    std::memcpy(&header[108], &offset, 4);
    std::memcpy(&header[344], "ni1", 4);
    write("v.hdr", header);
    write(format.voxels, format.packed ? gzip(voxels) : voxels);
  } else if (name == "nrrd_raw") {
    write("v.nrrd", joined(text_bytes(kNrrdFields + std::string("encoding: raw\n\n")), voxels));
  } else if (name == "nrrd_gzip") {
    write("v.nrrd",
          joined(text_bytes(kNrrdFields + std::string("encoding: gzip\n\n")), gzip(voxels)));
  } else if (name == "nhdr_raw") {
    write("v.nhdr", text_bytes(kNrrdFields + std::string("encoding: raw\ndata file: v.raw")));
    write("v.raw", voxels);
  } else if (name == "nhdr_gzip") {
    write("v.nhdr", text_bytes(kNrrdFields + std::string("encoding: gzip\ndata file: v.raw.gz\n")));
    write("v.raw.gz", gzip(voxels));
  } else if (name == "nhdr_list") {
    write("v.nhdr",
          text_bytes(kNrrdFields + std::string("encoding: raw\ndata file: s%02d.raw 1 7 1 2\n")));
    for (size_t slice = 0; slice < 7; ++slice) {
      const auto begin = voxels.begin() + static_cast<std::ptrdiff_t>(slice * 144);
      write_plainly(folder / fmt::format("s{:02}.raw", slice + 1), Bytes(begin, begin + 144));
    }
  } else if (name == "mha_raw") {
    write("v.mha",
          joined(text_bytes(kMetaFields + std::string("ElementDataFile = LOCAL\n")), voxels));
  } else if (name == "mha_zlib") {
    write("v.mha",
          joined(text_bytes(kMetaFields +
                            std::string("CompressedData = True\nElementDataFile = LOCAL\n")),
                 packed(voxels, 15)));
  } else if (name == "mhd_raw") {
    write("v.mhd", text_bytes(kMetaFields + std::string("ElementDataFile = v.raw\n")));
    write("v.raw", voxels);
  } else if (name == "mhd_zlib") {
    write("v.mhd",
          text_bytes(kMetaFields + std::string("CompressedData = True\nElementDataFile = v.zraw")));
    write("v.zraw", packed(voxels, 15));
  }
}

class ShortData : public testing::TestWithParam<Format> {};

TEST_P(ShortData, IsRefusedAndSaysWhatIsMissing) {
  const Format& format = GetParam();
  const TestFolder folder;
  write_format(folder, format);
  ASSERT_EQ(load_volume(folder / format.header).values, small_volume().values);
  const fs::path damaged = folder / format.voxels;
  const Bytes whole = read_file(damaged);
  const size_t share = format.voxels == std::string("s04.raw") ? kVoxelBytes / 7 : kVoxelBytes;
  for (const size_t percent : {60, 70}) {
    const size_t left = whole.size() * percent / 100;
    write_plainly(damaged, first(whole, left));
    const std::string error = read_error(folder / format.header);
    EXPECT_THAT(error, HasSubstr("truncated"));
    EXPECT_THAT(error, HasSubstr(format.packed ? fmt::format(" of the {} bytes", share)
                                               : fmt::format("{} of the {} bytes",
                                                             whole.size() - left, share)));
  }
  write_plainly(damaged, first(whole, whole.size() - 1));
  EXPECT_THAT(read_error(folder / format.header), HasSubstr("truncated"));
  if (format.packed) {  // a bit of every byte of the sums at the end: CRC and length, or Adler-32
    const bool zlib = std::string(format.name).ends_with("zlib");
    for (size_t byte = whole.size() - (zlib ? 4 : 8); byte < whole.size(); ++byte) {
      Bytes wrong = whole;
      wrong[byte] ^= 4;
      write_plainly(damaged, wrong);
      EXPECT_THAT(read_error(folder / format.header), HasSubstr("checksum"));
    }
  }
  if (format.voxels != std::string(format.header)) {
    fs::remove(damaged);
    EXPECT_THAT(read_error(folder / format.header), HasSubstr("missing"));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ShortData,
                         testing::Values(Format{"nii", "v.nii", "v.nii", false},
                                         Format{"nii_gz", "v.nii.gz", "v.nii.gz", true},
                                         Format{"hdr_img", "v.hdr", "v.img", false},
                                         Format{"hdr_img_gz", "v.hdr", "v.img.gz", true},
                                         Format{"nrrd_raw", "v.nrrd", "v.nrrd", false},
                                         Format{"nrrd_gzip", "v.nrrd", "v.nrrd", true},
                                         Format{"nhdr_raw", "v.nhdr", "v.raw", false},
                                         Format{"nhdr_gzip", "v.nhdr", "v.raw.gz", true},
                                         Format{"nhdr_list", "v.nhdr", "s04.raw", false},
                                         Format{"mha_raw", "v.mha", "v.mha", false},
                                         Format{"mha_zlib", "v.mha", "v.mha", true},
                                         Format{"mhd_raw", "v.mhd", "v.raw", false},
                                         Format{"mhd_zlib", "v.mhd", "v.zraw", true}),
                         [](const auto& format) { return std::string(format.param.name); });

TEST(ImageFile, APackedFileMayBeSeveralStreams) {
  const TestFolder folder;
  save_volume(folder / "v.nii", small_volume());
  const Bytes whole = read_file(folder / "v.nii");
  const Bytes a = first(whole, 500);
  const Bytes b(whole.begin() + 500, whole.end());
  write_plainly(folder / "two.nii.gz", joined(gzip(a), gzip(b)));
  EXPECT_EQ(load_volume(folder / "two.nii.gz").values, small_volume().values);
  write_plainly(folder / "one.nii.gz", gzip(a));
  EXPECT_THAT(read_error(folder / "one.nii.gz"), HasSubstr("860 of the 1008 bytes"));
}

TEST(ImageFile, WhatUnpacksToFarMoreThanItsHeaderSaysIsRefused) {
  const TestFolder folder;
  save_volume(folder / "v.nii", small_volume());
  Bytes bomb = read_file(folder / "v.nii");
  bomb.resize(size_t{4} << 20);
  write_plainly(folder / "v.nii.gz", gzip(bomb));
  EXPECT_THAT(read_error(folder / "v.nii.gz"), HasSubstr("unpacks to more than the 1008 bytes"));
}

/// A photograph of 100³ voxels whose colours say where they are, as NRRD.
Bytes large_photograph(const std::string& encoding, int channels) {
  constexpr int kSide = 100;
  Bytes voxels;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    for (int c = 0; c < channels; ++c) {
      voxels.push_back(static_cast<std::uint8_t>(i % 251 * (c + 1)));
    }
  }
  const std::string header = fmt::format(
      "NRRD0004\ntype: uint8\ndimension: 4\nspace: right-anterior-superior\nsizes: {} 100 100 100\n"
      "kinds: {}-color domain domain domain\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
      "encoding: {}\n\n",
      channels, channels == 3 ? "rgb" : "rgba", encoding);
  return joined(text_bytes(header), encoding == "raw" ? voxels : gzip(voxels));
}

TEST(ImageFile, ColoursOfLargeFilesKeepTheirPlaces) {
  const TestFolder folder;
  for (const char* encoding : {"raw", "gzip"}) {
    for (const int channels : {3, 4}) {
      write_plainly(folder / "v.nrrd", large_photograph(encoding, channels));
      const Volume volume = load_volume(folder / "v.nrrd");
      ASSERT_EQ(volume.rgb.size(), 3U * 1000 * 1000);
      size_t wrong = 0;
      for (size_t i = 0; i < volume.voxels(); ++i) {
        for (size_t c = 0; c < 3; ++c) {
          wrong += volume.rgb[3 * i + c] != static_cast<std::uint8_t>(i % 251 * (c + 1)) ? 1U : 0U;
        }
      }
      EXPECT_EQ(wrong, 0U) << encoding << " " << channels;
    }
  }
}

const Bytes kTenAndTwenty = {10, 20, 10, 20, 10, 20, 10, 20};

/// Of 2 x 2 x 2 voxels, 10 and 20 in turns along x, `fields` beside the size and type.
Volume two_voxels(const TestFolder& folder, const std::string& name, const std::string& fields) {
  const bool nrrd = name.ends_with(".nrrd");
  const std::string header =
      nrrd ? "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n" + fields + "\n"
           : "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n" + fields;
  write_plainly(folder / name, joined(text_bytes(header), kTenAndTwenty));
  return load_volume(folder / name);
}

/// RAS mm along x from the voxel of 10 to that of 20.
float from_ten_to_twenty(const Volume& volume) {
  const float step = volume.world_from_index({1, 0, 0}).x - volume.world_from_index({0, 0, 0}).x;
  return volume.values[0] < volume.values[1] ? step : -step;
}

TEST(ImageFile, ASpacingBelowZeroTurnsItsAxisRound) {
  const TestFolder folder;
  const std::string axes = "TransformMatrix = 1 0 0 0 1 0 0 0 1\n";
  const std::string local = "ElementDataFile = LOCAL\n";
  // The file's axes are LPS: on to the left is −x.
  EXPECT_FLOAT_EQ(
      from_ten_to_twenty(two_voxels(folder, "a.mha", axes + "ElementSpacing = 2 2 2\n" + local)),
      -2);
  EXPECT_FLOAT_EQ(
      from_ten_to_twenty(two_voxels(folder, "b.mha", axes + "ElementSpacing = -2 2 2\n" + local)),
      2);
}

TEST(ImageFile, ASpaceWithoutDirectionsIsThatOfTheAxes) {
  const TestFolder folder;
  const auto step = [&](const char* space) {
    return from_ten_to_twenty(
        two_voxels(folder, "v.nrrd", fmt::format("space: {}\nspacings: 2 2 2\n", space)));
  };
  EXPECT_FLOAT_EQ(step("right-anterior-superior"), 2);
  EXPECT_FLOAT_EQ(step("left-posterior-superior"), -2);
}

TEST(ImageFile, AHeaderMayBeLongerThanItsText) {
  const TestFolder folder;
  const std::string text =
      "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 20 20 20\nHeaderSize "
      "= "
      "512\nElementDataFile = LOCAL\n";
  Bytes bytes = text_bytes(text);
  bytes.resize(512, 200);
  write_plainly(folder / "v.mha", joined(bytes, kTenAndTwenty));
  const Volume volume = load_volume(folder / "v.mha");
  EXPECT_EQ(volume.values[0], 20);  // the patient's right comes first
  EXPECT_EQ(volume.values[1], 10);
}

TEST(ImageFile, ListsOfVolumesAreNoPhotographs) {
  const TestFolder folder;
  for (const char* kind : {"list", "time"}) {
    const std::string header = fmt::format(
        "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 1 1\nkinds: {} domain domain domain\n"
        "space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n",
        kind);
    write_plainly(folder / "v.nrrd", joined(text_bytes(header), {1, 2, 3, 4, 5, 6}));
    EXPECT_THAT(read_error(folder / "v.nrrd"), HasSubstr("its first axis is of that kind"));
  }
}

TEST(ImageFile, TheVoxelsThatAreNamedAreThoseThatAreRead) {
  const TestFolder folder;
  write_format(folder, {"hdr_img", "v.hdr", "v.img", false});
  const Bytes voxels = read_file(folder / "v.img");
  Bytes other = voxels;
  std::ranges::fill(other, std::uint8_t{1});
  write_plainly(folder / "v.img.gz", gzip(voxels));
  write_plainly(folder / "v.img", other);
  EXPECT_EQ(load_volume(folder / "v.img.gz").values, small_volume().values);
}

/// A NIfTI file of 3 volumes of 9 x 8 x 7 voxels, the second with 1000 more everywhere.
Bytes three_volumes(const TestFolder& folder) {
  save_volume(folder / "v.nii", small_volume());
  Bytes bytes = read_file(folder / "v.nii");
  const std::int16_t axes = 4;
  const std::int16_t frames = 3;
  std::memcpy(&bytes[40], &axes, 2);
  std::memcpy(&bytes[48], &frames, 2);
  for (const int more : {1000, 0}) {
    for (size_t i = 0; i < kVoxelBytes; i += 2) {
      std::int16_t value;
      std::memcpy(&value, &bytes[352 + i], 2);
      value = static_cast<std::int16_t>(value + more);
      bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
      bytes.push_back(static_cast<std::uint8_t>((value >> 8) & 0xff));
    }
  }
  return bytes;
}

TEST(ImageFile, OneFrameOfASeriesInTime) {
  const TestFolder folder;
  const Bytes series = three_volumes(folder);
  write_plainly(folder / "s.nii", series);
  write_plainly(folder / "s.nii.gz", gzip(series));
  LoadOptions options;
  options.keep_table = true;
  for (const char* name : {"s.nii", "s.nii.gz"}) {
    EXPECT_THAT(read_error(folder / name), HasSubstr("--frame 1 to 3"));
    EXPECT_THAT(read_error(folder / name, 4), HasSubstr("no frame 4: it holds 3"));
    for (int frame = 1; frame <= 3; ++frame) {
      options.frame = frame;
      const Volume volume = load_volume(folder / name, options);
      EXPECT_EQ(volume.values[10], small_volume().values[10] + (frame == 2 ? 1000 : 0));
      EXPECT_EQ(volume.values[503], small_volume().values[503] + (frame == 2 ? 1000 : 0));
    }
  }
  // What is missing of any frame is missing: a cut file shows no frame.
  write_plainly(folder / "cut.nii", first(series, series.size() - 10));
  EXPECT_THAT(read_error(folder / "cut.nii", 1), HasSubstr("10 of the 3024 bytes"));
  // The slowest axis of the others counts frames as well.
  write_plainly(
      folder / "s.nrrd",
      joined(text_bytes("NRRD0004\ntype: short\ndimension: 4\nsizes: 9 8 7 3\nspace: LPS\n"
                        "space directions: (4,0,0) (0,5,0) (0,0,6) none\nendian: little\n"
                        "kinds: domain domain domain list\nencoding: raw\n\n"),
             Bytes(series.begin() + 352, series.end())));
  EXPECT_THAT(read_error(folder / "s.nrrd"), HasSubstr("--frame 1 to 3"));
  EXPECT_EQ(read_image_file(folder / "s.nrrd", 2).values[10], small_volume().values[10] + 1000);
  write_plainly(folder / "s.mha",
                joined(text_bytes("NDims = 4\nDimSize = 9 8 7 3\nElementType = MET_SHORT\n"
                                  "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
                                  "ElementSpacing = 4 5 6 1\nElementDataFile = LOCAL\n"),
                       Bytes(series.begin() + 352, series.end())));
  EXPECT_EQ(read_image_file(folder / "s.mha", 2).values[10], small_volume().values[10] + 1000);
}

/// Two by two by two numbers as the type has them, in the given byte order.
template <typename T>
Bytes eight(bool big_endian) {
  Bytes bytes;
  for (int i = 1; i <= 8; ++i) {
    auto stored = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(static_cast<T>(i * 13));
    if (big_endian) {
      std::ranges::reverse(stored);
    }
    bytes.insert(bytes.end(), stored.begin(), stored.end());
  }
  return bytes;
}

template <typename T>
void expect_eight(const TestFolder& folder, const std::string& nrrd_type,
                  const std::string& meta_type) {
  for (const bool big : {false, true}) {
    write_plainly(folder / "v.nrrd",
                  joined(text_bytes(fmt::format("NRRD0004\ntype: {}\ndimension: 3\nsizes: 2 2 2\n"
                                                "spacings: 20 20 20\nendian: {}\nencoding: raw\n\n",
                                                nrrd_type, big ? "big" : "little")),
                         eight<T>(big)));
    write_plainly(folder / "v.mha",
                  joined(text_bytes(fmt::format(
                             "NDims = 3\nDimSize = 2 2 2\nElementType = {}\nElementSpacing = 20 20 "
                             "20\nBinaryDataByteOrderMSB = {}\nElementDataFile = LOCAL\n",
                             meta_type, big ? "True" : "False")),
                         eight<T>(big)));
    for (const char* name : {"v.nrrd", "v.mha"}) {
      EXPECT_THAT(read_image_file(folder / name).values.unpack(),
                  ElementsAre(13, 26, 39, 52, 65, 78, 91, 104))
          << nrrd_type << big;
    }
  }
}

TEST(ImageFile, EveryTypeInBothByteOrders) {
  const TestFolder folder;
  testing::internal::CaptureStderr();
  expect_eight<std::int8_t>(folder, "signed char", "MET_CHAR");
  expect_eight<std::uint8_t>(folder, "uint8", "MET_UCHAR");
  expect_eight<std::int16_t>(folder, "int16_t", "MET_SHORT");
  expect_eight<std::uint16_t>(folder, "unsigned short", "MET_USHORT");
  expect_eight<std::int32_t>(folder, "int", "MET_LONG");
  expect_eight<std::uint32_t>(folder, "uint", "MET_UINT");
  expect_eight<std::int64_t>(folder, "long long int", "MET_LONG_LONG");
  expect_eight<std::uint64_t>(folder, "uint64", "MET_ULONG_LONG");
  expect_eight<float>(folder, "float", "MET_FLOAT");
  expect_eight<double>(folder, "double", "MET_DOUBLE");
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("orientation"));
}

TEST(ImageFile, TextIsReadAndCounted) {
  const TestFolder folder;
  const std::string header =
      "NRRD0001\n# a comment\ntype: float\ndimension: 3\nsizes: 2 2 2\nspace: RAS\n"
      "space directions: (9,0,0) (0,9,0) (0,0,9)\nkey:=value\nencoding: ascii\n\n";
  write_text(folder / "v.nrrd", header + "1 2.5 -3e1\n4 5 6 7 8\n");
  EXPECT_THAT(read_image_file(folder / "v.nrrd").values.unpack(),
              ElementsAre(1, 2.5, -30, 4, 5, 6, 7, 8));
  write_text(folder / "v.nrrd", header + "1 2.5 -3e1\n4 5 6\n");
  EXPECT_THAT(read_error(folder / "v.nrrd"), HasSubstr("2 of the 8 numbers"));
  write_text(folder / "v.nrrd", header + "1 2.5 -3e1\n4 x 6 7 8\n");
  EXPECT_THAT(read_error(folder / "v.nrrd"), HasSubstr("voxel 4 of its text is no number"));
}

TEST(ImageFile, MetaImageNamesItsFilesInAList) {
  const TestFolder folder;
  const std::string header =
      "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 9 9 9\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nHeaderSize = -1\nElementDataFile = ";
  write_text(folder / "a.bin", "....\1\2\3\4");
  write_text(folder / "b.bin", "\5\6\7\10");
  write_text(folder / "v.mhd", header + "LIST\na.bin\nb.bin\n");
  EXPECT_THAT(read_image_file(folder / "v.mhd").values.unpack(),
              ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  write_text(folder / "v.mhd", header + "LIST\na.bin\nb.bin\nc.bin\n");
  EXPECT_THAT(read_error(folder / "v.mhd"), HasSubstr("3 files"));
  write_text(folder / "v.mhd", header + "/dev/zero\n");
  EXPECT_THAT(read_error(folder / "v.mhd"), HasSubstr("no such file"));
}

TEST(ImageFile, MetaImageScalesItsValuesAsItSays) {
  const TestFolder folder;
  write_text(folder / "v.mha",
             "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 9 9 9\n"
             "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementToIntensityFunctionSlope = 2\n"
             "ElementToIntensityFunctionOffset = -10\nElementDataFile = LOCAL\n\1\2\3\4\5\6\7\10");
  EXPECT_THAT(read_image_file(folder / "v.mha").values.unpack(),
              ElementsAre(-8, -6, -4, -2, 0, 2, 4, 6));
}

TEST(ImageFile, UnitsAreObeyed) {
  const TestFolder folder;
  const std::string voxels = "\1\2\3\4\5\6\7\10";
  const auto nrrd = [&](const std::string& unit) {
    write_text(folder / "v.nrrd",
               "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nspace: LPS\nspace directions: "
               "(2,0,0) (0,2,0) (0,0,2)\nspace origin: (1,1,1)\nspace units: \"" +
                   unit + "\" \"" + unit + "\" \"" + unit + "\"\nencoding: raw\n\n" + voxels);
    return read_image_file(folder / "v.nrrd");
  };
  testing::internal::CaptureStderr();
  EXPECT_EQ(nrrd("mm").spacing, glm::dvec3(2));
  EXPECT_EQ(nrrd("cm").spacing, glm::dvec3(20));
  EXPECT_EQ(nrrd("cm").origin, glm::dvec3(10));
  EXPECT_EQ(nrrd("m").spacing, glm::dvec3(2000));
  EXPECT_EQ(nrrd("microns").spacing, glm::dvec3(2e-3));
  const std::string small = testing::internal::GetCapturedStderr();
  EXPECT_THAT(small, HasSubstr("by its space directions[0]: small for a body"));
  EXPECT_THAT(small, HasSubstr("by its space directions[0]: too large for a body"));
  testing::internal::CaptureStderr();
  EXPECT_EQ(nrrd("furlong").spacing, glm::dvec3(2));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("\"furlong\", no unit of length"));
  write_text(folder / "v.mha",
             "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 2 2 2\n"
             "DistanceUnits = cm\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n" +
                 voxels);
  EXPECT_EQ(read_image_file(folder / "v.mha").spacing, glm::dvec3(20));
}

TEST(ImageFile, ASpacingOfZeroIsSaid) {
  const TestFolder folder;
  const std::string voxels = "\1\2\3\4\5\6\7\10";
  testing::internal::CaptureStderr();
  write_text(folder / "v.mha",
             "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 2 0 2\n"
             "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n" +
                 voxels);
  EXPECT_EQ(read_image_file(folder / "v.mha").spacing, glm::dvec3(2, 1, 2));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("ElementSpacing[1] is 0"));
  testing::internal::CaptureStderr();
  write_text(
      folder / "v.nrrd",
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nspacings: 2 2 0\nencoding: raw\n\n" +
          voxels);
  EXPECT_EQ(read_image_file(folder / "v.nrrd").spacing, glm::dvec3(2, 2, 1));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("spacings[2] is 0"));
}

TEST(ImageFile, HeadersHintAtWhatTheyShow) {
  const TestFolder folder;
  const auto nrrd = [&](const std::string& keys) {
    write_plainly(
        folder / "v.nrrd",
        joined(text_bytes(kNrrdFields + ("encoding: raw\n" + keys + "\n")), Bytes(kVoxelBytes)));
    return read_image_file(folder / "v.nrrd").hints;
  };
  EXPECT_EQ(nrrd("").modality, Modality::kUnknown);
  EXPECT_EQ(nrrd("Modality:=MR\n").modality, Modality::kMr);
  const Hints converted = nrrd(
      "DICOM_0008_0060_Modality:=CT\n0018|0015:=CHEST\n"
      "DICOM_0008_103E_SeriesDescription:=CTA\n0018|0010:=Iohexol\n");
  EXPECT_EQ(converted.modality, Modality::kCt);
  EXPECT_EQ(converted.region, BodyRegion::kChest);
  EXPECT_EQ(converted.part, BodyPart::kChest);
  EXPECT_TRUE(converted.angiography);
  EXPECT_TRUE(converted.contrast);

  const auto meta = [&](const std::string& field) {
    write_plainly(
        folder / "v.mha",
        joined(text_bytes(kMetaFields + field + "ElementDataFile = LOCAL\n"), Bytes(kVoxelBytes)));
    return read_image_file(folder / "v.mha").hints.modality;
  };
  EXPECT_EQ(meta(""), Modality::kUnknown);
  EXPECT_EQ(meta("Modality = MET_MOD_PET\n"), Modality::kPet);

  save_volume(folder / "v.nii", small_volume());
  Bytes nifti = read_file(folder / "v.nii");
  const auto read_nifti = [&] {
    write_plainly(folder / "v.nii", nifti);
    return read_image_file(folder / "v.nii").hints;
  };
  EXPECT_EQ(read_nifti().modality, Modality::kUnknown);
  EXPECT_FALSE(read_nifti().shown);
  const std::string words = "TE=2.9;tof brain";
  std::ranges::copy(words, nifti.begin() + 148);
  const float shown[2] = {700, 100};  // cal_max, cal_min
  std::memcpy(&nifti[124], shown, sizeof(shown));
  const Hints hints = read_nifti();
  EXPECT_EQ(hints.modality, Modality::kMr);
  EXPECT_EQ(hints.region, BodyRegion::kHead);
  EXPECT_TRUE(hints.angiography);
  EXPECT_EQ(hints.shown, Vec2(100, 700));
  const float nonsense[2] = {std::numeric_limits<float>::quiet_NaN(), 100};
  std::memcpy(&nifti[124], nonsense, sizeof(nonsense));
  EXPECT_FALSE(read_nifti().shown);
}

}  // namespace
}  // namespace clipgs
