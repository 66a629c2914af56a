// Volumes of the solids of a CAD file, by several methods; whole_solids.py calls it and compares.
//
// usage: isochor_solid_probe FILE                        the number of closed solids
//        isochor_solid_probe FILE K ours                 ours: about the axes z, x, y, and facts
//        isochor_solid_probe FILE K default              BRepGProp without a tolerance
//        isochor_solid_probe FILE K adaptive|gk EPS      BRepGProp with a tolerance
//        isochor_solid_probe FILE K faces EPS            face by face, the integral of p . n / 3:
//        ours,
//                                                        OpenCASCADE's, our bound, the face's kind
//        isochor_solid_probe FILE K third F GOAL         face F by brute force, until halving the
//        steps
//                                                        changes less than GOAL
// K and F count from 0. Prints a line ": name value ..." per result; other lines are OpenCASCADE's
// chatter. Exit status: 0, or 1 with a message.
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_Shape.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <gp_Trsf.hxx>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/face_loops.h"
#include "isochor/step/flux.h"
#include "isochor/step/flux_integrand.h"
#include "isochor/step/shape_facts.h"
#include "isochor/step/trim_region.h"
#include "isochor/volume/volume_form.h"

namespace isochor {
namespace {

using internal::FaceIntegrals;
using internal::ShapeIntegrals;

std::vector<TopoDS_Shape> closed_solids(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) {
    solids.Add(it.Current());  // some files have nothing but a closed shell
  }
  std::vector<TopoDS_Shape> closed;
  for (int k = 1; k <= solids.Extent(); ++k) {
    if (internal::shape_facts(solids(k), false).closed) closed.push_back(solids(k));
  }
  return closed;
}

// (x, y, z) to (y, z, x), `times` times: exact, a rotation.
gp_Trsf turn(int times) {
  gp_Trsf once, all;
  once.SetValues(0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0);
  for (int k = 0; k < times; ++k) all.Multiply(once);
  return all;
}

// The integrals of z dx dy, x dy dz and y dz dx. On a solid without gaps all are the volume.
std::array<ShapeIntegrals, 3> about_axes(const TopoDS_Shape& solid) {
  std::array<ShapeIntegrals, 3> all;
  for (int k = 0; k < 3; ++k) {
    all[static_cast<size_t>(k)] = internal::integrate_shape(solid.Moved(TopLoc_Location(turn(k))));
  }
  return all;
}

// The point that BRepGProp takes as the tip of its cones: the mean of the vertices as met.
gp_Pnt tip_of(const TopoDS_Shape& shape) {
  gp_XYZ sum(0.0, 0.0, 0.0);
  int count = 0;
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next(), ++count) {
    sum += BRep_Tool::Pnt(TopoDS::Vertex(it.Current())).XYZ();
  }
  if (count > 0) sum /= count;
  return gp_Pnt(sum);
}

// The integral of (p - tip) . n / 3 over face `k`, and its bound: what BRepGProp computes.
Bounded cone_volume(const std::array<ShapeIntegrals, 3>& all, size_t k, const gp_Pnt& tip) {
  // Axis z of the shape turned once is x of the shape, turned twice y.
  const std::array<double, 3> origin = {tip.Z(), tip.X(), tip.Y()};
  Bounded sum;
  for (size_t axis = 0; axis < 3; ++axis) {
    const double height = all[axis].z0 - origin[axis];
    sum.value += all[axis].faces[k].flux_about_zero(height) / 3.0;
    sum.bound += all[axis].faces[k].bound_about_zero(height) / 3.0;
  }
  return sum;
}

void print_faces(const TopoDS_Shape& solid, double eps) {
  const std::array<ShapeIntegrals, 3> all = about_axes(solid);
  size_t k = 0;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next(), ++k) {
    const Bounded ours = cone_volume(all, k, tip_of(it.Current()));
    GProp_GProps properties;
    BRepGProp::VolumeProperties(it.Current(), properties, eps);
    const GeomAdaptor_Surface surface(BRep_Tool::Surface(TopoDS::Face(it.Current())));
    std::printf(": face %zu %.17g %.17g %.3g %d\n", k, ours.value, properties.Mass(), ours.bound,
                static_cast<int>(surface.GetType()));
  }
}

