// The program as a user runs it: real processes, real files.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/statvfs.h>

#include "cli/cli_fixture.h"
#include "core/geometry.h"
#include "core/image.h"
#include "splat/ply.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/test_head.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::run_clipgs;

TEST_F(CliTest, UsageErrorsExitWithTwo) {
  EXPECT_EQ(run_clipgs({}).status, 2);
  EXPECT_EQ(run_clipgs({"nonsense"}).status, 2);
  EXPECT_EQ(run_clipgs({"phantom"}).status, 2);
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--plane", "0,0,1"}).status, 2);
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--plane", "0,0,0,1"}).status, 2);
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--view", "a,b"}).status, 2);
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--size", "0x4"}).status, 2);
  EXPECT_EQ(run_clipgs({"build", phantom(), "-o", at("x.sog"), "--quality", "best"}).status, 2);
}

TEST_F(CliTest, EveryCommandHasHelpWithAnExample) {
  const Finished top = run_clipgs({"--help"});
  EXPECT_EQ(top.status, 0);
  for (const char* command :
       {"bake", "build", "phantom", "info", "cinema", "looks", "dataset", "train", "pack", "unpack",
        "export", "render", "eval", "study", "serve"}) {
    EXPECT_THAT(top.out, HasSubstr(command));
    const Finished help = run_clipgs({command, "--help"});
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_THAT(help.out, HasSubstr("clipgs " + std::string(command))) << command;
  }
}

TEST_F(CliTest, BadVolumesFailInOneLine) {
  const std::string out = at("out.png");
  expect_failure({"cinema", at("missing.nrrd"), "-o", out}, "missing.nrrd", out);

  const std::string whole = read_text(phantom());
  write_text(at("cut.nrrd"), std::string_view(whole).substr(0, whole.size() / 2));
  expect_failure({"cinema", at("cut.nrrd"), "-o", out}, "cut.nrrd", out);
  write_text(at("noise.nii"), "this is no volume");
  expect_failure({"cinema", at("noise.nii"), "-o", out}, "noise.nii", out);

  fs::create_directories(at("empty"));
  expect_failure({"cinema", at("empty"), "-o", out}, "empty", out);
  write_text(at("empty/readme.txt"), "no image here");
  expect_failure({"cinema", at("empty"), "-o", out}, "empty", out);
}

TEST_F(CliTest, EmptyNanAndConstantVolumesFailInOneLine) {
  const std::string out = at("out.png");
  const auto write_nrrd = [&](const std::string& name, int side, float value) {
    std::string text =
        "NRRD0004\ntype: float\ndimension: 3\nsizes: " + std::to_string(side) + " " +
        std::to_string(side) + " " + std::to_string(side) +
        "\nspace: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
        "endian: little\nencoding: raw\nspace origin: (0,0,0)\n\n";
    const std::vector<float> values(static_cast<size_t>(side) * side * side, value);
    text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    write_text(at(name), text);
  };
  write_nrrd("zero.nrrd", 0, 0);
  write_nrrd("nan.nrrd", 8, std::numeric_limits<float>::quiet_NaN());
  write_nrrd("constant.nrrd", 8, 42);
  for (const char* name : {"zero.nrrd", "nan.nrrd", "constant.nrrd"}) {
    expect_failure({"cinema", at(name), "-o", out}, name, out);
  }
}

TEST_F(CliTest, FrameChoosesAVolumeOfAFileInTime) {
  std::string text =
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 8 8 8 2\nspace: right-anterior-superior\n"
      "space directions: (9,0,0) (0,9,0) (0,0,9) none\nencoding: raw\n\n";
  for (int i = 0; i < 2 * 512; ++i) {
    text += static_cast<char>(i < 512 ? i % 50 : i % 100);
  }
  write_text(at("time.nrrd"), text);
  expect_failure({"info", at("time.nrrd")}, "--frame 1 to 2");
  expect_failure({"info", at("time.nrrd"), "--frame", "3"}, "no frame 3: it holds 2");
  EXPECT_EQ(run_clipgs({"info", at("time.nrrd"), "--frame", "0"}).status, 2);
  const auto largest = [&](const char* frame) {
    const Finished info = run_clipgs({"info", at("time.nrrd"), "--json", "--frame", frame});
    return nlohmann::json::parse(info.out)["values"][1].get<int>();
  };
  EXPECT_EQ(largest("1"), 49);
  EXPECT_EQ(largest("2"), 99);
}

