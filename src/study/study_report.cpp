#include "study/study_report.h"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "study/sus.h"

namespace clipgs {

namespace {

constexpr const char* kNothing = "–";
constexpr const char* kSuggestedMark = " *";

std::string title_with_unit(const std::string& measure) {
  const MeasureTitle title = measure_title(measure);
  return title.unit.empty() ? title.title : fmt::format("{} ({})", title.title, title.unit);
}

std::string interval_text(const Interval& interval, int decimals) {
  return fmt::format("[{}, {}]", signed_text(interval.low, decimals),
                     signed_text(interval.high, decimals));
}

std::string mean_text(const std::optional<Descriptives>& all) {
  if (!all) {
    return kNothing;
  }
  return all->sd ? fmt::format("{} ± {}", signed_text(all->mean, 2), signed_text(*all->sd, 2))
                 : signed_text(all->mean, 2);
}

std::string median_text(const std::optional<Descriptives>& all) {
  return all ? fmt::format("{} {}", signed_text(all->median, 2),
                           interval_text({all->q1, all->q3}, 2))
             : kNothing;
}

std::string difference_text(const std::optional<Descriptives>& all) {
  if (!all) {
    return kNothing;
  }
  return all->mean_ci
             ? fmt::format("{} {}", signed_text(all->mean, 2), interval_text(*all->mean_ci, 2))
             : signed_text(all->mean, 2);
}

std::string normality_text(const MeasureComparison& measure) {
  return measure.normality ? fmt::format("W = {}, {}", share_text(measure.normality->w, 3),
                                         p_text(measure.normality->p))
                           : kNothing;
}

std::string t_text(const MeasureComparison& measure) {
  if (!measure.t) {
    return kNothing;
  }
  return fmt::format("t({:.0f}) = {}, {}{}", measure.t->df, signed_text(measure.t->t, 3),
                     p_text(measure.t->p),
                     measure.suggested == PairedTest::kT ? kSuggestedMark : "");
}

std::string effect_text(const MeasureComparison& measure) {
  if (!measure.t) {
    return kNothing;
  }
  const std::string dz = signed_text(measure.t->dz, 2);
  return measure.t->dz_ci ? fmt::format("{} {}", dz, interval_text(*measure.t->dz_ci, 2)) : dz;
}

std::string wilcoxon_text(const MeasureComparison& measure) {
  if (!measure.wilcoxon) {
    return kNothing;
  }
  return fmt::format("W = {:g}, Z = {}, {}{}", measure.wilcoxon->w,
                     signed_text(measure.wilcoxon->z, 3), p_text(measure.wilcoxon->p),
                     measure.suggested == PairedTest::kWilcoxon ? kSuggestedMark : "");
}

std::string exact_text(const MeasureComparison& measure) {
  return measure.wilcoxon && measure.wilcoxon->exact_p ? p_text(*measure.wilcoxon->exact_p)
                                                       : kNothing;
}

ReportBlock summary_block(const StudyComparison& comparison) {
  ReportBlock block;
  block.title = fmt::format("{} against {}", comparison.modes[0], comparison.modes[1]);
  block.lines = {fmt::format("{} participant{}; differences are {} − {}; intervals hold {:g} %",
                             comparison.participants, comparison.participants == 1 ? "" : "s",
                             comparison.modes[0], comparison.modes[1],
                             100 * (1 - comparison.target.alpha))};
  return block;
}

ReportBlock exclusion_block(const StudyComparison& comparison) {
  ReportBlock block;
  block.title = "Left out";
  for (const Exclusion& one : comparison.exclusions) {
    block.lines.push_back(fmt::format(
        "participant {}, {}: {}", one.participant,
        one.measure.empty() ? "everything" : measure_title(one.measure).title, one.reason));
  }
  block.lines.insert(block.lines.end(), comparison.remarks.begin(), comparison.remarks.end());
  if (block.lines.empty()) {
    block.lines = {"nothing: every participant has every measure in both modes"};
  }
  return block;
}

ReportBlock value_block(const StudyComparison& comparison) {
  ReportBlock block;
  block.title = "Values: mean ± SD, median [quartiles], mean difference [interval]";
  const auto& [first, second] = comparison.modes;
  block.header = {"measure",           "n",         first, first + ", median", second,
                  second + ", median", "difference"};
  for (const MeasureComparison& measure : comparison.measures) {
    block.rows.push_back({title_with_unit(measure.measure), fmt::format("{}", measure.pairs.size()),
                          mean_text(measure.first), median_text(measure.first),
                          mean_text(measure.second), median_text(measure.second),
                          difference_text(measure.difference)});
  }
  return block;
}

ReportBlock test_block(const StudyComparison& comparison) {
  ReportBlock block;
  block.title = "Tests of the differences, two-sided";
  block.header = {"measure",  "Shapiro–Wilk", "paired t", "d_z [interval]",
                  "Wilcoxon", "exact p",      "r",        "Holm"};
  for (const MeasureComparison& measure : comparison.measures) {
    block.rows.push_back({measure_title(measure.measure).title, normality_text(measure),
                          t_text(measure), effect_text(measure), wilcoxon_text(measure),
                          exact_text(measure),
                          measure.wilcoxon ? share_text(measure.wilcoxon->r, 2) : kNothing,
                          measure.holm_p ? p_text(*measure.holm_p) : kNothing});
  }
  return block;
}

ReportBlock note_block(const StudyComparison& comparison) {
  ReportBlock block;
  for (const MeasureComparison& measure : comparison.measures) {
    if (!measure.note.empty()) {
      block.lines.push_back(
          fmt::format("{}: {}", measure_title(measure.measure).title, measure.note));
    }
  }
  block.lines.insert(
      block.lines.end(),
      {"* the test that Shapiro–Wilk suggests: Wilcoxon where its p < .05, else the paired t",
       "Wilcoxon: zeros dropped, ties corrected, no continuity correction; r is rank-biserial",
       "Holm: over all measures, of the suggested test's p; of Wilcoxon's exact p where it is "
       "given"});
  return block;
}

ReportBlock sus_block(const MeasureComparison& sus, const StudyComparison& comparison) {
  ReportBlock block;
  block.title = "What the mean SUS scores mean";
  const std::array means{sus.first->mean, sus.second->mean};
  for (size_t i = 0; i < means.size(); ++i) {
    const SusGrade grade = sus_grade(means[i]);
    block.lines.push_back(fmt::format("{} {}: {}; grade {}, percentile {}–{}", comparison.modes[i],
                                      signed_text(means[i], 2), sus_adjective(means[i]),
                                      grade.letter, grade.low, grade.high));
  }
  block.lines.emplace_back(
      "adjectives: the best whose mean is reached (Bangor et al. 2009); grades and percentiles: "
      "Sauro & Lewis (2016)");
  return block;
}

ReportBlock size_block(const StudyComparison& comparison) {
  ReportBlock block;
  block.title =
      fmt::format("Pairs for a power of {} at α = {}, two-sided",
                  share_text(comparison.target.power, 2), share_text(comparison.target.alpha, 2));
  const auto add = [&](const std::string& name, double dz,
                       const std::optional<SampleSizes>& sizes) {
    block.lines.push_back(fmt::format(
        "{}, d_z = {}: {}", name, signed_text(dz, 2),
        sizes ? fmt::format("{} by the paired t-test, {} by Wilcoxon's", sizes->t, sizes->wilcoxon)
              : "too small an effect to plan for"));
  };
  if (comparison.effect) {
    add("planned", *comparison.effect, comparison.sizes);
  } else {
    for (const MeasureComparison& measure : comparison.measures) {
      if (measure.t) {
        add(measure_title(measure.measure).title, measure.t->dz, measure.sizes);
      }
    }
    block.lines.emplace_back(
        "an observed effect is uncertain, see its interval: plan with one that matters (--effect)");
  }
  block.lines.emplace_back(
      "Wilcoxon's by its asymptotic relative efficiency for normal differences, 3/π");
  return block;
}

using nlohmann::json;

template <typename T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

json interval_json(const std::optional<Interval>& interval) {
  return interval ? json{interval->low, interval->high} : json();
}

json descriptives_json(const std::optional<Descriptives>& all) {
  if (!all) {
    return {};
  }
  return {
      {"mean", all->mean},     {"sd", or_null(all->sd)}, {"mean_ci", interval_json(all->mean_ci)},
      {"median", all->median}, {"q1", all->q1},          {"q3", all->q3},
      {"iqr", all->iqr()},     {"min", all->min},        {"max", all->max}};
}

json t_json(const std::optional<PairedT>& test) {
  if (!test) {
    return {};
  }
  return {{"t", test->t},
          {"df", test->df},
          {"p", test->p},
          {"dz", test->dz},
          {"dz_ci", interval_json(test->dz_ci)}};
}

json wilcoxon_json(const std::optional<Wilcoxon>& test) {
  if (!test) {
    return {};
  }
  return {{"n", test->n},       {"zeros", test->zeros},
          {"plus", test->plus}, {"minus", test->minus},
          {"w", test->w},       {"z", test->z},
          {"p", test->p},       {"exact_p", or_null(test->exact_p)},
          {"r", test->r}};
}

json sizes_json(const std::optional<SampleSizes>& sizes) {
  return sizes ? json{{"t", sizes->t}, {"wilcoxon", sizes->wilcoxon}} : json();
}

json measure_json(const MeasureComparison& measure) {
  constexpr std::array kTests{"none", "t", "wilcoxon"};
  const MeasureTitle title = measure_title(measure.measure);
  json pairs = json::array();
  for (const MeasurePair& pair : measure.pairs) {
    pairs.push_back(
        {{"participant", pair.participant}, {"first", pair.first}, {"second", pair.second}});
  }
  json normality;
  if (measure.normality) {
    normality = {{"w", measure.normality->w}, {"p", measure.normality->p}};
  }
  return {{"measure", measure.measure},
          {"title", title.title},
          {"unit", title.unit},
          {"n", measure.pairs.size()},
          {"first", descriptives_json(measure.first)},
          {"second", descriptives_json(measure.second)},
          {"difference", descriptives_json(measure.difference)},
          {"normality", normality},
          {"t", t_json(measure.t)},
          {"wilcoxon", wilcoxon_json(measure.wilcoxon)},
          {"suggested", kTests[static_cast<size_t>(measure.suggested)]},
          {"p", or_null(measure.p)},
          {"holm_p", or_null(measure.holm_p)},
          {"sample_size", sizes_json(measure.sizes)},
          {"note", measure.note},
          {"pairs", pairs}};
}

}  // namespace

std::string signed_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-') {
    const bool zero = text.find_first_of("123456789") == std::string::npos;
    text = (zero ? "" : "−") + text.substr(1);
  }
  return text;
}

