#include "volume/load.h"

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "volume/phantom.h"
#include "volume/preset.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A small volume whose every voxel differs, turned a little away from the patient's axes.
Volume varied_volume() {
  Volume volume;
  volume.dims = {7, 5, 4};
  volume.spacing = {1.5f, 2, 2.5f};
  volume.direction = glm::mat3_cast(glm::angleAxis(0.15f, glm::normalize(Vec3(1, 1, 2))));
  volume.origin = {-12, 34, 56};
  volume.modality = Modality::kCt;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    volume.values.unpack().push_back(static_cast<float>(i) * 9 - 1000);
  }
  return volume;
}

void expect_same_geometry(const Volume& a, const Volume& b) {
  EXPECT_EQ(a.dims, b.dims);
  EXPECT_LT(glm::length(a.spacing - b.spacing), 1e-4f);
  EXPECT_LT(glm::length(a.origin - b.origin), 1e-3f);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(glm::length(a.direction[i] - b.direction[i]), 1e-4f);
  }
}

class SaveAndLoad : public testing::TestWithParam<const char*> {};

TEST_P(SaveAndLoad, KeepsWholeNumbersAndGeometry) {
  const TestFolder folder;
  const Volume volume = varied_volume();
  save_volume(folder / GetParam(), volume);
  const Volume back = load_volume(folder / GetParam());
  expect_same_geometry(volume, back);
  EXPECT_EQ(volume.values, back.values);
  EXPECT_EQ(back.modality, Modality::kCt);
}

TEST_P(SaveAndLoad, KeepsFractions) {
  const TestFolder folder;
  Volume volume = varied_volume();
  volume.values.unpack()[3] += 0.25f;
  save_volume(folder / GetParam(), volume);
  EXPECT_EQ(volume.values, load_volume(folder / GetParam()).values);
}

INSTANTIATE_TEST_SUITE_P(Formats, SaveAndLoad,
                         testing::Values("v.nii", "v.nii.gz", "v.nrrd", "v.mha"));

/// An NRRD with raw voxels and the given header lines.
void write_nrrd(const std::filesystem::path& path, const std::string& fields,
                const std::string& voxels) {
  write_text(path, "NRRD0004\n" + fields + "encoding: raw\nendian: little\n\n" + voxels);
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string counting_bytes(size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i) {
    text += static_cast<char>(i * 7 % 251);
  }
  return text;
}

TEST(Load, LpsBecomesRasWithAxesAlongThePatient) {
  const TestFolder folder;
  // Axes stored as (superior, left, posterior), 4 x 2 x 3 voxels.
  std::vector<std::int16_t> values;
  for (std::int16_t i = 0; i < 24; ++i) {
    values.push_back(i);
  }
  write_nrrd(folder / "v.nrrd",
             "type: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 2 3\n"
             "space directions: (0,0,2) (3,0,0) (0,5,0)\nspace origin: (10,20,30)\n",
             bytes_of(values));
  const Volume v = load_volume(folder / "v.nrrd");
  EXPECT_EQ(v.dims, IVec3(2, 3, 4));
  EXPECT_EQ(v.spacing, Vec3(3, 5, 2));
  EXPECT_LT(glm::length(v.direction[0] - Vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::length(v.direction[1] - Vec3(0, 1, 0)), 1e-6f);
  // Stored voxel (i, j, k) lies at LPS (10 + 3j, 20 + 5k, 30 + 2i).
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 3; ++k) {
        const Vec3 ras(-(10 + 3 * j), -(20 + 5 * k), 30 + 2 * i);
        EXPECT_NEAR(v.sample(ras), static_cast<float>(i + 4 * j + 8 * k), 1e-3f);
      }
    }
  }
}

TEST(Load, NiftiSlopeAndInterceptAreHonoured) {
  const TestFolder folder;
  save_volume(folder / "v.nii", varied_volume());
  std::vector<std::uint8_t> bytes = read_file(folder / "v.nii");
  const float slope = 0.5f;
  const float intercept = -100;
  std::memcpy(&bytes[112], &slope, 4);
  std::memcpy(&bytes[116], &intercept, 4);
  write_file(folder / "v.nii", bytes.data(), bytes.size());
  const Volume back = load_volume(folder / "v.nii");
  EXPECT_NEAR(back.values[10], varied_volume().values[10] * 0.5f - 100, 1e-3f);
}

