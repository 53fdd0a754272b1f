// Series from a real archive, Orthanc, and from ones that do wrong.
#include "archive/fetch.h"

#include <atomic>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "archive/orthanc_fixture.h"
#include "archive/test_sockets.h"

#include "core/file.h"
#include "core/progress.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;
using testing_support::connect_to;
using testing_support::make_tls_gate;
using testing_support::Orthanc;
using testing_support::OrthancOptions;
using testing_support::read_head;
using testing_support::ScratchFolder;
using testing_support::send_all;
using testing_support::SocketServer;
using testing_support::TestAuthority;
using testing_support::tunnel;

constexpr const char* kStudy = "1.2.826.0.1.3680043.2.1125.0";
constexpr const char* kSeries = "1.2.826.0.1.3680043.2.1125.1";
constexpr const char* kUser = "doctor";
constexpr const char* kPassword = "very-secret";

/// A series of noise that no compression makes small; instance numbers from `first` on.
void write_images(const fs::path& folder, int count, int first = 1, int wide = 16) {
  fs::create_directories(folder);
  for (int i = first; i < first + count; ++i) {
    FixtureSlice slice;
    slice.patient = "patient";
    slice.instance = i;
    slice.columns = slice.rows = wide;
    slice.position.z = i;
    for (int pixel = 0; pixel < wide * wide; ++pixel) {
      slice.pixels.push_back(static_cast<std::int16_t>(pixel * 7919 + i * 104729));
    }
    write_dicom(folder / std::to_string(i), slice);
  }
}

/// The archive of all tests here, with a series of 30 images.
Orthanc& the_archive() {
  static const std::unique_ptr<Orthanc> kArchive = [] {
    OrthancOptions options;
    options.tls = true;
    options.user = kUser;
    options.password = kPassword;
    auto archive = std::make_unique<Orthanc>(options);
    const ScratchFolder folder;
    write_images(folder.path(), 30);
    archive->upload(folder.path());
    return archive;
  }();
  return *kArchive;
}

HttpOptions quick(HttpOptions options) {
  options.first_wait = milliseconds(5);
  options.idle_limit = milliseconds(5000);
  return options;
}

Fetched fetch(const std::string& base, const HttpOptions& options, const fs::path& folder,
              const std::string& series = kSeries, const std::string& study = kStudy) {
  HttpClient client(base + "/dicom-web", quick(options));
  DicomWebStudy found(client, study);
  return fetch_series(found, series, folder);
}

size_t count_of(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), {}));
}

class FetchTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Orthanc::is_installed()) {
      GTEST_SKIP() << "there is no Orthanc with its DICOMweb plugin here (see scripts/setup.sh)";
    }
  }
  TestFolder folder_;
};

TEST_F(FetchTest, BringsTheVolumeThatWasStored) {
  const Orthanc& archive = the_archive();
  const fs::path out = folder_ / "out";
  const Fetched fetched = fetch(archive.url(), archive.client_options(), out);
  EXPECT_EQ(fetched.files, 30U);
  EXPECT_EQ(count_of(out), 30U);
  EXPECT_EQ(fs::status(out).permissions(), fs::perms::owner_all);
  EXPECT_EQ(count_of(folder_.path()), 1U) << "nothing is left beside it";
  write_images(folder_ / "stored", 30);
  const Volume stored = load_volume(folder_ / "stored");
  const Volume brought = load_volume(out);
  EXPECT_EQ(stored.values, brought.values);
  EXPECT_EQ(stored.dims, brought.dims);
  EXPECT_EQ(stored.origin, brought.origin);
  EXPECT_THAT(error_of([&] { fetch(archive.url(), archive.client_options(), out); }),
              HasSubstr("is there already"));
}