TEST_F(CliTest, InfoListsWhatWasDoneToAVolume) {
  const Finished info = run_clipgs({"info", phantom(), "--json", "--crop", "-40,40,-40,40,-60,60",
                                    "--denoise-volume", "auto", "--soften-metal", "auto"});
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(info.err, HasSubstr("cropped to a box"));
  const nlohmann::json done = nlohmann::json::parse(info.out).at("prepared");
  ASSERT_EQ(done.size(), 3);
  EXPECT_EQ(done[0].at("step"), "crop");
  EXPECT_NEAR(done[0].at("to_s_mm").get<float>(), 60, 10);
  EXPECT_EQ(done[1].at("step"), "metal");
  EXPECT_EQ(done[2].at("step"), "denoise");
  EXPECT_GT(done[2].at("sigma").get<float>(), 0);
  EXPECT_FALSE(
      nlohmann::json::parse(run_clipgs({"info", phantom(), "--json"}).out).contains("prepared"));
  expect_failure({"info", phantom(), "--crop", "900,999,0,1,0,1"}, "--crop leaves 0 x");
  expect_failure({"info", phantom(), "--bias"}, "--bias is for MR");
  EXPECT_EQ(run_clipgs({"info", phantom(), "--crop", "body"}).status, 2);
  EXPECT_EQ(run_clipgs({"info", phantom(), "--denoise-volume", "-3"}).status, 2);
}

TEST_F(CliTest, InfoDrawsAHeadBeforeAndAfterItsFaceIsTakenOff) {
  save_volume(at("head.nrrd"), scanned_head(Modality::kCt));
  const Finished info = run_clipgs(
      {"info", at("head.nrrd"), "--json", "--deface", "--deface-picture", at("heads.png")});
  ASSERT_EQ(info.status, 0) << info.err;
  const nlohmann::json json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json.at("deface_picture"), at("heads.png"));
  EXPECT_EQ(json.at("prepared").back().at("step"), "deface");
  const Image picture = read_png(at("heads.png"));
  const int half = picture.width / 2;
  double changed = 0;
  for (int y = 60; y < picture.height - 20; ++y) {
    for (int x = 20; x < half - 20; ++x) {
      changed += std::abs(picture.at(x, y)[0] - picture.at(x + half, y)[0]) > 0.05f ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 5000) << "the face differs";
  EXPECT_LT(changed, 0.5 * half * picture.height) << "and the skull does not";
  expect_failure({"info", phantom(), "--deface", "--deface-picture", at("none.png")},
                 "--deface: there is no head in it", at("none.png"));
  EXPECT_NE(run_clipgs({"info", at("head.nrrd"), "--deface-picture", at("none.png")}).status, 0);
}

TEST_F(CliTest, ABuiltCaseSaysThatItsFaceWasTakenOff) {
  save_volume(at("head.nrrd"), scanned_head(Modality::kCt, Mat3(1), 4));
  const auto build = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"build", at("head.nrrd"), "-o", at("head.sog"), "--quality",
                               "instant", "--section-size", "64"});
    return run_clipgs(more);
  };
  const Finished with_face = build({});
  ASSERT_EQ(with_face.status, 0) << with_face.err;
  EXPECT_THAT(with_face.err, HasSubstr("head with a face"));
  const Finished without_face = build({"--deface"});
  ASSERT_EQ(without_face.status, 0) << without_face.err;
  EXPECT_THAT(without_face.err, Not(HasSubstr("head with a face")));
  const nlohmann::json look =
      nlohmann::json::parse(run_clipgs({"info", at("head.sog"), "--json"}).out).at("look");
  EXPECT_GT(look.at("defaced").at("removed_ml"), 100);
  EXPECT_GE(look.at("defaced").at("brain_mm"), 5);
  EXPECT_THAT(run_clipgs({"info", at("head.sog"), "--privacy"}).out, HasSubstr("was taken off"));
}

TEST_F(CliTest, InfoDrawsTheHistogramOfValueAndGradient) {
  for (const char* const name : {"values.png", "values.webp"}) {
    const Finished info =
        run_clipgs({"info", phantom(), "--json", "--histogram", at(name), "--preset", "anatomy"});
    ASSERT_EQ(info.status, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out).at("histogram"), at(name));
    EXPECT_GT(std::filesystem::file_size(at(name)), 10000);
  }
  const Image picture = read_png(at("values.png"));
  EXPECT_GT(picture.width, 800);
  EXPECT_GT(picture.height, 450);

  const std::string out = at("none.png");
  write_text(at("constant.nrrd"),
             "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nspace: right-anterior-superior\n"
             "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n" +
                 std::string(512, 42));
  for (const char* const preset : {"auto", "anatomy", "mr"}) {  // "mr" is of percentiles
    expect_failure({"info", at("constant.nrrd"), "--histogram", out, "--preset", preset},
                   "constant.nrrd: every voxel has the value 42", out);
  }
  expect_failure({"info", phantom(), "--histogram", out, "--preset", "nonesuch"}, "no preset", out);
  expect_failure({"info", phantom(), "--histogram", at("no/such.png")}, "such.png");
  EXPECT_EQ(run_clipgs({"info", phantom(), "--histogram", at("values.jpg")}).status, 2);
  EXPECT_EQ(run_clipgs({"info", phantom(), "--preset", "anatomy"}).status, 2);
}

