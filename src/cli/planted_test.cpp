// Nothing that a DICOM file says of a patient is in what is made of it: texts are planted wherever
// a file can hold one, and looked for in everything that is written.
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gdcmDict.h>
#include <gdcmDicts.h>
#include <gdcmGlobal.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmWriter.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "archive/orthanc_fixture.h"

#include "asset/zip.h"
#include "cli/cli_fixture.h"
#include "core/letter_case.h"
#include "volume/dicom_fixture.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::Orthanc;
using testing_support::run_clipgs;

constexpr const char* kText = "zQx7Planted";
constexpr const char* kDay = "19010203";
constexpr const char* kUid = "1.2.999.777.31337";
constexpr std::uint16_t kFirstGroup = 8;         // before are the file's own
constexpr std::uint16_t kFirstOverlay = 0x5000;  // from here on are curves, overlays and pixels

/// What an element of a kind can hold of these; "": none.
std::string planted(const gdcm::VR& vr) {
  switch (vr) {
    case gdcm::VR::AE:
    case gdcm::VR::SH:
    case gdcm::VR::LO:
    case gdcm::VR::LT:
    case gdcm::VR::ST:
    case gdcm::VR::UT:
    case gdcm::VR::PN:
      return kText;
    case gdcm::VR::DA:
      return kDay;
    case gdcm::VR::UI:
      return kUid;
    default:
      return "";
  }
}

void insert(gdcm::DataSet& data, const gdcm::Tag& tag, const gdcm::VR& vr, std::string value) {
  if (value.size() % 2 == 1) {
    value += vr == gdcm::VR::UI ? '\0' : ' ';
  }
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(value.data(), static_cast<std::uint32_t>(value.size()));
  data.Replace(element);
}

/// Every public element of text, a day or a UID that the file has not got.
int plant_public(gdcm::DataSet& data) {
  const gdcm::Dict& dictionary = gdcm::Global::GetInstance().GetDicts().GetPublicDict();
  int count = 0;
  for (auto entry = dictionary.Begin(); entry != dictionary.End(); ++entry) {
    const gdcm::Tag& tag = entry->first;
    const std::string value = planted(entry->second.GetVR());
    const bool is_retold = tag.GetGroup() % 2 == 0 && tag.GetGroup() >= kFirstGroup &&
                           tag.GetGroup() < kFirstOverlay && !data.FindDataElement(tag);
    if (!value.empty() && is_retold) {
      insert(data, tag, entry->second.GetVR(), value);
      ++count;
    }
  }
  return count;
}

/// A code string, private elements, and a sequence in a sequence.
void plant_elsewhere(gdcm::DataSet& data) {
  insert(data, {0x0018, 0x0015}, gdcm::VR::CS, "ZQX7PLANTED");  // body part examined
  insert(data, {0x0009, 0x0010}, gdcm::VR::LO, kText);
  insert(data, {0x0009, 0x1001}, gdcm::VR::LO, kText);
  gdcm::DataSet inner;
  insert(inner, {0x0010, 0x0010}, gdcm::VR::PN, kText);
  gdcm::DataSet outer;
  for (auto [into, what, tag] : {std::tuple{&outer, &inner, gdcm::Tag(0x0008, 0x1140)},
                                 {&data, &outer, gdcm::Tag(0x0008, 0x1115)}}) {
    gdcm::Item item;
    item.SetVLToUndefined();
    item.SetNestedDataSet(*what);
    const auto items = gdcm::SequenceOfItems::New();
    items->SetLengthToUndefined();
    items->AddItem(item);
    gdcm::DataElement sequence(tag);
    sequence.SetVR(gdcm::VR::SQ);
    sequence.SetValue(*items);
    sequence.SetVLToUndefined();
    into->Replace(sequence);
  }
}

void plant(const fs::path& path) {
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  ASSERT_TRUE(reader.Read());
  gdcm::DataSet& data = reader.GetFile().GetDataSet();
  EXPECT_GT(plant_public(data), 400);
  plant_elsewhere(data);
  gdcm::Writer writer;
  writer.CheckFileMetaInformationOff();
  writer.SetFile(reader.GetFile());
  writer.SetFileName(path.c_str());
  ASSERT_TRUE(writer.Write());
}

