// The bundled models. Each function returns the whole text of a file; nothing depends on time or
// machine. Unit: metre. Axes of the fuselages: x aft, y to starboard, z up; of the hull: x forward,
// y to port, z up.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/bspline/surface.h"

namespace make_data {

// One skin with a seam along the belly, a pole at the nose, a row of windows on each side and a
// planar aft cap.
std::string fuselage_step();

// Twelve patches, four around and three along; tangents agree across every join exactly, curvatures
// do not. The knot spans of the nose are 3/4 as long as those of the cabin and the tail.
std::string fuselage12_step();

// Port and starboard skin, a transom at x = 0 and a deck that rises towards the bow.
std::string hull_step();

// Its starboard skin alone: open in the planes y = 0, x = 0 and z = 4.5 + x/32.
std::string half_hull_step();

// The unit cube: six bicubic patches of 15 x 15 poles at the Greville abscissae.
std::string cube_step();
std::string cube_json();

// The unit cube of seven bicubic patches in different bases. The top is two faces, "top left" and
// "top right", which the front and the back meet along one side each (T-junctions).
std::string patchwork_step();

// A block with a curved top, a canopy and a mast on it. The canopy meets the top in two trimming
// curves, parabolas in the parameter planes of both; the mast's foot is a side of the mast and a
// trim of the top.
std::string canopy_step();

// Rational bodies of revolution around the z axis, of whole patches: a wall (cubic along the axis,
// quadratic around it) between two disks; a torus, cubic both ways; a spindle with a blunt nose and
// a blunt tail, quadratic both ways. Their knot lines are smooth by their poles only.
std::string cylinder_json();
std::string torus_json();
std::string spindle_json();

}  // namespace make_data
