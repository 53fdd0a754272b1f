#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"
#include "volume/test_folder.h"

// Every number of every header, replaced by what no scanner writes: each file must end in one line
// that a person understands, or in a volume of sense. It must not abort, hang or allocate for it.

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();

Volume turned_volume() {
  Volume volume;
  volume.dims = {7, 5, 4};
  volume.spacing = {15, 20, 25};
  volume.direction = glm::mat3_cast(glm::angleAxis(0.15f, glm::normalize(Vec3(1, 1, 2))));
  volume.origin = {-12, 34, 56};
  std::vector<float> values;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    values.push_back(static_cast<float>(i) * 9);
  }
  volume.values = values;
  return volume;
}

/// Loads it; returns the message, "" if there is a volume.
std::string outcome(const fs::path& path) {
  std::string error;
  testing::internal::CaptureStderr();
  try {
    const Volume volume = load_volume(path);
    EXPECT_EQ(volume.values.size(), volume.voxels());
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(volume.dims[axis], 2);
      EXPECT_TRUE(volume.spacing[axis] > 1e-7f && volume.spacing[axis] < 1e7f);
      EXPECT_LE(std::abs(volume.origin[axis]), 1e9f);
      EXPECT_NEAR(glm::length(volume.direction[axis]), 1, 1e-4);
    }
    EXPECT_NEAR(glm::determinant(volume.direction), 1, 1e-4);
    EXPECT_TRUE(std::ranges::all_of(volume.values.all(), [](float v) { return std::isfinite(v); }));
  } catch (const Error& e) {
    error = e.what();
    EXPECT_NE(error, "");
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(error.find("0x"), std::string::npos) << error;
  }
  const std::string warnings = testing::internal::GetCapturedStderr();
  EXPECT_EQ(warnings.find("nan"), std::string::npos) << warnings;
  return error;
}

template <typename T>
std::string outcome_with(const fs::path& path, Bytes bytes, size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
  write_plainly(path, bytes);
  SCOPED_TRACE(fmt::format("byte {}", at));
  return outcome(path);
}

TEST(HeaderMutations, OfNiftiEndInOneLineOrAVolume) {
  const TestFolder folder;
  save_volume(folder / "v.nii", turned_volume());
  const Bytes whole = read_file(folder / "v.nii");
  int tried = 0;
  int refused = 0;
  const auto count = [&](const std::string& error) {
    ++tried;
    refused += error.empty() ? 0 : 1;
  };
  std::vector<size_t> reals;  // pixdim, vox_offset, slope and intercept, quaternion, offsets, srow
  for (const auto& [first, fields] :
       std::initializer_list<std::pair<size_t, size_t>>{{76, 8}, {108, 3}, {256, 6}, {280, 12}}) {
    for (size_t i = 0; i < fields; ++i) {
      reals.push_back(first + 4 * i);
    }
  }
  for (const size_t at : reals) {
    for (const float value : {std::nanf(""), kInf, -kInf, kMax, -kMax, 0.0f, 1e-38f, -1.0f, 1e6f}) {
      count(outcome_with(folder / "m.nii", whole, at, value));
    }
  }
  std::vector<size_t> shorts;  // dim, datatype, bitpix, qform_code, sform_code
  for (size_t at = 40; at < 56; at += 2) {
    shorts.push_back(at);
  }
  shorts.insert(shorts.end(), {70, 72, 252, 254});
  for (const size_t at : shorts) {
    for (const int value : {-32768, -1, 0, 1, 2, 32767}) {
      count(outcome_with(folder / "m.nii", whole, at, static_cast<std::int16_t>(value)));
    }
  }
  for (const int value : {-1, 0, 347, 540, 0x5c010000, 0x1c020000}) {
    count(outcome_with(folder / "m.nii", whole, 0, value));
  }
  for (size_t at = 344; at < 348; ++at) {
    count(outcome_with(folder / "m.nii", whole, at, std::uint8_t{255}));
  }
  EXPECT_GT(tried, 300);
  EXPECT_GT(refused, tried / 3);
  RecordProperty("mutations", tried);
}

