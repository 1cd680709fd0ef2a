#pragma once

#include "self_collision/surfaces.h"

namespace selvage::surfaces {

/// A sheet of some hundred triangles bent by a few random waves, from hardly at all to violently: large enough that
/// pieces of it are worth culling, and smooth enough that some can be.
Surface waved_sheet(Random& random);

/// Counterexamples to conditions under which a surface was thought not to meet itself. In all of them normals lie
/// within a few degrees of z, and triangles that share no vertex pass through each other.

/// Two loose rectangles, crossed like a plus sign and tilted against each other.
Surface crossed_rectangles();

/// A disc sector from -45 to 405 degrees whose radius grows with the angle, lifted so that its two layers change places
/// in the overlap; turned about z.
Surface overwound_sector(double turn);

/// A comb of eight teeth whose contour, whatever quarter of it is taken, is several runs: those of every second tooth
/// lean over the next ones, `lean` spaces far, and are lifted so that the two pass through each other where they
/// overlap.
Surface comb(double lean);

/// A square and a smaller one, both cut along a slit in the middle and joined crosswise there: connected and manifold,
/// each vertex with one fan, with two contours that are simple, do not meet and are nested.
Surface crosswise_squares();

/// A closed box-like surface whose top has been pushed down through its bottom: no border at all.
Surface pushed_through(Random& random);

}  // namespace selvage::surfaces
