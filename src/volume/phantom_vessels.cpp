#include "volume/phantom_body.h"

namespace clipgs::phantom {
namespace {

constexpr float kArterial = 260;  // HU with contrast
constexpr float kPulmonary = 230;
constexpr float kVenous = 175;

auto blood(const Painter& painter, float hu) {
  return [&painter, hu](const Vec3& p) { return hu + 6 * painter.noise(p, 4, 40); };
}

void add(std::vector<Segment>& to, const std::vector<Segment>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// In front of the spine, `x` to the right of the middle.
Vec3 before_spine(float x, float z, float gap) { return {x, spine_y(z) + 16 + gap, z}; }

std::vector<Segment> aorta() {
  std::vector<Vec3> path{{2, 22, 92}, {14, 30, 118}, {12, 22, 146}, {-2, 0, 160}, {-16, -26, 150}};
  for (int level = 0; level < 6; ++level) {
    const float z = 125 - 29.0f * static_cast<float>(level);
    path.push_back(before_spine(z > 40 ? -19.0f : -12.0f, z, z > 40 ? 2.0f : 12.0f));
  }
  std::vector<Segment> vessel = smooth_tube(path, 15, 11);
  add(vessel, smooth_tube({before_spine(-12, -20, 12), before_spine(-8, -60, 13),
                           before_spine(-6, -105, 14), before_spine(-4, -150, 14)},
                          10.5f, 9));
  return vessel;
}

std::vector<Segment> arteries() {
  std::vector<Segment> vessels = aorta();
  const Vec3 fork = before_spine(-4, -150, 14);
  for (const float side : {-1.0f, 1.0f}) {
    add(vessels,
        smooth_tube({fork, fork + Vec3(side * 22, -2, -34), fork + Vec3(side * 40, -4, -70)}, 6,
                    5));
    // Renal, into the hilum of each kidney.
    add(vessels, smooth_tube({before_spine(-8, -78, 12), before_spine(side * 22, -80, 8),
                              Vec3(side * 46, -32, -80)},
                             3.6f, 3));
    // Common carotid and subclavian.
    add(vessels,
        smooth_tube({{side * 5, 8, 158}, {side * 16, 6, 182}, {side * 18, 2, 210}}, 4.5f, 4));
    add(vessels,
        smooth_tube({{side * 9, 2, 158}, {side * 34, -2, 186}, {side * 84, 4, 200}}, 4.5f, 4));
  }
  // Coeliac trunk to spleen and liver; superior mesenteric with its branches.
  const Vec3 coeliac = before_spine(-10, -48, 26);
  add(vessels, tube({before_spine(-10, -46, 14), coeliac}, 4, 4));
  add(vessels, smooth_tube({coeliac, {-34, 0, -38}, {-58, -16, -34}, {-80, -26, -22}}, 3.2f, 2.4f));
  add(vessels, smooth_tube({coeliac, {6, 18, -46}, {26, 22, -38}, {40, 16, -28}}, 3, 2.2f));
  add(vessels, smooth_tube({before_spine(-8, -64, 14), {-4, 10, -86}, {2, 24, -130}, {8, 30, -175}},
                           4, 2.5f));
  return vessels;
}

std::vector<Segment> veins() {
  std::vector<Segment> vessels = smooth_tube({before_spine(18, -150, 14),
                                              before_spine(18, -100, 14),
                                              before_spine(20, -50, 18),
                                              {26, -2, 10},
                                              {32, 12, 50}},
                                             10.5f, 12);
  const Vec3 fork = before_spine(18, -150, 14);
  for (const float side : {-1.0f, 1.0f}) {
    add(vessels, smooth_tube({fork, fork + Vec3(side * 20 - 14, -6, -36),
                              fork + Vec3(side * 38 - 14, -8, -72)},
                             7.5f, 6.5f));
    add(vessels, smooth_tube({before_spine(18, -82, 14), before_spine(side * 26, -84, 16),
                              Vec3(side * 46, -26, -82)},
                             4.5f, 4));
  }
  add(vessels, smooth_tube({{34, 16, 90}, {32, 8, 130}, {30, 8, 170}, {40, 4, 212}}, 9, 8));
  // Portal vein: spleen and gut to the liver's gate.
  add(vessels,
      smooth_tube({{-70, -22, -32}, {-30, 6, -46}, {14, 14, -52}, {30, 12, -36}}, 5, 6.5f));
  add(vessels, smooth_tube({{18, 34, -165}, {16, 26, -110}, {14, 14, -54}}, 4, 5.5f));
  return vessels;
}

std::vector<Segment> liver_trees(Rng& rng) {
  std::vector<Segment> vessels;
  const auto inside = [](const Vec3& p) { return liver(p) < -5; };
  for (const Vec3 direction :
       {Vec3(0.9f, -0.35f, 0.1f), Vec3(0.5f, 0.5f, 0.4f), Vec3(-0.6f, 0.7f, 0.45f)}) {
    grow_tree(rng, {{30, 12, -36}, glm::normalize(direction), 24, 5, 6}, inside, vessels);
  }
  for (const Vec3 direction : {Vec3(0.95f, -0.1f, -0.4f), Vec3(0.6f, 0.75f, -0.35f)}) {
    grow_tree(rng, {{30, -2, 2}, glm::normalize(direction), 26, 4.5f, 6}, inside, vessels);
  }
  return vessels;
}

std::vector<Segment> lung_trees(Rng& rng) {
  std::vector<Segment> vessels =
      smooth_tube({{-10, 46, 84}, {-14, 32, 106}, {-12, 14, 120}}, 12, 11);
  for (const float side : {-1.0f, 1.0f}) {
    const Vec3 hilum(side * 42, -2, 112);
    add(vessels, smooth_tube({{-12, 14, 120}, {side * 18, 4, 120}, hilum}, 9.5f, 7.5f));
    const auto inside = [&](const Vec3& p) { return lung(p, side) < -5; };
    for (const Vec3 direction :
         {Vec3(0.4f, 0.45f, 0.85f), Vec3(0.45f, -0.5f, 0.7f), Vec3(0.8f, 0.6f, -0.2f),
          Vec3(0.75f, -0.6f, -0.2f), Vec3(0.45f, 0.3f, -0.85f), Vec3(0.4f, -0.55f, -0.8f)}) {
      grow_tree(rng, {hilum, glm::normalize(direction * Vec3(side, 1, 1)), 24, 4.6f, 7}, inside,
                vessels);
    }
  }
  return vessels;
}

}  // namespace

void paint_vessels(Painter& painter, std::uint64_t seed) {
  Rng rng(seed, 2);
  painter.paint_tubes(lung_trees(rng), blood(painter, kPulmonary));
  painter.paint_tubes(liver_trees(rng), blood(painter, kVenous));
  painter.paint_tubes(veins(), blood(painter, kVenous));
  const std::vector<Segment> all = arteries();
  painter.paint_tubes(grown(all, 1.3f), blood(painter, 60));  // the wall
  painter.paint_tubes(all, blood(painter, kArterial));
}

}  // namespace clipgs::phantom
