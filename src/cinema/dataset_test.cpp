#include "cinema/dataset.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <unistd.h>

#include "cinema/choose_frames.h"
#include "cinema/dataset_claim.h"
#include "cinema/held_out.h"
#include "cinema/make_dataset.h"
#include "cinema/seed_points.h"
#include "cinema/test_scenes.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "volume/phantom.h"
#include "volume/upsample.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test::make_preset;
using test::point;
using testing::HasSubstr;
using testing::ThrowsMessage;

class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(fs::temp_directory_path() / ("clipgs_dataset_test_" + std::to_string(getpid()) + "_" +
                                           std::to_string(count_++))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

struct Fixture {
  Volume volume = make_ball(32, 12, 1, 0);
  Preset preset = make_preset({point(0.2f, 0, Vec3(0.7f)), point(0.8f, 2, Vec3(0.7f, 0.5f, 0.4f))},
                              {Vec3(0.6f), Vec3(0.3f), Vec3(0.1f), {}}, 2);
  DatasetOptions options;
  Fixture() {
    preset.name = "ball";
    options.size = 24;
    options.upsample = false;  // one test looks at it; it takes most of the time of so few pictures
    options.train_frames = 7;
    options.test_frames = 2;
    options.validation_frames = 1;
    options.train_spp = 8;
    options.test_noise_db = 36;
    options.test_masked_noise_db = 34;
    options.seed_points = 2000;
  }
  Dataset make(const fs::path& folder) const {
    return make_dataset(volume, preset, folder, options);
  }
};

float offset_along_axis(const Frame& frame) {
  const Plane plane = frame.plane.value();
  return plane.normal.z * plane.offset;
}

TEST(PlanFrames, SharesAndHeldOutPlanes) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  options.train_frames = 400;
  options.test_frames = 25;
  options.validation_frames = 13;
  const std::vector<Frame> frames = plan_frames(matter, options);
  ASSERT_EQ(frames.size(), 476U);
  int axis = 0;
  int oblique = 0;
  int uncut = 0;
  int seen = 0;
  int up = 0;
  Vec3 mean_direction(0);
  std::set<std::string> files;
  std::vector<float> offsets;
  for (const Frame& frame : frames) {
    files.insert(frame.file);
    if (frame.plane) {
      EXPECT_NEAR(glm::length(frame.plane->normal), 1, 1e-5);
      const Vec2 extent = matter.extent(frame.plane->normal);
      EXPECT_GT(frame.plane->offset, extent.x);
      EXPECT_LT(frame.plane->offset, extent.y);
    }
    if (frame.split != Split::kTrain) {
      EXPECT_TRUE(frame.plane);
      EXPECT_EQ(std::abs(frame.plane->normal.z) > 0.9999f,
                frame.split == Split::kTestAxis || frame.split == Split::kValidationAxis);
      EXPECT_FALSE(frame.uncut_file.empty());
      EXPECT_FALSE(frame.depth_file.empty());
      EXPECT_FALSE(frame.uncut_depth_file.empty());
      EXPECT_NEAR(glm::length(frame.camera.position - matter.sphere.center),
                  framing_distance(matter.sphere.radius), 0.01);
      continue;
    }
    mean_direction += glm::normalize(frame.camera.position - matter.sphere.center) / 400.0f;
    if (!frame.plane) {
      ++uncut;
      continue;
    }
    seen += frame.plane->signed_distance(frame.camera.position) < 0 ? 1 : 0;
    if (std::abs(frame.plane->normal.z) > 0.9999f) {
      ++axis;
      up += frame.plane->normal.z > 0 ? 1 : 0;
      offsets.push_back(offset_along_axis(frame));
    } else {
      ++oblique;
    }
  }
  EXPECT_EQ(files.size(), frames.size());
  EXPECT_NEAR(axis, 160, 8);
  EXPECT_NEAR(oblique, 180, 8);
  EXPECT_NEAR(uncut, 60, 8);
  EXPECT_NEAR(seen, 0.75 * (axis + oblique), 35);
  EXPECT_NEAR(up, 0.5 * axis, 0.2 * axis);
  EXPECT_LT(glm::length(mean_direction), 0.01f);
  // Axis planes cover what is left of the extent evenly: 10 and 5 windows of 2 % are not theirs.
  std::ranges::sort(offsets);
  const Vec2 extent = matter.extent(options.axis);
  for (size_t i = 1; i < offsets.size(); ++i) {
    const float step = (offsets[i] - offsets[i - 1]) / (extent.y - extent.x);
    EXPECT_LT(step, 2.01f / axis + 0.021f);
  }
}

bool is_test(Split split) { return split == Split::kTestAxis || split == Split::kTestOblique; }

