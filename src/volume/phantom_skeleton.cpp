#include <array>

#include "core/geometry.h"
#include "volume/phantom_body.h"

namespace clipgs::phantom {
namespace {

auto cortical(const Painter& painter) {
  return [&painter](const Vec3& p) { return 1150 + 120 * painter.noise(p, 5, 50); };
}

/// Spongy bone filled with marrow.
auto marrow(const Painter& painter) {
  return [&painter](const Vec3& p) {
    return 215 + 60 * painter.noise(p, 3, 51) + 40 * painter.noise(p, 9, 52);
  };
}

auto cartilage(const Painter& painter) {
  return [&painter](const Vec3& p) { return 95 + 8 * painter.noise(p, 5, 53); };
}

/// A shell of cortical bone, `shell` mm thick, around marrow.
template <typename Distance>
void paint_bone(Painter& painter, const Box& box, const Distance& distance, float shell) {
  painter.paint(box, distance, cortical(painter));
  painter.paint(box, [&](const Vec3& p) { return distance(p) + shell; }, marrow(painter));
}

/// Heights of the vertebral bodies' middles, T1 first, L5 last.
constexpr std::array<float, 17> kVertebrae{238, 217, 196, 175, 155, 134,  112,  89,  65,
                                           40,  14,  -14, -46, -80, -115, -150, -186};
constexpr size_t kRibs = 12;

/// How far down the spine a vertebra is: 0 for T1, 1 for L5. Bodies grow on the way.
float share_down(size_t i) {
  return static_cast<float>(i) / static_cast<float>(kVertebrae.size() - 1);
}

Vec2 body_radii(float share) {
  return {glm::mix(14.0f, 24.0f, share), glm::mix(11.0f, 17.0f, share)};
}

float vertebral_body(const Vec3& p, size_t i) {
  const float z = kVertebrae[i];
  const float share = share_down(i);
  const float half = glm::mix(8.5f, 14.0f, share);
  // Waisted: the end plates are wider than the middle.
  const float flare = 2 * std::min(std::abs(p.z - z) / half, 1.2f);
  const float side =
      ellipse(Vec2(p.x, p.y), Vec2(0, spine_y(p.z)), body_radii(share) + Vec2(flare - 1.5f));
  return smooth_intersection(side, std::abs(p.z - z) - half, 4);
}

/// Middle of the spinal canal at height z, behind the bodies.
Vec2 canal_center(float z, float share) { return {0, spine_y(z) - body_radii(share).y - 9.5f}; }

float vertebral_arch(const Vec3& p, size_t i) {
  const float z = kVertebrae[i];
  const float share = share_down(i);
  const bool lumbar = i >= kRibs;
  const Vec2 canal = canal_center(z, share);
  const float ring =
      std::max(ellipse(Vec2(p.x, p.y), canal, Vec2(17, 14)), std::abs(p.z - z + 3) - 9);
  const float drop = lumbar ? 6.0f : 20.0f;  // thoracic spines overlap like tiles
  const float back = lumbar ? 28.0f : 20.0f;
  const Segment spinous{{0, canal.y - 12, z - 2}, {0, canal.y - back, z - drop}, 4.5f, 4.0f};
  float d = smooth_union(ring, distance_to(spinous, p), 4);
  const float reach = lumbar ? 44.0f : 30.0f;
  const float rise = lumbar ? 0.0f : 5.0f;
  const Segment transverse{{14, canal.y + 2, z}, {reach, canal.y - 6, z + rise}, 5.0f, 4.0f};
  d = smooth_union(d, distance_to(transverse, Vec3(std::abs(p.x), p.y, p.z)), 4);
  return std::max(d, skin(p) + 7);
}

void paint_spine(Painter& painter) {
  Box column;
  column.add(Vec3(-30, -110, -1000));
  column.add(Vec3(30, 0, 1000));
  const auto share_at = [](float z) { return std::clamp((238 - z) / 424, 0.0f, 1.0f); };
  painter.paint(
      column,
      [&](const Vec3& p) {
        return ellipse(Vec2(p.x, p.y), Vec2(0, spine_y(p.z)), body_radii(share_at(p.z)) + 1.0f);
      },
      [&](const Vec3& p) { return 82 + 8 * painter.noise(p, 5, 54); });  // the discs
  for (size_t i = 0; i < kVertebrae.size(); ++i) {
    const float z = kVertebrae[i];
    Box box;
    box.add(Vec3(-50, spine_y(z) - 65, z - 30));
    box.add(Vec3(50, spine_y(z) + 22, z + 22));
    paint_bone(painter, box, [i](const Vec3& p) { return vertebral_arch(p, i); }, 2.0f);
    paint_bone(painter, box, [i](const Vec3& p) { return vertebral_body(p, i); }, 1.4f);
  }
  const auto canal = [&](const Vec3& p, const Vec2& radii) {
    return ellipse(Vec2(p.x, p.y), canal_center(p.z, share_at(p.z)), radii);
  };
  painter.paint(
      column, [&](const Vec3& p) { return canal(p, Vec2(11, 8.5f)); },
      [](const Vec3&) { return -60.0f; });  // epidural fat
  painter.paint(
      column, [&](const Vec3& p) { return canal(p, Vec2(9, 7)); },
      [](const Vec3&) { return 12.0f; });
  painter.paint(
      column,
      [&](const Vec3& p) {
        const float r = glm::mix(2.5f, 5.5f, smooth_step(-80, -30, p.z));  // the cord ends at L1
        return canal(p, Vec2(r + 1, r));
      },
      [](const Vec3&) { return 42.0f; });
}

/// Middle line of rib `k` (0 for the first), from the spine forward, under the skin.
std::vector<Vec3> rib_path(size_t k, float side) {
  const float reach = k < 7 ? 0.84f : k < 10 ? 0.70f : k == 10 ? 0.52f : 0.40f;  // of half a turn
  const float drop = k < 10 ? 68.0f : 38.0f;
  const float depth = 19;
  std::vector<Vec3> path;
  const float z = kVertebrae[k];
  const Vec3 head(side * (body_radii(share_down(k)).x + 2), spine_y(z) - 6, z + 4);
  path.push_back(head);
  constexpr int kSteps = 26;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = static_cast<float>(i) / kSteps;
    const float angle = kPi * glm::mix(0.13f, reach, t);
    const float height = z - drop * smooth_step(0, 1.05f, t) * (0.35f + 0.65f * t);
    path.push_back(under_skin(angle, std::min(height, 205.0f), side,
                              depth + (1 - t) * 6 * (t < 0.1f ? 1.0f : 0.6f)) +
                   Vec3(0, 0, height - std::min(height, 205.0f)));
  }
  return path;
}

/// Where the cartilage of rib `k` meets the breastbone or the cartilage above.
Vec3 rib_anchor(size_t k, float side) {
  const float z =
      k < 7 ? 168 - 17.0f * static_cast<float>(k) : 62 - 16.0f * static_cast<float>(k - 7);
  const float x = k < 7 ? 17.0f : 22.0f + 13.0f * static_cast<float>(k - 7);
  Vec3 p = under_skin(kPi, z, side, 20);
  p.x = side * x;
  return p;
}

void paint_ribs(Painter& painter) {
  std::vector<Segment> bones;
  std::vector<Segment> cartilages;
  for (size_t k = 0; k < kRibs; ++k) {
    for (const float side : {-1.0f, 1.0f}) {
      const std::vector<Vec3> path = rib_path(k, side);
      const float radius = k == 0 || k > 9 ? 3.6f : 4.3f;
      const std::vector<Segment> bone = tube(path, radius, radius);
      bones.insert(bones.end(), bone.begin(), bone.end());
      if (k < 10) {
        const Vec3 end = path.back();
        const Vec3 anchor = rib_anchor(k, side);
        const Vec3 middle = under_skin(0.5f * (std::atan2(std::abs(end.x), -end.y) +
                                               std::atan2(std::abs(anchor.x), -anchor.y)),
                                       std::min(0.5f * (end.z + anchor.z) - 6, 205.0f), side, 20);
        const std::vector<Segment> c = smooth_tube({end, middle, anchor}, 4.2f, 4.5f);
        cartilages.insert(cartilages.end(), c.begin(), c.end());
      }
    }
  }
  const Vec3 flat(1, 1, 0.62f);  // ribs are taller than thick
  painter.paint_tubes(cartilages, cartilage(painter), flat);
  painter.paint_tubes(bones, cortical(painter), flat);
  painter.paint_tubes(grown(bones, -1.5f), marrow(painter), flat);
}

void paint_breastbone(Painter& painter) {
  const float top = under_skin(kPi, 152, 1, 19).y;
  const float mid = under_skin(kPi, 96, 1, 19).y;
  const float low = under_skin(kPi, 44, 1, 19).y;
  Box box;
  box.add(Vec3(-32, low - 25, 25));
  box.add(Vec3(32, mid + 25, 182));
  paint_bone(
      painter, box,
      [=](const Vec3& p) {
        const float handle = ellipsoid(p, {0, top, 156}, {27, 7, 19});
        const float blade = ellipsoid(p, {0, mid, 98}, {17, 6.5f, 50});
        const float tip = ellipsoid(p, {0, low, 45}, {6, 4, 14});
        return smooth_union(smooth_union(handle, blade, 8), tip, 6);
      },
      1.6f);
}

void paint_shoulder_girdle(Painter& painter) {
  for (const float side : {-1.0f, 1.0f}) {
    const std::vector<Segment> clavicle = smooth_tube(
        {{side * 22, 58, 174}, {side * 55, 60, 182}, {side * 95, 38, 190}, {side * 128, 22, 196}},
        6, 5);
    painter.paint_tubes(clavicle, cortical(painter));
    painter.paint_tubes(grown(clavicle, -2.0f), marrow(painter));

    const Vec3 center(side * 88, -74, 140);
    const Vec3 normal = glm::normalize(Vec3(side * 0.35f, -1, 0.12f));
    Box box;
    box.add(center - Vec3(60, 40, 75));
    box.add(center + Vec3(60, 40, 75));
    paint_bone(
        painter, box,
        [=](const Vec3& p) {
          const Vec3 q = p - center;
          const float bow = glm::dot(q, normal) + 0.0016f * (q.x * q.x + 0.4f * q.z * q.z);
          const float half_width = 34 * smooth_step(-68, 30, q.z) + 4;  // a triangle, tip down
          const float rim = std::max(std::abs(q.x) - half_width, std::abs(q.z) - 60);
          const float spine_ridge = distance_to(
              {center + Vec3(-side * 30, -10, 22), center + Vec3(side * 46, -16, 46), 4.0f, 5.5f},
              p);
          const float plate = smooth_intersection(std::abs(bow) - 3, rim, 4);
          return std::max(smooth_union(plate, spine_ridge, 5), skin(p) + 6);
        },
        1.5f);
  }
}

void paint_hip_bones(Painter& painter) {
  for (const float side : {-1.0f, 1.0f}) {
    Box box;
    box.add(Vec3(side * 30, -105, -240));
    box.add(Vec3(side * 145, 75, -130));
    paint_bone(
        painter, box,
        [=](const Vec3& p) {
          const Vec3 q(p.x * side, p.y, p.z);
          const float bowl = std::abs(ellipsoid(q, {52, 2, -232}, {76, 92, 92})) - 5.0f;
          const float wing = std::max(52 - q.x, 0.6f * (q.y - 58));
          return std::max(smooth_intersection(bowl, wing, 6), skin(p) + 10);
        },
        2.0f);
  }
}

}  // namespace

void paint_skeleton(Painter& painter) {
  paint_shoulder_girdle(painter);
  paint_ribs(painter);
  paint_breastbone(painter);
  paint_hip_bones(painter);
  paint_spine(painter);
}

}  // namespace clipgs::phantom
