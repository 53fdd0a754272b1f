#include "asset/glb.h"

#include <cstring>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace clipgs {
namespace {

using nlohmann::json;

std::uint32_t word(const Bytes& file, size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, &file[at], sizeof(value));
  return value;
}

TEST(Glb, HoldsEverySplatInItsAxes) {
  Gaussians splats(2, 1);
  splats.plane(0)[1] = 1;  // at (1, 2, 3): x right, y down, z forward
  splats.plane(1)[1] = 2;
  splats.plane(2)[1] = 3;
  splats.plane(Gaussians::kLogScale + 1)[1] = 0.5f;
  splats.plane(Gaussians::kRotation)[0] = splats.plane(Gaussians::kRotation)[1] = 1;
  splats.plane(Gaussians::kSh + 3)[1] = 0.25f;  // of y, which turns with it
  const Bytes file = encode_glb(splats);
  ASSERT_EQ(word(file, 0), 0x46546c67u);
  EXPECT_EQ(word(file, 4), 2);
  EXPECT_EQ(word(file, 8), file.size());
  const size_t json_size = word(file, 12);
  const json document =
      json::parse(file.begin() + 20, file.begin() + 20 + static_cast<std::ptrdiff_t>(json_size));
  const size_t body = 20 + json_size + 8;
  EXPECT_EQ(document["buffers"][0]["byteLength"], word(file, 20 + json_size));
  EXPECT_EQ(document["extensionsUsed"], json::array({"KHR_gaussian_splatting"}));
  const json& primitive = document["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  const auto value = [&](const char* name, size_t i, size_t component) {
    const json& accessor = document["accessors"][primitive["attributes"][name].get<size_t>()];
    const json& view = document["bufferViews"][accessor["bufferView"].get<size_t>()];
    const size_t components = accessor["type"] == "VEC4" ? 4 : accessor["type"] == "VEC3" ? 3 : 1;
    float number = 0;
    std::memcpy(&number,
                &file[body + view["byteOffset"].get<size_t>() + 4 * (i * components + component)],
                sizeof(number));
    return number;
  };
  EXPECT_EQ(value("POSITION", 1, 0), 1);
  EXPECT_EQ(value("POSITION", 1, 1), -2);
  EXPECT_EQ(value("POSITION", 1, 2), -3);
  EXPECT_NEAR(value("KHR_gaussian_splatting:SCALE", 1, 1), std::exp(0.5f), 1e-5f);
  EXPECT_NEAR(value("KHR_gaussian_splatting:OPACITY", 0, 0), 0.5f, 1e-6f);
  EXPECT_NEAR(value("KHR_gaussian_splatting:SH_DEGREE_1_COEF_0", 1, 0), -0.25f, 1e-5f);
  EXPECT_EQ(document["accessors"][0]["min"], json({0, -2, -3}));
}

}  // namespace
}  // namespace clipgs