TEST_F(CliTest, InfoListsTheSeriesAndPhasesOfAFolder) {
  FixtureSlice slice;
  for (const int phase : {1, 2}) {
    slice.texts = {{0x0020, 0x0012, std::to_string(phase), true}};
    write_series(at("scan"), even_table(5 + phase, 2), slice, std::to_string(phase), 50 * phase);
  }
  slice.series_uid = "1.2.3.4";
  write_series(at("scan"), even_table(9, 2), slice, "c");
  const Finished info = run_clipgs({"info", at("scan"), "--json", "--series", "3"});
  ASSERT_EQ(info.status, 0) << info.err;
  const nlohmann::json series = nlohmann::json::parse(info.out).at("series");
  ASSERT_EQ(series.size(), 3);
  EXPECT_EQ(series[0].at("uid"), "1.2.3.4");
  EXPECT_FALSE(series[0].contains("phase"));
  EXPECT_EQ(series[1].at("phase"), "acquisition 2");
  EXPECT_EQ(series[2].at("phase"), "acquisition 1");
  EXPECT_EQ(series[2].at("dims"), nlohmann::json({16, 12, 6}));
  EXPECT_EQ(series[2].at("taken"), true);
  expect_failure({"info", at("scan"), "--series", "4"}, "from 1 to 3");
}

TEST_F(CliTest, LabelsColourThinAndHide) {
  const std::string labels = write_labels("labels.nrrd", -500);
  const auto picture = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"cinema", phantom(), "-o",     at("x.png"), "--view",
                                          "0,0",    "--size",  "48x48",  "--spp",     "8",
                                          "--rig",  "ambient", "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished finished = run_clipgs(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return read_png(at("x.png"));
  };
  // Sums of red, green, blue and alpha in each half of the picture.
  const auto halves = [](const Image& image) {
    std::array<Vec4, 2> sums{Vec4(0), Vec4(0)};
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < 4; ++c) {
          sums[x < image.width / 2 ? 0 : 1][c] += image.at(x, y)[c];
        }
      }
    }
    return sums;
  };
  // From the front, the patient's right (x > 0) is on the left.
  const auto plain = halves(picture({}));
  const auto blue = halves(picture({"--labels", labels, "--label", "1=#0000ff"}));
  EXPECT_NEAR(blue[0].x, plain[0].x, 0.1f * plain[0].x);
  EXPECT_LT(blue[1].x, 0.2f * plain[1].x);
  EXPECT_GT(blue[1].z, plain[1].z);
  EXPECT_NEAR(blue[1].w, plain[1].w, 0.05f * plain[1].w);
  write_text(at("table.json"), R"({"labels": [{"label": 1, "name": "left", "visible": false}]})");
  const Image hidden = picture({"--labels", labels, "--label-table", at("table.json")});
  EXPECT_NE(hidden.data, picture({}).data);
  EXPECT_EQ(hidden.data, picture({"--labels", labels, "--label", "1=hidden"}).data);

  const std::vector<std::string> command = {"cinema", phantom(), "-o", at("none.png")};
  const auto with = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  };
  EXPECT_EQ(run_clipgs(with({"--label", "1=hidden"})).status, 2);
  EXPECT_EQ(run_clipgs(with({"--labels", labels, "--label", "1=red"})).status, 2);
  expect_failure(with({"--labels", phantom()}), "255 labels", at("none.png"));
  expect_failure(with({"--labels", write_labels("beside.nrrd", 9999)}), "patient space",
                 at("none.png"));
  expect_failure(with({"--labels", labels, "--label-table", labels}), "not JSON", at("none.png"));
}

TEST_F(CliTest, UnknownPresetListsTheOnesThereAre) {
  expect_failure({"cinema", phantom(), "-o", at("x.png"), "--preset", "nonesuch"}, "soft-tissue",
                 at("x.png"));
}

TEST_F(CliTest, PresetsOfAnotherModalityWarn) {
  const auto said = [&](const std::vector<std::string>& options) {
    std::vector<std::string> command = {"cinema", phantom(), "-o",    at("x.png"),
                                        "--size", "16",      "--spp", "1"};
    command.insert(command.end(), options.begin(), options.end());
    const Finished finished = run_clipgs(command);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.err;
  };
  EXPECT_THAT(said({"--preset", "mr"}), HasSubstr("--preset mr is made for MR, and the volume is "
                                                  "CT; --preset auto takes soft-tissue"));
  EXPECT_THAT(said({"--preset", "soft-tissue", "--modality", "mr"}),
              HasSubstr("made for CT, and the volume is MR; --preset auto takes mr"));
  for (const char* const fits : {"auto", "bone", "generic"}) {
    EXPECT_THAT(said({"--preset", fits}), testing::Not(HasSubstr("made for"))) << fits;
  }
}

