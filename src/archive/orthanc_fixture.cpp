#include "archive/orthanc_fixture.h"

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <signal.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "core/file.h"

namespace clipgs::testing_support {

namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "/usr/sbin/Orthanc";
constexpr const char* kPlugin = "/usr/share/orthanc/plugins/libOrthancDicomWeb.so";

void run(const std::string& command) {
  if (std::system((command + " 2>/dev/null").c_str()) != 0) {
    throw std::runtime_error("failed: " + command);
  }
}

bool listens(int port) {
  const int socket = connect_to(port);
  ::close(socket);
  return socket >= 0;
}

}  // namespace

ScratchFolder::ScratchFolder() {
  const fs::path memory = "/dev/shm";  // where an archive's database is quick
  const fs::path base = fs::is_directory(memory) ? memory : fs::temp_directory_path();
  std::string name = (base / "clipgs-archive-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no temporary folder");
  }
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

namespace {

/// A key, and a certificate of it, by "openssl req".
std::string request(const fs::path& folder, const std::string& name, const std::string& more) {
  return fmt::format(
      "cd {} && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 "
      "-subj /CN={} -keyout {}.key -out {}.pem {}",
      folder.string(), name, name, name, more);
}

}  // namespace

TestAuthority::TestAuthority() { run(request(folder_.path(), "authority", "")); }

TestAuthority::Issued TestAuthority::issue(const std::string& name, const std::string& hosts) {
  const fs::path stem = folder_.path() / name;
  run(request(folder_.path(), name,
              fmt::format("-CA authority.pem -CAkey authority.key -addext subjectAltName={} "
                          "-addext basicConstraints=critical,CA:FALSE",
                          hosts)));
  Issued issued{stem.string() + ".pem", stem.string() + ".key", stem.string() + ".both"};
  write_text(issued.both, read_text(issued.certificate) + read_text(issued.key));
  return issued;
}

TestAuthority::Issued TestAuthority::issue_expired(const std::string& name) {
  const Issued issued = issue(name);
  run(
      fmt::format("cd {0} && openssl x509 -x509toreq -in {1}.pem -signkey {1}.key "
                  "-copy_extensions copy -out request && openssl x509 -req -in request "
                  "-CA authority.pem -CAkey authority.key -copy_extensions copy -days -1 "
                  "-out {1}.pem && cat {1}.pem {1}.key > {1}.both",
                  folder_.path().string(), name));
  return issued;
}

bool Orthanc::is_installed() { return fs::exists(kProgram) && fs::exists(kPlugin); }

Orthanc::Orthanc(const OrthancOptions& options) : options_(options) {
  constexpr int kTries = 3;  // somebody else may take the port
  for (int i = 0; i < kTries; ++i) {
    if (start()) {
      if (options_.tls) {
        gate_ = make_tls_gate(
            http_port_,
            options_.certificate.empty() ? authority_.issue("server").both : options_.certificate,
            options_.client_authorities);
      }
      return;
    }
    kill();
  }
  throw std::runtime_error("Orthanc does not start: " + read_text(folder_.path() / "log"));
}

Orthanc::~Orthanc() { kill(); }

bool Orthanc::start() {
  http_port_ = free_port();
  dicom_port_ = free_port();
  const std::string storage = (folder_.path() / "storage").string();
  nlohmann::json settings = {{"Name", "clipgs test"},
                             {"StorageDirectory", storage},
                             {"IndexDirectory", storage},
                             {"HttpPort", http_port_},
                             {"DicomPort", dicom_port_},
                             {"DicomAet", "CLIPGSTEST"},
                             {"DicomAlwaysAllowEcho", true},
                             {"DicomAlwaysAllowFind", true},
                             {"DicomAlwaysAllowGet", true},
                             {"DicomAlwaysAllowMove", true},
                             {"DicomAlwaysAllowStore", true},
                             {"RemoteAccessAllowed", false},
                             {"AuthenticationEnabled", !options_.user.empty()},
                             {"Plugins", {kPlugin}}};
  if (!options_.user.empty()) {
    settings["RegisteredUsers"] = {{options_.user, options_.password}};
  }
  settings.merge_patch(options_.settings);
  const fs::path file = folder_.path() / "orthanc.json";
  write_text(file, settings.dump());

  process_ = ::fork();
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int log = ::open((folder_.path() / "log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execl(kProgram, kProgram, file.c_str(), nullptr);
    std::_Exit(127);
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    if (::waitpid(process_, nullptr, WNOHANG) != 0) {
      process_ = -1;
      return false;
    }
    if (listens(http_port_) && listens(dicom_port_)) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

std::string Orthanc::url() const {
  return gate_ ? fmt::format("https://127.0.0.1:{}", gate_->port())
               : fmt::format("http://127.0.0.1:{}", http_port_);
}

HttpOptions Orthanc::client_options() const {
  HttpOptions options;
  options.user = options_.user;
  options.password = options_.password;
  if (options_.tls) {
    options.authorities = authority_.certificate();
  }
  return options;
}

int Orthanc::upload(const fs::path& folder) const {
  HttpClient client(url(), client_options());
  int count = 0;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (file.is_regular_file()) {
      client.post("/instances", {"application/dicom", read_text(file.path())});
      ++count;
    }
  }
  return count;
}

void Orthanc::kill() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
}

}  // namespace clipgs::testing_support
