#include "volume/dicom_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <span>

#include "core/error.h"
#include "volume/itk_reader.h"

namespace clipgs {
namespace {

constexpr size_t kPreamble = 128;
constexpr std::uint32_t kUndefinedLength = 0xffffffff;

constexpr std::uint32_t tag(std::uint32_t group, std::uint32_t element) {
  return group << 16U | element;
}

constexpr std::uint32_t kTransferSyntax = tag(0x0002, 0x0010);
constexpr std::uint32_t kImageType = tag(0x0008, 0x0008);
constexpr std::uint32_t kAcquisitionTime = tag(0x0008, 0x0032);
constexpr std::uint32_t kModality = tag(0x0008, 0x0060);
constexpr std::uint32_t kEchoTime = tag(0x0018, 0x0081);
constexpr std::uint32_t kTriggerTime = tag(0x0018, 0x1060);
constexpr std::uint32_t kBValue = tag(0x0018, 0x9087);
constexpr std::uint32_t kSeriesUid = tag(0x0020, 0x000e);
constexpr std::uint32_t kSeriesNumber = tag(0x0020, 0x0011);
constexpr std::uint32_t kAcquisitionNumber = tag(0x0020, 0x0012);
constexpr std::uint32_t kInstanceNumber = tag(0x0020, 0x0013);
constexpr std::uint32_t kPosition = tag(0x0020, 0x0032);
constexpr std::uint32_t kOrientation = tag(0x0020, 0x0037);
constexpr std::uint32_t kTemporalPosition = tag(0x0020, 0x0100);
constexpr std::uint32_t kTemporalIndex = tag(0x0020, 0x9128);
constexpr std::uint32_t kSamples = tag(0x0028, 0x0002);
constexpr std::uint32_t kFrames = tag(0x0028, 0x0008);
constexpr std::uint32_t kRows = tag(0x0028, 0x0010);
constexpr std::uint32_t kColumns = tag(0x0028, 0x0011);
constexpr std::uint32_t kPixelSpacing = tag(0x0028, 0x0030);
constexpr std::uint32_t kBitsAllocated = tag(0x0028, 0x0100);
constexpr std::uint32_t kPhotometric = tag(0x0028, 0x0004);
constexpr std::uint32_t kBitsStored = tag(0x0028, 0x0101);
constexpr std::uint32_t kRepresentation = tag(0x0028, 0x0103);
constexpr std::uint32_t kIntercept = tag(0x0028, 0x1052);
constexpr std::uint32_t kSlope = tag(0x0028, 0x1053);
constexpr std::uint32_t kPixelData = tag(0x7fe0, 0x0010);
constexpr std::uint32_t kItem = tag(0xfffe, 0xe000);
constexpr std::uint32_t kItemEnd = tag(0xfffe, 0xe00d);
constexpr std::uint32_t kSequenceEnd = tag(0xfffe, 0xe0dd);

/// The elements that we read; no other value leaves the file.
constexpr std::array kWanted{kTransferSyntax,   kImageType,
                             kAcquisitionTime,  kModality,
                             kEchoTime,         kTriggerTime,
                             kBValue,           kSeriesUid,
                             kSeriesNumber,     kAcquisitionNumber,
                             kInstanceNumber,   kPosition,
                             kOrientation,      kSamples,
                             kTemporalPosition, kTemporalIndex,
                             kFrames,           kRows,
                             kColumns,          kPixelSpacing,
                             kBitsAllocated,    kPhotometric,
                             kBitsStored,       kRepresentation,
                             kIntercept,        kSlope};

/// How a data set is encoded, as the transfer syntax says.
struct Encoding {
  bool explicit_vr = true;
  bool big_endian = false;
};

class Walker {
 public:
  Walker(std::span<const std::uint8_t> bytes, std::string name)
      : bytes_(bytes), name_(std::move(name)) {}

  void walk() {
    at_ = kPreamble + 4;
    while (at_ < bytes_.size() && peek_group() == 0x0002) {
      element(0);
    }
    encoding_ = encoding_of(text(kTransferSyntax));
    while (at_ < bytes_.size()) {
      element(0);
    }
  }

  std::string text(std::uint32_t wanted) const {
    const auto it = values_.find(wanted);
    if (it == values_.end()) {
      return "";
    }
    std::string value(it->second.begin(), it->second.end());
    while (!value.empty() && (value.back() == ' ' || value.back() == '\0')) {
      value.pop_back();
    }
    return value;
  }

