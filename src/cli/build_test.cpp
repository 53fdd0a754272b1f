// The build as a user runs it: real processes, real files.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/cli_fixture.h"
#include "core/lock.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::run_clipgs;
using testing_support::run_clipgs_and_kill;

class BuildTest : public CliTest {
 protected:
  /// As small_build(), smaller still.
  std::vector<std::string> tiny_build(const std::string& output,
                                      const std::vector<std::string>& more) const {
    std::vector<std::string> build = small_build(output);
    for (const auto& [option, value] : {std::pair{"--size", "32"},
                                        {"--train-frames", "4"},
                                        {"--steps", "20"},
                                        {"--budget", "300"}}) {
      *(std::ranges::find(build, option) + 1) = value;
    }
    build.insert(build.end(), more.begin(), more.end());
    return build;
  }

  /// Builds, after an edit: the pictures must be made again, for this reason.
  void expect_seen(const std::vector<std::string>& build, const std::string& says) {
    const Finished again = run_clipgs(build);
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr("pictures: made again, the " + says + " changed\n"));
  }
};

TEST_F(BuildTest, EditedFilesAreSeen) {
  nlohmann::json preset =
      nlohmann::json::parse(read_text(CLIPGS_SOURCE_DIR "/presets/soft-tissue.json"));
  nlohmann::json rig =
      nlohmann::json::parse(read_text(CLIPGS_SOURCE_DIR "/presets/rigs/ambient.json"));
  write_text(at("my.json"), preset.dump());
  write_text(at("rig.json"), rig.dump());
  const std::vector<std::string> looks = {"--preset", at("my.json"), "--rig", at("rig.json")};
  const std::vector<std::string> build = tiny_build("case.sog", looks);
  ASSERT_EQ(run_clipgs(build).status, 0);
  const std::string before = read_text(at("case.sog"));

  for (nlohmann::json& point : preset["points"]) {
    point["color"] = "#2040ff";
  }
  write_text(at("my.json"), preset.dump());
  expect_seen(build, "preset");
  const std::string blue = read_text(at("case.sog"));
  EXPECT_TRUE(blue != before);
  rig["sky"]["bottom"]["intensity"] = 0.1;
  write_text(at("rig.json"), rig.dump());
  expect_seen(build, "lights");
  EXPECT_TRUE(read_text(at("case.sog")) != blue);

  // The case is that of a build from scratch.
  ASSERT_EQ(run_clipgs(tiny_build("fresh.sog", looks)).status, 0);
  EXPECT_TRUE(read_text(at("case.sog")) == read_text(at("fresh.sog")));
}

TEST_F(BuildTest, EditedPanoramasLabelTablesAndVolumesAreSeen) {
  const auto sky = [](const char* top) {
    std::string pixels;
    for (int i = 0; i < 8 * 4; ++i) {
      pixels += i < 16 ? std::string(top, 4) : std::string("\x10\x10\x20\x80", 4);
    }
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + pixels;
  };
  const auto table = [](const std::string& color) {
    return R"({"labels": [{"label": 1, "name": "a", "color": ")" + color + "\"}]}";
  };
  write_text(at("sky.hdr"), sky("\xff\xc0\x80\x82"));
  write_text(at("table.json"), table("#ff0000"));
  const std::vector<std::string> build =
      tiny_build("case.sog", {"--preset", "soft-tissue", "--rig", at("sky.hdr"), "--exposure", "1",
                              "--labels", write_labels("labels.nrrd", -500), "--label-table",
                              at("table.json"), "--no-section"});
  ASSERT_EQ(run_clipgs(build).status, 0);
  write_text(at("sky.hdr"), sky("\x80\xc0\xff\x82"));
  expect_seen(build, "lights");
  write_text(at("table.json"), table("#00ff00"));
  expect_seen(build, "labels' looks");

  // Another volume of the same size and time.
  const auto time = fs::last_write_time(phantom());
  ASSERT_EQ(run_clipgs({"phantom", at("other.nrrd"), "--size", "40", "--seed", "2"}).status, 0);
  write_text(phantom(), read_text(at("other.nrrd")));
  fs::last_write_time(phantom(), time);
  expect_seen(build, "volume");
}