TEST_F(FetchTest, SaysWhoIsNotLetIn) {
  const Orthanc& archive = the_archive();
  HttpOptions options = archive.client_options();
  options.password = "wrong";
  const auto error = [&](const std::string& series, const std::string& study) {
    return error_of([&] { fetch(archive.url(), options, folder_ / "out", series, study); });
  };
  EXPECT_THAT(error(kSeries, kStudy), HasSubstr("does not take this token or password (401)"));
  options.authorities.clear();
  EXPECT_THAT(error(kSeries, kStudy), HasSubstr("is not trusted"));
  options = archive.client_options();
  EXPECT_THAT(error("1.2.3", kStudy), HasSubstr("no such series"));
  EXPECT_THAT(error("1.2.3", "1.2"), HasSubstr("no such series"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(FetchTest, ShowsItsCertificateWhereTheGatewayWantsOne) {
  const Orthanc& archive = the_archive();
  TestAuthority authority;
  const auto gate =
      make_tls_gate(archive.http_port(), authority.issue("gate").both, authority.certificate());
  const std::string url = fmt::format("https://127.0.0.1:{}", gate->port());
  HttpOptions options = archive.client_options();
  options.authorities = authority.certificate();
  EXPECT_THAT(error_of([&] { fetch(url, options, folder_ / "out"); }),
              HasSubstr("give --client-certificate"));
  const TestAuthority::Issued mine = authority.issue("me");
  options.certificate = mine.certificate;
  options.key = mine.key;
  EXPECT_EQ(fetch(url, options, folder_ / "out").files, 30U);
}

TEST_F(FetchTest, TakesATokenWhereTheArchiveWantsOne) {
  const fs::path script = folder_ / "token.lua";
  write_text(script,
             "function IncomingHttpRequestFilter(method, uri, ip, username, headers)\n"
             "  return headers['authorization'] == 'Bearer very-secret'\nend\n");
  OrthancOptions options;
  options.settings = {{"LuaScripts", {script.string()}}};
  const Orthanc archive(options);
  HttpClient nobody(archive.url() + "/dicom-web", quick({}));
  EXPECT_THAT(error_of([&] { DicomWebStudy(nobody, kStudy).series(); }), HasSubstr("(40"));
  HttpOptions known;
  known.token = "very-secret";
  HttpClient client(archive.url() + "/dicom-web", quick(known));
  EXPECT_TRUE(DicomWebStudy(client, kStudy).series().empty());
}

TEST_F(FetchTest, TakesTheLargestSeriesOfPicturesAndListsTheOthers) {
  const Orthanc& archive = the_archive();
  const std::vector<std::tuple<const char*, const char*, int>> others = {
      {"1.2.3.1", "CT", 3}, {"1.2.3.2", "SR", 5}, {"1.2.4.1", "SR", 1}, {"1.2.4.2", "PR", 2}};
  for (const auto& [uid, modality, count] : others) {
    FixtureSlice slice;
    slice.study_uid = std::string(uid).substr(0, 5);
    slice.series_uid = uid;
    slice.modality = modality;
    for (slice.instance = 1; slice.instance <= count; ++slice.instance) {
      fill(slice);
      write_dicom(folder_ / fmt::format("{}-{}", uid, slice.instance), slice);
    }
  }
  archive.upload(folder_.path());
  HttpClient client(archive.url() + "/dicom-web", quick(archive.client_options()));
  const std::vector<ArchiveSeries> list = DicomWebStudy(client, "1.2.3").series();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].uid, "1.2.3.1");
  EXPECT_EQ(list[0].describe(), "CT, series 7, 3 images");
  EXPECT_FALSE(list[1].shows_pictures());
  EXPECT_EQ(choose_series(list, "", "archive"), 0U);
  EXPECT_EQ(choose_series(list, "2", "archive"), 1U);
  EXPECT_EQ(choose_series(list, "1.2.3.2", "archive"), 1U);
  EXPECT_THAT(error_of([&] { choose_series(list, "3", "archive"); }),
              HasSubstr("archive: no series \"3\": give a number from 1 to 2"));
  const std::vector<ArchiveSeries> none = DicomWebStudy(client, "1.2.4").series();
  EXPECT_THAT(error_of([&] { choose_series(none, "", "archive"); }),
              HasSubstr("a study without images: 1) PR, series 7, 2 images; 2) SR"));
  EXPECT_THAT(
      error_of([&] { choose_series(DicomWebStudy(client, "1.9").series(), "", "archive"); }),
      HasSubstr("no such study"));
}

/// What a fetch does meanwhile, once, when the first image has come.
class AtTheFirstImage {
 public:
  explicit AtTheFirstImage(std::function<void()> action) {
    Progress::set_watcher(
        [action = std::move(action), done = false](const std::string&, double) mutable {
          if (!std::exchange(done, true)) {
            action();
          }
        });
  }
  ~AtTheFirstImage() { Progress::set_watcher(nullptr); }
  AtTheFirstImage(const AtTheFirstImage&) = delete;
  AtTheFirstImage& operator=(const AtTheFirstImage&) = delete;
};

TEST_F(FetchTest, ASeriesThatGrowsMeanwhileIsFetchedWhole) {
  const Orthanc archive;
  write_images(folder_ / "stored", 10);
  archive.upload(folder_ / "stored");
  const AtTheFirstImage grow([&] {
    write_images(folder_ / "more", 2, 11);
    archive.upload(folder_ / "more");
  });
  EXPECT_EQ(fetch(archive.url(), {}, folder_ / "out").files, 12U);
  EXPECT_EQ(load_volume(folder_ / "out").dims.z, 12);
}

TEST_F(FetchTest, AnArchiveThatDiesIsAnErrorAndWhatCameIsKept) {
  write_images(folder_ / "stored", 20, 1, 200);  // 80 kB each
  auto archive = std::make_unique<Orthanc>();
  archive->upload(folder_ / "stored");
  std::atomic<std::uint64_t> most = 700'000;
  const SocketServer gateway([&](int socket) {
    const int inside = connect_to(archive->http_port());
    tunnel(socket, inside, most);
    if (most != UINT64_MAX) {
      archive->kill();
    }
    ::close(inside);
  });
  const std::string url = fmt::format("http://127.0.0.1:{}", gateway.port());
  EXPECT_THAT(error_of([&] { fetch(url, {}, folder_ / "out"); }),
              HasSubstr("the connection was cut"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  const fs::path part = folder_ / "out.clipgs-part";
  const size_t came = count_of(part);
  EXPECT_GT(came, 4U);
  EXPECT_LT(came, 12U);

  archive = std::make_unique<Orthanc>();
  archive->upload(folder_ / "stored");
  most = UINT64_MAX;
  const auto first = fs::last_write_time(part / "000001.dcm");
  EXPECT_EQ(fetch(url, {}, folder_ / "out").files, 20U);
  EXPECT_EQ(fs::last_write_time(folder_ / "out/000001.dcm"), first) << "it goes on";
  EXPECT_EQ(load_volume(folder_ / "out").values, load_volume(folder_ / "stored").values);
  EXPECT_FALSE(fs::exists(part));
}

/// Answers lists as an archive does that has one series of these images, and files with `wado`.
class FalseArchive {
 public:
  FalseArchive(int said, int listed, std::string wado)
      : said_(said),
        listed_(listed),
        wado_(std::move(wado)),
        server_([this](int socket) { send_all(socket, answer_to(read_head(socket))); }) {}

  std::string url() const { return fmt::format("http://127.0.0.1:{}", server_.port()); }

 private:
  static std::string json(const std::string& body) {
    return fmt::format(
        "HTTP/1.1 200 OK\r\nContent-Type: application/dicom+json\r\n"
        "Content-Length: {}\r\n\r\n{}",
        body.size(), body);
  }

  std::string answer_to(const std::string& head) const {
    if (head.find("/instances?") != std::string::npos) {
      std::string list;
      for (int i = 1; i <= listed_; ++i) {
        list += fmt::format(R"({}{{"00080018": {{"vr": "UI", "Value": ["{}.{}"]}}}})",
                            i == 1 ? "" : ",", kSeries, i);
      }
      return json("[" + list + "]");
    }
    if (head.find("/series?") != std::string::npos) {
      return json(fmt::format(R"([{{"0020000E": {{"vr": "UI", "Value": ["{}"]}},
                                   "00201209": {{"vr": "IS", "Value": ["{}"]}}}}])",
                              kSeries, said_));
    }
    return wado_;
  }

  int said_;
  int listed_;
  std::string wado_;
  SocketServer server_;
};

