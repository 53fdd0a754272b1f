#include "cinema/held_out.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace clipgs {

Vec3 view_of(const Frame& frame, const VisibleMatter& matter) {
  return glm::normalize(frame.camera.position - matter.sphere.center);
}

float plane_distance(const Plane& a, const Plane& b, const Sphere& sphere) {
  const auto apart = [&](const Plane& other) {
    return std::abs(a.signed_distance(sphere.center) - other.signed_distance(sphere.center)) +
           sphere.radius * glm::length(a.normal - other.normal);
  };
  return std::min(apart(b), apart(b.flipped()));
}

HeldOut::HeldOut(const VisibleMatter& matter, const Vec3& axis, bool mirrored, size_t views)
    : matter_(matter), axis_(axis), mirrored_(mirrored) {
  // A cap of angle a is (1 − cos a)/2 of the sphere.
  const float caps = static_cast<float>(views) * (mirrored ? 2.0f : 1.0f);
  least_cosine_ = std::max(std::cos(kLeastTurn), 1.0f - 1.0f / std::max(1.0f, caps));
}

void HeldOut::add(std::span<const Frame> frames) {
  for (const Frame& frame : frames) {
    directions_.push_back(view_of(frame, matter_));
    if (frame.plane) {
      planes_.push_back(*frame.plane);
    }
  }
}

bool HeldOut::near(const Vec3& direction) const {
  const Vec3 mirrored = direction - 2.0f * glm::dot(direction, axis_) * axis_;
  return std::ranges::any_of(directions_, [&](const Vec3& other) {
    return glm::dot(other, direction) > least_cosine_ ||
           (mirrored_ && glm::dot(other, mirrored) > least_cosine_);
  });
}

bool HeldOut::near(const Plane& plane) const {
  const Vec2 extent = matter_.extent(plane.normal);
  return std::ranges::any_of(planes_, [&](const Plane& other) {
    return plane_distance(plane, other, matter_.sphere) < kLeastStep * (extent.y - extent.x);
  });
}

std::vector<Vec3> HeldOut::spread_directions(int count, const Mat3& rotation) const {
  std::vector<Vec3> free;
  // A spiral of as many points that enough lie outside the caps.
  for (int points = count; std::ssize(free) < count;
       points += std::max<int>(1, count - static_cast<int>(free.size()))) {
    free.clear();
    for (int i = 0; i < points; ++i) {
      const Vec3 direction = rotation * fibonacci_sphere(i, points);
      if (!near(direction)) {
        free.push_back(direction);
      }
    }
  }
  std::vector<Vec3> directions;
  directions.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    directions.push_back(free[static_cast<size_t>(i) * free.size() / static_cast<size_t>(count)]);
  }
  return directions;
}

float HeldOut::free_height(const Vec2& range, float share) const {
  // Heights from the end of one window around a plane to the start of the next.
  const Vec2 extent = matter_.extent(axis_);
  std::vector<float> taken;
  for (const Plane& plane : planes_) {
    if (std::abs(glm::dot(plane.normal, axis_)) > 0.999999f) {
      const float offset = glm::dot(plane.normal, axis_) * plane.offset;
      taken.push_back((offset - extent.x) / (extent.y - extent.x));
    }
  }
  std::ranges::sort(taken);
  // A little more than the least step, whatever rounding does.
  constexpr float kWindow = kLeastStep * 1.001f;
  std::vector<Vec2> gaps;
  float begin = range.x;
  float total = 0;
  const auto add_gap = [&](float end) {
    if (end > begin) {
      gaps.emplace_back(begin, end);
      total += end - begin;
    }
  };
  for (const float height : taken) {
    add_gap(std::min(range.y, height - kWindow));
    begin = std::max(begin, height + kWindow);
  }
  add_gap(range.y);
  float left = share * total;
  for (const Vec2& gap : gaps) {
    if (left <= gap.y - gap.x) {
      return gap.x + left;
    }
    left -= gap.y - gap.x;
  }
  return gaps.empty() ? glm::mix(range.x, range.y, share) : gaps.back().y;
}

}  // namespace clipgs
