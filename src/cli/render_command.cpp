#include <memory>

#include "asset/case.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/file.h"
#include "core/image.h"
#include "splat/render.h"

namespace clipgs {

namespace {

struct RenderArguments {
  std::string scene;
  std::string output;
  std::string view = "0,0";
  std::string plane;
  std::string clip = "exact";
  std::string size = "512x512";
  bool reference = false;
};

void run_render(const RenderArguments& arguments) {
  const View view = parse_view(arguments.view);
  const IVec3 size = parse_size(arguments.size);
  const std::optional<Plane> plane = parse_plane(arguments.plane);
  const ClipOperator clip = parse_clip_operator(arguments.clip);
  require_writable(arguments.output);
  const Scene scene = load_scene(arguments.scene);
  warn_if_plane_misses(plane, scene.bounds);
  const Camera camera = frame_sphere(scene.sphere, view, size.x, size.y);
  const auto draw = arguments.reference ? render_reference : render;
  write_png(arguments.output, draw(scene.gaussians, camera, plane, clip));
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Draw a case or scene as a picture");
  const auto arguments = std::make_shared<RenderArguments>();
  command->add_option("scene", arguments->scene, "Case (.sog) or scene (.ply)")->required();
  command->add_option("-o,--output", arguments->output, "Picture to write (RGBA PNG)")->required();
  command->add_option("--view", arguments->view, "Camera: azimuth,elevation[,zoom] in degrees")
      ->capture_default_str();
  command->add_option("--plane", arguments->plane,
                      "Cut: nx,ny,nz,c keeps n·x >= c (RAS, mm); none if not given");
  command->add_option("--clip", arguments->clip, "Clip operator: hard, soft or exact")
      ->capture_default_str();
  command->add_option("--size", arguments->size, "Width x height in pixels")->capture_default_str();
  command->add_flag("--reference", arguments->reference,
                    "Draw with the slow double-precision reference renderer");
  command->footer("Example: clipgs render case.sog -o cut.png --view 30,20 --plane 0,0,-1,40");
  command->callback([arguments] { run_render(*arguments); });
}

}  // namespace clipgs
