#include "study/study_plot.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "study/study_csv.h"

/// Asked by the leak sanitizer: fontconfig keeps what it read of fonts until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StudyPlotTest : public testing::Test {
 protected:
  StudyPlotTest()
      : folder_(fs::path(testing::TempDir()) / ("clipgs-study-plot-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~StudyPlotTest() override { fs::remove_all(folder_); }

  static StudyComparison paper() {
    return compare_modes(
        read_study_csv(fs::path(CLIPGS_SOURCE_DIR) / "presets" / "study" / "synthetic-paper.csv"));
  }

  fs::path folder_;
};

TEST_F(StudyPlotTest, PngShowsBothModesOnALightGround) {
  write_study_plot(paper(), folder_ / "plot.png");
  const Image picture = read_png(folder_ / "plot.png");
  EXPECT_GE(picture.width, 1000);
  size_t white = 0;
  size_t blue = 0;
  size_t orange = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float* c = picture.at(x, y);
      white += c[0] > 0.99f && c[1] > 0.99f && c[2] > 0.99f ? 1 : 0;
      blue += c[2] > 0.6f && c[0] < 0.1f ? 1 : 0;
      orange += c[0] > 0.7f && c[2] < 0.1f ? 1 : 0;
    }
  }
  EXPECT_GT(white, picture.pixels() / 2);
  // Dots of ten participants in two panels, at the very least.
  EXPECT_GT(blue, 20 * 60);
  EXPECT_GT(orange, 20 * 60);
}

TEST_F(StudyPlotTest, SvgIsTheSameEveryTime) {
  const auto draw = [&] {
    write_study_plot(paper(), folder_ / "plot.svg");
    std::string svg = read_text(folder_ / "plot.svg");
    // cairo numbers the surfaces of a process.
    const size_t number = svg.find("\"surface") + 8;
    svg.erase(number, svg.find('"', number) - number);
    return svg;
  };
  const std::string svg = draw();
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_GT(svg.size(), 10000);
  EXPECT_TRUE(draw() == svg);
}

TEST_F(StudyPlotTest, OddDataAreDrawn) {
  const auto draw = [&](const std::string& text) {
    write_study_plot(compare_modes(parse_study_csv(text, "t.csv")), folder_ / "odd.png");
    return read_png(folder_ / "odd.png").pixels();
  };
  const std::string head = "participant,mode,x\n";
  EXPECT_GT(draw(head + "1,a,5\n1,b,5\n"), 0);
  EXPECT_GT(draw(head + "1,a,0\n1,b,0\n2,a,0\n2,b,0\n3,a,0\n3,b,0\n"), 0);
  EXPECT_GT(draw(head + "1,a,1e12\n1,b,-1e12\n2,a,1e-9\n2,b,3\n"), 0);
  EXPECT_GT(draw(head + "1,a,1e-300\n1,b,2e-300\n2,a,1\n2,b,1.0000000001\n"), 0);
  EXPECT_GT(draw(head + "1,a,1e11\n1,b,100000000000.1\n"), 0);
}

TEST_F(StudyPlotTest, RefusesOtherEndingsAndNothingToDraw) {
  EXPECT_THROW(write_study_plot(paper(), folder_ / "plot.pdf"), Error);
  const StudyTable apart = parse_study_csv("participant,mode,x\n1,a,5\n2,b,5\n", "t.csv");
  EXPECT_THROW(write_study_plot(compare_modes(apart), folder_ / "plot.png"), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace clipgs