/// What a frame is for: two of different uses must not be alike.
int use_of(Split split) { return split == Split::kTrain ? 0 : is_test(split) ? 1 : 2; }

TEST(PlanFrames, NoSplitComesNearAnother) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  for (const bool one_sided : {false, true}) {
    DatasetOptions options;
    options.train_frames = 1000;
    options.test_frames = 25;
    options.validation_frames = 13;
    options.one_sided = one_sided;
    options.axis = glm::normalize(Vec3(1, 2, 2));
    const std::vector<Frame> frames = plan_frames(CinemaScene(f.volume, f.preset), matter, options);
    float turn = 180;
    float step = 1;
    for (const Frame& a : frames) {
      for (const Frame& b : frames) {
        if (a.split == Split::kTrain || use_of(a.split) == use_of(b.split)) {
          continue;
        }
        const float cosine = glm::dot(view_of(a, matter), view_of(b, matter));
        turn = std::min(turn, glm::degrees(std::acos(std::min(1.0f, cosine))));
        if (b.plane) {
          const Vec2 extent = matter.extent(b.plane->normal);
          step = std::min(
              step, plane_distance(*a.plane, *b.plane, matter.sphere) / (extent.y - extent.x));
        }
      }
    }
    EXPECT_GT(turn, 4.99f);
    EXPECT_GT(step, 0.0099f);
  }
}

TEST(PlanFrames, ManyHeldOutViewsLeaveHalfOfAllDirections) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  options.train_frames = 50;
  options.test_frames = options.validation_frames = 500;
  EXPECT_EQ(plan_frames(matter, options).size(), 2050U);
}

TEST(PlanFrames, OneSidedAxisPlanesKeepWhatIsBelow) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  options.train_frames = 400;
  options.one_sided = true;
  const Vec2 extent = matter.extent(options.axis);
  int axis = 0;
  int seen = 0;
  for (const Frame& frame : plan_frames(matter, options)) {
    if (!frame.plane || std::abs(frame.plane->normal.z) < 0.9999f) {
      continue;
    }
    EXPECT_EQ(frame.plane->normal, Vec3(0, 0, -1));
    EXPECT_GT(offset_along_axis(frame), glm::mix(extent.x, extent.y, 0.149f));
    EXPECT_NEAR(glm::length(frame.camera.to_camera(matter.sphere.center)),
                glm::length(frame.camera.position - matter.sphere.center), 0.01);
    if (frame.split == Split::kTrain) {
      ++axis;
      seen += frame.plane->signed_distance(frame.camera.position) < 0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(axis, 160, 8);
  EXPECT_NEAR(seen, 0.75 * axis, 16);
}

TEST(PlanFrames, TestPlanesStayInTheMatterHoweverManyTrainingHas) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  options.train_frames = 5000;
  const Vec2 extent = matter.extent(options.axis);
  for (const Frame& frame : plan_frames(matter, options)) {
    if (frame.split == Split::kTestAxis) {
      const float height = offset_along_axis(frame);
      EXPECT_GT(height, glm::mix(extent.x, extent.y, 0.09f));
      EXPECT_LT(height, glm::mix(extent.x, extent.y, 0.91f));
    }
  }
}

// Frames by kind: uncut, axis or oblique.
std::array<int, 3> count_kinds(const std::vector<Frame>& frames) {
  std::array<int, 3> counts{};
  for (const Frame& frame : frames) {
    if (frame.split == Split::kTrain) {
      ++counts[!frame.plane ? 0 : std::abs(frame.plane->normal.z) > 0.9999f ? 1 : 2];
    }
  }
  return counts;
}

bool same_view(const Frame& a, const Frame& b) {
  return a.camera.position == b.camera.position && a.plane.has_value() == b.plane.has_value() &&
         (!a.plane || (a.plane->normal == b.plane->normal && a.plane->offset == b.plane->offset));
}

TEST(PlanFrames, ChosenFramesAreOfTheSameKindsAndLeaveTheTestAlone) {
  const Fixture f;
  const CinemaScene scene(f.volume, f.preset);
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  for (const int count : {1, 7, 60}) {
    options.train_frames = count;
    const std::vector<Frame> spread = plan_frames(matter, options);
    const std::vector<Frame> chosen = plan_frames(scene, matter, options);
    ASSERT_EQ(chosen.size(), spread.size());
    EXPECT_EQ(count_kinds(chosen), count_kinds(spread));
    double distances = 0;
    for (size_t i = 0; i < chosen.size(); ++i) {
      EXPECT_EQ(chosen[i].file, spread[i].file);
      distances += glm::length(chosen[i].camera.position - matter.sphere.center) -
                   glm::length(spread[i].camera.position - matter.sphere.center);
      if (chosen[i].split != Split::kTrain) {
        EXPECT_TRUE(same_view(chosen[i], spread[i]));
      }
    }
    EXPECT_NEAR(distances, 0, 1e-3 * count);
  }
}

