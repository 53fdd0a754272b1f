#include <archive.h>
#include <archive_entry.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/nameless_file.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Bytes = std::vector<std::uint8_t>;
struct ZipFile {
  std::string name;
  Bytes bytes;
};

void write_zip(const fs::path& path, const std::vector<ZipFile>& files,
               const std::string& password = "") {
  archive* a = archive_write_new();
  archive_write_set_format_zip(a);
  if (!password.empty()) {
    ASSERT_EQ(archive_write_set_options(a, "zip:encryption=traditional"), ARCHIVE_OK);
    archive_write_set_passphrase(a, password.c_str());
  }
  ASSERT_EQ(archive_write_open_filename(a, path.c_str()), ARCHIVE_OK);
  for (const ZipFile& file : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, file.name.c_str());
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_entry_set_size(entry, static_cast<la_int64_t>(file.bytes.size()));
    ASSERT_EQ(archive_write_header(a, entry), ARCHIVE_OK);
    archive_write_data(a, file.bytes.data(), file.bytes.size());
    archive_entry_free(entry);
  }
  archive_write_free(a);
}

Bytes gzipped(const Bytes& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  Bytes packed(deflateBound(&stream, bytes.size()));
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

Bytes text(const std::string& words) { return {words.begin(), words.end()}; }

/// 32 MiB that begin like DICOM.
Bytes bomb() {
  Bytes bytes(size_t{32} << 20);
  std::ranges::copy(std::string_view("DICM"), bytes.begin() + 128);
  return bytes;
}

/// What a hospital hands out, its files named after the patient.
class HandedOut : public testing::Test {
 protected:
  HandedOut() {
    write_series(folder_ / "plain", even_table(8, 2), FixtureSlice());
    FixtureSlice scout;
    scout.series_uid = "1.2.9";
    write_series(folder_ / "scout", even_table(2, 2), scout);
    files_.push_back({"DICOMDIR", text(std::string(200, 'x'))});
    files_.push_back({"AUTORUN.INF", text("[autorun] open=viewer.exe")});
    files_.push_back({"VIEWER/viewer.exe", Bytes(3'000'000)});
    add("plain", "DOE_JOHN/STUDY1/SERIES2/");
    add("scout", "DOE_JOHN/STUDY1/SERIES1/");
    files_.push_back({"DOE_JOHN/empty", {}});
  }

  void add(const std::string& from, const std::string& to) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / from)) {
      files_.push_back({to + entry.path().filename().string(), read_file(entry.path())});
    }
  }

  fs::path zipped() const {
    const fs::path path = folder_ / "study.zip";
    write_zip(path, files_);
    return path;
  }

  TestFolder folder_;
  std::vector<ZipFile> files_;
};

TEST_F(HandedOut, AZipIsReadAsItsFolderWouldBe) {
  testing::internal::CaptureStderr();
  const LoadedVolume loaded = load_with_series(zipped());
  const std::string warnings = testing::internal::GetCapturedStderr();
  const Volume plain = load_volume(folder_ / "plain");
  EXPECT_EQ(loaded.volume.dims, IVec3(16, 12, 8));
  EXPECT_EQ(loaded.volume.values, plain.values);
  EXPECT_EQ(loaded.series.size(), 2);
  EXPECT_THAT(warnings, AllOf(HasSubstr("2) CT, series 7, 2 slices"), Not(HasSubstr("DOE"))));
}

TEST_F(HandedOut, NothingStaysBehind) {
  fs::create_directories(folder_ / "tmp");
  const char* set = std::getenv("TMPDIR");
  const std::string before = set == nullptr ? "" : set;
  setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  const NamelessFile open;
  const bool nameless = fs::is_empty(folder_ / "tmp");
  const fs::path zip = zipped();
  testing::internal::CaptureStderr();
  load_volume(zip);
  testing::internal::GetCapturedStderr();
  const bool empty = fs::is_empty(folder_ / "tmp");
  setenv("TMPDIR", "/nowhere/at/all", 1);
  const std::string error = error_of([&] { load_volume(zip); });
  if (set == nullptr) {
    unsetenv("TMPDIR");
  } else {
    setenv("TMPDIR", before.c_str(), 1);
  }
  EXPECT_TRUE(nameless);
  EXPECT_TRUE(empty);
  EXPECT_THAT(error, HasSubstr("TMPDIR"));
}

TEST_F(HandedOut, ADamagedFileIsNamedByNumber) {
  for (ZipFile& file : files_) {
    if (file.name.ends_with("SERIES2/i7")) {
      file.bytes.resize(file.bytes.size() - 40);
    }
  }
  const std::string error = error_of([&] { load_volume(zipped()); });
  EXPECT_THAT(error, AllOf(HasSubstr("study.zip (its file "), HasSubstr("truncated"),
                           Not(HasSubstr("DOE"))));
}

