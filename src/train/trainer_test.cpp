#include "train/trainer.h"

#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cinema/make_dataset.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "section/faces.h"
#include "splat/overdraw.h"
#include "splat/render.h"
#include "volume/phantom.h"
#include "volume/preset.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

/// One small dataset of a bone-dense ball for all tests of this file.
class TrainerTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Progress::set_enabled(false);
    folder_ = fs::path(testing::TempDir()) / ("clipgs-trainer-" + std::to_string(getpid()));
    DatasetOptions options;
    options.size = 48;
    options.train_frames = 10;
    options.test_frames = 1;
    options.validation_frames = 0;
    options.train_spp = 4;
    options.test_noise_db = 20;
    options.test_masked_noise_db = 0;
    options.upsample = false;
    options.seed_points = 2000;
    make_dataset(make_ball(32, 11, 300, -1000), load_preset("soft-tissue"), folder_ / "data",
                 options);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static Dataset dataset() { return load_dataset(folder_ / "data"); }
  static TrainOptions options() {
    TrainOptions options;
    options.budget = 600;
    options.start = 400;
    options.steps = 240;
    options.relocate_every = 20;
    return options;
  }
  static std::vector<float> trained(Trainer& trainer) {
    while (trainer.steps_done() < options().steps) {
      trainer.step();
    }
    return trainer.gaussians().data();
  }

  static fs::path folder_;
};

fs::path TrainerTest::folder_;

TEST_F(TrainerTest, LearnsAndGrowsToTheBudget) {
  const Dataset data = dataset();
  const auto error = [&](const Gaussians& gaussians) {
    double sum = 0;
    for (const Frame* frame : data.split(Split::kTrain)) {
      const Image truth = composite(data.load(*frame), 0, 0, 0);
      const Image picture =
          composite(render(gaussians, frame->camera, frame->plane, ClipOperator::kExact), 0, 0, 0);
      for (size_t i = 0; i < truth.data.size(); ++i) {
        sum += std::pow(truth.data[i] - picture.data[i], 2);
      }
    }
    return sum;
  };
  Trainer trainer(data, options());
  const double before = error(trainer.gaussians());
  trained(trainer);
  EXPECT_LT(error(trainer.gaussians()), 0.75 * before);
  EXPECT_EQ(trainer.gaussians().size(), options().budget);
  for (const float v : trainer.gaussians().data()) {
    ASSERT_TRUE(std::isfinite(v));
  }
}

TEST_F(TrainerTest, ThePenaltyOnOverdrawMakesGaussiansFewAndOpaque) {
  const Dataset data = dataset();
  const auto cost = [&](float penalty) {
    TrainOptions some = options();
    some.overdraw_penalty = penalty;
    Trainer trainer(data, some);
    trained(trainer);
    return overdraw(trainer.gaussians(), data.sphere.radius);
  };
  EXPECT_LT(cost(10 * TrainOptions().overdraw_penalty), 0.7 * cost(0));
}

TEST_F(TrainerTest, GaussiansTooSmallToBeSeenMoveToWhereTheyAreNeeded) {
  const Dataset data = dataset();
  TrainOptions some = options();
  Scene start = scene_of(data);
  {
    Trainer trainer(data, some);
    trained(trainer);
    start.gaussians = trainer.gaussians();
  }
  // As good as nothing in any picture, and opaque.
  start.gaussians.plane(Gaussians::kOpacity)[0] = 2;
  for (int a = 0; a < 3; ++a) {
    start.gaussians.plane(Gaussians::kLogScale + a)[0] = -9;
  }
  some.steps = 2 * some.relocate_every;
  Trainer trainer(data, some, nullptr, &start);
  while (trainer.steps_done() < some.relocate_every) {
    trainer.step();
  }
  EXPECT_GT(trainer.gaussians().scale(0).x, 0.01f);
}

