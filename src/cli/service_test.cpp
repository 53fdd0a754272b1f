#include <chrono>
#include <csignal>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>

#include "cli/cli_fixture.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing_support::Finished;
using testing_support::run_clipgs;

class ServiceCommandTest : public testing_support::CliTest {};

TEST_F(ServiceCommandTest, MakesListsAndRemovesTokens) {
  const std::string file = at("tokens.json");
  const Finished made = run_clipgs({"token", file, "--add", "ward-3", "--folder", "cardiology/",
                                    "--folder", "head", "--expires", "2999-01-31"});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, MatchesRegex("([a-km-np-z2-9]{5}-){4}[a-km-np-z2-9]{6}\n"));
  struct stat status{};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  const std::string token = made.out.substr(0, made.out.size() - 1);
  EXPECT_THAT(read_text(file), Not(HasSubstr(token)));
  EXPECT_EQ(run_clipgs({"token", file, "--add", "chief", "--folder", ".", "--write"}).status, 0);
  EXPECT_EQ(run_clipgs({"token", file, "--add", "prometheus", "--metrics"}).status, 0);
  EXPECT_EQ(run_clipgs({"token", file}).out,
            "ward-3: cardiology, head, until 2999-01-31\nchief: all cases, may write\n"
            "prometheus: no case, metrics\n");
  expect_failure({"token", file, "--add", "chief", "--folder", "."}, "already");
  expect_failure({"token", file, "--add", "x"}, "--folder . of all");
  expect_failure({"token", file, "--add", "x", "--folder", "../x"}, "no folder below");
  expect_failure({"token", file, "--add", "x y", "--folder", "."}, "give a name");
  expect_failure({"token", file, "--add", "x", "--folder", ".", "--expires", "soon"}, "2027-01-31");
  expect_failure({"token", file, "--remove", "nobody"}, "no token nobody");
  expect_failure({"token", at("none.json")}, "no such file");
  EXPECT_EQ(run_clipgs({"token", file, "--remove", "chief"}).status, 0);
  EXPECT_THAT(run_clipgs({"token", file}).out, Not(HasSubstr("chief")));
  EXPECT_FALSE(fs::exists(file + ".lock"));
}

TEST_F(ServiceCommandTest, TokensAreNotSentInTheClear) {
  fs::create_directory(at("cases"));
  ASSERT_EQ(run_clipgs({"token", at("tokens.json"), "--add", "a", "--folder", "."}).status, 0);
  expect_failure(
      {"serve", at("cases"), "--host", "0.0.0.0", "--port", "0", "--tokens", at("tokens.json")},
      "unencrypted");
  ::chmod(at("tokens.json").c_str(), 0644);
  expect_failure({"serve", at("cases"), "--port", "0", "--tokens", at("tokens.json")},
                 "run chmod 600");
  expect_failure({"serve", at("cases"), "--port", "0", "--audit", at("nowhere/audit")},
                 "cannot be written");
  expect_failure({"serve", at("cases"), "--port", "0", "--trusted-proxy", "nginx"},
                 "--trusted-proxy nginx: is no address");
  EXPECT_EQ(run_clipgs({"serve", at("cases"), "--certificate", at("a.pem")}).status, 2);
}

/// The program, in the background.
class Serving {
 public:
  explicit Serving(const std::vector<std::string>& arguments) : pid_(::fork()) {
    if (pid_ == 0) {
      std::vector<char*> words = {const_cast<char*>(CLIPGS_PROGRAM)};
      for (const std::string& one : arguments) {
        words.push_back(const_cast<char*>(one.c_str()));
      }
      words.push_back(nullptr);
      ::execv(CLIPGS_PROGRAM, words.data());
      ::_exit(127);
    }
  }
  ~Serving() {
    if (pid_ > 0) {
      end(SIGKILL);
    }
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;

  void tell(int signal) const { ::kill(pid_, signal); }
  /// Its exit status.
  int end(int signal) {
    tell(signal);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_;
};

bool appears(const std::string& file) {
  for (int i = 0; i < 1000 && !fs::exists(file); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return fs::exists(file);
}

TEST_F(ServiceCommandTest, OpensLogsAnewAtSighup) {
  fs::create_directory(at("cases"));
  Serving serving({"serve", at("cases"), "--port", "0", "--access-log", at("access"), "--audit",
                   at("audit"), "--json"});
  ASSERT_TRUE(appears(at("audit")) && appears(at("access")));
  fs::rename(at("access"), at("access.1"));
  fs::rename(at("audit"), at("audit.1"));
  serving.tell(SIGHUP);
  EXPECT_TRUE(appears(at("audit")) && appears(at("access")));
  EXPECT_EQ(serving.end(SIGTERM), 0);
}

}  // namespace
}  // namespace clipgs
