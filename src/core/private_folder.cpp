#include "core/private_folder.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const char* what) {
  throw Error("{}: a temporary folder cannot be {} ({}); set TMPDIR to a folder with free space",
              temporary_folder().string(), what, std::strerror(errno));
}

/// Blocks what ends this process and others of its terminal.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t ends;
    ::sigemptyset(&ends);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
      ::sigaddset(&ends, signal);
    }
    ::pthread_sigmask(SIG_BLOCK, &ends, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

/// In the child: outlives what ends its parent, and holds nothing of its files and locks.
[[noreturn]] void sweep_after(int life, const fs::path& folder) {
  constexpr int kLife = STDERR_FILENO + 1;
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (nowhere >= 0) {
      ::dup2(nowhere, stream);
    }
  }
  ::dup2(life, kLife);
  ::close_range(kLife + 1, ~0U, 0);
  char byte = 0;
  while (::read(kLife, &byte, 1) < 0 && errno == EINTR) {
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  std::_Exit(0);
}

}  // namespace

PrivateFolder::PrivateFolder() {
  std::string name = (temporary_folder() / "clipgs-XXXXXX").string();
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
    fail("made");
  }
  if (::mkdtemp(name.data()) == nullptr) {  // 0700
    const int error = errno;
    ::close(pipe[0]);
    ::close(pipe[1]);
    errno = error;
    fail("made");
  }
  path_ = name;
  life_ = pipe[1];
  {
    const BlockedSignals from_the_first_moment;  // of the child, which keeps them blocked
    sweeper_ = ::fork();
    if (sweeper_ == 0) {
      sweep_after(pipe[0], path_);
    }
  }
  ::close(pipe[0]);
  if (sweeper_ < 0) {
    const int error = errno;
    ::close(life_);
    fs::remove(path_);
    errno = error;
    fail("watched");
  }
}

PrivateFolder::~PrivateFolder() {
  ::close(life_);
  ::waitpid(sweeper_, nullptr, 0);
}

}  // namespace clipgs
