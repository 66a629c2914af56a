// Writes one solid, or an open skin, as a STEP file (ISO 10303-21, AP242), from plain geometry and
// topology.
//
// Numbers are written with the shortest digits that read back as the same double. The text depends
// on nothing but the calls: no time, no machine, no address.
//
// Use: vertices, then edges (a space curve and its pcurves), then faces (loops of edges), then
// `text`. Every edge of a solid must be used twice, in opposite directions.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "make_data/spline_tools.h"

namespace make_data {

using Rgb = std::array<double, 3>;

// A curve in the parameter plane of a surface: clamped poles, or a straight line
// (start + t * direction) when `knots` is empty.
struct Pcurve {
  int surface = 0;  // an id from `surface` or `plane`
  std::vector<KnotVector> knots;
  std::vector<Uv> poles;
};
Pcurve straight_pcurve(int surface, Uv start, Uv direction);
Pcurve spline_pcurve(int surface, const KnotVector& knots, std::vector<Uv> poles);

// An edge as a loop uses it.
struct Use {
  int edge = 0;
  bool forward = true;
};

class StepText {
 public:
  // `unit` is an SI name such as "METRE".
  StepText(std::string name, std::string description, std::string unit);

  int vertex(const Vec3& point);
  int surface(const Surface& surface, bool u_closed = false, bool v_closed = false);
  // Parameters of the point p: ((p - origin) . x_axis, (p - origin) . (normal x x_axis)).
  int plane(const Vec3& origin, const Vec3& normal, const Vec3& x_axis);
  // `seam`: the two pcurves lie on one surface.
  int edge(int begin, int end, const Curve& curve, const std::vector<Pcurve>& pcurves,
           bool seam = false);
  // A straight edge from one point to another, parametrised by length.
  int straight_edge(int begin, int end, const Vec3& from, const Vec3& to,
                    const std::vector<Pcurve>& pcurves);
  // The first loop is the outer one. `reversed`: the outward normal is -(S_u x S_v); loops run
  // counter-clockwise around the outward normal, holes clockwise.
  void face(const std::string& name, int surface, const std::vector<std::vector<Use>>& loops,
            const Rgb& colour, bool reversed = false);

  // The faces are a skin that encloses nothing.
  void leave_open() { open_ = true; }

  // The whole file.
  std::string text() const;

 private:
  int add(const std::string& body);
  // Points, directions and contexts that are the same text are the same entity.
  int shared(const std::string& body);
  int point(const Vec3& p);
  int point2(Uv p);
  int direction(const Vec3& d);
  int pcurve(const Pcurve& p);
  // The entities around the faces: solid, units, product; returns the context of the shape.
  int add_product();
  void add_colours(int context);
  int edge_curve(int begin, int end, int curve, const std::vector<Pcurve>& pcurves, bool seam);

  std::string name_, description_, unit_;
  std::vector<std::string> lines_;
  std::map<std::string, int> known_;
  std::vector<int> faces_;
  std::vector<Rgb> colours_;
  bool open_ = false;
};

// The shortest STEP real that reads back as `value`.
std::string step_real(double value);

}  // namespace make_data
