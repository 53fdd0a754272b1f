#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "cli/cli_fixture.h"
#include "core/file.h"

namespace clipgs {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing_support::run_clipgs;

/// What a shell prints, with what it complains of.
std::string output_of(const std::string& command) {
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    text += static_cast<char>(c);
  }
  ::pclose(pipe);
  return text;
}

bool is_there(const std::string& program) { return !output_of("command -v " + program).empty(); }

class ManualTest : public testing_support::CliTest {
 protected:
  /// The completion of a shell, as a file.
  std::string completion(const std::string& shell) const {
    const testing_support::Finished finished = run_clipgs({"completion", shell});
    EXPECT_EQ(finished.status, 0) << finished.err;
    write_text(at("completion." + shell), finished.out);
    return at("completion." + shell);
  }

  /// What bash offers for the last of these words.
  std::string offered(const std::string& words) const {
    return output_of(fmt::format(
        "bash -c 'source {}; COMP_WORDS=(clipgs {}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
        "_clipgs; echo -n \"${{COMPREPLY[*]}}\"'",
        completion("bash"), words));
  }
};

TEST_F(ManualTest, HasAPageOfEveryCommandThatRoffTakes) {
  ASSERT_EQ(run_clipgs({"man", "-o", at("pages")}).status, 0);
  std::vector<std::string> names;
  for (const auto& page : std::filesystem::directory_iterator(at("pages"))) {
    names.push_back(page.path().filename().string());
    if (is_there("groff")) {
      EXPECT_THAT(output_of("groff -k -man -Tutf8 -ww -z " + page.path().string()), IsEmpty())
          << page.path();
    }
  }
  EXPECT_THAT(names, AllOf(Contains("clipgs.1"), Contains("clipgs-build.1"),
                           Contains("clipgs-view.1"), Contains("clipgs-man.1")));
  const std::string all = read_text(at("pages") + "/clipgs.1");
  for (const std::string& name : names) {
    if (name != "clipgs.1") {
      EXPECT_THAT(all, HasSubstr("\n\\fB" + name.substr(7, name.size() - 9) + "\\fR\n"));
    }
  }
  const std::string build = read_text(at("pages") + "/clipgs-build.1");
  EXPECT_THAT(build, AllOf(HasSubstr("\\fB\\-\\-tone\\fR"), HasSubstr("[srgb, filmic]"),
                           HasSubstr(".SH EXAMPLES\n.nf\nclipgs build")));
}

TEST_F(ManualTest, CompletesInBash) {
  EXPECT_EQ(offered("bui"), "build");
  EXPECT_THAT(offered("\"\""), AllOf(StartsWith("archive bake build"), HasSubstr("unpack view")));
  EXPECT_EQ(offered("build --tit"), "--title");
  EXPECT_EQ(offered("build ct.nii.gz --tone \"\""), "srgb filmic");
  EXPECT_EQ(offered("--quiet render case.sog --thr"), "--threads");
  EXPECT_EQ(offered("completion z"), "zsh");
  EXPECT_EQ(offered("build ct"), "");  // files, which bash knows
}

TEST_F(ManualTest, CompletesInFish) {
  if (!is_there("fish")) {
    GTEST_SKIP() << "there is no fish";
  }
  const auto offers = [&](const std::string& line) {
    return output_of(
        fmt::format("fish -c 'source {}; complete -C \"{}\"'", completion("fish"), line));
  };
  EXPECT_EQ(offers("clipgs buil"), "build\tFrom a volume to a case: pictures, training, packing\n");
  EXPECT_THAT(offers("clipgs build --ton"), StartsWith("--tone\t"));
  EXPECT_THAT(offers("clipgs build --tone "), AllOf(HasSubstr("srgb\t"), HasSubstr("filmic\t")));
}

TEST_F(ManualTest, CompletesInZsh) {
  if (!is_there("zsh")) {
    GTEST_SKIP() << "there is no zsh";
  }
  EXPECT_THAT(output_of("zsh -n " + completion("zsh")), IsEmpty());
  // As a person has it: a terminal of zsh's own, and Tab.
  std::filesystem::create_directory(at("functions"));
  std::filesystem::copy_file(at("completion.zsh"), at("functions/_clipgs"));
  write_text(at("try.zsh"), fmt::format(R"(zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell 'fpath=({} $fpath); autoload -U compinit; compinit -u -d {}; clipgs() {{ print -r "ran <$*>" }}; print rea""dy'
zpty -r -m shell text '*ready*'
zpty -w -n shell $'clipgs buil\t--titl\t\n'
zpty -r -m shell text '*ran <[^$]*>*'
print -r -- "$text"
)",
                                        at("functions"), at("compdump")));
  EXPECT_THAT(output_of("timeout 60 zsh -f " + at("try.zsh")), HasSubstr("ran <build --title>"));
}

TEST_F(ManualTest, IsOfKnownShellsAlone) {
  EXPECT_EQ(run_clipgs({"completion", "tcsh"}).status, 2);
  EXPECT_EQ(run_clipgs({"man"}).status, 2);
  expect_failure({"man", "-o", phantom()}, "phantom.nrrd");
}

}  // namespace
}  // namespace clipgs