TEST_F(HandedOut, ADamagedZipIsAnError) {
  const Bytes whole = read_file(zipped());
  for (const size_t length : {size_t{4}, whole.size() / 2, whole.size() - 30}) {
    write_file(folder_ / "study.zip", whole.data(), length);
    const std::string error = error_of([&] { load_volume(folder_ / "study.zip"); });
    EXPECT_THAT(error, HasSubstr("truncated or corrupt ZIP")) << length;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST_F(HandedOut, AWrongChecksumIsNoticed) {
  const fs::path path = zipped();
  Bytes bytes = read_file(path);
  constexpr std::string_view kEntry = "PK\1\2";  // of the central directory
  for (size_t i = 0; i + 20 < bytes.size(); ++i) {
    if (std::ranges::equal(std::span(bytes).subspan(i, kEntry.size()), kEntry)) {
      bytes[i + 16] ^= 1;
    }
  }
  write_file(path, bytes.data(), bytes.size());
  EXPECT_THAT(error_of([&] { load_volume(path); }), HasSubstr("checksum is wrong"));
}

TEST_F(HandedOut, ABombIsRefused) {
  write_zip(folder_ / "bomb.zip", {{"a", bomb()}});
  EXPECT_LT(fs::file_size(folder_ / "bomb.zip"), 1'000'000);
  EXPECT_THAT(error_of([&] { load_volume(folder_ / "bomb.zip"); }),
              HasSubstr("unpacks to more than DICOM does"));
  const Bytes packed = gzipped(bomb());
  write_file(folder_ / "bomb.dcm.gz", packed.data(), packed.size());
  EXPECT_THAT(error_of([&] { load_volume(folder_ / "bomb.dcm.gz"); }),
              HasSubstr("unpacks to more than DICOM does"));
}

TEST_F(HandedOut, APasswordAndOtherThingsAreSaid) {
  write_zip(folder_ / "locked.zip", files_, "secret");
  EXPECT_THAT(error_of([&] { load_volume(folder_ / "locked.zip"); }), HasSubstr("password"));
  write_zip(folder_ / "other.zip", {{"a.txt", text("hello")}});
  EXPECT_THAT(error_of([&] { load_volume(folder_ / "other.zip"); }),
              HasSubstr("no DICOM image with a position"));
}

TEST_F(HandedOut, GzipsOfDicomAreRead) {
  fs::create_directories(folder_ / "packed");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "plain")) {
    const Bytes packed = gzipped(read_file(entry.path()));
    write_plainly(folder_ / "packed" / (entry.path().filename().string() + ".dcm.gz"), packed);
    files_.push_back({"packed/" + entry.path().filename().string(), packed});
  }
  const Volume plain = load_volume(folder_ / "plain");
  EXPECT_EQ(load_volume(folder_ / "packed").values, plain.values);
  EXPECT_EQ(load_volume(folder_ / "packed" / "i7.dcm.gz").values, plain.values);
  std::erase_if(files_, [](const ZipFile& file) { return !file.name.starts_with("packed/"); });
  EXPECT_EQ(load_volume(zipped()).values, plain.values);

  const fs::path one = folder_ / "packed" / "i7.dcm.gz";
  const Bytes whole = read_file(one);
  write_file(one, whole.data(), whole.size() - 9);
  EXPECT_THAT(error_of([&] { load_volume(folder_ / "packed"); }),
              AllOf(HasSubstr("i7.dcm.gz"), HasSubstr("the file ends")));
  Bytes wrong = whole;
  wrong[wrong.size() - 8] ^= 1;
  write_file(one, wrong.data(), wrong.size());
  EXPECT_THAT(error_of([&] { load_volume(one); }), HasSubstr("its checksum is wrong"));
}

TEST_F(HandedOut, AFileOfManyFramesIsReadFromAnywhere) {
  FixtureSlice frames;
  frames.texts = {{0x0028, 0x0008, "3", true}, {0x0018, 0x0088, "2"}};
  for (int frame = 0; frame < 3; ++frame) {
    FixtureSlice one;
    fill(one, 10 * frame);
    frames.pixels.insert(frames.pixels.end(), one.pixels.begin(), one.pixels.end());
  }
  write_dicom(folder_ / "frames.dcm", frames);
  const Volume plain = load_volume(folder_ / "frames.dcm");
  EXPECT_EQ(plain.dims, IVec3(16, 12, 3));
  EXPECT_EQ(plain.spacing, Vec3(1, 1, 2));
  files_ = {{"DOE", read_file(folder_ / "frames.dcm")}};
  EXPECT_EQ(load_volume(zipped()).values, plain.values);
  const Bytes packed = gzipped(files_[0].bytes);
  fs::create_directories(folder_ / "gz");
  write_file(folder_ / "gz" / "frames.dcm.gz", packed.data(), packed.size());
  EXPECT_EQ(load_volume(folder_ / "gz" / "frames.dcm.gz").values, plain.values);
}

}  // namespace
}  // namespace clipgs
