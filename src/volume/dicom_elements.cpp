#include "volume/dicom_elements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string_view>

#include "core/error.h"

namespace clipgs {
namespace {

constexpr size_t kPreamble = 128;
constexpr std::uint32_t kUndefinedLength = 0xffffffff;
constexpr size_t kItemHead = 8;  // bytes: tag and length

constexpr std::uint32_t kPixelData = 0x7fe00010;
constexpr std::uint32_t kItem = 0xfffee000;
constexpr std::uint32_t kItemEnd = 0xfffee00d;
constexpr std::uint32_t kSequenceEnd = 0xfffee0dd;

constexpr std::uint32_t kSharedGroups = 0x52009229;
constexpr std::uint32_t kPerFrameGroups = 0x52009230;
constexpr std::uint32_t kDetectorInformation = 0x00540022;  // where nuclear medicine has the place

/// The sequences in functional groups that hold elements that we read.
constexpr std::array<std::uint32_t, 10> kMacros{
    0x00189114,  // MR echo
    0x00189117,  // MR diffusion
    0x00189118,  // cardiac synchronization
    0x00189226,  // MR image frame type
    0x00189329,  // CT image frame type
    0x00209111,  // frame content
    0x00209113,  // plane position
    0x00209116,  // plane orientation
    0x00289110,  // pixel measures
    0x00289145,  // pixel value transformation
};

bool is_wanted(std::uint32_t which) {
  switch (static_cast<DicomTag>(which)) {
    case DicomTag::kTransferSyntax:
    case DicomTag::kImageType:
    case DicomTag::kInstanceUid:
    case DicomTag::kAcquisitionTime:
    case DicomTag::kModality:
    case DicomTag::kSeriesDescription:
    case DicomTag::kFrameType:
    case DicomTag::kPatientId:
    case DicomTag::kContrastAgent:
    case DicomTag::kBodyPart:
    case DicomTag::kEchoTime:
    case DicomTag::kSpacingBetweenSlices:
    case DicomTag::kTriggerTime:
    case DicomTag::kFrameTime:
    case DicomTag::kEffectiveEchoTime:
    case DicomTag::kBValue:
    case DicomTag::kSeriesUid:
    case DicomTag::kSeriesNumber:
    case DicomTag::kAcquisitionNumber:
    case DicomTag::kInstanceNumber:
    case DicomTag::kPosition:
    case DicomTag::kOrientation:
    case DicomTag::kTemporalPosition:
    case DicomTag::kTemporalIndex:
    case DicomTag::kTriggerDelay:
    case DicomTag::kFrameAcquisition:
    case DicomTag::kSamples:
    case DicomTag::kPhotometric:
    case DicomTag::kFrames:
    case DicomTag::kFrameIncrement:
    case DicomTag::kRows:
    case DicomTag::kColumns:
    case DicomTag::kPixelSpacing:
    case DicomTag::kBitsAllocated:
    case DicomTag::kBitsStored:
    case DicomTag::kHighBit:
    case DicomTag::kRepresentation:
    case DicomTag::kPadding:
    case DicomTag::kPaddingLimit:
    case DicomTag::kIntercept:
    case DicomTag::kSlope:
    case DicomTag::kFrameOffsets:
    case DicomTag::kDoseScaling:
      return true;
  }
  return false;
}

}  // namespace

void DicomElements::walk() {
  constexpr Scope kFile{Level::kFile, false};
  at_ = kPreamble + 4;
  if (bytes_.size() < at_) {
    corrupt("an empty or cut-off beginning");
  }
  while (at_ < bytes_.size() && peek_group() == 0x0002) {
    element(0, kFile);
  }
  encoding_ = encoding_of(text(DicomTag::kTransferSyntax));
  while (at_ < bytes_.size()) {
    element(0, kFile);
  }
}

const DicomElements::Bytes* DicomElements::find(DicomTag wanted, size_t frame) const {
  const Values* const own = frame < per_frame_.size() ? &per_frame_[frame] : nullptr;
  for (const Values* values : {own, &of_all_frames_, &of_file_}) {
    if (values != nullptr) {
      if (const auto found = values->find(wanted); found != values->end()) {
        return &found->second;
      }
    }
  }
  return nullptr;
}

std::string DicomElements::text(DicomTag wanted, size_t frame) const {
  const Bytes* const bytes = find(wanted, frame);
  if (bytes == nullptr) {
    return "";
  }
  std::string value(bytes->begin(), bytes->end());
  while (!value.empty() && (value.back() == ' ' || value.back() == '\0')) {
    value.pop_back();
  }
  return value;
}

std::optional<int> DicomElements::unsigned_short(DicomTag wanted, size_t frame) const {
  const Bytes* const bytes = find(wanted, frame);
  return bytes != nullptr && bytes->size() >= 2 ? std::optional<int>(u16(bytes->data()))
                                                : std::nullopt;
}

std::optional<double> DicomElements::unsigned_long(DicomTag wanted, size_t frame) const {
  const Bytes* const bytes = find(wanted, frame);
  return bytes != nullptr && bytes->size() == 4 ? std::optional<double>(u32(bytes->data()))
                                                : std::nullopt;
}

std::optional<double> DicomElements::float64(DicomTag wanted, size_t frame) const {
  const Bytes* const bytes = find(wanted, frame);
  if (bytes == nullptr || bytes->size() != 8) {
    return std::nullopt;
  }
  const auto number = std::bit_cast<double>(u64(bytes->data()));
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::vector<std::span<const std::uint8_t>> DicomElements::fragments(size_t frame,
                                                                    size_t frames) const {
  if (fragments_.size() < 1 + frames) {
    corrupt("fewer pieces of compressed pixels than frames");
  }
  const auto first = fragments_.begin() + 1;
  if (frames == 1) {
    return {first, fragments_.end()};
  }
  if (fragments_.size() == 1 + frames) {
    return {first[static_cast<std::ptrdiff_t>(frame)]};
  }
  const Bytes table = fragments_.front();
  if (table.size() != 4 * frames) {
    throw Error("{}: its compressed frames come in pieces, and it does not say which are whose",
                name_);
  }
  // From the beginning of the first item to that of the frame's first.
  const std::uint8_t* const begin = first->data() - kItemHead;
  const std::uint64_t from = u32(&table[4 * frame]);
  const std::uint64_t to = frame + 1 < frames ? u32(&table[4 * (frame + 1)]) : UINT64_MAX;
  std::vector<Bytes> pieces;
  for (auto piece = first; piece != fragments_.end(); ++piece) {
    const auto offset = static_cast<std::uint64_t>(piece->data() - kItemHead - begin);
    if (offset >= from && offset < to) {
      pieces.push_back(*piece);
    }
  }
  return pieces;
}

void DicomElements::corrupt(const char* what) const {
  throw Error("{}: truncated or corrupt DICOM file ({} at byte {})", name_, what, at_);
}

DicomElements::Encoding DicomElements::encoding_of(const std::string& syntax) const {
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

std::uint16_t DicomElements::u16(const std::uint8_t* p) const {
  return encoding_.big_endian ? static_cast<std::uint16_t>(p[0] << 8U | p[1])
                              : static_cast<std::uint16_t>(p[1] << 8U | p[0]);
}

std::uint32_t DicomElements::u32(const std::uint8_t* p) const {
  const std::uint32_t first = u16(p);
  const std::uint32_t second = u16(p + 2);
  return encoding_.big_endian ? first << 16U | second : second << 16U | first;
}

std::uint64_t DicomElements::u64(const std::uint8_t* p) const {
  const std::uint64_t first = u32(p);
  const std::uint64_t second = u32(p + 4);
  return encoding_.big_endian ? first << 32U | second : second << 32U | first;
}

const std::uint8_t* DicomElements::take(size_t count) {
  if (count > bytes_.size() - at_) {
    corrupt("it ends too early");
  }
  const std::uint8_t* p = bytes_.data() + at_;
  at_ += count;
  return p;
}

std::uint32_t DicomElements::peek_group() {
  if (bytes_.size() - at_ < 8) {
    corrupt("it ends too early");
  }
  return u16(bytes_.data() + at_);
}

std::uint32_t DicomElements::take_tag() {
  const std::uint8_t* p = take(4);
  return std::uint32_t{u16(p)} << 16U | u16(p + 2);
}

/// What is read of the sequence `which` that lies in `scope`.
DicomElements::Scope DicomElements::opened_by(std::uint32_t which, Scope scope) {
  if (scope.level == Level::kFile) {
    switch (which) {
      case kSharedGroups:
        return {Level::kGroups, false};
      case kPerFrameGroups:
        return {Level::kGroups, true};
      case kDetectorInformation:
        return {Level::kMacro, false};
      default:
        return {};
    }
  }
  const bool known = std::ranges::find(kMacros, which) != kMacros.end();
  return scope.level == Level::kGroups && known ? Scope{Level::kMacro, scope.of_one_frame}
                                                : Scope{};
}

/// One data element, with all that is nested in it.
void DicomElements::element(int depth, Scope scope) {
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
  const Scope inner = opened_by(which, scope);
  if (length == kUndefinedLength && which == kPixelData) {
    std::vector<Bytes> pieces = take_fragments();
    if (scope.level == Level::kFile) {  // not of an icon
      fragments_ = std::move(pieces);
      encapsulated_ = true;
      has_pixels_ = true;
    }
  } else if (length == kUndefinedLength) {
    sequence(depth, nested_explicit, inner, kNoEnd);
  } else if (inner.level != Level::kNothing) {
    const size_t begin = at_;
    take(length);
    at_ = begin;
    sequence(depth, nested_explicit, inner, begin + length);
  } else {
    keep(which, length, scope);
  }
}

void DicomElements::keep(std::uint32_t which, std::uint32_t length, Scope scope) {
  const Bytes value{take(length), length};
  if (scope.level == Level::kFile && which == kPixelData) {
    has_pixels_ = true;
    pixels_ = value;
  } else if (is_wanted(which) && scope.level == Level::kFile) {
    of_file_[DicomTag{which}] = value;
  } else if (is_wanted(which) && scope.level == Level::kMacro) {
    (scope.of_one_frame ? per_frame_.back() : of_all_frames_)[DicomTag{which}] = value;
  }
}

/// Encapsulated pixels: items of bytes up to the end of the sequence.
std::vector<std::span<const std::uint8_t>> DicomElements::take_fragments() {
  std::vector<Bytes> pieces;
  for (;;) {
    const std::uint32_t which = take_tag();
    const std::uint32_t length = u32(take(4));
    if (which == kSequenceEnd) {
      return pieces;
    }
    if (which != kItem || length == kUndefinedLength) {
      corrupt("a broken item of compressed pixels");
    }
    pieces.emplace_back(take(length), length);
  }
}

void DicomElements::sequence(int depth, bool explicit_vr, Scope scope, size_t end) {
  constexpr int kDeepest = 32;
  if (depth >= kDeepest) {
    corrupt("sequences nested too deep");
  }
  const bool outer = encoding_.explicit_vr;
  encoding_.explicit_vr = explicit_vr;
  while (at_ < end) {
    const std::uint32_t which = take_tag();
    const std::uint32_t length = u32(take(4));
    if (which == kSequenceEnd && end == kNoEnd) {
      break;
    }
    if (which != kItem) {
      corrupt("a broken sequence");
    }
    if (scope.level == Level::kGroups && scope.of_one_frame) {
      if (per_frame_.size() == size_t{kMostFrames}) {
        corrupt("more than 2^16 frames");
      }
      per_frame_.emplace_back();
    }
    if (length == kUndefinedLength) {
      item(depth, scope, kNoEnd);
    } else if (scope.level == Level::kNothing) {
      take(length);
    } else {
      item(depth, scope, at_ + length);
    }
  }
  if (end != kNoEnd && at_ != end) {
    corrupt("a sequence that ends within an item");
  }
  encoding_.explicit_vr = outer;
}

void DicomElements::item(int depth, Scope scope, size_t end) {
  while (at_ < end) {
    const size_t start = at_;
    if (end == kNoEnd && take_tag() == kItemEnd) {
      take(4);
      return;
    }
    at_ = start;
    element(depth + 1, scope);
  }
  if (at_ != end) {
    corrupt("an item that ends within an element");
  }
}

}  // namespace clipgs
