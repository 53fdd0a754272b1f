#include "serve/certificate.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/file.h"
#include "serve/token.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

class IdentityTest : public ::testing::Test {
 protected:
  IdentityTest()
      : folder_(fs::temp_directory_path() / ("clipgs_identity_" + std::to_string(::getpid()))) {}
  ~IdentityTest() override { fs::remove_all(folder_); }

  const fs::path folder_;
};

TEST(Certificate, IsForItsHostsAlone) {
  const Certificate one = make_certificate({"192.168.1.20", "localhost"});
  EXPECT_TRUE(is_good(one, {"192.168.1.20"}));
  EXPECT_TRUE(is_good(one, {"localhost", "192.168.1.20"}));
  EXPECT_FALSE(is_good(one, {"192.168.1.21"}));
  EXPECT_FALSE(is_good(one, {"example.org"}));
  EXPECT_THAT(fingerprint(one), ::testing::MatchesRegex("([0-9A-F]{2}:){31}[0-9A-F]{2}"));
  const Certificate other = make_certificate({"192.168.1.20"});
  EXPECT_NE(fingerprint(one), fingerprint(other));
  EXPECT_FALSE(is_good({one.certificate, other.key}, {"192.168.1.20"}));
  EXPECT_FALSE(is_good({}, {}));
}

TEST_F(IdentityTest, IsKeptAndReadByItsOwnerAlone) {
  const ServerIdentity first = load_identity(folder_, {"127.0.0.1"});
  EXPECT_THAT(first.token, ::testing::MatchesRegex("([a-km-np-z2-9]{5}-){4}[a-km-np-z2-9]{6}"));
  const ServerIdentity again = load_identity(folder_, {"127.0.0.1"});
  EXPECT_EQ(again.token, first.token);
  EXPECT_EQ(fingerprint(again.certificate), fingerprint(first.certificate));
  for (const auto& file : fs::directory_iterator(folder_)) {
    EXPECT_EQ(file.status().permissions(), fs::perms::owner_read | fs::perms::owner_write)
        << file.path();
  }
}

TEST_F(IdentityTest, AShortTokenOfOlderVersionsIsReplaced) {
  const ServerIdentity first = load_identity(folder_, {"127.0.0.1"});
  write_text(folder_ / "token", "k3v9qtxw");
  const ServerIdentity again = load_identity(folder_, {"127.0.0.1"});
  EXPECT_EQ(again.token.size(), first.token.size());
  EXPECT_EQ(plain_token(again.token).size(), 26U) << "130 bits";
  EXPECT_EQ(fingerprint(again.certificate), fingerprint(first.certificate));
  EXPECT_EQ(load_identity(folder_, {"127.0.0.1"}).token, again.token);
}

TEST_F(IdentityTest, IsMadeAnewWhereItIsOfNoUse) {
  const ServerIdentity first = load_identity(folder_, {"127.0.0.1"});
  const ServerIdentity moved = load_identity(folder_, {"10.0.0.7"});
  EXPECT_NE(fingerprint(moved.certificate), fingerprint(first.certificate));
  EXPECT_EQ(moved.token, first.token);
  write_text(folder_ / "key.pem", "no key");
  write_text(folder_ / "token", "short");
  const ServerIdentity repaired = load_identity(folder_, {"10.0.0.7"});
  EXPECT_TRUE(is_good(repaired.certificate, {"10.0.0.7"}));
  EXPECT_NE(repaired.token, first.token);
}

}  // namespace
}  // namespace clipgs
