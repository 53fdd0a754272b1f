#include "section/face_splats.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "section/faces.h"
#include "splat/disc.h"

namespace clipgs {

namespace {

// So far away, in radii of the matter, that all rays are nearly straight.
constexpr float kDistance = 40;
constexpr int kMostPixels = 768;  // a side
constexpr int kLargest = 16;      // pixels a side that one disc may stand for
constexpr float kFineColors = 0.02f;
constexpr float kSolid = 0.98f;  // alpha of what larger discs may stand for
constexpr float kSeen = 0.3f;    // alpha of what has a disc
constexpr float kWide = 0.6f;    // of a pixel: neighbours leave no gap, and blur little
constexpr float kThick = 0.05f;
constexpr float kMostOpaque = 0.995f;

/// A face as it is seen from straight before it.
struct FacePicture {
  Image colors;      // premultiplied, alpha 0 where it is no point of the plane's face
  Vec3 corner;       // of the first pixel, mm
  Vec3 right, down;  // from pixel to pixel, mm
  Vec3 normal;       // out of the face
  float pixel;       // mm
};

std::optional<FacePicture> picture_of(const Section& section, const Sphere& sphere, const Cut& cut,
                                      const Plane& plane, int coarser) {
  const float off = plane.signed_distance(sphere.center);
  if (std::abs(off) >= sphere.radius) {
    return std::nullopt;
  }
  const float reach = std::sqrt(sphere.radius * sphere.radius - off * off);
  const float finest = 0.7f * std::min({section.spacing.x, section.spacing.y, section.spacing.z});
  const int size =
      std::clamp(static_cast<int>(std::ceil(2 * reach / finest)), 1, kMostPixels) / coarser + 1;
  const Vec3 center = sphere.center - off * plane.normal;
  const Vec3 outward = -plane.normal;
  Vec3 up;
  Vec3 side;
  orthonormal_basis(outward, up, side);
  const float distance = kDistance * sphere.radius;
  const Vec3 eye = center + distance * outward;
  const Camera camera = look_at(eye, center, up, size, size, 2 * std::atan2(reach, distance));
  FacePicture face{draw_faces(section, camera, cut), {}, {}, {}, outward, 2 * reach / size};
  const Image distances = face_distances(section, camera, cut);
  const auto point_at = [&](float x, float y) {
    const Vec3 direction = camera.ray_direction(x, y);
    return eye + direction * (-distance / glm::dot(direction, outward));
  };
  face.corner = point_at(0.5f, 0.5f);
  face.right = point_at(1.5f, 0.5f) - face.corner;
  face.down = point_at(0.5f, 1.5f) - face.corner;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const size_t i = static_cast<size_t>(y) * size + x;
      const float at =
          glm::dot(camera.ray_direction(x + 0.5f, y + 0.5f), -outward) * distances.data[i];
      if (std::abs(at - distance) > face.pixel) {  // another plane's, or no face
        std::fill_n(&face.colors.data[4 * i], 4, 0.0f);
      }
    }
  }
  return face;
}

/// A square of pixels, and their mean colour.
struct Square {
  int x, y, side;
  Vec3 color;
  float alpha;
};

class Squares {
 public:
  Squares(const Image& colors, float tolerance) : colors_(colors), tolerance_(tolerance) {
    for (int y = 0; y < colors.height; y += kLargest) {
      for (int x = 0; x < colors.width; x += kLargest) {
        divide(x, y, kLargest);
      }
    }
  }
  std::vector<Square> found;

 private:
  void divide(int x, int y, int side) {
    if (side > 1 && !is_one(x, y, side)) {
      for (const int dy : {0, side / 2}) {
        for (const int dx : {0, side / 2}) {
          divide(x + dx, y + dy, side / 2);
        }
      }
      return;
    }
    Vec3 sum(0);
    float alpha = 0;
    for (int at_y = y; at_y < y + side; ++at_y) {
      for (int at_x = x; at_x < x + side; ++at_x) {
        const float* const p = pixel(at_x, at_y);
        sum += p != nullptr ? Vec3(p[0], p[1], p[2]) : Vec3(0);
        alpha += p != nullptr ? p[3] : 0.0f;
      }
    }
    const float mean_alpha = alpha / static_cast<float>(side * side);
    if (mean_alpha >= kSeen) {
      found.push_back({x, y, side, sum / alpha, mean_alpha});
    }
  }

