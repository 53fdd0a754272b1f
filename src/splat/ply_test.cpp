#include "splat/ply.h"

#include <cstring>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::filesystem::path temporary_ply(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / ("clipgs_ply_test_" + name);
}

/// A PLY of one vertex whose property number k has the value k + 1.
std::vector<std::uint8_t> one_vertex(const std::vector<std::string>& properties,
                                     const std::string& before_end = "") {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment made by a test\n";
  text += "element vertex 1\n";
  for (const std::string& property : properties) {
    text += "property float " + property + "\n";
  }
  text += before_end + "end_header\n";
  std::vector<std::uint8_t> bytes(text.begin(), text.end());
  for (size_t k = 0; k < properties.size(); ++k) {
    const auto value = static_cast<float>(k + 1);
    bytes.resize(bytes.size() + sizeof(float));
    std::memcpy(bytes.data() + bytes.size() - sizeof(float), &value, sizeof(float));
  }
  return bytes;
}

const std::vector<std::string> kShuffled = {"opacity", "rot_3",   "rot_2",   "rot_1",  "rot_0",
                                            "f_dc_2",  "f_dc_1",  "f_dc_0",  "z",      "y",
                                            "x",       "scale_2", "scale_1", "scale_0"};

TEST(Ply, RoundTripIsExactAtEveryDegree) {
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    const Gaussians written = random_gaussians(100, degree, 7);
    const auto path = temporary_ply("round_trip.ply");
    write_ply(path, written);
    const Gaussians read = read_ply(path);
    EXPECT_EQ(read.sh_degree(), degree);
    EXPECT_EQ(read.data(), written.data());
  }
}

TEST(Ply, FaceColoursGoRoundToo) {
  const Gaussians written = random_faces(100, 1, 7);
  const auto path = temporary_ply("faces.ply");
  write_ply(path, written);
  const Gaussians read = read_ply(path);
  EXPECT_TRUE(read.is_like(written));
  EXPECT_EQ(read.data(), written.data());
}

TEST(Ply, WritesThe62FloatsOf3dgs) {
  const auto path = temporary_ply("floats.ply");
  write_ply(path, random_gaussians(3, 3, 7));
  const std::string text = read_text(path);
  const size_t body = text.find("end_header\n") + std::strlen("end_header\n");
  EXPECT_EQ(text.size() - body, 3u * 248);
  EXPECT_THAT(text, HasSubstr("property float nz\nproperty float f_dc_0\n"));
  EXPECT_THAT(text, HasSubstr("property float f_rest_44\nproperty float opacity\n"));
}

TEST(Ply, RestIsChannelMajor) {
  std::vector<std::string> properties = kShuffled;
  for (int k = 0; k < 9; ++k) {
    properties.push_back("f_rest_" + std::to_string(k));
  }
  const Gaussians g = read_ply(one_vertex(properties), "test.ply");
  ASSERT_EQ(g.sh_degree(), 1);
  // f_rest_k has the value 15 + k; coefficient 1 of red, green, blue is k = 0, 3, 6.
  EXPECT_EQ(g.plane(Gaussians::kSh + 3)[0], 15);
  EXPECT_EQ(g.plane(Gaussians::kSh + 4)[0], 18);
  EXPECT_EQ(g.plane(Gaussians::kSh + 5)[0], 21);
  EXPECT_EQ(g.plane(Gaussians::kSh + 6)[0], 16);
}

TEST(Ply, AcceptsAnyOrderAndSkipsOtherProperties) {
  const Gaussians g = read_ply(one_vertex(kShuffled), "test.ply");
  EXPECT_EQ(g.sh_degree(), 0);
  EXPECT_EQ(g.mean(0), Vec3(11, 10, 9));
  EXPECT_EQ(g.plane(Gaussians::kRotation)[0], 5);
  EXPECT_EQ(g.plane(Gaussians::kOpacity)[0], 1);
  EXPECT_EQ(g.plane(Gaussians::kLogScale)[0], 14);

  std::vector<std::uint8_t> bytes = one_vertex(kShuffled, "property uchar red\n");
  EXPECT_THROW(read_ply(bytes, "test.ply"), Error);  // one byte short
  bytes.push_back(9);
  EXPECT_EQ(read_ply(bytes, "test.ply").data(), g.data());
}

TEST(Ply, RefusesWhatItCannotRead) {
  const auto refuses = [](std::vector<std::uint8_t> bytes, const char* message) {
    EXPECT_THAT([&] { read_ply(bytes, "test.ply"); }, ThrowsMessage<Error>(HasSubstr(message)));
  };
  const auto text = [](const std::string& s) {
    return std::vector<std::uint8_t>(s.begin(), s.end());
  };
  refuses({}, "not a PLY");
  refuses(text("PK\3\4"), "not a PLY");
  refuses(text("ply\nformat binary_little_endian 1.0\n"), "no end");
  refuses(text("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n"), "ascii");
  refuses(text("ply\nformat binary_big_endian 1.0\nend_header\n"), "big_endian");
  refuses(text("ply\nelement vertex 1\nproperty float x\nend_header\n"), "no format");
  refuses(text("ply\nformat binary_little_endian 1.0\nelement vertex -5\nend_header\n"), "number");
  refuses(text("ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999\nend_header\n"),
          "number");
  refuses(one_vertex(kShuffled, "element face 1\n"), "more than one element");
  refuses(one_vertex(kShuffled, "property list uchar int vertex_index\n"), "plain number");
  refuses(one_vertex(kShuffled, "property float x\n"), "twice");
  refuses(one_vertex({"x", "y", "z"}), "scale_0");

  std::vector<std::string> rest = kShuffled;
  rest.emplace_back("f_rest_0");
  refuses(one_vertex(rest), "f_rest");

  std::vector<std::string> faces = kShuffled;
  faces.emplace_back("f_face_0");
  refuses(one_vertex(faces), "f_face_4");

  std::vector<std::uint8_t> truncated = one_vertex(kShuffled);
  truncated.pop_back();
  refuses(truncated, "truncated");

  std::vector<std::uint8_t> nan = one_vertex(kShuffled);
  const float value = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan.data() + nan.size() - sizeof(float), &value, sizeof(float));
  refuses(nan, "scale_0 of splat 0");
}

}  // namespace
}  // namespace clipgs
