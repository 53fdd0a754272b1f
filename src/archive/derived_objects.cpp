#include "archive/derived_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTransferSyntax.h>
#include <gdcmWriter.h>
#include <sstream>
#include <utility>

#include "core/digest.h"
#include "core/error.h"
#include "core/version.h"

namespace clipgs {

namespace {

using gdcm::VR;

constexpr const char* kFilmClass = "1.2.840.10008.5.1.4.1.1.7.4";
constexpr const char* kReportClass = "1.2.840.10008.5.1.4.1.1.104.1";
constexpr const char* kNotForDiagnosis = "not for diagnosis";

/// An attribute of the patient or the study.
struct Kept {
  std::uint16_t group;
  std::uint16_t element;
  VR::VRType vr;
  bool always;  ///< type 2: it is there, if only empty
};

// Of modules Patient, General Study and Patient Study; the study's UID, of type 1, is looked at
// besides. Nothing that is not in this list leaves a file.
constexpr std::array kPatientAndStudy = {
    Kept{0x0008, 0x0005, VR::CS, false},  // Specific Character Set: of the names
    Kept{0x0008, 0x0020, VR::DA, true},   // Study Date
    Kept{0x0008, 0x0030, VR::TM, true},   // Study Time
    Kept{0x0008, 0x0050, VR::SH, true},   // Accession Number
    Kept{0x0008, 0x0090, VR::PN, true},   // Referring Physician's Name
    Kept{0x0008, 0x0201, VR::SH, false},  // Timezone Offset From UTC
    Kept{0x0008, 0x1030, VR::LO, false},  // Study Description
    Kept{0x0010, 0x0010, VR::PN, true},   // Patient's Name
    Kept{0x0010, 0x0020, VR::LO, true},   // Patient ID
    Kept{0x0010, 0x0021, VR::LO, false},  // Issuer of Patient ID
    Kept{0x0010, 0x0030, VR::DA, true},   // Patient's Birth Date
    Kept{0x0010, 0x0040, VR::CS, true},   // Patient's Sex
    Kept{0x0010, 0x1010, VR::AS, false},  // Patient's Age
    Kept{0x0010, 0x1020, VR::DS, false},  // Patient's Size
    Kept{0x0010, 0x1030, VR::DS, false},  // Patient's Weight
    Kept{0x0012, 0x0062, VR::CS, false},  // Patient Identity Removed
    Kept{0x0012, 0x0063, VR::LO, false},  // De-identification Method
    Kept{0x0020, 0x000d, VR::UI, true},   // Study Instance UID
    Kept{0x0020, 0x0010, VR::SH, true},   // Study ID
};

/// A data set, element by element.
class Elements {
 public:
  void put(const gdcm::Tag& tag, VR::VRType vr, std::string text) {
    if (text.size() % 2 != 0) {
      text += vr == VR::UI || vr == VR::OB ? '\0' : ' ';
    }
    gdcm::DataElement element(tag);
    element.SetVR(vr);
    element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
    data_.Replace(element);
  }
  void put(const gdcm::Tag& tag, int number) {
    const auto value = static_cast<std::uint16_t>(number);
    put(tag, VR::US, {reinterpret_cast<const char*>(&value), sizeof value});
  }
  void put(const gdcm::Tag& tag, const std::vector<gdcm::DataSet>& items) {
    const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
    sequence->SetLengthToUndefined();
    for (const gdcm::DataSet& nested : items) {
      gdcm::Item item;
      item.SetNestedDataSet(nested);
      item.SetVLToUndefined();
      sequence->AddItem(item);
    }
    gdcm::DataElement element(tag);
    element.SetVR(VR::SQ);
    element.SetValue(*sequence);
    element.SetVLToUndefined();
    data_.Replace(element);
  }
  const gdcm::DataSet& data() const { return data_; }

