#include "cinema/traced_volume.h"

#include "volume/upsample.h"

namespace clipgs {

const Volume& TracedVolume::traced() {
  if (!finer_ || !can_be_upsampled(scanned_)) {
    return scanned_;
  }
  if (!fine_) {
    fine_ = upsample(scanned_, preset_.transfer);
  }
  return *fine_;
}

}  // namespace clipgs
