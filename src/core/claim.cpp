#include "core/claim.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

#include "core/digest.h"
#include "core/file.h"
#include "core/version.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMadeOf = "made_of";
constexpr const char* kFinished = "finished";

fs::path claim_file(const fs::path& stem) {
  fs::path file = stem;
  file += ".made-of.json";
  return file;
}

/// The claim's file; null if there is none, or none that can be read.
Claim read_claim_file(const fs::path& file) {
  if (!fs::is_regular_file(file)) {
    return nullptr;
  }
  Claim json = Claim::parse(read_text(file), nullptr, false);
  const bool known = json.is_object() && json.contains(kMadeOf) && json[kMadeOf].is_object() &&
                     json.contains(kFinished) && json[kFinished].is_boolean();
  return known ? json : Claim();
}

bool exists(const fs::path& path) { return fs::exists(path); }

void remove_all(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    fs::remove(file);
  }
}

}  // namespace

Claim claim_of_step(const std::string& step, int revision) {
  return {{"program", fmt::format("clipgs {}, {} {}", program_version(), step, revision)}};
}

std::string changes(const Claim& before, const Claim& now) {
  std::set<std::string> names;
  for (const Claim* claim : {&before, &now}) {
    for (const auto& [name, value] : claim->items()) {
      names.insert(name);
    }
  }
  std::vector<std::string> changed;
  for (std::string name : names) {
    if (before.value(name, Claim()) != now.value(name, Claim())) {
      std::ranges::replace(name, '_', ' ');
      changed.push_back("the " + name);
    }
  }
  if (changed.empty()) {
    return "";
  }
  const std::string last = changed.back();
  changed.pop_back();
  return fmt::format("{}{}{} changed", fmt::join(changed, ", "), changed.empty() ? "" : " and ",
                     last);
}

std::string digest_of(const Claim& claim) { return Digest().add(claim.dump()).hex(); }

Step::Step(const std::string& name, const fs::path& stem, Claim claim,
           const std::vector<fs::path>& results, const std::vector<fs::path>& remains)
    : file_(claim_file(stem)), claim_(std::move(claim)) {
  const Claim before = read_claim_file(file_);
  const bool is_known = !before.is_null();
  const std::string changed = is_known ? changes(before[kMadeOf], claim_) : "";
  if (is_known && changed.empty()) {
    done_ = before[kFinished].get<bool>() && std::ranges::all_of(results, exists);
    if (done_) {
      fmt::print(stderr, "{}: done before\n", name);
      return;
    }
  } else {
    if (is_known || std::ranges::any_of(results, exists)) {
      fmt::print(stderr, "{}: made again, {}\n", name,
                 is_known ? changed : "it is not known of what it was made");
    }
    remove_all(remains);
    remove_all(results);
  }
  write(false);
}

void Step::write(bool finished) const {
  write_text(file_, Claim{{kMadeOf, claim_}, {kFinished, finished}}.dump(1) + "\n");
}

Claim read_claim(const fs::path& stem) {
  const Claim file = read_claim_file(claim_file(stem));
  return file.is_null() ? file : file[kMadeOf];
}

void forget(const fs::path& stem, const std::vector<fs::path>& results) {
  remove_all(results);
  fs::remove(claim_file(stem));
}

}  // namespace clipgs