/// A ball of soft tissue, in a folder and in files that are named after the patient.
void write_ball(const fs::path& folder) {
  constexpr int kWide = 40;
  fs::create_directories(folder);
  for (int z = 0; z < kWide; ++z) {
    FixtureSlice slice;
    slice.study_uid = fmt::format("{}.1", kUid);
    slice.series_uid = kUid;
    slice.instance = z + 1;
    slice.columns = slice.rows = kWide;
    slice.position = {-20, -20, z - 20};
    for (int i = 0; i < kWide * kWide; ++i) {
      const double r = std::hypot(i % kWide - 20, i / kWide - 20, z - 20);
      slice.pixels.push_back(static_cast<std::int16_t>(r < 15 ? 1074 : 24));
    }
    const fs::path file = folder / fmt::format("{}-{}.dcm", kText, z);
    write_dicom(file, slice);
    plant(file);
  }
}

/// Fails where one of the planted texts is.
void expect_clean(const std::string& bytes, const std::string& where) {
  const std::string lower = lower_case(bytes);
  for (const char* text : {"zqx7", kDay, "1901-02-03", kUid}) {
    EXPECT_EQ(lower.find(text), std::string::npos) << text << " is in " << where;
  }
}

/// The same of everything in a folder: names, contents, and what archives hold.
int expect_clean_folder(const fs::path& folder) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    expect_clean(fs::relative(entry.path(), folder).string(), "a name");
    if (!entry.is_regular_file()) {
      continue;
    }
    ++files;
    const std::string bytes = read_text(entry.path());
    expect_clean(bytes, entry.path().string());
    if (bytes.starts_with("PK")) {
      for (const auto& [name, content] : read_zip(read_file(entry.path()), "an archive")) {
        expect_clean(name, "an archive");
        expect_clean(std::string(content.begin(), content.end()),
                     entry.path().string() + " " + name);
      }
    }
  }
  return files;
}

TEST_F(CliTest, NothingPlantedInDicomLeavesIt) {
  const fs::path scan = fs::path(at("in")) / kText;
  write_ball(scan);
  const std::string input = read_text(scan / fmt::format("{}-7.dcm", kText));
  for (const char* text : {kText, "ZQX7PLANTED", kDay, kUid}) {
    ASSERT_THAT(input, HasSubstr(text)) << "is to be found, and not elsewhere";
  }
  fs::create_directories(at("out"));
  std::vector<std::string> build = small_build("out/case.sog");
  build[1] = scan.string();
  const Finished built = run_clipgs(build);
  ASSERT_EQ(built.status, 0) << built.err;
  ASSERT_EQ(run_clipgs({"export", at("out/case.sog"), "-o", at("out/case.glb")}).status, 0);
  ASSERT_EQ(run_clipgs({"unpack", at("out/case.sog"), "-o", at("out/scene.ply")}).status, 0);
  ASSERT_EQ(run_clipgs({"looks", scan.string(), "-o", at("out/looks.webp"), "--quiet"}).status, 0);
  EXPECT_GT(expect_clean_folder(at("out")), 10);
  const Finished told = run_clipgs({"info", at("out/case.sog"), "--privacy", "--json"});
  expect_clean(told.out, "clipgs info --privacy");
  EXPECT_THAT(told.out, Not(HasSubstr("\"foreign\": true")));
}

TEST_F(CliTest, NothingOfAnArchiveIsInWhatIsBuiltFromIt) {
  if (!Orthanc::is_installed()) {
    GTEST_SKIP() << "there is no Orthanc with its DICOMweb plugin here (see scripts/setup.sh)";
  }
  const fs::path scan = fs::path(at("in")) / kText;
  write_ball(scan);
  testing_support::OrthancOptions options;
  options.settings = {{"DicomWeb", {{"Enable", true}, {"Root", fmt::format("/{}/", kText)}}}};
  const Orthanc archive(options);
  archive.upload(scan);
  fs::create_directories(at("out"));
  std::vector<std::string> build = small_build("out/case.sog");
  build[1] = fmt::format("dicomweb+{}/{}/studies/{}.1", archive.url(), kText, kUid);
  // Quicker: what files hold is looked for above.
  build.insert(build.end(), {"--as-scanned", "--no-section"});
  const Finished built = run_clipgs(build);
  ASSERT_EQ(built.status, 0) << built.err;
  expect_clean(built.err, "what clipgs build says");
  EXPECT_GT(expect_clean_folder(at("out")), 10);
  for (const auto& entry : fs::recursive_directory_iterator(at("out"))) {
    if (entry.is_regular_file()) {
      EXPECT_THAT(read_text(entry.path()), Not(HasSubstr(archive.url().substr(7)))) << entry.path();
    }
  }
}

}  // namespace
}  // namespace clipgs