TEST(PlanFrames, ChoosesTheSameOnAnyNumberOfThreads) {
  const Fixture f;
  const CinemaScene scene(f.volume, f.preset);
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  DatasetOptions options;
  options.train_frames = 50;
  const std::vector<Frame> many = plan_frames(scene, matter, options);
  set_thread_count(1);
  const std::vector<Frame> one = plan_frames(scene, matter, options);
  set_thread_count(0);
  for (size_t i = 0; i < many.size(); ++i) {
    EXPECT_TRUE(same_view(one[i], many[i]));
  }
}

Frame frame_from(const Sphere& sphere, const Vec3& direction, std::optional<Plane> plane = {}) {
  Frame frame;
  frame.camera = frame_sphere(sphere, direction, 1, 64, 64);
  frame.plane = plane;
  return frame;
}

TEST(ChooseFrames, TakesWhatOthersDoNotShow) {
  const Fixture f;
  const CinemaScene scene(f.volume, f.preset);
  const Sphere sphere = visible_matter(f.volume, f.preset.transfer).sphere;
  FramePool pool;
  pool.frames.assign(2, frame_from(sphere, Vec3(1, 0, 0)));
  pool.frames.push_back(frame_from(sphere, Vec3(-1, 0, 0)));
  pool.groups.assign(pool.frames.size(), 0);
  pool.quotas = {2};
  EXPECT_EQ(choose_frames(scene, sphere, pool), (std::vector<size_t>{0, 2}));
  // Of a group of its own each frame has its turn.
  pool.groups[1] = 1;
  pool.quotas = {2, 1};
  EXPECT_EQ(choose_frames(scene, sphere, pool), (std::vector<size_t>{0, 1, 2}));
}

TEST(ChooseFrames, PrefersSurfacesToFaces) {
  const Volume ball = make_ball(32, 12, 1, 0);
  const Preset preset = make_preset({point(0.2f, 0), point(0.8f, 20)}, test::white_sky());
  const CinemaScene scene(ball, preset);
  const Sphere sphere = visible_matter(ball, preset.transfer).sphere;
  // Half a ball, seen on its face and from the other side.
  const Plane plane{Vec3(-1, 0, 0), 0};
  FramePool pool;
  pool.frames = {frame_from(sphere, Vec3(1, 0, 0), plane),
                 frame_from(sphere, Vec3(-1, 0, 0), plane)};
  pool.groups = {0, 0};
  pool.quotas = {1};
  EXPECT_EQ(choose_frames(scene, sphere, pool), (std::vector<size_t>{1}));
}

TEST(PlanFrames, ShareOfTrainingFramesIsNear) {
  Fixture f;
  f.options.train_frames = 200;
  f.options.close_frames = 2;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  const std::vector<Frame> whole = plan_frames(matter, f.options);
  std::vector<Frame> frames = whole;
  bring_near(0.25f, f.options.seed, frames);
  int count = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    const Camera& near = frames[i].camera;
    const Camera& far = whole[i].camera;
    const float zoom = near.fx / far.fx;
    EXPECT_EQ(near.fy / far.fy, zoom);
    EXPECT_EQ(near.position, far.position);
    if (zoom == 1) {
      EXPECT_EQ(near.cx, far.cx);
      continue;
    }
    ++count;
    EXPECT_EQ(zoom, 2);
    EXPECT_EQ(frames[i].split, Split::kTrain);
    // Its corners are seen in the whole picture, too.
    for (const float at : {0.0f, 24.0f}) {
      EXPECT_NEAR((at - near.cx) / zoom + far.cx, 12, 12.001f);
      EXPECT_NEAR((at - near.cy) / zoom + far.cy, 12, 12.001f);
    }
  }
  EXPECT_NEAR(count, 50, 15);
  frames = whole;
  bring_near(0, f.options.seed, frames);
  EXPECT_TRUE(std::ranges::all_of(frames, [](const Frame& frame) {
    return frame.camera.cx == 0.5f * static_cast<float>(frame.camera.width);
  }));
}

