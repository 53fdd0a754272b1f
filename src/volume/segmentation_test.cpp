#include "volume/segmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/label_looks.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A grid turned a little away from the patient's axes; values differ.
Volume make_scan() {
  Volume volume;
  volume.dims = {8, 7, 6};
  volume.spacing = {1, 1.5f, 2};
  volume.direction = glm::mat3_cast(glm::angleAxis(0.2f, glm::normalize(Vec3(1, 1, 2))));
  volume.origin = {-12, 34, 56};
  for (size_t i = 0; i < volume.voxels(); ++i) {
    volume.values.unpack().push_back(static_cast<float>(i));
  }
  return volume;
}

template <typename LabelAt>
Volume labels_on(Volume grid, const LabelAt& label_at) {
  for (size_t i = 0; i < grid.voxels(); ++i) {
    grid.values.unpack()[i] = static_cast<float>(label_at(i));
  }
  return grid;
}

std::string error_of_labels(const Volume& labels) {
  const TestFolder folder;
  save_volume(folder / "labels.nrrd", labels);
  Volume scan = make_scan();
  return error_of([&] { add_labels(scan, folder / "labels.nrrd"); });
}

class Segmentation : public testing::TestWithParam<const char*> {};

TEST_P(Segmentation, OfTheSameGridIsTakenAsItIs) {
  const TestFolder folder;
  save_volume(folder / "scan.nrrd", make_scan());
  const auto label_at = [](size_t i) { return i % 5 == 0 ? 2035 : i % 3 == 0 ? -1 : 0; };
  save_volume(folder / GetParam(), labels_on(make_scan(), label_at));
  LoadOptions options;
  options.labels = folder / GetParam();
  const Volume volume = load_volume(folder / "scan.nrrd", options);
  EXPECT_THAT(volume.label_numbers, ElementsAre(0, -1, 2035));
  ASSERT_EQ(volume.labels.size(), volume.voxels());
  for (size_t i = 0; i < volume.voxels(); ++i) {
    EXPECT_EQ(volume.label_numbers[volume.labels[i]], label_at(i));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Segmentation,
                         testing::Values("labels.nii.gz", "labels.nrrd", "labels.mha"));

TEST(SegmentationGrid, OfAnotherGridIsTakenFromTheNearestVoxel) {
  // Coarser, along the patient's axes, and smaller than the scan.
  Volume labels;
  labels.dims = {3, 4, 3};
  labels.spacing = {2, 2, 3};
  Volume scan = make_scan();
  labels.origin = scan.world_from_index(Vec3(2, 2, 1));
  for (size_t i = 0; i < labels.voxels(); ++i) {
    labels.values.unpack().push_back(static_cast<float>(i + 1));
  }
  const TestFolder folder;
  save_volume(folder / "labels.nii.gz", labels);
  add_labels(scan, folder / "labels.nii.gz");
  size_t outside = 0;
  for (int z = 0; z < scan.dims.z; ++z) {
    for (int y = 0; y < scan.dims.y; ++y) {
      for (int x = 0; x < scan.dims.x; ++x) {
        const Vec3 there = labels.index_from_world(scan.world_from_index(Vec3(x, y, z)));
        const Vec3 near = glm::round(there);
        if (glm::any(glm::greaterThan(glm::abs(there - near), Vec3(0.499f)))) {
          continue;  // a tie
        }
        int expected = 0;
        if (glm::all(glm::greaterThanEqual(near, Vec3(0))) &&
            glm::all(glm::lessThan(near, Vec3(labels.dims)))) {
          const IVec3 at(near);
          expected = static_cast<int>(labels.at(at.x, at.y, at.z));
        }
        outside += expected == 0 ? 1 : 0;
        EXPECT_EQ(scan.label_numbers[scan.labels[scan.offset(x, y, z)]], expected);
      }
    }
  }
  EXPECT_GT(outside, 50U);
  EXPECT_LT(outside, scan.voxels() - 50);
}

TEST(SegmentationErrors, SayWhatIsWrong) {
  const Volume scan = make_scan();
  EXPECT_THAT(error_of_labels(labels_on(scan, [](size_t i) { return i == 77 ? 0.5 : 1; })),
              HasSubstr("labels.nrrd: holds the value 0.5"));
  EXPECT_THAT(error_of_labels(labels_on(scan, [](size_t i) { return i; })),
              HasSubstr("more than 255 labels"));
  EXPECT_EQ(error_of_labels(labels_on(scan, [](size_t i) { return i % 256; })), "");
  EXPECT_THAT(error_of_labels(labels_on(scan, [](size_t) { return 0; })), HasSubstr("no label"));
  Volume elsewhere = labels_on(scan, [](size_t) { return 1; });
  elsewhere.origin += Vec3(500, 0, 0);
  EXPECT_THAT(error_of_labels(elsewhere), HasSubstr("same patient space"));
  Volume volume = scan;
  EXPECT_THAT(error_of([&] { add_labels(volume, "/nonesuch.nii"); }), HasSubstr("no such file"));
}

TEST(LabelLooks, AreParsed) {
  const auto [number, look] = parse_label("12=#ff0000,0.25");
  EXPECT_EQ(number, 12);
  EXPECT_EQ(look.albedo, Vec3(1, 0, 0));
  EXPECT_EQ(look.opacity, 0.25f);
  EXPECT_EQ(parse_label("0=hidden").second.opacity, 0);
  EXPECT_EQ(parse_label("3=0.5").second.opacity, 0.5f);
  EXPECT_EQ(parse_label("3=0.5").second.albedo, std::nullopt);
  for (const char* wrong : {"", "3", "3=", "=0.5", "x=0.5", "3=red", "3=#ff", "3=0.5,0.6", "3=2",
                            "3=nan", "3.5=hidden", "3=#ff0000,#00ff00"}) {
    EXPECT_THAT(error_of([&] { parse_label(wrong); }), HasSubstr("label")) << wrong;
  }
}

TEST(LabelLooks, AreReadFromATable) {
  const TestFolder folder;
  const auto table = [&](const std::string& text) {
    write_text(folder / "table.json", text);
    return load_label_table(folder / "table.json");
  };
  const LabelLooks looks = table(R"({"labels": [
    {"label": 1, "name": "liver", "color": "#ffffff", "opacity": 0.5, "visible": true},
    {"label": 2, "visible": false}, {"label": 3}]})");
  ASSERT_EQ(looks.size(), 3U);
  EXPECT_EQ(looks.at(1).albedo, Vec3(1));
  EXPECT_EQ(looks.at(1).opacity, 0.5f);
  EXPECT_EQ(looks.at(2).opacity, 0);
  EXPECT_EQ(looks.at(3).opacity, 1);
  EXPECT_EQ(looks.at(3).albedo, std::nullopt);
  for (const auto& [text, says] : {std::pair{"{}", "labels is missing"},
                                   {R"({"labels": [{"label": 1}, {"label": 1}]})", "twice"},
                                   {R"({"labels": [{"label": 1.5}]})", "labels[0].label"},
                                   {R"({"labels": [{"label": 1, "colour": "#fff"}]})", "colour"},
                                   {R"({"labels": [{"label": 1, "visible": 0}]})", "visible"},
                                   {"no", "not JSON"}}) {
    EXPECT_THAT(error_of([&, json = text] { table(json); }), HasSubstr(says));
  }
}

TEST(LabelLooks, PaletteTellsLabelsApart) {
  const LabelLooks looks = label_palette({0, 4, 5, 6, 9});
  EXPECT_FALSE(looks.contains(0));
  EXPECT_EQ(looks.size(), 4U);
  for (const auto& [a, first] : looks) {
    for (const auto& [b, second] : looks) {
      EXPECT_TRUE(a == b || glm::length(*first.albedo - *second.albedo) > 0.2f);
    }
  }
}

}  // namespace
}  // namespace clipgs
