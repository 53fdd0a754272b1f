#include "measure/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/json_reader.h"
#include "measure/html.h"

namespace clipgs {

namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --ground: #f6f5f2; --card: #ffffff; --ink: #1d1f23;
  --quiet: #6a6e76; --line: #dddbd5; --exact: #1f6feb; --soft: #c2571a; --hard: #7a7f87;
  --layers: #8a3fb8; --volume: #12833f; }
@media (prefers-color-scheme: dark) { :root { --ground: #111316; --card: #1a1d21; --ink: #e8e9eb;
  --quiet: #9aa0a8; --line: #30343a; --exact: #6ea8ff; --soft: #f0934e; --hard: #a3a9b2;
  --layers: #c58aea; --volume: #4cc77a; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.55 system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .8rem; }
p { max-width: 72ch; margin: .4rem 0; }
.quiet { color: var(--quiet); }
.badge { display: inline-block; border: 1px solid var(--soft); color: var(--soft);
  border-radius: 99px; padding: .05rem .7rem; font-size: .85rem; margin-bottom: .9rem; }
.scroll { overflow-x: auto; background: var(--card); border: 1px solid var(--line);
  border-radius: 10px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .5rem .9rem; text-align: right; white-space: nowrap; }
th { font-weight: 600; font-size: .85rem; color: var(--quiet); border-bottom: 1px solid var(--line); }
tbody + tbody tr:first-child td { border-top: 1px solid var(--line); }
th:nth-child(-n+5), td:nth-child(-n+5) { text-align: left; }
td.best { font-weight: 700; }
.exact { color: var(--exact); } .soft { color: var(--soft); } .hard { color: var(--hard); }
.layers { color: var(--layers); } .volume { color: var(--volume); } .other { color: var(--quiet); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(320px, 1fr)); gap: 1rem; }
.plots > figure { background: var(--card); border: 1px solid var(--line); border-radius: 10px;
  padding: .8rem 1rem; }
svg { width: 100%; height: auto; display: block; font-size: 12px; }
svg text { fill: var(--quiet); } svg .grid { stroke: var(--line); }
svg .floor { stroke: var(--ink); stroke-dasharray: 5 4; }
svg polyline { fill: none; stroke: currentColor; stroke-width: 2; stroke-linejoin: round; }
svg circle { fill: currentColor; }
figure { margin: 0; }
.frame { margin: 0 0 1.6rem; }
.frame > figcaption { margin-bottom: .5rem; }
.row { display: grid; gap: .5rem; grid-template-columns: repeat(auto-fit, minmax(170px, 1fr)); }
.row img { width: 100%; height: auto; display: block; background: #000; border-radius: 8px; }
.zoom img { image-rendering: pixelated; }
.row figcaption { font-size: .85rem; padding: .3rem .1rem; }
.scale { display: inline-block; vertical-align: middle; width: 7rem; height: .7rem;
  border-radius: 4px; background: linear-gradient(90deg, #000, #f00, #ff0, #fff);
  border: 1px solid var(--line); }
dt { font-weight: 600; margin-top: .6rem; } dd { margin: 0; max-width: 72ch; }
)css";

constexpr const char* kDefinitions = R"html(
<h2>What the columns mean</h2>
<dl>
<dt>PSNR</dt><dd>Over RGB in [0, 1] on black, the whole picture; mean of the pictures' values. An
object that fills little of the frame makes it high.</dd>
<dt>masked</dt><dd>PSNR over the pixels where the truth's or the picture's alpha exceeds 0.01: the
figure to compare.</dd>
<dt>pooled</dt><dd>The same of all the pictures' pixels together: one bad picture weighs what it
shows. ± is half the 95&nbsp;% confidence interval of the mean (Student's t over the pictures).</dd>
<dt>face, opened, outside</dt><dd>Masked PSNR by what a pixel shows, pooled: matter that begins at
the plane or at an end of the volume; what lay hidden behind matter that the plane took away; the
rest. In brackets the shares of the masked pixels and of their squared error.</dd>
<dt>SSIM</dt><dd>Window of 11×11 pixels, σ 1.5, zero padded, mean of the channels.</dd>
<dt>band SSIM</dt><dd>Mean of the SSIM map where the truth's first hit lies within 2&nbsp;% of the
extent of the plane: at the cut.</dd>
<dt>ꟻLIP</dt><dd>The difference that someone sees who flips between truth and ours, 0 to 1, mean over
the masked pixels, at a headset's 25 pixels a degree unless <code>--pixels-per-degree</code> said
otherwise (Andersson et al. 2020).</dd>
<dt>leak</dt><dd>Colour energy that the picture puts where the cut left nothing, divided by the
energy of the truth, in units of 10⁻².</dd>
<dt>section</dt><dd>What draws the face of the cut: the case's own volume, lit like the rest, or the
splats. Pictures and plots show <i>volume</i> with the exact operator, and the operators by splats
alone.</dd>
<dt>noise floor</dt><dd>How well the path-traced truth knows itself, from two independent halves of
its samples. No PSNR above it can be trusted.</dd>
</dl>
)html";

/// Mean absolute error that the error map shows as white.
constexpr float kErrorScale = 0.25f;

std::string value_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "–";
}

const char* split_title(Split split) {
  switch (split) {
    case Split::kTestAxis:
      return "Planes along the axis";
    case Split::kTestOblique:
      return "Oblique planes";
    case Split::kTestUncut:
      return "Uncut";
    case Split::kTestClose:
      return "Close up";
    case Split::kTestCutAxis:
      return "Faces and edges of cuts across each axis";
    case Split::kTestCutOblique:
      return "Faces and edges of oblique cuts";
    case Split::kValidationAxis:
      return "Planes along the axis, validation";
    case Split::kValidationOblique:
      return "Oblique planes, validation";
    case Split::kValidationUncut:
      return "Uncut, validation";
    case Split::kValidationClose:
      return "Close up, validation";
    case Split::kTrain:
      break;
  }
  return "Training";
}

/// How the columns of the table are written; `best` is +1 where more is better, −1 where less is.
struct Column {
  const char* title;
  int decimals;
  int best;
  std::optional<double> (*value)(const Scores&);
};

const std::array<Column, 10> kColumns = {{
    {"PSNR, dB", 2, 1, [](const Scores& s) { return std::optional(s.psnr); }},
    {"masked, dB", 2, 1, [](const Scores& s) { return s.psnr_masked; }},
    {"pooled", 2, 1, [](const Scores& s) { return s.masked.psnr(); }},
    {"face", 2, 1, [](const Scores& s) { return s.share(PixelClass::kFace).psnr; }},
    {"opened", 2, 1, [](const Scores& s) { return s.share(PixelClass::kOpened).psnr; }},
    {"outside", 2, 1, [](const Scores& s) { return s.share(PixelClass::kOutside).psnr; }},
    {"SSIM", 4, 1, [](const Scores& s) { return std::optional(s.ssim); }},
    {"band SSIM", 4, 1, [](const Scores& s) { return s.band_ssim; }},
    {"ꟻLIP", 4, -1, [](const Scores& s) { return s.flip; }},
    {"leak, 10⁻²", 3, -1, [](const Scores& s) { return s.leak_percent(); }},
}};

/// What stands smaller behind a value: how sure it is, or what share it is of.
std::string column_note(const EvaluationRow& row, const Column& column) {
  const std::string title = column.title;
  if (title == "masked, dB" && row.confidence) {
    return fmt::format(" <span class=\"quiet\">± {:.2f}</span>", *row.confidence);
  }
  for (const PixelClass which : kPixelClasses) {
    const ClassShare share = row.mean.share(which);
    if (title == pixel_class_name(which) && share.psnr) {
      return fmt::format(" <span class=\"quiet\">({:.0f} %, {:.0f} %)</span>", 100 * *share.pixels,
                         100 * *share.error);
    }
  }
  return {};
}

/// The best value of a column among the rows of one split that are held against the same.
std::optional<double> best_value(const Evaluation& evaluation, const EvaluationRow& among,
                                 const Column& column) {
  std::optional<double> best;
  for (const EvaluationRow& row : evaluation.rows) {
    const std::optional<double> value = column.value(row.mean);
    if (row.split == among.split && row.drawing.against_model == among.drawing.against_model &&
        value && (!best || (*value - *best) * static_cast<double>(column.best) > 0)) {
      best = value;
    }
  }
  return best;
}

std::string table_html(const Evaluation& evaluation) {
  std::string html =
      "<div "
      "class=\"scroll\"><table><thead><tr><th>scene</th><th>split</th><th>clip</th><th>section</th>"
      "<th>against</th>";
  for (const Column& column : kColumns) {
    html += fmt::format("<th>{}</th>", column.title);
  }
  html += "<th>noise floor, dB</th><th>masked</th><th>pictures</th></tr></thead>\n";
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    html += "<tbody>\n";
    for (const EvaluationRow& row : evaluation.rows) {
      if (row.split != noise.split) {
        continue;
      }
      const char* clip = clip_text(evaluation, row.drawing);
      const char* faces = face_source_name(row.drawing.faces);
      html += fmt::format(
          R"(<tr><td>{}</td><td>{}</td><td class="{}">{}</td><td class="{}">{}</td><td>{}</td>)",
          escape_html(evaluation.subjects[row.drawing.subject]), split_name(noise.split), clip,
          clip, faces, faces, escape_html(against_text(evaluation, row.drawing)));
      for (const Column& column : kColumns) {
        const std::optional<double> value = column.value(row.mean);
        const bool best = value && value == best_value(evaluation, row, column);
        html += fmt::format("<td{}>{}{}</td>", best ? " class=\"best\"" : "",
                            value_text(value, column.decimals), column_note(row, column));
      }
      html += fmt::format("<td>{:.1f}</td><td>{:.1f}</td><td>{}</td></tr>\n", noise.db,
                          noise.masked_db, row.images);
    }
    html += "</tbody>\n";
  }
  return html + "</table></div>\n";
}

/// What each step on the way to a case leaves of the raw states.
std::string sizes_html(const Evaluation& evaluation) {
  if (evaluation.sizes.empty()) {
    return {};
  }
  std::string html =
      "<h2>Size</h2>\n<div class=\"scroll\"><table><thead><tr><th>stage</th><th>MB</th>"
      "</tr></thead><tbody>\n";
  for (const SizeStage& stage : evaluation.sizes) {
    html += fmt::format("<tr><td>{}</td><td>{:.2f}</td></tr>\n", escape_html(stage.name),
                        static_cast<double>(stage.bytes) / 1e6);
  }
  return html + "</tbody></table></div>\n";
}

/// The drawing whose pictures choose the frames shown and are held against the truth first.
Drawing leading_drawing(const Evaluation& evaluation) {
  const auto rank = [](const EvaluationRow& row) {
    if (row.drawing.subject != 0 || row.drawing.against_model) {
      return -1;
    }
    return (row.drawing.faces == FaceSource::kVolume ? 2 : 0) +
           (row.drawing.clip == ClipOperator::kExact ? 1 : 0);
  };
  return std::ranges::max_element(evaluation.rows, {}, rank)->drawing;
}

/// Whether pictures and plots show a drawing: the leading one, the first subject's splats under
/// every operator (under faces of the volume the operators differ little), the others' under
/// `exact` or their own.
bool is_shown(const Drawing& drawing, const Drawing& leading) {
  return drawing == leading || (!drawing.against_model && drawing.faces == FaceSource::kSplats &&
                                (drawing.subject == 0 || drawing.clip == ClipOperator::kExact));
}

/// The drawings that pictures and plots of a split show, the leading one first.
std::vector<Drawing> shown_drawings(const Evaluation& evaluation, Split split) {
  const Drawing leading = leading_drawing(evaluation);
  std::vector<Drawing> shown;
  for (const EvaluationRow& row : evaluation.rows) {
    if (row.split == split && is_shown(row.drawing, leading)) {
      shown.push_back(row.drawing);
    }
  }
  std::ranges::stable_sort(shown, [&](const Drawing& a, const Drawing& b) {
    const auto rank = [&](const Drawing& d) {
      return std::pair(d == leading ? -1 : static_cast<int>(d.subject), -static_cast<int>(d.clip));
    };
    return rank(a) < rank(b);
  });
  return shown;
}

/// Name of a drawing among those shown …
std::string drawing_name(const Evaluation& evaluation, const Drawing& drawing) {
  if (drawing.subject != 0) {
    return evaluation.subjects[drawing.subject];
  }
  return drawing.faces == FaceSource::kVolume ? "volume" : clip_text(evaluation, drawing);
}

/// … and its class of style.
const char* drawing_class(const Drawing& drawing) {
  if (drawing.subject != 0) {
    return "other";
  }
  return drawing.faces == FaceSource::kVolume ? "volume" : clip_operator_name(drawing.clip);
}

/// Masked PSNRs of one split and drawing, lowest first.
std::vector<double> sorted_psnr(const Dataset& dataset, const Evaluation& evaluation, Split split,
                                const Drawing& drawing) {
  std::vector<double> values;
  for (const FrameScores& frame : evaluation.frames) {
    if (frame.drawing == drawing && dataset.frames[frame.frame].split == split &&
        frame.scores.psnr_masked) {
      values.push_back(*frame.scores.psnr_masked);
    }
  }
  std::ranges::sort(values);
  return values;
}

/// Maps ranks and decibels to the plot's coordinates.
struct PlotFrame {
  static constexpr double kLeft = 36, kRight = 500, kTop = 18, kBottom = 200;
  double low = 0, high = 1;

