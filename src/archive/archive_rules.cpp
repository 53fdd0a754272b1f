#include "archive/archive_rules.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fmt/format.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>
#include <set>
#include <sys/stat.h>

#include "archive/url.h"

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t kMostRuleBytes = 1 << 20;
constexpr size_t kMostRules = 1000;
constexpr size_t kMostPatterns = 100;
constexpr const char* kRulesRemedy = "docs/orthanc.md tells what a file of rules may hold";

// Of clipgs build, those that depend on nothing but the series.
constexpr std::array kBuildOptions = {"quality",      "preset",       "rig",
                                      "exposure",     "tone",         "title",
                                      "model",        "seed",         "size",
                                      "test-frames",  "budget",       "train-frames",
                                      "steps",        "sh-degree",    "crop",
                                      "deface",       "gaps",         "region",
                                      "soften-metal", "bias",         "keep-table",
                                      "denoise",      "as-scanned",   "denoise-volume",
                                      "no-section",   "section-size", "gradient-opacity"};

const std::string& fact_of(const SeriesFacts& facts, const std::string& key) {
  static const std::map<std::string, std::string SeriesFacts::*> kFacts = {
      {"modality", &SeriesFacts::modality}, {"body_part", &SeriesFacts::body_part},
      {"series", &SeriesFacts::series},     {"study", &SeriesFacts::study},
      {"station", &SeriesFacts::station},   {"ae", &SeriesFacts::ae}};
  return facts.*kFacts.at(key);
}

bool is_in(const RuleRange& range, double value) {
  return value >= range.low && value <= range.high;
}

/// A text, or a list of texts.
std::vector<std::string> texts_of(const json& object, const JsonReader& reader, const char* key) {
  const json& value = object.at(key);
  const json list = value.is_array() ? value : json::array({value});
  std::vector<std::string> texts;
  for (const json& one : list) {
    if (!one.is_string() || list.size() > kMostPatterns) {
      reader.fail(key, "a text, or a list of texts");
    }
    texts.push_back(one.get<std::string>());
  }
  return texts;
}

/// [low, high], of which null is no limit.
RuleRange range_of(const json& object, const JsonReader& reader, const char* key) {
  const json& ends = object.at(key);
  RuleRange range;
  if (!ends.is_array() || ends.size() != 2) {
    reader.fail(key, "[least, most], of which null is no limit");
  }
  for (const auto& [end, limit] : {std::pair(0, &range.low), std::pair(1, &range.high)}) {
    if (ends[end].is_number()) {
      *limit = ends[end].get<double>();
    } else if (!ends[end].is_null()) {
      reader.fail(key, "[least, most], of which null is no limit");
    }
  }
  if (range.low > range.high) {
    reader.fail(key, "[least, most], in this order");
  }
  return range;
}

/// {"quality": "draft", "denoise": true} as --quality draft --denoise.
std::vector<std::string> build_words(const json& rule, const JsonReader& reader) {
  std::vector<std::string> words;
  const json options = rule.value("build", json::object());
  if (!options.is_object()) {
    reader.fail("build", "an object of options of clipgs build");
  }
  for (const auto& [name, value] : options.items()) {
    const bool known = std::ranges::find(kBuildOptions, name) != kBuildOptions.end();
    if (!known || !(value.is_string() || value.is_number() || value.is_boolean())) {
      reader.fail(fmt::format("build.{}", name).c_str(),
                  "an option of clipgs build that a rule may have, with its value");
    }
    if (name == "preset" &&
        (!value.is_string() || value.get<std::string>().find(',') != std::string::npos)) {
      reader.fail("build.preset", "one preset's name");
    }
    if (value == false) {
      continue;
    }
    words.push_back("--" + name);
    if (!value.is_boolean()) {
      words.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return words;
}

BackChoice back_of(const json& rule, const JsonReader& reader) {
  BackChoice back{false, false, false};
  for (const std::string& one : texts_of(rule, reader, "back")) {
    if (one == "film") {
      back.film = true;
    } else if (one == "report") {
      back.report = true;
    } else if (one == "link") {
      back.link = true;
    } else {
      reader.fail("back", R"(a list of "film", "report" and "link")");
    }
  }
  return back;
}

/// Relative, without steps upwards, and none that is hidden.
std::string folder_of_cases(const JsonReader& reader) {
  const fs::path folder = fs::path(reader.text("folder")).lexically_normal();
  if (folder.is_absolute() || folder.generic_string().starts_with('.') ||
      folder.generic_string().find("/.") != std::string::npos) {
    reader.fail("folder", "a folder below that of the cases");
  }
  return folder.generic_string();
}

ArchiveRule rule_of(const json& object, const std::string& where) {
  const JsonReader reader(object, where, kRulesRemedy);
  reader.allow_only({"name", "modality", "body_part", "series", "study", "station", "ae", "slices",
                     "slice_thickness", "skip", "folder", "build", "back"});
  ArchiveRule rule;
  rule.name = reader.text("name");
  for (const char* const key : {"modality", "body_part", "series", "study", "station", "ae"}) {
    if (reader.has(key)) {
      rule.patterns[key] = texts_of(object, reader, key);
    }
  }
  if (reader.has("slices")) {
    rule.slices = range_of(object, reader, "slices");
  }
  if (reader.has("slice_thickness")) {
    rule.slice_thickness = range_of(object, reader, "slice_thickness");
  }
  rule.skip = reader.has("skip") && reader.boolean("skip");
  rule.folder = reader.has("folder") ? folder_of_cases(reader) : "";
  rule.build = build_words(object, reader);
  if (reader.has("back")) {
    rule.back = back_of(object, reader);
  }
  return rule;
}

std::string url_of(const JsonReader& reader, const char* key) {
  const std::string url = reader.text(key);
  try {
    parse_url(url);
  } catch (const Error&) {
    reader.fail(key, "an address as http://127.0.0.1:8042, without a user or password");
  }
  return url;
}

void read_times(const JsonReader& reader, ArchiveRules& rules) {
  constexpr int kDay = 24 * 60 * 60;
  for (const auto& [key, time, least] :
       {std::tuple("poll_seconds", &rules.poll, 1), std::tuple("settle_seconds", &rules.settle, 0),
        std::tuple("retry_seconds", &rules.retry, 1)}) {
    if (reader.has(key)) {
      *time = std::chrono::seconds(reader.integer(key, least, kDay));
    }
  }
}

void require_private_credentials(const fs::path& file) {
  const char* const systemd = std::getenv("CREDENTIALS_DIRECTORY");
  struct stat status{};
  if (::stat(file.c_str(), &status) != 0) {
    throw Error("{}: there is no such file of credentials; write USER:PASSWORD into one",
                file.string());
  }
  const bool from_systemd = systemd != nullptr && fs::absolute(file).parent_path() == systemd;
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0 && !from_systemd) {
    throw Error("{}: others than its owner may open it (mode {:04o}); run chmod 600 {}",
                file.string(), status.st_mode & 07777, file.string());
  }
}

}  // namespace

