#include "volume/deface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/distance.h"
#include "volume/identify.h"
#include "volume/matter.h"
#include "volume/padding.h"

namespace clipgs {
namespace {

// Of the face, mm from the front of the brain, and from its floor there.
constexpr float kFaceDepth = 40;    // the orbits' apex
constexpr float kAboveFloor = 20;   // eyebrows
constexpr float kBelowFloor = 140;  // chin

// Of the ears, mm behind the front of the brain, and from its floor there.
constexpr float kEarFrom = 60;
constexpr float kEarTo = 160;
constexpr float kEarAbove = 40;
constexpr float kEarBelow = 80;
constexpr float kOffBody = 2;  // mm; nearer is skin

constexpr double kLeastFace = 30;  // ml; a slab through the eyes has 70

constexpr const char* kNoFace =
    "next to nothing of a face is in it: the picture ends before, or the face was taken off; leave "
    "--deface out";
constexpr const char* kOtherPart =
    "there is no head in it, as its header or --region says; leave --deface out, or give --region "
    "head";

/// A CT shows its bones; of an MR what is said of it counts.
bool may_show_head(const Volume& volume) {
  constexpr std::array kParts = {BodyPart::kUnknown,     BodyPart::kHead, BodyPart::kJaw,
                                 BodyPart::kHeadAndNeck, BodyPart::kNeck, BodyPart::kSpine,
                                 BodyPart::kWholeBody};
  return volume.modality == Modality::kCt || std::ranges::count(kParts, volume.part) > 0;
}

double ml_of_voxel(const Volume& volume) {
  const Vec3& s = volume.spacing;
  return double{s.x} * s.y * s.z / 1000;
}

/// ml of matter in the face, by voxels about 2 mm apart.
double matter_within(const Face& face, const Volume& volume) {
  constexpr float kApart = 2;  // mm
  const IVec3 step = glm::max(IVec3(glm::round(kApart / volume.spacing)), IVec3(1));
  const float least = least_matter(volume);
  const auto slices = static_cast<size_t>((volume.dims.z + step.z - 1) / step.z);
  std::vector<size_t> counts(slices);
  parallel_for(slices, 1, [&](size_t slice, size_t) {
    const int z = static_cast<int>(slice) * step.z;
    for (int y = 0; y < volume.dims.y; y += step.y) {
      for (int x = 0; x < volume.dims.x; x += step.x) {
        counts[slice] +=
            volume.at(x, y, z) > least && face.holds(volume.world_from_index(Vec3(x, y, z))) ? 1
                                                                                             : 0;
      }
    }
  });
  size_t count = 0;
  for (const size_t one : counts) {
    count += one;
  }
  return static_cast<double>(count) * step.x * step.y * step.z * ml_of_voxel(volume);
}

/// Those voxels i of the face where may_be(i).
template <typename MayBe>
BitMask voxels_of(const Face& face, const Volume& volume, const MayBe& may_be) {
  BitMask voxels(volume.voxels());
  parallel_for(static_cast<size_t>(volume.dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < volume.dims.y; ++y) {
      const size_t row = volume.offset(0, y, static_cast<int>(z));
      voxels.fill(row, row + static_cast<size_t>(volume.dims.x), [&](size_t i) {
        return may_be(i) && face.holds(volume.world_from_index(Vec3(i - row, y, z)));
      });
    }
  });
  return voxels;
}

void require_head_scan(const Volume& volume, const std::string& where) {
  const bool mr = volume.modality == Modality::kMr || volume.modality == Modality::kUnknown;
  if (volume.modality != Modality::kCt && !mr) {
    throw Error("{}: --deface is for CT and MR, not for {}; leave it out", where,
                modality_name(volume.modality));
  }
  if (likely_rescale(volume)) {
    throw Error(
        "{}: --deface needs to know what its values mean; give --hu SCALE,OFFSET if it is CT (HU = "
        "SCALE * stored + OFFSET), or --modality mr",
        where);
  }
}

}  // namespace