  static double x(size_t rank, size_t count) {
    return kLeft +
           (kRight - kLeft) *
               (count > 1 ? static_cast<double>(rank) / static_cast<double>(count - 1) : 0.5);
  }
  double y(double db) const { return kBottom - (kBottom - kTop) * (db - low) / (high - low); }
};

std::string curve_svg(const PlotFrame& plot, const std::vector<double>& values, const char* name) {
  std::string points;
  std::string dots;
  for (size_t i = 0; i < values.size(); ++i) {
    const double x = PlotFrame::x(i, values.size());
    const double y = plot.y(values[i]);
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    dots += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.5"/>)", x, y);
  }
  return fmt::format(R"(<g class="{}"><polyline points="{}"/>{}</g>)", name, points, dots);
}

std::string plot_html(const Dataset& dataset, const Evaluation& evaluation, Split split,
                      double noise) {
  PlotFrame plot{std::numeric_limits<double>::max(), noise};
  std::string curves;
  std::string legend;
  std::vector<std::pair<Drawing, std::vector<double>>> series;
  for (const Drawing& drawing : shown_drawings(evaluation, split)) {
    series.emplace_back(drawing, sorted_psnr(dataset, evaluation, split, drawing));
    for (const double value : series.back().second) {
      plot.low = std::min(plot.low, value);
      plot.high = std::max(plot.high, value);
    }
  }
  const double step = plot.high - plot.low > 40 ? 20 : 5;
  plot.low = std::floor(std::min(plot.low, plot.high - step) / step) * step;
  plot.high = std::ceil(plot.high / step) * step;
  for (const auto& [drawing, values] : series) {
    curves += curve_svg(plot, values, drawing_class(drawing));
    legend += fmt::format(R"( <span class="{}">● {}</span>)", drawing_class(drawing),
                          escape_html(drawing_name(evaluation, drawing)));
  }
  std::string grid;
  const int lines = static_cast<int>(std::lround((plot.high - plot.low) / step));
  for (int i = 0; i <= lines; ++i) {
    const double db = plot.low + i * step;
    grid += fmt::format(R"(<line class="grid" x1="{0}" x2="{1}" y1="{2:.1f}" y2="{2:.1f}"/>)"
                        R"(<text x="{3}" y="{4:.1f}" text-anchor="end">{5:.0f}</text>)"
                        "\n",
                        PlotFrame::kLeft, PlotFrame::kRight, plot.y(db), PlotFrame::kLeft - 6,
                        plot.y(db) + 4, db);
  }
  grid += fmt::format(R"(<line class="floor" x1="{0}" x2="{1}" y1="{2:.1f}" y2="{2:.1f}"/>)"
                      R"(<text x="{3}" y="{4:.1f}">noise floor</text>)"
                      "\n",
                      PlotFrame::kLeft, PlotFrame::kRight, plot.y(noise), PlotFrame::kLeft + 6,
                      plot.y(noise) - 5);
  return fmt::format(
      "<figure><figcaption><b>{}</b> · masked PSNR of every picture, dB, worst to best ·{}"
      "</figcaption>\n<svg viewBox=\"0 0 510 215\" role=\"img\" aria-label=\"Sorted masked PSNR\">"
      "{}{}</svg></figure>\n",
      split_title(split), legend, grid, curves);
}

