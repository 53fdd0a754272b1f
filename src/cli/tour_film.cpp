#include "cli/tour_film.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>

#include "tour/flight.h"
#include "tour/link.h"
#include "tour/tour_file.h"

#include "asset/draw_case.h"
#include "cli/arguments.h"
#include "cli/caption.h"
#include "cli/film.h"
#include "core/error.h"
#include "core/progress.h"
#include "section/annotate.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

/// A stop with all that is read of it.
struct ReadStop {
  Stop stop;
  Link link;
  fs::path file;  ///< of its case
};

/// A case, and the light that it is in.
class LitCase {
 public:
  explicit LitCase(const fs::path& file) : case_(load_case(file, BrokenSection::kLeftOut)) {
    if (case_.section) {
      own_ = case_.section->rig;
    }
    prepare_openings(case_);
  }

  const Case& contents() const { return case_; }

  /// Lit as a view has it; a case that keeps its light is left in it.
  const Case& lit_for(const Shown& shown) {
    const bool is_same = shown.rig == rig_ && shown.turn == turn_ && shown.lamp == lamp_;
    if (case_.section && !is_same && !keeps_light_) {
      rig_ = shown.rig;
      turn_ = shown.turn;
      lamp_ = shown.lamp;
      light();
    }
    return case_;
  }

 private:
  void light() {
    const LightRig rig = turned(rig_ ? load_rig(*rig_) : own_, static_cast<float>(turn_));
    try {
      relight(case_, lamp_ ? lamp_instead(rig, Vec3(*lamp_)) : rig);
    } catch (const Error& error) {
      keeps_light_ = true;
      warn(error.what());
    }
  }

  Case case_;
  LightRig own_;
  std::optional<std::string> rig_;
  double turn_ = 0;
  std::optional<glm::dvec3> lamp_;
  bool keeps_light_ = false;
};

/// The file of the case that a stop names: it lies beside the one that is given. Throws Error.
fs::path case_file(const TourFilmArguments& arguments, const Link& link, size_t number,
                   const std::string& volume) {
  const std::string name = link.case_name();
  if (name.empty() || name == arguments.scene.stem().string()) {
    return arguments.scene;
  }
  const fs::path file = arguments.scene.parent_path() / (name + ".sog");
  const std::string tour = arguments.tour.filename().string();
  if (name.find('/') != std::string::npos || !fs::is_regular_file(file)) {
    throw Error("{}: view {} shows case \"{}\", which is not there; put {}.sog beside {}", tour,
                number, name, name, arguments.scene.filename().string());
  }
  const std::string other = read_case_info(file).scene.look.volume;
  if (!volume.empty() && !other.empty() && other != volume) {
    throw Error("{}: view {} shows case \"{}\", which is of another volume", tour, number, name);
  }
  return file;
}

std::vector<ReadStop> read_stops(const TourFilmArguments& arguments) {
  Tour tour = read_tour(arguments.tour);
  const std::string volume = arguments.scene.extension() == ".sog"
                                 ? read_case_info(arguments.scene).scene.look.volume
                                 : "";
  if (!tour.volume.empty() && !volume.empty() && tour.volume != volume) {
    throw Error("{}: a tour of another volume than {}; give the case that it was saved of",
                arguments.tour.filename().string(), arguments.scene.filename().string());
  }
  std::vector<ReadStop> stops;
  for (Stop& stop : tour.stops) {
    Link link(stop.show);
    fs::path file = case_file(arguments, link, stops.size() + 1, volume);
    stops.push_back({std::move(stop), std::move(link), std::move(file)});
  }
  return stops;
}

/// What is drawn of a case: a picture is drawn anew only where it is another.
class Draughtsman {
 public:
  explicit Draughtsman(const TourFilmArguments& arguments) : arguments_(arguments) {}

  /// One at a time: they may be large.
  LitCase& open(const fs::path& file) {
    if (!case_ || file != file_) {
      case_.reset();
      case_ = std::make_unique<LitCase>(file);
      file_ = file;
    }
    return *case_;
  }