Face::Face(const Brain& brain)
    : brain_(brain),
      corner_(0.5f * glm::length(brain.spacing)),
      from_brain_(distances_to(brain.dims, brain.spacing, brain.mask, kFromBrain + 4 * corner_)),
      from_body_(distances_to(brain.dims, brain.spacing, brain.body, kOffBody + 4 * corner_)) {}

bool Face::holds(const Vec3& ras) const {
  const Box& bounds = brain_.bounds;
  const Vec3 place = ras * brain_.head;
  const float from_front = place.y - bounds.max.y;
  const float from_floor = place.z - brain_.floor;
  const float beside = std::abs(place.x - bounds.center().x) - 0.5f * bounds.size().x;
  const bool in_face =
      from_front > -kFaceDepth && from_floor < kAboveFloor && from_floor > -kBelowFloor;
  const bool beside_head = beside > 0 && from_front > -kEarTo && from_front < -kEarFrom &&
                           from_floor < kEarAbove && from_floor > -kEarBelow;
  return (in_face || (beside_head && interpolated(from_body_, ras) > kOffBody)) &&
         interpolated(from_brain_, ras) >= kFromBrain + corner_;
}

float Face::interpolated(const std::vector<float>& field, const Vec3& ras) const {
  const Vec3 index = glm::clamp(((ras - brain_.origin) * brain_.direction) / brain_.spacing,
                                Vec3(0), Vec3(brain_.dims - 1));
  const IVec3 low = glm::min(IVec3(index), brain_.dims - 2);
  const Vec3 t = index - Vec3(low);
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const IVec3 step(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    const Vec3 weight = glm::mix(1.0f - t, t, Vec3(step));
    const IVec3 at = low + step;
    sum += weight.x * weight.y * weight.z *
           field[(static_cast<size_t>(at.z) * brain_.dims.y + at.y) * brain_.dims.x + at.x];
  }
  return sum;
}

FaceSearch find_face(const Volume& volume) {
  if (!may_show_head(volume)) {
    return {std::nullopt, kOtherPart};
  }
  const BrainSearch search = find_brain(volume);
  if (!search.brain) {
    return {std::nullopt, search.why_not};
  }
  Face face(*search.brain);
  if (matter_within(face, volume) < kLeastFace) {
    return {std::nullopt, kNoFace};
  }
  return {std::move(face), ""};
}

bool shows_face(const Volume& volume) {
  const bool scan = volume.modality == Modality::kCt || volume.modality == Modality::kMr ||
                    volume.modality == Modality::kUnknown;
  return scan && !likely_rescale(volume) && find_face(volume).face;
}

Face deface(Volume& volume, const std::string& where) {
  require_head_scan(volume, where);
  FaceSearch search = find_face(volume);
  if (!search.face) {
    throw Error("{}: --deface: {}", where, search.why_not);
  }
  const float least = least_matter(volume);
  const float nothing = volume.modality == Modality::kCt ? kAirHu : volume.values.range().min;
  const BitMask voxels =
      voxels_of(*search.face, volume, [&](size_t i) { return volume.values[i] != nothing; });
  size_t matter = 0;
  for (size_t i = voxels.next(0); i < voxels.size(); i = voxels.next(i + 1)) {
    matter += volume.values[i] > least ? 1 : 0;
  }
  volume.values.set_where(nothing, [&](size_t i) { return voxels[i]; });
  const auto ml = static_cast<float>(static_cast<double>(matter) * ml_of_voxel(volume));
  volume.defaced = Defaced{0.1f * std::round(10 * ml), Face::kFromBrain};
  return std::move(*search.face);
}

void deface_labels(Volume& volume, const Face& face) {
  const BitMask voxels = voxels_of(face, volume, [&](size_t i) { return volume.labels[i] != 0; });
  for (size_t i = voxels.next(0); i < voxels.size(); i = voxels.next(i + 1)) {
    volume.labels[i] = 0;
  }
}

}  // namespace clipgs
