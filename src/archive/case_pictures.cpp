#include "archive/case_pictures.h"

#include "asset/draw_case.h"
#include "core/camera.h"
#include "core/draw_text.h"

namespace clipgs {

std::vector<Image> turntable(Case contents, int pictures, int side) {
  constexpr double kTextSize = 12;
  constexpr double kGrey = 0.7;
  prepare_openings(contents);
  std::vector<Image> result;
  for (int i = 0; i < pictures; ++i) {
    const View view{360 * static_cast<float>(i) / static_cast<float>(pictures)};
    const Camera camera = frame_sphere(contents.scene.sphere, view, side, side);
    Image picture = composite(draw_case(contents, camera, Cut()), 0, 0, 0);
    write_over(picture, [&](cairo_t* cairo) {
      cairo_set_source_rgb(cairo, kGrey, kGrey, kGrey);
      const double room = side;
      draw_text(cairo, "clipgs: not for diagnosis", room / 2, room - kTextSize / 2, kTextSize,
                Align::kMiddle, room);
    });
    result.push_back(std::move(picture));
  }
  return result;
}

}  // namespace clipgs