  int unsigned_short(std::uint32_t wanted, int otherwise) const {
    const auto it = values_.find(wanted);
    if (it == values_.end() || it->second.size() < 2) {
      return otherwise;
    }
    return u16(it->second.data());
  }

  /// Of a 4-byte unsigned integer.
  std::optional<double> unsigned_long(std::uint32_t wanted) const {
    const auto it = values_.find(wanted);
    return it != values_.end() && it->second.size() == 4
               ? std::optional<double>(u32(it->second.data()))
               : std::nullopt;
  }

  /// Of an 8-byte float.
  std::optional<double> float64(std::uint32_t wanted) const {
    const auto it = values_.find(wanted);
    if (it == values_.end() || it->second.size() != 8) {
      return std::nullopt;
    }
    const std::uint64_t first = u32(it->second.data());
    const std::uint64_t second = u32(it->second.data() + 4);
    const auto number =
        std::bit_cast<double>(encoding_.big_endian ? first << 32U | second : second << 32U | first);
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
  }

  bool has_pixels() const { return has_pixels_; }
  bool encapsulated() const { return encapsulated_; }
  bool big_endian() const { return encoding_.big_endian; }
  /// The value of the pixel data element; encapsulated: all its items and the end of the sequence.
  std::span<const std::uint8_t> pixels() const { return pixels_; }

  [[noreturn]] void corrupt(const char* what) const {
    throw Error("{}: truncated or corrupt DICOM file ({} at byte {})", name_, what, at_);
  }

 private:
  Encoding encoding_of(const std::string& syntax) const {
    if (syntax == "1.2.840.10008.1.2") {
      return {false, false};
    }
    if (syntax == "1.2.840.10008.1.2.2") {
      return {true, true};
    }
    if (syntax == "1.2.840.10008.1.2.1.99") {
      throw Error("{}: deflated DICOM is not supported; export it uncompressed", name_);
    }
    return {true, false};
  }

  std::uint16_t u16(const std::uint8_t* p) const {
    return encoding_.big_endian ? static_cast<std::uint16_t>(p[0] << 8U | p[1])
                                : static_cast<std::uint16_t>(p[1] << 8U | p[0]);
  }

  std::uint32_t u32(const std::uint8_t* p) const {
    const std::uint32_t first = u16(p);
    const std::uint32_t second = u16(p + 2);
    return encoding_.big_endian ? first << 16U | second : second << 16U | first;
  }

  const std::uint8_t* take(size_t count) {
    if (count > bytes_.size() - at_) {
      corrupt("it ends too early");
    }
    const std::uint8_t* p = bytes_.data() + at_;
    at_ += count;
    return p;
  }

  std::uint32_t peek_group() {
    if (bytes_.size() - at_ < 8) {
      corrupt("it ends too early");
    }
    return u16(bytes_.data() + at_);
  }

  std::uint32_t take_tag() {
    const std::uint8_t* p = take(4);
    return tag(u16(p), u16(p + 2));
  }

