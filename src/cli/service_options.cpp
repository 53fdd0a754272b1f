#include "cli/service_options.h"

#include "core/error.h"
#include "serve/certificate.h"
#include "serve/http.h"

namespace clipgs {

void add_service_options(CLI::App& command, ServerOptions& server, CertificateFiles& files) {
  const char* const group = "As a service (docs/service.md)";
  command
      .add_option("--tokens", server.tokens,
                  "File of named tokens (clipgs token makes it): only who has one is let in, and "
                  "sees what it lets see. Changes are seen at once")
      ->group(group);
  command
      .add_flag("--subfolders", server.subfolders,
                "Also the cases of folders below FOLDER, as --tokens does")
      ->group(group);
  command
      .add_option("--access-log", server.access_log,
                  "File that gets a line of JSON for each request, without secrets; -: standard "
                  "error. SIGHUP opens it anew")
      ->group(group);
  command
      .add_option(
          "--audit", server.audit,
          "File that gets a line of JSON for each case that is opened or marked, by whom and "
          "when. Where that cannot be written, no case is given")
      ->group(group);
  CLI::Option* certificate =
      command
          .add_option("--certificate", files.certificate,
                      "Encrypt, with this certificate of an authority (PEM, with those that lead "
                      "to it)")
          ->group(group)
          ->excludes("--headset");
  CLI::Option* key =
      command.add_option("--key", files.key, "The certificate's key (PEM)")->group(group);
  certificate->needs(key);
  key->needs(certificate);
  command
      .add_option("--trusted-proxy", server.proxies,
                  "Address, or network as 10.1.0.0/16, of a reverse proxy that is believed when it "
                  "says for whom it asks (X-Forwarded-For, or Forwarded). Repeatable")
      ->allow_extra_args(false)
      ->group(group);
  command
      .add_option("--public-url", server.public_url,
                  "Where browsers open it behind a proxy, as https://cases.hospital.example/")
      ->group(group);
}

void settle_service(const CertificateFiles& files, ServerOptions& server) {
  if (!files.certificate.empty()) {
    server.identity = ServerIdentity{load_certificate(files.certificate, files.key), ""};
  }
  const std::string host = host_name(server.host).value_or(server.host);
  if (!server.tokens.empty() && !server.identity && server.proxies.empty() && !is_loopback(host)) {
    throw Error(
        "--tokens: would be sent through the network unencrypted; add --certificate and --key, or "
        "--headset, or listen for a proxy that encrypts (--trusted-proxy)");
  }
}

}  // namespace clipgs
