#include "pipeline/build_needs.h"

#include <algorithm>

#include "pipeline/build_clock.h"

#include "cinema/scene.h"
#include "section/section.h"
#include "volume/upsample.h"

namespace clipgs {

namespace {

// The program itself, its threads and what a step holds of everything: bytes.
constexpr std::uint64_t kProgram = 96'000'000;
// Of a Gaussian while it is learnt: parameters, gradients and Adam's two moments.
constexpr std::uint64_t kPerGaussian = 800;
// Of a pixel of training pictures, its face included.
constexpr std::uint64_t kPerPixel = 8;
// Of a voxel of the section: while faces are drawn, and while its image is coded beside what coding
// takes of any.
constexpr std::uint64_t kPerVoxelDrawn = 6;
constexpr std::uint64_t kPerVoxelCoded = 8;
constexpr std::uint64_t kCoding = 256'000'000;

// Seconds on two cores of an AMD EPYC, of phantoms of 96 and 256 voxels and of a head.
constexpr double kBegin = 5;
constexpr double kPerVoxelPrepared = 0.3e-6;
constexpr double kTestPicture = 10;  // as many training pictures cost the same
constexpr double kPerVoxelPacked = 0.8e-6;
constexpr double kPerPixelMeasured = 30e-6;

std::uint64_t memory_of_pictures(const VolumeSize& size, const SectionChoice& section,
                                 bool upsample) {
  return kProgram +
         std::max(size.loading(), size.loaded() + dataset_memory(size, section, upsample));
}

std::uint64_t section_voxels(const VolumeSize& size, const SectionChoice& section) {
  return section.none || size.labels ? 0 : held_section_memory(size, {section.size});
}

double seconds_of_preparing(const VolumeSize& size, bool upsample) {
  const VolumeSize fine = upsample ? most_upsampled(size) : size;
  return kBegin + kPerVoxelPrepared * static_cast<double>(fine.voxels());
}

std::uint64_t memory_of_packing(std::uint64_t section) {
  return kProgram + kCoding + kPerVoxelCoded * section;
}

double seconds_of_packing(std::uint64_t section) {
  return kBegin + kPerVoxelPacked * static_cast<double>(section);
}

}  // namespace

std::vector<StepNeeds> build_needs(const VolumeSize& size, const BuildOptions& options) {
  const DatasetOptions& pictures = options.pictures;
  const auto pixels = static_cast<std::uint64_t>(pictures.size) * pictures.size;
  const std::uint64_t frames = pictures.train_frames;
  const std::uint64_t section = section_voxels(size, options.section);
  const ExpectedSeconds expected = expected_seconds(options);

  const double tests = 2 * pictures.test_frames + pictures.uncut_frames + pictures.close_frames;
  const double test_size = pictures.test_size > 0 ? pictures.test_size : pictures.size;
  const double of_tests = 1.5 * tests * kTestPicture * expected.dataset /  // half to validate by
                          static_cast<double>(frames) * test_size * test_size /
                          static_cast<double>(pixels);
  const std::uint64_t learning = kProgram + kPerPixel * pixels * frames +
                                 kPerGaussian * options.training.budget + kPerVoxelDrawn * section;

  std::vector<StepNeeds> steps = {
      {"dataset", memory_of_pictures(size, options.section, pictures.upsample),
       seconds_of_preparing(size, pictures.upsample) + expected.dataset + of_tests},
      {"train", learning, kBegin + expected.loading + expected.training}};
  if (options.papers_way) {
    steps.push_back({"refine", learning, kBegin + expected.loading + expected.refining});
  }
  steps.push_back({"pack", memory_of_packing(section), seconds_of_packing(section)});
  steps.push_back({"eval", kProgram + kPerVoxelDrawn * section,
                   kBegin + kPerPixelMeasured * tests * test_size * test_size});
  return steps;
}

std::vector<StepNeeds> instant_needs(const VolumeSize& size, const SectionChoice& section,
                                     bool upsample) {
  const std::uint64_t voxels = section_voxels(size, section);
  return {{"build",
           std::max(memory_of_pictures(size, section, upsample), memory_of_packing(voxels)),
           seconds_of_preparing(size, upsample) + seconds_of_packing(voxels)}};
}

}  // namespace clipgs
