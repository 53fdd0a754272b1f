#include <array>

#include "volume/phantom_body.h"

namespace clipgs::phantom {
namespace {

Box around(const Vec3& center, const Vec3& radii) {
  Box box;
  box.add(center - radii);
  box.add(center + radii);
  return box;
}

/// An organ of nearly one value: soft texture at 4 mm and 11 mm.
auto tissue(const Painter& painter, float hu, std::uint32_t field) {
  return [&painter, hu, field](const Vec3& p) {
    return hu + 5 * painter.noise(p, 4, field) + 4 * painter.noise(p, 11, field);
  };
}

void paint_liver(Painter& painter) {
  painter.paint(
      around({30, 15, -20}, {125, 100, 80}),
      [&](const Vec3& p) { return liver(p) + 2 * painter.noise(p, 30, 10); },
      tissue(painter, 108, 11));
  const Vec3 gallbladder(40, 50, -66);
  painter.paint(
      around(gallbladder, Vec3(30)),
      [&](const Vec3& p) { return ellipsoid(p, gallbladder, {13, 14, 24}) - 1.5f; },
      tissue(painter, 60, 12));
  painter.paint(
      around(gallbladder, Vec3(30)),
      [&](const Vec3& p) { return ellipsoid(p, gallbladder, {12, 13, 23}); },
      [](const Vec3&) { return 8.0f; });
}

void paint_spleen(Painter& painter) {
  const Vec3 center(-98, -30, -16);
  painter.paint(
      around(center, {40, 55, 50}),
      [&](const Vec3& p) {
        const float body = ellipsoid(p, center, {27, 46, 40});
        const float hollow = ellipsoid(p, center + Vec3(34, 12, -4), {24, 34, 34});
        const float bean = smooth_intersection(body, -hollow, 8);
        return std::max({bean, cavity(p) + 2, 0.8f * (p.z - diaphragm(p) + 4)});
      },
      tissue(painter, 122, 13));
}

/// Cortex, pyramids of medulla, and a pelvis of fat and urine.
void paint_kidney(Painter& painter, float side) {
  const Vec3 center(side * 60, -38, side > 0 ? -86.0f : -76.0f);
  const auto kidney = [=](const Vec3& p) {
    const float body = ellipsoid(p, center, {27, 24, 52});
    const float hilum = ellipsoid(p, center + Vec3(-side * 30, 8, 0), {17, 14, 20});
    return smooth_intersection(body, -hilum, 8);
  };
  painter.paint(around(center, {34, 30, 58}), kidney, tissue(painter, 165, 14));
  painter.paint(
      around(center, {34, 30, 58}),
      [&](const Vec3& p) {
        const Vec3 q = p - center - Vec3(-side * 8, 2, 0);
        const float angle = std::atan2(q.z, side * q.x + 0.3f * q.y);
        const float columns = 3.5f * std::cos(9 * angle);
        return kidney(p) + 8 + columns;
      },
      tissue(painter, 112, 15));
  painter.paint(
      around(center, {34, 30, 58}),
      [&](const Vec3& p) {
        return ellipsoid(p, center + Vec3(-side * 10, 3, 0), {11, 8, 24}) +
               2.5f * painter.noise(p, 8, 16);
      },
      [&](const Vec3& p) { return p.x * side > center.x * side - 12 ? -80.0f : 12.0f; });
}

void paint_stomach(Painter& painter) {
  const auto stomach = [&](const Vec3& p) {
    const float fundus = ellipsoid(p, {-52, 12, -20}, {34, 36, 36});
    const float antrum = ellipsoid(p, {-14, 46, -56}, {36, 17, 16});
    const float body = smooth_union(fundus, antrum, 26);
    return std::max({body, cavity(p) + 4, 0.8f * (p.z - diaphragm(p) + 6)});
  };
  const Box box = around({-35, 25, -35}, {70, 60, 62});
  painter.paint(
      box, [&](const Vec3& p) { return stomach(p) + 1.5f * painter.noise(p, 12, 17); },
      tissue(painter, 78, 18));
  painter.paint(
      box, [&](const Vec3& p) { return stomach(p) + 5 + 2.5f * std::abs(painter.noise(p, 9, 19)); },
      [&](const Vec3& p) {
        // The patient lies on the back: gas above, fluid below, a little debris between.
        return p.y > 34 ? -985.0f : 18 + 12 * painter.noise(p, 6, 20);
      });
}

void paint_pancreas(Painter& painter) {
  const std::vector<Segment> path = smooth_tube(
      {{34, 14, -78}, {26, 20, -62}, {-8, 22, -60}, {-48, 2, -46}, {-78, -24, -34}}, 13, 8);
  painter.paint(
      bounds_of(path),
      [&](const Vec3& p) {
        float d = 1e9f;
        for (const Segment& s : path) {
          d = smooth_union(d, distance_to(s, p), 4);
        }
        return d + 2.5f * painter.noise(p, 7, 21);
      },
      tissue(painter, 96, 22));
}

/// A gut: wall, then what it holds.
template <typename Contents>
void paint_gut(Painter& painter, const std::vector<Segment>& path, float wall,
               const Contents& contents) {
  painter.paint_tubes(path, tissue(painter, 72, 23));
  painter.paint_tubes(grown(path, -wall), contents);
}

void paint_colon(Painter& painter) {
  const auto haustra = [](std::vector<Segment> path) {
    for (size_t i = 0; i < path.size(); ++i) {  // bulges between tight rings
      path[i].radius_a *= i % 2 == 0 ? 1.12f : 0.86f;
      path[i].radius_b *= i % 2 == 0 ? 0.86f : 1.12f;
    }
    return path;
  };
  const auto stool = [&](const Vec3& p) {
    return -40 + 90 * painter.noise(p, 8, 24) + 120 * std::min(painter.noise(p, 5, 25), 0.0f);
  };
  const auto gas = [&](const Vec3& p) {
    return p.y > 52 + 3 * painter.noise(p, 9, 26) ? -985.0f : stool(p);
  };
  paint_gut(
      painter,
      haustra(smooth_tube({{92, -8, -215}, {96, 4, -170}, {92, 0, -125}, {84, 20, -90}}, 24, 21)),
      2.5f, stool);
  paint_gut(
      painter,
      haustra(smooth_tube(
          {{84, 22, -90}, {50, 62, -100}, {0, 68, -112}, {-48, 62, -98}, {-88, 20, -64}}, 20, 18)),
      2.5f, gas);
  paint_gut(painter,
            haustra(smooth_tube(
                {{-88, 18, -64}, {-98, -12, -105}, {-98, -8, -160}, {-90, 10, -215}}, 17, 15)),
            2.5f, stool);
}

void paint_small_bowel(Painter& painter) {
  std::vector<Vec3> points;
  constexpr int kTurns = 64;
  for (int i = 0; i <= kTurns; ++i) {
    const auto t = static_cast<float>(i);
    points.emplace_back(64 * std::sin(0.83f * t), 34 + 30 * std::sin(1.31f * t + 1),
                        -136 - 1.05f * t + 11 * std::sin(2.1f * t));
  }
  paint_gut(painter, smooth_tube(points, 9, 9), 2.2f, [&](const Vec3& p) {
    const float folds = std::pow(std::abs(painter.noise(p, 4, 27)), 2.0f);
    return 22 + 50 * folds;
  });
}

void paint_lung(Painter& painter, float side) {
  Box box;
  box.add(Vec3(0, -110, -75));
  box.add(Vec3(side * 150, 115, 205));
  const auto parenchyma = [&](const Vec3& p) {
    // Denser where the patient lies on it.
    const float lying = smooth_step(20, -90, p.y);
    return -865 + 70 * lying + 22 * painter.noise(p, 5, 30) + 18 * painter.noise(p, 12, 31);
  };
  painter.paint(
      box, [&](const Vec3& p) { return lung(p, side); },
      [&](const Vec3& p) {
        // The oblique fissure between the lobes, a thin double sheet.
        const float fissure = std::abs(p.z - 60 - 0.9f * (p.y + 6) * -1.0f);
        return parenchyma(p) + 420 * std::exp(-fissure * fissure / 1.2f);
      });
}

/// Lumen, wall and trees of the airways.
void paint_airways(Painter& painter, Rng& rng) {
  std::vector<Segment> airways = smooth_tube({{0, -6, 210}, {0, -10, 165}, {0, -14, 132}}, 8.5f, 8);
  for (const float side : {-1.0f, 1.0f}) {
    const Vec3 hilum(side * 40, -12, 108);
    const std::vector<Segment> bronchus =
        smooth_tube({{0, -14, 132}, {side * 16, -15, 120}, hilum}, 6.5f, 5.2f);
    airways.insert(airways.end(), bronchus.begin(), bronchus.end());
    const auto inside = [&](const Vec3& p) { return lung(p, side) < -6; };
    for (const Vec3 direction :
         {Vec3(0.5f, 0.25f, 0.8f), Vec3(0.75f, 0.65f, -0.1f), Vec3(0.55f, -0.3f, -0.75f)}) {
      grow_tree(rng, {hilum, glm::normalize(direction * Vec3(side, 1, 1)), 26, 4.2f, 5}, inside,
                airways);
    }
  }
  painter.paint_tubes(grown(airways, 1.4f), tissue(painter, 30, 32));
  painter.paint_tubes(airways, [](const Vec3&) { return -1000.0f; });
}

void paint_oesophagus(Painter& painter) {
  const std::vector<Segment> path =
      smooth_tube({{-4, -20, 212}, {-5, -24, 130}, {-9, -22, 60}, {-26, -6, 8}}, 7, 8);
  painter.paint_tubes(path, tissue(painter, 50, 38));
  painter.paint_tubes(grown(path, -5), [](const Vec3&) { return -300.0f; });
}

void paint_heart(Painter& painter) {
  const Box box = around({-14, 32, 62}, {80, 62, 66});
  const auto heart = [](const Vec3& p) {
    const float ventricles = ellipsoid(p, {-24, 36, 54}, {50, 42, 44});
    const float atria = ellipsoid(p, {10, 14, 76}, {42, 34, 36});
    return std::max(smooth_union(ventricles, atria, 16), cavity(p) + 3);
  };
  painter.paint(box, [&](const Vec3& p) { return heart(p) - 6; }, tissue(painter, -88, 33));
  painter.paint(
      box, [&](const Vec3& p) { return heart(p) + 1.2f * painter.noise(p, 10, 34); },
      tissue(painter, 98, 35));
  struct Chamber {
    Vec3 center;
    Vec3 radii;
    float hu;
  };
  constexpr float kLeft = 255;
  constexpr float kRight = 190;
  const std::array<Chamber, 4> chambers{{{{-40, 30, 50}, {20, 19, 30}, kLeft},
                                         {{-8, 56, 52}, {28, 12, 30}, kRight},
                                         {{-4, 0, 82}, {27, 15, 19}, kLeft},
                                         {{36, 24, 72}, {16, 20, 24}, kRight}}};
  for (const Chamber& chamber : chambers) {
    painter.paint(
        box,
        [&](const Vec3& p) {
          // Trabeculae roughen the chambers' walls.
          return std::max(ellipsoid(p, chamber.center, chamber.radii), heart(p) + 3) +
                 2.2f * painter.noise(p, 6, 36);
        },
        tissue(painter, chamber.hu, 37));
  }
}

}  // namespace

void paint_organs(Painter& painter) {
  paint_liver(painter);
  paint_spleen(painter);
  paint_pancreas(painter);
  paint_stomach(painter);
  paint_small_bowel(painter);
  paint_colon(painter);
  paint_kidney(painter, -1);
  paint_kidney(painter, 1);
}

void paint_chest(Painter& painter, std::uint64_t seed) {
  paint_lung(painter, -1);
  paint_lung(painter, 1);
  paint_oesophagus(painter);
  paint_heart(painter);
  Rng rng(seed, 1);
  paint_airways(painter, rng);
}

}  // namespace clipgs::phantom