TEST(PlanFrames, UncutAndCloseTestsOfTheirOwnSize) {
  Fixture f;
  f.options.test_size = 40;
  f.options.uncut_frames = 3;
  f.options.close_frames = 6;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  const CinemaScene scene(f.volume, f.preset);
  std::vector<Frame> frames = plan_frames(matter, f.options);
  const std::vector<Frame> whole = frames;
  aim_close_ups(scene, f.options.seed, frames);
  std::map<Split, std::vector<Frame>> splits;
  for (size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = frames[i];
    EXPECT_EQ(frame.camera.width, frame.split == Split::kTrain ? 24 : 40);
    EXPECT_EQ(frame.camera.position, whole[i].camera.position);
    EXPECT_EQ(frame.uncut_file.empty(), !frame.plane || frame.split == Split::kTrain);
    splits[frame.split].push_back(frame);
  }
  EXPECT_EQ(splits[Split::kTestUncut].size(), 3U);
  EXPECT_EQ(splits[Split::kValidationUncut].size(), 2U);
  ASSERT_EQ(splits[Split::kTestClose].size(), 6U);
  EXPECT_EQ(splits[Split::kValidationClose].size(), 3U);
  EXPECT_FALSE(splits[Split::kTestUncut][0].plane);
  const float whole_body = splits[Split::kTestUncut][0].camera.fx;
  for (size_t i = 0; i < 6; ++i) {
    const Frame& frame = splits[Split::kTestClose][i];
    EXPECT_EQ(frame.plane.has_value(), i % 2 == 0);
    EXPECT_FLOAT_EQ(frame.camera.fx / whole_body, static_cast<float>(2 + i % 3));
    // In the middle is matter: of the face, if the camera sees it.
    const float hit = *render_depth(scene, frame.camera, frame.plane).at(20, 20);
    EXPECT_GT(hit, 0) << i;
    if (frame.plane && frame.plane->signed_distance(frame.camera.position) < 0) {
      const Vec3 place = frame.camera.position + hit * frame.camera.ray_direction(20, 20);
      EXPECT_NEAR(frame.plane->signed_distance(place), 0, 2) << i;
    }
  }
}

TEST(Dataset, CutViewsSeeFacesStraightAndEdgesAlongThePlane) {
  const Fixture f;
  const VisibleMatter matter = visible_matter(f.volume, f.preset.transfer);
  const std::vector<Frame> frames = plan_cut_views(matter, 40, 3);
  std::map<Split, int> counts;
  int edges = 0;
  for (const Frame& frame : frames) {
    ++counts[frame.split];
    const Plane& plane = *frame.plane;
    EXPECT_NEAR(plane.signed_distance(matter.sphere.center), 0, 1e-3f);
    const Vec3 from = glm::normalize(frame.camera.position - matter.sphere.center);
    const float sine = glm::dot(from, plane.normal);
    if (sine > 0) {
      EXPECT_NEAR(sine, std::sin(1.5f * 0.0174533f), 1e-4f);
      ++edges;
    } else {
      EXPECT_LT(sine, -std::cos(10.1f * 0.0174533f));
    }
    for (int k = 0; k < 9; ++k) {
      EXPECT_TRUE(std::isfinite(frame.camera.rotation[k / 3][k % 3]));
    }
  }
  EXPECT_EQ(counts[Split::kTestCutAxis], 30);
  EXPECT_EQ(counts[Split::kTestCutOblique], 15);
  EXPECT_EQ(edges, 25);
  std::set<std::string> files;
  for (const Frame& frame : frames) {
    files.insert(frame.file);
  }
  EXPECT_EQ(files.size(), frames.size());
}

TEST(Dataset, HasUncutAndClosePictures) {
  Fixture f;
  f.options.uncut_frames = 1;
  f.options.close_frames = 2;
  f.options.test_size = 32;
  const TemporaryFolder folder;
  const Dataset dataset = f.make(folder.path());
  const std::vector<const Frame*> close = dataset.split(Split::kTestClose);
  ASSERT_EQ(close.size(), 2U);
  ASSERT_EQ(dataset.split(Split::kTestUncut).size(), 1U);
  EXPECT_EQ(dataset.load(*close[0]).width, 32);
  EXPECT_TRUE(fs::exists(folder.path() / close[0]->uncut_depth_file));
  EXPECT_TRUE(fs::exists(folder.path() / close[1]->depth_file));
  EXPECT_TRUE(close[1]->uncut_depth_file.empty());
  const Frame& uncut = *dataset.split(Split::kTestUncut)[0];
  EXPECT_GE(uncut.masked_noise_db, f.options.test_masked_noise_db);
}

