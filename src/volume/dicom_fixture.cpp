#include "volume/dicom_fixture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gdcmDataElement.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmSequenceOfItems.h>
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

template <typename Number>
void insert_number(gdcm::DataSet& data, gdcm::Tag tag, gdcm::VR vr, Number number) {
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(reinterpret_cast<const char*>(&number), sizeof number);
  data.Insert(element);
}

void insert(gdcm::DataSet& data, gdcm::Tag tag, int number) {
  insert_number(data, tag, gdcm::VR::US, static_cast<std::uint16_t>(number));
}

void insert_place(gdcm::DataSet& data, const FixtureSlice& slice) {
  const glm::dvec3& p = slice.position;
  insert(data, {0x0020, 0x0032}, gdcm::VR::DS,
         fmt::format("{:.6f}\\{:.6f}\\{:.6f}", p.x, p.y, p.z));
}

void insert_orientation(gdcm::DataSet& data, const FixtureSlice& slice) {
  const glm::dvec3& u = slice.row;
  const glm::dvec3& v = slice.column;
  insert(
      data, {0x0020, 0x0037}, gdcm::VR::DS,
      fmt::format("{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}\\{:.7f}", u.x, u.y, u.z, v.x, v.y, v.z));
}

void insert_measures(gdcm::DataSet& data, const FixtureSlice& slice) {
  insert(data, {0x0028, 0x0030}, gdcm::VR::DS,
         fmt::format("{:.6f}\\{:.6f}", slice.pixel_spacing.y, slice.pixel_spacing.x));
}

void insert_scale(gdcm::DataSet& data, const FixtureSlice& slice) {
  insert(data, {0x0028, 0x1052}, gdcm::VR::DS, fmt::format("{}", slice.intercept));
  insert(data, {0x0028, 0x1053}, gdcm::VR::DS, fmt::format("{}", slice.slope));
}

/// What images of one file have in common.
gdcm::DataSet& begin_file(gdcm::Writer& writer, const FixtureSlice& slice,
                          gdcm::TransferSyntax::TSType syntax) {
  gdcm::File& file = writer.GetFile();
  file.GetHeader().SetDataSetTransferSyntax(syntax);
  gdcm::DataSet& data = file.GetDataSet();
  const auto text = [&](std::uint16_t group, std::uint16_t element, gdcm::VR vr,
                        const std::string& value) { insert(data, {group, element}, vr, value); };
  text(0x0008, 0x0016, gdcm::VR::UI, "1.2.840.10008.5.1.4.1.1.2");  // CT Image Storage
  text(0x0008, 0x0018, gdcm::VR::UI, fmt::format("{}.{}", slice.series_uid, slice.instance));
  text(0x0008, 0x0060, gdcm::VR::CS, slice.modality);
  text(0x0010, 0x0020, gdcm::VR::LO, slice.patient);
  text(0x0020, 0x000d, gdcm::VR::UI, slice.study_uid);
  text(0x0020, 0x000e, gdcm::VR::UI, slice.series_uid);
  text(0x0020, 0x0011, gdcm::VR::IS, "7");
  text(0x0020, 0x0013, gdcm::VR::IS, fmt::format("{}", slice.instance));
  text(0x0028, 0x0004, gdcm::VR::CS, "MONOCHROME2");
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
  if (slice.padding) {
    insert_number(data, {0x0028, 0x0120}, gdcm::VR::SS, *slice.padding);
  }
  if (slice.padding_limit) {
    insert_number(data, {0x0028, 0x0121}, gdcm::VR::SS, *slice.padding_limit);
  }
  return data;
}

void end_file(gdcm::Writer& writer, const std::filesystem::path& path) {
  writer.SetFileName(path.c_str());
  if (!writer.Write()) {
    throw std::runtime_error("cannot write " + path.string());
  }
}

void insert_sequence(gdcm::DataSet& data, gdcm::Tag tag, const std::vector<gdcm::DataSet>& items,
                     const FixtureFrames& how) {
  const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
  for (const gdcm::DataSet& nested : items) {
    gdcm::Item item;
    item.SetNestedDataSet(nested);
    item.SetVL(how.defined_lengths ? nested.GetLength<gdcm::ExplicitDataElement>()
                                   : gdcm::VL(0xffffffff));
    sequence->AddItem(item);
  }
  if (how.defined_lengths) {
    sequence->SetLength(0);  // else the length has a delimiter in it
    sequence->SetLength(sequence->ComputeLength<gdcm::ExplicitDataElement>());
  } else {
    sequence->SetLengthToUndefined();
  }
  gdcm::DataElement element(tag);
  element.SetVR(gdcm::VR::SQ);
  element.SetValue(*sequence);
  element.SetVL(sequence->GetLength());
  data.Insert(element);
}

