#include "archive/incoming_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/dicom_fixture.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The bytes of one image.
std::string image(const TestFolder& folder, int number, const std::string& patient = "p",
                  const std::string& series = "1.2.3") {
  FixtureSlice slice;
  slice.patient = patient;
  slice.series_uid = series;
  slice.instance = number;
  fill(slice);
  write_dicom(folder / "image", slice);
  return read_text(folder / "image");
}

void take(IncomingSeries& incoming, const std::string& bytes) {
  incoming.begin();
  incoming.receive(bytes);
  incoming.end();
}

size_t files_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<size_t>(std::distance(begin(files), end(files)));
}

TEST(IncomingSeries, NumbersWhatComesAndGoesOnFromIt) {
  const TestFolder folder;
  create_folder(folder / "in");
  {
    IncomingSeries incoming(folder / "in", "1.2.3", "archive");
    take(incoming, image(folder, 1));
    take(incoming, image(folder, 2));
    take(incoming, image(folder, 2));
    EXPECT_EQ(incoming.instances().size(), 2U) << "one came twice";
    incoming.begin();
    incoming.receive(image(folder, 3).substr(0, 901));
  }
  EXPECT_EQ(files_in(folder / "in"), 2U) << "what did not come whole is gone";
  write_text(folder / "in" / "000001.dcm", image(folder, 1).substr(0, 901));
  IncomingSeries again(folder / "in", "1.2.3", "archive");
  EXPECT_EQ(again.instances().size(), 1U);
  take(again, image(folder, 1));
  EXPECT_EQ(again.instances().size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(folder / "in/000001.dcm"));
  EXPECT_TRUE(std::filesystem::exists(folder / "in/000002.dcm"));
  EXPECT_EQ(again.bytes(), image(folder, 1).size() + image(folder, 2).size());
}

TEST(IncomingSeries, TakesNothingElse) {
  const TestFolder folder;
  create_folder(folder / "in");
  IncomingSeries incoming(folder / "in", "1.2.3", "archive");
  take(incoming, image(folder, 1, "one patient"));
  const auto error = [&](const std::string& bytes) {
    return error_of([&] { take(incoming, bytes); });
  };
  EXPECT_THAT(error("<html>"), HasSubstr("no DICOM file"));
  EXPECT_THAT(error(""), HasSubstr("no DICOM file"));
  EXPECT_THAT(error(image(folder, 2).substr(0, 901)), HasSubstr("truncated or corrupt"));
  EXPECT_THAT(error(image(folder, 2, "one patient", "1.2.4")), HasSubstr("of another series"));
  const std::string mixed = error(image(folder, 2, "another patient"));
  EXPECT_THAT(mixed, HasSubstr("archive: this series holds images of two patients"));
  EXPECT_THAT(mixed, Not(HasSubstr("one patient")));
  EXPECT_THAT(mixed, Not(HasSubstr("another patient")));
  EXPECT_EQ(incoming.instances().size(), 1U);
}

}  // namespace
}  // namespace clipgs