TEST(Dataset, ComesBackFromDisk) {
  Fixture f;
  f.options.upsample = true;
  const TemporaryFolder folder;
  const Dataset dataset = f.make(folder.path());
  EXPECT_EQ(dataset.split(Split::kTrain).size(), 7U);
  EXPECT_EQ(dataset.split(Split::kTestAxis).size(), 2U);
  EXPECT_EQ(dataset.split(Split::kTestOblique).size(), 2U);
  EXPECT_EQ(dataset.split(Split::kValidationAxis).size(), 1U);
  ASSERT_EQ(dataset.ends.size(), 6U);
  for (const Plane& end : dataset.ends) {  // of voxels' centres from −15.5 to 15.5
    EXPECT_NEAR(end.offset, -15.5f, 1e-4f);
  }
  EXPECT_EQ(dataset.preset, "ball");
  EXPECT_NEAR(dataset.sphere.radius, 12, 1.5);
  EXPECT_FLOAT_EQ(dataset.voxel_mm, 1);
  const Volume traced = upsample(f.volume, f.preset.transfer);
  const std::vector<Frame> planned = plan_frames(
      CinemaScene(traced, f.preset), visible_matter(f.volume, f.preset.transfer), f.options);
  for (size_t i = 0; i < planned.size(); ++i) {
    const Frame& frame = dataset.frames[i];
    EXPECT_EQ(frame.file, planned[i].file);
    EXPECT_EQ(frame.plane.has_value(), planned[i].plane.has_value());
    EXPECT_LT(glm::length(frame.camera.position - planned[i].camera.position), 1e-3f);
    EXPECT_LT(glm::length(frame.camera.forward() - planned[i].camera.forward()), 1e-5f);
    EXPECT_EQ(dataset.load(frame).channels, 4);
    if (frame.split != Split::kTrain) {
      EXPECT_GE(frame.noise_db, f.options.test_noise_db);
      EXPECT_GE(frame.masked_noise_db, f.options.test_masked_noise_db);
      EXPECT_LT(frame.masked_noise_db, frame.noise_db);
      const Image depth = read_png(folder.path() / frame.depth_file);
      const float nearest = glm::length(frame.camera.position) - 13;
      for (size_t p = 0; p < depth.pixels(); ++p) {
        const float mm =
            depth.data[p * static_cast<size_t>(depth.channels)] * 65535 * dataset.depth_scale;
        EXPECT_TRUE(mm == 0 || (mm > nearest && mm < nearest + 28)) << mm;
      }
      EXPECT_EQ(read_png(folder.path() / frame.uncut_file).channels, 4);
    }
  }
  for (const SeedPoint& seed : load_seed_points(folder.path())) {
    ASSERT_LT(glm::length(seed.position), 13.5f);
    ASSERT_GT(seed.spacing, 0);
    ASSERT_GT(seed.color.r, seed.color.b);
  }
}

std::map<std::string, std::vector<std::uint8_t>> contents(const fs::path& folder) {
  std::map<std::string, std::vector<std::uint8_t>> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
    }
  }
  return files;
}

TEST(Dataset, GoesOnAfterAKill) {
  const Fixture f;
  const TemporaryFolder folder;
  f.make(folder.path());
  const auto whole = contents(folder.path());

  // What a kill after three frames leaves behind.
  const Json index = Json::parse(read_text(folder.path() / "transforms.json"));
  Json state = {{"frames", Json::object()}};
  for (int i = 0; i < 3; ++i) {
    state["frames"][index["frames"][i]["file_path"].get<std::string>()] = {
        index["frames"][i]["noise_db"], index["frames"][i]["masked_noise_db"]};
  }
  fs::remove(folder.path() / "transforms.json");
  for (size_t i = 3; i < index["frames"].size(); ++i) {
    fs::remove(folder.path() / index["frames"][i]["file_path"].get<std::string>());
  }
  write_text(folder.path() / "progress.json", state.dump());
  const fs::path claim_file = folder.path() / "transforms.made-of.json";
  Json claim = Json::parse(read_text(claim_file));
  claim["finished"] = false;
  write_text(claim_file, claim.dump());
  write_text(folder.path() / "images/train_0004.png.clipgs-1.part", "half a picture");
  const fs::path kept = folder.path() / "images/train_0001.png";
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(kept, old);

  f.make(folder.path());
  EXPECT_EQ(contents(folder.path()), whole);
  EXPECT_EQ(fs::last_write_time(kept), old);

  // Whole now: nothing is written again. Other inputs: everything is.
  const fs::path last = folder.path() / "images/test_oblique_0001.png";
  fs::last_write_time(last, old);
  f.make(folder.path());
  EXPECT_EQ(fs::last_write_time(last), old);
  Fixture other;
  other.options.seed = 2;
  other.make(folder.path());
  EXPECT_NE(contents(folder.path()), whole);
  EXPECT_NE(fs::last_write_time(last), old);
}

TEST(Dataset, MorePointsAreNoReasonForOtherPictures) {
  Fixture f;
  const TemporaryFolder folder;
  f.make(folder.path());
  const auto before = contents(folder.path());
  f.options.seed_points *= 2;
  f.make(folder.path());
  for (const auto& [file, bytes] : contents(folder.path())) {
    EXPECT_EQ(bytes == before.at(file), !file.starts_with("points.")) << file;
  }
}

