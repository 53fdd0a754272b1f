#include "volume/phantom_body.h"

#include <array>

namespace clipgs::phantom {
namespace {

/// Half width and half depths (front, back) of the trunk at a height, mm.
struct Outline {
  float z;
  float side;
  float front;
  float back;
};

constexpr std::array<Outline, 7> kOutline{{{-205, 160, 98, 104},
                                           {-130, 153, 99, 96},
                                           {-60, 141, 97, 96},
                                           {20, 147, 103, 101},
                                           {90, 157, 110, 105},
                                           {150, 160, 101, 101},
                                           {205, 158, 80, 93}}};

Outline outline_at(float z) {
  size_t i = 0;
  while (i + 2 < kOutline.size() && z > kOutline[i + 1].z) {
    ++i;
  }
  const Outline& a = kOutline[i];
  const Outline& b = kOutline[i + 1];
  const float t = smooth_step(a.z, b.z, z);
  return {z, glm::mix(a.side, b.side, t), glm::mix(a.front, b.front, t),
          glm::mix(a.back, b.back, t)};
}

float bump(float x, float width) { return std::exp(-x * x / (width * width)); }

float breast_muscle(const Vec3& p) {
  return ellipsoid(Vec3(std::abs(p.x), p.y, p.z), Vec3(62, 84, 100), Vec3(58, 30, 42));
}

}  // namespace

float skin(const Vec3& p) {
  const Outline o = outline_at(p.z);
  const float depth = p.y > 0 ? o.front : o.back;
  // A superellipse of exponent 2.5, to first order.
  const float u = std::abs(p.x) / o.side;
  const float v = std::abs(p.y) / depth;
  const float k = std::pow(u * u * std::sqrt(u) + v * v * std::sqrt(v), 0.4f);
  if (k < 1e-3f) {
    return -std::min(o.side, depth);
  }
  const Vec2 slope = Vec2(u * std::sqrt(u) / o.side, v * std::sqrt(v) / depth) / (k * std::sqrt(k));
  const float trunk = (k - 1) / glm::length(slope);
  float d = smooth_union(trunk, breast_muscle(p), 18);
  if (p.y < 0) {
    d += 6 * bump(p.x, 14);  // the furrow over the spine
  } else {
    d += 2 * bump(p.x, 8) * smooth_step(60, 20, p.z);
    d += 9 * bump(p.x, 6) * bump(p.z + 95, 6);  // the navel
  }
  return d;
}

float fat_thickness(const Vec3& p) {
  const float belly = smooth_step(70, -60, p.z);
  const float front = smooth_step(-40, 60, p.y);
  return 7 + belly * (6 + 5 * front);
}

float wall_thickness(const Vec3& p) {
  const float back = smooth_step(0, -70, p.y);
  return 14 + 6 * back;
}

float diaphragm(const Vec3& p) {
  const float right = p.x > 0 ? 1.0f : 0.0f;
  const float peak = glm::mix(22.0f, 34.0f, smooth_step(-30, 30, p.x));
  const float center = right > 0 ? 66.0f : -66.0f;
  const float across = (p.x - center) / 92;
  const float along = (p.y - 12) / 104;
  return std::max(peak - 62 * (across * across + along * along), -70.0f);
}

float lung(const Vec3& p, float side) {
  const Vec3 q(p.x * side, p.y, p.z);  // as if it were the right one
  const float dome = ellipsoid(q, Vec3(66, -4, 30), Vec3(86, 106, 158));
  const float outer = smooth_intersection(dome, cavity(p) + 1.5f, 16);
  const float above = 0.8f * (diaphragm(p) + 2 - p.z);
  const float middle = 22 + 10 * bump(p.z - 110, 30) - q.x;  // the hilum makes room
  return smooth_intersection(smooth_intersection(outer, above, 10), middle, 14);
}

float liver(const Vec3& p) {
  const float right = ellipsoid(p, Vec3(56, 2, -22), Vec3(92, 84, 62));
  const float left = ellipsoid(p, Vec3(-12, 44, -4), Vec3(62, 34, 26));
  const float body = smooth_union(right, left, 20);
  const float below = 0.8f * (p.z - diaphragm(p) + 4);
  return smooth_intersection(smooth_intersection(body, below, 10), cavity(p) + 3, 12);
}

float spine_y(float z) {
  const float lumbar = bump(z + 110, 75);
  const float thoracic = bump(z - 105, 80);
  return -42 + 9 * lumbar - 7 * thoracic;
}

Vec3 under_skin(float angle, float z, float side, float depth) {
  const Vec3 toward(side * std::sin(angle), -std::cos(angle), 0);
  // Bisection along the direction from the axis: the outline is star-shaped.
  float low = 0;
  float high = 200;
  for (int i = 0; i < 20; ++i) {
    const float r = 0.5f * (low + high);
    (skin(toward * r + Vec3(0, 0, z)) < -depth ? low : high) = r;
  }
  return toward * low + Vec3(0, 0, z);
}

void paint_wall(Painter& painter) {
  Box everywhere;
  everywhere.add(Vec3(-1000));
  everywhere.add(Vec3(1000));
  painter.paint(everywhere, skin, [&](const Vec3& p) { return 45 + 10 * painter.noise(p, 3, 0); });
  painter.paint(
      everywhere, [](const Vec3& p) { return skin(p) + 2.2f; },
      [&](const Vec3& p) {
        // Lobules between thin septa.
        const float septa = 1 - std::abs(painter.noise(p, 14, 1));
        return -108 + 8 * painter.noise(p, 5, 2) + 26 * std::pow(septa, 8.0f);
      });
  painter.paint(
      everywhere,
      [&](const Vec3& p) { return skin(p) + fat_thickness(p) + 2 * painter.noise(p, 40, 3); },
      [&](const Vec3& p) {
        // Layers of muscle at the flanks, with sheets of fat between them; the white line in front.
        const float depth = -(skin(p) + fat_thickness(p)) / wall_thickness(p);
        const float flank = smooth_step(50, 95, std::abs(p.x)) * smooth_step(90, 30, p.z);
        const float sheets = flank * (bump(depth - 0.34f, 0.06f) + bump(depth - 0.68f, 0.06f));
        const float line = p.y > 0 && p.z < 40 ? bump(p.x, 3.5f) : 0.0f;
        const float streaks =
            std::pow(std::max(painter.noise(p, 9, 4), 0.0f), 3.0f) * smooth_step(0, -60, p.y);
        return 58 + 7 * painter.noise(p, 4, 5) - 120 * std::min(sheets + line, 1.0f) -
               110 * streaks;
      });
  painter.paint(everywhere, cavity, [&](const Vec3& p) {
    return -98 + 9 * painter.noise(p, 7, 6) + 22 * std::max(painter.noise(p, 17, 7), 0.0f);
  });
  // Erector spinae and psoas beside the spine.
  for (const float side : {-1.0f, 1.0f}) {
    Box back;
    back.add(Vec3(side * 8, -105, -1000));
    back.add(Vec3(side * 66, -40, 1000));
    const auto muscle = [&](const Vec3& p) {
      return 60 + 7 * painter.noise(p, 4, 5) -
             90 * std::pow(std::max(painter.noise(p, 8, 8), 0.0f), 2.0f);
    };
    painter.paint(
        back,
        [&](const Vec3& p) {
          const float column =
              ellipse(Vec2(p.x, p.y), Vec2(side * 34, spine_y(p.z) - 22), Vec2(27, 17));
          return std::max(column, skin(p) + 9);
        },
        muscle);
    painter.paint_tubes(
        tube({{side * 26, -44, -40}, {side * 36, -34, -110}, {side * 56, -12, -215}}, 7, 24),
        muscle);
  }
}

}  // namespace clipgs::phantom