TEST_F(CliTest, ModalityIsWhatTheUserSays) {
  const auto info = [&](const std::vector<std::string>& options) {
    std::vector<std::string> command = {"info", phantom(), "--json"};
    command.insert(command.end(), options.begin(), options.end());
    const Finished finished = run_clipgs(command);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return nlohmann::json::parse(finished.out);
  };
  EXPECT_EQ(info({})["modality"], "CT");
  EXPECT_EQ(info({})["windows"][0]["name"], "soft-tissue");
  EXPECT_EQ(info({"--modality", "pet"})["modality"], "PET");
  EXPECT_EQ(info({"--modality", "pet"})["auto_preset"], "pet");
  EXPECT_EQ(info({"--modality", "us"})["windows"][0]["name"], "auto");
  expect_failure({"info", phantom(), "--modality", "photo"}, "one value a voxel");
  EXPECT_EQ(run_clipgs({"info", phantom(), "--modality", "xray"}).status, 2);
}

TEST_F(CliTest, UnwritableOutputFailsBeforeAnyWork) {
  expect_failure({"build", phantom(), "-o", "/proc/case.sog"}, "/proc/case.sog");
  expect_failure({"cinema", phantom(), "-o", at("no/such/folder/x.png")}, "no/such/folder");
}

TEST_F(CliTest, NamesOfWhatIsNotWrittenAreRefused) {
  const std::string volume = phantom();
  const std::string scene = at("scene.ply");
  const std::string wrong = at("x.jpg");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"cinema", volume, "-o", wrong},
           {"cinema", volume, "-o", at("x.webp")},
           {"cinema", volume, "-o", at("x.png"), "--turntable"},
           {"looks", volume, "-o", wrong},
           {"render", scene, "-o", wrong},
           {"render", scene, "-o", at("x")},
           {"build", volume, "-o", wrong},
           {"pack", scene, "-o", wrong},
           {"unpack", at("case.sog"), "-o", wrong},
           {"export", at("case.sog"), "-o", wrong},
           {"train", at("dataset"), "-o", wrong},
           {"refine", scene, "--dataset", at("dataset"), "-o", wrong},
           {"bake", scene, "-o", wrong},
           {"eval", scene, "--dataset", at("dataset"), "--json", at("x.html")},
           {"eval", scene, "--dataset", at("dataset"), "--report", at("x.json")},
           {"phantom", wrong}}) {
    const Finished finished = run_clipgs(command);
    EXPECT_EQ(finished.status, 2) << command[0];
    EXPECT_THAT(finished.err + finished.out, HasSubstr("name that ends in .")) << command[0];
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);  // the phantom
}

TEST_F(CliTest, OutputThatIsNoFileIsRefusedBeforeAnyWork) {
  const std::string volume = phantom();
  const auto link = [&](const std::string& name) {
    fs::create_symlink("/dev/full", at(name));
    return at(name);
  };
  expect_failure({"phantom", link("full.nrrd")}, "full.nrrd: is a device");
  expect_failure({"cinema", volume, "-o", link("full.png")}, "full.png: is a device");
  expect_failure({"looks", volume, "-o", link("full.webp")}, "full.webp: is a device");
  expect_failure({"build", volume, "-o", link("full.sog")}, "full.sog: is a device");
  EXPECT_FALSE(fs::exists(at("full.clipgs-work")));
  EXPECT_TRUE(fs::is_symlink(at("full.png")) && fs::is_character_file("/dev/full"));
  fs::create_directories(at("folder.png"));
  expect_failure({"cinema", volume, "-o", at("folder.png")}, "folder.png: is a folder");
  expect_failure({"dataset", volume, "-o", volume}, "phantom.nrrd");
}

