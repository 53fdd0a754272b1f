#pragma once

#include "cinema/dataset.h"
#include "section/section.h"

namespace clipgs {

/// How well a section's faces matched the pictures they were fitted to, before and after: PSNR over
/// the pixels where a face is opaque, as much as they count, dB, of errors in linear light times
/// the slope of the display's sRGB curve.
struct ReflectanceFit {
  double psnr_before = 0;
  double psnr_after = 0;
  size_t pixels = 0;  ///< that they count as
};

/// Fits the section's reflectances, at the face and beneath it, to the training pictures of
/// `dataset`: in linear light a pixel is linear in them, so that the least squares have a closed
/// form. What they learn beyond the preset's albedo is how much light tissue scatters back that
/// entered it elsewhere. Errors count as they show in display sRGB, large ones by Cauchy's weights
/// less: of what no table can explain. Tables stay as they are where no face is seen. Throws Error.
ReflectanceFit fit_reflectance(Section& section, const Dataset& dataset);

}  // namespace clipgs
