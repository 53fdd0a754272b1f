#pragma once

#include <optional>
#include <string>

#include "volume/bit_mask.h"
#include "volume/volume.h"

namespace clipgs {

/// Where the brain lies in a volume: a mask of blocks of about 2 mm, with a layer of blocks around
/// them that are none of the volume.
struct Brain {
  IVec3 dims{0};      ///< blocks along the volume's axes
  Vec3 spacing{1};    ///< mm between their middles
  Vec3 origin{0};     ///< RAS mm of the middle of block (0, 0, 0)
  Mat3 direction{1};  ///< as the volume's
  BitMask mask{0};    ///< x fastest
  /// What is no air or background, with what it encloses, and without what is thinner than 16 mm,
  /// as ears are.
  BitMask body{0};
  float ml = 0;
  /// To the head's right, to its front and its top: unit RAS directions, columns. The front is
  /// where the brain is long, seen from above and from the side.
  Mat3 head{1};
  Box bounds;       ///< mm along these directions
  float floor = 0;  ///< mm to the top: where the brain ends below at its front, in the middle

  /// RAS mm of the middle of a block.
  Vec3 place(size_t block) const;
};

/// The brain, or why there is none to be told, as the end of a sentence with what to do.
struct BrainSearch {
  std::optional<Brain> brain;
  std::string why_not;
};

/// Looks for the brain of a CT in HU, or else of an MR, whatever its contrast: of soft tissue that
/// stays when some millimetres are taken off every surface, in a CT the part that most bone lies
/// around, in an MR the largest part, of about the signal in the middle of the head. It is one only
/// if its size is a brain's, and in an MR if what lies around it is darker, with more around that,
/// and if it does not reach into the orbits; else there is none. The volume has no colours.
BrainSearch find_brain(const Volume& volume);

}  // namespace clipgs
