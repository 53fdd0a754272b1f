#include "cli/film.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "asset/webp.h"
#include "asset/webp_animation.h"
#include "core/error.h"
#include "core/file.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

class WebpFilm : public Film {
 public:
  WebpFilm(fs::path output, float fps) : output_(std::move(output)), pictures_(fps, kQuality) {}

  void add(const Image& picture, int times) override { pictures_.add(picture, times); }
  void finish() override {
    const Bytes bytes = pictures_.finish();
    write_file(output_, bytes.data(), bytes.size());
  }

 private:
  static constexpr float kQuality = 80;

  fs::path output_;
  WebpAnimation pictures_;
};

/// 00000.png, 00001.png, …
class FolderFilm : public Film {
 public:
  explicit FolderFilm(fs::path folder) : folder_(std::move(folder)) { create_folder(folder_); }

  void add(const Image& picture, int times) override {
    for (int i = 0; i < times; ++i) {
      write_png(folder_ / fmt::format("{:05}.png", count_++), picture);
    }
  }
  void finish() override {}

 private:
  fs::path folder_;
  int count_ = 0;
};

/// A program that is given bytes by its standard input. Its own words go to standard error.
class Receiver {
 public:
  /// Throws Error where there is no program of that name.
  explicit Receiver(std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
      throw Error("{}: {}", words[0], std::strerror(errno));
    }
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int error =
        posix_spawnp(&pid_, words[0].c_str(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[0]);
    input_ = ends[1];
    if (error != 0) {
      ::close(input_);
      throw Error(
          "{} is not there, which writes .mp4 and .webm; install it (apt install {}), or "
          "give a name that ends in .webp, or a folder",
          words[0], words[0]);
    }
  }
  ~Receiver() { end(); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Whether it took them all.
  bool give(const std::uint8_t* bytes, size_t size) const {
    while (size > 0) {
      const ssize_t taken = ::write(input_, bytes, size);
      if (taken < 0 && errno != EINTR) {
        return false;
      }
      bytes += std::max<ssize_t>(taken, 0);
      size -= static_cast<size_t>(std::max<ssize_t>(taken, 0));
    }
    return true;
  }

  /// There is no more. Returns whether it ended well.
  bool end() {
    if (input_ < 0) {
      return false;
    }
    ::close(std::exchange(input_, -1));
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    return status == 0;
  }

 private:
  pid_t pid_ = 0;
  int input_ = -1;
};

/// By ffmpeg, into a file beside the output that takes its place in the end.
class VideoFilm : public Film {
 public:
  VideoFilm(fs::path output, float fps)
      : output_(std::move(output)),
        part_(output_.string() + fmt::format(".clipgs-{}.part", ::getpid())),
        fps_(fps) {
    require_writable(output_);
    // A program that ends early is said to; it does not end this one.
    ::signal(SIGPIPE, SIG_IGN);
    Receiver({"ffmpeg", "-version"}).end();
  }
  ~VideoFilm() override {
    ffmpeg_.reset();
    std::error_code ignored;
    fs::remove(part_, ignored);
  }
  VideoFilm(const VideoFilm&) = delete;
  VideoFilm& operator=(const VideoFilm&) = delete;

  void add(const Image& picture, int times) override {
    if (!ffmpeg_) {
      ffmpeg_ = std::make_unique<Receiver>(command(picture));
    }
    const Texels texels = to_texels(picture);
    for (int i = 0; i < times; ++i) {
      if (!ffmpeg_->give(texels.rgba.data(), texels.rgba.size())) {
        fail();
      }
    }
  }
  void finish() override {
    if (!ffmpeg_ || !ffmpeg_->end()) {
      fail();
    }
    fs::rename(part_, output_);
  }

 private:
  [[noreturn]] void fail() const {
    throw Error("{}: ffmpeg could not write it; what it says stands above", output_.string());
  }

  std::vector<std::string> command(const Image& picture) const {
    std::vector<std::string> words = {
        "ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgba",
        "-video_size", fmt::format("{}x{}", picture.width, picture.height), "-framerate",
        fmt::format("{}", fps_), "-i", "-",
        // Colours have half the resolution: both sides are even.
        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-map_metadata", "-1",
        "-fflags", "+bitexact", "-flags:v", "+bitexact"};
    const std::vector<std::string> codec =
        output_.extension() == ".webm"
            ? std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "24", "-b:v",
                                       "0",    "-row-mt",    "1",    "-f", "webm"}
            : std::vector<std::string>{"-c:v",      "libx264",    "-crf", "18",
                                       "-movflags", "+faststart", "-f",   "mp4"};
    words.insert(words.end(), codec.begin(), codec.end());
    words.push_back(part_.string());
    return words;
  }

  fs::path output_;
  fs::path part_;
  float fps_;
  std::unique_ptr<Receiver> ffmpeg_;
};

}  // namespace

std::unique_ptr<Film> make_film(const fs::path& output, float frames_per_second) {
  const fs::path ending = output.extension();
  if (ending == ".webp") {
    require_writable(output);
    return std::make_unique<WebpFilm>(output, frames_per_second);
  }
  if (ending == ".mp4" || ending == ".webm") {
    return std::make_unique<VideoFilm>(output, frames_per_second);
  }
  if (ending.empty()) {
    return std::make_unique<FolderFilm>(output);
  }
  throw Error(
      "{}: give a name that ends in .webp, .mp4 or .webm, or, for single pictures, that of "
      "a folder",
      output.string());
}

}  // namespace clipgs
