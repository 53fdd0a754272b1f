// Panoramas that light pictures, and what lies behind these.
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>

#include "cli/cli_fixture.h"
#include "core/image.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing_support::run_clipgs;

class BackdropTest : public testing_support::CliTest {
 protected:
  /// A picture of the phantom, with these options.
  Image cinema(const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"cinema",  phantom(), "-o",   at("picture.png"), "--spp",
                                          "16",      "--size",  "48",   "--bits",          "16",
                                          "--quiet", "--view",  "20,15"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto finished = run_clipgs(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return read_png(at("picture.png"));
  }

  /// Writes a PFM picture of 8 × 4 pixels of 1, but for one of them.
  std::string panorama(float odd) {
    std::vector<float> pixels(size_t{8} * 4 * 3, 1.0f);
    pixels[3 * 10] = odd;  // the third pixel of the third row from the top
    write_text(at("sky.pfm"),
               "PF\n8 4\n-1\n" + std::string(reinterpret_cast<const char*>(pixels.data()),
                                             sizeof(float) * pixels.size()));
    return at("sky.pfm");
  }
};

/// Of a row and channel that no matter is in.
float corner(const Image& image, int row, int channel) { return image.at(0, row)[channel]; }

TEST_F(BackdropTest, ScriptMakesTheSamePanoramasAgainAndTheyLight) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "there is no python3";
  }
  const std::string script = std::string("python3 ") + CLIPGS_SCRIPTS + "/panoramas.py ";
  ASSERT_EQ(std::system((script + at("one")).c_str()), 0);
  ASSERT_EQ(std::system((script + at("two")).c_str()), 0);
  std::vector<Image> pictures;
  for (const char* name : {"operating-theatre", "photo-studio", "window"}) {
    const std::string file = fmt::format("one/{}.hdr", name);
    EXPECT_EQ(read_file(at(file)), read_file(at(fmt::format("two/{}.hdr", name))));
    EXPECT_LT(fs::file_size(at(file)), 100'000);
    EXPECT_EQ(read_hdr(at(file)).width, 512);
    pictures.push_back(cinema({"--rig", at(file)}));
    float brightest = 0;
    for (const float value : pictures.back().data) {
      brightest = std::max(brightest, value);
    }
    EXPECT_GT(brightest, 0.5f) << name;
  }
  EXPECT_NE(pictures[0].data, pictures[1].data);
  EXPECT_NE(pictures[1].data, pictures[2].data);
  EXPECT_NE(std::system((script + phantom() + " 2>/dev/null").c_str()), 0);
}

TEST_F(BackdropTest, PanoramasThatAreNoLightAreRefused) {
  cinema({"--rig", panorama(2)});
  const std::string out = at("refused.png");
  const auto refused = [&](const std::string& sky, const std::string& says) {
    expect_failure({"cinema", phantom(), "-o", out, "--rig", sky, "--spp", "1", "--size", "16"},
                   says, out);
  };
  refused(panorama(std::numeric_limits<float>::quiet_NaN()),
          "sky.pfm: the radiance of pixel 2, 2 (from the top left) is nan, but must be 0 to 1e+10; "
          "mend it there, or write the panorama again");
  refused(panorama(std::numeric_limits<float>::infinity()), "pixel 2, 2");
  refused(panorama(-1), "is -1, but");
  fs::resize_file(at("sky.pfm"), 100);
  refused(at("sky.pfm"), "sky.pfm: damaged PFM picture (it ends too early)");
}

TEST_F(BackdropTest, BackgroundsAreColoursNamesAndGradients) {
  const Image plain = cinema({});
  ASSERT_EQ(plain.channels, 4);
  EXPECT_EQ(cinema({"--background", "0.2,0.4,1"}).data, cinema({"--background", "#3366ff"}).data);
  const Image white = cinema({"--background", "white"});
  ASSERT_EQ(white.channels, 3);
  EXPECT_EQ(corner(white, 0, 0), 1);
  const Image gradient = cinema({"--background", "#204060,black"});
  for (const int row : {0, 24, 47}) {
    const float left = 1 - (static_cast<float>(row) + 0.5f) / 48;
    EXPECT_NEAR(corner(gradient, row, 0), left * 0x20 / 255, 1e-4);
    EXPECT_NEAR(corner(gradient, row, 2), left * 0x60 / 255, 1e-4);
  }
  // Where the body hides all of it, it is the same picture.
  const size_t middle = size_t{24} * 48 + 24;
  ASSERT_EQ(plain.data[4 * middle + 3], 1);
  EXPECT_EQ(gradient.data[3 * middle], plain.data[4 * middle]);
  EXPECT_GT(corner(cinema({"--background", "paper"}), 0, 0), 0.9f);
  EXPECT_LT(corner(cinema({"--background", "studio"}), 0, 0), 0.2f);
  for (const char* wrong : {"pink", "#12345", "#12345g", "1,2", "white,", "white,pink", ",", "#"}) {
    const auto finished = run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--size", "16",
                                      "--spp", "1", "--background", wrong});
    EXPECT_EQ(finished.status, 2) << wrong;
    EXPECT_FALSE(fs::exists(at("x.png")));
  }
}