bool ArchiveRule::matches(const SeriesFacts& facts) const {
  const bool texts = std::ranges::all_of(patterns, [&](const auto& pattern) {
    return std::ranges::any_of(pattern.second, [&](const std::string& one) {
      return ::fnmatch(one.c_str(), fact_of(facts, pattern.first).c_str(), FNM_CASEFOLD) == 0;
    });
  });
  return texts && is_in(slices, facts.slices) &&
         (!slice_thickness ||
          (facts.slice_thickness && is_in(*slice_thickness, *facts.slice_thickness)));
}

const ArchiveRule* ArchiveRules::find(const SeriesFacts& facts) const {
  const auto rule = std::ranges::find_if(rules, [&](const auto& r) { return r.matches(facts); });
  return rule == rules.end() || rule->skip ? nullptr : &*rule;
}

ArchiveRules read_rules(const fs::path& file) {
  const std::vector<std::uint8_t> bytes = read_file(file, kMostRuleBytes);
  const json object = json::parse(bytes, nullptr, false);
  if (!object.is_object() || object.value("clipgs_archive", json()) != 1) {
    throw Error("{}: is no file of rules of version 1 (\"clipgs_archive\": 1); {}", file.string(),
                kRulesRemedy);
  }
  const JsonReader reader(object, file.string(), kRulesRemedy);
  reader.allow_only({"clipgs_archive", "orthanc", "credentials", "public_url", "wake",
                     "poll_seconds", "film_pictures", "film_size", "settle_seconds",
                     "retry_seconds", "tries", "metadata", "rules"});
  ArchiveRules rules;
  rules.orthanc = url_of(reader, "orthanc");
  const auto text = [&](const char* key) {
    return reader.has(key) ? reader.text(key) : std::string();
  };
  rules.credentials = text("credentials");
  rules.wake = text("wake");
  if (reader.has("public_url")) {
    rules.public_url = url_of(reader, "public_url");
    rules.public_url += rules.public_url.ends_with('/') ? "" : "/";
  }
  read_times(reader, rules);
  for (const auto& [key, number, least, most] : {std::tuple("tries", &rules.tries, 1, 1000),
                                                 {"metadata", &rules.metadata, 1024, 65535},
                                                 {"film_pictures", &rules.film_pictures, 4, 360},
                                                 {"film_size", &rules.film_size, 64, 2048}}) {
    *number = reader.has(key) ? reader.integer(key, least, most) : *number;
  }
  if (reader.children("rules", kMostRules).empty()) {
    reader.fail("rules", "a list of at least one rule");
  }
  std::set<std::string> names;
  for (const json& one : object["rules"]) {
    const std::string where = fmt::format("{}: rules[{}]", file.string(), rules.rules.size());
    rules.rules.push_back(rule_of(one, where));
    if (!names.insert(rules.rules.back().name).second) {
      throw Error("{}: a second rule is called {}; give it another name", where,
                  rules.rules.back().name);
    }
  }
  return rules;
}

Credentials read_credentials(const ArchiveRules& rules) {
  const char* const variable = std::getenv("CLIPGS_ORTHANC_CREDENTIALS");
  const fs::path file =
      rules.credentials.empty() && variable != nullptr ? fs::path(variable) : rules.credentials;
  if (file.empty()) {
    return {};
  }
  require_private_credentials(file);
  const std::string text = read_text(file);
  const std::string line = text.substr(0, text.find_first_of("\r\n"));
  const size_t colon = line.find(':');
  if (colon == 0 || colon == std::string::npos) {
    throw Error("{}: USER:PASSWORD was expected in its first line", file.string());
  }
  return {line.substr(0, colon), line.substr(colon + 1)};
}

}  // namespace clipgs
