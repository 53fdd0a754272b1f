// Series of a real archive as commands take them.
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "archive/orthanc_fixture.h"

#include "cli/cli_fixture.h"
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
using testing_support::run_clipgs_and_kill;

constexpr const char* kStudy = "1.2.826.0.1.3680043.2.1125.0";

/// An archive that wants a password, with a study of two series, and temporary files where they can
/// be counted.
class ArchiveCli : public CliTest {
 protected:
  void SetUp() override {
    if (!Orthanc::is_installed()) {
      GTEST_SKIP() << "there is no Orthanc with its DICOMweb plugin here (see scripts/setup.sh)";
    }
    ::setenv("CLIPGS_ARCHIVE_PASSWORD", "very-secret", 1);
  }
  ~ArchiveCli() override {
    ::unsetenv("TMPDIR");
    ::unsetenv("CLIPGS_ARCHIVE_PASSWORD");
  }

  std::unique_ptr<Orthanc> start() const {
    testing_support::OrthancOptions options;
    options.user = "me";
    options.password = "very-secret";
    auto archive = std::make_unique<Orthanc>(options);  // whose own files lie elsewhere
    fs::create_directories(at("tmp"));
    ::setenv("TMPDIR", at("tmp").c_str(), 1);
    return archive;
  }

  void write_scan(const std::string& uid, int slices) const {
    FixtureSlice slice;
    slice.series_uid = uid;
    slice.columns = slice.rows = 24;
    fs::create_directories(at("scan"));
    write_series(at("scan"), even_table(slices, 2), slice, uid + "-");
  }

  bool nothing_is_left() const { return fs::is_empty(at("tmp")); }
};

TEST_F(ArchiveCli, FetchesTellsAndBuilds) {
  write_scan("1.2.3.1", 24);
  write_scan("1.2.3.2", 8);
  const auto archive = start();
  archive->upload(at("scan"));
  const std::string address =
      fmt::format("dicomweb+{}/dicom-web/studies/{}", archive->url(), kStudy);

  const Finished fetched = run_clipgs({"fetch", address, "-o", at("ct"), "--user", "me", "--json"});
  ASSERT_EQ(fetched.status, 0) << fetched.err;
  const auto told = nlohmann::json::parse(fetched.out);
  EXPECT_EQ(told.at("files"), 24);
  EXPECT_EQ(told.at("series").at(0).at("uid"), "1.2.3.1");
  EXPECT_TRUE(told.at("series").at(0).at("taken").get<bool>());
  EXPECT_EQ(told.at("series").at(1).at("images"), 8);
  EXPECT_THAT(fetched.err, HasSubstr("2 series: 1) CT, series 7, 24 images; 2) CT"));
  EXPECT_THAT(fetched.err, Not(HasSubstr("1.2.3.1")));

  const Finished info =
      run_clipgs({"info", address, "--user", "me", "--series", "1.2.3.2", "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out).at("dims").at(2), 8);

  for (const std::string& volume : {at("ct"), address}) {
    const Finished built =
        run_clipgs({"build", volume, "-o", at(volume == address ? "a.sog" : "b.sog"), "--quality",
                    "instant", "--user", "me"});
    ASSERT_EQ(built.status, 0) << built.err;
  }
  EXPECT_EQ(read_text(at("a.sog")), read_text(at("b.sog"))) << "as from the folder";
  EXPECT_TRUE(nothing_is_left());

  write_text(at("password"), "wrong\n");
  expect_failure(
      {"fetch", address, "-o", at("x"), "--user", "me", "--password-file", at("password")},
      "everybody on this machine may read this secret");
  fs::permissions(at("password"), fs::perms::owner_read);
  expect_failure(
      {"build", address, "-o", at("x.sog"), "--user", "me", "--password-file", at("password")},
      "(401)", at("x.sog"));
  expect_failure({"build", address, "-o", at("x.sog"), "--user", "me", "--series", "3"},
                 "no series \"3\"", at("x.sog"));
  expect_failure({"build", address, "-o", at("x.sog"), "--user", "me", "--gaps", "refuse", "--crop",
                  "900,901,900,901,900,901"},
                 "", at("x.sog"));
  EXPECT_TRUE(nothing_is_left()) << "after errors";
  EXPECT_EQ(
      run_clipgs({"fetch", address + "/series/1.2.3.1", "-o", at("x"), "--series", "1"}).status, 2);

  run_clipgs_and_kill({"build", address, "-o", at("x.sog"), "--user", "me", "--quality", "instant"},
                      0.15);
  for (int i = 0; i < 100 && !nothing_is_left(); ++i) {
    ::usleep(20'000);
  }
  EXPECT_TRUE(nothing_is_left()) << "after kill -9";
}

}  // namespace
}  // namespace clipgs