// What is far away fades towards the background, which needs no telling of the picture.
TEST_F(BackdropTest, DepthCuesFadeWhatIsFar) {
  const Image plain = cinema({"--background", "black"});
  EXPECT_EQ(cinema({"--background", "black", "--depth-cue", "0"}).data, plain.data);
  const Image half = cinema({"--background", "black", "--depth-cue", "0.5"});
  const Image whole = cinema({"--background", "black", "--depth-cue", "1"});
  double least = 1;
  double most = 0;
  for (size_t i = 0; i < plain.data.size(); ++i) {
    EXPECT_LE(whole.data[i], half.data[i] + 1e-4f);
    EXPECT_NEAR(half.data[i], 0.5f * (plain.data[i] + whole.data[i]), 1e-4);
    if (plain.data[i] > 0.2f) {
      least = std::min(least, double{whole.data[i] / plain.data[i]});
      most = std::max(most, double{whole.data[i] / plain.data[i]});
    }
  }
  EXPECT_LT(least, 0.75);
  EXPECT_GT(most, 0.9);
  const Image over = cinema({"--background", "#808080", "--depth-cue", "1"});
  const Image through =
      composite(cinema({"--depth-cue", "1"}), 128.0f / 255, 128.0f / 255, 128.0f / 255);
  for (size_t i = 0; i < over.data.size(); ++i) {
    EXPECT_NEAR(over.data[i], through.data[i], 1e-4);
  }
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--depth-cue", "1.5"}).status, 2);
}

TEST_F(BackdropTest, CasesAreDrawnBeforeThemToo) {
  ASSERT_EQ(run_clipgs(small_build("case.sog")).status, 0);
  const auto draw = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {
        "render", at("case.sog"), "-o",    at("drawn.png"), "--size",
        "64",     "--view",       "20,15", "--plane",       "0.3,-0.9,-0.2,0"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto finished = run_clipgs(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return read_png(at("drawn.png"));
  };
  const Image plain = draw({});
  const Image white = draw({"--background", "white"});
  ASSERT_EQ(white.channels, 3);
  const Image over = composite(plain, 1, 1, 1);
  for (size_t i = 0; i < white.data.size(); ++i) {
    EXPECT_NEAR(white.data[i], over.data[i], 2.0 / 255);
  }
  // The reference fades the same; it is no farther from the fast one than where nothing fades.
  const auto apart = [&](const std::string& source, const std::string& cue) {
    std::vector<std::string> options = {"--background", "studio",      "--section",
                                        source,         "--depth-cue", cue};
    const Image fast = draw(options);
    options.emplace_back("--reference");
    const Image reference = draw(options);
    double sum = 0;
    for (size_t i = 0; i < fast.data.size(); ++i) {
      sum += std::abs(double{fast.data[i] - reference.data[i]});
    }
    return sum / static_cast<double>(fast.data.size());
  };
  EXPECT_LT(apart("splats", "0.8"), 0.002);
  EXPECT_LT(apart("volume", "0.8"), apart("volume", "0") + 0.001);
  // Splats show all of it without a section; far ones are darker before black, and none brighter.
  const Image body = draw({"--background", "black", "--section", "splats"});
  const Image faded = draw({"--background", "black", "--section", "splats", "--depth-cue", "1"});
  for (size_t i = 0; i < body.data.size(); ++i) {
    EXPECT_LE(faded.data[i], body.data[i] + 1.0f / 255);
  }
  EXPECT_NE(faded.data, body.data);
}

}  // namespace
}  // namespace clipgs
