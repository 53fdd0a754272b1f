#include <fmt/format.h>
#include <memory>
#include <optional>

#include "asset/draw_case.h"
#include "cli/animation.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/cut_options.h"
#include "cli/tour_film.h"
#include "cli/view_options.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "section/annotate.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

struct RenderArguments {
  std::string scene;
  std::string output;
  ViewArguments view{"0,0"};
  CutArguments cut;
  BackdropArguments backdrop;
  std::optional<int> state;
  AnimationArguments animation;
  std::string clip = "exact";
  std::string section;
  float grey = 0;
  std::string window;  ///< empty: the first that the case is usually seen through
  std::string openings = "cinematic";
  bool annotate = false;
  std::vector<std::string> pins;
  bool reference = false;
  std::string rig;
  float turn = 0;
  std::string lamp;
  std::string tour;
  bool no_captions = false;

  bool changes_light() const { return !rig.empty() || turn != 0 || !lamp.empty(); }
};

/// Whether what the user asks for is in the section volume.
bool needs_section(const RenderArguments& arguments) {
  return arguments.section == "volume" || arguments.grey > 0 || arguments.annotate ||
         !arguments.pins.empty() || arguments.changes_light();
}

/// What the case is lit by, if it has a section.
LightRig lights_of(const RenderArguments& arguments, const Case& contents) {
  const LightRig own = contents.section ? contents.section->rig : LightRig();
  LightRig rig = turned(arguments.rig.empty() ? own : load_rig(arguments.rig), arguments.turn);
  if (arguments.lamp.empty()) {
    return rig;
  }
  const Vec3 direction = parse_vector(arguments.lamp, "--lamp");
  if (glm::length(direction) == 0) {
    throw Error("--lamp {}: is no direction; give right, anterior, superior, as 1,1,2",
                arguments.lamp);
  }
  return lamp_instead(rig, direction);
}

/// Volume where the case has one, unless the user says otherwise.
FaceSource face_source(const RenderArguments& arguments, const Case& contents) {
  if (needs_section(arguments) && !contents.section) {
    throw Error(
        "{}: has no section volume to draw faces from; build it again, without --no-section",
        arguments.scene);
  }
  if (arguments.section.empty()) {
    return contents.section ? FaceSource::kVolume : FaceSource::kSplats;
  }
  const FaceSource source = parse_face_source(arguments.section);
  if (source == FaceSource::kSplats && arguments.changes_light()) {
    throw Error("--section splats shows the light that they were trained in; leave it out");
  }
  return source;
}

/// The plane of one state, which is said on standard output.
Cut cut_of_state(int state, const Scene& scene, const std::string& name) {
  const PlaneStates states =
      scene.states.count > 0 ? scene.states : PlaneStates::over(scene.extent);
  if (state >= states.count) {
    throw Error("{}: has no state {}; give --state a number from 0 to {}", name, state,
                states.count - 1);
  }
  const float position = states.position(state);
  fmt::print("state {} of {}: {:.2f} mm\n", state, states.count, position);
  return states.plane(scene.axis, position);
}

void render_tour(const RenderArguments& arguments) {
  const IVec3 size = parse_size(arguments.view.size);
  TourFilmArguments film;
  film.tour = arguments.tour;
  film.scene = arguments.scene;
  film.output = arguments.output;
  film.width = size.x;
  film.height = size.y;
  film.fps = arguments.animation.fps;
  film.background = parse_background(arguments.backdrop.background);
  film.captions = !arguments.no_captions;
  write_tour_film(film);
}