Image error_map(const Image& truth, const Image& picture) {
  const Image a = composite(truth, 0, 0, 0);
  const Image b = composite(picture, 0, 0, 0);
  Image grey(a.width, a.height, 1);
  for (size_t i = 0; i < a.pixels(); ++i) {
    float sum = 0;
    for (size_t c = 0; c < 3; ++c) {
      sum += std::abs(a.data[i * 3 + c] - b.data[i * 3 + c]);
    }
    grey.data[i] = sum / 3.0f / kErrorScale;
  }
  return heat_map(grey);
}

std::string picture_html(const Image& rgb, const std::string& name, const std::string& detail) {
  return fmt::format(
      "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\"><figcaption>{} "
      "<span class=\"quiet\">{}</span></figcaption></figure>\n",
      data_uri(rgb), rgb.width, rgb.height, name, name, detail);
}

std::string plane_text(const std::optional<Plane>& plane) {
  if (!plane) {
    return "uncut";
  }
  const auto tidy = [](float v) { return plain_zero(std::round(v * 100) / 100); };
  const Vec3& n = plane->normal;
  return fmt::format("plane {:.2f}, {:.2f}, {:.2f} at {:.1f} mm", tidy(n.x), tidy(n.y), tidy(n.z),
                     tidy(plane->offset));
}