  Image draw(LitCase& lit, const Shown& shown, const std::vector<Vec3>& pins) const {
    const Case& contents = lit.lit_for(shown);
    const Camera camera =
        camera_of(shown.view, contents.scene.sphere, arguments_.width, arguments_.height);
    const Cut cut = cut_of(shown);
    DrawOptions options;
    options.clip = parse_clip_operator(shown.clip);
    if (!can_draw(contents, cut, options.clip)) {
      options.clip = ClipOperator::kExact;  // as the viewer does
    }
    const bool by_volume = shown.section == "volume" && shown.faces && contents.section;
    options.faces = by_volume ? FaceSource::kVolume : FaceSource::kSplats;
    options.body = shown.body;
    options.style.grey = static_cast<float>(shown.grey);
    options.style.openings = parse_grey_openings(shown.openings);
    options.cue =
        DepthCue::over(contents.scene.sphere, camera.position, static_cast<float>(shown.depth_cue));
    if (contents.section) {
      options.style.window = {static_cast<float>(shown.window->center),
                              static_cast<float>(shown.window->width)};
    }
    Image picture = draw_case(contents, camera, cut, options);
    const bool is_grey = by_volume && shown.grey > 0 && !cut.empty();
    if (is_grey || (contents.section && !pins.empty())) {
      annotate(picture, *contents.section, camera, cut, options.style, pins);
    }
    const std::optional<Background> background =
        shown.background ? find_background(*shown.background) : arguments_.background;
    return background ? composite(picture, *background) : picture;
  }

 private:
  const TourFilmArguments& arguments_;
  fs::path file_;
  std::unique_ptr<LitCase> case_;
};

/// The window that a case begins with.
ShownWindow usual_window(const Case& contents) {
  const Window window = contents.section ? parse_window("", *contents.section) : Window();
  return {window.center, window.width};
}

Shown shown_of(const ReadStop& stop, const Shown& before, const Scene& scene) {
  const PlaneStates states =
      scene.states.count > 0 ? scene.states : PlaneStates::over(scene.extent);
  return stop.link.shown(before, states, scene.axis);
}

}  // namespace

void write_tour_film(const TourFilmArguments& arguments) {
  const std::vector<ReadStop> stops = read_stops(arguments);
  const std::unique_ptr<Film> film = make_film(arguments.output, arguments.fps);
  Draughtsman draughtsman(arguments);
  const auto frames_of = [&](double seconds) {
    return static_cast<int>(std::lround(seconds * static_cast<double>(arguments.fps)));
  };
  const auto is_first = [&](const ReadStop& one) { return &one == stops.data(); };
  size_t total = 0;
  for (const ReadStop& one : stops) {
    total += static_cast<size_t>(is_first(one) ? 0 : frames_of(one.stop.fly)) + 1;
  }
  Progress progress("tour", total);
  size_t drawn = 0;
  Shown before;
  std::vector<Vec3> pins_before;
  Sphere sphere;  // that `before` is a view of
  for (const ReadStop& one : stops) {
    LitCase& lit = draughtsman.open(one.file);
    const Scene& scene = lit.contents().scene;
    const auto show = [&](const Shown& shown, const std::vector<Vec3>& pins, int times) {
      Image picture = draughtsman.draw(lit, shown, pins);
      if (arguments.captions) {
        draw_caption(picture, one.stop.name, one.stop.text);
      }
      film->add(picture, times);
      progress.update(++drawn);
    };
    if (!before.window) {
      before.window = usual_window(lit.contents());
    }
    if (!is_first(one)) {
      before.view = reframed(before.view, sphere, scene.sphere);
    }
    const Shown there = shown_of(one, before, scene);
    const std::vector<Vec3> pins = there.marks ? one.link.pins() : std::vector<Vec3>();
    const int flown = is_first(one) ? 0 : frames_of(one.stop.fly);
    for (int i = 0; i < flown; ++i) {
      const double share = static_cast<double>(i) / flown;
      show(flight(before, there, share, scene.sphere), share < 0.5 ? pins_before : pins, 1);
    }
    show(there, pins, std::max(1, frames_of(one.stop.stay)));
    before = there;
    pins_before = pins;
    sphere = scene.sphere;
  }
  film->finish();
}

}  // namespace clipgs
