#include "core/helper_process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <span>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace clipgs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kNoAnswer = UINT64_MAX;  // in place of the answer's size

/// False if the other end is gone, or `end` has come.
template <typename Byte, typename Move>
bool move_all(int socket, std::span<Byte> bytes, short event, Clock::time_point end,
              const Move& move) {
  while (!bytes.empty()) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd waiting{socket, event, 0};
    const int timeout = end == Clock::time_point::max()
                            ? -1
                            : static_cast<int>(std::clamp<decltype(left)>(left, 0, 1 << 30));
    const int ready = ::poll(&waiting, 1, timeout);
    const ssize_t moved = ready > 0 ? move(bytes) : 0;
    if ((ready < 0 || moved < 0) && errno != EINTR && errno != EAGAIN) {
      return false;
    }
    if (ready == 0 || (ready > 0 && moved == 0)) {
      return false;
    }
    bytes = bytes.subspan(static_cast<size_t>(std::max<ssize_t>(moved, 0)));
  }
  return true;
}

bool send_all(int socket, std::span<const char> bytes, Clock::time_point end) {
  return move_all(socket, bytes, POLLOUT, end, [&](std::span<const char> rest) {
    return ::send(socket, rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  });
}

bool receive_all(int socket, std::span<char> bytes, Clock::time_point end) {
  return move_all(socket, bytes, POLLIN, end, [&](std::span<char> rest) {
    return ::recv(socket, rest.data(), rest.size(), MSG_DONTWAIT);
  });
}

bool send_number(int socket, std::uint64_t number, Clock::time_point end) {
  return send_all(socket, {reinterpret_cast<const char*>(&number), sizeof number}, end);
}

bool receive_number(int socket, std::uint64_t& number, Clock::time_point end) {
  return receive_all(socket, {reinterpret_cast<char*>(&number), sizeof number}, end);
}

std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void confine(std::uint64_t most_memory) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  if (!HelperProcess::kMemoryIsFree) {
    const rlimit memory{most_memory, most_memory};
    ::setrlimit(RLIMIT_AS, &memory);
  }
  // Libraries print what they think of a file; our one line says it.
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (nowhere >= 0) {
      ::dup2(nowhere, stream);
    }
  }
}

/// In the child, until this process closes its end.
void answer_requests(int socket, const HelperProcess::Work& work) {
  constexpr auto kForever = Clock::time_point::max();
  for (std::uint64_t size = 0; receive_number(socket, size, kForever);) {
    std::string request(size, '\0');
    if (!receive_all(socket, request, kForever)) {
      return;
    }
    const std::optional<std::string> answer = work(std::move(request));
    if (!send_number(socket, answer ? answer->size() : kNoAnswer, kForever) ||
        (answer && !send_all(socket, *answer, kForever))) {
      return;
    }
  }
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
const bool HelperProcess::kMemoryIsFree = true;
#elif defined(__has_feature)
const bool HelperProcess::kMemoryIsFree = __has_feature(address_sanitizer);
#else
const bool HelperProcess::kMemoryIsFree = false;
#endif

HelperProcess::HelperProcess(const Work& work, std::uint64_t most_memory) {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw Error("no process can be started beside this one ({})", std::strerror(errno));
  }
  const std::uint64_t memory = address_space() + most_memory;
  child_ = ::fork();
  if (child_ == 0) {
    ::close(ends[0]);
    confine(memory);
    try {
      answer_requests(ends[1], work);
    } catch (const std::exception&) {  // out of memory
      ::_exit(1);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  socket_ = ends[0];
  if (child_ < 0) {
    ::close(socket_);
    throw Error("no process can be started beside this one ({})", std::strerror(errno));
  }
}

HelperProcess::~HelperProcess() { end(); }

std::optional<std::string> HelperProcess::ask(const std::string& request, std::uint64_t most,
                                              std::chrono::milliseconds limit) {
  const Clock::time_point until = Clock::now() + limit;
  std::uint64_t size = 0;
  if (socket_ < 0 || !send_number(socket_, request.size(), until) ||
      !send_all(socket_, request, until) || !receive_number(socket_, size, until)) {
    end();
    return std::nullopt;
  }
  if (size == kNoAnswer) {
    return std::nullopt;
  }
  std::string answer(std::min(size, most), '\0');
  if (size > most || !receive_all(socket_, answer, until)) {
    end();
    return std::nullopt;
  }
  return answer;
}

void HelperProcess::end() {
  if (socket_ < 0) {
    return;
  }
  ::close(socket_);
  socket_ = -1;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace clipgs
