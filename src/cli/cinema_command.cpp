#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cinema/denoise.h"
#include "cinema/picture.h"
#include "cinema/visible_matter.h"
#include "cli/animation.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/cut_options.h"
#include "cli/look_options.h"
#include "cli/view_options.h"
#include "cli/volume_options.h"
#include "core/file.h"
#include "volume/upsample.h"

namespace clipgs {
namespace {

// Sides of the body that a floor may lie on.
const std::map<std::string, Vec3> kSides = {{"left", {-1, 0, 0}},      {"right", {1, 0, 0}},
                                            {"posterior", {0, -1, 0}}, {"anterior", {0, 1, 0}},
                                            {"inferior", {0, 0, -1}},  {"superior", {0, 0, 1}}};

struct CinemaArguments {
  std::filesystem::path volume;
  std::filesystem::path output;
  LoadOptions load;
  LookArguments look;
  ViewArguments view{"30,15"};
  CutArguments cut;
  AnimationArguments animation;
  BackdropArguments backdrop;
  std::string focus;
  std::string floor;
  PictureOptions picture;
  bool denoise = false;
  int bits = 8;
  bool json = false;
};

/// Touches what is visible, and reaches beyond the picture's edges.
Floor make_floor(const VisibleMatter& matter, const Vec3& side) {
  const Vec3& center = matter.sphere.center;
  const float distance = matter.extent(side).y - glm::dot(side, center);
  return {-side, center + distance * side, 3 * matter.sphere.radius};
}

void run_cinema(const CinemaArguments& arguments) {
  const Viewpoint viewpoint = parse_viewpoint(arguments.view);
  const Cut cut = parse_cut(arguments.cut);
  const std::optional<Background> background = parse_background(arguments.backdrop.background);
  check_picture_output(arguments.animation, arguments.output);
  require_writable(arguments.output);
  Volume volume = load_volume(arguments.volume, arguments.load);
  const Preset preset = load_look(arguments.look, volume);
  const VisibleMatter matter = visible_matter(volume, preset.transfer, preset.labels);
  warn_if_plane_misses(cut, matter.bounds);
  if (!arguments.look.as_scanned) {
    volume = upsample(std::move(volume), preset.transfer);
  }
  const CinemaScene scene(volume, preset);
  PictureOptions options = arguments.picture;
  options.features = arguments.denoise || arguments.backdrop.depth_cue > 0;
  if (!arguments.animation.any()) {
    options.progress = "cinema";
  }
  Vec3 focus = viewpoint.middle(matter.sphere);
  if (!arguments.focus.empty()) {
    focus = parse_vector(arguments.focus, "--focus");
  }
  if (!arguments.floor.empty()) {
    options.floor = make_floor(matter, kSides.at(arguments.floor));
  }
  double samples = 0;
  float noise = kNoNoise;  // of the noisiest picture
  const auto draw = [&](const View& from, const Cut& kept) {
    const Camera camera = viewpoint.camera(matter.sphere, from);
    options.lens.focus = camera.to_camera(focus).z;
    const Picture picture = render_picture(scene, camera, kept, options);
    samples += picture.samples;
    noise = std::min(noise, noise_floor(picture, preset.display(), options.floor ? 1 : 0));
    const Picture clean = arguments.denoise ? denoise(picture, preset.display()) : picture;
    Image image = display(clean.mean(), preset.display());
    const DepthCue cue =
        DepthCue::over(matter.sphere, camera.position, arguments.backdrop.depth_cue);
    if (cue.strength > 0) {
      fade(image, picture.depth(), cue);
    }
    return background ? composite(image, *background) : image;
  };
  const auto start = std::chrono::steady_clock::now();
  if (arguments.animation.any()) {
    const auto extent = [&](const Vec3& normal) { return matter.extent(normal); };
    write_animation(arguments.output, "cinema", arguments.animation, viewpoint.view, cut, extent,
                    draw);
  } else {
    write_png(arguments.output, draw(viewpoint.view, cut), arguments.bits);
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  if (arguments.json) {
    const nlohmann::ordered_json json = {{"output", arguments.output.string()},
                                         {"preset", preset.name},
                                         {"noise_db", noise},
                                         {"samples", samples},
                                         {"seconds", seconds},
                                         {"width", viewpoint.size.x},
                                         {"height", viewpoint.size.y}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}: preset {}, noise floor {:.1f} dB, {:.3g} samples in {:.1f} s\n",
               arguments.output.string(), preset.name, noise, samples, seconds);
  }
}

}  // namespace

void add_cinema_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("cinema", "Path-trace a picture of a volume, or an animation");
  command->footer(
      "Example: clipgs cinema ct.nii.gz -o cut.png --preset bone --view 30,20 --plane 0,0,-1,40\n"
      "         clipgs cinema ct.nii.gz -o cut.webp --rig rim --sweep --size 320\n"
      "         clipgs cinema ct.nii.gz -o deep.png --background studio --depth-cue 0.7");
  const auto arguments = std::make_shared<CinemaArguments>();
  add_volume_argument(*command, arguments->volume);
  command->add_option("-o,--output", arguments->output, "Picture to write (PNG; WebP if it moves)")
      ->required();
  add_look_options(*command, arguments->look);
  add_label_options(*command, arguments->look.labels, arguments->load);
  add_cut_options(*command, arguments->cut);
  add_animation_options(*command, arguments->animation);
  add_view_options(*command, arguments->view);
  command->add_option("--spp", arguments->picture.spp, "Most samples a pixel, on average")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command
      ->add_option("--noise-db", arguments->picture.noise_db,
                   "Stop when the noise floor reaches this, dB (0: use all samples)")
      ->check(CLI::Range(0.0, 90.0));
  command->add_option("--bounces", arguments->picture.max_bounces, "Most vertices of a path")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--denoise", arguments->denoise,
                    "Smooth away noise, for pictures to look at; the noise floor said is that "
                    "before");
  command
      ->add_option("--lens", arguments->picture.lens.radius,
                   "Radius of the lens, mm: what is far from the focus is blurred (0: nothing is)")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command->add_option("--focus", arguments->focus,
                      "R,A,S, mm: the point that is sharp (default: the middle of the picture)");
  command
      ->add_option("--floor", arguments->floor,
                   "A floor on this side of the body that shows only the shadow that falls on it: "
                   "inferior, posterior, left, right, anterior or superior")
      ->check(CLI::IsMember(&kSides));
  command->add_option("--seed", arguments->picture.seed, "Random seed")->capture_default_str();
  add_backdrop_options(*command, arguments->backdrop);
  command->add_option("--bits", arguments->bits, "Bits a channel")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_volume_options(*command, arguments->load);
  arguments->load.work = [&look = arguments->look](const VolumeSize& size) {
    return picture_memory(size, !look.as_scanned);
  };
  command->callback([arguments] { run_cinema(*arguments); });
}

}  // namespace clipgs