std::string share_text(double value, int decimals) {
  std::string text = signed_text(value, decimals);
  const size_t zero = text.find("0.");
  if (zero != std::string::npos && (zero == 0 || text.starts_with("−0."))) {
    text.erase(zero, 1);
  }
  return text;
}

std::string p_text(double p) {
  if (p < 0.001) {
    return "p < .001";
  }
  return p > 0.999 ? "p > .999" : "p = " + share_text(p, 3);
}

std::vector<ReportBlock> study_report(const StudyComparison& comparison) {
  std::vector<ReportBlock> blocks = {summary_block(comparison), exclusion_block(comparison),
                                     value_block(comparison), test_block(comparison),
                                     note_block(comparison)};
  for (const MeasureComparison& measure : comparison.measures) {
    if (measure.measure == "sus" && measure.first) {
      blocks.push_back(sus_block(measure, comparison));
    }
  }
  blocks.push_back(size_block(comparison));
  return blocks;
}

std::string study_json(const StudyComparison& comparison) {
  json excluded = json::array();
  for (const Exclusion& one : comparison.exclusions) {
    excluded.push_back(
        {{"participant", one.participant}, {"measure", one.measure}, {"reason", one.reason}});
  }
  json measures = json::array();
  for (const MeasureComparison& measure : comparison.measures) {
    measures.push_back(measure_json(measure));
  }
  json planned;
  if (comparison.effect) {
    planned = {{"effect", *comparison.effect}, {"sample_size", sizes_json(comparison.sizes)}};
  }
  const json all = {{"modes", comparison.modes},
                    {"participants", comparison.participants},
                    {"alpha", comparison.target.alpha},
                    {"power", comparison.target.power},
                    {"excluded", excluded},
                    {"remarks", comparison.remarks},
                    {"measures", measures},
                    {"planned", planned}};
  // Names of files need not be UTF-8.
  return all.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

}  // namespace clipgs