TEST_F(CliTest, FullDiskFailsAndLeavesNothing) {
  // A file system of 16 KiB, where the tests may mount one.
  const std::string disk = at("disk");
  fs::create_directories(disk);
  if (std::system(("mount -t tmpfs -o size=16k tmpfs " + disk + " 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP()
        << "cannot mount a small file system here; FileTest.FullDiskThrows covers the rest";
  }
  expect_failure({"phantom", disk + "/phantom.nrrd", "--size", "64"}, "phantom.nrrd");
  expect_failure({"looks", phantom(), "-o", disk + "/looks.png", "--spp", "1"}, "looks.png");
  EXPECT_TRUE(fs::is_empty(disk));
  EXPECT_EQ(std::system(("umount " + disk).c_str()), 0);
}

TEST_F(CliTest, PlaneThatMissesWarns) {
  const std::string out = at("x.png");
  const Finished finished = run_clipgs(
      {"cinema", phantom(), "-o", out, "--plane", "0,0,1,-9999", "--spp", "1", "--size", "32x32"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_THAT(finished.err, HasSubstr("nothing is cut"));
  const Finished all = run_clipgs(
      {"cinema", phantom(), "-o", out, "--plane", "0,0,1,9999", "--spp", "1", "--size", "32x32"});
  EXPECT_EQ(all.status, 0);
  EXPECT_THAT(all.err, HasSubstr("everything is cut"));
}

TEST_F(CliTest, PanoramaLightsPicturesButNotSections) {
  const fs::path sky = at("sky.hdr");
  std::string pixels;
  for (int i = 0; i < 8 * 4; ++i) {
    pixels += i < 16 ? std::string("\xff\xc0\x80\x82", 4) : std::string("\x10\x10\x20\x80", 4);
  }
  write_text(sky, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + pixels);
  const fs::path out = at("panorama.png");
  ASSERT_EQ(run_clipgs({"cinema", phantom(), "-o", out, "--rig", sky, "--size", "32", "--spp", "4"})
                .status,
            0);
  EXPECT_EQ(read_png(out).width, 32);
  expect_failure({"dataset", phantom(), "-o", at("dark"), "--rig", sky}, "--no-section",
                 at("dark"));
  expect_failure({"dataset", phantom(), "-o", at("dark"), "--rig", "softbox"}, "--no-section",
                 at("dark"));
  write_text(sky, "no picture");
  expect_failure({"cinema", phantom(), "-o", at("y.png"), "--rig", sky}, "sky.hdr", at("y.png"));
}

TEST_F(CliTest, FloorShowsShadowsAlone) {
  const auto shadows = [&](const std::vector<std::string>& more) {
    const std::string out = at("floor.png");
    std::vector<std::string> arguments = {"cinema", phantom(), "-o",    out,     "--view",
                                          "20,15",  "--size",  "48x48", "--spp", "16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run_clipgs(arguments).status, 0);
    const Image image = read_png(out);
    int count = 0;
    for (size_t i = 0; i < image.pixels(); ++i) {
      const float* pixel = &image.data[4 * i];
      count += pixel[3] > 0.1f && pixel[0] + pixel[1] + pixel[2] == 0 ? 1 : 0;
    }
    return count;
  };
  EXPECT_LT(shadows({}), 4);
  EXPECT_GT(shadows({"--floor", "inferior"}), 20);
  EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--floor", "below"}).status, 2);
}

TEST_F(CliTest, GradientOpacityThinsPicturesButNotSections) {
  const auto picture = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"cinema", phantom(), "-o",    at(name),
                                          "--size", "32",      "--spp", "8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run_clipgs(arguments).status, 0);
    double alpha = 0;
    const Image image = read_png(at(name));
    for (size_t i = 3; i < image.data.size(); i += 4) {
      alpha += image.data[i];
    }
    return alpha;
  };
  const double solid = picture("solid.png", {});
  const double thin = picture("thin.png", {"--gradient-opacity", "200,2000,0.001"});
  EXPECT_GT(thin, 0);
  EXPECT_LT(thin, 0.9 * solid);
  for (const char* const wrong : {"100", "100,50", "0,10,2", "0,10,a"}) {
    EXPECT_EQ(
        run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--gradient-opacity", wrong}).status,
        2);
  }
  expect_failure({"dataset", phantom(), "-o", at("thin"), "--gradient-opacity", "0,100"},
                 "--no-section", at("thin"));
  expect_failure({"build", phantom(), "-o", at("thin.sog"), "--gradient-opacity", "0,100"},
                 "--no-section", at("thin.clipgs-work"));
}

TEST_F(CliTest, FilmicKeepsWhatIsBrighterThanWhiteApart) {
  const auto white = [&](const std::string& tone) {
    EXPECT_EQ(run_clipgs({"cinema", phantom(), "-o", at("bright.png"), "--size", "48", "--spp", "8",
                          "--exposure", "1.9", "--tone", tone})
                  .status,
              0);
    const Image image = read_png(at("bright.png"));
    return std::ranges::count(image.data, 1.0f);
  };
  EXPECT_GT(white("srgb"), white("filmic") + 100);
  const Finished unknown = run_clipgs({"cinema", phantom(), "-o", at("x.png"), "--tone", "agfa"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("{srgb,filmic}"));
}

TEST_F(CliTest, WindowsOfACaseAreThoseOfItsModality) {
  std::vector<std::string> build = small_build("mr.sog");
  build.insert(build.end(), {"--modality", "mr"});
  ASSERT_EQ(run_clipgs(build).status, 0);
  const auto render = [&](const std::vector<std::string>& window) {
    std::vector<std::string> command = {"render", at("mr.sog"), "-o", at("x.png"), "--size",
                                        "64",     "--grey",     "1",  "--plane",   "0,1,0,0"};
    command.insert(command.end(), window.begin(), window.end());
    const Finished finished = run_clipgs(command);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return read_png(at("x.png")).data;
  };
  EXPECT_EQ(render({}), render({"--window", "auto"}));
  EXPECT_NE(render({}), render({"--window", "full"}));
  expect_failure({"render", at("mr.sog"), "-o", at("y.png"), "--grey", "1", "--window", "lung"},
                 "--window lung: no window of a case of MR; give auto, full, CENTER,WIDTH",
                 at("y.png"));
}

TEST_F(CliTest, BuildMakesACaseThatRendersAndEvaluates) {
  const Finished built = run_clipgs(small_build("case.sog"));
  ASSERT_EQ(built.status, 0) << built.err;
  const Finished info = run_clipgs({"info", at("case.sog"), "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out).at("splats"), 1500);
  EXPECT_GT(nlohmann::json::parse(info.out).at("section").at("bytes"), 1000);

  ASSERT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("whole.png"), "--size", "64"}).status,
            0);
  ASSERT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("cut.png"), "--size", "64", "--plane",
                        "0,1,0,0"})
                .status,
            0);
  expect_failure({"render", at("case.sog"), "-o", at("x.png"), "--grey", "1", "--window", "auto"},
                 "no window of a case of CT; give soft-tissue, bone, lung, brain, CENTER,WIDTH",
                 at("x.png"));
  const Image whole = read_png(at("whole.png"));
  EXPECT_GT(*std::max_element(whole.data.begin(), whole.data.end()), 0.5f);
  EXPECT_NE(whole.data, read_png(at("cut.png")).data);

  const Finished evaluated =
      run_clipgs({"eval", at("case.sog"), "--dataset", at("case.clipgs-work/dataset"), "--json",
                  at("eval.json"), "--report", at("report.html")});
  ASSERT_EQ(evaluated.status, 0) << evaluated.err;
  const auto json = nlohmann::json::parse(read_text(at("eval.json")));
  EXPECT_EQ(json.at("rows").size(), 12U);  // two splits, three operators, volume and splats
  EXPECT_THAT(read_text(at("report.html")), HasSubstr("ot for diagnosis"));

  // In other lights than the dataset's, every split is worse.
  const Finished otherwise =
      run_clipgs({"eval", at("case.sog"), "--dataset", at("case.clipgs-work/dataset"), "--json",
                  at("rim.json"), "--rig", "rim"});
  ASSERT_EQ(otherwise.status, 0) << otherwise.err;
  const auto rim = nlohmann::json::parse(read_text(at("rim.json")));
  ASSERT_EQ(rim.at("rows").size(), 6U);
  for (const auto& row : rim.at("rows")) {
    const auto same = std::ranges::find_if(json.at("rows"), [&](const auto& own) {
      return own.at("split") == row.at("split") && own.at("clip") == row.at("clip") &&
             own.at("section") == "volume";
    });
    ASSERT_NE(same, json.at("rows").end());
    EXPECT_LT(row.at("psnr_masked"), same->at("psnr_masked"));
  }

  const Finished dataset = run_clipgs({"info", at("case.clipgs-work/dataset"), "--json"});
  ASSERT_EQ(dataset.status, 0) << dataset.err;
  EXPECT_EQ(nlohmann::json::parse(dataset.out).at("train").at("pictures"), 8);

  // Faces by the volume, by splats, and in grey.
  std::vector<std::vector<float>> pictures;
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{}, {"--section", "splats"}, {"--grey", "1"}}) {
    std::vector<std::string> arguments = {"render", at("case.sog"), "-o",      at("face.png"),
                                          "--size", "64",           "--plane", "0,-1,0,0"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    ASSERT_EQ(run_clipgs(arguments).status, 0);
    pictures.push_back(read_png(at("face.png")).data);
  }
  EXPECT_NE(pictures[0], pictures[1]);
  EXPECT_NE(pictures[0], pictures[2]);

  expect_failure(
      {"render", at("case.sog"), "-o", at("lit.png"), "--section", "splats", "--rig", "rim"},
      "trained in", at("lit.png"));

  // A state is a plane along the axis.
  const Finished state = run_clipgs(
      {"render", at("case.sog"), "-o", at("state.png"), "--size", "64", "--state", "57"});
  ASSERT_EQ(state.status, 0) << state.err;
  int count = 0;
  float position = 0;
  ASSERT_EQ(std::sscanf(state.out.c_str(), "state 57 of %d: %f mm", &count, &position), 2)
      << state.out;
  const auto extent = nlohmann::json::parse(info.out).at("extent_mm").get<std::vector<float>>();
  EXPECT_EQ(count, 200);
  EXPECT_NEAR(position, extent[0] + (extent[1] - extent[0]) * 58 / 200, 0.01f);
  ASSERT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("plane.png"), "--size", "64", "--plane",
                        "0,0,-1," + std::to_string(-position)})
                .status,
            0);
  const std::vector<float> by_state = read_png(at("state.png")).data;
  const std::vector<float> by_plane = read_png(at("plane.png")).data;
  ASSERT_EQ(by_state.size(), by_plane.size());
  double difference = 0;  // of the position's digits
  for (size_t i = 0; i < by_state.size(); ++i) {
    difference += std::abs(by_state[i] - by_plane[i]) / static_cast<double>(by_state.size());
  }
  EXPECT_LT(difference, 1e-3);
  EXPECT_NE(by_state, whole.data);
  expect_failure({"render", at("case.sog"), "-o", at("none.png"), "--state", "200"},
                 "has no state 200; give --state a number from 0 to 199", at("none.png"));
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--state", "-1"},
                                                {"--state", "x"},
                                                {"--state", "5", "--plane", "0,0,-1,0"},
                                                {"--camera", "x.json", "--view", "0,0"},
                                                {"--camera", "x.json", "--turntable"},
                                                {"--state", "5", "--slab", "0,0,-1,0,9"}}) {
    std::vector<std::string> arguments = {"render", at("case.sog"), "-o", at("none.png")};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run_clipgs(arguments).status, 2) << wrong.back();
  }

  // Any camera, as a frame of the dataset has it.
  const auto transforms =
      nlohmann::json::parse(read_text(at("case.clipgs-work/dataset/transforms.json")));
  nlohmann::json frame = transforms.at("frames").at(0);
  write_text(at("camera.json"), frame.dump());
  const std::vector<std::string> posed = {"render",        at("case.sog"), "-o",
                                          at("posed.png"), "--camera",     at("camera.json")};
  ASSERT_EQ(run_clipgs(posed).status, 0);
  const Image picture = read_png(at("posed.png"));
  EXPECT_EQ(picture.width, frame.at("w"));
  EXPECT_GT(*std::max_element(picture.data.begin(), picture.data.end()), 0.5f);
  frame.erase("fl_x");
  write_text(at("camera.json"), frame.dump());
  expect_failure(posed, "camera.json: \"fl_x\"");

  // What moves is a WebP, and nothing else.
  ASSERT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("spin.webp"), "--size", "64",
                        "--turntable", "--sweep", "--frames", "3"})
                .status,
            0);
  EXPECT_THAT(read_text(at("spin.webp")).substr(0, 64), HasSubstr("ANIM"));
  EXPECT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("spin.png"), "--sweep"}).status, 2);
  ASSERT_EQ(run_clipgs({"cinema", phantom(), "-o", at("sweep.webp"), "--size", "32", "--spp", "2",
                        "--slab", "0,0,1,0,20", "--sweep", "--frames", "2"})
                .status,
            0);

  // A tour is drawn as its stops would be, and flies between them.
  const auto tour_of = [&](const std::string& last) {
    write_text(at("case.tour.json"),
               R"({"clipgs_tour":1,"volume":"","stops":[{"id":"1","name":"Front","text":"one",)"
               R"("show":"view=0,0","stay":0.25},{"id":"2","fly":1,"stay":0.5,"show":")" +
                   last + R"("}]})");
    return std::vector<std::string>{"render", at("case.sog"), "--tour", at("case.tour.json"),
                                    "--size", "64",           "--fps",  "4"};
  };
  const auto film = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto tour = tour_of("view=90,10,2&plane=0,0,-1,0&grey=0");
  ASSERT_EQ(run_clipgs(film(tour, {"-o", at("tour"), "--no-captions"})).status, 0);
  EXPECT_TRUE(std::filesystem::exists(at("tour/00006.png")));
  EXPECT_FALSE(std::filesystem::exists(at("tour/00007.png"))) << "0.25 + 1 + 0.5 s";
  ASSERT_EQ(run_clipgs({"render", at("case.sog"), "-o", at("stop.png"), "--size", "64", "--view",
                        "90,10,2", "--plane", "0,0,-1,0"})
                .status,
            0);
  EXPECT_EQ(read_png(at("tour/00006.png")).data, read_png(at("stop.png")).data);
  EXPECT_NE(read_png(at("tour/00003.png")).data, read_png(at("tour/00004.png")).data);
  EXPECT_NE(read_png(at("tour/00000.png")).data, read_png(at("tour/00002.png")).data);
  // To another look nothing moves before that has come: here it looks the same.
  std::filesystem::copy_file(at("case.sog"), at("other.sog"));
  ASSERT_EQ(run_clipgs(film(tour_of("case=other&view=90,10,2&plane=0,0,-1,0&grey=0&"
                                    "length=-20,0,0,20,0,0&name=Marked"),
                            {"-o", at("looks"), "--no-captions"}))
                .status,
            0);
  EXPECT_EQ(read_png(at("looks/00000.png")).data, read_png(at("looks/00002.png")).data);
  EXPECT_NE(read_png(at("looks/00000.png")).data, read_png(at("looks/00003.png")).data);
  EXPECT_NE(read_png(at("looks/00006.png")).data, read_png(at("stop.png")).data) << "a mark";
  tour_of("view=90,10,2&plane=0,0,-1,0&grey=0");
  ASSERT_EQ(run_clipgs(film(tour, {"-o", at("tour.webp")})).status, 0);
  EXPECT_THAT(read_text(at("tour.webp")).substr(0, 64), HasSubstr("ANIM"));
  expect_failure(film(tour, {"-o", at("tour.gif")}), ".mp4", at("tour.gif"));
  expect_failure(film(tour_of("case=gone&view=1,1"), {"-o", at("gone.webp")}),
                 "view 2 shows case \"gone\"", at("gone.webp"));
  EXPECT_EQ(run_clipgs(film(tour, {"-o", at("x.webp"), "--view", "0,0"})).status, 2);

  // Unpacked and packed again it is the same case, smaller or without its section if wanted.
  const auto section_of = [&](const std::vector<std::string>& options) {
    std::vector<std::string> pack = {"pack", at("again.ply"), "-o", at("again.sog")};
    pack.insert(pack.end(), options.begin(), options.end());
    EXPECT_EQ(run_clipgs(pack).status, 0);
    const Finished said = run_clipgs({"info", at("again.sog"), "--json"});
    return nlohmann::json::parse(said.out).value("section", nlohmann::json());
  };
  ASSERT_EQ(run_clipgs({"unpack", at("case.sog"), "-o", at("again.ply")}).status, 0);
  EXPECT_EQ(section_of({})["dims"], nlohmann::json::parse(info.out)["section"]["dims"]);
  const auto small = section_of({"--section-size", "12"})["dims"];
  EXPECT_LE(small[0].get<int>() * small[1].get<int>() * small[2].get<int>(), 12 * 12 * 12);
  EXPECT_GT(small[2], 8);
  const auto lossless = section_of({"--section-quality", "100"})["bytes"];
  EXPECT_EQ(section_of({})["bytes"], lossless);  // there is room for it
  EXPECT_GT(lossless, section_of({"--max-mb", "0"})["bytes"]);
  EXPECT_TRUE(section_of({"--no-section"}).is_null());
  expect_failure({"render", at("again.sog"), "-o", at("none.png"), "--section", "volume"},
                 "no section", at("none.png"));

  // Other programs have it as splats alone, whole or cut, and what they have is read back.
  const auto exported = [&](const char* name, const std::vector<std::string>& options) {
    std::vector<std::string> command = {"export", at("case.sog"), "-o", at(name), "--fill", "2000"};
    command.insert(command.end(), options.begin(), options.end());
    EXPECT_EQ(run_clipgs(command).status, 0) << name;
    return std::filesystem::file_size(at(name));
  };
  EXPECT_GT(exported("whole.ply", {}), exported("whole.spz", {}));
  EXPECT_GT(exported("whole.glb", {}), exported("whole.sog", {}));
  exported("cut.spz", {"--plane", "0,0,-1,0", "--spz-version", "3"});
  exported("cut.ply", {"--plane", "0,0,-1,0"});
  for (const char* name : {"whole.ply", "whole.spz", "whole.sog", "cut.spz"}) {
    const Finished drawn =
        run_clipgs({"render", at(name), "-o", at("other.png"), "--size", "64x64"});
    EXPECT_EQ(drawn.status, 0);
    EXPECT_THAT(drawn.err, HasSubstr("taken as metres"));
    EXPECT_GT(std::ranges::max(read_png(at("other.png")).data), 0.5f) << name;
  }
  const Gaussians kept = read_ply(at("cut.ply"));  // what is below, y being down
  EXPECT_GE(*std::min_element(kept.plane(1), kept.plane(1) + kept.size()), -1e-5f);
  EXPECT_EQ(run_clipgs({"export", at("case.sog"), "-o", at("x.spz"), "--format", "glb"}).status, 1);

  // A case cut short is refused.
  const std::string bytes = read_text(at("case.sog"));
  write_text(at("cut.sog"), std::string_view(bytes).substr(0, bytes.size() * 2 / 3));
  expect_failure({"info", at("cut.sog")}, "cut.sog");
  expect_failure({"render", at("cut.sog"), "-o", at("none.png")}, "cut.sog", at("none.png"));
}

}  // namespace
}  // namespace clipgs
