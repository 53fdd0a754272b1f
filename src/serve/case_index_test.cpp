#include "serve/case_index.h"

#include <fcntl.h>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "serve/test_cases.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// What was read from files and pipes by this program so far, in bytes.
std::uint64_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string key;
  std::uint64_t value = 0;
  io >> key >> value;
  EXPECT_EQ(key, "rchar:");
  return value;
}

/// The case of that name as the index sees it: its title, or its error, or "none".
std::string seen(CaseIndex& index, const std::string& name) {
  const auto entry = index.find(name);
  std::string listed = "none";
  for (const auto& one : index.list()) {
    if (one->name == name) {
      listed = one->error.empty() ? one->info.scene.title : one->error;
    }
  }
  const std::string found = !entry                 ? "none"
                            : entry->error.empty() ? entry->info.scene.title
                                                   : entry->error;
  EXPECT_EQ(listed, found);
  return found;
}

TEST(CaseIndex, ReadsOfHugeFilesWhatItNeeds) {
  const TestFolder folder;
  // 3 GB that are no case, and a case of 600 MB, both full of holes.
  {
    const std::ofstream empty(folder / "huge.sog");
  }
  fs::resize_file(folder / "huge.sog", std::uintmax_t{3'000'000'000});
  {
    const std::ofstream empty(folder / "hollow.sog");
  }
  fs::resize_file(folder / "hollow.sog", std::uintmax_t{600'000'000});
  test::write_large_case(folder / "large.sog", 30'000'000);
  CaseIndex index(folder.path());
  const std::uint64_t before = bytes_read();
  EXPECT_THAT(seen(index, "huge"), HasSubstr("huge.sog: is 3000000000 bytes long"));
  EXPECT_THAT(seen(index, "hollow"), HasSubstr("hollow.sog: is not a readable case"));
  EXPECT_EQ(seen(index, "large"), "Large");
  EXPECT_LT(bytes_read() - before, 4'000'000U);
}

TEST(CaseIndex, FollowsLinksWithinTheFolderAlone) {
  const TestFolder folder;
  const fs::path cases = folder / "cases";
  fs::create_directories(cases / "more");
  test::write_small_case(folder / "private.sog", "Private");
  test::write_small_case(cases / "head.sog", "A head");
  test::write_small_case(cases / "more" / "hand.sog", "A hand");
  fs::create_symlink(folder / "private.sog", cases / "absolute.sog");
  fs::create_symlink("../private.sog", cases / "relative.sog");
  fs::create_symlink("relative.sog", cases / "twice.sog");
  fs::create_directory_symlink(folder.path(), cases / "door");
  fs::create_symlink("door/private.sog", cases / "through.sog");
  fs::create_symlink("head.sog", cases / "same.sog");
  fs::create_symlink(cases / "more" / "hand.sog", cases / "hand.sog");
  fs::create_symlink("nothing.sog", cases / "dangling.sog");
  // As a string the folder's path begins this one.
  fs::create_directories(folder / "cases2");
  test::write_small_case(folder / "cases2" / "other.sog", "Other");
  fs::create_symlink("../cases2/other.sog", cases / "beside.sog");
  CaseIndex index(cases);
  for (const char* name : {"absolute", "relative", "twice", "through", "beside"}) {
    EXPECT_THAT(seen(index, name), HasSubstr(std::string(name) + ".sog: is a link that leaves"));
    EXPECT_EQ(index.find(name)->bytes, 0U) << "is nobody's business";
  }
  EXPECT_EQ(seen(index, "same"), "A head");
  EXPECT_EQ(seen(index, "hand"), "A hand");
  EXPECT_EQ(seen(index, "dangling"), "none");
  EXPECT_EQ(seen(index, "door/private"), "none");
  EXPECT_EQ(seen(index, "more/hand"), "none");
  EXPECT_EQ(seen(index, "../private"), "none");
}

TEST(CaseIndex, AFileThatBecameALinkIsNotOpened) {
  const TestFolder folder;
  const fs::path cases = folder / "cases";
  fs::create_directories(cases);
  test::write_small_case(folder / "private.sog", "Private");
  test::write_small_case(cases / "head.sog", "A head");
  CaseIndex index(cases);
  const auto entry = index.find("head");
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(index.open(*entry)->state().version, entry->version);
  fs::remove(cases / "head.sog");
  fs::create_symlink(folder / "private.sog", cases / "head.sog");
  EXPECT_THAT(error_of([&] { index.open(*entry); }), HasSubstr("leaves the folder"));
}

TEST(CaseIndex, TheFolderItselfMayBeALink) {
  const TestFolder folder;
  fs::create_directories(folder / "real");
  test::write_small_case(folder / "real" / "head.sog", "A head");
  fs::create_directory_symlink("real", folder / "cases");
  CaseIndex index(folder / "cases");
  EXPECT_EQ(seen(index, "head"), "A head");
}

TEST(CaseIndex, PipesAndFoldersAreNoCases) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.sog").c_str(), 0600), 0);
  fs::create_directory(folder / "folder.sog");
  CaseIndex index(folder.path());
  EXPECT_EQ(seen(index, "pipe"), "none");
  EXPECT_EQ(seen(index, "folder"), "none");
  EXPECT_EQ(seen(index, ""), "none");
}

TEST(CaseIndex, AFolderThatVanishedIsAnErrorUntilItIsBack) {
  const TestFolder folder;
  const fs::path cases = folder / "cases";
  fs::create_directories(cases);
  test::write_small_case(cases / "head.sog", "A head");
  CaseIndex index(cases);
  const auto entry = index.find("head");
  fs::rename(cases, folder / "away");
  for (const std::string& error :
       {error_of([&] { index.list(); }), error_of([&] { index.find("head"); }),
        error_of([&] { index.open(*entry); })}) {
    EXPECT_THAT(error, HasSubstr("the folder of the cases cannot be read"));
    EXPECT_THAT(error, Not(HasSubstr(folder.path().string()))) << "browsers read it";
  }
  fs::rename(folder / "away", cases);
  EXPECT_EQ(seen(index, "head"), "A head");
}

TEST(CaseIndex, SeesWhatChanges) {
  const TestFolder folder;
  CaseIndex index(folder.path());
  EXPECT_TRUE(index.list().empty());
  test::write_small_case(folder / "head.sog", "A head");
  EXPECT_EQ(seen(index, "head"), "A head");
  const auto first = index.find("head");
  EXPECT_EQ(index.find("head"), first) << "read once";
  test::write_small_case(folder / "head.sog", "Another");
  EXPECT_EQ(seen(index, "head"), "Another");
  EXPECT_NE(index.find("head")->version, first->version);
  fs::remove(folder / "head.sog");
  EXPECT_EQ(seen(index, "head"), "none");
}

TEST(CaseIndex, ForgetsWhyAFileCouldNotBeOpened) {
  const TestFolder folder;
  const fs::path cases = folder / "cases";
  fs::create_directories(cases);
  fs::create_directories(folder / "outside");
  test::write_small_case(folder / "outside" / "head.sog", "A head");
  fs::create_directory_symlink("../outside", cases / "door");
  fs::create_symlink("door/head.sog", cases / "head.sog");
  CaseIndex index(cases);
  EXPECT_THAT(seen(index, "head"), HasSubstr("leaves the folder"));
  // The file itself stays as it is, as where only its permissions were changed.
  fs::rename(folder / "outside", cases / "inside");
  fs::remove(cases / "door");
  fs::create_directory_symlink("inside", cases / "door");
  EXPECT_EQ(seen(index, "head"), "A head");
}

TEST(CaseIndex, SeesPermissionsThatAreGiven) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "root may read everything";
  }
  const TestFolder folder;
  test::write_small_case(folder / "head.sog", "A head");
  fs::permissions(folder / "head.sog", fs::perms::none);
  CaseIndex index(folder.path());
  EXPECT_THAT(seen(index, "head"), HasSubstr("check its permissions"));
  fs::permissions(folder / "head.sog", fs::perms::owner_read);
  EXPECT_EQ(seen(index, "head"), "A head");
}

