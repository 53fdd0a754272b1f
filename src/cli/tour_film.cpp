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
#include "cli/draw_marks.h"
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

  Image draw(LitCase& lit, const Shown& shown, std::vector<SaidMark>& marks) const {
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
    if (by_volume && shown.grey > 0 && !cut.empty()) {
      annotate(picture, *contents.section, camera, cut, options.style, {});
    }
    const std::optional<Background> background =
        shown.background ? find_background(*shown.background) : arguments_.background;
    if (background) {
      picture = composite(picture, *background);
    }
    if (!marks.empty()) {
      const Section* const section = contents.section ? &*contents.section : nullptr;
      draw_marks(picture, marks, camera, cut, section, shown.body);
    }
    return picture;
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

/// Between two pictures of one form: as much of `b` as that says. Straight alpha.
Image mixed(const Image& a, const Image& b, float share) {
  Image result = a;
  for (size_t i = 0; i < a.data.size(); i += static_cast<size_t>(a.channels)) {
    const bool has_alpha = a.channels == 4;
    const float of_a = (1 - share) * (has_alpha ? a.data[i + 3] : 1);
    const float of_b = share * (has_alpha ? b.data[i + 3] : 1);
    const float alpha = of_a + of_b;
    for (size_t c = 0; alpha > 0 && c < 3; ++c) {
      result.data[i + c] = (of_a * a.data[i + c] + of_b * b.data[i + c]) / alpha;
    }
    if (has_alpha) {
      result.data[i + 3] = alpha;
    }
  }
  return result;
}

/// A tour, from stop to stop.
class TourFilm {
 public:
  TourFilm(const TourFilmArguments& arguments, const std::vector<ReadStop>& stops)
      : arguments_(arguments),
        draughtsman_(arguments),
        film_(make_film(arguments.output, arguments.fps)),
        progress_("tour", frames_of(stops)) {}

  /// Flies there, but to the first one, and stays.
  void show(const ReadStop& one) {
    const bool is_other = file_ && *file_ != one.file;
    LitCase& lit = draughtsman_.open(one.file);
    const Scene& scene = lit.contents().scene;
    if (!shown_.window) {
      shown_.window = usual_window(lit.contents());
    }
    if (file_) {
      shown_.view = reframed(shown_.view, sphere_, scene.sphere);
    }
    const Shown there = shown_of(one, shown_, scene);
    const auto& section = lit.contents().section;
    std::vector<SaidMark> marks = said_marks(there.marks ? one.link.marks() : std::vector<Mark>(),
                                             section ? &*section : nullptr);
    const int flown = file_ ? frames_of(one.stop.fly) : 0;
    Image still;  // of the look that comes, where the one that goes is
    for (int i = 0; i < flown; ++i) {
      const double share = static_cast<double>(i) / flown;
      const Crossing way = is_other ? crossing(share) : Crossing{0, share};
      if (way.before > 0) {
        still = still.data.empty() ? draughtsman_.draw(lit, shown_, marks_) : std::move(still);
        add(one, mixed(still, picture_, static_cast<float>(way.before)), 1);
      } else {
        const Shown now = flight(shown_, there, way.flown, scene.sphere);
        add(one, draughtsman_.draw(lit, now, way.flown < 0.5 ? marks_ : marks), 1);
      }
    }
    picture_ = draughtsman_.draw(lit, there, marks);
    add(one, picture_, std::max(1, frames_of(one.stop.stay)));
    shown_ = there;
    marks_ = std::move(marks);
    sphere_ = scene.sphere;
    file_ = one.file;
  }

  void finish() { film_->finish(); }

 private:
  int frames_of(double seconds) const {
    return static_cast<int>(std::lround(seconds * static_cast<double>(arguments_.fps)));
  }

  /// That are drawn: of a stay, one.
  size_t frames_of(const std::vector<ReadStop>& stops) const {
    size_t total = stops.size();
    for (size_t i = 1; i < stops.size(); ++i) {
      total += static_cast<size_t>(frames_of(stops[i].stop.fly));
    }
    return total;
  }

  void add(const ReadStop& one, Image picture, int times) {
    if (arguments_.captions) {
      draw_caption(picture, one.stop.name, one.stop.text);
    }
    film_->add(picture, times);
    progress_.update(++drawn_);
  }

  const TourFilmArguments& arguments_;
  Draughtsman draughtsman_;
  std::unique_ptr<Film> film_;
  Progress progress_;
  size_t drawn_ = 0;
  // Of the stop before.
  Shown shown_;
  std::vector<SaidMark> marks_;
  Image picture_;
  Sphere sphere_;                 ///< that `shown_` is a view of
  std::optional<fs::path> file_;  ///< none: there was no stop yet
};

}  // namespace

void write_tour_film(const TourFilmArguments& arguments) {
  const std::vector<ReadStop> stops = read_stops(arguments);
  TourFilm film(arguments, stops);
  for (const ReadStop& stop : stops) {
    film.show(stop);
  }
  film.finish();
}

}  // namespace clipgs
