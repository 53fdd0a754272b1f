#include "volume/deface.h"

#include <algorithm>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "volume/crop.h"
#include "volume/load.h"
#include "volume/test_ct.h"
#include "volume/test_folder.h"
#include "volume/test_head.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

Mat3 turned(float degrees, const Vec3& axis) {
  return glm::mat3_cast(glm::angleAxis(glm::radians(degrees), axis));
}

class DefacedHead : public testing::TestWithParam<Modality> {};

/// Every voxel within 5 mm of the brain is as it was, and eyes, nose and chin are nothing.
void expect_defaced(const Volume& before, const Mat3& turn) {
  Volume after = before;
  deface(after, "head");
  const float nothing = before.modality == Modality::kCt ? -1024 : before.values.range().min;
  size_t eyes = 0;
  size_t nose = 0;
  size_t far = 0;
  for (size_t i = 0; i < before.voxels(); ++i) {
    const IVec3 at(i % before.dims.x, i / before.dims.x % before.dims.y,
                   i / before.offset(0, 0, 1));
    const Vec3 place = before.world_from_index(Vec3(at)) * turn;
    const HeadPart part = head_part(place);
    const bool changed = after.values[i] != before.values[i];
    ASSERT_FALSE(changed && in_ellipsoid(place, Vec3(0), kBrainRadii + 5.0f)) << place.y;
    ASSERT_FALSE(changed && part == HeadPart::kBrain) << place.z;
    ASSERT_TRUE(!changed || after.values[i] == nothing);
    eyes += part == HeadPart::kEye && after.values[i] != nothing ? 1 : 0;
    nose += part == HeadPart::kNose && after.values[i] != nothing ? 1 : 0;
    const bool in_front = place.y > 75 && place.z < -45 && place.z > -125;
    far += in_front && part != HeadPart::kAir && after.values[i] != nothing ? 1 : 0;
    ASSERT_FALSE(changed && place.y < 10 && std::abs(place.x) < 60) << "the throat stays";
  }
  EXPECT_EQ(eyes, 0);
  EXPECT_EQ(nose, 0);
  EXPECT_EQ(far, 0);
  ASSERT_TRUE(after.defaced);
  EXPECT_GT(after.defaced->removed_ml, 200);
  EXPECT_LT(after.defaced->removed_ml, 600);
  EXPECT_GE(after.defaced->brain_mm, Face::kFromBrain);
}

TEST_P(DefacedHead, HasABrainAndNoFace) { expect_defaced(scanned_head(GetParam()), Mat3(1)); }

TEST_P(DefacedHead, MayBeTurnedAndNod) {
  for (const Mat3& turn : {turned(12, {0, 0, 1}), turned(-15, {1, 0, 0}), turned(15, {1, 0, 0})}) {
    expect_defaced(scanned_head(GetParam(), turn, 3), turn);
  }
}

TEST_P(DefacedHead, IsTheSameAtAnyNumberOfThreads) {
  const auto with = [](int threads) {
    set_thread_count(threads);
    Volume volume = scanned_head(GetParam());
    deface(volume, "head");
    set_thread_count(0);
    return volume;
  };
  const Volume one = with(1);
  const Volume two = with(2);
  EXPECT_EQ(one.values, two.values);
  EXPECT_EQ(one.defaced, two.defaced);
}

INSTANTIATE_TEST_SUITE_P(Modalities, DefacedHead, testing::Values(Modality::kCt, Modality::kMr),
                         [](const auto& one) { return std::string(modality_name(one.param)); });

TEST(Deface, OfALargerBodyTakesTheFaceAlone) {
  // Shoulders and a chest below, which hold more soft tissue than the brain.
  Volume volume = scanned_head(Modality::kCt);
  std::vector<float>& values = volume.values.unpack();
  for (int z = 0; z < 12; ++z) {
    for (int y = 20; y < 60; ++y) {
      for (int x = 2; x < volume.dims.x - 2; ++x) {
        values[volume.offset(x, y, z)] = 50;
      }
    }
  }
  const Volume before = volume;
  deface(volume, "body");
  for (size_t i = 0; i < before.voxels(); ++i) {
    if (before.values[i] == 50) {
      ASSERT_EQ(volume.values[i], 50);
    }
  }
  EXPECT_EQ(volume.values[volume.offset(volume.dims.x / 2, 87, 36)], -1024) << "the nose";
}

TEST(Deface, TakesLabelsOffAsWell) {
  Volume volume = scanned_head(Modality::kMr);
  volume.labels.assign(volume.voxels(), 1);
  volume.label_numbers = {0, 7};
  const Volume before = volume;
  deface_labels(volume, deface(volume, "head"));
  for (size_t i = 0; i < volume.voxels(); ++i) {
    if (volume.values[i] != before.values[i]) {
      ASSERT_EQ(volume.labels[i], 0);
    }
  }
  EXPECT_EQ(volume.labels[volume.offset(40, 48, 64)], 1) << "the middle of the brain";
}

/// What deface() says of it; it must stay as it is.
std::string refusal(Volume volume) {
  const VoxelValues before = volume.values;
  std::string said = error_of([&] { deface(volume, "scan"); });
  EXPECT_EQ(volume.values, before) << said;
  EXPECT_FALSE(volume.defaced);
  EXPECT_FALSE(shows_face(volume)) << said;
  return said;
}

