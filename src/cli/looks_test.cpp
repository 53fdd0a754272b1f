// clipgs looks as a user runs it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asset/webp.h"
#include "cli/cli_fixture.h"
#include "core/geometry.h"
#include "core/image.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::run_clipgs;

// Tiles of two pictures and 44 px of text, 16 px apart, under a heading of 48 px.
constexpr int kSide = 64;
constexpr int kAcross = 2 * kSide + 16;
constexpr int kDown = kSide + 44 + 16;

class LooksTest : public CliTest {
 protected:
  std::vector<std::string> looks(const std::string& output,
                                 const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments = {"looks",  phantom(), "-o",    at(output),
                                          "--size", "64",      "--spp", "4"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  }

  /// A NRRD of 16³ voxels that are 0, all but the first `bright`.
  std::string write_specks(const std::string& name, int bright) const {
    std::string text =
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 16 16\nspace: right-anterior-superior\n"
        "space directions: (2,0,0) (0,2,0) (0,0,2)\nencoding: raw\nspace origin: (0,0,0)\n\n";
    text += std::string(static_cast<size_t>(bright), '\x64');
    text += std::string(static_cast<size_t>(16 * 16 * 16 - bright), '\0');
    write_text(at(name), text);
    return at(name);
  }
};

/// The square of kSide px at that place.
std::vector<float> square(const Image& sheet, int left, int top) {
  std::vector<float> values;
  for (int y = top; y < top + kSide; ++y) {
    values.insert(values.end(), sheet.at(left, y), sheet.at(left, y) + 3 * kSide);
  }
  return values;
}

/// Of a look: its uncut (0) or its cut (1) picture.
std::vector<float> picture(const Image& sheet, int look, int which) {
  const int columns = (sheet.width - 16) / kAcross;
  return square(sheet, 16 + look % columns * kAcross + which * kSide, 48 + look / columns * kDown);
}

/// How much of the longer side of a square what is no background takes, 0…1; 1 if it touches the
/// border.
double filled(const std::vector<float>& pixels) {
  const float* const corner = pixels.data();
  glm::ivec2 low(kSide);
  glm::ivec2 high(-1);
  for (int i = 0; i < kSide * kSide; ++i) {
    const float* const pixel = &pixels[3 * static_cast<size_t>(i)];
    if (std::abs(pixel[0] - corner[0]) + std::abs(pixel[2] - corner[2]) > 0.02f) {
      low = glm::min(low, glm::ivec2(i % kSide, i / kSide));
      high = glm::max(high, glm::ivec2(i % kSide, i / kSide));
    }
  }
  const bool touches = std::min(low.x, low.y) == 0 || std::max(high.x, high.y) == kSide - 1;
  return touches ? 1 : std::max(high.x - low.x, high.y - low.y) / double{kSide};
}

TEST_F(LooksTest, ASheetShowsEverySuitablePreset) {
  const Finished finished = run_clipgs(looks("sheet.png", {"--json"}));
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  EXPECT_EQ(json["auto_preset"], json["looks"][0]["preset"]);
  const auto count = static_cast<int>(json["looks"].size());
  EXPECT_GE(count, 7);

  const Image sheet = read_png(at("sheet.png"));
  ASSERT_EQ((sheet.width - 16) % kAcross, 0);
  ASSERT_EQ((sheet.height - 48) % kDown, 0);
  const int columns = (sheet.width - 16) / kAcross;
  EXPECT_EQ((sheet.height - 48) / kDown, (count + columns - 1) / columns);
  std::vector<std::vector<float>> pictures;
  for (int look = 0; look < count; ++look) {
    pictures.push_back(picture(sheet, look, 0));
    const double share = filled(pictures.back());
    EXPECT_GT(share, 0.8) << json["looks"][look]["preset"];
    EXPECT_LT(share, 1) << json["looks"][look]["preset"];
    pictures.push_back(picture(sheet, look, 1));
  }
  std::ranges::sort(pictures);
  EXPECT_EQ(std::ranges::adjacent_find(pictures), pictures.end());
}

TEST_F(LooksTest, VeilsAreInThePicture) {
  // A ball of soft tissue with a little bone in its middle, which glass veils.
  const IVec3 dims(48);
  std::string text =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 48 48 48\nspace: right-anterior-superior\n"
      "space directions: (4,0,0) (0,4,0) (0,0,4)\nencoding: raw\nspace origin: (0,0,0)\n\n";
  for (int i = 0; i < dims.x * dims.y * dims.z; ++i) {
    const IVec3 voxel(i % dims.x, i / dims.x % dims.y, i / (dims.x * dims.y));
    const float radius = glm::length(Vec3(voxel) - 0.5f * Vec3(dims - 1));
    text += radius < 4 ? '\x70' : radius < 20 ? '\x42' : '\0';
  }
  write_text(at("ball.nrrd"), text);
  const Finished finished = run_clipgs({"looks", at("ball.nrrd"), "-o", at("ball.png"), "--hu",
                                        "16,-1024", "--size", "64", "--spp", "16", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json looks = nlohmann::json::parse(finished.out)["looks"];
  const Image sheet = read_png(at("ball.png"));
  int glass = 0;
  for (int look = 0; look < static_cast<int>(looks.size()); ++look) {
    if (looks[look]["preset"] == "glass") {
      ++glass;
      const double share = filled(picture(sheet, look, 0));
      EXPECT_GT(share, 0.8);
      EXPECT_LT(share, 1);
    }
  }
  EXPECT_EQ(glass, 1);
}

TEST_F(LooksTest, TheSheetIsTheSameAtAnyThreadCountAndAsWebp) {
  ASSERT_EQ(run_clipgs(looks("a.png", {"--threads", "1"})).status, 0);
  ASSERT_EQ(run_clipgs(looks("b.png", {"--threads", "3"})).status, 0);
  EXPECT_EQ(read_file(at("a.png")), read_file(at("b.png")));
  const Image png = read_png(at("a.png"));
  ASSERT_EQ(run_clipgs(looks("c.webp")).status, 0);
  const Texels webp = decode_webp(read_file(at("c.webp")), png.width, png.height, "c.webp");
  double error = 0;
  for (size_t i = 0; i < png.pixels(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      error += std::abs(png.data[3 * i + c] - static_cast<float>(webp.rgba[4 * i + c]) / 255);
    }
  }
  EXPECT_LT(error / static_cast<double>(3 * png.pixels()), 0.02);
}

TEST_F(LooksTest, CommandsRunAsTheyArePrinted) {
  fs::rename(phantom(), at("a patient's.nrrd"));
  std::vector<std::string> arguments =
      looks("sheet.png", {"--json", "--hu", "1,-5", "--keep-table", "--gaps", "refuse"});
  arguments[1] = at("a patient's.nrrd");
  const Finished finished = run_clipgs(arguments);
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  for (const nlohmann::json& look : json["looks"]) {
    const std::string preset = look["preset"];
    EXPECT_THAT(look["build"].get<std::string>(),
                testing::StartsWith("clipgs build '" + at("a patient'\\''s.nrrd") +
                                    "' -o case.sog --preset " + preset));
    EXPECT_EQ(look["build"].get<std::string>().ends_with(" --no-section"), preset == "crystal");
  }
  EXPECT_THAT(json["build_all"].get<std::string>(),
              testing::AllOf(HasSubstr(" -o case.sog --preset soft-tissue,"), HasSubstr(",skin,"),
                             testing::Not(HasSubstr("crystal"))));
  const std::string line = json["looks"][1]["cinema"];
  EXPECT_THAT(line, HasSubstr("--gaps refuse --hu 1,-5 --keep-table"));
  const std::string program = fs::path(CLIPGS_PROGRAM).parent_path().string();
  const std::string shell = "cd '" + folder_.string() + "' && PATH='" + program + "':$PATH " +
                            line + " --size 32 --spp 1 --quiet >/dev/null";
  EXPECT_EQ(std::system(shell.c_str()), 0) << shell;
  EXPECT_EQ(read_png(at(json["looks"][1]["preset"].get<std::string>() + ".png")).width, 32);
}

TEST_F(LooksTest, TheCutFacesTheCamera) {
  const auto halves = [&](const char* view) {
    EXPECT_EQ(run_clipgs(looks("x.png", {"--view", view})).status, 0);
    const Image sheet = read_png(at("x.png"));
    return std::pair{picture(sheet, 0, 0), picture(sheet, 0, 1)};
  };
  // Soft tissue: brown skin, and faces of which much is darker.
  for (const char* const view : {"0,0", "90,0", "180,0", "20,80"}) {
    const auto [uncut, cut] = halves(view);
    int darker = 0;
    for (size_t i = 0; i < uncut.size(); i += 3) {
      darker += cut[i] < uncut[i] - 0.08f ? 1 : 0;
    }
    EXPECT_GT(darker, kSide * kSide / 10) << view;
  }
}

TEST_F(LooksTest, WhatCannotBeDrawnIsSaidInOneLine) {
  const std::string out = at("x.webp");
  expect_failure({"looks", write_specks("constant.nrrd", 0), "-o", out}, "constant.nrrd", out);
  const std::string specks = write_specks("specks.nrrd", 2);
  const Finished finished = run_clipgs({"looks", specks, "-o", out, "--modality", "mr"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("preset mra shows nothing of the volume but specks"));
  EXPECT_THAT(finished.err, HasSubstr("specks.nrrd: no preset shows more of it than specks"));
  EXPECT_FALSE(fs::exists(out));
  expect_failure(looks("no/such/folder.webp"), "no/such");
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"--size", "32"}, {"--size", "2000"}, {"--view", "a"}, {"--spp", "0"}}) {
    EXPECT_EQ(run_clipgs(looks("x.webp", wrong)).status, 2) << wrong[0];
  }
}

}  // namespace
}  // namespace clipgs
