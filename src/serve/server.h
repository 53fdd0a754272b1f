#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "serve/certificate.h"
#include "serve/companion_desk.h"
#include "serve/connections.h"
#include "serve/live_work.h"

namespace clipgs {

/// What a server serves, where, and to whom.
struct ServerOptions {
  std::filesystem::path folder;    ///< its *.sog are the cases
  std::string host = "127.0.0.1";  ///< address to listen on
  int port = 8080;                 ///< 0: any free one
  /// Encrypts (TLS 1.2 or newer), and where it has a token answers only those who came by the
  /// address with it once: "https://192.168.1.20:8080/k3v9q-txw7h-…". Browsers then keep it in a
  /// cookie.
  std::optional<ServerIdentity> identity;
  ConnectionLimits limits = {};
  std::filesystem::path study = {};  ///< where a study is recorded (StudyDesk); "": nowhere
  std::set<std::string> only = {};   ///< names of the cases that are served; none: all of them
  LiveWork* live = nullptr;          ///< what is made while it is served; outlives the server
  CompanionDesk::Keeps keeps = {};   ///< what beside cases may be changed
  bool subfolders = false;           ///< also the cases of the folders below it
  /// The file of named tokens, see Entrance; identity's token is none then. "": none.
  std::filesystem::path tokens = {};
  std::filesystem::path access_log = {};  ///< see AccessLog; "": none
  std::filesystem::path audit = {};       ///< see CaseOpenings; "": none
  std::vector<std::string> proxies = {};  ///< see TrustedProxies
  /// Where browsers open it behind a proxy, "https://cases.hospital.example/"; "": nowhere else.
  std::string public_url = {};
};

/// Gives the viewer and the cases of one folder to browsers, and nothing else:
///
///   /                       the viewer
///   /api/cases              the cases as JSON, see case_index_json, and what is kept beside them
///                           ("keeps_marks"); with LiveWork, "making" is
///                           what is made meanwhile. ?page=NAME: that page looks, &left: no more
///   /cases/NAME.sog         a case, whole or in ranges
///   /cases/NAME/thumbnail   its picture
///   /cases/NAME.marks.json  what is marked of it, and
///   /cases/NAME.tour.json   its tour, see CompanionDesk
///   /study, /api/study      of a study, if one is recorded, see StudyDesk
///   /health                 200 while cases can be given, or 503 and why not; to everybody
///   /metrics                what it counts, see Metrics; for this machine, or a token's owner
///
/// Listening on a loopback address, it answers only requests that call it by one, so that a web
/// page elsewhere cannot reach the cases through a name of its own (DNS rebinding). No connection
/// has a thread, however slow it is; ConnectionLimits ends those that stop.
class Server {
 public:
  /// Takes the port; from here on connections wait to be answered. Throws Error if the port is
  /// taken or the folder is not there.
  explicit Server(const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  /// Whether only this machine can reach it.
  bool is_local() const;
  /// "http://127.0.0.1:8080/", with the token where there is one.
  std::string url() const;
  /// The same at another of the machine's addresses.
  std::string url_at(const std::string& host) const;
  /// Cases that can be shown, and files of the folder that cannot.
  size_t case_count() const;
  size_t broken_count() const;

  /// Answers requests until `stop`.
  void run();
  /// Ends `run`; from any thread.
  void stop();
  /// Goes on in new log files where the old ones were renamed; from any thread.
  void reopen_logs();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clipgs