Volume mr_where(const std::function<float(const Vec3&)>& signal) {
  Volume volume = scanned_head(Modality::kMr);
  std::vector<float>& values = volume.values.unpack();
  for (size_t i = 0; i < values.size(); ++i) {
    const IVec3 at(i % volume.dims.x, i / volume.dims.x % volume.dims.y,
                   i / volume.offset(0, 0, 1));
    values[i] = signal(volume.world_from_index(Vec3(at)));
  }
  return volume;
}

TEST(Deface, RefusesWhatIsNoHead) {
  EXPECT_THAT(refusal(ct_of(limb_hu, kHeadSize)), HasSubstr("scan: --deface: there is no head"));
  EXPECT_THAT(refusal(ct_of(chest_hu, kTrunkSize)), HasSubstr("there is no head"));
  Volume thigh = mr_where([](const Vec3& p) {  // as much muscle as a brain, in bright fat
    return in_cylinder(p, {0, 0}, {65, 75})   ? 100.0f
           : in_cylinder(p, {0, 0}, {80, 90}) ? 200.0f
                                              : 2.0f;
  });
  crop(thigh, {IVec3(0), IVec3(thigh.dims.x - 1, thigh.dims.y - 1, 47)});
  EXPECT_THAT(refusal(thigh), HasSubstr("there is no head"));
  Volume knee = scanned_head(Modality::kMr);
  knee.part = BodyPart::kKnee;
  EXPECT_THAT(refusal(knee), HasSubstr("--region"));
}

TEST(Deface, SaysWhereThereIsNoFace) {
  Volume above = scanned_head(Modality::kCt);
  crop(above, {IVec3(0, 0, 60), above.dims - 1});
  EXPECT_THAT(refusal(above), HasSubstr("the picture ends before"));
  Volume within = scanned_head(Modality::kMr);
  crop(within, {IVec3(22, 0, 0), IVec3(58, within.dims.y - 1, within.dims.z - 1)});
  EXPECT_THAT(refusal(within), HasSubstr("ends within the brain"));
  EXPECT_THAT(refusal(mr_where([](const Vec3& p) {
                return in_ellipsoid(p, Vec3(0), kBrainRadii) ? 100.0f + p.x / 10 : 0.0f;
              })),
              HasSubstr("nothing around it"));
}

TEST(Deface, RefusesOtherModalities) {
  for (const Modality modality : {Modality::kPhoto, Modality::kPet, Modality::kUltrasound}) {
    Volume volume = scanned_head(Modality::kMr);
    volume.modality = modality;
    EXPECT_THAT(refusal(volume), HasSubstr("is for CT and MR"));
  }
  Volume unknown = scanned_head(Modality::kCt);
  unknown.values.transform([](float hu) { return std::round((hu + 1024) / 16); });
  unknown.modality = Modality::kUnknown;
  EXPECT_THAT(refusal(unknown), HasSubstr("--hu"));
}

TEST(Deface, IsAStepOfLoading) {
  const TestFolder folder;
  save_volume(folder / "head.nrrd", scanned_head(Modality::kCt));
  LoadOptions options;
  options.warn_of_face = true;
  testing::internal::CaptureStderr();
  EXPECT_FALSE(load_with_series(folder / "head.nrrd", options).volume.defaced);
  const std::string warned = testing::internal::GetCapturedStderr();
  const size_t first = warned.find("this is a head with a face");
  ASSERT_NE(first, std::string::npos) << warned;
  EXPECT_EQ(warned.find("this is a head with a face", first + 1), std::string::npos);

  options.deface = true;
  options.prepare.crop_to_matter = true;
  int watched = 0;
  options.watch_deface = [&](const Volume& volume) {
    EXPECT_EQ(volume.defaced.has_value(), watched == 1);
    ++watched;
  };
  testing::internal::CaptureStderr();
  const LoadedVolume loaded = load_with_series(folder / "head.nrrd", options);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("of face and ears off"));
  EXPECT_EQ(watched, 2);
  ASSERT_TRUE(loaded.volume.defaced);
  const auto step = std::ranges::find(loaded.prepared, "deface", &PreparationStep::name);
  ASSERT_NE(step, loaded.prepared.end());
  EXPECT_EQ(step->figures[0].second, loaded.volume.defaced->removed_ml);
  EXPECT_EQ(loaded.prepared.back().name, "crop");
  EXPECT_LT(loaded.volume.dims.y, scanned_head(Modality::kCt).dims.y) << "no face is left around";
}

TEST(RealData, HeadsAreDefaced) {
  const std::filesystem::path data = data_folder();
  if (!std::filesystem::exists(data / "head.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data;
  }
  LoadOptions hu;
  hu.hu = Rescale{16, -1024};
  for (const auto& [file, options, ml] :
       {std::tuple{"head.nrrd", hu, Vec2(500, 800)},
        std::tuple{"chris_t1.nii.gz", LoadOptions{}, Vec2(200, 400)}}) {
    Volume volume = load_volume(data / file, options);
    EXPECT_TRUE(shows_face(volume)) << file;
    deface(volume, file);
    EXPECT_GT(volume.defaced->removed_ml, ml.x) << file;
    EXPECT_LT(volume.defaced->removed_ml, ml.y) << file;
    EXPECT_GE(volume.defaced->brain_mm, Face::kFromBrain) << file;
  }
  EXPECT_THAT(refusal(load_volume(data / "spm152.nii.gz")), HasSubstr("nothing around it"));
  for (const char* file : {"chris_MRA.nii.gz", "chest.nrrd"}) {
    EXPECT_NE(refusal(load_volume(data / file)), "") << file;
  }
}

}  // namespace
}  // namespace clipgs