std::string wado(const std::string& type, const std::string& body) {
  return fmt::format("HTTP/1.1 200 OK\r\nContent-Type: {}\r\nContent-Length: {}\r\n\r\n{}", type,
                     body.size(), body);
}

TEST_F(FetchTest, WhatIsNotTheSeriesIsAnError) {
  write_images(folder_ / "stored", 1);
  const std::string image = read_text(folder_ / "stored/1");
  const std::string type = "multipart/related; boundary=b";
  const std::string part = "--b\r\n\r\n" + image + "\r\n";
  const std::vector<std::tuple<int, int, std::string, std::string>> wrong = {
      {1, 1, wado("text/html", "<html>log in</html>"), "answers no DICOM files"},
      {1, 1, wado("multipart/related; boundary=c", part + "--b--"), "its answer was cut"},
      {1, 1, wado(type, "--b\r\n\r\n<html>\r\n--b--"), "no DICOM file"},
      {2, 2, wado(type, part + "--b--"), "says that the series has 2 images, and 1 came"},
      {2, 1, wado(type, part + "--b--"), "says that the series has 2 images, and 1 came"},
      {0, 0, "", "no such series"}};
  for (const auto& [said, listed, answer, line] : wrong) {
    const FalseArchive archive(said, listed, answer);
    EXPECT_THAT(error_of([&] { fetch(archive.url(), {}, folder_ / "out"); }), HasSubstr(line));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
  const FalseArchive good(1, 1, wado(type, part + "--b--"));
  EXPECT_EQ(fetch(good.url(), {}, folder_ / "out").files, 1U);
}

TEST_F(FetchTest, APageForBrowsersIsNoDicomWeb) {
  const SocketServer server([](int socket) {
    read_head(socket);
    send_all(socket, wado("text/html", "<html>Welcome to Orthanc</html>"));
  });
  EXPECT_THAT(error_of([&] {
                fetch(fmt::format("http://127.0.0.1:{}", server.port()), {}, folder_ / "out");
              }),
              HasSubstr("answers something else than DICOMweb"));
}

TEST(DicomWebAddress, NamesAStudyOrASeries) {
  const DicomWebAddress study = parse_dicomweb("dicomweb+https://a.example/rs/studies/1.2.3/");
  EXPECT_EQ(study.base, "https://a.example/rs");
  EXPECT_EQ(study.study, "1.2.3");
  EXPECT_EQ(study.series, "");
  EXPECT_EQ(parse_dicomweb("dicomweb+http://[::1]:1/studies/1.2/series/1.2.9").series, "1.2.9");
  for (const char* wrong :
       {"dicomweb+https://a.example", "dicomweb+https://a.example/studies/",
        "dicomweb+https://a.example/studies/1.2/series/", "dicomweb+https://a.example/studies/1..2",
        "dicomweb+https://a.example/studies/../series/1",
        "dicomweb+https://a.example/studies/1.2/x", "dicomweb+ftp://a.example/studies/1.2",
        "dicomweb+https://u:p@a.example/studies/1.2"}) {
    EXPECT_NE(error_of([&] { parse_dicomweb(wrong); }), "") << wrong;
  }
}

}  // namespace
}  // namespace clipgs
