#include "volume/itk_reader.h"

#include <algorithm>
#include <cctype>
#include <fcntl.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageIOBase.h>
#include <itkRGBAPixel.h>
#include <itkRGBPixel.h>
#include <sstream>
#include <string>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using ScalarImage = itk::Image<float, 3>;
using RgbImage = itk::Image<itk::RGBPixel<std::uint8_t>, 3>;

/// ITK's messages are many lines with addresses; people need the one that says why.
std::string one_line(const itk::ExceptionObject& e) {
  std::string text = e.GetDescription();
  std::ranges::replace_if(text, [](unsigned char c) { return std::isspace(c) != 0; }, ' ');
  constexpr size_t kLongest = 160;
  return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

/// The most bytes of pixels that can come out of the file: deflate packs at best 1032 to 1. A
/// header that promises more is corrupt, and must not make us allocate what it promises.
std::uint64_t most_pixel_bytes(const fs::path& path) {
  constexpr std::uint64_t kBestDeflate = 1040;
  return fs::file_size(path) * kBestDeflate;
}

void check_header(itk::ImageIOBase& io, const fs::path& path) {
  const unsigned dimensions = io.GetNumberOfDimensions();
  std::uint64_t voxels = 1;
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    const std::uint64_t size = io.GetDimensions(axis);
    if (axis >= 3 && size != 1) {
      throw Error("{}: a series of {} volumes; store the one to show as a 3D file", path.string(),
                  size);
    }
    if (size == 0) {
      throw Error("{}: the volume has size zero along axis {}", path.string(), axis);
    }
    if (size > kMaxVoxels / voxels) {
      throw Error("{}: the header says more than 2^32 voxels; crop or downsample it",
                  path.string());
    }
    voxels *= size;
  }
  if (dimensions < 3) {
    throw Error("{}: a {}D image; a 3D volume is needed", path.string(), dimensions);
  }
  const std::uint64_t bytes = voxels * io.GetNumberOfComponents() * io.GetComponentSize();
  if (bytes > most_pixel_bytes(path)) {
    throw Error(
        "{}: truncated or corrupt: the header says {} bytes of voxels, more than the file "
        "can hold",
        path.string(), bytes);
  }
}

template <typename ImageType>
typename ImageType::Pointer read_pixels(itk::ImageIOBase* io, const fs::path& path) {
  auto reader = itk::ImageFileReader<ImageType>::New();
  reader->SetImageIO(io);
  reader->SetFileName(path.string());
  reader->Update();
  typename ImageType::Pointer image = reader->GetOutput();
  image->DisconnectPipeline();
  return image;
}

template <typename ImageType>
void copy_geometry(const ImageType& image, StoredImage& stored) {
  const auto size = image.GetLargestPossibleRegion().GetSize();
  for (unsigned axis = 0; axis < 3; ++axis) {
    stored.dims[static_cast<int>(axis)] = static_cast<int>(size[axis]);
    stored.spacing[static_cast<int>(axis)] = image.GetSpacing()[axis];
    stored.origin[static_cast<int>(axis)] = image.GetOrigin()[axis];
    for (unsigned row = 0; row < 3; ++row) {
      stored.direction[static_cast<int>(axis)][static_cast<int>(row)] =
          image.GetDirection()(row, axis);
    }
  }
}

StoredImage read_checked(itk::ImageIOBase* io, const fs::path& path) {
  StoredImage stored;
  const auto type = io->GetComponentType();
  const bool byte = type == itk::IOComponentEnum::UCHAR;
  const unsigned components = io->GetNumberOfComponents();
  if (components == 1) {
    const auto image = read_pixels<ScalarImage>(io, path);
    copy_geometry(*image, stored);
    ValuePacker packer(image->GetPixelContainer()->Size());
    packer.append({image->GetBufferPointer(), image->GetPixelContainer()->Size()});
    stored.values = packer.take();
    stored.eight_bit = byte || type == itk::IOComponentEnum::CHAR;
  } else if ((components == 3 || components == 4) && byte) {
    const auto image = read_pixels<RgbImage>(io, path);
    copy_geometry(*image, stored);
    const auto* begin = reinterpret_cast<const std::uint8_t*>(image->GetBufferPointer());
    stored.rgb.assign(begin, begin + 3 * image->GetPixelContainer()->Size());
  } else {
    throw Error("{}: {} numbers a voxel; one number, or 8-bit RGB, is needed", path.string(),
                components);
  }
  return stored;
}

/// Sends standard error to nowhere while it lives: libraries under ITK print their errors there,
/// whatever its settings, beside the one line that we say.
class QuietStandardError {
 public:
  QuietStandardError() : saved_(dup(STDERR_FILENO)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (saved_ >= 0 && nowhere >= 0) {
      dup2(nowhere, STDERR_FILENO);
    }
    if (nowhere >= 0) {
      close(nowhere);
    }
  }
  ~QuietStandardError() {
    if (saved_ >= 0) {
      dup2(saved_, STDERR_FILENO);
      close(saved_);
    }
  }
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  int saved_;
};

StoredImage read_with(itk::ImageIOBase* io, const fs::path& path) {
  const QuietStandardError quiet;
  try {
    if (!io->CanReadFile(path.string().c_str())) {
      throw Error("{}: not a file of its kind: its header is corrupt or truncated", path.string());
    }
    io->SetFileName(path.string());
    io->ReadImageInformation();
    check_header(*io, path);
    return read_checked(io, path);
  } catch (const itk::ExceptionObject& e) {
    throw Error("{}: truncated or corrupt: {}", path.string(), one_line(e));
  }
}

/// ITK and GDCM talk on standard error; our one line says what a person needs.
void silence_libraries() {
  itk::Object::GlobalWarningDisplayOff();
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

/// A DICOM file of nothing but the picture. Debian's GDCM asserts, and so ends the program, on
/// corrupt elements that have nothing to do with the pixels: it never gets to see them.
std::string minimal_file(const DicomHeader& header, std::span<const std::uint8_t> fragments) {
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
  file.append(reinterpret_cast<const char*>(fragments.data()), fragments.size());
  return file;
}

}  // namespace

StoredImage read_multi_frame(const fs::path& path) {
  silence_libraries();
  const auto io = itk::GDCMImageIO::New();
  return read_with(io, path);
}

std::vector<std::uint8_t> decode_dicom_pixels(const DicomHeader& header,
                                              std::span<const std::uint8_t> fragments) {
  silence_libraries();
  std::istringstream file(minimal_file(header, fragments), std::ios::binary);
  gdcm::ImageReader reader;
  reader.SetStream(file);
  if (!reader.Read()) {
    throw Error("{}: its compressed pixels cannot be read", header.source.name());
  }
  const gdcm::Image& image = reader.GetImage();
  const size_t expected = static_cast<size_t>(header.columns) * header.rows *
                          static_cast<size_t>(header.bits_allocated / 8);
  std::vector<std::uint8_t> pixels(image.GetBufferLength());
  if (pixels.size() != expected || !image.GetBuffer(reinterpret_cast<char*>(pixels.data()))) {
    throw Error("{}: its compressed pixels are corrupt", header.source.name());
  }
  return pixels;
}

}  // namespace clipgs
