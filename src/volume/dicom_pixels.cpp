#include "volume/dicom_pixels.h"

#include <span>

#include "core/error.h"

namespace clipgs {
namespace {

/// Whether what a header calls padding is none: a CT has tissue of these values, and would have
/// holes.
bool is_of_tissue(const DicomHeader& header, double stored) {
  constexpr double kLeast = -900;  // HU
  constexpr double kMost = 3000;
  const double hu = header.slope * stored + header.intercept;
  return header.modality == "CT" && hu > kLeast && hu < kMost;
}

/// `bytes` hold whole integers of bits_allocated; the bits above bits_stored mean nothing. Padding
/// becomes `fill`.
std::vector<float> convert_pixels(const DicomHeader& header, std::span<const std::uint8_t> bytes,
                                  bool big_endian, float fill) {
  const size_t width = static_cast<size_t>(header.bits_allocated) / 8;
  const StoredRange padding =
      is_of_tissue(header, header.padding.first) || is_of_tissue(header, header.padding.last)
          ? StoredRange()
          : header.padding;
  std::vector<float> values(static_cast<size_t>(header.columns) * header.rows);
  for (size_t i = 0; i < values.size(); ++i) {
    std::uint32_t stored = 0;
    for (size_t byte = 0; byte < width; ++byte) {
      stored |= std::uint32_t{bytes[i * width + byte]}
                << (8U * static_cast<unsigned>(big_endian ? width - 1 - byte : byte));
    }
    const double value = stored_number(header, stored);
    values[i] =
        padding.holds(value) ? fill : static_cast<float>(header.slope * value + header.intercept);
  }
  return values;
}

void require_supported(const DicomHeader& header) {
  if (header.samples != 1 || !header.photometric.starts_with("MONOCHROME")) {
    throw Error("{}: a colour image; store colour volumes as RGB .nrrd or .mha",
                header.source.name());
  }
  const bool whole_bytes =
      header.bits_allocated == 8 || header.bits_allocated == 16 || header.bits_allocated == 32;
  if (!whole_bytes || header.bits_stored < 1 || header.bits_stored > header.bits_allocated ||
      header.high_bit != header.bits_stored - 1) {
    throw Error("{}: pixels of {} bits in {}, the highest number {}, are not supported",
                header.source.name(), header.bits_stored, header.bits_allocated, header.high_bit);
  }
}

}  // namespace

struct DicomPixels::File {
  explicit File(const DicomSource& from)
      : source(from), bytes(from.read()), elements(bytes, from.name()) {
    elements.walk();
    headers = dicom_headers(elements, source);
  }

  DicomSource source;
  std::vector<std::uint8_t> bytes;
  DicomElements elements;
  std::vector<DicomHeader> headers;
};

DicomPixels::DicomPixels(float fill) : fill_(fill) {}
DicomPixels::~DicomPixels() = default;

std::vector<float> DicomPixels::read(const DicomHeader& known) {
  if (file_ == nullptr || file_->source != known.source) {
    file_ = std::make_unique<File>(known.source);
  }
  const DicomElements& elements = file_->elements;
  const auto frame = static_cast<size_t>(known.frame);
  if (frame >= file_->headers.size() || file_->headers[frame].rows != known.rows ||
      file_->headers[frame].columns != known.columns) {
    throw Error("{}: changed while it was read", known.source.name());
  }
  const DicomHeader& header = file_->headers[frame];
  require_supported(header);
  if (elements.encapsulated()) {
    const auto fragments = elements.fragments(frame, static_cast<size_t>(header.frames));
    const std::string pixels = decoder_.decode(header, fragments);
    return convert_pixels(header,
                          {reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size()},
                          false, fill_);
  }
  const size_t size =
      static_cast<size_t>(header.columns) * header.rows * (header.bits_allocated / 8);
  return convert_pixels(header, elements.pixels().subspan(frame * size, size),
                        elements.big_endian(), fill_);
}

}  // namespace clipgs
