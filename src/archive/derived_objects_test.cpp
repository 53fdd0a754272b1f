#include "archive/derived_objects.h"

#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmWriter.h>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

#include "core/error.h"
#include "volume/dicom_fixture.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

std::string text_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
  if (!data.FindDataElement(tag)) {
    return "(none)";
  }
  const gdcm::ByteValue* const bytes = data.GetDataElement(tag).GetByteValue();
  std::string text = bytes != nullptr ? std::string(bytes->GetPointer(), bytes->GetLength()) : "";
  while (text.ends_with(' ') || text.ends_with('\0')) {
    text.pop_back();
  }
  return text;
}

gdcm::DataSet data_of(const std::string& file) {
  std::istringstream in(file);
  gdcm::Reader reader;
  reader.SetStream(in);
  EXPECT_TRUE(reader.Read());
  return reader.GetFile().GetDataSet();
}

class DerivedObjectsTest : public ::testing::Test {
 protected:
  DerivedObjectsTest()
      : file_(fs::path(::testing::TempDir()) /
              ("clipgs-derived-" + std::to_string(::getpid()) + ".dcm")) {
    FixtureSlice slice;
    fill(slice);
    write_dicom(file_, slice);
    plant({0x0008, 0x0005}, gdcm::VR::CS, "ISO_IR 192");
    plant({0x0010, 0x0010}, gdcm::VR::PN, "Müller^Jürgen");
    plant({0x0010, 0x0020}, gdcm::VR::LO, "4711");
    plant({0x0008, 0x0050}, gdcm::VR::SH, "A-17");
    plant({0x0008, 0x0081}, gdcm::VR::ST, "Hospital Street 1");  // of neither module
    plant({0x0010, 0x4000}, gdcm::VR::LT, "a comment");          // nor wanted
  }
  ~DerivedObjectsTest() override { fs::remove(file_); }

  void plant(const gdcm::Tag& tag, gdcm::VR::VRType vr, std::string text) const {
    gdcm::Reader reader;
    reader.SetFileName(file_.c_str());
    ASSERT_TRUE(reader.Read());
    text += text.size() % 2 != 0 ? " " : "";
    gdcm::DataElement element(tag);
    element.SetVR(vr);
    element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
    reader.GetFile().GetDataSet().Replace(element);
    gdcm::Writer writer;
    writer.SetFile(reader.GetFile());
    writer.SetFileName(file_.c_str());
    ASSERT_TRUE(writer.Write());
  }

  DerivedFrom source() const {
    return {file_,
            {{"1.2.840.10008.5.1.4.1.1.2", "1.2.3.1"}, {"1.2.840.10008.5.1.4.1.1.2", "1.2.3.2"}},
            "content"};
  }

  void expect_patient_and_study(const gdcm::DataSet& data) const {
    EXPECT_EQ(text_of(data, {0x0008, 0x0005}), "ISO_IR 192");
    EXPECT_EQ(text_of(data, {0x0010, 0x0010}), "Müller^Jürgen");
    EXPECT_EQ(text_of(data, {0x0010, 0x0020}), "4711");
    EXPECT_EQ(text_of(data, {0x0008, 0x0050}), "A-17");
    EXPECT_EQ(text_of(data, {0x0020, 0x000d}), "1.2.826.0.1.3680043.2.1125.0");
    EXPECT_EQ(text_of(data, {0x0010, 0x0030}), "");  // type 2: there, if only empty
    EXPECT_EQ(text_of(data, {0x0010, 0x1010}), "(none)");
    EXPECT_EQ(text_of(data, {0x0008, 0x0081}), "(none)");
    EXPECT_EQ(text_of(data, {0x0010, 0x4000}), "(none)");
    EXPECT_NE(text_of(data, {0x0020, 0x000e}), "1.2.826.0.1.3680043.2.1125.1");
  }

  void expect_sources(const gdcm::DataSet& data, const gdcm::Tag& tag) const {
    const auto items = data.GetDataElement(tag).GetValueAsSQ();
    ASSERT_EQ(items->GetNumberOfItems(), 2U);
    EXPECT_EQ(text_of(items->GetItem(2).GetNestedDataSet(), {0x0008, 0x1155}), "1.2.3.2");
  }

  fs::path file_;
};

DicomFilm film_of_two() {
  DicomFilm film{{Image(4, 3, 3), Image(4, 3, 3)}, 10, "https://cases.example/#case=a"};
  film.pictures[1].at(2, 1)[1] = 1;
  return film;
}

TEST_F(DerivedObjectsTest, FilmHasItsPicturesAndThePatient) {
  const std::string file = film_object(source(), film_of_two());
  const gdcm::DataSet data = data_of(file);
  expect_patient_and_study(data);
  expect_sources(data, {0x0008, 0x2112});
  EXPECT_EQ(text_of(data, {0x0008, 0x0008}), "DERIVED\\SECONDARY");
  EXPECT_EQ(text_of(data, {0x0028, 0x0301}), "NO");
  EXPECT_EQ(text_of(data, {0x0018, 0x1063}), "100");
  EXPECT_EQ(text_of(data, {0x0020, 0x4000}), "https://cases.example/#case=a");

  std::istringstream in(file);
  gdcm::ImageReader reader;
  reader.SetStream(in);
  ASSERT_TRUE(reader.Read());
  const gdcm::Image& image = reader.GetImage();
  ASSERT_EQ(image.GetBufferLength(), 2UL * 4 * 3 * 3);
  std::string pixels(image.GetBufferLength(), '\1');
  ASSERT_TRUE(image.GetBuffer(pixels.data()));
  std::string expected(pixels.size(), '\0');
  expected[36 + (1 * 4 + 2) * 3 + 1] = '\xff';
  EXPECT_EQ(pixels, expected);
}

TEST_F(DerivedObjectsTest, ReportHoldsThePdf) {
  const gdcm::DataSet data = data_of(report_object(source(), "%PDF-1.5 of odd length"));
  expect_patient_and_study(data);
  expect_sources(data, {0x0042, 0x0013});
  EXPECT_EQ(text_of(data, {0x0042, 0x0011}), "%PDF-1.5 of odd length");
  EXPECT_EQ(text_of(data, {0x0042, 0x0012}), "application/pdf");
}

TEST_F(DerivedObjectsTest, SameImagesGiveTheSameObject) {
  EXPECT_EQ(film_object(source(), film_of_two()), film_object(source(), film_of_two()));
  DerivedFrom other = source();
  other.content = "other content";
  const gdcm::Tag uid(0x0008, 0x0018);
  const std::string one = text_of(data_of(report_object(source(), "%PDF")), uid);
  EXPECT_NE(one, text_of(data_of(report_object(other, "%PDF")), uid));
  EXPECT_NE(one, text_of(data_of(film_object(source(), film_of_two())), uid));
}

TEST_F(DerivedObjectsTest, UidsAreUuids) {
  const std::string uid = derived_uid("content", "film");
  EXPECT_EQ(uid.substr(0, 5), "2.25.");
  EXPECT_LE(uid.size(), 44U);  // PS3.5 B.2: 39 digits at most
  EXPECT_EQ(uid.find_first_not_of("0123456789.", 5), std::string::npos);
  EXPECT_EQ(uid, derived_uid("content", "film"));
  EXPECT_NE(uid, derived_uid("contentf", "ilm"));
}

TEST_F(DerivedObjectsTest, RefusesASourceWithoutAStudy) {
  plant({0x0020, 0x000d}, gdcm::VR::UI, "");
  EXPECT_THROW(film_object(source(), film_of_two()), Error);
}

}  // namespace
}  // namespace clipgs