  /// Whether a square may have one disc, which reaches beyond it: as far as that it is all face,
  /// and of one colour, or it is none at all.
  bool is_one(int x, int y, int side) const {
    Vec3 low(1e9f);
    Vec3 high(-1e9f);
    float least = 1;
    float most = 0;
    for (int at_y = y - side; at_y < y + 2 * side; ++at_y) {
      for (int at_x = x - side; at_x < x + 2 * side; ++at_x) {
        const float* const p = pixel(at_x, at_y);
        const float alpha = p != nullptr ? p[3] : 0.0f;
        least = std::min(least, alpha);
        most = std::max(most, alpha);
        if (least < kSolid && most > 0) {
          return false;
        }
        if (p != nullptr && alpha > 0) {
          const Vec3 color = Vec3(p[0], p[1], p[2]) / alpha;
          low = glm::min(low, color);
          high = glm::max(high, color);
        }
      }
    }
    const Vec3 range = high - low;
    return most == 0 || std::max({range.r, range.g, range.b}) <= tolerance_;
  }

  /// Null beyond the picture.
  const float* pixel(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < colors_.width && y < colors_.height;
    return inside ? &colors_.data[4 * (static_cast<size_t>(y) * colors_.width + x)] : nullptr;
  }

  const Image& colors_;
  float tolerance_;
};

std::vector<FacePicture> pictures_of(const Section& section, const Sphere& sphere, const Cut& cut,
                                     int coarser) {
  std::vector<Plane> planes(cut.planes().begin(), cut.planes().end());
  std::ranges::copy(section.ends(), std::back_inserter(planes));
  std::vector<FacePicture> faces;
  for (const Plane& plane : planes) {
    if (std::optional<FacePicture> face = picture_of(section, sphere, cut, plane, coarser)) {
      faces.push_back(std::move(*face));
    }
  }
  return faces;
}

void add_discs(const FacePicture& face, const std::vector<Square>& squares, size_t& i,
               Gaussians& discs) {
  for (const Square& square : squares) {
    const float middle = 0.5f * static_cast<float>(square.side - 1);
    const Vec3 center = face.corner + (static_cast<float>(square.x) + middle) * face.right +
                        (static_cast<float>(square.y) + middle) * face.down;
    const float side = face.pixel * static_cast<float>(square.side);
    place({center, face.normal, square.color, kWide * side, kThick * face.pixel,
           std::min(square.alpha, kMostOpaque)},
          i++, discs);
  }
}

}  // namespace

Gaussians face_splats(const Section& section, const Sphere& sphere, const Cut& cut, size_t most) {
  // Of the tolerance, each half as much again; beyond, coarser pixels show more.
  constexpr int kSteps = 6;
  constexpr int kCoarsest = 64;
  for (int coarser = 1;; coarser *= 2) {
    const std::vector<FacePicture> faces = pictures_of(section, sphere, cut, coarser);
    float tolerance = kFineColors;
    for (int step = 0; step < kSteps; ++step, tolerance *= 1.5f) {
      std::vector<std::vector<Square>> squares;
      size_t count = 0;
      for (const FacePicture& face : faces) {
        squares.push_back(std::move(Squares(face.colors, tolerance).found));
        count += squares.back().size();
      }
      if (count <= most || coarser == kCoarsest) {
        Gaussians discs(count, 0);
        size_t i = 0;
        for (size_t f = 0; f < faces.size(); ++f) {
          add_discs(faces[f], squares[f], i, discs);
        }
        return discs;
      }
    }
  }
}

}  // namespace clipgs