/// A square part of a picture.
Image cut_out(const Image& picture, int left, int top, int side) {
  Image part(side, side, picture.channels);
  for (int y = 0; y < side; ++y) {
    std::copy_n(picture.at(left, top + y), static_cast<size_t>(side) * picture.channels,
                part.at(0, y));
  }
  return part;
}

/// Where the middle of the drawn face is; nothing if hardly any is seen.
std::optional<Vec2> middle_of_face(const Case& contents, const Frame& frame) {
  if (!contents.section) {
    return std::nullopt;
  }
  constexpr double kLeast = 64;  // px
  const Image faces = draw_faces(*contents.section, frame.camera, frame.plane);
  double count = 0;
  Vec2 sum(0);
  for (int y = 0; y < faces.height; ++y) {
    for (int x = 0; x < faces.width; ++x) {
      if (faces.at(x, y)[3] > 0.5f) {
        sum += Vec2(x, y);
        ++count;
      }
    }
  }
  return count < kLeast ? std::nullopt : std::optional(sum / static_cast<float>(count));
}

/// The face, enlarged: truth, drawn from the volume, and drawn by splats.
std::string zoom_html(const Case& contents, const Frame& frame, const Image& truth,
                      ClipOperator clip) {
  const std::optional<Vec2> middle = middle_of_face(contents, frame);
  if (!middle) {
    return {};
  }
  const int side = std::min(truth.width, truth.height) * 3 / 8;
  const auto corner = [side](float at, int size) {
    return std::clamp(static_cast<int>(at) - side / 2, 0, size - side);
  };
  const int left = corner(middle->x, truth.width);
  const int top = corner(middle->y, truth.height);
  std::string html = "<div class=\"row zoom\">\n";
  const auto add = [&](const Image& picture, const char* name, const char* detail) {
    html += picture_html(cut_out(composite(picture, 0, 0, 0), left, top, side), name, detail);
  };
  add(truth, "truth", "the face, enlarged");
  add(draw_frame(contents, frame, {.clip = clip, .faces = FaceSource::kVolume}), "section",
      "from the volume");
  add(draw_frame(contents, frame, {.clip = clip, .faces = FaceSource::kSplats}), "splats",
      "as they fill the face");
  return html + "</div>\n";
}

