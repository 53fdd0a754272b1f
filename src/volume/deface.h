#pragma once

#include <optional>
#include <string>
#include <vector>

#include "volume/brain.h"
#include "volume/volume.h"

namespace clipgs {

/// The face of a head, and its ears, as places in the patient. The face is a box in front of, and
/// below, the front of the brain: eyes, nose, mouth, cheeks and chin, and not the throat. What is
/// near the brain is of neither.
class Face {
 public:
  static constexpr float kFromBrain = 5;  ///< mm around every block of the brain that are not of it

  explicit Face(const Brain& brain);

  bool holds(const Vec3& ras) const;

 private:
  float interpolated(const std::vector<float>& field, const Vec3& ras) const;

  Brain brain_;
  float corner_;                   // mm from the middle of a block to its corners
  std::vector<float> from_brain_;  // mm, of the middles of blocks
  std::vector<float> from_body_;
};

/// The face, or why there is none, as the end of a sentence with what to do.
struct FaceSearch {
  std::optional<Face> face;
  std::string why_not;
};

/// Looks at a CT in HU, or at an MR, or what may be one; costs less than a second. There is a face
/// if at least 30 ml of matter are within it.
FaceSearch find_face(const Volume& volume);

/// Whether find_face() finds one, in a volume of any kind.
bool shows_face(const Volume& volume);

/// Sets the face to air (−1024 HU) or, in an MR, to the lowest value that there is, and says in
/// Volume::defaced what went. Throws Error, which begins with `where`, for what is neither CT nor
/// MR, and where there is no face, or none is told for sure: then nothing changes.
Face deface(Volume& volume, const std::string& where);

/// Takes labels off the face as well.
void deface_labels(Volume& volume, const Face& face);

}  // namespace clipgs