 private:
  gdcm::DataSet data_;
};

/// The value's bytes; "" if it is not there.
std::string value_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
  const gdcm::ByteValue* const bytes =
      data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
  return bytes != nullptr ? std::string(bytes->GetPointer(), bytes->GetLength()) : std::string();
}

void keep_patient_and_study(const std::filesystem::path& file, Elements& elements) {
  gdcm::Reader reader;
  reader.SetFileName(file.c_str());
  if (!reader.ReadUpToTag(gdcm::Tag(0x0028, 0x0000))) {
    throw Error("a file of the series cannot be read as DICOM; send the series again");
  }
  const gdcm::DataSet& source = reader.GetFile().GetDataSet();
  for (const Kept& kept : kPatientAndStudy) {
    const gdcm::Tag tag(kept.group, kept.element);
    if (kept.always || source.FindDataElement(tag)) {
      elements.put(tag, kept.vr, value_of(source, tag));
    }
  }
  if (value_of(source, gdcm::Tag(0x0020, 0x000d)).empty()) {
    throw Error("a file of the series tells no study (Study Instance UID); send it with one");
  }
}

void put_images(Elements& elements, const gdcm::Tag& tag, const std::vector<SourceImage>& images) {
  if (images.empty()) {
    return;
  }
  std::vector<gdcm::DataSet> items;
  for (const SourceImage& image : images) {
    Elements item;
    item.put({0x0008, 0x1150}, VR::UI, image.sop_class);
    item.put({0x0008, 0x1155}, VR::UI, image.sop_instance);
    items.push_back(item.data());
  }
  elements.put(tag, items);
}

/// What any of our objects has: patient, study, a series of its own, and who made it.
Elements begin_object(const DerivedFrom& source, const char* sop_class, const std::string& what) {
  Elements elements;
  keep_patient_and_study(source.file, elements);
  elements.put({0x0008, 0x0016}, VR::UI, sop_class);
  elements.put({0x0008, 0x0018}, VR::UI, derived_uid(source.content, what));
  elements.put({0x0020, 0x000e}, VR::UI, derived_uid(source.content, what + " series"));
  elements.put({0x0020, 0x0013}, VR::IS, "1");
  elements.put({0x0008, 0x0064}, VR::CS, "WSD");  // Conversion Type: by a workstation
  elements.put({0x0008, 0x0070}, VR::LO, kDerivedBy);
  elements.put({0x0008, 0x1090}, VR::LO, kDerivedBy);
  elements.put({0x0018, 0x1020}, VR::LO, program_version());
  elements.put({0x0028, 0x0301}, VR::CS, "NO");  // Burned In Annotation: of a patient
  return elements;
}

std::string file_of(const Elements& elements) {
  gdcm::Writer writer;
  gdcm::File& file = writer.GetFile();
  file.GetHeader().SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  file.SetDataSet(elements.data());
  std::ostringstream bytes;
  writer.SetStream(bytes);
  if (!writer.Write()) {
    throw Error("a derived DICOM object cannot be written; is the series DICOM of the usual kind?");
  }
  return bytes.str();
}

std::string pixels_of(const DicomFilm& film) {
  std::string pixels;
  pixels.reserve(film.pictures.size() * film.pictures.front().data.size());
  for (const Image& picture : film.pictures) {
    for (const float value : picture.data) {
      pixels += static_cast<char>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    }
  }
  return pixels;
}

}  // namespace

std::string derived_uid(const std::string& content, const std::string& what) {
  __extension__ using Number = unsigned __int128;
  constexpr size_t kDigits = 32;
  std::string digits = Digest().add(content).add(what).hex().substr(0, kDigits);
  digits[12] = '8';  // RFC 9562: a UUID of one's own making, and its variant
  digits[16] = "89ab"[(digits[16] <= '9' ? digits[16] - '0' : digits[16] - 'a' + 10) % 4];
  Number number = 0;
  for (const char digit : digits) {
    number = number * 16 + static_cast<unsigned>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
  }
  std::string decimal;
  for (; number > 0; number /= 10) {
    decimal += static_cast<char>('0' + static_cast<int>(number % 10));
  }
  return "2.25." + std::string(decimal.rbegin(), decimal.rend());
}

