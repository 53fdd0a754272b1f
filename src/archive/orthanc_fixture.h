#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/types.h>

#include "archive/http_client.h"
#include "archive/test_sockets.h"

namespace clipgs::testing_support {

/// A folder of a test's own, gone with the object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Makes certificates, as a hospital's own authority does, with the openssl command.
class TestAuthority {
 public:
  TestAuthority();

  /// Certificate, key, and both in one file, PEM.
  struct Issued {
    std::filesystem::path certificate;
    std::filesystem::path key;
    std::filesystem::path both;
  };
  /// `hosts`: "IP:127.0.0.1,DNS:localhost".
  Issued issue(const std::string& name, const std::string& hosts = "IP:127.0.0.1,DNS:localhost");
  /// The same, whose time was over yesterday.
  Issued issue_expired(const std::string& name);
  std::filesystem::path certificate() const { return folder_.path() / "authority.pem"; }

 private:
  ScratchFolder folder_;
};

/// What an archive of a test asks of those who come.
struct OrthancOptions {
  bool tls = false;
  std::string user;  ///< "": nobody has to say who asks
  std::string password;
  std::filesystem::path certificate;         ///< of the server, both(); empty: one of its own
  std::filesystem::path client_authorities;  ///< PEM: who asks must show a certificate of one
  nlohmann::json settings = nlohmann::json::object();  ///< further ones, or other ones, of Orthanc
};

/// A real archive on this machine: Debian's Orthanc with its DICOMweb plugin, on free ports of the
/// loopback, in a folder of its own. Its TLS is a gateway's before it: with OpenSSL 3, that of
/// Debian 12's Orthanc crashes. It ends with the object, or with the test however that ends.
class Orthanc {
 public:
  /// Whether this machine has it; tests say so and are skipped where it has not.
  static bool is_installed();

  /// Waits until it answers. Throws if it does not.
  explicit Orthanc(const OrthancOptions& options = {});
  ~Orthanc();
  Orthanc(const Orthanc&) = delete;
  Orthanc& operator=(const Orthanc&) = delete;

  int http_port() const { return http_port_; }    ///< without TLS
  int dicom_port() const { return dicom_port_; }  ///< its title: CLIPGSTEST; anybody may ask
  /// "https://127.0.0.1:PORT", without DICOMweb's /dicom-web.
  std::string url() const;
  /// What lets a client in.
  HttpOptions client_options() const;
  /// Stores all files of a folder. Returns how many.
  int upload(const std::filesystem::path& folder) const;
  /// As kill -9.
  void kill();

 private:
  bool start();

  OrthancOptions options_;
  ScratchFolder folder_;
  TestAuthority authority_;
  int http_port_ = 0;
  int dicom_port_ = 0;
  pid_t process_ = -1;
  std::unique_ptr<SocketServer> gate_;
};
}  // namespace clipgs::testing_support
