#include "cli/open_browser.h"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "core/error.h"

namespace clipgs {

namespace {

void tell(const std::string& url) {
  warn("no browser could be opened; open this address in one: " + url);
}

/// Programs that show an address, the best first.
std::vector<std::string> openers() {
  std::vector<std::string> names;
  if (const char* browser = std::getenv("BROWSER"); browser != nullptr && *browser != '\0') {
    names = CLI::detail::split(browser, ':');
  }
#ifdef __APPLE__
  names.insert(names.end(), {"open"});
#else
  names.insert(names.end(), {"xdg-open", "x-www-browser", "sensible-browser"});
#endif
  return names;
}

/// Starts a program, whose words are not for the user; 0 where there is none of that name.
pid_t start(std::string program, std::string argument) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
  }
  // The signals that end this program wait for it to take them; the other's do not, and Ctrl-C is
  // not for it.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  char* const words[] = {program.data(), argument.data(), nullptr};
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, program.c_str(), &files, &attributes, words, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error == 0 ? pid : 0;
}

}  // namespace

void open_browser(const std::string& url) {
  for (const std::string& opener : openers()) {
    if (const pid_t pid = start(opener, url); pid != 0) {
      std::thread([pid, url] {
        int status = 0;
        if (waitpid(pid, &status, 0) == pid && status != 0) {
          tell(url);
        }
      }).detach();
      return;
    }
  }
  tell(url);
}

}  // namespace clipgs
