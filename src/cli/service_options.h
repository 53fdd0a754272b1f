#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "serve/server.h"

namespace clipgs {

/// An authority's certificate; both or none.
struct CertificateFiles {
  std::filesystem::path certificate;
  std::filesystem::path key;
};

/// Adds what a server in a hospital is told besides: who may see what, what is logged, what stands
/// before it. Both must outlive the parsing.
void add_service_options(CLI::App& command, ServerOptions& server, CertificateFiles& files);

/// After the parsing: reads the certificate. Throws Error, also where tokens would be sent
/// unencrypted.
void settle_service(const CertificateFiles& files, ServerOptions& server);

}  // namespace clipgs
