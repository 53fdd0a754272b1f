#include "volume/dicom_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "core/error.h"
#include "volume/dicom_elements.h"

namespace clipgs {
namespace {

constexpr int kMostSamples = 4;
constexpr int kMostBits = 64;

/// The numbers of a backslash-separated string; false if it does not hold so many.
bool parse_numbers(const std::string& text, std::span<double> numbers) {
  const char* at = text.c_str();
  for (double& number : numbers) {
    char* end = nullptr;
    number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number) || std::abs(number) > 1e9) {
      return false;
    }
    end += std::strspn(end, " ");  // each may be padded
    if (*end != '\\' && *end != '\0') {
      return false;
    }
    at = *end == '\\' ? end + 1 : end;
  }
  return true;
}

/// Without what a terminal would obey, and not too long to be said.
std::string printable(std::string text) {
  constexpr size_t kLongest = 64;
  text.resize(std::min(text.size(), kLongest));
  std::ranges::replace_if(text, [](char c) { return c < 0x20 || c > 0x7e; }, '?');
  return text;
}

double parse_double(const std::string& text, double otherwise) {
  std::array<double, 1> number{};
  return parse_numbers(text, number) ? number[0] : otherwise;
}

int parse_int(const std::string& text, int otherwise) {
  return static_cast<int>(parse_double(text, otherwise));
}

std::optional<double> parse_optional(const std::string& text) {
  std::array<double, 1> number{};
  return parse_numbers(text, number) ? std::optional(number[0]) : std::nullopt;
}

/// `otherwise` where the file says nothing; what it says has to be a number.
double require_double(const DicomElements& elements, DicomTag tag, size_t frame, double otherwise,
                      const char* what) {
  const std::string text = elements.text(tag, frame);
  const std::optional<double> number = parse_optional(text);
  if (!text.empty() && !number) {
    elements.corrupt(what);
  }
  return number.value_or(otherwise);
}

/// Seconds of "HHMMSS.FFFFFF", of which the last parts may lack.
std::optional<double> parse_time(const std::string& text) {
  const size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  if (digits < 6) {
    return std::nullopt;
  }
  return 3600 * parse_double(text.substr(0, 2), 0) + 60 * parse_double(text.substr(2, 2), 0) +
         parse_double(text.substr(4), 0);
}

DicomMarks marks_of(const DicomElements& elements, size_t frame) {
  using Tag = DicomTag;
  const auto decimal = [&](Tag tag) { return parse_optional(elements.text(tag, frame)); };
  const auto either = [](std::optional<double> first, std::optional<double> second) {
    return first ? first : second;
  };
  DicomMarks marks;
  marks.temporal_position = decimal(Tag::kTemporalPosition);
  marks.temporal_index = elements.unsigned_long(Tag::kTemporalIndex, frame);
  marks.trigger_ms =
      either(elements.float64(Tag::kTriggerDelay, frame), decimal(Tag::kTriggerTime));
  marks.echo_ms = either(elements.float64(Tag::kEffectiveEchoTime, frame), decimal(Tag::kEchoTime));
  marks.b_value = elements.float64(Tag::kBValue, frame);
  marks.acquisition = either(elements.unsigned_short(Tag::kFrameAcquisition, frame),
                             decimal(Tag::kAcquisitionNumber));
  const std::string moment = elements.text(Tag::kFrameTime, frame);  // YYYYMMDDHHMMSS
  constexpr size_t kDate = 8;
  marks.acquired_s = parse_time(moment.size() > kDate ? moment.substr(kDate)
                                                      : elements.text(Tag::kAcquisitionTime));
  const std::string type = elements.text(Tag::kFrameType, frame);
  marks.image_type = printable(type.empty() ? elements.text(Tag::kImageType) : type);
  return marks;
}

Hints hints_of(const DicomElements& elements, size_t frame) {
  Hints hints;
  hints.learn_modality(elements.text(DicomTag::kModality));
  hints.learn_part(elements.text(DicomTag::kBodyPart, frame));
  hints.learn_words(elements.text(DicomTag::kSeriesDescription));
  hints.learn_agent(elements.text(DicomTag::kContrastAgent, frame));
  return hints;
}