TEST(CaseIndex, SeesOtherContentsOfTheSameTimeAndSize) {
  const TestFolder folder;
  const fs::path path = folder / "head.sog";
  test::write_small_case(path, "A head");
  CaseIndex index(folder.path());
  EXPECT_EQ(seen(index, "head"), "A head");
  const fs::file_time_type time = fs::last_write_time(path);
  test::write_small_case(folder / "other.sog", "A hand");
  ASSERT_EQ(fs::file_size(folder / "other.sog"), fs::file_size(path));
  fs::copy_file(folder / "other.sog", path, fs::copy_options::overwrite_existing);
  fs::last_write_time(path, time);
  EXPECT_EQ(seen(index, "head"), "A hand");
}

TEST(CaseIndex, LooksBelowTheFolderWhereToldTo) {
  const TestFolder folder;
  const fs::path cases = folder / "cases";
  fs::create_directories(cases / "a" / "b");
  fs::create_directories(cases / ".trash");
  fs::create_directories(cases / "head.clipgs-work");
  fs::create_directories(folder / "outside");
  for (const char* name : {"cases/head", "cases/a/foot", "cases/a/b/hand", "cases/.trash/old",
                           "cases/head.clipgs-work/part", "outside/secret"}) {
    test::write_small_case(folder / (std::string(name) + ".sog"), name);
  }
  fs::create_directory_symlink("../outside", cases / "door");
  fs::create_directory_symlink(".", cases / "a" / "again");
  CaseIndex flat(cases);
  EXPECT_EQ(flat.list().size(), 1U);
  EXPECT_EQ(flat.find("a/foot"), nullptr);
  CaseIndex index(cases, {}, true);
  std::vector<std::string> names;
  for (const auto& entry : index.list()) {
    names.push_back(entry->name);
    EXPECT_EQ(index.find(entry->name), entry);
    EXPECT_EQ(index.open(*entry)->state().version, entry->version);
  }
  EXPECT_THAT(names, testing::ElementsAre("a/b/hand", "a/foot", "head"));
  for (const char* name :
       {"door/secret", "a/again/foot", ".trash/old", "head.clipgs-work/part", "a/../head", "./head",
        "a//foot", "/a/foot", "a/", "a", "../outside/secret", "a/b/../foot"}) {
    EXPECT_EQ(index.find(name), nullptr) << name;
  }
  fs::remove_all(cases / "a");
  EXPECT_EQ(index.list().size(), 1U);
  EXPECT_EQ(index.find("a/foot"), nullptr);
}

}  // namespace
}  // namespace clipgs