std::string film_object(const DerivedFrom& source, const DicomFilm& film) {
  const Image& first = film.pictures.at(0);
  Elements elements = begin_object(source, kFilmClass, "film");
  elements.put({0x0008, 0x0008}, VR::CS, "DERIVED\\SECONDARY");
  elements.put({0x0008, 0x0060}, VR::CS, "OT");
  elements.put({0x0008, 0x103e}, VR::LO, fmt::format("Cinematic film, {}", kNotForDiagnosis));
  elements.put({0x0008, 0x2111}, VR::ST,
               fmt::format("Pictures of a 3D scene made of the series, {}", kNotForDiagnosis));
  put_images(elements, {0x0008, 0x2112}, source.images);  // Source Image Sequence
  elements.put({0x0018, 0x1063}, VR::DS, fmt::format("{:.6g}", 1000 / film.frames_per_second));
  elements.put({0x0020, 0x0011}, VR::IS, "9001");
  elements.put({0x0020, 0x0020}, VR::CS, "");  // Patient Orientation: it turns
  elements.put({0x0020, 0x0060}, VR::CS, "");  // Laterality: not said
  elements.put({0x0020, 0x4000}, VR::LT, film.comment);
  elements.put({0x0028, 0x0002}, 3);  // samples per pixel
  elements.put({0x0028, 0x0004}, VR::CS, "RGB");
  elements.put({0x0028, 0x0006}, 0);  // planar configuration
  elements.put({0x0028, 0x0008}, VR::IS, fmt::format("{}", film.pictures.size()));
  elements.put({0x0028, 0x0009}, VR::AT, std::string("\x18\x00\x63\x10", 4));  // Frame Time
  elements.put({0x0028, 0x0010}, first.height);
  elements.put({0x0028, 0x0011}, first.width);
  elements.put({0x0028, 0x0100}, 8);             // bits allocated
  elements.put({0x0028, 0x0101}, 8);             // bits stored
  elements.put({0x0028, 0x0102}, 7);             // high bit
  elements.put({0x0028, 0x0103}, 0);             // unsigned
  elements.put({0x0028, 0x2110}, VR::CS, "00");  // Lossy Image Compression
  elements.put({0x7fe0, 0x0010}, VR::OB, pixels_of(film));
  return file_of(elements);
}

std::string report_object(const DerivedFrom& source, const std::string& pdf) {
  Elements elements = begin_object(source, kReportClass, "report");
  elements.put({0x0008, 0x0023}, VR::DA, "");  // Content Date: the same input, the same bytes
  elements.put({0x0008, 0x002a}, VR::DT, "");  // Acquisition DateTime
  elements.put({0x0008, 0x0033}, VR::TM, "");  // Content Time
  elements.put({0x0008, 0x0060}, VR::CS, "DOC");
  elements.put({0x0008, 0x103e}, VR::LO, fmt::format("Cinematic report, {}", kNotForDiagnosis));
  elements.put({0x0020, 0x0011}, VR::IS, "9002");
  elements.put({0x0040, 0xa043}, std::vector<gdcm::DataSet>());  // Concept Name Code Sequence
  elements.put({0x0042, 0x0010}, VR::ST, "Cinematic report");
  elements.put({0x0042, 0x0011}, VR::OB, pdf);
  elements.put({0x0042, 0x0012}, VR::LO, "application/pdf");
  put_images(elements, {0x0042, 0x0013}, source.images);  // Source Instance Sequence
  const auto length = static_cast<std::uint32_t>(pdf.size());
  elements.put({0x0042, 0x0015}, VR::UL, {reinterpret_cast<const char*>(&length), sizeof length});
  return file_of(elements);
}

}  // namespace clipgs
