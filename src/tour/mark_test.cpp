#include "tour/mark.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tour/label_layout.h"
#include "tour/link.h"
#include "tour/region.h"

#include "core/file.h"

namespace clipgs {
namespace {

using nlohmann::json;

json fixture() { return json::parse(read_text(CLIPGS_SOURCE_DIR "/src/tour/marks.json")); }

void expect_at(const glm::dvec3& point, const json& expected, const std::string& what) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(point[k], expected[static_cast<size_t>(k)].get<double>(), 1e-9) << what;
  }
}

TEST(Mark, IsReadOfALinkAndMeasuredAsTheViewerDoes) {
  for (const json& one : fixture()["marks"]) {
    const auto link = one["link"].get<std::string>();
    const std::vector<Mark> marks = Link(link).marks();
    ASSERT_EQ(marks.size(), one["marks"].size()) << link;
    for (size_t i = 0; i < marks.size(); ++i) {
      const json& expected = one["marks"][i];
      const auto lines = lines_of(marks[i]);
      const std::string text = mark_text(marks[i], nullptr);
      EXPECT_EQ(text, expected["text"] == "" ? "Point" : expected["text"]) << link;
      expect_at(anchor_of(marks[i]), expected["anchor"], link);
      ASSERT_EQ(lines.size(), expected["points"].size()) << link;
      if (!lines.empty()) {
        ASSERT_EQ(lines[0].size(), expected["points"][0]) << link;
        expect_at(lines[0][lines[0].size() / 3], expected["end"], link);
      }
    }
  }
}

TEST(Mark, IsNoneWhereItsNumbersAreNot) {
  EXPECT_FALSE(make_mark(MarkKind::kPoint, {}));
  EXPECT_FALSE(make_mark(MarkKind::kPoint, {1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(make_mark(MarkKind::kLength, {1, 2, 3, 4, 5}));
  EXPECT_FALSE(make_mark(MarkKind::kRegion, {0, 0, 0, 1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(make_mark(MarkKind::kOutline, std::vector<double>(3 * (kMostCorners + 2), 1.0)));
  EXPECT_TRUE(make_mark(MarkKind::kOutline, std::vector<double>(3 * (kMostCorners + 1), 1.0)));
}

TEST(Region, HasTheValuesThatTheVolumeHasWithin) {
  Section section;
  section.dims = IVec3(32, 32, 4);
  section.modality = Modality::kCt;
  section.voxels.assign(section.voxel_count(), 40);
  std::vector<float> values;
  for (size_t code = 0; code < ValueCurve::kCodes; ++code) {
    values.push_back(10 * static_cast<float>(code));
  }
  section.curve = ValueCurve(values);
  for (int y = 0; y < 32; ++y) {
    for (int x = 16; x < 32; ++x) {
      section.voxels[section.offset(x, y, 1)] = 60;
    }
  }
  const auto of_left =
      region_values(*make_mark(MarkKind::kRegion, {0, 0, 1, 8, 16, 1, 12, 16, 1}), section);
  ASSERT_TRUE(of_left);
  EXPECT_NEAR(of_left->mean, 400, 1e-3);
  EXPECT_NEAR(of_left->deviation, 0, 1e-3);
  const Mark both =
      *make_mark(MarkKind::kOutline, {0, 0, 1, 10.5, 4, 1, 20.5, 4, 1, 20.5, 20, 1, 10.5, 20, 1});
  const auto of_both = region_values(both, section);
  ASSERT_TRUE(of_both);
  EXPECT_NEAR(of_both->mean, 500, 2);
  EXPECT_NEAR(of_both->deviation, 97, 3);
  EXPECT_TRUE(mark_text(both, &section).starts_with("1.60 cm² · mean "));
  EXPECT_FALSE(
      region_values(*make_mark(MarkKind::kRegion, {0, 0, 1, 500, 500, 1, 501, 500, 1}), section));
}

TEST(LabelLayout, IsTheViewers) {
  const json all = fixture();
  const glm::dvec2 picture(all["picture"][0], all["picture"][1]);
  const glm::dvec2 moved(all["moved"][0], all["moved"][1]);
  for (const json& one : all["layouts"]) {
    std::vector<Label> labels;
    for (const json& label : one["labels"]) {
      labels.push_back({{label[0], label[1]}, {label[2], label[3]}, {}});
      for (size_t k = 4; k < label.size(); k += 2) {
        labels.back().line.emplace_back(label[k], label[k + 1]);
      }
    }
    const auto choices = [&](std::span<const std::optional<size_t>> before) {
      std::vector<std::optional<size_t>> result;
      for (const LaidLabel& laid : lay_out(labels, picture, before)) {
        result.emplace_back(laid.choice);
      }
      return result;
    };
    const auto first = choices({});
    for (Label& label : labels) {
      label.anchor += moved;
      for (glm::dvec2& point : label.line) {
        point += moved;
      }
    }
    const auto again = choices(first);
    for (size_t i = 0; i < labels.size(); ++i) {
      EXPECT_EQ(*first[i], one["first"][i].get<size_t>()) << i;
      EXPECT_EQ(*again[i], one["again"][i].get<size_t>()) << i;
    }
  }
}

}  // namespace
}  // namespace clipgs
