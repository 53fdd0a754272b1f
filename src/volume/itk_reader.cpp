#include "volume/itk_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <gdcmScanner.h>
#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageIOBase.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkRGBAPixel.h>
#include <itkRGBPixel.h>
#include <string>

#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using ScalarImage = itk::Image<float, 3>;
using RgbImage = itk::Image<itk::RGBPixel<std::uint8_t>, 3>;

/// ITK's messages are many lines with addresses; people need the one that says why.
std::string one_line(const itk::ExceptionObject& e) {
  std::string text = e.GetDescription();
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; }, ' ');
  constexpr size_t kLongest = 160;
  return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

bool ends_with(const std::string& text, std::string_view suffix) {
  return text.size() >= suffix.size() && text.ends_with(suffix);
}

itk::ImageIOBase::Pointer image_io(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ends_with(name, ".nii") || ends_with(name, ".nii.gz") || ends_with(name, ".hdr") ||
      ends_with(name, ".img") || ends_with(name, ".img.gz")) {
    return itk::NiftiImageIO::New().GetPointer();
  }
  if (ends_with(name, ".nrrd") || ends_with(name, ".nhdr")) {
    return itk::NrrdImageIO::New().GetPointer();
  }
  if (ends_with(name, ".mha") || ends_with(name, ".mhd")) {
    return itk::MetaImageIO::New().GetPointer();
  }
  throw Error(
      "{}: unknown kind of volume; use a DICOM folder, .nii(.gz), .nrrd, .nhdr, .mha or "
      ".mhd",
      path.string());
}

/// The most bytes of pixels that can come out of the file: deflate packs at best 1032 to 1. A
/// header that promises more is corrupt, and must not make us allocate what it promises.
std::uint64_t most_pixel_bytes(const fs::path& path) {
  constexpr std::uint64_t kBestDeflate = 1040;
  const std::string extension = path.extension().string();
  const bool detached = extension == ".nhdr" || extension == ".mhd" || extension == ".hdr";
  std::uint64_t bytes = 0;
  if (detached) {
    for (const fs::directory_entry& entry :
         fs::directory_iterator(fs::absolute(path).parent_path())) {
      bytes += entry.is_regular_file() ? entry.file_size() : 0;
    }
  } else {
    bytes = fs::file_size(path);
  }
  return bytes * kBestDeflate;
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
      throw Error("{}: the header says more than 2^31 voxels; crop or downsample it",
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
    const float* begin = image->GetBufferPointer();
    stored.values.assign(begin, begin + image->GetPixelContainer()->Size());
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

StoredImage read_with(itk::ImageIOBase* io, const fs::path& path) {
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

const gdcm::Tag kModality(0x0008, 0x0060);
const gdcm::Tag kSeriesUid(0x0020, 0x000e);
const gdcm::Tag kSeriesNumber(0x0020, 0x0011);
const gdcm::Tag kInstanceNumber(0x0020, 0x0013);
const gdcm::Tag kPosition(0x0020, 0x0032);
const gdcm::Tag kOrientation(0x0020, 0x0037);
const gdcm::Tag kFrames(0x0028, 0x0008);
const gdcm::Tag kRows(0x0028, 0x0010);
const gdcm::Tag kColumns(0x0028, 0x0011);
const gdcm::Tag kPixelSpacing(0x0028, 0x0030);

std::string tag_text(const gdcm::Scanner& scanner, const fs::path& path, const gdcm::Tag& tag) {
  const char* value = scanner.GetValue(path.c_str(), tag);
  std::string text = value == nullptr ? "" : value;
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) {
    text.pop_back();
  }
  return text;
}

/// The numbers of a backslash-separated DICOM string; fewer than N if it does not hold N.
template <size_t N>
bool parse_numbers(const std::string& text, std::array<double, N>& numbers) {
  const char* at = text.c_str();
  for (size_t i = 0; i < N; ++i) {
    char* end = nullptr;
    numbers[i] = std::strtod(at, &end);
    if (end == at || !std::isfinite(numbers[i])) {
      return false;
    }
    at = *end == '\\' ? end + 1 : end;
  }
  return true;
}

int parse_int(const std::string& text, int otherwise) {
  std::array<double, 1> number{};
  return parse_numbers(text, number) && std::abs(number[0]) < 1e9 ? static_cast<int>(number[0])
                                                                  : otherwise;
}

DicomHeader header_of(const gdcm::Scanner& scanner, const fs::path& path) {
  DicomHeader header;
  header.path = path;
  header.series_uid = tag_text(scanner, path, kSeriesUid);
  header.modality = tag_text(scanner, path, kModality);
  header.series_number = parse_int(tag_text(scanner, path, kSeriesNumber), 0);
  header.instance = parse_int(tag_text(scanner, path, kInstanceNumber), 0);
  header.columns = parse_int(tag_text(scanner, path, kColumns), 0);
  header.rows = parse_int(tag_text(scanner, path, kRows), 0);
  header.frames = parse_int(tag_text(scanner, path, kFrames), 1);
  std::array<double, 3> position{};
  std::array<double, 6> o{};
  std::array<double, 2> spacing{};  // rows apart first, then columns
  header.placed = parse_numbers(tag_text(scanner, path, kPosition), position) &&
                  parse_numbers(tag_text(scanner, path, kOrientation), o) &&
                  parse_numbers(tag_text(scanner, path, kPixelSpacing), spacing) &&
                  spacing[0] > 0 && spacing[1] > 0;
  if (header.placed) {
    header.position = {position[0], position[1], position[2]};
    header.row = {o[0], o[1], o[2]};
    header.column = {o[3], o[4], o[5]};
    header.pixel_spacing = {spacing[1], spacing[0]};
  }
  return header;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (it->is_regular_file(error)) {
      files.push_back(it->path());
    }
  }
  if (error) {
    throw Error("{}: cannot be listed: {}", folder.string(), error.message());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

StoredImage read_image_file(const fs::path& path) {
  silence_libraries();
  const itk::ImageIOBase::Pointer io = image_io(path);
  return read_with(io, path);
}

bool is_dicom_file(const fs::path& path) {
  std::array<char, 132> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return file && std::memcmp(&head[128], "DICM", 4) == 0;
}

std::vector<DicomHeader> scan_dicom(const fs::path& folder) {
  silence_libraries();
  const std::vector<fs::path> files = files_below(folder);
  gdcm::Scanner scanner;
  for (const gdcm::Tag& tag : {kModality, kSeriesUid, kSeriesNumber, kInstanceNumber, kPosition,
                               kOrientation, kFrames, kRows, kColumns, kPixelSpacing}) {
    scanner.AddTag(tag);
  }
  gdcm::Directory::FilenamesType names;
  std::transform(files.begin(), files.end(), std::back_inserter(names),
                 [](const fs::path& file) { return file.string(); });
  if (!scanner.Scan(names)) {
    throw Error("{}: its files cannot be read", folder.string());
  }
  std::vector<DicomHeader> headers;
  for (const fs::path& file : files) {
    if (!scanner.IsKey(file.c_str())) {
      if (is_dicom_file(file)) {
        throw Error("{}: truncated or corrupt DICOM file", file.string());
      }
      continue;
    }
    DicomHeader header = header_of(scanner, file);
    if (header.rows > 0 && header.columns > 0) {
      headers.push_back(std::move(header));
    }
  }
  return headers;
}

StoredImage read_dicom_image(const fs::path& path) {
  silence_libraries();
  const auto io = itk::GDCMImageIO::New();
  return read_with(io, path);
}

}  // namespace clipgs