TEST_F(TrainerTest, SameBytesAtOneAndTwoThreads) {
  std::vector<float> results[2];
  for (int threads = 1; threads <= 2; ++threads) {
    set_thread_count(threads);
    Trainer trainer(dataset(), options());
    results[threads - 1] = trained(trainer);
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(TrainerTest, ResumesFromACheckpointToTheSameBytes) {
  Trainer whole(dataset(), options());
  const std::vector<float> expected = trained(whole);

  const fs::path checkpoint = folder_ / "checkpoint";
  Trainer first(dataset(), options());
  EXPECT_FALSE(first.load_checkpoint(checkpoint));
  for (int i = 0; i < 137; ++i) {  // in the middle of an epoch
    first.step();
  }
  first.save_checkpoint(checkpoint);
  Trainer second(dataset(), options());
  ASSERT_TRUE(second.load_checkpoint(checkpoint));
  EXPECT_EQ(second.steps_done(), 137U);
  EXPECT_EQ(trained(second), expected);
}

/// As options(), of a uniaxial model with all that it learns.
TrainOptions uniaxial_options(TrainOptions options) {
  options.uniaxial.emplace();
  options.uniaxial->adjustment.width = 32;
  options.uniaxial->coarse_share = 0.3f;
  return options;
}

/// Everything that a run ends with.
std::vector<float> all_of(const Trainer& trainer) {
  std::vector<float> all = trainer.gaussians().data();
  const UniaxialParameters& uniaxial = *trainer.uniaxial();
  all.insert(all.end(), uniaxial.thresholds.begin(), uniaxial.thresholds.end());
  all.insert(all.end(), uniaxial.adjustment->weights().begin(),
             uniaxial.adjustment->weights().end());
  return all;
}

TEST_F(TrainerTest, AUniaxialModelLearnsAllItsParts) {
  const Dataset data = dataset();
  Trainer trainer(data, uniaxial_options(options()));
  const std::vector<float> weights_before = trainer.uniaxial()->adjustment
                                                ? trainer.uniaxial()->adjustment->weights()
                                                : std::vector<float>();
  EXPECT_TRUE(weights_before.empty());  // it acts later
  const auto error = [&] {              // of the uncut scene and of what is cut
    double sum = 0;
    UniaxialState state;
    for (const Frame* frame : data.split(Split::kTrain)) {
      const std::optional<Plane>& plane = frame->plane;
      if (!plane || glm::dot(plane->normal, trainer.uniaxial()->normal) > 0.9999f) {
        make_state(trainer.gaussians(), *trainer.uniaxial(),
                   plane ? std::optional(plane->offset) : std::nullopt, state);
        const Image truth = composite(data.load(*frame), 0, 0, 0);
        const Image picture = composite(
            render(state.gaussians, frame->camera, std::nullopt, ClipOperator::kExact), 0, 0, 0);
        for (size_t i = 0; i < truth.data.size(); ++i) {
          sum += std::pow(truth.data[i] - picture.data[i], 2);
        }
      }
    }
    return sum;
  };
  const double before = error();
  trained(trainer);
  EXPECT_LT(error(), 0.75 * before);
  const UniaxialParameters& learnt = *trainer.uniaxial();
  ASSERT_TRUE(learnt.adjustment);
  const std::vector<float>& weights = learnt.adjustment->weights();
  EXPECT_TRUE(
      std::ranges::any_of(weights.end() - 16 * 33, weights.end(), [](float w) { return w != 0; }));
  ASSERT_EQ(learnt.thresholds.size(), trainer.gaussians().size());
  size_t apart = 0;
  for (size_t i = 0; i < learnt.thresholds.size(); ++i) {
    const float center = glm::dot(learnt.normal, trainer.gaussians().mean(i));
    apart += std::abs(learnt.thresholds[i] - center) > 0.01f ? 1 : 0;
  }
  EXPECT_GT(apart, learnt.thresholds.size() / 20);
}

TEST_F(TrainerTest, AUniaxialModelIsTheSameAtAnyNumberOfThreadsAndAfterAResume) {
  const TrainOptions with = uniaxial_options(options());
  set_thread_count(1);
  Trainer whole(dataset(), with);
  trained(whole);
  set_thread_count(0);
  for (const size_t stop : {40U, 137U}) {  // before and after the adjustment acts
    const fs::path checkpoint = folder_ / "uniaxial-checkpoint";
    Trainer first(dataset(), with);
    for (size_t i = 0; i < stop; ++i) {
      first.step();
    }
    first.save_checkpoint(checkpoint);
    Trainer second(dataset(), with);
    ASSERT_TRUE(second.load_checkpoint(checkpoint));
    trained(second);
    EXPECT_TRUE(all_of(second) == all_of(whole));
    Trainer other(dataset(), options());
    EXPECT_THROW(other.load_checkpoint(checkpoint), Error);
    TrainOptions hard = with;
    hard.uniaxial->truncation = Truncation::kHard;
    Trainer of_hard(dataset(), hard);
    EXPECT_THROW(of_hard.load_checkpoint(checkpoint), Error);
  }
}

TEST_F(TrainerTest, RefiningImprovesASceneAndLayersFollow) {
  const Dataset data = dataset();
  TrainOptions few = options();
  few.steps = 60;
  Scene scene = train(data, few, {});
  scene.states = PlaneStates::over(scene.extent);
  scene.layers.assign(scene.gaussians.size(), 7);
  TrainOptions more = refine_options();
  more.steps = 120;
  const Scene refined = refine(scene, data, more, {});
  EXPECT_EQ(refined.gaussians.size(), scene.gaussians.size());
  const auto error = [&](const Scene& of) {
    double sum = 0;
    for (const Frame* frame : data.split(Split::kTrain)) {
      const Image truth = composite(data.load(*frame), 0, 0, 0);
      const Image picture = composite(
          render(of.gaussians, frame->camera, frame->plane, ClipOperator::kExact), 0, 0, 0);
      for (size_t i = 0; i < truth.data.size(); ++i) {
        sum += std::pow(truth.data[i] - picture.data[i], 2);
      }
    }
    return sum;
  };
  EXPECT_LT(error(refined), 0.9 * error(scene));
  for (size_t i = 0; i < refined.layers.size(); ++i) {
    EXPECT_EQ(refined.layers[i],
              refined.states.nearest_slab(glm::dot(refined.axis, refined.gaussians.mean(i))));
  }
}

TEST_F(TrainerTest, WithASectionFacesAreRightAndTheSplatsFillTheRest) {
  const Dataset data = dataset();
  const Section section =
      make_section(make_ball(32, 11, 300, -1000), load_preset("soft-tissue"), {32});
  // Where faces are seen, and over the rest of the pictures.
  const auto errors = [&](const Trainer& trainer, bool faces) {
    std::array<double, 2> sums{};
    for (const Frame* frame : data.split(Split::kTrain)) {
      const Image front = draw_faces(section, frame->camera, frame->plane);
      RasterOptions raster;
      raster.face_gain = trainer.face_gain();
      Rasterizer rasterizer;
      const Image& picture = rasterizer.forward(trainer.gaussians(), frame->camera, frame->plane,
                                                raster, faces ? &front : nullptr);
      const Image truth = composite(data.load(*frame), 0, 0, 0);
      for (size_t i = 0; i < truth.data.size(); ++i) {
        sums[front.data[i / 3 * 4 + 3] > 0.99f ? 0 : 1] +=
            std::pow(truth.data[i] - picture.data[i / 3 * 4 + i % 3], 2);
      }
    }
    return sums;
  };
  Trainer without(data, options());
  Trainer with(data, options(), &section);
  trained(without);
  trained(with);
  const auto [face, rest] = errors(with, true);
  EXPECT_LT(face, errors(without, false)[0]);
  EXPECT_LT(face, errors(with, false)[0]);
  EXPECT_LT(rest, 1.2 * errors(without, false)[1]);

  // A checkpoint of one is not taken for the other's.
  const fs::path checkpoint = folder_ / "with";
  with.save_checkpoint(checkpoint);
  EXPECT_THROW(without.load_checkpoint(checkpoint), Error);
  EXPECT_TRUE(with.load_checkpoint(checkpoint));
}

TEST_F(TrainerTest, RefusesCorruptAndForeignCheckpoints) {
  const fs::path checkpoint = folder_ / "corrupt";
  Trainer trainer(dataset(), options());
  trainer.save_checkpoint(checkpoint);
  const std::string bytes = read_text(checkpoint);
  for (const size_t length : {size_t{0}, size_t{10}, size_t{100}, bytes.size() - 1}) {
    write_text(checkpoint, std::string_view(bytes).substr(0, length));
    EXPECT_THROW(trainer.load_checkpoint(checkpoint), Error) << length;
  }
  std::string other = bytes;
  other[0] = 'X';
  write_text(checkpoint, other);
  EXPECT_THROW(trainer.load_checkpoint(checkpoint), Error);

  write_text(checkpoint, bytes);
  const auto expect_refused = [&](const Dataset& data, const TrainOptions& some, const char* says,
                                  const Scene* start = nullptr) {
    Trainer foreign(data, some, nullptr, start);
    EXPECT_THAT([&] { foreign.load_checkpoint(checkpoint); },
                testing::ThrowsMessage<Error>(testing::HasSubstr(says)));
  };
  TrainOptions changed = options();
  changed.seed = 2;
  expect_refused(dataset(), changed, "the seed");
  changed = options();
  changed.mean_rate *= 2;
  expect_refused(dataset(), changed, "the rate of means changed;");
  changed = options();
  changed.uniaxial.emplace();
  expect_refused(dataset(), changed, "the model");

  // As many pictures, of the same size.
  Dataset data = dataset();
  std::swap(data.frames[0].file, data.frames[1].file);
  expect_refused(data, options(), ": the pictures changed;");
  data = dataset();
  data.frames[2].camera.position.x += 1;
  expect_refused(data, options(), ": the pictures changed;");
  data = dataset();
  data.frames[3].plane = Plane{Vec3(0, 0, 1), 100};
  expect_refused(data, options(), ": the pictures changed;");

  // As many Gaussians to start from, one of them elsewhere.
  Scene start = scene_of(dataset());
  start.gaussians = trainer.gaussians();
  Trainer refining(dataset(), options(), nullptr, &start);
  refining.save_checkpoint(checkpoint);
  EXPECT_TRUE(refining.load_checkpoint(checkpoint));
  start.gaussians.plane(0)[5] += 1;
  expect_refused(dataset(), options(), ": the start changed;", &start);
}

}  // namespace
}  // namespace clipgs
