// Small solids made with OpenCASCADE for the tests of this folder.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Solid.hxx>
#include <gp_Trsf.hxx>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/step/document.h"

namespace isochor::shapes {

// A cube [0,size]^3 of six bicubic faces of n x n poles, each bulged inside its boundary. All edges
// are shared; numbers are not round.
TopoDS_Solid bicubic_cube(double size = 1.0, int n = 6);

// A barrel around z: one bicubic face, periodic (or clamped and closed) around, planar caps.
TopoDS_Solid barrel(bool periodic);

// A dome: one bicubic face closed around and collapsed at the top, one planar cap.
TopoDS_Solid dome();

// bicubic_cube with a round hole through its top and bottom faces.
TopoDS_Shape holed_cube();

// A plate 4 x 6 x 2 about the origin with a round hole of radius 0.7 at (0.3, 0.4).
TopoDS_Shape holed_plate();

// A compound of the shapes.
TopoDS_Shape together(const std::vector<TopoDS_Shape>& parts);

TopoDS_Solid cylinder(double radius = 0.5, double height = 2.0);

// A lens around z between two planar caps: its side is a torus whose tube is wider than its hole.
TopoDS_Solid lens();

// A turn and a shift without round numbers, and where it takes a point or a vector.
gp_Trsf some_pose();
Vec3 posed(const gp_Trsf& pose, const Vec3& at, bool vector);

// A document as a reader would give it.
internal::Document document_of(const TopoDS_Shape& shape, const std::string& unit = "mm");

// An assembly "pair" of a cube "box" and a cylinder "pin" used at two places; the first face of the
// cube is named "lid" and red, the cylinder is blue.
internal::Document assembly(const std::string& unit = "mm");

// An assembly "rack" of a part "bar" at each of these places.
internal::Document placed(const TopoDS_Shape& part, const std::vector<gp_Trsf>& places);

}  // namespace isochor::shapes