/// Every change must be seen, and called by its name.
TEST(DatasetClaims, AreOfAllThatPicturesShow) {
  const auto changed = [](auto change) {
    Fixture f;
    f.volume.labels.assign(f.volume.voxels(), 0);
    f.volume.label_numbers = {0, 7};
    f.preset.rig.environment = std::make_shared<const Image>(4, 2, 3);
    f.preset.rig.keys.push_back({});
    const DatasetClaims before = claims_of(f.volume, f.preset, f.options);
    change(f.volume, f.preset, f.options);
    const DatasetClaims after = claims_of(f.volume, f.preset, f.options);
    return changes(before.pictures, after.pictures) + "; " + changes(before.points, after.points);
  };
  using V = Volume&;
  using P = Preset&;
  using O = DatasetOptions&;
  EXPECT_EQ(changed([](V, P, O) {}), "; ");
  const std::string volume = "the volume changed; the volume changed";
  EXPECT_EQ(changed([](V v, P, O) { v.values.unpack().back() += 1; }), volume);
  EXPECT_EQ(changed([](V v, P, O) { v.spacing.z *= 2; }), volume);
  EXPECT_EQ(changed([](V v, P, O) { v.origin.x += 1; }), volume);
  EXPECT_EQ(changed([](V v, P, O) { v.direction[0] = -v.direction[0]; }), volume);
  EXPECT_EQ(changed([](V v, P, O) { v.rgb.resize(3 * v.voxels()); }), volume);
  EXPECT_EQ(changed([](V v, P, O) { v.labels.back() = 1; }),
            "the labels changed; the labels changed");
  const std::string looks = "the labels' looks changed; the labels' looks changed";
  EXPECT_EQ(changed([](V, P p, O) { p.labels[7].opacity = 0; }), looks);
  EXPECT_EQ(changed([](V, P p, O) { p.labels[7].albedo = Vec3(0); }), looks);
  const std::string preset = "the preset changed; the preset changed";
  EXPECT_EQ(changed([](V, P p, O) { p.name = "other"; }), preset);
  EXPECT_EQ(changed([](V, P p, O) { p.surface_strength *= 2; }), preset);
  EXPECT_EQ(changed([](V, P p, O) { p.gradient_opacity = {0, 1, 0}; }), preset);
  EXPECT_EQ(changed([](V, P p, O) { p.boundary = BoundaryLook{{0, 1}, p.transfer}; }), preset);
  for (float Material::* const member :
       {&Material::extinction, &Material::specular, &Material::roughness, &Material::phase}) {
    EXPECT_EQ(changed([&](V, P p, O) {
                std::vector<TransferPoint> points = p.transfer.points();
                points.back().material.*member += 0.01f;
                p.transfer = TransferFunction(points);
              }),
              preset);
  }
  const std::string lights = "the lights changed; the lights changed";
  EXPECT_EQ(changed([](V, P p, O) { p.rig.sky_bottom.y += 1; }), lights);
  EXPECT_EQ(changed([](V, P p, O) { p.rig.keys[0].angular_radius += 1; }), lights);
  EXPECT_EQ(changed([](V, P p, O) { p.rig.keys[0].distance += 1; }), lights);
  EXPECT_EQ(changed([](V, P p, O) { p.rig.environment_turn += 1; }), lights);
  EXPECT_EQ(changed([](V, P p, O) {
              Image sky = *p.rig.environment;
              sky.data[5] = 1;
              p.rig.environment = std::make_shared<const Image>(sky);
            }),
            lights);
  EXPECT_EQ(changed([](V, P p, O) { p.exposure = 2; }),
            "the exposure changed; the exposure changed");
  EXPECT_EQ(changed([](V, P p, O) { p.tone = ToneCurve::kFilmic; }),
            "the tone changed; the tone changed");
  EXPECT_EQ(changed([](V, P, O o) { o.size = 25; }), "the size changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.test_size = 24; }), "; ");  // as it is
  EXPECT_EQ(changed([](V, P, O o) { o.test_size = 25; }), "the test size changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.close_frames = 2; }), "the close frames changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.train_frames = 8; }), "the train frames changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.axis = Vec3(1, 0, 0); }), "the axis changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.one_sided = true; }), "the side of axis planes changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.choose_views = false; }), "the choice of views changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.near_share = 0.25f; }), "the share of near views changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.upsample = !o.upsample; }), "the voxels changed; ");
  EXPECT_EQ(changed([](V, P, O o) { o.seed = 2; }), "the seed changed; the seed changed");
  EXPECT_EQ(changed([](V, P, O o) { o.seed_points = 9; }), "; the number of points changed");
}

