#pragma once

#include <charconv>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cinema/picture.h"
#include "cinema/scene.h"
#include "cinema/visible_matter.h"
#include "core/camera.h"
#include "core/cut.h"
#include "core/error.h"
#include "volume/load.h"

// What the benches of this folder draw.
namespace clipgs::bench {

/// A volume with its look, one view of it and a cut.
struct Subject {
  Volume volume;
  Preset preset;
  VisibleMatter matter;
  CinemaScene scene;
  Camera camera;
  Cut cut;

  Subject(Volume v, const std::string& preset_name, const Cut& kept, int size)
      : volume(std::move(v)),
        preset(load_preset(preset_name, volume)),
        matter(visible_matter(volume, preset.transfer)),
        scene(volume, preset),
        camera(frame_sphere(matter.sphere, View{30, 15, 1}, size, size)),
        cut(kept) {}

  /// For tables.
  std::string name() const { return preset.name + (cut.planes().empty() ? "" : ", cut"); }
};

inline std::vector<float> numbers(std::string_view text) {
  std::vector<float> result;
  while (!text.empty()) {
    float value = 0;
    const char* const end = std::from_chars(text.data(), text.data() + text.size(), value).ptr;
    text.remove_prefix(std::min(text.size(), static_cast<size_t>(end - text.data()) + 1));
    result.push_back(value);
  }
  return result;
}

/// From a command line: VOLUME PRESET [SCALE,OFFSET|-] [NX,NY,NZ,OFFSET].
inline Subject subject_of(std::span<char*> arguments, int size) {
  if (arguments.size() < 3) {
    throw Error("usage: VOLUME PRESET [SCALE,OFFSET|-] [NX,NY,NZ,OFFSET]");
  }
  LoadOptions load;
  if (arguments.size() > 3 && std::string_view(arguments[3]) != "-") {
    const std::vector<float> hu = numbers(arguments[3]);
    load.hu = Rescale{hu.at(0), hu.at(1)};
  }
  Cut cut;
  if (arguments.size() > 4) {
    const std::vector<float> n = numbers(arguments[4]);
    cut = Cut(Plane{glm::normalize(Vec3(n.at(0), n.at(1), n.at(2))), n.at(3)});
  }
  return {load_volume(arguments[1], load), arguments[2], cut, size};
}

constexpr int kBounces = 4;

/// As displayed, over black.
inline Image shown(const Image& premultiplied, const Subject& s) {
  return composite(display(premultiplied, s.preset.display()), 0, 0, 0);
}

struct Truth {
  Image shown;   // over black
  double error;  // its own mean squared error: independent of the others', it is taken off
};

/// A picture whose noise floor is this high, dB.
inline Truth converged(const Subject& s, float noise_db) {
  PictureOptions options;
  options.spp = 1 << 14;
  options.noise_db = noise_db;
  options.max_bounces = kBounces;
  options.seed = 99;
  const Picture picture = render_picture(s.scene, s.camera, s.cut, options);
  return {shown(picture.mean(), s),
          std::pow(10.0, -0.1 * noise_floor(picture, s.preset.display()))};
}

/// The whole of a bench's main().
inline int run_bench(const char* name, int count, char** arguments,
                     void (*run)(std::span<char*> arguments)) {
  try {
    run({arguments, static_cast<size_t>(count)});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return 1;
  }
  return 0;
}

}  // namespace clipgs::bench
