#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "cli/arguments.h"
#include "core/camera.h"
#include "core/camera_file.h"

namespace clipgs {

/// --view, --look-at, --size and --camera, which every command that draws a picture understands.
struct ViewArguments {
  explicit ViewArguments(const char* default_view) : view(default_view) {}

  std::string view;
  std::string look_at;  ///< empty: the middle of what is visible
  std::string camera;   ///< a file; empty: --view
  std::string size = "512x512";
};

/// Adds the options; `arguments` must outlive the parsing. Call after add_animation_options: a
/// turntable has a camera of its own.
inline void add_view_options(CLI::App& command, ViewArguments& arguments) {
  CLI::Option* const view =
      command.add_option("--view", arguments.view, "Camera: azimuth,elevation[,zoom] in degrees")
          ->capture_default_str();
  CLI::Option* const look_at = command.add_option(
      "--look-at", arguments.look_at,
      "R,A,S, mm: the point in the middle of the picture (default: the middle of what is visible)");
  CLI::Option* const size =
      command.add_option("--size", arguments.size, "Width x height in pixels")
          ->capture_default_str();
  command
      .add_option("--camera", arguments.camera,
                  "JSON file of any other camera, with the keys of a frame of a dataset's "
                  "transforms.json: w, h, fl_x, fl_y, cx, cy and transform_matrix")
      ->excludes(view)
      ->excludes(look_at)
      ->excludes(size)
      ->excludes("--turntable");
}

/// Where a picture is seen from.
struct Viewpoint {
  View view;
  std::optional<Vec3> look_at;   // RAS mm
  IVec3 size;                    // px
  std::optional<Camera> placed;  // instead of all of them

  /// The middle of the picture, RAS mm, of what is visible.
  Vec3 middle(const Sphere& visible) const { return look_at.value_or(visible.center); }
  /// From `from`, which is the view or what an animation makes of it, at all that is visible.
  Camera camera(const Sphere& visible, const View& from) const {
    return placed ? *placed : frame_sphere({middle(visible), visible.radius}, from, size.x, size.y);
  }
};

/// Throws CLI::ValidationError, and Error if the camera's file is none.
inline Viewpoint parse_viewpoint(const ViewArguments& arguments) {
  Viewpoint result{parse_view(arguments.view), std::nullopt, parse_size(arguments.size),
                   std::nullopt};
  if (!arguments.look_at.empty()) {
    result.look_at = parse_vector(arguments.look_at, "--look-at");
  }
  if (!arguments.camera.empty()) {
    result.placed = read_camera(arguments.camera);
    result.size = {result.placed->width, result.placed->height, 0};
  }
  return result;
}

}  // namespace clipgs
