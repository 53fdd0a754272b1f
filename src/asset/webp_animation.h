#pragma once

#include <memory>

#include "asset/zip.h"
#include "core/image.h"

namespace clipgs {

/// Pictures shown one after the other, for ever. What is kept of each is its encoded change.
class WebpAnimation {
 public:
  /// `quality` 0 to 100.
  WebpAnimation(float frames_per_second, float quality);
  ~WebpAnimation();
  WebpAnimation(const WebpAnimation&) = delete;
  WebpAnimation& operator=(const WebpAnimation&) = delete;

  /// Adds a picture of 3 or 4 channels in [0, 1], which stays for so many pictures' time; all are
  /// of the first one's size. Throws Error.
  void add(const Image& picture, int times = 1);

  /// The file. Throws Error where nothing was added.
  Bytes finish();

 private:
  struct Encoder;

  double milliseconds_;  // a picture
  float quality_;
  int added_ = 0;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace clipgs
