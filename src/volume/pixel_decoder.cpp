#include "volume/pixel_decoder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "volume/header_text.h"

namespace clipgs {
namespace {

/// What GDCM decodes: JPEG, JPEG-LS, JPEG 2000, RLE (PS3.6 A).
constexpr std::array<std::string_view, 10> kSyntaxes{
    "1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.51", "1.2.840.10008.1.2.4.53",
    "1.2.840.10008.1.2.4.57", "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.80",
    "1.2.840.10008.1.2.4.81", "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91",
    "1.2.840.10008.1.2.5"};

/// Larger than any detector: what a few bytes of a corrupt file may promise.
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;

/// GDCM talks on standard error; our one line says what a person needs.
void silence_library() {
  gdcm::Trace::WarningOff();
  gdcm::Trace::DebugOff();
  gdcm::Trace::ErrorOff();
}

void append_element(std::string& file, std::uint16_t group, std::uint16_t element, const char* vr,
                    std::string value) {
  if (value.size() % 2 != 0) {
    value += vr == std::string_view("UI") ? '\0' : ' ';
  }
  const auto put = [&](std::uint16_t number) {
    file += static_cast<char>(number & 0xffU);
    file += static_cast<char>(number >> 8U);
  };
  put(group);
  put(element);
  file += vr;
  put(static_cast<std::uint16_t>(value.size()));
  file += value;
}

std::string us(int number) {
  return {static_cast<char>(number & 0xff), static_cast<char>((number >> 8) & 0xff)};
}

constexpr std::uint16_t kItem = 0xe000;
constexpr std::uint16_t kSequenceEnd = 0xe0dd;

/// Of group 0xfffe.
void append_item(std::string& file, std::uint16_t element, std::span<const std::uint8_t> value) {
  const auto size = static_cast<std::uint32_t>(value.size());
  for (const std::uint32_t number : {0xfffeU, std::uint32_t{element}, size, size >> 16U}) {
    file += static_cast<char>(number & 0xffU);
    file += static_cast<char>(number >> 8U & 0xffU);
  }
  file.append(reinterpret_cast<const char*>(value.data()), value.size());
}

/// A DICOM file of nothing but the picture. Debian's GDCM asserts, and so ends its process, on
/// elements that have nothing to do with the pixels: it never gets to see them.
std::string minimal_file(const DicomHeader& header,
                         std::span<const std::span<const std::uint8_t>> fragments) {
  std::string file(128, '\0');
  file += "DICM";
  append_element(file, 0x0002, 0x0010, "UI", header.transfer_syntax);
  append_element(file, 0x0028, 0x0002, "US", us(1));
  append_element(file, 0x0028, 0x0004, "CS", header.photometric);
  append_element(file, 0x0028, 0x0010, "US", us(header.rows));
  append_element(file, 0x0028, 0x0011, "US", us(header.columns));
  append_element(file, 0x0028, 0x0100, "US", us(header.bits_allocated));
  append_element(file, 0x0028, 0x0101, "US", us(header.bits_stored));
  append_element(file, 0x0028, 0x0102, "US", us(header.bits_stored - 1));
  append_element(file, 0x0028, 0x0103, "US", us(header.is_signed ? 1 : 0));
  constexpr std::string_view kPixels("\xe0\x7f\x10\0OB\0\0\xff\xff\xff\xff", 12);
  file += kPixels;
  append_item(file, kItem, {});  // no table of offsets
  for (const std::span<const std::uint8_t> fragment : fragments) {
    append_item(file, kItem, fragment);
  }
  append_item(file, kSequenceEnd, {});
  return file;
}

/// Runs in a process of its own.
std::optional<std::string> decoded(std::string file) {
  silence_library();
  std::istringstream stream(std::move(file), std::ios::binary);
  gdcm::ImageReader reader;
  reader.SetStream(stream);
  if (!reader.Read()) {
    return std::nullopt;
  }
  const gdcm::Image& image = reader.GetImage();
  std::string pixels(image.GetBufferLength(), '\0');
  return image.GetBuffer(pixels.data()) ? std::optional(std::move(pixels)) : std::nullopt;
}

}  // namespace

std::string PixelDecoder::decode(const DicomHeader& header,
                                 std::span<const std::span<const std::uint8_t>> fragments) {
  constexpr std::uint64_t kMostMemory = std::uint64_t{1} << 31;
  constexpr std::uint64_t kPixelsASecond = 1 << 22;  // of the slowest code on a slow machine
  const std::uint64_t pixels = static_cast<std::uint64_t>(header.columns) * header.rows;
  if (pixels > kMostPixels) {
    throw Error("{}: a compressed image of more than 2^26 pixels; downsample it",
                header.source.name());
  }
  if (std::ranges::find(kSyntaxes, header.transfer_syntax) == kSyntaxes.end()) {
    throw Error("{}: compression {} is not supported; export the series uncompressed",
                header.source.name(), printable(header.transfer_syntax));
  }
  if (!gdcm_) {
    gdcm_.emplace(decoded, kMostMemory);
  }
  const std::uint64_t expected = pixels * (static_cast<unsigned>(header.bits_allocated) / 8);
  const std::chrono::seconds limit(8 + pixels / kPixelsASecond);
  const auto start = std::chrono::steady_clock::now();
  std::optional<std::string> bytes = gdcm_->ask(minimal_file(header, fragments), expected, limit);
  if (!bytes || bytes->size() != expected) {
    gdcm_.reset();
    if (std::chrono::steady_clock::now() - start >= limit) {
      throw Error(
          "{}: its compressed pixels take more than {} s to decode; try again, or export "
          "the series uncompressed",
          header.source.name(), limit.count());
    }
    throw Error("{}: its compressed pixels are corrupt", header.source.name());
  }
  return std::move(*bytes);
}

}  // namespace clipgs
