#pragma once

#include <string>

#include "archive/http_connection.h"

namespace clipgs {

/// What is wrong and what to do, for people, where a request was no success: "wants to know who
/// asks (401); give --token-file, or --user".
std::string line_of(const HttpOutcome& outcome, const Url& url, const HttpOptions& options);

/// Whether the system knows no such host, as far as that can be told.
bool is_unknown_host(const std::string& host);

}  // namespace clipgs