/// Of a body of 64 in air of 0, as of 8 bits that stand for HU.
std::string body_bytes() { return std::string(20, 0) + std::string(39, 64) + '\xc8'; }

TEST(Load, EightBitIsTakenAsStoredUnlessToldOtherwise) {
  const TestFolder folder;
  write_nrrd(folder / "v.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\n", body_bytes());
  testing::internal::CaptureStderr();
  const Volume stored = load_volume(folder / "v.nrrd");
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("if this is CT give --hu "));
  EXPECT_EQ(stored.modality, Modality::kUnknown);
  LoadOptions options;
  options.hu = Rescale{16, -1024};
  testing::internal::CaptureStderr();
  const Volume hu = load_volume(folder / "v.nrrd", options);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), Not(HasSubstr("--hu")));
  EXPECT_EQ(hu.modality, Modality::kCt);
  for (size_t i = 0; i < hu.voxels(); ++i) {
    EXPECT_EQ(hu.values[i], stored.values[i] * 16 - 1024);
  }
}

TEST(Load, NoHuAreSuggestedForWhatIsNoCt) {
  const TestFolder folder;
  write_nrrd(folder / "v.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\n", counting_bytes(60));
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder / "v.nrrd").modality, Modality::kUnknown);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), Not(HasSubstr("--hu")));
  write_nrrd(folder / "mr.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\nmodality:=MR\n",
             body_bytes());
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder / "mr.nrrd").modality, Modality::kMr);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), Not(HasSubstr("--hu")));
}

TEST(Load, ModalityOverrulesTheGuess) {
  const TestFolder folder;
  save_volume(folder / "v.nrrd", varied_volume());
  EXPECT_EQ(load_volume(folder / "v.nrrd").modality, Modality::kCt);
  LoadOptions options;
  for (const Modality modality :
       {Modality::kCt, Modality::kMr, Modality::kPet, Modality::kUltrasound}) {
    options.modality = modality;
    EXPECT_EQ(load_volume(folder / "v.nrrd", options).modality, modality);
  }
  write_nrrd(folder / "mr.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\nmodality:=MR\n",
             counting_bytes(60));
  EXPECT_EQ(load_volume(folder / "mr.nrrd", options).modality, Modality::kUltrasound);
}

TEST(Load, ModalityMakesCtOfWhatWasNoneWithAllThatFollows) {
  const TestFolder folder;
  Volume volume = make_ball(64, 20, 1040, 0);
  volume.spacing = Vec3(3);
  volume.values.transform([](float value) { return value - 2000; });
  volume.values.unpack()[0] = 40000;  // beyond what the guess takes for CT
  save_volume(folder / "v.nrrd", volume);
  EXPECT_EQ(load_volume(folder / "v.nrrd").values.range().min, -2000);
  LoadOptions options;
  options.modality = Modality::kCt;
  EXPECT_EQ(load_volume(folder / "v.nrrd", options).values.range().min, -1024);
}

TEST(Load, ModalityThatCannotBeIsRefused) {
  const TestFolder folder;
  write_nrrd(folder / "v.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\n", counting_bytes(60));
  write_nrrd(folder / "rgb.nrrd",
             "type: uchar\ndimension: 4\nsizes: 3 4 3 2\nkinds: RGB-color domain domain domain\n"
             "space directions: none (1,0,0) (0,1,0) (0,0,1)\n",
             counting_bytes(72));
  const auto error = [&](const char* file, Modality modality, std::optional<Rescale> hu = {}) {
    LoadOptions options;
    options.modality = modality;
    options.hu = hu;
    return error_of([&] { load_volume(folder / file, options); });
  };
  EXPECT_THAT(error("v.nrrd", Modality::kPhoto), HasSubstr("one value a voxel"));
  EXPECT_THAT(error("v.nrrd", Modality::kCt), HasSubstr("give --hu SCALE,OFFSET"));
  EXPECT_EQ(error("v.nrrd", Modality::kCt, Rescale{16, -1024}), "");
  EXPECT_THAT(error("v.nrrd", Modality::kMr, Rescale{16, -1024}), HasSubstr("leave one of them"));
  EXPECT_THAT(error("rgb.nrrd", Modality::kMr), HasSubstr("rgb.nrrd: has colours"));
  EXPECT_EQ(error("rgb.nrrd", Modality::kPhoto), "");
}

