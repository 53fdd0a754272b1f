#include "pipeline/instant_case.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "pipeline/case_step.h"

#include "cinema/dataset_claim.h"
#include "cinema/picture.h"
#include "cinema/seed_points.h"
#include "cinema/traced_volume.h"
#include "cinema/visible_matter.h"
#include "section/surface_splats.h"
#include "splat/render.h"
#include "train/seeding.h"

namespace clipgs {

namespace {

// As many as a headset draws without a thought.
constexpr size_t kSplats = 40000;
// Finer ones are not seen before a case is trained, and take longer to make and to load.
constexpr int kSectionSize = 288;

// More are drawn as they are: finer ones take longer than all the rest.
constexpr size_t kFewVoxels = 6'000'000;

// Of the matter what may be translucent: coding adds a little, and who opens a case must find, too,
// that its walls are drawn.
constexpr float kSurelyOpaque = 0.27f;

/// Gaussians all through the matter, as opaque as they are thick.
Gaussians volume_splats(const Volume& volume, const Preset& preset) {
  constexpr std::uint64_t kSeed = 1;
  constexpr float kMostOpaque = 0.95f;
  Gaussians splats =
      start_from_points(sample_seed_points(volume, preset, kSplats, kSeed), kSplats, 0, kSeed);
  for (size_t i = 0; i < splats.size(); ++i) {
    const float extinction = preset.transfer.at(volume.sample(splats.mean(i))).extinction;
    // ∫ along a line through the middle of a Gaussian of that extinction.
    const float depth = std::sqrt(2 * kPi) * extinction * splats.scale(i).x;
    const float opacity = std::clamp(1 - std::exp(-depth), 0.01f, kMostOpaque);
    splats.plane(Gaussians::kOpacity)[i] = std::log(opacity / (1 - opacity));
  }
  return splats;
}

/// Sums of what pixels show, linear premultiplied RGB.
Vec3 light_of(const Image& straight, ToneCurve tone) {
  Vec3 sum(0);
  for (size_t i = 0; i < straight.pixels(); ++i) {
    const float* const p = &straight.data[4 * i];
    sum += p[3] * Vec3(linear_from_display(p[0], tone), linear_from_display(p[1], tone),
                       linear_from_display(p[2], tone));
  }
  return sum;
}

/// Makes the Gaussians as bright, all in all, as a traced picture is: light that goes deep into
/// matter loses more than what is placed in it can know.
void match_light(Gaussians& splats, const CinemaScene& scene, const Sphere& sphere) {
  constexpr int kSide = 128;  // px
  constexpr int kRounds = 3;  // the display's curve bends
  const Camera camera = frame_sphere(sphere, View{30, 10, 1}, kSide, kSide);
  const ToneCurve tone = scene.preset().tone;
  PictureOptions options;
  options.spp = 16;
  const Vec3 wanted = light_of(
      display(render_picture(scene, camera, Cut(), options).mean(), scene.preset().display()),
      tone);
  for (int round = 0; round < kRounds; ++round) {
    const Vec3 seen = light_of(render(splats, camera, Cut(), ClipOperator::kExact), tone);
    for (int c = 0; c < 3; ++c) {
      const float gain = wanted[c] / std::max(seen[c], 1e-6f);
      float* const coefficients = splats.plane(Gaussians::kSh + c);
      for (size_t i = 0; i < splats.size(); ++i) {
        const float color = 0.5f + kShBand0 * coefficients[i];
        const float changed = display_from_linear(gain * linear_from_display(color, tone), tone);
        coefficients[i] = (changed - 0.5f) / kShBand0;
      }
    }
  }
}

Scene scene_of(const Volume& volume, const Preset& preset) {
  const VisibleMatter matter = visible_matter(volume, preset.transfer, preset.labels);
  Scene scene;
  scene.trained = 0;
  scene.sphere = matter.sphere;
  scene.bounds = matter.bounds;
  scene.extent = matter.extent(scene.axis);
  scene.preset = preset.name;
  scene.look = look_of(claims_of(volume, preset, {}), volume, preset);
  return scene;
}

/// The case of a section: discs on its surfaces, if these can be drawn.
bool place_splats(Case& contents) {
  const Section& section = *contents.section;
  const SurfaceScan scan = scan_surfaces(section);
  const auto openings = std::make_shared<const Openings>(section, scan);
  if (!openings->drawn() || scan.translucent >= kSurelyOpaque) {
    return false;
  }
  contents.scene.gaussians = surface_splats(section, scan, *openings, kSplats);
  contents.scene.placed = true;
  contents.openings = openings;
  return true;
}

}  // namespace

CaseCoding quick_coding(const CaseCoding& asked) {
  constexpr float kQuality = 85;
  CaseCoding coding = asked;
  coding.section_quality = asked.section_quality.value_or(kQuality);
  coding.saving = Saving::kTime;
  return coding;
}

std::optional<Case> make_placed_case(const Volume& volume, const Preset& preset, Section section,
                                     const std::string& title) {
  Case contents(scene_of(volume, preset));
  name_case(contents, title);
  contents.section = std::move(section);
  return place_splats(contents) ? std::optional(std::move(contents)) : std::nullopt;
}

Case make_instant_case(const Volume& volume, const Preset& preset, const InstantOptions& options) {
  require_look_for_section(preset, options.section);
  Case contents(scene_of(volume, preset));
  name_case(contents, options.title);
  if (!options.section.none) {
    TracedVolume traced(volume, preset, options.upsample && volume.voxels() <= kFewVoxels);
    contents.section.emplace(make_section(traced.traced(), volume, preset,
                                          {std::min(options.section.size, kSectionSize)}));
    if (place_splats(contents)) {
      return contents;
    }
  }
  contents.scene.gaussians = volume_splats(volume, preset);
  match_light(contents.scene.gaussians, CinemaScene(volume, preset), contents.scene.sphere);
  return contents;
}

void build_instant_case(const Volume& volume, const Preset& preset, const InstantOptions& options,
                        const std::filesystem::path& output) {
  write_finished_case(output, make_instant_case(volume, preset, options),
                      quick_coding(options.section.coding));
}

}  // namespace clipgs
