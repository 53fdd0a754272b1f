// clipgs archive with a real Orthanc: what arrives becomes cases, and results go back. The long
// one, in which everything is killed, is packaging/orthanc/test_kills.py.
#include <filesystem>
#include <fmt/format.h>
#include <gdcmReader.h>
#include <gdcmWriter.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "archive/orthanc_fixture.h"

#include "asset/zip.h"
#include "cli/cli_fixture.h"
#include "core/letter_case.h"
#include "volume/dicom_fixture.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::run_clipgs;

/// Whose images they are, as they are planted.
struct PlantedPatient {
  std::string name = "ZQX7^Planted";
  std::string id = "zqx7-4711";
  std::string study = "1.2.999.777.31337";
};

constexpr const char* kPlantedDay = "19010203";

void put_planted(gdcm::DataSet& data, gdcm::Tag tag, gdcm::VR::VRType vr, std::string text) {
  text += text.size() % 2 == 0 ? "" : vr == gdcm::VR::UI ? std::string(1, '\0') : " ";
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
  data.Replace(element);
}

void plant_patient(const fs::path& file, const PlantedPatient& patient) {
  gdcm::Reader reader;
  reader.SetFileName(file.c_str());
  ASSERT_TRUE(reader.Read());
  gdcm::DataSet& data = reader.GetFile().GetDataSet();
  put_planted(data, {0x0010, 0x0010}, gdcm::VR::PN, patient.name);
  put_planted(data, {0x0010, 0x0020}, gdcm::VR::LO, patient.id);
  put_planted(data, {0x0010, 0x0030}, gdcm::VR::DA, kPlantedDay);
  put_planted(data, {0x0020, 0x000d}, gdcm::VR::UI, patient.study);
  put_planted(data, {0x0008, 0x103e}, gdcm::VR::LO, "zqx7 thorax");
  gdcm::Writer writer;
  writer.SetFile(reader.GetFile());
  writer.SetFileName(file.c_str());
  ASSERT_TRUE(writer.Write());
}

/// The phantom as a CT's slices, from the `first` on.
void write_phantom_series(const fs::path& folder, const PlantedPatient& patient, int first,
                          int count, const std::string& series = "1.2.999.777.1") {
  constexpr double kHuOfZero = -1024;
  const Volume volume = make_phantom(40);
  fs::create_directories(folder);
  for (int z = first; z < std::min(first + count, volume.dims.z); ++z) {
    FixtureSlice slice;
    slice.series_uid = series;
    slice.instance = z + 1;
    slice.columns = volume.dims.x;
    slice.rows = volume.dims.y;
    slice.pixel_spacing = {volume.spacing.x, volume.spacing.y};
    slice.row = {-1, 0, 0};  // the volume goes to the right and to the front, DICOM's axes do not
    slice.column = {0, -1, 0};
    const Vec3 corner = volume.world_from_index(Vec3(0, 0, z));
    slice.position = {-corner.x, -corner.y, corner.z};
    for (int i = 0; i < volume.dims.x * volume.dims.y; ++i) {
      const float hu = volume.at(i % volume.dims.x, i / volume.dims.x, z);
      slice.pixels.push_back(static_cast<std::int16_t>(std::lround(hu - kHuOfZero)));
    }
    const fs::path file = folder / fmt::format("{}-{:03}.dcm", series, z);
    write_dicom(file, slice);
    plant_patient(file, patient);
  }
}

class ArchiveTest : public CliTest {
 protected:
  void SetUp() override {
    if (!testing_support::Orthanc::is_installed()) {
      GTEST_SKIP() << "there is no Orthanc";
    }
    testing_support::OrthancOptions options;
    options.user = "clipgs";
    options.password = "secret";
    options.settings = {{"StableAge", 1}};
    orthanc_ = std::make_unique<testing_support::Orthanc>(options);
    client_ = std::make_unique<HttpClient>(orthanc_->url(), orthanc_->client_options());
    write_text(at("credentials"), "clipgs:secret\n");
    fs::permissions(at("credentials"), fs::perms::owner_read);
    write_rules(nlohmann::json::object());
  }