TEST(HeaderMutations, OfNiftiAreSaidByTheirField) {
  const TestFolder folder;
  save_volume(folder / "v.nii", turned_volume());
  const Bytes whole = read_file(folder / "v.nii");
  const auto error = [&](size_t at, auto value) {
    return outcome_with(folder / "m.nii", whole, at, value);
  };
  for (size_t i = 0; i < 12; ++i) {
    const std::string field = fmt::format("srow_{}[{}]", "xyz"[i / 4], i % 4);
    EXPECT_THAT(error(280 + 4 * i, std::nanf("")), HasSubstr("its " + field + " is nan"));
    EXPECT_THAT(error(280 + 4 * i, kInf), HasSubstr("its " + field + " is inf"));
  }
  EXPECT_THAT(error(320, kMax), HasSubstr("srow_*[2] puts voxels 3.4"));
  EXPECT_THAT(error(324, kMax), HasSubstr("srow_*[3] puts it 3.4"));
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(error(256 + 4 * i, kInf), HasSubstr(fmt::format("quatern_{} is inf", "bcd"[i])));
    EXPECT_THAT(error(268 + 4 * i, -kInf), HasSubstr(fmt::format("qoffset_{} is -inf", "xyz"[i])));
    EXPECT_THAT(error(80 + 4 * i, std::nanf("")),
                HasSubstr(fmt::format("pixdim[{}] is nan", i + 1)));
  }
  EXPECT_THAT(error(256, 3.0f), HasSubstr("no rotation"));
  EXPECT_THAT(error(108, std::nanf("")), HasSubstr("vox_offset is nan"));
  EXPECT_THAT(error(108, 0.0f), HasSubstr("vox_offset is 0"));
  EXPECT_THAT(error(108, 1e6f), HasSubstr("280 of the 280 bytes"));
  EXPECT_THAT(error(112, kInf), HasSubstr("scl_slope is inf"));
  EXPECT_THAT(error(116, kInf), HasSubstr("scl_inter is inf"));
  EXPECT_THAT(error(40, std::int16_t{9}), HasSubstr("dim[0] is 9"));
  EXPECT_THAT(error(42, std::int16_t{-3}), HasSubstr("size -3 along axis 1"));
  EXPECT_THAT(error(46, std::int16_t{32767}), HasSubstr("2293410 of the 2293690 bytes"));
  EXPECT_THAT(error(70, std::int16_t{32}), HasSubstr("datatype 32"));
  EXPECT_THAT(error(254, std::int16_t{77}), HasSubstr("sform_code is 77"));
  EXPECT_THAT(error(0, 7), HasSubstr("sizeof_hdr is 7"));
}

void write_text_plainly(const fs::path& path, const std::string& text) {
  write_plainly(path, Bytes(text.begin(), text.end()));
}

/// The file with its header's n-th number replaced; "" if it has fewer.
std::string with_number(const std::string& header, size_t n, const std::string& replacement) {
  size_t at = 0;
  for (size_t found = 0;; ++found) {
    at = header.find_first_of("0123456789", at);
    if (at == std::string::npos) {
      return "";
    }
    const size_t end = header.find_first_not_of("0123456789.e+-", at);
    if (found == n) {
      const bool negative = at > 0 && header[at - 1] == '-';
      return header.substr(0, negative ? at - 1 : at) + replacement + header.substr(end);
    }
    at = end;
  }
}

void mutate_text(const std::string& name, const std::string& voxels_after) {
  const TestFolder folder;
  save_volume(folder / name, turned_volume());
  const std::string whole = read_text(folder / name);
  const size_t length = whole.find(voxels_after) + voxels_after.size();
  int tried = 0;
  int refused = 0;
  for (const char* value : {"nan", "inf", "-inf", "1e39", "1e308", "1e999", "0", "-1", "0.5", "x",
                            "", "99999999999", "2147483647"}) {
    for (size_t n = 0;; ++n) {
      const std::string header = with_number(whole.substr(0, length), n, value);
      if (header.empty()) {
        break;
      }
      write_text_plainly(folder / ("m-" + name), header + whole.substr(length));
      SCOPED_TRACE(fmt::format("number {} is \"{}\"", n, value));
      refused += outcome(folder / ("m-" + name)).empty() ? 0 : 1;
      ++tried;
    }
  }
  EXPECT_GT(tried, 200);
  EXPECT_GT(refused, tried / 2);
  testing::Test::RecordProperty("mutations", tried);
}

TEST(HeaderMutations, OfNrrdEndInOneLineOrAVolume) { mutate_text("v.nrrd", "\n\n"); }
TEST(HeaderMutations, OfMetaImageEndInOneLineOrAVolume) {
  mutate_text("v.mha", "ElementDataFile = LOCAL\n");
}

struct Mutation {
  const char* from;
  const char* to;
  const char* message;
};

void expect_messages(const std::string& name, const std::string& header,
                     std::initializer_list<Mutation> mutations) {
  const TestFolder folder;
  const std::string voxels("\1\2\3\4\5\6\7\10");
  write_text_plainly(folder / name, header + voxels);
  EXPECT_EQ(outcome(folder / name), "");
  for (const Mutation& mutation : mutations) {
    std::string changed = header;
    const size_t at = changed.find(mutation.from);
    ASSERT_NE(at, std::string::npos) << mutation.from;
    changed.replace(at, std::strlen(mutation.from), mutation.to);
    write_text_plainly(folder / name, changed + voxels);
    EXPECT_THAT(outcome(folder / name), HasSubstr(mutation.message));
  }
}

