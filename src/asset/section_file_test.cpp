#include "asset/section_file.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "section/test_section.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using nlohmann::json;

Section make(int channels) {
  Section section = test::ball_section();
  Rng rng(1);  // a scanner's noise, where there is tissue
  for (std::uint8_t& code : section.voxels) {
    code = code > 40 ? static_cast<std::uint8_t>(code - rng.below(16)) : code;
  }
  if (channels == 3) {
    section.channels = 3;
    std::vector<std::uint8_t> rgb;
    for (const std::uint8_t code : section.voxels) {
      rgb.insert(rgb.end(), {code, static_cast<std::uint8_t>(code / 2), 30});
    }
    section.voxels = rgb;
    section.curve = ValueCurve();
  }
  return section;
}

Section with_boundary(Section section) {
  section.steep = SteepRange{5, 20};
  for (size_t i = 0; i < section.materials.size(); ++i) {
    section.materials[i].boundary = Vec3(0.2f, 0.5f, static_cast<float>(i) / 255);
  }
  return section;
}

void expect_same(const Section& a, const Section& b) {
  EXPECT_EQ(a.dims, b.dims);
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.spacing, b.spacing);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.source_spacing, b.source_spacing);
  EXPECT_EQ(a.modality, b.modality);
  EXPECT_EQ(a.curve.values(), b.curve.values());
  EXPECT_EQ(a.exposure, b.exposure);
  EXPECT_EQ(a.tone, b.tone);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(glm::length(a.direction[k] - b.direction[k]), 1e-6f);
  }
  ASSERT_EQ(a.rig.keys.size(), b.rig.keys.size());
  for (size_t i = 0; i < a.rig.keys.size(); ++i) {
    EXPECT_LT(glm::length(a.rig.keys[i].direction - b.rig.keys[i].direction), 1e-6f);
    EXPECT_EQ(a.rig.keys[i].radiance, b.rig.keys[i].radiance);
  }
  for (size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_NEAR(a.materials[i].extinction, b.materials[i].extinction, 1e-3f);
    EXPECT_LT(glm::length(a.materials[i].surface - b.materials[i].surface), 1e-3f);
    EXPECT_LT(glm::length(a.materials[i].interior - b.materials[i].interior), 1e-3f);
    EXPECT_LT(glm::length(a.materials[i].boundary - b.materials[i].boundary), 1e-3f);
  }
  ASSERT_EQ(a.steep.has_value(), b.steep.has_value());
  if (a.steep) {
    EXPECT_EQ(a.steep->from, b.steep->from);
    EXPECT_EQ(a.steep->to, b.steep->to);
  }
}

class SectionFileTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Channels, SectionFileTest, testing::Values(1, 3));

TEST_P(SectionFileTest, RoundTripIsLossless) {
  const Section section = make(GetParam());
  const TestFolder folder;
  write_section(folder / "a.zip", section);
  const Section back = read_section(folder / "a.zip");
  expect_same(section, back);
  EXPECT_EQ(section.voxels, back.voxels);
  write_section(folder / "b.zip", section);
  EXPECT_EQ(read_text(folder / "a.zip"), read_text(folder / "b.zip"));
}

TEST_P(SectionFileTest, RefusesVoxelsThatAreNotThoseDescribed) {
  const TestFolder folder;
  write_section(folder / "a.zip", make(GetParam()));
  const std::map<std::string, Bytes> good =
      read_zip(read_file(folder / "a.zip", size_t{1} << 20), "a.zip");
  const auto refused = [&](const auto& change) {
    std::map<std::string, Bytes> bad = good;
    change(bad);
    std::vector<ZipEntry> entries;
    for (const auto& [name, bytes] : bad) {
      entries.push_back({name, bytes});
    }
    const Bytes zip = write_zip(entries);
    write_file(folder / "b.zip", zip.data(), zip.size());
    EXPECT_THROW(read_section(folder / "b.zip"), Error);
  };
  refused([](auto& files) { files["section.voxels"].pop_back(); });
  refused([](auto& files) { files["section.voxels"][9] ^= 1; });
  refused([](auto& files) { files.erase("section.voxels"); });
  refused([](auto& files) { files.erase("section.json"); });
  refused([](auto& files) { files["section.json"].resize(20); });
}

TEST_P(SectionFileTest, LossyCodingStatesItsError) {
  const Section section = make(GetParam());
  std::vector<ZipEntry> lossless;
  std::vector<ZipEntry> lossy;
  const json exact = encode_section(section, kLossless, lossless);
  const json coded = encode_section(section, 50, lossy);
  EXPECT_LT(lossy[0].bytes.size(), lossless[0].bytes.size());
  const auto worst = [](const json& errors) {
    return std::ranges::max(errors.get<std::vector<float>>());
  };
  EXPECT_GT(worst(coded["value_errors"]), worst(exact["value_errors"]));
  const Section back = decode_section(coded, {{lossy[0].name, lossy[0].bytes}}, "test");
  expect_same(section, back);
  double squares = 0;
  for (size_t i = 0; i < section.voxels.size(); ++i) {
    squares += std::pow(static_cast<double>(section.voxels[i]) - back.voxels[i], 2);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(section.voxels.size())), 12);
}