TEST(Load, HeadersThatSayCtOfEightBitsAreNotBelieved) {
  const TestFolder folder;
  write_nrrd(folder / "v.nrrd", "type: uchar\ndimension: 3\nsizes: 5 4 3\nmodality:=CT\n",
             counting_bytes(60));
  EXPECT_EQ(load_volume(folder / "v.nrrd").modality, Modality::kUnknown);
}

TEST(Load, RgbBecomesPhotographs) {
  const TestFolder folder;
  write_nrrd(folder / "v.nrrd",
             "type: uchar\ndimension: 4\nsizes: 3 4 3 2\nkinds: RGB-color domain domain domain\n"
             "space: right-anterior-superior\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
             "space origin: (0,0,0)\n",
             counting_bytes(72));
  const Volume v = load_volume(folder / "v.nrrd");
  EXPECT_EQ(v.modality, Modality::kPhoto);
  ASSERT_EQ(v.rgb.size(), 72);
  EXPECT_EQ(v.dims, IVec3(4, 3, 2));
  EXPECT_EQ(v.rgb[3], 21);  // the second voxel's red: byte 3 of the file
  EXPECT_NEAR(v.values[1], 0.2126f * 21 + 0.7152f * 28 + 0.0722f * 35, 1e-3f);
}

TEST(Load, PixelsOutsideTheScannersFieldAreAir) {
  const TestFolder folder;
  Volume volume = varied_volume();
  volume.values.unpack()[5] = -3024;
  save_volume(folder / "v.nrrd", volume);
  EXPECT_EQ(load_volume(folder / "v.nrrd").values[5], -1024);
}

