#include "serve/metrics.h"

#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sys/resource.h>
#include <unistd.h>

#include "core/version.h"

namespace clipgs {

namespace {

/// Text that grows by families of samples.
class Exposition {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
  }
  template <typename T>
  void sample(const T& value, std::string_view labels = "") {
    text_ += fmt::format("{}{} {}\n", name_, labels, value);
  }
  template <typename T>
  void single(std::string_view name, std::string_view type, std::string_view help, const T& value) {
    family(name, type, help);
    sample(value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_;
  std::string text_;
};

std::string label(std::string_view name, std::string_view value) {
  return fmt::format("{{{}=\"{}\"}}", name, metric_label(value));
}

/// Bytes of memory that the process has, nothing where the system does not tell.
std::optional<std::uint64_t> resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t whole = 0;
  std::uint64_t resident = 0;
  if (!(file >> whole >> resident)) {
    return std::nullopt;
  }
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void write_process(Exposition& out, double running) {
  const double now =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  out.single("clipgs_uptime_seconds", "gauge", "For how long the server has been running.",
             fmt::format("{:.3f}", running));
  // Whole: two clocks are not read at once.
  out.single("process_start_time_seconds", "gauge", "When it was started, since 1970 (UTC).",
             fmt::format("{:.0f}", now - running));
  out.single("process_cpu_seconds_total", "counter", "Time of the CPUs that it took.",
             fmt::format("{:.3f}", cpu_seconds()));
  if (const auto bytes = resident_bytes()) {
    out.single("process_resident_memory_bytes", "gauge", "Memory that it has.", *bytes);
  }
  std::error_code error;
  const auto files = std::filesystem::directory_iterator("/proc/self/fd", error);
  if (!error) {
    out.single("process_open_fds", "gauge", "Files and connections that it has open.",
               std::distance(begin(files), end(files)));
  }
}

void write_cases(Exposition& out, const std::optional<Metrics::Cases>& cases) {
  out.single("clipgs_folder_readable", "gauge", "1 while the folder of the cases can be read.",
             cases ? 1 : 0);
  if (cases) {
    out.family("clipgs_cases", "gauge", "Cases in the folder, and files that cannot be shown.");
    out.sample(cases->shown, label("state", "shown"));
    out.sample(cases->broken, label("state", "broken"));
  }
}

}  // namespace

std::string metric_label(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') {
      text += '\\';
    }
    text += c == '\n' ? R"(\n)" : std::string(1, c);
  }
  return text;
}

void Metrics::answered(RequestKind kind, unsigned status, std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  ++requests_[{kind, status}];
  bytes_[kind] += bytes;
}

std::string Metrics::text(const std::optional<Cases>& cases, std::uint64_t opened) const {
  Exposition out;
  out.family("clipgs_build_info", "gauge", "The program's version; its value is always 1.");
  out.sample(1, label("version", program_version()));
  write_cases(out, cases);
  out.single("clipgs_cases_opened_total", "counter",
             "Cases opened, each once by somebody until it has rested.", opened);
  out.single("clipgs_connections", "gauge", "Open connections.", connections_.load());
  {
    const std::scoped_lock lock(mutex_);
    out.family("clipgs_http_requests_total", "counter", "Requests by what they asked for.");
    for (const auto& [key, count] : requests_) {
      out.sample(count,
                 fmt::format(R"({{kind="{}",code="{}"}})", kind_name(key.first), key.second));
    }
    out.family("clipgs_http_sent_bytes_total", "counter", "Bytes sent, with heads, without TLS.");
    for (const auto& [kind, bytes] : bytes_) {
      out.sample(bytes, label("kind", kind_name(kind)));
    }
  }
  const std::chrono::duration<double> running = std::chrono::steady_clock::now() - started_;
  write_process(out, running.count());
  return out.take();
}

}  // namespace clipgs
