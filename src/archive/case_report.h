#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/image.h"

namespace clipgs {

/// What a report tells of a case; nothing of the patient.
struct CaseReport {
  std::string title;
  std::vector<Image> pictures;                               ///< RGB, up to four beside each other
  std::vector<std::pair<std::string, std::string>> figures;  ///< what, and how much
  std::vector<std::string> notes;                            ///< warnings of the build
  std::string link;                                          ///< to the case
};

/// One page (A4) as PDF, in which the link is one. The same input gives the same bytes. Throws
/// Error.
std::string report_pdf(const CaseReport& report);

}  // namespace clipgs