TEST_F(BuildTest, OptionsMakeAgainWhatDependsOnThem) {
  ASSERT_EQ(run_clipgs(tiny_build("case.sog", {})).status, 0);
  const Finished titled = run_clipgs(tiny_build("case.sog", {"--title", "Torso"}));
  EXPECT_THAT(
      titled.err,
      AllOf(HasSubstr("pictures: done before"), HasSubstr("section: done before"),
            HasSubstr("training: done before"), HasSubstr("case: made again, the title changed")));
  EXPECT_THAT(run_clipgs({"info", at("case.sog")}).out, HasSubstr("Torso"));
  std::vector<std::string> longer = tiny_build("case.sog", {});
  *(std::ranges::find(longer, "--steps") + 1) = "21";
  const Finished trained = run_clipgs(longer);
  EXPECT_THAT(trained.err, AllOf(HasSubstr("pictures: done before"),
                                 HasSubstr("training: made again, the steps changed")));
}

TEST_F(BuildTest, SeveralPresetsMakeACaseEachOfOneVolume) {
  const auto looks = [&](const std::string& presets, const std::vector<std::string>& more = {}) {
    std::vector<std::string> build = tiny_build("case.sog", {"--preset", presets});
    build.insert(build.end(), more.begin(), more.end());
    return build;
  };
  const auto look_of = [&](const std::string& file) {
    const Finished info = run_clipgs({"info", at(file), "--json"});
    return nlohmann::json::parse(info.out).at("look");
  };
  // The last cannot be built: nor is the first.
  expect_failure(looks("skin,crystal"), "--no-section", at("case-skin.sog"));
  expect_failure(looks("skin,no-such"), "no-such", at("case-skin.sog"));
  EXPECT_EQ(run_clipgs(looks("skin,skin")).status, 2);
  EXPECT_EQ(run_clipgs(looks("skin,,skeleton")).status, 2);

  const Finished built = run_clipgs(looks("skin,skeleton", {"--work", at("work")}));
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_FALSE(fs::exists(at("case.sog")));
  EXPECT_TRUE(fs::exists(at("work/skin/scene.ply")));
  const nlohmann::json skin = look_of("case-skin.sog");
  const nlohmann::json skeleton = look_of("case-skeleton.sog");
  EXPECT_EQ(skin.at("volume"), skeleton.at("volume"));
  EXPECT_EQ(skeleton.at("title"), "Skeleton");
  EXPECT_NE(skin.at("description"), skeleton.at("description"));
}

TEST_F(BuildTest, CasesNameTheToneCurveThatTheyAreShownBy) {
  const auto tone_of = [](const std::string& path) {
    const Finished info = run_clipgs({"info", path, "--json"});
    const nlohmann::json json = nlohmann::json::parse(info.out);
    return json.at(json.contains("section") ? "/section/tone"_json_pointer : "/tone"_json_pointer)
        .get<std::string>();
  };
  ASSERT_EQ(run_clipgs(tiny_build("case.sog", {})).status, 0);
  const std::string plain = read_text(at("case.sog"));
  EXPECT_EQ(tone_of(at("case.sog")), "srgb");
  EXPECT_THAT(run_clipgs(tiny_build("case.sog", {"--tone", "srgb"})).err, Not(HasSubstr("again")));
  EXPECT_TRUE(read_text(at("case.sog")) == plain);
  expect_seen(tiny_build("case.sog", {"--tone", "filmic"}), "tone");
  EXPECT_EQ(tone_of(at("case.sog")), "filmic");
  EXPECT_EQ(tone_of(at("case.clipgs-work/dataset")), "filmic");

  std::string index = read_text(at("case.clipgs-work/dataset/transforms.json"));
  index.replace(index.find("filmic"), 6, "sepia!");
  write_text(at("case.clipgs-work/dataset/transforms.json"), index);
  const Finished newer = run_clipgs({"info", at("case.clipgs-work/dataset")});
  EXPECT_EQ(newer.status, 1);
  EXPECT_THAT(newer.err, HasSubstr("one of srgb, filmic"));
}

