// A dataset's pictures traced again, and what numbers the commands take.
#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "cli/process.h"
#include "core/file.h"
#include "core/image.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::Finished;
using testing_support::run_clipgs;

class CameraTest : public testing::Test {
 protected:
  CameraTest()
      : folder_(fs::path(testing::TempDir()) / ("clipgs-camera-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    EXPECT_EQ(run_clipgs({"phantom", at("phantom.nrrd"), "--size", "40"}).status, 0);
  }
  ~CameraTest() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

/// Mean squared difference over black.
double difference(const Image& a, const Image& b) {
  const Image x = composite(a, 0, 0, 0);
  const Image y = composite(b, 0, 0, 0);
  EXPECT_EQ(x.data.size(), y.data.size());
  double sum = 0;
  for (size_t i = 0; i < x.data.size(); ++i) {
    const auto d = static_cast<double>(x.data[i] - y.data[i]);
    sum += d * d;
  }
  return sum / static_cast<double>(x.data.size());
}

double mse_of(double decibels) { return std::pow(10, -0.1 * decibels); }

TEST_F(CameraTest, ATestViewIsTracedAgain) {
  const Finished made =
      run_clipgs({"dataset", at("phantom.nrrd"), "-o", at("dataset"), "--size", "48",
                  "--train-frames", "1", "--test-frames", "1", "--test-noise-db", "30", "--quiet"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string text = read_text(at("dataset/transforms.json"));
  EXPECT_THAT(text, testing::Not(testing::ContainsRegex("-0(\\.0)?[],\n ]")));
  int again = 0;
  const nlohmann::json dataset = nlohmann::json::parse(text);
  for (const nlohmann::json& frame : dataset["frames"]) {
    if (frame["split"] == "train") {
      continue;
    }
    write_text(at("frame.json"), frame.dump());
    std::string plane;
    for (const nlohmann::json& number : frame["clip_plane"]) {
      plane += (plane.empty() ? "" : ",") + number.dump();
    }
    const std::vector<std::string> command = {
        "cinema", at("phantom.nrrd"), "-o", at("again.png"), "--camera", at("frame.json"), "--spp",
        "256",    "--seed",           "9",  "--json"};
    std::vector<std::string> cut = command;
    cut.insert(cut.end(), {"--plane", plane});
    const Finished traced = run_clipgs(cut);
    ASSERT_EQ(traced.status, 0) << traced.err;
    const nlohmann::json said = nlohmann::json::parse(traced.out);
    EXPECT_EQ(said["width"], 48);
    const Image own = read_png(at("dataset/" + frame["file_path"].get<std::string>()));
    const double noise = mse_of(frame["noise_db"]) + mse_of(said["noise_db"]);
    EXPECT_LT(difference(read_png(at("again.png")), own), 1.5 * noise);
    ASSERT_EQ(run_clipgs(command).status, 0);
    EXPECT_GT(difference(read_png(at("again.png")), own), 10 * noise) << "uncut";
    ++again;
  }
  EXPECT_EQ(again, 4);  // two of tests, two of validation
}

TEST_F(CameraTest, LooksAtAPoint) {
  // How far down the matter lies in the picture, px.
  const auto height = [&](const std::string& point) {
    std::vector<std::string> command = {
        "cinema", at("phantom.nrrd"), "-o", at("x.png"), "--size", "64", "--spp",
        "4",      "--view",           "0,0"};
    if (!point.empty()) {
      command.insert(command.end(), {"--look-at", point});
    }
    EXPECT_EQ(run_clipgs(command).status, 0);
    const Image image = read_png(at("x.png"));
    float rows = 0;
    float sum = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        rows += image.at(x, y)[3] * static_cast<float>(y);
        sum += image.at(x, y)[3];
      }
    }
    return rows / sum;
  };
  const float middle = height("");
  EXPECT_NEAR(middle, 32, 4);
  EXPECT_GT(height("0,0,60"), middle + 3);
  EXPECT_LT(height("0,0,-60"), middle - 3);
}

TEST_F(CameraTest, StandsAloneAndMustBeOne) {
  write_text(at("camera.json"), R"({"w": 32, "h": 20, "fl_x": 40, "fl_y": 40, "cx": 16, "cy": 10,
      "transform_matrix": [[1,0,0,0],[0,0,-1,-600],[0,1,0,0],[0,0,0,1]]})");
  const std::vector<std::string> command = {
      "cinema", at("phantom.nrrd"), "-o", at("x.png"), "--spp", "1", "--camera"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = command;
    all.insert(all.end(), more.begin(), more.end());
    return run_clipgs(all);
  };
  EXPECT_EQ(with({at("camera.json")}).status, 0);
  EXPECT_EQ(read_png(at("x.png")).width, 32);
  EXPECT_EQ(with({at("camera.json"), "--view", "0,0"}).status, 2);
  EXPECT_EQ(with({at("camera.json"), "--size", "32"}).status, 2);
  EXPECT_EQ(with({at("camera.json"), "--look-at", "0,0,0"}).status, 2);
  write_text(at("camera.json"), R"({"w": 32})");
  const Finished none = with({at("camera.json")});
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("camera.json: \"h\" is missing"));
}

TEST_F(CameraTest, NumbersAreBounded) {
  const auto status = [&](const std::string& option, const std::string& value) {
    return run_clipgs({"cinema", at("phantom.nrrd"), "-o", at("x.png"), "--size", "16", "--spp",
                       "1", option, value})
        .status;
  };
  EXPECT_EQ(status("--exposure", "2"), 0);
  EXPECT_EQ(status("--tone", "filmic"), 0);
  for (const auto& [option, value] : {std::pair{"--exposure", "0"},
                                      {"--exposure", "1e9"},
                                      {"--tone", "agfa"},
                                      {"--view", "0,0,1e9"},
                                      {"--view", "1e30,0"},
                                      {"--focus", "1e30,0,0"},
                                      {"--look-at", "1e30,0,0"},
                                      {"--look-at", "1,2"},
                                      {"--background", "2,0,0"},
                                      {"--plane", "0,0,1e30,1"},
                                      {"--gradient-opacity", "1,1e30"},
                                      {"--lens", "1e9"},
                                      {"--spp", "2000000"},
                                      {"--bounces", "5000"}}) {
    EXPECT_EQ(status(option, value), 2) << option << " " << value;
  }
}

TEST_F(CameraTest, PresetsWithoutMeasureAreRefused) {
  write_text(at("dense.json"),
             R"({"surface_strength": 1, "lights": "studio", "points": [
                 {"value": 0, "color": "#ffffff", "extinction": 0},
                 {"value": 100, "color": "#ffffff", "extinction": 1e6}]})");
  const Finished dense =
      run_clipgs({"cinema", at("phantom.nrrd"), "-o", at("x.png"), "--preset", at("dense.json")});
  EXPECT_EQ(dense.status, 1);
  EXPECT_THAT(dense.err,
              HasSubstr("dense.json: points[1].extinction is 1e+06, at most 100 1/mm\n"));
  EXPECT_FALSE(fs::exists(at("x.png")));
}

}  // namespace
}  // namespace clipgs
