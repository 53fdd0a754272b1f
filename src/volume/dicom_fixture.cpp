#include "volume/dicom_fixture.h"

#include <cmath>
#include <fmt/format.h>
#include <gdcmDataElement.h>
#include <gdcmTransferSyntax.h>
#include <gdcmWriter.h>
#include <stdexcept>

namespace clipgs {
namespace {

void insert(gdcm::DataSet& data, gdcm::Tag tag, gdcm::VR vr, std::string text) {
  if (text.size() % 2 != 0) {
    text += vr == gdcm::VR::UI ? '\0' : ' ';
  }
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
  data.Insert(element);
}

void insert(gdcm::DataSet& data, gdcm::Tag tag, int number) {
  const auto value = static_cast<std::uint16_t>(number);
  gdcm::DataElement element(tag);
  element.SetVR(gdcm::VR::US);
  element.SetByteValue(reinterpret_cast<const char*>(&value), sizeof value);
  data.Insert(element);
}

}  // namespace

void write_dicom(const std::filesystem::path& path, const FixtureSlice& slice) {
  gdcm::Writer writer;
  gdcm::File& file = writer.GetFile();
  file.GetHeader().SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  gdcm::DataSet& data = file.GetDataSet();
  const auto text = [&](std::uint16_t group, std::uint16_t element, gdcm::VR vr,
                        const std::string& value) { insert(data, {group, element}, vr, value); };
  text(0x0008, 0x0016, gdcm::VR::UI, "1.2.840.10008.5.1.4.1.1.2");  // CT Image Storage
  text(0x0008, 0x0018, gdcm::VR::UI, fmt::format("{}.{}", slice.series_uid, slice.instance));
  text(0x0008, 0x0060, gdcm::VR::CS, slice.modality);
  text(0x0020, 0x000d, gdcm::VR::UI, "1.2.826.0.1.3680043.2.1125.0");
  text(0x0020, 0x000e, gdcm::VR::UI, slice.series_uid);
  text(0x0020, 0x0011, gdcm::VR::IS, "7");
  text(0x0020, 0x0013, gdcm::VR::IS, fmt::format("{}", slice.instance));
  text(0x0020, 0x0032, gdcm::VR::DS,
       fmt::format("{:.6f}\\{:.6f}\\{:.6f}", slice.position.x, slice.position.y, slice.position.z));
  text(0x0020, 0x0037, gdcm::VR::DS,
       fmt::format("{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}", slice.row.x, slice.row.y,
                   slice.row.z, slice.column.x, slice.column.y, slice.column.z));
  text(0x0028, 0x0004, gdcm::VR::CS, "MONOCHROME2");
  text(0x0028, 0x0030, gdcm::VR::DS,
       fmt::format("{:.6f}\\{:.6f}", slice.pixel_spacing.y, slice.pixel_spacing.x));
  text(0x0028, 0x1052, gdcm::VR::DS, fmt::format("{}", slice.intercept));
  text(0x0028, 0x1053, gdcm::VR::DS, fmt::format("{}", slice.slope));
  for (const FixtureSlice::Text& extra : slice.texts) {
    text(extra.group, extra.element, extra.integer ? gdcm::VR::IS : gdcm::VR::DS, extra.value);
  }
  insert(data, {0x0028, 0x0002}, 1);  // samples per pixel
  insert(data, {0x0028, 0x0010}, slice.rows);
  insert(data, {0x0028, 0x0011}, slice.columns);
  insert(data, {0x0028, 0x0100}, 16);  // bits allocated
  insert(data, {0x0028, 0x0101}, 16);  // bits stored
  insert(data, {0x0028, 0x0102}, 15);  // high bit
  insert(data, {0x0028, 0x0103}, 1);   // signed
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetVR(gdcm::VR::OW);
  pixels.SetByteValue(reinterpret_cast<const char*>(slice.pixels.data()),
                      static_cast<std::uint32_t>(slice.pixels.size() * sizeof(std::int16_t)));
  data.Insert(pixels);
  writer.SetFileName(path.c_str());
  if (!writer.Write()) {
    throw std::runtime_error("cannot write " + path.string());
  }
}

double fixture_truth(const glm::dvec3& lps) { return 40 + 3 * lps.x - 2 * lps.y + 4 * lps.z; }

void fill(FixtureSlice& slice, double added) {
  slice.pixels.clear();
  for (int y = 0; y < slice.rows; ++y) {
    for (int x = 0; x < slice.columns; ++x) {
      const glm::dvec3 p = slice.position + slice.row * (x * slice.pixel_spacing.x) +
                           slice.column * (y * slice.pixel_spacing.y);
      slice.pixels.push_back(static_cast<std::int16_t>(
          std::lround((fixture_truth(p) + added - slice.intercept) / slice.slope)));
    }
  }
}

void write_series(const std::filesystem::path& folder, const std::vector<double>& table,
                  FixtureSlice slice, const std::string& prefix, double added) {
  std::filesystem::create_directories(folder);
  for (size_t i = 0; i < table.size(); ++i) {
    slice.position.z = table[i];
    slice.instance = static_cast<int>(i) + 1;
    fill(slice, added);
    write_dicom(folder / fmt::format("{}{}", prefix, (i * 7) % 31), slice);
  }
}

std::vector<double> even_table(int slices, double step) {
  std::vector<double> table;
  for (int i = 0; i < slices; ++i) {
    table.push_back(-20 + i * step);
  }
  return table;
}

}  // namespace clipgs