TEST_F(BuildTest, TheSecondInAWorkFolderIsToldWhoIsAtWork) {
  const std::string work = at("case.clipgs-work");
  const std::string me = "process " + std::to_string(getpid()) + " on ";
  {
    const FolderLock lock(work);
    expect_failure(tiny_build("case.sog", {}), me, at("case.sog"));
    expect_failure(tiny_build("case.sog", {}), "--work", at("case.sog"));
    expect_failure({"dataset", phantom(), "-o", work}, me);
  }

  // Of two at once, with other options, none ends with the other's bytes.
  const auto seeded = [&](const std::string& name, const std::string& seed) {
    return tiny_build(name + seed + ".sog", {"--seed", seed, "--work", at("work of " + name)});
  };
  const auto run = [](const std::vector<std::string>& build) { return run_clipgs(build); };
  const std::string seeds[] = {"2", "3"};
  phantom();  // made once
  std::future<Finished> runs[] = {std::async(std::launch::async, run, seeded("both", seeds[0])),
                                  std::async(std::launch::async, run, seeded("both", seeds[1]))};
  int successes = 0;
  for (int i = 0; i < 2; ++i) {
    const Finished finished = runs[i].get();
    const std::string output = at("both" + seeds[i] + ".sog");
    if (finished.status == 0) {
      ++successes;
      ASSERT_EQ(run_clipgs(seeded("own", seeds[i])).status, 0);
      EXPECT_TRUE(read_text(output) == read_text(at("own" + seeds[i] + ".sog")));
    } else {
      EXPECT_THAT(finished.err, AllOf(HasSubstr("process "), HasSubstr(" is at work here")));
      EXPECT_FALSE(fs::exists(output));
    }
  }
  EXPECT_GT(successes, 0);
}

TEST_F(BuildTest, TwoTrainingsOfOneSceneAndCheckpointsOfOthersAreRefused) {
  ASSERT_EQ(run_clipgs({"dataset", phantom(), "-o", at("data"), "--size", "32", "--train-frames",
                        "4", "--test-frames", "0", "--no-section"})
                .status,
            0);
  const std::vector<std::string> train = {"train",    at("data"), "-o",      at("scene.ply"),
                                          "--budget", "1000",     "--steps", "9"};
  {
    const FileLock lock(at("scene.ply.lock"), at("scene.ply"), "");
    expect_failure(train, "process " + std::to_string(getpid()) + " on ", at("scene.ply"));
  }
  write_text(at("scene.ply.checkpoint"), "CLIPGST5 of an older program");
  expect_failure(train, "scene.ply.checkpoint: is no checkpoint of this version", at("scene.ply"));
  fs::remove(at("scene.ply.checkpoint"));
  EXPECT_EQ(run_clipgs(train).status, 0);
}

TEST_F(BuildTest, BuildWithLabelsHasNoSection) {
  const std::string labels = write_labels("labels.nrrd", -500);
  std::vector<std::string> build = small_build("case.sog");
  build.insert(build.end(), {"--labels", labels, "--label", "1=hidden"});
  const Finished built = run_clipgs(build);
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("no section"));
  const Finished info = run_clipgs({"info", at("case.sog"), "--json"});
  EXPECT_TRUE(nlohmann::json::parse(info.out).value("section", nlohmann::json()).is_null());

  // Another look of the labels is another picture.
  build.back() = "1=0.5";
  EXPECT_THAT(run_clipgs(build).err, HasSubstr("pictures: made again, the labels' looks changed"));
}

TEST_F(BuildTest, KilledBuildResumesToTheSameBytesAtAnyThreadCount) {
  std::vector<std::string> reference = small_build("reference.sog");
  reference.insert(reference.end(), {"--threads", "1"});
  ASSERT_EQ(run_clipgs(reference).status, 0);
  const std::string expected = read_text(at("reference.sog"));

  // Killed again and again, a little later each time, wherever it may be.
  const std::vector<std::string> interrupted = small_build("interrupted.sog");
  int kills = 0;
  double seconds = 0.05;
  while (run_clipgs_and_kill(interrupted, seconds)) {
    ++kills;
    seconds *= 1.3;
    ASSERT_LT(kills, 60);
    // The instant case is there before the build is done. A kill may come after the finished one is
    // in its place, with the report still to write.
    if (fs::exists(at("interrupted.sog"))) {
      const std::string text = read_text(at("interrupted.sog"));
      EXPECT_TRUE(text == expected || text.find("\"trained\":0") != std::string::npos);
      ASSERT_EQ(run_clipgs({"info", at("interrupted.sog")}).status, 0);
    }
  }
  EXPECT_GT(kills, 0);
  EXPECT_TRUE(read_text(at("interrupted.sog")) == expected);

  // What was half written is gone, and so is the lock.
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    EXPECT_THAT(entry.path().string(), Not(AnyOf(HasSubstr(".part"), HasSubstr(".lock"))));
  }

  // Nothing but the packing left to do.
  fs::remove(at("interrupted.sog"));
  ASSERT_EQ(run_clipgs(interrupted).status, 0);
  EXPECT_TRUE(read_text(at("interrupted.sog")) == expected);
}