  /// One rule for all CT, with some keys changed.
  void write_rules(const nlohmann::json& changes,
                   const nlohmann::json& rule_changes = nlohmann::json::object()) const {
    nlohmann::json rule = {{"name", "ct"},
                           {"modality", "CT"},
                           {"folder", "ward"},
                           {"build", {{"quality", "instant"}}}};
    rule.merge_patch(rule_changes);
    nlohmann::json rules = {{"clipgs_archive", 1},
                            {"orthanc", orthanc_->url()},
                            {"credentials", at("credentials")},
                            {"public_url", "https://cases.example/"},
                            {"poll_seconds", 1},
                            {"settle_seconds", 0},
                            {"film_pictures", 4},
                            {"film_size", 64},
                            {"rules", {rule}}};
    rules.merge_patch(changes);
    write_text(at("rules.json"), rules.dump());
  }

  std::vector<std::string> archive() const {
    return {"archive", at("rules.json"), "-o", at("cases"), "--once"};
  }

  nlohmann::json ask(const std::string& path) const {
    return nlohmann::json::parse(client_->get(path, "application/json").body);
  }

  void upload(const std::string& folder) const {
    ASSERT_GT(orthanc_->upload(at(folder)), 0);
    wait_until_stable();
  }

  void wait_until_stable() const {
    const auto unstable = [&] {
      for (const nlohmann::json& one : ask("/series?expand")) {
        if (!one["IsStable"]) {
          return true;
        }
      }
      return false;
    };
    while (unstable()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  /// Series of a modality, as Orthanc tells of them.
  std::vector<nlohmann::json> series_of(const std::string& modality) const {
    std::vector<nlohmann::json> found;
    for (const nlohmann::json& one : ask("/series?expand")) {
      if (one["MainDicomTags"].value("Modality", "") == modality) {
        found.push_back(one);
      }
    }
    return found;
  }

  std::string instance_of(const nlohmann::json& series) const { return series["Instances"].at(0); }

  /// Cases in the ward's folder, by their names.
  std::vector<fs::path> cases() const {
    std::vector<fs::path> found;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(at("cases/ward"), absent)) {
      found.push_back(entry.path());
    }
    return found;
  }

  nlohmann::json record_of(const fs::path& case_file) const {
    return nlohmann::json::parse(
        read_text(at("cases.clipgs-archive/" + case_file.stem().string() + ".json")));
  }

  std::unique_ptr<testing_support::Orthanc> orthanc_;
  std::unique_ptr<HttpClient> client_;
};

void expect_no_patient(const std::string& bytes, const std::string& where) {
  const std::string lower = lower_case(bytes);
  for (const char* const text : {"zqx7", kPlantedDay, "1.2.999.777"}) {
    EXPECT_EQ(lower.find(text), std::string::npos) << text << " is in " << where;
  }
}

/// In names, and in what files and the archives among them hold.
void expect_no_patient_in(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    expect_no_patient(fs::relative(entry.path(), folder).string(), "a name");
    if (!entry.is_regular_file()) {
      continue;
    }
    const std::string bytes = read_text(entry.path());
    expect_no_patient(bytes, entry.path().string());
    if (entry.path().extension() == ".sog") {
      for (const auto& [name, content] : read_zip(read_file(entry.path()), "a case")) {
        expect_no_patient(std::string(content.begin(), content.end()), name);
      }
    }
  }
}

