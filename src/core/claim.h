#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clipgs {

/// All that a result is made of: a JSON object of plain values by name, and of digests (Digest) of
/// what is larger. Names are words for people, joined by underscores.
using Claim = nlohmann::json;

/// A claim of a step of the program, whose `revision` is raised when the step makes other results
/// of the same input: neither that nor another version of the program reuses older results.
Claim claim_of_step(const std::string& step, int revision);

/// What differs, for people: "the preset changed", "the size and the seed changed". Empty if
/// nothing does.
std::string changes(const Claim& before, const Claim& now);

/// SHA-256 of a claim, to be part of the claim of what is made of the result.
std::string digest_of(const Claim& claim);

/// A piece of work in a folder that is done once for what it is made of. Its claim lies beside the
/// results, as NAME.made-of.json of results NAME.*, from the start of the work on.
class Step {
 public:
  /// Looks at what is there, and says so in a line on standard error. Work that is finished is
  /// `done`. Results of another claim are removed, and so are `remains` (checkpoints and the like);
  /// work of this claim that is unfinished keeps them, to go on from. `name`: for people, e.g.
  /// "pictures". Throws Error if the claim cannot be written.
  Step(const std::string& name, const std::filesystem::path& stem, Claim claim,
       const std::vector<std::filesystem::path>& results,
       const std::vector<std::filesystem::path>& remains = {});

  bool done() const { return done_; }
  /// Call when the results are there, whole.
  void finish() const { write(true); }
  const Claim& claim() const { return claim_; }

 private:
  void write(bool finished) const;

  std::filesystem::path file_;
  Claim claim_;
  bool done_ = false;
};

/// The claim of what lies in a folder as STEM.*, finished or not; null if there is none.
Claim read_claim(const std::filesystem::path& stem);

/// Removes results and their claim, if they are there.
void forget(const std::filesystem::path& stem, const std::vector<std::filesystem::path>& results);

}  // namespace clipgs