/// Where the frame lies, as far as the file says so in full.
void place(const DicomElements& elements, DicomHeader& header) {
  std::array<double, 3> position{};
  std::array<double, 6> o{};
  std::array<double, 2> spacing{};  // between rows first, then between columns
  const auto frame = static_cast<size_t>(header.frame);
  header.placed = parse_numbers(elements.text(DicomTag::kPosition, frame), position) &&
                  parse_numbers(elements.text(DicomTag::kOrientation, frame), o) &&
                  parse_numbers(elements.text(DicomTag::kPixelSpacing, frame), spacing) &&
                  spacing[0] > 0 && spacing[1] > 0;
  if (header.placed) {
    header.position = {position[0], position[1], position[2]};
    header.row = {o[0], o[1], o[2]};
    header.column = {o[3], o[4], o[5]};
    header.pixel_spacing = {spacing[1], spacing[0]};
  }
}

StoredRange padding_of(const DicomElements& elements, const DicomHeader& header) {
  const std::optional<int> first = elements.unsigned_short(DicomTag::kPadding);
  if (!first || header.bits_allocated > 16 || header.bits_stored < 1 || header.bits_stored > 16) {
    return {};
  }
  const int last = elements.unsigned_short(DicomTag::kPaddingLimit).value_or(*first);
  const double one = stored_number(header, static_cast<std::uint32_t>(*first));
  const double other = stored_number(header, static_cast<std::uint32_t>(last));
  return {std::min(one, other), std::max(one, other)};
}

DicomHeader header_of(const DicomElements& elements, const DicomSource& source, int frame) {
  const auto at = static_cast<size_t>(frame);
  const auto whole = [&](DicomTag tag, int otherwise) {
    return elements.unsigned_short(tag).value_or(otherwise);
  };
  DicomHeader header;
  header.source = source;
  header.frame = frame;
  header.frames = std::max(parse_int(elements.text(DicomTag::kFrames), 1), 1);
  header.series_uid = printable(elements.text(DicomTag::kSeriesUid));
  header.modality = printable(elements.text(DicomTag::kModality));
  header.series_number = parse_int(elements.text(DicomTag::kSeriesNumber), 0);
  header.instance =
      header.frames > 1 ? frame + 1 : parse_int(elements.text(DicomTag::kInstanceNumber), 0);
  header.columns = whole(DicomTag::kColumns, 0);
  header.rows = whole(DicomTag::kRows, 0);
  header.marks = marks_of(elements, at);
  header.hints = hints_of(elements, at);
  header.transfer_syntax = printable(elements.text(DicomTag::kTransferSyntax));
  header.photometric = printable(elements.text(DicomTag::kPhotometric));
  header.samples = whole(DicomTag::kSamples, 1);
  header.bits_allocated = whole(DicomTag::kBitsAllocated, 16);
  header.bits_stored = whole(DicomTag::kBitsStored, header.bits_allocated);
  header.is_signed = whole(DicomTag::kRepresentation, 0) == 1;
  header.high_bit = whole(DicomTag::kHighBit, header.bits_stored - 1);
  header.padding = padding_of(elements, header);
  header.slope =
      require_double(elements, DicomTag::kSlope, at, 1, "a Rescale Slope that is no number");
  header.intercept = require_double(elements, DicomTag::kIntercept, at, 0,
                                    "a Rescale Intercept that is no number");
  if (header.modality == "RTDOSE") {
    header.slope = require_double(elements, DicomTag::kDoseScaling, at, 1,
                                  "a Dose Grid Scaling that is no number");
  }
  place(elements, header);
  return header;
}

/// mm along the normal from the first of `frames` frames to each, where one distance or a list of
/// them says so (nuclear medicine, dose); empty where nothing does.
std::vector<double> frame_offsets(const DicomElements& elements, int frames) {
  std::vector<double> offsets(static_cast<size_t>(frames));
  const std::string list = elements.text(DicomTag::kFrameOffsets);
  // What counts the frames, where the file says so, has to be the slices (54,80): of a gated or
  // dynamic series it is time as well, and one distance says nothing of where they lie.
  const double slice_vector = elements.big_endian() ? 0x00540080 : 0x00800054;
  const std::optional<double> counted = elements.unsigned_long(DicomTag::kFrameIncrement);
  if (list.empty()) {
    const bool by_slices = !counted || *counted == slice_vector;
    const double step =
        by_slices ? parse_double(elements.text(DicomTag::kSpacingBetweenSlices), 0) : 0;
    for (size_t i = 0; i < offsets.size(); ++i) {
      offsets[i] = step * static_cast<double>(i);
    }
    return step == 0 ? std::vector<double>() : offsets;
  }
  if (!parse_numbers(list, offsets)) {
    return {};
  }
  const double first = offsets.front();
  std::ranges::for_each(offsets, [&](double& offset) { offset -= first; });
  return offsets;
}