TEST(Dataset, RefusesOptionsOutOfRange) {
  const TemporaryFolder folder;
  const auto refuses = [&](auto change, const char* says) {
    Fixture f;
    change(f.options);
    EXPECT_THAT([&] { f.make(folder.path()); }, ThrowsMessage<Error>(HasSubstr(says)));
  };
  refuses([](DatasetOptions& o) { o.size = 8; }, "pictures of 8x8 px are out of range");
  refuses([](DatasetOptions& o) { o.test_size = 5000; }, "5000x5000 px are out of range");
  refuses([](DatasetOptions& o) { o.close_frames = -1; }, "at least one training frame");
  refuses([](DatasetOptions& o) { o.near_share = 1.5f; }, "a share of 1.5 training frames");
  refuses([](DatasetOptions& o) { o.axis = Vec3(2, 0, 0); }, "unit vector");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Dataset, DenoisesTrainingPicturesAndNoOthers) {
  Fixture f;
  const TemporaryFolder plain_folder;
  const TemporaryFolder denoised_folder;
  const Dataset plain = f.make(plain_folder.path());
  f.options.denoise = true;
  const Dataset denoised = f.make(denoised_folder.path());
  ASSERT_EQ(plain.frames.size(), denoised.frames.size());
  for (size_t i = 0; i < plain.frames.size(); ++i) {
    const Frame& frame = plain.frames[i];
    const bool training = frame.split == Split::kTrain;
    const auto same = [&](const std::string& file) {
      return read_file(plain_folder.path() / file) == read_file(denoised_folder.path() / file);
    };
    EXPECT_EQ(same(frame.file), !training) << frame.file;
    EXPECT_TRUE(training || same(frame.uncut_file));
    EXPECT_TRUE(training || same(frame.depth_file));
    EXPECT_EQ(frame.noise_db, denoised.frames[i].noise_db);  // that before denoising
  }
  const Json a = Json::parse(read_text(plain_folder.path() / "transforms.json"));
  const Json b = Json::parse(read_text(denoised_folder.path() / "transforms.json"));
  EXPECT_FALSE(a["train_denoised"]);
  EXPECT_TRUE(b["train_denoised"]);
  EXPECT_EQ(changes(read_claim(plain_folder.path() / "transforms"),
                    read_claim(denoised_folder.path() / "transforms")),
            "the denoising changed");
}

TEST(Dataset, RefusesWhatItCannotTrust) {
  const Fixture f;
  const TemporaryFolder folder;
  EXPECT_THAT([&] { load_dataset(folder.path()); }, ThrowsMessage<Error>(HasSubstr("no dataset")));
  f.make(folder.path());
  const fs::path path = folder.path() / "transforms.json";
  const Json good = Json::parse(read_text(path));
  const auto expect_refused = [&](const char* pointer, const Json& value, const char* says) {
    Json bad = good;
    bad[Json::json_pointer(pointer)] = value;
    write_text(path, bad.dump());
    EXPECT_THAT([&] { load_dataset(folder.path()); }, ThrowsMessage<Error>(HasSubstr(says)))
        << pointer;
  };
  expect_refused("/frames", Json::array(), "\"frames\"");
  expect_refused("/axis", {0, 0, 2}, "unit vector");
  expect_refused("/extent", {1}, "\"extent\"");
  expect_refused("/sphere/radius", -1, "empty");
  expect_refused("/frames/2/file_path", "../../etc/passwd", "inside the dataset");
  expect_refused("/frames/2/file_path", "/etc/passwd", "inside the dataset");
  expect_refused("/frames/2/w", 1e9, "\"w\"");
  expect_refused("/frames/2/w", 12.5, "\"w\"");
  expect_refused("/frames/2/split", "tests", "test_axis");
  expect_refused("/frames/2/clip_plane", {1, 1, 1, 0}, "unit normal");
  expect_refused("/frames/2/clip_plane", {1, 0, 0}, "clip_plane");
  expect_refused("/frames/2/transform_matrix/1", {1, 2, 3, 4}, "rigid");
  expect_refused("/frames/2/noise_db", "loud", "noise_db");
  write_text(path, good.dump().substr(0, 500));
  EXPECT_THAT([&] { load_dataset(folder.path()); }, ThrowsMessage<Error>(HasSubstr("JSON")));

  write_text(path, good.dump());
  const Dataset dataset = load_dataset(folder.path());
  write_png(folder.path() / dataset.frames[0].file, Image(5, 5, 4));
  EXPECT_THROW(dataset.load(dataset.frames[0]), Error);

  std::vector<std::uint8_t> points = read_file(folder.path() / "points.ply");
  write_file(folder.path() / "points.ply", points.data(), points.size() - 1);
  EXPECT_THAT([&] { load_seed_points(folder.path()); },
              ThrowsMessage<Error>(HasSubstr("seed points")));
}

