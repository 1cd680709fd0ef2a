#pragma once

#include "picture/drawing/colour.h"
#include "selvage/core/types.h"

namespace selvage {

/// Colour of a body: those of Okabe and Ito (2008), which people with any kind of colour blindness tell apart, and the
/// same lighter and darker where there are more bodies. The same as in the page (viewer/src/fields.ts).
Rgb body_colour(Index body);

/// Colour of the inside of a body that is cut open.
Rgb cap_colour(Index body);

/// Colour of a value from 0 to 1, from dark to light, so that order is seen without hue. The same as in the page.
Rgb value_colour(float value);

/// Colour of a kind of contact by its number: free, inside, then as MarkKind. The same as in the page.
Rgb contact_colour(Index kind);

/// Light grey.
Rgb collider_colour();

}  // namespace selvage
