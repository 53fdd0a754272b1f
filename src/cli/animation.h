#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "core/camera.h"
#include "core/cut.h"
#include "core/image.h"

namespace clipgs {

/// --turntable, --sweep, --frames and --fps.
struct AnimationArguments {
  bool turntable = false;  ///< the camera goes once around the patient
  bool sweep = false;      ///< the first plane or slab goes through what is visible, and back
  int frames = 48;
  float fps = 16;

  bool any() const { return turntable || sweep; }
};

/// Adds the options; `animation` must outlive the parsing.
void add_animation_options(CLI::App& command, AnimationArguments& animation);

/// Throws CLI::ValidationError unless `output` is a .webp where something is to move, a .png else.
void check_picture_output(const AnimationArguments& animation, const std::filesystem::path& output);

/// Draws every picture by draw(view, cut), starting from `view` and `cut`, and writes them as a
/// WebP that goes on for ever. `extent` is the interval of normal·x over what is visible. Without a
/// plane, a sweep removes what is superior. Throws Error.
void write_animation(const std::filesystem::path& output, const std::string& label,
                     const AnimationArguments& animation, const View& view, const Cut& cut,
                     const std::function<Vec2(const Vec3&)>& extent,
                     const std::function<Image(const View&, const Cut&)>& draw);

}  // namespace clipgs