TEST_F(ArchiveTest, BuildsWhatArrivesAndPutsResultsBack) {
  write_phantom_series(at("in"), {}, 0, 100);
  upload("in");
  const Finished first = run_clipgs(archive());
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(cases().size(), 1U) << first.err;
  const fs::path made = cases().front();

  // The same bytes as by hand.
  ASSERT_EQ(
      run_clipgs({"build", at("in"), "-o", at("by-hand.sog"), "--quality", "instant", "--quiet"})
          .status,
      0);
  EXPECT_EQ(read_text(made), read_text(at("by-hand.sog")));

  const std::string link =
      fmt::format("https://cases.example/#case=ward%2F{}", made.stem().string());
  const std::vector<nlohmann::json> films = series_of("OT");
  const std::vector<nlohmann::json> reports = series_of("DOC");
  ASSERT_EQ(films.size(), 1U);
  ASSERT_EQ(reports.size(), 1U);
  for (const nlohmann::json& derived : {films[0], reports[0]}) {
    const nlohmann::json tags = ask("/instances/" + instance_of(derived) + "/simplified-tags");
    EXPECT_EQ(tags["PatientName"], "ZQX7^Planted");
    EXPECT_EQ(tags["PatientID"], "zqx7-4711");
    EXPECT_EQ(tags["PatientBirthDate"], kPlantedDay);
    EXPECT_EQ(tags["StudyInstanceUID"], "1.2.999.777.31337");
  }
  const nlohmann::json film = ask("/instances/" + instance_of(films[0]) + "/simplified-tags");
  EXPECT_EQ(film["NumberOfFrames"], "4");
  EXPECT_EQ(film["ImageComments"], link);
  EXPECT_EQ(film["SourceImageSequence"].size(), series_of("CT")[0]["Instances"].size());
  EXPECT_EQ(client_->get("/instances/" + instance_of(films[0]) + "/frames/3/preview", "image/png")
                .head.content_type,
            "image/png");
  const std::string pdf =
      client_->get("/instances/" + instance_of(reports[0]) + "/pdf", "application/pdf").body;
  EXPECT_THAT(pdf, HasSubstr(link));
  EXPECT_EQ(
      client_
          ->get("/series/" + series_of("CT")[0]["ID"].get<std::string>() + "/metadata/1024", "*/*")
          .body,
      link);

  expect_no_patient_in(at("cases"));
  expect_no_patient_in(at("cases.clipgs-archive"));
  expect_no_patient(first.err + first.out, "the log");
  expect_no_patient(pdf, "the report");

  // Again: nothing is built of what is done, and nothing of what clipgs made.
  const auto before = fs::last_write_time(made);
  wait_until_stable();
  const Finished again = run_clipgs(archive());
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "");
  EXPECT_EQ(fs::last_write_time(made), before);
  EXPECT_EQ(ask("/instances").size(), series_of("CT")[0]["Instances"].size() + 2);

  // With its records lost it is built anew, and what goes back is there already.
  fs::remove_all(at("cases.clipgs-archive"));
  ASSERT_EQ(run_clipgs(archive()).status, 0);
  EXPECT_EQ(ask("/instances").size(), series_of("CT")[0]["Instances"].size() + 2);
}

TEST_F(ArchiveTest, BuildsAnewWhatGrew) {
  write_rules(nlohmann::json::object(), {{"back", {"link"}}});
  write_phantom_series(at("half"), {}, 0, 24);
  upload("half");
  ASSERT_EQ(run_clipgs(archive()).status, 0);
  ASSERT_EQ(cases().size(), 1U);
  const fs::path made = cases().front();
  const std::string half = read_text(made);

  write_phantom_series(at("rest"), {}, 24, 100);
  upload("rest");
  const Finished grown = run_clipgs(archive());
  ASSERT_EQ(grown.status, 0) << grown.err;
  ASSERT_EQ(cases().size(), 1U);
  EXPECT_NE(read_text(made), half);
  const nlohmann::json record = record_of(made);
  EXPECT_EQ(record["stage"], "done");

  // The same images once more, stored anew: they are read, and known.
  for (const nlohmann::json& series : series_of("CT")) {
    client_->del("/series/" + series["ID"].get<std::string>());
  }
  upload("half");
  upload("rest");
  const Finished same = run_clipgs(archive());
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_THAT(same.err, Not(HasSubstr("built")));
  EXPECT_EQ(record_of(made)["content"], record["content"]);
  EXPECT_NE(record_of(made)["listing"], record["listing"]);
}

