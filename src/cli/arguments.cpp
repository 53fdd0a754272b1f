#include "cli/arguments.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/utf8.h"
#include "splat/scene.h"

namespace clipgs {

std::vector<float> parse_numbers(const std::string& text, size_t least, size_t most,
                                 const std::string& option, const Bounds& bounds) {
  std::vector<float> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  bool valid = !text.empty();
  while (valid && at <= end) {
    float value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    valid = error == std::errc() && std::isfinite(value) && (next == end || *next == ',');
    numbers.push_back(value);
    at = next + 1;
  }
  if (!valid || numbers.size() < least || numbers.size() > most) {
    throw CLI::ValidationError(option,
                               fmt::format("\"{}\" is not {} numbers separated by commas", text,
                                           least == most ? fmt::format("{}", least)
                                                         : fmt::format("{} to {}", least, most)));
  }
  for (const float number : numbers) {
    if (number < bounds.low || number > bounds.high) {
      throw CLI::ValidationError(
          option, fmt::format("{:g} does not lie in {:g}..{:g}", number, bounds.low, bounds.high));
    }
  }
  return numbers;
}

namespace {

/// What is wrong with a title, in a line, or nothing.
std::string title_problem(const std::string& title) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (title.size() > kMostTitle) {
    return fmt::format("a title of {} bytes is longer than the {} that a case holds; shorten it",
                       title.size(), kMostTitle);
  }
  if (!is_utf8(title)) {
    return "the title is not UTF-8 text; write it in a terminal of UTF-8";
  }
  if (std::ranges::any_of(title, is_control)) {
    return "the title has a line break, a tab or another control character in it; leave it out";
  }
  return "";
}

}  // namespace

void add_title_option(CLI::App& command, std::string& title, const std::string& usual) {
  command.add_option("--title", title, "Title of the case (default: " + usual + ")")
      ->check(CLI::Validator(title_problem, ""));
}

CLI::Validator ends_in(std::vector<std::string> endings) {
  const std::string list = fmt::format("{}", fmt::join(endings, " or "));
  return {[endings = std::move(endings), list](const std::string& name) {
            const auto fits = [&](const std::string& ending) {
              return name.size() > ending.size() && name.ends_with(ending);
            };
            // CLI11's checks return what is wrong; nothing if all is well.
            return std::ranges::any_of(endings, fits)
                       ? std::string()
                       : fmt::format("{}: give a name that ends in {}, as what is written", name,
                                     list);
          },
          list};
}

IVec3 parse_size(const std::string& text) {
  const auto fail = [&] {
    throw CLI::ValidationError(
        "--size", fmt::format("\"{}\" is not a size like 512x512 (16 to 8192 a side)", text));
  };
  const size_t x = text.find('x');
  const std::string parts[2] = {text.substr(0, x),
                                x == std::string::npos ? text : text.substr(x + 1)};
  IVec3 size(0);
  for (int i = 0; i < 2; ++i) {
    const char* end = parts[i].data() + parts[i].size();
    const auto [next, error] = std::from_chars(parts[i].data(), end, size[i]);
    if (error != std::errc() || next != end || size[i] < 16 || size[i] > 8192) {
      fail();
    }
  }
  return size;
}

Vec3 parse_vector(const std::string& text, const std::string& option) {
  const std::vector<float> n = parse_numbers(text, 3, 3, option);
  return {n[0], n[1], n[2]};
}

View parse_view(const std::string& text) {
  const std::vector<float> n = parse_numbers(text, 2, 3, "--view");
  View view{n[0], n[1], n.size() > 2 ? n[2] : 1.0f};
  if (!(view.zoom >= 0.01f && view.zoom <= 1000)) {
    throw CLI::ValidationError("--view", "the zoom must lie in 0.01..1000");
  }
  return view;
}

GradientOpacity parse_gradient_opacity(const std::string& text) {
  const std::vector<float> n = parse_numbers(text, 2, 3, "--gradient-opacity");
  const GradientOpacity result{n[0], n[1], n.size() > 2 ? n[2] : 0.0f};
  if (!result.valid()) {
    throw CLI::ValidationError("--gradient-opacity",
                               "FROM must be at least 0 and below TO, FLOOR 0 to 1");
  }
  return result;
}

