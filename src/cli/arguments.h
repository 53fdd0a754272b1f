#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/background.h"
#include "core/camera.h"
#include "core/cut.h"
#include "section/faces.h"
#include "section/windows.h"
#include "volume/gradient_opacity.h"

namespace clipgs {

// Values that several commands take. Each parser throws CLI::ValidationError, which is bad usage.

/// "512x384" (or "512": a square), both sides 16…8192.
IVec3 parse_size(const std::string& text);  // x, y; z is 0

/// "R,A,S" of an option: a point, mm, or a direction.
Vec3 parse_vector(const std::string& text, const std::string& option);

/// "azimuth,elevation[,zoom]" in degrees.
View parse_view(const std::string& text);

/// "from,to[,floor]" of --gradient-opacity, volume's units per mm.
GradientOpacity parse_gradient_opacity(const std::string& text);

/// --background and --depth-cue, of commands that draw one picture.
struct BackdropArguments {
  std::string background;  ///< empty: transparent
  float depth_cue = 0;
};

/// Adds the options; `arguments` must outlive the parsing.
void add_backdrop_options(CLI::App& command, BackdropArguments& arguments);

/// "r,g,b" in 0…1, "#rrggbb", a background's name, or two of the latter with a comma between:
/// from the upper edge to the lower. Nothing: transparent.
std::optional<Background> parse_background(const std::string& text);

/// --plane and --slab, as often as they were given.
struct CutArguments {
  std::vector<std::string> planes;  ///< "nx,ny,nz,c" keeps n·x ≥ c, RAS mm
  std::vector<std::string> slabs;   ///< "nx,ny,nz,c,thickness" keeps c ≤ n·x ≤ c + thickness
};

/// What all of them keep; n is normalised, c scaled alike, a thickness is mm.
Cut parse_cut(const CutArguments& arguments);

/// Grey values shown from black to white: "center,width", or the name of a window that such
/// sections are usually seen through (windows_of()); empty: the first of those. Throws Error that
/// lists the names for another.
Window parse_window(const std::string& text, const Section& section);

/// Adds --title, which must be text that fits into a case; `usual` says what is taken without it.
/// `title` must outlive the parsing.
void add_title_option(CLI::App& command, std::string& title, const std::string& usual);

/// Checks that a file's name ends in one of these: what a command writes does not depend on the
/// name, so a name that promises something else is refused.
CLI::Validator ends_in(std::vector<std::string> endings);

/// What numbers may be, both ends included.
struct Bounds {
  float low = -1e9f;
  float high = 1e9f;
};

/// "a,b,c…": `least` to `most` numbers within `bounds`; `option` names the flag in the error.
std::vector<float> parse_numbers(const std::string& text, size_t least, size_t most,
                                 const std::string& option, const Bounds& bounds = {});

/// Warns if a plane misses the box: nothing is cut, or everything.
void warn_if_plane_misses(const Cut& cut, const Box& bounds);

}  // namespace clipgs
