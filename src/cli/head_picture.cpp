#include "cli/head_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "cli/sheet.h"
#include "core/draw_text.h"
#include "core/parallel.h"
#include "volume/crop.h"
#include "volume/matter.h"

namespace clipgs {
namespace {

constexpr float kPixel = 0.8f;  // mm
constexpr float kStep = 1;      // mm along a ray
constexpr float kCrown = 150;   // mm that the head's width is measured in
constexpr float kHeight = 260;  // mm
constexpr float kAround = 10;   // mm
constexpr int kHeading = 40;    // px
constexpr int kBetween = 12;    // px
constexpr float kSheet[] = {0.05f, 0.055f, 0.07f};
constexpr float kNothing[] = {0.10f, 0.11f, 0.14f};

/// Looks along `forward` at all of a box.
struct Sight {
  Vec3 forward;
  Vec3 right;   // of the picture
  Vec3 corner;  // where its top left pixel looks from
  float depth;  // mm
  int width, height;

  Sight(const Box& box, const Vec3& direction) : forward(direction) {
    const Vec3 up(0, 0, 1);
    right = glm::cross(forward, up);
    const Vec3 size = box.size();
    depth = glm::dot(size, glm::abs(forward));
    const float across = glm::dot(size, glm::abs(right));
    corner = box.center() - 0.5f * (depth * forward + across * right - size.z * up);
    width = std::max(static_cast<int>(across / kPixel), 1);
    height = std::max(static_cast<int>(size.z / kPixel), 1);
  }
  Vec3 start(int x, int y) const {
    return corner +
           kPixel * (static_cast<float>(x) * right - static_cast<float>(y) * Vec3(0, 0, 1));
  }
};

/// mm along the ray to where it meets two steps of matter; infinity if it does not.
float depth_of(const Volume& volume, float least, const Vec3& start, const Sight& sight) {
  const auto is_matter = [&](float depth) {
    const Vec3 place = start + depth * sight.forward;
    const Vec3 index = volume.index_from_world(place);
    return glm::all(glm::greaterThanEqual(index, Vec3(0))) &&
           glm::all(glm::lessThanEqual(index, Vec3(volume.dims - 1))) &&
           volume.sample(place) > least;
  };
  bool before = false;
  const auto steps = static_cast<int>(sight.depth / kStep);
  for (int step = 0; step <= steps; ++step) {
    const float depth = static_cast<float>(step) * kStep;
    const bool here = is_matter(depth);
    if (here && before) {
      float out = depth - 2 * kStep;
      float in = depth - kStep;
      for (int halving = 0; halving < 5; ++halving) {
        const float middle = 0.5f * (out + in);
        (is_matter(middle) ? in : out) = middle;
      }
      return in;
    }
    before = here;
  }
  return std::numeric_limits<float>::infinity();
}

/// Lit from above the viewer.
float light_on(const std::vector<float>& depths, const Sight& sight, int x, int y) {
  const auto depth = [&](int at_x, int at_y) {
    const float there = depths[static_cast<size_t>(std::clamp(at_y, 0, sight.height - 1)) *
                                   static_cast<size_t>(sight.width) +
                               static_cast<size_t>(std::clamp(at_x, 0, sight.width - 1))];
    return std::min(there, sight.depth);
  };
  const Vec3 normal = glm::normalize(
      Vec3(depth(x + 1, y) - depth(x - 1, y), depth(x, y - 1) - depth(x, y + 1), 2 * kPixel));
  constexpr float kAmbient = 0.12f;
  const Vec3 light = glm::normalize(Vec3(-0.3f, 0.6f, 1.0f));
  return kAmbient + (1 - kAmbient) * std::max(glm::dot(normal, light), 0.0f);
}

void draw_sight(const Volume& volume, float least, const Sight& sight, Image& picture, int left) {
  const auto width = static_cast<size_t>(sight.width);
  std::vector<float> depths(width * static_cast<size_t>(sight.height));
  parallel_for(depths.size(), width, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 start = sight.start(static_cast<int>(i % width), static_cast<int>(i / width));
      depths[i] = depth_of(volume, least, start, sight);
    }
  });
  for (int y = 0; y < sight.height; ++y) {
    for (int x = 0; x < sight.width; ++x) {
      if (std::isfinite(depths[static_cast<size_t>(y) * width + static_cast<size_t>(x)])) {
        std::fill_n(picture.at(left + x, y), 3, light_on(depths, sight, x, y));
      }
    }
  }
}

void place_picture(const Image& picture, int left, Image& sheet) {
  for (int y = 0; y < picture.height; ++y) {
    std::copy_n(picture.at(0, y), 3 * static_cast<size_t>(picture.width),
                sheet.at(left, kHeading + y));
  }
}

}  // namespace

Box box_of_head(const Volume& volume) {
  const VoxelBox matter = voxels_of_matter(volume);
  Box box;
  if (matter.dims().x == 0) {
    return box;
  }
  const float least = least_matter(volume);
  float top = std::numeric_limits<float>::lowest();
  for (const int z : {matter.low.z, matter.high.z}) {
    top = std::max(top, volume.world_from_index(Vec3(matter.low.x, matter.low.y, z)).z);
  }
  for (int z = matter.low.z; z <= matter.high.z; ++z) {
    for (int y = matter.low.y; y <= matter.high.y; ++y) {
      for (int x = matter.low.x; x <= matter.high.x; ++x) {
        const Vec3 place = volume.world_from_index(Vec3(x, y, z));
        if (place.z > top - kCrown && volume.at(x, y, z) > least) {
          box.add(place);
        }
      }
    }
  }
  if (!box.empty()) {
    box.min -= kAround;
    box.max += kAround;
    box.min.z = std::max(box.max.z - kHeight, volume.bounds().min.z - kAround);
  }
  return box;
}

Image draw_head(const Volume& volume, const Box& box) {
  const Sight front(box, {0, -1, 0});
  const Sight side(box, {-1, 0, 0});
  Image picture(front.width + kBetween + side.width, front.height, 3);
  fill(picture, kNothing, 0, 0, picture.width, picture.height);
  const float least = least_matter(volume);
  draw_sight(volume, least, front, picture, 0);
  draw_sight(volume, least, side, picture, front.width + kBetween);
  return picture;
}

Image draw_before_and_after(const Image& before, const Image& after) {
  const int second = before.width + 3 * kBetween;
  Image sheet(second + after.width + kBetween, kHeading + before.height + kBetween, 3);
  fill(sheet, kSheet, 0, 0, sheet.width, sheet.height);
  place_picture(before, kBetween, sheet);
  place_picture(after, second, sheet);
  write_over(sheet, [&](cairo_t* cairo) {
    constexpr double kInk = 0.93;
    constexpr double kTextSize = 15;
    constexpr double kLine = 26;
    grey(cairo, kInk);
    draw_text(cairo, "Before", kBetween, kLine, kTextSize, Align::kLeft, before.width, true);
    draw_text(cairo, "After --deface", second, kLine, kTextSize, Align::kLeft, after.width, true);
  });
  return sheet;
}

}  // namespace clipgs
