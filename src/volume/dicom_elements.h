#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace clipgs {

/// The data elements that we read of DICOM files (an allow-list: no other value leaves a file), as
/// group << 16 | element.
enum class DicomTag : std::uint32_t {
  kTransferSyntax = 0x00020010,
  kImageType = 0x00080008,
  kInstanceUid = 0x00080018,  ///< only tells whether a file came from an archive, never kept
  kAcquisitionTime = 0x00080032,
  kModality = 0x00080060,
  kSeriesDescription = 0x0008103e,  ///< matched against words (Hints), never kept
  kFrameType = 0x00089007,
  kPatientId = 0x00100020,      ///< only whether it is one patient's is asked, never kept
  kContrastAgent = 0x00180010,  ///< only whether there is one is kept
  kBodyPart = 0x00180015,       ///< matched against words (Hints), never kept
  kEchoTime = 0x00180081,
  kSpacingBetweenSlices = 0x00180088,
  kTriggerTime = 0x00181060,
  kFrameTime = 0x00189074,
  kEffectiveEchoTime = 0x00189082,
  kBValue = 0x00189087,
  kSeriesUid = 0x0020000e,
  kSeriesNumber = 0x00200011,
  kAcquisitionNumber = 0x00200012,
  kInstanceNumber = 0x00200013,
  kPosition = 0x00200032,
  kOrientation = 0x00200037,
  kTemporalPosition = 0x00200100,
  kTemporalIndex = 0x00209128,
  kTriggerDelay = 0x00209153,
  kFrameAcquisition = 0x00209156,
  kSamples = 0x00280002,
  kPhotometric = 0x00280004,
  kFrames = 0x00280008,
  kFrameIncrement = 0x00280009,
  kRows = 0x00280010,
  kColumns = 0x00280011,
  kPixelSpacing = 0x00280030,
  kBitsAllocated = 0x00280100,
  kBitsStored = 0x00280101,
  kHighBit = 0x00280102,
  kRepresentation = 0x00280103,
  kPadding = 0x00280120,
  kPaddingLimit = 0x00280121,
  kIntercept = 0x00281052,
  kSlope = 0x00281053,
  kFrameOffsets = 0x3004000c,
  kDoseScaling = 0x3004000e,
};

/// The elements of one DICOM file, by PS3.5: explicit and implicit VR, nested sequences, native and
/// encapsulated pixels. Every length is checked to lie inside the file. What functional groups
/// (PS3.3 C.7.6.16) say of one frame, or of all of them, stands before what the file says.
class DicomElements {
 public:
  static constexpr int kMostFrames = 1 << 16;  ///< in one file

  /// `bytes` stay the caller's; `name` is what messages call the file.
  DicomElements(std::span<const std::uint8_t> bytes, std::string name)
      : bytes_(bytes), name_(std::move(name)) {}

  /// Walks all elements. Throws Error for truncated and corrupt files; what was found before can be
  /// asked for even then.
  void walk();

  /// Without padding; "" if it is not there. `frame` counts from 0.
  std::string text(DicomTag wanted, size_t frame = 0) const;
  std::optional<int> unsigned_short(DicomTag wanted, size_t frame = 0) const;
  std::optional<double> unsigned_long(DicomTag wanted, size_t frame = 0) const;
  /// Of 8 bytes, and finite.
  std::optional<double> float64(DicomTag wanted, size_t frame = 0) const;

  /// How many frames have a description of their own.
  size_t described_frames() const { return per_frame_.size(); }

  bool has_pixels() const { return has_pixels_; }
  bool encapsulated() const { return encapsulated_; }
  bool big_endian() const { return encoding_.big_endian; }
  /// Native pixels, those of all frames.
  std::span<const std::uint8_t> pixels() const { return pixels_; }
  /// The pieces of encapsulated pixels that make up one of `frames` frames. Throws Error if the
  /// file does not say which they are.
  std::vector<std::span<const std::uint8_t>> fragments(size_t frame, size_t frames) const;

  [[noreturn]] void corrupt(const char* what) const;

 private:
  using Bytes = std::span<const std::uint8_t>;
  using Values = std::map<DicomTag, Bytes>;

  /// How a data set is encoded, as the transfer syntax says.
  struct Encoding {
    bool explicit_vr = true;
    bool big_endian = false;
  };

  /// What the elements of a sequence are read for.
  enum class Level { kFile, kGroups, kMacro, kNothing };
  struct Scope {
    Level level = Level::kNothing;
    bool of_one_frame = false;
  };

  static constexpr size_t kNoEnd = SIZE_MAX;  ///< of a sequence or item: its delimiter ends it

  Encoding encoding_of(const std::string& syntax) const;
  static Scope opened_by(std::uint32_t which, Scope scope);
  const Bytes* find(DicomTag wanted, size_t frame) const;
  std::uint16_t u16(const std::uint8_t* p) const;
  std::uint32_t u32(const std::uint8_t* p) const;
  std::uint64_t u64(const std::uint8_t* p) const;
  const std::uint8_t* take(size_t count);
  std::uint32_t take_tag();
  std::uint32_t peek_group();
  void element(int depth, Scope scope);
  void keep(std::uint32_t which, std::uint32_t length, Scope scope);
  std::vector<Bytes> take_fragments();
  void sequence(int depth, bool explicit_vr, Scope scope, size_t end);
  void item(int depth, Scope scope, size_t end);

  Bytes bytes_;
  std::string name_;
  size_t at_ = 0;
  Encoding encoding_;
  Values of_file_;
  Values of_all_frames_;
  std::vector<Values> per_frame_;
  Bytes pixels_;
  std::vector<Bytes> fragments_;  ///< the first is the basic offset table
  bool has_pixels_ = false;
  bool encapsulated_ = false;
};

}  // namespace clipgs