TEST(Dataset, OtherLooksOfLabelsMakeItAnew) {
  Fixture f;
  f.options.train_frames = 2;
  f.options.test_frames = 0;
  f.options.validation_frames = 0;
  f.volume.label_numbers = {0, 1};
  f.volume.labels.assign(f.volume.voxels(), 1);
  const TemporaryFolder folder;
  f.make(folder.path());
  const auto before = contents(folder.path());
  f.preset.labels[1].opacity = 0.5f;
  f.make(folder.path());
  EXPECT_NE(contents(folder.path()), before);
}

TEST(Dataset, OtherPhaseOrGradientOpacityMakeItAnew) {
  Fixture f;
  f.options.train_frames = 2;
  f.options.test_frames = 0;
  f.options.validation_frames = 0;
  const TemporaryFolder folder;
  f.make(folder.path());
  const auto before = contents(folder.path());
  std::vector<TransferPoint> points = f.preset.transfer.points();
  points.back().material.phase = 0.5f;
  f.preset.transfer = TransferFunction(points);
  f.make(folder.path());
  const auto with_phase = contents(folder.path());
  EXPECT_NE(with_phase, before);
  f.preset.gradient_opacity = GradientOpacity{0, 1, 0.5f};
  f.make(folder.path());
  EXPECT_NE(contents(folder.path()), with_phase);
}

TEST(SeedPoints, TakeLabelsLooks) {
  Volume ball = make_ball(48, 18, 1, 0);
  ball.label_numbers = {0, 1, 2};
  for (size_t i = 0; i < ball.voxels(); ++i) {
    ball.labels.push_back(i < ball.voxels() / 2 ? 1 : 2);  // inferior, superior
  }
  Preset preset = make_preset({point(0.2f, 0), point(0.8f, 2)}, test::white_sky());
  preset.labels[1].opacity = 0;
  preset.labels[2].albedo = Vec3(0, 1, 0);
  for (const SeedPoint& p : sample_seed_points(ball, preset, 2000, 1)) {
    EXPECT_GT(p.position.z, -0.1f);
    EXPECT_EQ(p.color.r, 0);
    EXPECT_GT(p.color.g, 0.5f);
  }
}

TEST(SeedPoints, LieAtBoundariesIfTheyAloneAreSeen) {
  const Volume ball = make_ball(48, 18, 1, 0);
  Preset preset = make_preset({point(0, 2), point(1, 2)}, test::white_sky());
  preset.gradient_opacity = GradientOpacity{0.05f, 0.2f, 0};
  for (const SeedPoint& p : sample_seed_points(ball, preset, 2000, 1)) {
    EXPECT_NEAR(glm::length(p.position), 18, 3);
  }
}

TEST(SeedPoints, HaveTheBoundarysLookWhereValuesAreSteep) {
  const Volume ball = make_ball(48, 18, 1, 0);
  Preset preset = make_preset({point(0.2f, 0, Vec3(0, 1, 0)), point(0.8f, 2, Vec3(0, 1, 0))},
                              test::white_sky());
  preset.boundary = BoundaryLook{{0.05f, 0.2f}, TransferFunction({point(0.5f, 0, Vec3(1, 0, 0))})};
  for (const SeedPoint& p : sample_seed_points(ball, preset, 2000, 1)) {
    if (glm::length(p.position) < 15) {
      EXPECT_EQ(p.color.r, 0);
    } else if (std::abs(glm::length(p.position) - 18) < 0.3f) {
      EXPECT_GT(p.color.r, 0.3f);
    }
  }
}

TEST(SeedPoints, FillTheSolidAndCrowdAtBoundaries) {
  const Volume ball = make_ball(64, 24, 1, 0);
  const Preset preset = make_preset({point(0.2f, 0), point(0.8f, 2)}, test::white_sky());
  const std::vector<SeedPoint> points = sample_seed_points(ball, preset, 30000, 1);
  EXPECT_NEAR(static_cast<double>(points.size()), 30000, 600);
  int inner = 0;
  int shell = 0;
  double inner_spacing = 0;
  double shell_spacing = 0;
  for (const SeedPoint& p : points) {
    const float r = glm::length(p.position);
    if (r < 12) {
      ++inner;
      inner_spacing += p.spacing;
    } else if (r > 23) {
      ++shell;
      shell_spacing += p.spacing;
    }
  }
  const double volume_of_inner = 4.19 * 12 * 12 * 12;
  inner_spacing /= inner;
  // Spacing is what it says: the cube root of the volume per point.
  EXPECT_NEAR(std::cbrt(volume_of_inner / inner), inner_spacing, 0.05 * inner_spacing);
  EXPECT_LT(shell_spacing / shell, 0.8 * inner_spacing);
}

}  // namespace
}  // namespace clipgs