TEST_F(BuildTest, BuildTheWayOfThePapersHasLayersAndResumes) {
  std::vector<std::string> build = small_build("layered.sog");
  build.insert(build.end(), {"--model", "clipgs"});
  *(std::ranges::find(build, "--train-frames") + 1) = "24";  // some across the axis
  const Finished built = run_clipgs(build);
  ASSERT_EQ(built.status, 0) << built.err;
  const std::string expected = read_text(at("layered.sog"));
  const Finished info = run_clipgs({"info", at("layered.sog"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("states").at("count"), 200);
  const std::string model = at("layered.clipgs-work/model.ply");
  const std::string dataset = at("layered.clipgs-work/dataset");
  const Finished measured =
      run_clipgs({"eval", at("layered.sog"), "--model", model, "--dataset", dataset});
  ASSERT_EQ(measured.status, 0) << measured.err;
  EXPECT_THAT(measured.out, HasSubstr("model      test_axis          own    splats   truth"));
  EXPECT_THAT(measured.out, HasSubstr("200 states as PLY"));
  EXPECT_EQ(run_clipgs({"render", model, "-o", at("own.png"), "--plane", "0,0,-1,0"}).status, 0);
  expect_failure({"render", model, "-o", at("no.png"), "--plane", "1,0,0,0"}, "clipgs bake",
                 at("no.png"));
  expect_failure({"refine", model, "--dataset", dataset, "-o", at("r.ply")}, "clipgs bake",
                 at("r.ply"));

  // Refinement and packing left to do.
  fs::remove(at("layered.sog"));
  fs::remove(at("layered.clipgs-work/scene.ply"));
  ASSERT_EQ(run_clipgs(build).status, 0);
  EXPECT_TRUE(read_text(at("layered.sog")) == expected);
}

TEST_F(BuildTest, BuildOfAnUnusableVolumeLeavesNothing) {
  // A NIfTI of size zero.
  std::string header(352, '\0');
  const auto put = [&](size_t at, std::int16_t number) {
    std::memcpy(&header[at], &number, sizeof number);
  };
  put(0, 348);
  for (const auto& [at, number] : {std::pair{40, 3}, {42, 0}, {44, 16}, {46, 16}, {70, 16}}) {
    put(static_cast<size_t>(at), static_cast<std::int16_t>(number));
  }
  std::memcpy(&header[344], "n+1", 4);
  write_text(at("zero.nii"), header);
  const Finished finished = run_clipgs({"build", at("zero.nii"), "-o", at("zero.sog")});
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("zero.nii: "));
  EXPECT_FALSE(fs::exists(at("zero.clipgs-work")));
  EXPECT_FALSE(fs::exists(at("zero.sog")));
}

TEST_F(BuildTest, CasesAreCalledByRegionAndLookNeverByTheVolumesFile) {
  ASSERT_EQ(run_clipgs({"phantom", at("Miller.nii.gz"), "--size", "64"}).status, 0);
  const auto info_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> build = {"build",        at("Miller.nii.gz"), "-o",
                                      at("case.sog"), "--quality",         "instant",
                                      "--preset",     "skin-and-bone"};
    build.insert(build.end(), more.begin(), more.end());
    EXPECT_EQ(run_clipgs(build).status, 0);
    EXPECT_THAT(read_text(at("case.sog")), Not(HasSubstr("Miller")));
    return nlohmann::json::parse(run_clipgs({"info", at("case.sog"), "--json"}).out);
  };
  const nlohmann::json knee = info_of({"--region", "knee"});
  EXPECT_EQ(knee.at("title"), "Knee, skin and bone");
  EXPECT_EQ(knee.at("region"), "knee");
  EXPECT_EQ(knee.at("look").at("modality"), "CT");
  const nlohmann::json seen = info_of({});
  EXPECT_EQ(seen.at("title"), "Trunk, skin and bone");
  const Finished failed = run_clipgs({"info", at("Miller.nii.gz"), "--region", "Miller"});
  EXPECT_EQ(failed.status, 2);
  EXPECT_THAT(failed.err, HasSubstr("give one of head, "));
}

