#include "pipeline/case_step.h"

#include <fmt/format.h>

#include "asset/draw_case.h"
#include "splat/overdraw.h"

namespace clipgs {

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