void run_render(const RenderArguments& arguments) {
  if (!arguments.tour.empty()) {
    render_tour(arguments);
    return;
  }
  const Viewpoint viewpoint = parse_viewpoint(arguments.view);
  Cut cut = parse_cut(arguments.cut);
  const std::optional<Background> background = parse_background(arguments.backdrop.background);
  DrawOptions options;
  options.clip = parse_clip_operator(arguments.clip);
  options.style.grey = arguments.grey;
  options.style.openings = parse_grey_openings(arguments.openings);
  options.reference = arguments.reference;
  std::vector<Vec3> pins;
  pins.reserve(arguments.pins.size());
  for (const std::string& text : arguments.pins) {
    pins.push_back(parse_vector(text, "--pin"));
  }
  check_picture_output(arguments.animation, arguments.output);
  require_writable(arguments.output);
  Case contents = load_case(arguments.scene, needs_section(arguments) ? BrokenSection::kRefused
                                                                      : BrokenSection::kLeftOut);
  if (arguments.changes_light()) {
    relight(contents, lights_of(arguments, contents));
  }
  prepare_openings(contents);
  if (contents.section) {
    options.style.window = parse_window(arguments.window, *contents.section);
  }
  options.faces = face_source(arguments, contents);
  if (options.clip == ClipOperator::kLayers && !contents.model && contents.scene.layers.empty()) {
    throw Error("{}: has no layers to clip by; clipgs bake makes them of a neural model",
                arguments.scene);
  }
  if (arguments.state) {
    cut = cut_of_state(*arguments.state, contents.scene, arguments.scene);
  }
  warn_if_plane_misses(cut, contents.scene.bounds);
  for (const Vec3& pin : pins) {
    fmt::print("{:.1f}, {:.1f}, {:.1f} mm: {}\n", pin.x, pin.y, pin.z,
               value_text(*contents.section, pin));
  }
  const auto draw = [&](const View& from, const Cut& kept) {
    const Camera camera = viewpoint.camera(contents.scene.sphere, from);
    options.cue =
        DepthCue::over(contents.scene.sphere, camera.position, arguments.backdrop.depth_cue);
    Image picture = draw_case(contents, camera, kept, options);
    if (arguments.annotate) {
      annotate(picture, *contents.section, camera, kept, options.style, pins);
    }
    return background ? composite(picture, *background) : picture;
  };
  if (arguments.animation.any()) {
    const auto extent = [&](const Vec3& n) { return project_box(contents.scene.bounds, n); };
    write_animation(arguments.output, "render", arguments.animation, viewpoint.view, cut, extent,
                    draw);
  } else {
    write_png(arguments.output, draw(viewpoint.view, cut));
  }
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("render", "Draw a case or scene as a picture, or an animation");
  const auto arguments = std::make_shared<RenderArguments>();
  command->add_option("scene", arguments->scene, "Case (.sog) or scene (.ply)")->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Picture to write (PNG; WebP if it moves; of a tour also MP4, WebM or a folder)")
      ->required();
  add_cut_options(*command, arguments->cut);
  command
      ->add_option("--state", arguments->state,
                   "Cut along the scene's axis: the plane of this one of its states, from 0 (200 "
                   "over what is visible, if it has none)")
      ->check(CLI::NonNegativeNumber)
      ->excludes("--plane")
      ->excludes("--slab");
  add_animation_options(*command, arguments->animation);
  add_view_options(*command, arguments->view);
  command
      ->add_option(
          "--clip", arguments->clip,
          "Clip operator: hard, soft, exact, or layers (cuts along the scene's axis, --state, by "
          "switching what clipgs bake made of states)")
      ->capture_default_str();
  command
      ->add_option("--section", arguments->section,
                   "What draws the faces of the cut: volume or splats (default: the case's section "
                   "volume, if it has one)")
      ->check(CLI::IsMember({"volume", "splats"}));
  command->add_option("--rig", arguments->rig,
                      "Lights: studio, theatre, rim, dome, ambient or a JSON file (default: those "
                      "that the case was made in)");
  command
      ->add_option("--turn-light", arguments->turn,
                   "Turn the lights about the patient's long axis, degrees, counterclockwise seen "
                   "from the head")
      ->check(CLI::Range(-360.0, 360.0));
  command->add_option("--lamp", arguments->lamp,
                      "A lamp instead, that shines from a direction: R,A,S");
  command
      ->add_option("--grey", arguments->grey,
                   "Faces as grey values, from 0 (cinematic) to 1 (as radiologists read them)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option(
      "--window", arguments->window,
      "Grey values from black to white: CENTER,WIDTH, or of a CT soft-tissue (the default), "
      "bone, lung or brain, of others but photographs auto (the default: the 1st to the 99th "
      "percentile of what is not air) or full");
  command
      ->add_option("--openings", arguments->openings,
                   "What grey shows in gaps that the window has black: cinematic or neutral walls, "
                   "or values")
      ->check(CLI::IsMember({"cinematic", "neutral", "values"}))
      ->capture_default_str();
  command->add_flag("--annotate", arguments->annotate,
                    "Write the patient's directions, a scale bar, the window and the pins' values "
                    "on the picture");
  command
      ->add_option("--pin", arguments->pins,
                   "Print the value at a point: R,A,S in mm; may be given again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_backdrop_options(*command, arguments->backdrop);
  CLI::Option* const tour =
      command
          ->add_option(
              "--tour", arguments->tour,
              "Fly from view to view of a tour that the viewer saved, NAME.tour.json: what "
              "is shown is said there; --size, --fps and --background are said here")
          ->check(CLI::ExistingFile);
  for (const char* const other :
       {"--view", "--look-at", "--camera", "--plane", "--slab", "--state", "--turntable", "--sweep",
        "--clip", "--section", "--rig", "--turn-light", "--lamp", "--grey", "--window",
        "--openings", "--pin", "--depth-cue"}) {
    tour->excludes(other);
  }
  command
      ->add_flag("--no-captions", arguments->no_captions, "Without what is said of a tour's views")
      ->needs(tour);
  command->add_flag("--reference", arguments->reference,
                    "Draw with the slow double-precision reference renderers (cinematic faces)");
  command->footer(
      "Example: clipgs render case.sog -o cut.png --view 30,20 --plane 0,0,-1,-40\n"
      "         clipgs render case.sog -o ct.png --view 0,80 --plane 0,0,-1,-40 --grey 1 --window "
      "bone --annotate\n"
      "         clipgs render mr.sog -o mr.png --grey 1 --window auto --plane 0,0,-1,-40\n"
      "         clipgs render case.sog -o state.png --view 30,20 --state 120 --clip layers\n"
      "         clipgs render case.sog -o spin.webp --turntable --plane 0,0,-1,-40\n"
      "         clipgs render case.sog -o tour.mp4 --tour case.tour.json --size 1280x720 --fps 30\n"
      "         clipgs render case.sog -o deep.png --background #202830,black --depth-cue 0.7");
  command->callback([arguments] { run_render(*arguments); });
}

}  // namespace clipgs
