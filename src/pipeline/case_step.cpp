#include "pipeline/case_step.h"

#include <cstdlib>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "asset/draw_case.h"
#include "core/error.h"
#include "splat/overdraw.h"

namespace clipgs {

std::string today() {
  const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t time = epoch != nullptr ? std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(time));
}

void name_case(Case& contents, const std::string& title) {
  Scene& scene = contents.scene;
  scene.title = title.empty() ? usual_title(scene.look, scene.preset) : title;
  scene.created = today();
}

bool is_finished_case(const std::filesystem::path& path) {
  try {
    return read_case_info(path).scene.trained == 1;
  } catch (const Error&) {
    return false;  // none is there, or none that can be read
  }
}

void write_finished_case(const std::filesystem::path& path, const Case& contents,
                         const CaseCoding& coding) {
  const Image thumbnail = make_thumbnail(contents);
  write_case(path, contents, &thumbnail, coding);
  const Scene& scene = contents.scene;
  fmt::print("{}: {} Gaussians, {:.2f} MB, {:.0f} fragments a pixel\n", path.string(),
             scene.gaussians.size(), static_cast<double>(std::filesystem::file_size(path)) / 1e6,
             overdraw(scene.gaussians, scene.sphere.radius));
}

}  // namespace clipgs
