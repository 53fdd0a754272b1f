#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cinema/denoise.h"
#include "cinema/picture.h"
#include "cinema/visible_matter.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/looks_sheet.h"
#include "cli/sheet.h"
#include "cli/shell_word.h"
#include "cli/volume_options.h"
#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"
#include "volume/identify.h"
#include "volume/load.h"
#include "volume/preset.h"
#include "volume/suitable_presets.h"

namespace clipgs {
namespace {

struct LooksArguments {
  std::filesystem::path volume;
  std::string output;
  LoadOptions load;
  std::vector<std::string> given;  ///< options of the volume, as they were written
  std::string view = "30,15";
  int size = 256;  ///< px, side of a picture
  PictureOptions picture;
  bool json = false;
};

/// Takes off the half that is nearer to the camera, across that of the patient's axes that the
/// camera looks along most: the cut face is seen.
Plane facing_cut(const VisibleMatter& matter, const View& view) {
  const Vec3 direction = view_direction(view.azimuth_deg, view.elevation_deg);
  int axis = 0;
  for (const int other : {1, 2}) {
    axis = std::abs(direction[other]) > std::abs(direction[axis]) ? other : axis;
  }
  Vec3 normal(0);
  normal[axis] = direction[axis] > 0 ? -1.0f : 1.0f;
  return {normal, glm::dot(normal, matter.bounds.center())};
}

/// From there at what is visible, as large as a square picture holds it: closer than at its sphere.
Camera tight_camera(const VisibleMatter& matter, const View& view, int size) {
  Camera camera = frame_sphere(matter.sphere, view, size, size);
  Vec2 low(std::numeric_limits<float>::max());
  Vec2 high(std::numeric_limits<float>::lowest());
  for (const Vec3& point : matter.hull) {
    const Vec3 seen = camera.to_camera(point);
    const Vec2 place = Vec2(seen) / seen.z;
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const Vec2 extent = high - low;
  const Vec2 middle = 0.5f * (low + high);
  const auto side = static_cast<float>(size);
  camera.fx = camera.fy = view.zoom * kFrameFill * side / std::max({extent.x, extent.y, 1e-6f});
  camera.cx = 0.5f * side - camera.fx * middle.x;
  camera.cy = 0.5f * side - camera.fy * middle.y;
  return camera;
}

Image draw_look(const CinemaScene& scene, const Camera& camera, const Cut& cut,
                const PictureOptions& options) {
  const DisplayTransform transform = scene.preset().display();
  const Picture picture = denoise(render_picture(scene, camera, cut, options), transform);
  const auto& [r, g, b] = kTileBackground;
  return composite(display(picture.mean(), transform), r, g, b);
}

/// With a veil as thin as glass made solid: cameras would frame what it veils alone, and its edge
/// would be cut off.
TransferFunction without_veils(const TransferFunction& transfer) {
  std::vector<TransferPoint> points = transfer.points();
  for (TransferPoint& point : points) {
    float& extinction = point.material.extinction;
    extinction = extinction > 0 ? std::max(extinction, 1.0f) : 0;
  }
  return TransferFunction(std::move(points));
}

/// Nothing, with a warning, where only specks are visible.
std::optional<VisibleMatter> matter_of(const Volume& volume, const Preset& preset) {
  try {
    return visible_matter(volume, without_veils(preset.transfer));
  } catch (const Error&) {
    warn(fmt::format("preset {} shows nothing of the volume but specks; it is left out",
                     preset.name));
    return std::nullopt;
  }
}

std::vector<Look> draw_looks(const LooksArguments& arguments, const Volume& volume,
                             const Identity& identity) {
  const View view = parse_view(arguments.view);
  const std::vector<std::string> names = suitable_presets(volume, identity);
  std::vector<Look> looks;
  Progress progress("looks", names.size());
  for (size_t i = 0; i < names.size(); ++i) {
    const Preset preset = load_preset(names[i], volume);
    if (const std::optional<VisibleMatter> matter = matter_of(volume, preset)) {
      // The voxels as scanned: finer ones (upsample()) would take longer than all the rest, and
      // pictures so small hardly show them.
      const CinemaScene scene(volume, preset);
      const Camera camera = tight_camera(*matter, view, arguments.size);
      looks.push_back({preset, preset.name == identity.preset,
                       draw_look(scene, camera, {}, arguments.picture),
                       draw_look(scene, camera, facing_cut(*matter, view), arguments.picture)});
    }
    progress.update(i + 1, names[i]);
  }
  if (looks.empty()) {
    throw Error(
        "{}: no preset shows more of it than specks; check the values with 'clipgs info' (8-bit "
        "data may need --hu scale,offset)",
        arguments.volume.string());
  }
  return looks;
}

/// The command that draws, or builds, the volume with that look, or several.
std::string command_line(const std::string& command, const std::string& output,
                         const LooksArguments& arguments, const std::string& preset) {
  std::string line = fmt::format("clipgs {} {} -o {} --preset {}", command,
                                 shell_word(arguments.volume.string()), output, preset);
  for (const std::string& option : arguments.given) {
    line += ' ' + shell_word(option);
  }
  return line;
}

/// Faces that are drawn from the volume's data know nothing of gradient opacity.
bool has_section(const Preset& preset) { return !preset.gradient_opacity; }

std::string build_line(const LooksArguments& arguments, const Preset& preset) {
  return command_line("build", "case.sog", arguments, preset.name) +
         (has_section(preset) ? "" : " --no-section");
}

/// Builds a case of each look that has a section, which the viewer shows as looks of one volume;
/// nothing where these are not several.
std::optional<std::string> build_all_line(const LooksArguments& arguments,
                                          const std::vector<Look>& looks) {
  std::vector<std::string> names;
  for (const Look& look : looks) {
    if (has_section(look.preset)) {
      names.push_back(look.preset.name);
    }
  }
  if (names.size() < 2) {
    return std::nullopt;
  }
  return command_line("build", "case.sog", arguments, fmt::format("{}", fmt::join(names, ",")));
}

std::string cinema_line(const LooksArguments& arguments, const Preset& preset) {
  return command_line("cinema", preset.name + ".png", arguments, preset.name);
}

void print_looks(const LooksArguments& arguments, const Identity& identity,
                 const std::vector<Look>& looks, double seconds) {
  const std::optional<std::string> build_all = build_all_line(arguments, looks);
  if (!arguments.json) {
    fmt::print("{}: {}, looks for it in {:.1f} s\n", arguments.output, identity.what, seconds);
    for (const Look& look : looks) {
      fmt::print("  {:<14} {}\n", look.preset.name, build_line(arguments, look.preset));
    }
    if (build_all) {
      fmt::print("a case of each, between which the viewer changes:\n  {}\n", *build_all);
    }
    return;
  }
  nlohmann::ordered_json json = {{"output", arguments.output},
                                 {"looks_like", identity.what},
                                 {"because", identity.reason},
                                 {"auto_preset", identity.preset},
                                 {"seconds", seconds}};
  if (build_all) {
    json["build_all"] = *build_all;
  }
  for (const Look& look : looks) {
    json["looks"].push_back({{"preset", look.preset.name},
                             {"title", look.preset.title},
                             {"description", look.preset.description},
                             {"cinema", cinema_line(arguments, look.preset)},
                             {"build", build_line(arguments, look.preset)}});
  }
  fmt::print("{}\n", json.dump(2));
}

void run_looks(const LooksArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  parse_view(arguments.view);  // before the volume is read
  require_writable(arguments.output);
  const Volume volume = load_volume(arguments.volume, arguments.load);
  const Identity identity = identify(volume);
  const std::vector<Look> looks = draw_looks(arguments, volume, identity);
  write_sheet(arguments.output,
              draw_looks_sheet(looks, fmt::format("Looks of this volume: {}", identity.what)));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print_looks(arguments, identity, looks, seconds);
}

}  // namespace

void add_looks_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "looks", "Draw every preset that suits a volume, small, on one sheet to choose from");
  command->footer(
      "Example: clipgs looks ct.nii.gz -o looks.webp\n"
      "         clipgs looks head.nrrd -o looks.png --hu 16,-1024 --view 150,10 --json");
  const auto arguments = std::make_shared<LooksArguments>();
  add_volume_argument(*command, arguments->volume);
  command->add_option("-o,--output", arguments->output, "Sheet to write (.webp or .png)")
      ->required()
      ->check(ends_in({".webp", ".png"}));
  command
      ->add_option("--view", arguments->view,
                   "Camera: azimuth,elevation[,zoom] in degrees; the cut faces it")
      ->capture_default_str();
  command->add_option("--size", arguments->size, "Side of a picture, px; each look has two")
      ->check(CLI::Range(64, 1024))
      ->capture_default_str();
  arguments->picture.spp = 32;
  arguments->picture.features = true;
  command->add_option("--spp", arguments->picture.spp, "Most samples a pixel, on average")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command->add_option("--seed", arguments->picture.seed, "Random seed")->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the looks and their commands as JSON");
  add_volume_options(*command, arguments->load);
  arguments->load.work = [](const VolumeSize& size) { return picture_memory(size, false); };
  command->callback([arguments, command] {
    arguments->given = given_volume_options(*command);
    run_looks(*arguments);
  });
}

}  // namespace clipgs
