#pragma once

#include "picture/drawing/colour.h"
#include "selvage/core/types.h"

namespace selvage {

/// Colour of a body: those of Okabe and Ito (2008), which people with any kind of colour blindness tell apart, and the
/// same lighter and darker where there are more bodies. The same as in the page (viewer/src/fields.ts).
Rgb body_colour(Index body);

/// Colour of the inside of a body that is cut open.
Rgb cap_colour(Index body);

/// Light grey.
Rgb collider_colour();

}  // namespace selvage