// The integral of (p - tip) . n / 3 over a face by Green's theorem again, but with no thought:
// equal steps along every curve, whatever knots they meet, and OpenCASCADE's own evaluation. It
// converges slowly and shares nothing with our integrals but the curves and the way to close a
// loop's gaps.
class BruteForce {
 public:
  BruteForce(const TopoDS_Face& face, const gp_Pnt& tip)
      : surface_(BRep_Tool::Surface(face)),
        loops_(internal::face_loops(face)),
        breaks_(internal::surface_breaks(surface_).u),
        tip_(tip),
        sign_(face.Orientation() == TopAbs_REVERSED ? -1.0 : 1.0) {
    // Without a curve there is no loop to follow: the sum stays too small and decides nothing.
    const auto lacks_a_curve = [](const internal::FaceLoop& loop) {
      return std::any_of(loop.uses.begin(), loop.uses.end(),
                         [](const internal::EdgeUse& use) { return use.curve.IsNull(); });
    };
    loops_.erase(std::remove_if(loops_.begin(), loops_.end(), lacks_a_curve), loops_.end());
    for (const internal::FaceLoop& loop : loops_) {
      for (const internal::EdgeUse& use : loop.uses) {
        low_ = std::min({low_, use.start().X(), use.finish().X()});
        high_ = std::max({high_, use.start().X(), use.finish().X()});
      }
    }
  }

  double integral(int steps) const {
    long double sum = 0.0;
    for (const internal::FaceLoop& loop : loops_) {
      for (size_t k = 0; k < loop.uses.size(); ++k) {
        sum += along(loop.uses[k], steps);
        const gp_Pnt2d a = loop.uses[k].finish();
        const gp_Pnt2d b = loop.uses[(k + 1) % loop.uses.size()].start();
        sum += inner(0.5 * (a.X() + b.X()), 0.5 * (a.Y() + b.Y())) * (b.Y() - a.Y());
      }
    }
    return static_cast<double>(sign_ * sum);
  }

  // What the gaps between the curves of the loops are worth to a method that leaves them open.
  double open_part() const {
    long double sum = 0.0;
    for (const internal::FaceLoop& loop : loops_) {
      for (size_t k = 0; k < loop.uses.size(); ++k) {
        const double a = loop.uses[k].finish().Y();
        const double b = loop.uses[(k + 1) % loop.uses.size()].start().Y();
        sum += std::abs((inner(high_, a) - inner(low_, a)) * (b - a));
      }
    }
    return static_cast<double>(sum);
  }

 private:
  // `steps` on the whole, at least one between two knots of the curve.
  long double along(const internal::EdgeUse& use, int steps) const {
    const Geom2dAdaptor_Curve curve(use.curve, use.first, use.last);
    TColStd_Array1OfReal knots(1, curve.NbIntervals(GeomAbs_CN) + 1);
    curve.Intervals(knots, GeomAbs_CN);
    const int parts = std::max(1, steps / (knots.Length() - 1));
    long double sum = 0.0;
    gp_Pnt2d p;
    gp_Vec2d d;
    for (int k = 0; k < parts * (knots.Length() - 1); ++k) {
      const double first = knots(1 + k / parts);
      const double step = (knots(2 + k / parts) - first) / parts;
      for (size_t g = 0; g < rule_.nodes.size(); ++g) {
        use.curve->D1(first + step * (k % parts + rule_.nodes[g]), p, d);
        if (d.Y() == 0.0) continue;
        sum += inner(p.X(), p.Y()) * (step * rule_.weights[g] * d.Y());
      }
    }
    return use.reversed ? -sum : sum;
  }

  // From the middle of the face to u.
  long double inner(double u, double v) const {
    const double start = 0.5 * (low_ + high_);
    const double low = std::min(start, u), high = std::max(start, u);
    long double sum = 0.0;
    double from = low;
    for (double knot : breaks_) {
      if (knot > from && knot < high) {
        sum += inner_piece(from, knot, v);
        from = knot;
      }
    }
    sum += inner_piece(from, high, v);
    return u < start ? -sum : sum;
  }

  long double inner_piece(double from, double to, double v) const {
    constexpr int kPieces = 3;
    const double step = (to - from) / kPieces;
    long double sum = 0.0;
    gp_Pnt p;
    gp_Vec du, dv;
    for (int k = 0; k < kPieces; ++k) {
      for (size_t g = 0; g < rule_.nodes.size(); ++g) {
        surface_->D1(from + step * (k + rule_.nodes[g]), v, p, du, dv);
        sum += gp_Vec(tip_, p).Dot(du.Crossed(dv)) / 3.0 * (step * rule_.weights[g]);
      }
    }
    return sum;
  }