/// Truth, ours in every way that is shown and the error of one test picture.
std::string frame_html(std::span<const Subject> subjects, const Dataset& dataset,
                       const Evaluation& evaluation, size_t index, const char* rank) {
  const Frame& frame = dataset.frames[index];
  const Image truth = load_truth(dataset, frame);
  const Drawing leading = leading_drawing(evaluation);
  std::string html = fmt::format(
      "<figure class=\"frame\"><figcaption><b>{}</b> <span class=\"quiet\">{} · {} · noise floor "
      "{:.1f} dB</span></figcaption><div class=\"row\">\n",
      rank, escape_html(frame.file), plane_text(frame.plane), frame.noise_db);
  html += picture_html(composite(truth, 0, 0, 0), "truth", "path traced");
  Image error;
  for (const Drawing& drawing : shown_drawings(evaluation, frame.split)) {
    const Image picture = draw_frame(*subjects[drawing.subject].contents, frame, drawing);
    if (drawing == leading) {
      error = error_map(truth, picture);
    }
    const auto score = std::ranges::find_if(evaluation.frames, [&](const FrameScores& one) {
      return one.frame == index && one.drawing == drawing;
    });
    html += picture_html(composite(picture, 0, 0, 0), drawing_name(evaluation, drawing),
                         value_text(score->scores.psnr_masked, 2) + " dB");
  }
  html += picture_html(error, "error", fmt::format("of {}", drawing_name(evaluation, leading)));
  html += "</div>\n";
  if (leading.faces == FaceSource::kVolume) {
    html += zoom_html(*subjects[0].contents, frame, truth, leading.clip);
  }
  return html + "</figure>\n";
}

