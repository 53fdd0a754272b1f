#pragma once

#include <chrono>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace clipgs {

/// What a series in an archive says of itself, as far as rules ask for it.
struct SeriesFacts {
  std::string modality;
  std::string body_part;  ///< Body Part Examined
  std::string series;     ///< Series Description
  std::string study;      ///< Study Description
  std::string station;    ///< Station Name
  std::string ae;         ///< AE title of who sent it
  int slices = 0;
  std::optional<double> slice_thickness;  ///< mm
};

/// Both ends included.
struct RuleRange {
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
};

/// What goes back into the archive.
struct BackChoice {
  bool film = true;
  bool report = true;
  bool link = true;  ///< as metadata of the series
};

/// Which series are built, and how.
struct ArchiveRule {
  std::string name;
  /// By key ("modality", …): patterns as the shell's, in any case of letters, one of which must
  /// match. Keys that are not there match anything.
  std::map<std::string, std::vector<std::string>> patterns;
  RuleRange slices;
  std::optional<RuleRange> slice_thickness;  ///< mm; a series that tells none does not match
  bool skip = false;                         ///< what matches is left alone
  std::string folder;                        ///< of the cases, below that of all; "": there
  std::vector<std::string> build;            ///< words for clipgs build
  BackChoice back;

  bool matches(const SeriesFacts& facts) const;
};

/// A file of rules (docs/orthanc.md).
struct ArchiveRules {
  std::string orthanc;                ///< URL of its REST interface
  std::filesystem::path credentials;  ///< file with USER:PASSWORD; "": see read_credentials()
  std::string public_url;             ///< of clipgs serve, ends in "/"; "": there are no links
  std::filesystem::path wake;         ///< a file that is touched when there is something new
  std::chrono::seconds poll{5};       ///< how often the archive is asked
  std::chrono::seconds settle{60};    ///< without a new image, before a series is built
  std::chrono::seconds retry{60};     ///< before the second try; then doubled each time
  int tries = 5;
  int metadata = 1024;  ///< number of the series' metadata that holds the link
  int film_pictures = 36;
  int film_size = 448;  ///< px, high and wide
  std::vector<ArchiveRule> rules;

  /// The first that matches; null: none, or one that leaves the series alone.
  const ArchiveRule* find(const SeriesFacts& facts) const;
};

/// Throws Error, in one line, for unknown keys as well.
ArchiveRules read_rules(const std::filesystem::path& file);

/// Of basic authentication; both empty: none.
struct Credentials {
  std::string user;
  std::string password;
};

/// From the rules' file, or else that of $CLIPGS_ORTHANC_CREDENTIALS. Throws Error if others than
/// its owner may open it, as far as systemd did not put it there.
Credentials read_credentials(const ArchiveRules& rules);

}  // namespace clipgs
