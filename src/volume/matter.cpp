#include "volume/matter.h"

#include "volume/histogram.h"
#include "volume/isolate_body.h"

namespace clipgs {

float least_matter(const Volume& volume) {
  return volume.modality == Modality::kCt ? kLeastMatter : least_signal(histogram(volume));
}

}  // namespace clipgs
