#include "asset/privacy.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "asset/case.h"
#include "asset/zip.h"
#include "core/error.h"
#include "core/file.h"
#include "section/test_section.h"
#include "splat/test_scene.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

std::optional<PrivacyNote> note_of(const std::vector<PrivacyNote>& notes,
                                   const std::string& where) {
  const auto found = std::ranges::find(notes, where, &PrivacyNote::where);
  return found == notes.end() ? std::nullopt : std::optional(*found);
}

Bytes a_case() {
  Scene scene = layered_scene(40, 1, 2);
  scene.title = "Teaching head";
  scene.created = "2026-11-28";
  scene.look.part = BodyPart::kHead;
  return encode_case({std::move(scene), test::ball_section()}, nullptr);
}

class Privacy : public testing::Test {
 protected:
  std::vector<PrivacyNote> notes(const Bytes& bytes) {
    write_file(folder_ / "a.sog", bytes.data(), bytes.size());
    return privacy_notes(folder_ / "a.sog");
  }
  const TestFolder folder_;
};

TEST_F(Privacy, TellsAllThatACaseSaysOfItsOriginAndNothingForeign) {
  const std::vector<PrivacyNote> said = notes(a_case());
  EXPECT_EQ(note_of(said, "title")->value, "Teaching head");
  EXPECT_EQ(note_of(said, "created")->value, "2026-11-28");
  EXPECT_EQ(note_of(said, "look.region")->value, "head");
  EXPECT_TRUE(note_of(said, "section.origin"));
  EXPECT_THAT(note_of(said, "the body")->what, HasSubstr("face"));
  EXPECT_TRUE(std::ranges::none_of(said, &PrivacyNote::foreign));
  EXPECT_FALSE(note_of(said, "a.marks.json"));
  write_text(folder_ / "a.marks.json", "{}");
  EXPECT_THAT(note_of(notes(a_case()), "a.marks.json")->what, HasSubstr("typed"));
}

TEST_F(Privacy, SaysThatAFaceWasTakenOff) {
  Scene scene = layered_scene(40, 1, 2);
  scene.look = {"0123456789abcdef", "", "", Modality::kMr, BodyPart::kHead, Defaced{272.1f, 5}};
  const std::vector<PrivacyNote> said = notes(encode_case({std::move(scene)}, nullptr));
  EXPECT_THAT(note_of(said, "look.defaced")->value, HasSubstr("272.1"));
  EXPECT_FALSE(note_of(said, "look.defaced")->foreign);
  EXPECT_THAT(note_of(said, "the body")->what, HasSubstr("was taken off"));
}

TEST_F(Privacy, FindsWhatNoClipgsWrites) {
  std::vector<ZipEntry> files;
  for (auto& [name, bytes] : read_zip(a_case(), "test")) {
    files.push_back({name, bytes});
  }
  const auto meta = std::ranges::find(files, "meta.json", &ZipEntry::name);
  nlohmann::json said = nlohmann::json::parse(meta->bytes.begin(), meta->bytes.end());
  said["clipgs"]["patient"] = "Doe^Jane";
  said["clipgs"]["look"]["station"] = "CT 3";
  said["clipgs"]["section"]["uid"] = "1.2.3";
  said["comment"] = "from Dr. X";
  const std::string text = said.dump();
  meta->bytes.assign(text.begin(), text.end());
  files.push_back({"letter.pdf", {1, 2, 3}});
  const auto image = std::ranges::find(files, "quats.webp", &ZipEntry::name);
  const std::string exif = std::string("EXIF") + std::string("\2\0\0\0ab", 6);
  image->bytes.insert(image->bytes.end(), exif.begin(), exif.end());
  const std::vector<PrivacyNote> found = notes(write_zip(files));
  for (const char* where : {"patient", "look.station", "section.uid", "meta.json: comment",
                            "letter.pdf", "quats.webp"}) {
    ASSERT_TRUE(note_of(found, where)) << where;
    EXPECT_TRUE(note_of(found, where)->foreign) << where;
  }
  EXPECT_EQ(note_of(found, "patient")->value, "Doe^Jane");
  EXPECT_EQ(std::ranges::count_if(found, &PrivacyNote::foreign), 6);
  EXPECT_TRUE(found.front().foreign) << "first what should not be there";
}

TEST_F(Privacy, OfWhatIsNoCaseIsALine) {
  EXPECT_THROW(notes({1, 2, 3}), Error);
  EXPECT_THROW(privacy_notes(folder_ / "gone.sog"), Error);
}

}  // namespace
}  // namespace clipgs
