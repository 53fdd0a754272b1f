#include "section/surface.h"

#include <algorithm>

#include "core/parallel.h"
#include "section/display_curve.h"
#include "section/face_light.h"
#include "section/face_rays.h"
#include "section/kept_span.h"

namespace clipgs {
namespace {

/// What a wall radiates towards the camera, linear RGB before exposure. As much of the gloss is
/// seen as of the light that would fall on the wall if nothing stood around it.
Vec3 radiance(const Wall& wall, const Section& section, const OpenedLight& light,
              const Vec3& direction) {
  const Vec3 white = light.on(wall);
  Vec3 sum = wall.reflectance * white;
  if (wall.specular > 0) {
    const Vec3 open = face_diffuse(section.rig, wall.normal);
    const float lit = (white.r + white.g + white.b) / std::max(open.r + open.g + open.b, 1e-6f);
    sum += std::min(lit, 1.0f) * wall.specular *
           face_gloss(section.rig, wall.normal, -direction, wall.roughness);
  }
  return sum;
}

}  // namespace

Image draw_surface(const Section& section, const Camera& camera, const Cut& cut,
                   const OpenedLight& light, const DepthCue& cue, int rays) {
  Image image(camera.width, camera.height, 4);
  const Openings& openings = light.openings();
  const DisplayCurve& display = display_curve(section.tone);
  const Vec3 origin = section.index_from_world(camera.position);
  // The wall that a ray meets; nothing where it is seen as a face, or through a gap of one.
  const auto look = [&](const Vec3& direction) -> std::optional<Wall> {
    const Vec3 stride = (direction * section.direction) / section.spacing;
    const auto [enter, leave, slope] =
        kept_span<float>(section, cut.planes(), camera.position, direction, origin, stride);
    if (!(enter < leave) || (!cut.empty() && openings.is_inside(origin + enter * stride))) {
      return std::nullopt;
    }
    std::optional<Wall> wall =
        openings.first_wall(section, camera.position, direction, enter, leave);
    if (wall && (glm::distance(wall->position, camera.position) - enter) * slope <
                    section.surface_depth()) {
      return std::nullopt;
    }
    return wall;
  };
  const auto add = [&](float x, float y, Vec4& sum) {
    const Vec3 direction = camera.ray_direction(x, y);
    if (const std::optional<Wall> wall = look(direction)) {
      const Vec3 seen = section.exposure * radiance(*wall, section, light, direction);
      const float kept = cue.kept(glm::distance(wall->position, camera.position));
      sum += Vec4(kept * Vec3(display(seen.r), display(seen.g), display(seen.b)), 1);
    }
  };
  parallel_for(static_cast<size_t>(image.height), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < image.width; ++x) {
        Vec4 sum(0);
        for (int i = 0; i < rays; ++i) {
          const Vec2 at = Vec2(x, y) + place_in_pixel(i, rays);
          add(at.x, at.y, sum);
        }
        if (sum.a > 0) {
          const Vec4 color(Vec3(sum) / sum.a, sum.a / static_cast<float>(rays));
          std::copy_n(&color[0], 4, image.at(x, y));
        }
      }
    }
  });
  return image;
}

}  // namespace clipgs