std::string load_error(const std::filesystem::path& path) {
  const LibraryLeaksIgnored ignored;
  const std::string error = error_of([&] { load_volume(path); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

TEST(LoadErrors, SayWhatIsWrong) {
  const TestFolder folder;
  EXPECT_THAT(load_error(folder / "none.nrrd"), HasSubstr("no such file"));
  write_text(folder / "notes.txt", "hello");
  EXPECT_THAT(load_error(folder / "notes.txt"), HasSubstr("unknown kind of volume"));
  EXPECT_THAT(load_error(folder.path()), HasSubstr("no DICOM image"));
  write_text(folder / "text.nii", "this is no NIfTI file");
  EXPECT_THAT(load_error(folder / "text.nii"), HasSubstr("corrupt"));
  write_text(folder / "text.nrrd", "this is no NRRD file");
  EXPECT_THAT(load_error(folder / "text.nrrd"), HasSubstr("corrupt"));
  write_text(folder / "empty.mha", "");
  EXPECT_THAT(load_error(folder / "empty.mha"), HasSubstr("corrupt"));

  const std::string short_3d = "type: short\ndimension: 3\n";
  const std::string voxels = bytes_of(std::vector<std::int16_t>(60, 42));
  write_nrrd(folder / "constant.nrrd", short_3d + "sizes: 5 4 3\n", voxels);
  EXPECT_THAT(load_error(folder / "constant.nrrd"), HasSubstr("every voxel has the value 42"));
  std::vector<float> far(60, -3e38f);
  far[7] = 3e38f;
  write_nrrd(folder / "far.nrrd", "type: float\ndimension: 3\nsizes: 5 4 3\n", bytes_of(far));
  EXPECT_THAT(load_error(folder / "far.nrrd"), HasSubstr("from -3e+38 to 3e+38, further than"));
  write_nrrd(folder / "zero.nrrd", short_3d + "sizes: 5 0 3\n", "");
  EXPECT_THAT(load_error(folder / "zero.nrrd"), HasSubstr("sizes gives the size 0 along axis 2"));
  write_nrrd(folder / "flat.nrrd", short_3d + "sizes: 20 3 1\n", voxels);
  EXPECT_THAT(load_error(folder / "flat.nrrd"), HasSubstr("at least 2"));
  write_nrrd(folder / "plane.nrrd", "type: short\ndimension: 2\nsizes: 20 3\n", voxels);
  EXPECT_THAT(load_error(folder / "plane.nrrd"), HasSubstr("2D image"));
  write_nrrd(folder / "truncated.nrrd", short_3d + "sizes: 5 4 3\n", voxels.substr(0, 70));
  EXPECT_THAT(load_error(folder / "truncated.nrrd"), HasSubstr("50 of the 120 bytes"));
  write_nrrd(folder / "huge.nrrd", short_3d + "sizes: 2000 1000 1000\n", voxels);
  EXPECT_THAT(load_error(folder / "huge.nrrd"), HasSubstr("3999999880 of the 4000000000 bytes"));
  write_nrrd(folder / "giant.nrrd", short_3d + "sizes: 200000 100000 100000\n", voxels);
  EXPECT_THAT(load_error(folder / "giant.nrrd"), HasSubstr("2^32"));
  write_nrrd(folder / "sheared.nrrd",
             short_3d +
                 "space: left-posterior-superior\nsizes: 5 4 3\n"
                 "space directions: (1,0,0) (0.5,1,0) (0,0,1)\nspace origin: (0,0,0)\n",
             bytes_of<std::int16_t>({1, 2}) + voxels.substr(4));
  EXPECT_THAT(load_error(folder / "sheared.nrrd"), HasSubstr("perpendicular"));
}

TEST(LoadErrors, NotANumberIsRefused) {
  const TestFolder folder;
  Volume volume = varied_volume();
  volume.values.unpack()[7] = std::numeric_limits<float>::quiet_NaN();
  save_volume(folder / "v.nrrd", volume);
  EXPECT_THAT(load_error(folder / "v.nrrd"), HasSubstr("NaN"));
}

TEST(LoadErrors, SaveRefusesUnknownKindsAndMissingFolders) {
  const TestFolder folder;
  EXPECT_THROW(save_volume(folder / "v.stl", varied_volume()), Error);
  EXPECT_THROW(save_volume(folder / "none" / "v.nrrd", varied_volume()), Error);
}

/// Feeds a damaged file to the loader: it must give a volume or an Error, nothing else.
void expect_no_crash(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  write_plainly(path, bytes);
  try {
    const Volume volume = load_volume(path);
    EXPECT_EQ(volume.values.size(), volume.voxels());
    EXPECT_GT(volume.voxels(), 0U);
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
  }
}

class Damaged : public testing::TestWithParam<const char*> {};

TEST_P(Damaged, FilesGiveAVolumeOrAnError) {
  const LibraryLeaksIgnored ignored;
  const TestFolder folder;
  const auto path = folder / GetParam();
  save_volume(path, varied_volume());
  const std::vector<std::uint8_t> whole = read_file(path);
  testing::internal::CaptureStderr();
  for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 60) {
    expect_no_crash(path, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  Rng rng(11);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::uint32_t flips = 1 + rng.below(4); flips > 0; --flips) {
      bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] ^=
          static_cast<std::uint8_t>(1U << rng.below(8));
    }
    expect_no_crash(path, bytes);
  }
  testing::internal::GetCapturedStderr();
}

INSTANTIATE_TEST_SUITE_P(Formats, Damaged, testing::Values("v.nii", "v.nii.gz", "v.nrrd", "v.mha"));

TEST(RealData, FilesLoad) {
  if (!std::filesystem::exists(data_folder() / "chest.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data_folder();
  }
  const Volume chest = load_volume(data_folder() / "chest.nrrd");
  EXPECT_EQ(chest.modality, Modality::kCt);
  EXPECT_EQ(chest.dims, IVec3(256, 256, 275));
  EXPECT_EQ(choose_preset(chest).name, "soft-tissue");
  const Volume abdomen = load_volume(data_folder() / "abdomen_pelvis_3mm.nii.gz");
  EXPECT_EQ(abdomen.modality, Modality::kCt);
  EXPECT_NEAR(abdomen.origin.z, 94.3018f, 1e-3f);
}

}  // namespace
}  // namespace clipgs
