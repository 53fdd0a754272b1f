#include "serve/access_tokens.h"

#include <chrono>
#include <cstdlib>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/file.h"
#include "serve/token.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTokenOfWard = "k3v9q-txw7h-23456-abcde-fghijk";

AccessToken ward() {
  return {{"ward", {"cardiology"}, false, false}, token_digest(kTokenOfWard), ""};
}

void write_private(const std::filesystem::path& file, const std::string& text) {
  write_text(file, text);
  ::chmod(file.c_str(), 0600);
}

TEST(AccessTokens, AreOfFoldersAndWhatIsBelowThem) {
  const Grant grant = ward().grant;
  EXPECT_TRUE(grant.may_see("cardiology/head"));
  EXPECT_TRUE(grant.may_see("cardiology/2027/head"));
  for (const char* other : {"head", "cardiology", "cardiology2/head", "x/cardiology/head", ""}) {
    EXPECT_FALSE(grant.may_see(other)) << other;
  }
  EXPECT_FALSE(grant.sees_all());
  EXPECT_TRUE(Grant({"all", {"."}}).may_see("head"));
  EXPECT_FALSE(Grant({"none", {}}).may_see("head"));
  EXPECT_EQ(grant_folder("a//b/../c/"), "a/c");
  EXPECT_EQ(grant_folder("./"), ".");
  for (const char* wrong : {"", "..", "../x", "a/../..", "/etc", ".hidden", "a/.hidden"}) {
    EXPECT_EQ(grant_folder(wrong), std::nullopt) << wrong;
  }
}

TEST(AccessTokens, AreKeptWithoutThemselves) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "tokens.json";
  AccessToken other{{"all", {"."}, true, true}, token_digest("other"), "2999-12-31"};
  write_tokens(file, {ward(), other});
  struct stat status{};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600U);
  EXPECT_EQ(read_text(file).find(kTokenOfWard), std::string::npos);
  const std::vector<AccessToken> read = read_tokens(file);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].grant.name, "ward");
  EXPECT_FALSE(read[0].grant.writes || read[0].grant.metrics || read[0].is_over());
  EXPECT_TRUE(read[1].grant.writes && read[1].grant.metrics && read[1].grant.sees_all());
  EXPECT_EQ(read[1].expires, "2999-12-31");
  TokenBook book(file);
  EXPECT_EQ(book.find("K3V9QTXW7H23456abcde-fghijk").value_or(other).grant.name, "ward");
  EXPECT_FALSE(book.find("k3v9q-txw7h-23456-abcde-fghijm"));
}

TEST(AccessTokens, AreRefusedWhereOthersMayReadThem) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "tokens.json";
  write_tokens(file, {ward()});
  for (const mode_t mode : {0640U, 0604U, 0602U, 0610U}) {
    ::chmod(file.c_str(), mode);
    const std::string error = error_of([&] { TokenBook book(file); });
    EXPECT_THAT(error, HasSubstr("chmod 600 " + file.string())) << mode;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  // systemd gives a service its copy with an access list, which shows as rights of the group.
  ::chmod(file.c_str(), 0440);
  ::setenv("CREDENTIALS_DIRECTORY", folder.path().c_str(), 1);
  EXPECT_EQ(error_of([&] { TokenBook book(file); }), "");
  ::unsetenv("CREDENTIALS_DIRECTORY");
}

TEST(AccessTokens, OfAFileThatIsWrongAreNone) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "tokens.json";
  const std::string digest = token_digest(kTokenOfWard);
  const auto token = [&](const std::string& name, const std::string& digits,
                         const std::string& rest) {
    return R"({"clipgs_tokens":1,"tokens":[{"name":")" + name + R"(","sha256":")" + digits + "\"" +
           rest + "}]}";
  };
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "version 1"},
      {"[]", "version 1"},
      {R"({"clipgs_tokens":2,"tokens":[]})", "version 1"},
      {R"({"clipgs_tokens":1,"tokens":{}})", "version 1"},
      {R"({"clipgs_tokens":1,"tokens":[3]})", "tokens[0]"},
      {token("a", digest, ""), "folders"},  // forgotten is not all
      {token("a", digest, R"(,"folders":"all")"), "folders"},
      {token("a", digest, R"(,"folders":["../b"])"), "folders"},
      {token("a", digest, R"(,"folders":[1])"), "folders"},
      {token("a", digest, R"(,"folders":["."],"writes":"no")"), "writes"},
      {token("a", digest, R"(,"folders":["."],"expires":"2027-02-30")"), "expires"},
      {token("a", digest, R"(,"folders":["."],"expires":"soon")"), "expires"},
      {token("a", digest, R"(,"folders":["."],"expire":"2027-01-31")"), "expire"},
      {token("a b", digest, R"(,"folders":["."])"), "name"},
      {token("a", "abc", R"(,"folders":["."])"), "sha256"},
  };
  for (const auto& [text, says] : wrong) {
    write_private(file, text);
    const std::string error = error_of([&] { read_tokens(file); });
    EXPECT_THAT(error, HasSubstr(says)) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  AccessToken twin = ward();
  twin.sha256 = token_digest("other");
  write_tokens(file, {ward(), twin});
  EXPECT_THAT(error_of([&] { read_tokens(file); }), HasSubstr("a second token is called ward"));
  EXPECT_THAT(error_of([&] { read_tokens(folder / "nowhere"); }), HasSubstr("no such file"));
}

TEST(AccessTokens, ChangeAtOnceAndLetNobodyInWhereTheyCannotBeRead) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "tokens.json";
  write_tokens(file, {});
  TokenBook book(file);
  EXPECT_FALSE(book.find(kTokenOfWard));
  write_tokens(file, {ward()});
  EXPECT_TRUE(book.find(kTokenOfWard));
  write_private(file, "half of a fi");
  const std::string error = error_of([&] { book.find(kTokenOfWard); });
  EXPECT_THAT(error, HasSubstr("cannot be read"));
  EXPECT_EQ(error.find(folder.path().string()), std::string::npos) << "browsers read it";
  write_tokens(file, {ward()});
  EXPECT_TRUE(book.find(kTokenOfWard));
  std::filesystem::remove(file);
  EXPECT_THAT(error_of([&] { book.find(kTokenOfWard); }), HasSubstr("cannot be read"));
}

TEST(AccessTokens, LastUntilTheEndOfTheirDay) {
  const auto day = [](int from_now) {
    const auto days = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
    const std::chrono::year_month_day date{days + std::chrono::days(from_now)};
    return fmt::format("{:04}-{:02}-{:02}", int(date.year()), unsigned(date.month()),
                       unsigned(date.day()));
  };
  AccessToken token = ward();
  for (const int from_now : {0, 1, 400}) {
    token.expires = day(from_now);
    EXPECT_FALSE(token.is_over()) << token.expires;
  }
  for (const int from_now : {-1, -400}) {
    token.expires = day(from_now);
    EXPECT_TRUE(token.is_over()) << token.expires;
  }
}

}  // namespace
}  // namespace clipgs