TEST(HeaderMutations, OfNrrdAreSaidByTheirField) {
  expect_messages(
      "v.nrrd",
      "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
      "space directions: (20,0,0) (0,20,0) (0,0,20)\nencoding: raw\nspace origin: (1,2,3)\n\n",
      {{"(20,0,0)", "(nan,0,0)", "space directions holds nan"},
       {"(20,0,0)", "(1e100,0,0)", "space directions[0] puts voxels 1e+100 mm apart"},
       {"(20,0,0)", "(0,0,0)", "space directions[0] puts voxels 0 mm apart"},
       {"(20,0,0)", "(0,20,0)", "lie in one plane"},
       {"(20,0,0)", "(20,7,0)", "not perpendicular"},
       {"(20,0,0)", "(20,0)", "space directions gives 2 numbers, not 3"},
       {"(20,0,0)", "none", "three axes of space"},
       {"(1,2,3)", "(1,inf,3)", "space origin holds inf"},
       {"(1,2,3)", "(1,2,1e9)", "space origin puts it"},
       {"sizes: 2 2 2", "sizes: 2 2 -2", "sizes gives the size -2 along axis 3"},
       {"sizes: 2 2 2", "sizes: 2 2", "sizes gives 2 numbers, not 3"},
       {"sizes: 2 2 2", "sizes: 2 2 99999999999", "more than 2^32 voxels"},
       {"sizes: 2 2 2", "sizes: 2 2 9", "28 of the 36 bytes"},
       {"dimension: 3", "dimension: 99", "dimension is 99"},
       {"dimension: 3\n", "", "no \"dimension\""},
       {"type: uchar", "type: block", "type \"block\""},
       {"type: uchar", "type: short", "no \"endian\""},
       {"encoding: raw", "encoding: bzip2", "encoding \"bzip2\""},
       {"encoding: raw", "encoding: raw\nbyte skip: 1e15", "byte skip is"},
       {"encoding: raw", "encoding: raw\nbyte skip: 3", "3 of the 8 bytes"},
       {"encoding: raw", "encoding: raw\nencoding: gzip", "gives \"encoding\" twice"},
       {"encoding: raw", "encoding: raw\nhello", "\"hello\" is no field"},
       {"NRRD0004", "NRRD", "does not begin with NRRD000"}});
}

TEST(HeaderMutations, OfMetaImageAreSaidByTheirField) {
  expect_messages(
      "v.mha",
      "ObjectType = Image\nNDims = 3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\n"
      "ElementSpacing = 20 20 20\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
      "ElementDataFile = LOCAL\n",
      {{"20 20 20", "20 nan 20", "ElementSpacing holds nan"},
       {"20 20 20", "20 1e9 20", "ElementSpacing[1] puts voxels 1e+09 mm"},
       {"20 20 20", "20 20", "ElementSpacing gives 2 numbers, not 3"},
       {"= 1 0 0", "= inf 0 0", "TransformMatrix holds inf"},
       {"= 1 0 0", "= 2 0 0", "direction 1 of its TransformMatrix is 2 long"},
       {"= 1 0 0", "= 0 1 0", "TransformMatrix lie in one plane"},
       {"= 1 0 0", "= 0.8 0.6 0", "TransformMatrix are not perpendicular"},
       {"Offset = 1 2 3", "Offset = 1 2 -1e300", "Offset puts it"},
       {"DimSize = 2 2 2", "DimSize = 2 0 2", "DimSize gives the size 0 along axis 2"},
       {"DimSize = 2 2 2", "DimSize = 2 2 8", "24 of the 32 bytes"},
       {"NDims = 3", "NDims = 2.5", "NDims is 2.5"},
       {"MET_UCHAR", "MET_OTHER", "ElementType \"MET_OTHER\""},
       {"MET_UCHAR", "MET_UCHAR\nElementNumberOfChannels = 5", "5 numbers a voxel"},
       {"MET_UCHAR", "MET_UCHAR\nCompressedData = perhaps", "neither True nor False"},
       {"MET_UCHAR", "MET_UCHAR\nCompressedData = True", "cannot be unpacked"},
       {"ObjectType = Image", "ObjectType = Tube", "ObjectType is \"Tube\""},
       {"ObjectType = Image", "hello", "\"hello\" is no line"},
       {"ElementDataFile = LOCAL\n", "", "no MetaImage file"},
       {"LOCAL", "x%1000000000d.raw 1 2 1", "one number like %03d"},
       {"LOCAL", "x%d.raw 1 2000000 1", "65536 files"}});
}

}  // namespace
}  // namespace clipgs