/// All frames of a file that says of each where it lies; else the first, without a place.
std::vector<DicomHeader> headers_of_frames(const DicomElements& elements, const DicomSource& source,
                                           int frames) {
  const size_t described = elements.described_frames();
  if (described != 0 && described != static_cast<size_t>(frames)) {
    throw Error("{}: truncated or corrupt DICOM file: {} frames, of which {} are described",
                source.name(), frames, described);
  }
  const std::vector<double> offsets =
      described == 0 ? frame_offsets(elements, frames) : std::vector<double>(described, 0.0);
  std::vector<DicomHeader> headers;
  for (int frame = 0; frame < static_cast<int>(offsets.size()); ++frame) {
    DicomHeader header = header_of(elements, source, frame);
    header.position += glm::cross(header.row, header.column) * offsets[static_cast<size_t>(frame)];
    headers.push_back(std::move(header));
  }
  if (headers.empty()) {
    headers.push_back(header_of(elements, source, 0));
    headers.front().placed = false;
  }
  return headers;
}

void require_sane_pixels(const DicomElements& elements, const DicomHeader& header) {
  if (header.rows == 0 || header.columns == 0) {
    elements.corrupt("pixels without a size");
  }
  if (header.frames > DicomElements::kMostFrames || header.samples > kMostSamples ||
      header.bits_allocated > kMostBits) {
    elements.corrupt("frames, samples or bits beyond all reason");
  }
  const std::uint64_t bits = static_cast<std::uint64_t>(header.columns) * header.rows *
                             header.frames * header.samples * header.bits_allocated;
  if (!elements.encapsulated() && elements.pixels().size() < bits / 8) {
    throw Error("{}: truncated or corrupt DICOM file: {} bytes of pixels where {} are due",
                header.source.name(), elements.pixels().size(), bits / 8);
  }
}

}  // namespace

double stored_number(const DicomHeader& header, std::uint32_t bits) {
  const auto unused = static_cast<unsigned>(32 - header.bits_stored);
  bits <<= unused;
  return header.is_signed ? static_cast<std::int32_t>(bits) >> unused
                          : static_cast<double>(bits >> unused);
}

std::vector<DicomHeader> dicom_headers(const DicomElements& elements, const DicomSource& source) {
  if (!elements.has_pixels()) {
    return {};
  }
  DicomHeader first = header_of(elements, source, 0);
  require_sane_pixels(elements, first);
  if (first.frames == 1) {
    return {std::move(first)};
  }
  return headers_of_frames(elements, source, first.frames);
}

std::vector<DicomHeader> read_dicom_headers(const DicomSource& source) {
  const std::vector<std::uint8_t> bytes = source.read();
  DicomElements elements(bytes, source.name());
  elements.walk();
  return dicom_headers(elements, source);
}

DicomScan scan_dicom(const std::vector<DicomSource>& sources) {
  constexpr size_t kMostImages = 1 << 20;  // a few bytes may promise many
  DicomScan scan;
  for (const DicomSource& source : sources) {
    if (scan.images.size() > kMostImages) {
      throw Error("{}: more than 2^20 images up to here; give the folder of one study",
                  source.name());
    }
    std::string series_uid;
    try {
      const std::vector<std::uint8_t> bytes = source.read();
      DicomElements elements(bytes, source.name());
      try {
        elements.walk();
        std::ranges::move(dicom_headers(elements, source), std::back_inserter(scan.images));
      } catch (const Error&) {
        series_uid = printable(elements.text(DicomTag::kSeriesUid));
        throw;
      }
    } catch (const Error& e) {
      scan.unreadable.push_back({source, series_uid, e.what()});
    }
  }
  return scan;
}

}  // namespace clipgs