TEST_F(ArchiveTest, KeepsPatientsOfOneSeriesUidApart) {
  write_rules(nlohmann::json::object(), {{"back", {"report"}}});
  write_phantom_series(at("one"), {"ZQX7^One", "1", "1.2.999.777.10"}, 0, 100);
  write_phantom_series(at("two"), {"ZQX7^Two", "2", "1.2.999.777.20"}, 8, 100);
  upload("one");
  upload("two");
  const Finished finished = run_clipgs(archive());
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(cases().size(), 2U);
  std::map<std::string, size_t> sources;
  for (const nlohmann::json& report : series_of("DOC")) {
    const nlohmann::json tags = ask("/instances/" + instance_of(report) + "/simplified-tags");
    sources[tags["PatientName"]] = tags["SourceInstanceSequence"].size();
  }
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources["ZQX7^One"], sources["ZQX7^Two"] + 8);
}

TEST_F(ArchiveTest, LeavesAloneWhatCannotBeBuilt) {
  write_rules({{"tries", 1}}, {{"modality", nullptr}, {"back", nlohmann::json::array()}});
  FixtureSlice report;  // without pixels, as structured reports are
  report.modality = "SR";
  report.series_uid = "1.2.999.777.2";
  fs::create_directories(at("in"));
  fill(report);
  write_dicom(at("in/report.dcm"), report);
  gdcm::Reader reader;
  reader.SetFileName(at("in/report.dcm").c_str());
  ASSERT_TRUE(reader.Read());
  for (const gdcm::Tag& tag : {gdcm::Tag(0x0028, 0x0010), {0x0028, 0x0011}, {0x7fe0, 0x0010}}) {
    reader.GetFile().GetDataSet().Remove(tag);
  }
  gdcm::Writer writer;
  writer.SetFile(reader.GetFile());
  writer.SetFileName(at("in/report.dcm").c_str());
  ASSERT_TRUE(writer.Write());
  write_phantom_series(at("in"), {}, 0, 1, "1.2.999.777.3");  // one slice is no volume
  write_phantom_series(at("in"), {}, 0, 100);
  upload("in");

  const Finished finished = run_clipgs(archive());
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("is left alone"));
  EXPECT_THAT(finished.err, HasSubstr("1 series could not be built"));
  expect_no_patient(finished.err, "the log");
  size_t failed = 0;
  size_t done = 0;
  for (const auto& entry : fs::directory_iterator(at("cases.clipgs-archive"))) {
    if (entry.path().extension() == ".json") {
      const nlohmann::json record = nlohmann::json::parse(read_text(entry.path()));
      failed += record["stage"] == "failed" && !record["reason"].get<std::string>().empty() ? 1 : 0;
      done += record["stage"] == "done" ? 1 : 0;
    }
  }
  EXPECT_EQ(failed, 1U);
  EXPECT_EQ(done, 1U);
  EXPECT_EQ(run_clipgs(archive()).status, 0);
  std::vector<std::string> retry = archive();
  retry.push_back("--retry");
  EXPECT_EQ(run_clipgs(retry).status, 1);
}

TEST_F(ArchiveTest, SaysInALineWhatIsWrongWithOrthanc) {
  write_text(at("credentials"), "clipgs:wrong");
  fs::permissions(at("credentials"), fs::perms::owner_read);
  expect_failure(archive(), "does not take the credentials");
  write_rules({{"orthanc", fmt::format("http://127.0.0.1:{}", testing_support::free_port())}});
  expect_failure(archive(), "nobody answers there");
  write_rules({{"polls", 3}});
  expect_failure(archive(), "\"polls\" is no key there");
}

}  // namespace
}  // namespace clipgs