TEST(SectionFile, NamesAToneCurveInAVersionOfItsOwn) {
  Section section = make(1);
  std::vector<ZipEntry> files;
  const json plain = encode_section(section, kLossless, files);
  EXPECT_EQ(plain["version"], 1);
  EXPECT_FALSE(plain["lights"].contains("tone"));
  section.tone = ToneCurve::kFilmic;
  json filmic = encode_section(section, kLossless, files);
  EXPECT_EQ(filmic["version"], 2);
  EXPECT_EQ(filmic["lights"]["tone"], "filmic");
  const std::map<std::string, Bytes> images = {{files[0].name, files[0].bytes}};
  expect_same(section, decode_section(filmic, images, "test"));
  filmic["lights"].erase("tone");
  filmic["version"] = 1;
  EXPECT_EQ(filmic, plain);
}

TEST(SectionFile, NamesAVideoInAVersionOfItsOwn) {
  const Section section = make(1);
  std::vector<ZipEntry> files;
  const json good = encode_section(section, 97, files);
  EXPECT_EQ(good["version"], 3);
  EXPECT_EQ(files[0].name, "section.obu");
  const std::map<std::string, Bytes> videos = {{files[0].name, files[0].bytes}};
  expect_same(section, decode_section(good, videos, "test"));
  const auto refused = [&](const char* key, const json& value) {
    json bad = good;
    bad[key] = value;
    EXPECT_THROW(decode_section(bad, videos, "test"), Error) << key;
  };
  refused("coding", "vp9");
  refused("coding", 1);
  refused("channels", 3);
  refused("dims", {12, 10, 5});
  std::vector<ZipEntry> soon;
  EXPECT_EQ(encode_section(section, 97, soon, Saving::kTime)["version"], 1);
  std::vector<ZipEntry> colors;
  EXPECT_EQ(encode_section(make(3), 97, colors)["version"], 1);
}

TEST(SectionFile, HasABoundarysLookWhereThePresetHas) {
  std::vector<ZipEntry> files;
  Section section = make(1);
  EXPECT_FALSE(encode_section(section, kLossless, files).contains("boundary"));
  section = with_boundary(std::move(section));
  const json object = encode_section(section, kLossless, files);
  EXPECT_EQ(object["version"], 1);  // readers that leave it out miss a tint of walls
  expect_same(section, decode_section(object, {{files[0].name, files[0].bytes}}, "test"));
}

TEST(SectionFile, RefusesWhatIsMissingOrOutOfRange) {
  std::vector<ZipEntry> files;
  const json good = encode_section(with_boundary(make(1)), kLossless, files);
  const std::map<std::string, Bytes> images = {{files[0].name, files[0].bytes}};
  EXPECT_NO_THROW(decode_section(good, images, "test"));
  for (const auto& [key, value] : good.items()) {
    json bad = good;
    bad.erase(key);
    if (key != "checksum" && key != "boundary") {  // not all sections have them
      EXPECT_THROW(decode_section(bad, images, "test"), Error) << key;
    }
    bad[key] = "nonsense";
    if (key != "modality") {
      EXPECT_THROW(decode_section(bad, images, "test"), Error) << key;
    }
  }
  const auto refused = [&](const char* pointer, const json& value) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    EXPECT_THROW(decode_section(bad, images, "test"), Error) << pointer;
  };
  refused("/dims/0", 1e9);
  refused("/dims/0", 2.5);
  refused("/dims/0", 900);  // not what the image holds
  refused("/tile/0", 64);
  refused("/spacing/1", 0);
  refused("/axis_x/0", 5);
  refused("/channels", 2);
  refused("/curve/7", -1e6);
  refused("/materials/specular/3", 2);
  refused("/materials/surface_g/3", -1);
  refused("/boundary/from", -1);
  refused("/boundary/to", 5);
  refused("/boundary/g/3", -1);
  refused("/boundary/b", json::array());
  refused("/lights/exposure", 0);
  refused("/lights/tone", 1);
  refused("/lights/keys/0/direction/0", 9);
  EXPECT_THROW(decode_section(good, {}, "test"), Error);
  Bytes cut = files[0].bytes;
  cut.resize(cut.size() / 2);
  EXPECT_THROW(decode_section(good, {{files[0].name, cut}}, "test"), Error);
}

}  // namespace
}  // namespace clipgs
