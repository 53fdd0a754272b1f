#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asset/webp.h"
#include "asset/zip.h"
#include "core/json_reader.h"
#include "section/section.h"

namespace clipgs {

/// Quality at which nothing of a section's voxels is lost.
constexpr float kLossless = 100;

/// A section's voxels as a file of a case.
struct CodedSlices {
  ZipEntry file;
  nlohmann::json keys;               ///< what the section's JSON says of how they lie in it
  bool video = false;                ///< frames of a video, or else one image
  std::vector<std::uint8_t> voxels;  ///< as they are read back
};

/// By ever lower qualities, what a section's slices of constant z are: below kLossless a video
/// (AV1), in which a slice is told by those beside it, and takes a third of what it takes in an
/// image that is as good; photographs, lossless sections and those that are wanted soon (`kTime`)
/// one image of all slices (WebP). Throws Error.
CodedSlices encode_slices(const Section& section, float quality, Saving saving);

/// The same as one of the two, whatever that is good for: a video of a section of one channel.
CodedSlices as_video(const Section& section, float quality);
CodedSlices as_image(const Section& section, float quality, Saving saving);

/// The voxels of `file` for a section of these dims and channels, by the keys that `reader` has.
/// Throws Error, `name` in it, on whatever is out of range, undecodable or of another size.
std::vector<std::uint8_t> decode_slices(const JsonReader& reader, const Bytes& file,
                                        const IVec3& dims, int channels, const std::string& name);

/// Whether such a section is coded as video.
bool is_video(const Section& section, float quality, Saving saving);

}  // namespace clipgs
