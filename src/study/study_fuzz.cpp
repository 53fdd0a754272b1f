// libFuzzer's entry to what reads a study: a first byte says whether a table follows, a session as
// it is recorded, or a mean to check.
#include <cstdlib>
#include <string>

#include "core/error.h"
#include "core/file.h"
#include "core/fuzz.h"
#include "study/comparison.h"
#include "study/grim.h"
#include "study/report_blocks.h"
#include "study/study_csv.h"
#include "study/study_report.h"
#include "study/study_sessions.h"

namespace clipgs::fuzz {

namespace {

constexpr char kTable = 0;
constexpr char kSession = 1;
constexpr char kMean = 2;

void compare(const StudyTable& table) {
  // What is written reads back as the same.
  const std::string csv = study_csv(table);
  if (study_csv(parse_study_csv(csv, "written")) != csv) {
    std::abort();
  }
  const StudyComparison comparison = compare_modes(table);
  for (const ReportFormat format :
       {ReportFormat::kText, ReportFormat::kMarkdown, ReportFormat::kLatex}) {
    format_report(study_report(comparison), format);
  }
  study_json(comparison);
}

}  // namespace

std::vector<Bytes> seeds() {
  const std::vector<std::string> texts = {
      kTable +
          std::string("# synthetic\nparticipant,mode,sus,x\n1,a,50,1\n1,b,60,2\n2,a,55,\n2,b,60,"
                      "3\n3,a,1,1\n3,b,2,4\n4,a,9,1\n4,b,7,4\n"),
      kTable + std::string("\xEF\xBB\xBFmode;participant;tlx1;tlx2;tlx3;tlx4;tlx5;tlx6\r\n"
                           "\"a;\";1;10,5;20;30;40;50;60\r\nb;01;1;2;3;4;5;6\r\n"),
      kTable +
          std::string("participant\tmode\tq1\tq2\tq3\tq4\tq5\tq6\tq7\tq8\tq9\tq10\tefficiency\n"
                      "7\ta\t1\t2\t3\t4\t5\t1\t2\t3\t4\t5\t3\n"),
      kSession + std::string(R"({"seq":0,"kind":"session","format":1,"plan":"p","digest":"d",)"
                             R"("participant":7,"order":["a"],"device":"desk"})"
                             "\n"
                             R"({"seq":1,"kind":"answers","mode":"a","questionnaire":"efficiency",)"
                             R"("answers":[4]})"
                             "\n"
                             R"({"seq":2,"kind":"end"})"
                             "\n"),
      kMean + std::string("71.80,10,2.5")};
  std::vector<Bytes> result;
  for (const std::string& text : texts) {
    result.push_back(bytes_of(text));
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  if (input.empty()) {
    return;
  }
  const std::string text = text_of(input.subspan(1));
  if (input.front() == kTable) {
    compare(parse_study_csv(text, "fuzz"));
  } else if (input.front() == kSession) {
    const std::filesystem::path folder = scratch_folder() / "sessions";
    create_folder(folder);
    write_text(folder / "p007-00000000.jsonl", text);
    compare(read_study_sessions(folder));
  } else if (input.front() == kMean) {
    grim_text(parse_grim_check(text));
  }
}

}  // namespace clipgs::fuzz