TEST_F(BuildTest, InstantCasesNeedNoWork) {
  const Finished made = run_clipgs({"phantom", at("p.nii.gz"), "--size", "64"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::vector<std::string> build = {"build",     at("p.nii.gz"), "-o",      at("now.sog"),
                                          "--quality", "instant",      "--title", "At once"};
  const Finished built = run_clipgs(build);
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_THAT(built.out, HasSubstr("now.sog: "));
  EXPECT_FALSE(fs::exists(at("now.clipgs-work")));
  const Finished info = run_clipgs({"info", at("now.sog"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("title"), "At once");
  const std::string first = read_text(at("now.sog"));
  for (const std::string& title :
       {std::string(9000, 'x'), std::string("a\nb"), std::string("M\xfcller")}) {
    const Finished failed =
        run_clipgs({"build", at("p.nii.gz"), "-o", at("now.sog"), "--title", title});
    EXPECT_EQ(failed.status, 2);
    EXPECT_THAT(failed.err, HasSubstr("--title: "));
  }
  for (const auto& [option, value] :
       {std::pair{"--steps", "5"}, {"--work", "w"}, {"--model", "clipgs"}, {"--test-size", "64"}}) {
    std::vector<std::string> wrong = build;
    wrong.insert(wrong.end(), {option, value});
    const Finished failed = run_clipgs(wrong);
    EXPECT_EQ(failed.status, 2);
    EXPECT_THAT(failed.err, HasSubstr("trains nothing"));
    EXPECT_THAT(failed.err, HasSubstr(option));
  }
  std::vector<std::string> unlit = build;
  unlit.insert(unlit.end(), {"--gradient-opacity", "10,20"});
  EXPECT_THAT(run_clipgs(unlit).err, HasSubstr("gradient opacity"));
  EXPECT_TRUE(read_text(at("now.sog")) == first);  // it is still there
}

TEST_F(BuildTest, StepsOfAQualityMakeTheBuildsCase) {
  ASSERT_EQ(run_clipgs(tiny_build("whole.sog", {"--title", "x"})).status, 0);
  const std::vector<std::vector<std::string>> steps = {
      {"dataset", phantom(), "-o", at("dataset"), "--quality", "draft", "--size", "32",
       "--train-frames", "4", "--test-frames", "1"},
      {"train", at("dataset"), "-o", at("scene.ply"), "--quality", "draft", "--steps", "20",
       "--budget", "300"},
      {"pack", at("scene.ply"), "-o", at("apart.sog"), "--title", "x"}};
  for (const std::vector<std::string>& step : steps) {
    const Finished finished = run_clipgs(step);
    ASSERT_EQ(finished.status, 0) << finished.err;
  }
  EXPECT_TRUE(read_text(at("apart.sog")) == read_text(at("whole.sog")));
  EXPECT_EQ(run_clipgs({"train", at("dataset"), "-o", at("s.ply"), "--quality", "instant"}).status,
            2);
}

TEST_F(BuildTest, NeedsAreToldFromTheHeaderAndNothingIsBuilt) {
  // A header of 256 MB of voxels, and not one of them.
  write_text(at("large.mhd"),
             "ObjectType = Image\nNDims = 3\nDimSize = 512 512 512\nElementSpacing = 1 1 1\n"
             "ElementType = MET_SHORT\nElementDataFile = none.raw\n");
  const auto steps = [&](const std::vector<std::string>& more) {
    std::vector<std::string> build = {"build", at("large.mhd"), "-o", at("c.sog"), "--needs"};
    build.insert(build.end(), more.begin(), more.end());
    const Finished finished = run_clipgs(build);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return nlohmann::json::parse(finished.out).at("steps");
  };
  const nlohmann::json draft = steps({"--quality", "draft"});
  EXPECT_GT(draft.at("dataset").at("memory_mb").get<int>(), 256 * 2);
  EXPECT_GT(steps({"--quality", "high"}).at("train").at("seconds").get<int>(),
            draft.at("train").at("seconds").get<int>());
  EXPECT_TRUE(steps({"--model", "clipgs"}).contains("refine"));
  EXPECT_TRUE(steps({"--quality", "instant"}).contains("build"));
  EXPECT_FALSE(fs::exists(at("c.sog")) || fs::exists(at("c.clipgs-work")));
  expect_failure({"build", at("absent.nii"), "-o", at("c.sog"), "--needs"}, "does not exist");
}

}  // namespace
}  // namespace clipgs