  /// One data element, with all that is nested in it.
  void element(int depth) {
    const std::uint32_t which = take_tag();
    std::uint32_t length = 0;
    bool nested_explicit = encoding_.explicit_vr;
    if (encoding_.explicit_vr && which >> 16U != 0xfffe) {
      const std::uint8_t* vr = take(2);
      const std::string_view name(reinterpret_cast<const char*>(vr), 2);
      if (name[0] < 'A' || name[0] > 'Z' || name[1] < 'A' || name[1] > 'Z') {
        corrupt("an element without a type");
      }
      constexpr std::array<std::string_view, 13> kLong{"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                                       "UC", "UR", "UT", "UN", "SV", "UV"};
      if (std::ranges::find(kLong, name) != kLong.end()) {
        take(2);
        length = u32(take(4));
      } else {
        length = u16(take(2));
      }
      nested_explicit = name != "UN";  // PS3.5 6.2.2: unknown sequences are implicit
    } else {
      length = u32(take(4));
    }
    if (length != kUndefinedLength) {
      keep(which, length, depth);
    } else if (which == kPixelData) {
      const size_t start = at_;
      fragments();
      if (depth == 0) {
        has_pixels_ = true;
        encapsulated_ = true;
        pixels_ = bytes_.subspan(start, at_ - start);
      }
    } else {
      sequence(depth, nested_explicit);
    }
  }

  void keep(std::uint32_t which, std::uint32_t length, int depth) {
    const std::uint8_t* value = take(length);
    if (depth > 0) {
      return;
    }
    if (which == kPixelData) {
      has_pixels_ = true;
      pixels_ = {value, length};
    } else if (std::ranges::find(kWanted, which) != kWanted.end()) {
      values_[which] = {value, length};
    }
  }

  /// Encapsulated pixels: items of bytes up to the end of the sequence.
  void fragments() {
    for (;;) {
      const std::uint32_t which = take_tag();
      const std::uint32_t length = u32(take(4));
      if (which == kSequenceEnd) {
        return;
      }
      if (which != kItem || length == kUndefinedLength) {
        corrupt("a broken item of compressed pixels");
      }
      take(length);
    }
  }

  void sequence(int depth, bool explicit_vr) {
    constexpr int kDeepest = 32;
    if (depth >= kDeepest) {
      corrupt("sequences nested too deep");
    }
    const bool outer = encoding_.explicit_vr;
    encoding_.explicit_vr = explicit_vr;
    for (;;) {
      const std::uint32_t which = take_tag();
      const std::uint32_t length = u32(take(4));
      if (which == kSequenceEnd) {
        break;
      }
      if (which != kItem) {
        corrupt("a broken sequence");
      }
      if (length != kUndefinedLength) {
        take(length);
      } else {
        item(depth);
      }
    }
    encoding_.explicit_vr = outer;
  }

  void item(int depth) {
    for (;;) {
      const size_t start = at_;
      if (take_tag() == kItemEnd) {
        take(4);
        return;
      }
      at_ = start;
      element(depth + 1);
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::string name_;
  size_t at_ = 0;
  Encoding encoding_;
  std::map<std::uint32_t, std::span<const std::uint8_t>> values_;
  std::span<const std::uint8_t> pixels_;
  bool has_pixels_ = false;
  bool encapsulated_ = false;
};

/// The numbers of a backslash-separated string; false if it does not hold N.
template <size_t N>
bool parse_numbers(const std::string& text, std::array<double, N>& numbers) {
  const char* at = text.c_str();
  for (double& number : numbers) {
    char* end = nullptr;
    number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number) || std::abs(number) > 1e9) {
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

/// Seconds of "HHMMSS.FFFFFF", of which the last parts may lack.
std::optional<double> parse_time(const std::string& text) {
  const size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  if (digits < 6) {
    return std::nullopt;
  }
  return 3600 * parse_double(text.substr(0, 2), 0) + 60 * parse_double(text.substr(2, 2), 0) +
         parse_double(text.substr(4), 0);
}

DicomMarks marks_of(const Walker& walker) {
  DicomMarks marks;
  marks.temporal_position = parse_optional(walker.text(kTemporalPosition));
  marks.temporal_index = walker.unsigned_long(kTemporalIndex);
  marks.trigger_ms = parse_optional(walker.text(kTriggerTime));
  marks.echo_ms = parse_optional(walker.text(kEchoTime));
  marks.b_value = walker.float64(kBValue);
  marks.acquisition = parse_optional(walker.text(kAcquisitionNumber));
  marks.acquired_s = parse_time(walker.text(kAcquisitionTime));
  marks.image_type = printable(walker.text(kImageType));
  return marks;
}

DicomHeader header_of(const Walker& walker, const DicomSource& source) {
  DicomHeader header;
  header.source = source;
  header.series_uid = walker.text(kSeriesUid);
  header.modality = walker.text(kModality);
  header.series_number = parse_int(walker.text(kSeriesNumber), 0);
  header.instance = parse_int(walker.text(kInstanceNumber), 0);
  header.columns = walker.unsigned_short(kColumns, 0);
  header.rows = walker.unsigned_short(kRows, 0);
  header.frames = std::max(parse_int(walker.text(kFrames), 1), 1);
  header.marks = marks_of(walker);
  header.transfer_syntax = walker.text(kTransferSyntax);
  header.photometric = walker.text(kPhotometric);
  header.samples = walker.unsigned_short(kSamples, 1);
  header.bits_allocated = walker.unsigned_short(kBitsAllocated, 16);
  header.bits_stored = walker.unsigned_short(kBitsStored, header.bits_allocated);
  header.is_signed = walker.unsigned_short(kRepresentation, 0) == 1;
  header.slope = parse_double(walker.text(kSlope), 1);
  header.intercept = parse_double(walker.text(kIntercept), 0);
  std::array<double, 3> position{};
  std::array<double, 6> o{};
  std::array<double, 2> spacing{};  // between rows first, then between columns
  header.placed = parse_numbers(walker.text(kPosition), position) &&
                  parse_numbers(walker.text(kOrientation), o) &&
                  parse_numbers(walker.text(kPixelSpacing), spacing) && spacing[0] > 0 &&
                  spacing[1] > 0;
  if (header.placed) {
    header.position = {position[0], position[1], position[2]};
    header.row = {o[0], o[1], o[2]};
    header.column = {o[3], o[4], o[5]};
    header.pixel_spacing = {spacing[1], spacing[0]};
  }
  return header;
}

void require_all_pixels(const Walker& walker, const DicomHeader& header) {
  const std::uint64_t bits = static_cast<std::uint64_t>(header.columns) * header.rows *
                             header.frames * header.samples * header.bits_allocated;
  if (!walker.encapsulated() && walker.pixels().size() < bits / 8) {
    throw Error("{}: truncated or corrupt DICOM file: {} bytes of pixels where {} are due",
                header.source.name(), walker.pixels().size(), bits / 8);
  }
}

DicomHeader checked_header(const Walker& walker, const DicomSource& source) {
  DicomHeader header = header_of(walker, source);
  if (header.rows == 0 || header.columns == 0) {
    walker.corrupt("pixels without a size");
  }
  require_all_pixels(walker, header);
  return header;
}

/// `bytes` hold whole integers of bits_allocated; the bits above bits_stored mean nothing.
std::vector<float> convert_pixels(const DicomHeader& header, std::span<const std::uint8_t> bytes,
                                  bool big_endian) {
  const size_t width = static_cast<size_t>(header.bits_allocated) / 8;
  const auto unused = static_cast<unsigned>(32 - header.bits_stored);
  std::vector<float> values(static_cast<size_t>(header.columns) * header.rows);
  for (size_t i = 0; i < values.size(); ++i) {
    std::uint32_t stored = 0;
    for (size_t byte = 0; byte < width; ++byte) {
      stored |= std::uint32_t{bytes[i * width + byte]}
                << (8U * static_cast<unsigned>(big_endian ? width - 1 - byte : byte));
    }
    stored <<= unused;
    const double value = header.is_signed ? static_cast<std::int32_t>(stored) >> unused
                                          : static_cast<double>(stored >> unused);
    values[i] = static_cast<float>(header.slope * value + header.intercept);
  }
  return values;
}

/// What walking the file finds: nothing for a file without an image.
std::optional<DicomHeader> walked_header(Walker& walker, const DicomSource& source) {
  walker.walk();
  if (!walker.has_pixels()) {
    return std::nullopt;
  }
  return checked_header(walker, source);
}

}  // namespace

std::optional<DicomHeader> read_dicom_header(const DicomSource& source) {
  const std::vector<std::uint8_t> bytes = source.read();
  Walker walker(bytes, source.name());
  return walked_header(walker, source);
}

std::vector<float> read_dicom_pixels(const DicomHeader& known) {
  const std::vector<std::uint8_t> bytes = known.source.read();
  Walker walker(bytes, known.source.name());
  walker.walk();
  const DicomHeader header = checked_header(walker, known.source);
  if (header.rows != known.rows || header.columns != known.columns || header.frames != 1) {
    throw Error("{}: changed while it was read", known.source.name());
  }
  if (header.samples != 1 || !header.photometric.starts_with("MONOCHROME")) {
    throw Error("{}: a colour image; store colour volumes as RGB .nrrd or .mha",
                header.source.name());
  }
  const bool whole_bytes =
      header.bits_allocated == 8 || header.bits_allocated == 16 || header.bits_allocated == 32;
  if (!whole_bytes || header.bits_stored < 1 || header.bits_stored > header.bits_allocated) {
    throw Error("{}: pixels of {} bits in {} are not supported", header.source.name(),
                header.bits_stored, header.bits_allocated);
  }
  if (!walker.encapsulated()) {
    return convert_pixels(header, walker.pixels(), walker.big_endian());
  }
  return convert_pixels(header, decode_dicom_pixels(header, walker.pixels()), false);
}

DicomScan scan_dicom(const std::vector<DicomSource>& sources) {
  DicomScan scan;
  for (const DicomSource& source : sources) {
    std::string series_uid;
    try {
      const std::vector<std::uint8_t> bytes = source.read();
      Walker walker(bytes, source.name());
      try {
        if (std::optional<DicomHeader> header = walked_header(walker, source)) {
          scan.images.push_back(std::move(*header));
        }
      } catch (const Error&) {
        series_uid = walker.text(kSeriesUid);
        throw;
      }
    } catch (const Error& e) {
      scan.unreadable.push_back({source, series_uid, e.what()});
    }
  }
  return scan;
}

}  // namespace clipgs