namespace {

/// "#rrggbb" or a name.
Background parse_backdrop(const std::string& text) {
  if (const std::optional<Background> named = find_background(text)) {
    return *named;
  }
  unsigned rgb = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != 7 || text[0] != '#' ||
      std::from_chars(text.data() + 1, end, rgb, 16).ptr != end) {
    throw CLI::ValidationError(
        "--background", fmt::format("\"{}\" is no colour; give r,g,b in 0..1, #rrggbb or one of {}",
                                    text, fmt::join(background_names(), ", ")));
  }
  const Vec3 color = Vec3(rgb >> 16U, rgb >> 8U & 255U, rgb & 255U) / 255.0f;
  return {color, color};
}

}  // namespace

std::optional<Background> parse_background(const std::string& text) {
  if (text.empty()) {
    return std::nullopt;
  }
  if (text.find_first_not_of("+-.,0123456789eE") == std::string::npos) {
    const std::vector<float> n = parse_numbers(text, 3, 3, "--background", {0, 1});
    const Vec3 color(n[0], n[1], n[2]);
    return Background{color, color};
  }
  const size_t comma = text.find(',');
  const Background first = parse_backdrop(text.substr(0, comma));
  return comma == std::string::npos
             ? first
             : Background{first.top, parse_backdrop(text.substr(comma + 1)).bottom};
}

void add_backdrop_options(CLI::App& command, BackdropArguments& arguments) {
  command.add_option("--background", arguments.background,
                     "Behind the picture: r,g,b in 0..1 (sRGB), #rrggbb, black, white, studio or "
                     "paper, or two of these but numbers from top to bottom, as #202830,black; "
                     "transparent if not given");
  command
      .add_option("--depth-cue", arguments.depth_cue,
                  "How much what is farther away fades towards the background, from 0 (not at all) "
                  "to 1 (wholly at the far end)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

namespace {

/// The plane of the first four numbers.
Plane plane_of(const std::vector<float>& n, const std::string& option) {
  const Vec3 normal(n[0], n[1], n[2]);
  const float length = glm::length(normal);
  if (!(length > 0)) {
    throw CLI::ValidationError(option, "the normal must not be 0,0,0");
  }
  return {normal / length, n[3] / length};
}

}  // namespace

Cut parse_cut(const CutArguments& arguments) {
  std::vector<Plane> result;
  result.reserve(arguments.planes.size() + 2 * arguments.slabs.size());
  for (const std::string& text : arguments.planes) {
    result.push_back(plane_of(parse_numbers(text, 4, 4, "--plane"), "--plane"));
  }
  for (const std::string& text : arguments.slabs) {
    const std::vector<float> n = parse_numbers(text, 5, 5, "--slab");
    const Plane near = plane_of(n, "--slab");
    if (!(n[4] > 0)) {
      throw CLI::ValidationError("--slab", "the thickness must be greater than 0");
    }
    result.push_back(near);
    result.push_back({-near.normal, -(near.offset + n[4])});
  }
  return Cut(result);
}

Window parse_window(const std::string& text, const Section& section) {
  const std::vector<NamedWindow> known = windows_of(section);
  if (text.empty()) {
    return known.empty() ? Window() : known.front().window;
  }
  const auto named = std::ranges::find(known, text, &NamedWindow::name);
  if (named != known.end()) {
    return named->window;
  }
  if (text.find_first_not_of("+-.,0123456789eE") != std::string::npos) {
    std::string names;
    for (const NamedWindow& one : known) {
      names += fmt::format("{}, ", one.name);
    }
    throw Error("--window {}: no window of a case of {}; give {}CENTER,WIDTH", text,
                modality_name(section.modality), names);
  }
  const std::vector<float> n = parse_numbers(text, 2, 2, "--window");
  if (!(n[1] > 0)) {
    throw CLI::ValidationError("--window", "the width must be greater than 0");
  }
  return {n[0], n[1]};
}

void warn_if_plane_misses(const Cut& cut, const Box& bounds) {
  if (bounds.empty()) {
    return;
  }
  for (const Plane& plane : cut.planes()) {
    const Vec2 extent = project_box(bounds, plane.normal);
    if (plane.offset <= extent.x || plane.offset >= extent.y) {
      warn(
          fmt::format("the plane misses what is visible, which spans {:.1f} to {:.1f} mm along its "
                      "normal: {} is cut away",
                      extent.x, extent.y, plane.offset <= extent.x ? "nothing" : "everything"));
    }
  }
}

}  // namespace clipgs