  Handle(Geom_Surface) surface_;
  std::vector<internal::FaceLoop> loops_;
  std::vector<double> breaks_;
  gp_Pnt tip_;
  double sign_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  internal::UnitRule rule_ = internal::unit_rule(12);
};

void print_ours(const TopoDS_Shape& solid) {
  const ShapeFacts facts = internal::shape_facts(solid, false);
  const std::array<ShapeIntegrals, 3> all = about_axes(solid);
  std::printf(": volume %.17g\n: bound %.17g\n: area %.17g\n", all[0].volume, all[0].bound,
              all[0].area);
  std::printf(": tolerance %.17g\n: edge_gap %.17g\n: vertex_gap %.17g\n", facts.max_tolerance,
              facts.max_edge_gap, facts.max_vertex_gap);
  double least = all[0].volume, most = least;
  for (const ShapeIntegrals& one : all) {
    least = std::min(least, one.volume);
    most = std::max(most, one.volume);
  }
  Bounded cones;
  for (size_t k = 0; k < all[0].faces.size(); ++k) {
    const Bounded cone = cone_volume(all, k, tip_of(solid));
    cones.value += cone.value;
    cones.bound += cone.bound;
  }
  std::printf(": spread %.17g\n: cones %.17g\n: cones_bound %.17g\n", most - least, cones.value,
              cones.bound);
  double open = 0.0;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
    open += BruteForce(TopoDS::Face(it.Current()), tip_of(solid)).open_part();
  }
  std::printf(": open %.17g\n", open);
  std::printf(": faces %zu\n", all[0].faces.size());
}

void print_third(const TopoDS_Shape& solid, int wanted, double goal) {
  TopExp_Explorer it(solid, TopAbs_FACE);
  for (int k = 0; k < wanted && it.More(); ++k) it.Next();
  const BruteForce force(TopoDS::Face(it.Current()), tip_of(it.Current()));
  constexpr int kFirst = 20, kMost = 3000;
  double last = force.integral(kFirst), change = 0.0;
  for (int steps = 2 * kFirst; steps <= kMost; steps *= 2) {
    const double now = force.integral(steps);
    change = std::abs(now - last);
    last = now;
    if (change <= goal) break;
  }
  std::printf(": volume %.17g\n: change %.17g\n: open %.17g\n", last, change, force.open_part());
}

int probe(int argc, char** argv) {
  const internal::Document document = internal::load_document(argv[1]);
  const std::vector<TopoDS_Shape> solids = closed_solids(document.shape);
  if (argc == 2) {
    std::printf(": solids %zu\n", solids.size());
    return 0;
  }
  const TopoDS_Shape& solid = solids.at(static_cast<size_t>(std::atoi(argv[2])));
  const std::string method = argv[3];
  const double number = argc > 4 ? std::atof(argv[4]) : 0.0;
  const auto begin = std::chrono::steady_clock::now();
  GProp_GProps properties;
  if (method == "ours") {
    print_ours(solid);
  } else if (method == "faces") {
    print_faces(solid, number);
  } else if (method == "third") {
    print_third(solid, std::atoi(argv[4]), argc > 5 ? std::atof(argv[5]) : 0.0);
  } else if (method == "default" || method == "adaptive" || method == "gk") {
    double estimate = 0.0;
    if (method == "default") BRepGProp::VolumeProperties(solid, properties);
    if (method == "adaptive") estimate = BRepGProp::VolumeProperties(solid, properties, number);
    if (method == "gk") estimate = BRepGProp::VolumePropertiesGK(solid, properties, number);
    std::printf(": volume %.17g\n: estimate %.17g\n", properties.Mass(), estimate);
  } else {
    throw std::runtime_error("no method " + method);
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::printf(": seconds %.3f\n", taken.count());
  return 0;
}

}  // namespace
}  // namespace isochor

int main(int argc, char** argv) {
  if (argc != 2 && (argc < 4 || argc > 6)) {
    std::fprintf(stderr, "usage: isochor_solid_probe FILE [K METHOD [NUMBER ...]]\n");
    return 1;
  }
  try {
    return isochor::probe(argc, argv);
  } catch (const Standard_Failure& failure) {
    std::fprintf(stderr, "OpenCASCADE: %s\n", failure.GetMessageString());
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "%s\n", fault.what());
  }
  return 1;
}
