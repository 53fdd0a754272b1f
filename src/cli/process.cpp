#include "cli/process.h"

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <signal.h>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace clipgs::testing_support {

namespace {

namespace fs = std::filesystem;

pid_t start(const std::vector<std::string>& arguments, const fs::path& out, const fs::path& err) {
  std::vector<char*> argv;
  std::string program = CLIPGS_PROGRAM;
  argv.push_back(program.data());
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    ::execv(program.c_str(), argv.data());
    std::_Exit(127);
  }
  if (pid < 0) {
    throw std::runtime_error("fork failed");
  }
  return pid;
}

std::string contents(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  fs::remove(path);
  return text.str();
}

fs::path scratch(const char* name) {
  static int counter = 0;
  return fs::temp_directory_path() /
         ("clipgs-run-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + name);
}

}  // namespace

Finished run_clipgs(const std::vector<std::string>& arguments) {
  const fs::path out = scratch(".out");
  const fs::path err = scratch(".err");
  const pid_t pid = start(arguments, out, err);
  int status = 0;
  ::waitpid(pid, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(out),
          contents(err)};
}

bool run_clipgs_and_kill(const std::vector<std::string>& arguments, double seconds) {
  const fs::path out = scratch(".out");
  const fs::path err = scratch(".err");
  const pid_t pid = start(arguments, out, err);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  bool running = true;
  while (running && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    running = ::waitpid(pid, nullptr, WNOHANG) == 0;
  }
  if (running) {
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
  }
  contents(out);
  contents(err);
  return running;
}

}  // namespace clipgs::testing_support