/// A sequence of one item.
template <typename Fill>
void insert_macro(gdcm::DataSet& data, gdcm::Tag tag, const FixtureFrames& how, const Fill& fill) {
  gdcm::DataSet macro;
  fill(macro);
  insert_sequence(data, tag, {macro}, how);
}

/// PS3.5 annex G: the high bytes and then the low ones, here in literal runs only.
std::string rle(const std::vector<std::int16_t>& pixels) {
  constexpr size_t kLongestRun = 128;
  std::string header(64, '\0');
  std::string body;
  const auto put = [&](size_t place, size_t number) {
    for (unsigned byte = 0; byte < 4; ++byte) {
      header[place + byte] = static_cast<char>(number >> 8U * byte & 0xffU);
    }
  };
  put(0, 2);
  for (const unsigned segment : {0U, 1U}) {
    put(4 + 4 * size_t{segment}, header.size() + body.size());
    for (size_t i = 0; i < pixels.size(); ++i) {
      if (i % kLongestRun == 0) {
        body += static_cast<char>(std::min(kLongestRun, pixels.size() - i) - 1);
      }
      body += static_cast<char>(static_cast<std::uint16_t>(pixels[i]) >> (segment == 0 ? 8U : 0U));
    }
    body.resize((body.size() + 1) / 2 * 2);
  }
  return header + body;
}

void insert_pixels(gdcm::DataSet& data, const std::vector<FixtureSlice>& slices, bool compressed) {
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> pieces = new gdcm::SequenceOfFragments;
  std::string plain;
  for (const FixtureSlice& slice : slices) {
    plain.append(reinterpret_cast<const char*>(slice.pixels.data()),
                 slice.pixels.size() * sizeof(std::int16_t));
    const std::string packed = rle(slice.pixels);
    gdcm::Fragment piece;
    piece.SetByteValue(packed.data(), static_cast<std::uint32_t>(packed.size()));
    pieces->AddFragment(piece);
  }
  if (compressed) {
    pixels.SetVR(gdcm::VR::OB);
    pixels.SetValue(*pieces);
  } else {
    pixels.SetVR(gdcm::VR::OW);
    pixels.SetByteValue(plain.data(), static_cast<std::uint32_t>(plain.size()));
  }
  data.Insert(pixels);
}

}  // namespace

void write_dicom(const std::filesystem::path& path, const FixtureSlice& slice) {
  gdcm::Writer writer;
  gdcm::DataSet& data = begin_file(writer, slice, gdcm::TransferSyntax::ExplicitVRLittleEndian);
  insert_place(data, slice);
  insert_orientation(data, slice);
  insert_measures(data, slice);
  insert_scale(data, slice);
  insert_pixels(data, {slice}, false);
  end_file(writer, path);
}

void write_frames(const std::filesystem::path& path, const std::vector<FixtureSlice>& slices,
                  const FixtureFrames& how) {
  gdcm::Writer writer;
  const FixtureSlice& first = slices.front();
  gdcm::DataSet& data = begin_file(
      writer, first,
      how.rle ? gdcm::TransferSyntax::RLELossless : gdcm::TransferSyntax::ExplicitVRLittleEndian);
  insert(data, {0x0028, 0x0008}, gdcm::VR::IS, std::to_string(slices.size()));
  gdcm::DataSet shared;
  insert_macro(shared, {0x0020, 0x9116}, how,
               [&](auto& macro) { insert_orientation(macro, first); });
  insert_macro(shared, {0x0028, 0x9110}, how, [&](auto& macro) { insert_measures(macro, first); });
  insert_macro(shared, {0x0028, 0x9145}, how, [&](auto& macro) { insert_scale(macro, first); });
  insert_sequence(data, {0x5200, 0x9229}, {shared}, how);
  std::vector<gdcm::DataSet> frames;
  for (size_t i = 0; i < slices.size(); ++i) {
    gdcm::DataSet frame;
    insert_macro(frame, {0x0020, 0x9113}, how,
                 [&](auto& macro) { insert_place(macro, slices[i]); });
    if (!how.times.empty()) {
      insert_macro(frame, {0x0020, 0x9111}, how, [&](auto& macro) {
        insert_number(macro, {0x0020, 0x9128}, gdcm::VR::UL, how.times[i]);
      });
    }
    frames.push_back(frame);
  }
  insert_sequence(data, {0x5200, 0x9230}, frames, how);
  insert_pixels(data, slices, how.rle);
  end_file(writer, path);
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