/// The three worst, the median and the best picture of a split, each once.
std::vector<std::pair<const char*, size_t>> chosen_frames(const Dataset& dataset,
                                                          const Evaluation& evaluation,
                                                          Split split) {
  std::vector<std::pair<double, size_t>> ranked;
  for (const FrameScores& frame : evaluation.frames) {
    if (frame.drawing == leading_drawing(evaluation) &&
        dataset.frames[frame.frame].split == split && frame.scores.psnr_masked) {
      ranked.emplace_back(*frame.scores.psnr_masked, frame.frame);
    }
  }
  std::ranges::sort(ranked);
  constexpr std::array kRanks{"Worst", "Second worst", "Third worst"};
  std::vector<std::pair<const char*, size_t>> chosen;
  for (size_t i = 0; i < std::min(kRanks.size(), ranked.size()); ++i) {
    chosen.emplace_back(kRanks[i], ranked[i].second);
  }
  if (ranked.size() / 2 >= kRanks.size()) {
    chosen.emplace_back("Median", ranked[ranked.size() / 2].second);
  }
  if (ranked.size() > kRanks.size()) {
    chosen.emplace_back("Best", ranked.back().second);
  }
  return chosen;
}

}  // namespace

std::string evaluation_report(std::span<const Subject> subjects, const Dataset& dataset,
                              const Evaluation& evaluation) {
  const Scene& scene = subjects[0].contents->scene;
  const std::string title = scene.title.empty() ? "Untitled scene" : scene.title;
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>{0} · clipgs evaluation</title><style>{1}</style></head>\n<body><main>\n"
      "<span class=\"badge\">Not for diagnosis</span>\n<h1>{0}</h1>\n"
      "<p class=\"quiet\">{2} Gaussians · {3:.2f} MB · preset {4} · held-out views and planes, "
      "against path-traced truth</p>\n<h2>Figures</h2>\n",
      escape_html(title), kStyle, evaluation.splats, static_cast<double>(evaluation.bytes) / 1e6,
      escape_html(dataset.preset));
  html += table_html(evaluation);
  html += sizes_html(evaluation);
  html +=
      "<p class=\"quiet\">Bold: the best of its split.</p>\n<h2>Every picture</h2>\n"
      "<div class=\"plots\">\n";
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    html += plot_html(dataset, evaluation, noise.split, noise.db);
  }
  html += "</div>\n";
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    html += fmt::format("<h2>{}: truth and ours</h2>\n", split_title(noise.split));
    for (const auto& [rank, frame] : chosen_frames(dataset, evaluation, noise.split)) {
      html += frame_html(subjects, dataset, evaluation, frame, rank);
    }
  }
  html += fmt::format(
      "<p class=\"quiet\">Error: mean over RGB, from 0 <span class=\"scale\"></span> to {:.2f} "
      "and more. Pictures are ranked by the masked PSNR of {}.</p>\n",
      kErrorScale, drawing_name(evaluation, leading_drawing(evaluation)));
  return html + kDefinitions + "</main></body></html>\n";
}

}  // namespace clipgs
