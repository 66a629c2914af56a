#include "isochor/step/compare_faces.h"

#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "isochor/step/checks.h"
#include "isochor/step/file_surface.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// A face that is not edited may move by this part of the diagonal, from rounding of placements and
// of surfaces that OpenCASCADE stores in another form.
constexpr double kMayMove = 1e-12;
// More units in the last place than re-orthogonalised axes explain are worth a notice.
constexpr double kExpectedUlps = 4.0;
constexpr int kSamples = 8;  // per direction

bool same_surface(const Surface& a, const Surface& b) {
  return a.u_knots() == b.u_knots() && a.v_knots() == b.v_knots() && a.poles() == b.poles() &&
         a.weights() == b.weights();
}

Handle(Geom_Surface) basis(const TopoDS_Face& face) {
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
  return trimmed.IsNull() ? surface : trimmed->BasisSurface();
}

bool same_bits(const Geom_BSplineSurface& a, const Geom_BSplineSurface& b) {
  if (a.IsUPeriodic() != b.IsUPeriodic() || a.IsVPeriodic() != b.IsVPeriodic() ||
      a.UDegree() != b.UDegree() || a.VDegree() != b.VDegree() || a.NbUPoles() != b.NbUPoles() ||
      a.NbVPoles() != b.NbVPoles() || a.NbUKnots() != b.NbUKnots() ||
      a.NbVKnots() != b.NbVKnots()) {
    return false;
  }
  for (int i = 1; i <= a.NbUKnots(); ++i) {
    if (a.UKnot(i) != b.UKnot(i) || a.UMultiplicity(i) != b.UMultiplicity(i)) return false;
  }
  for (int j = 1; j <= a.NbVKnots(); ++j) {
    if (a.VKnot(j) != b.VKnot(j) || a.VMultiplicity(j) != b.VMultiplicity(j)) return false;
  }
  for (int i = 1; i <= a.NbUPoles(); ++i) {
    for (int j = 1; j <= a.NbVPoles(); ++j) {
      const gp_Pnt p = a.Pole(i, j), q = b.Pole(i, j);
      if (p.X() != q.X() || p.Y() != q.Y() || p.Z() != q.Z()) return false;
      if (a.Weight(i, j) != b.Weight(i, j)) return false;
    }
  }
  return true;
}

// The surfaces of a face without its place: bits survive only there.
Handle(Geom_BSplineSurface) own_spline(const TopoDS_Face& face) {
  TopLoc_Location ignored;
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face, ignored);
  const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
  if (!trimmed.IsNull()) surface = trimmed->BasisSurface();
  return Handle(Geom_BSplineSurface)::DownCast(surface);
}

// The part of `gap` across a surface at (u, v); where it has no normal (a pole) all of it.
double across(const Geom_Surface& surface, double u, double v, const gp_Vec& gap) {
  gp_Pnt at;
  gp_Vec along_u, along_v;
  surface.D1(u, v, at, along_u, along_v);
  const gp_Vec normal = along_u.Crossed(along_v);
  const double length = normal.Magnitude();
  return length > 0.0 ? std::abs(gap.Dot(normal)) / length : gap.Magnitude();
}

// How far points of `before` lie from the surface of `after`. Parameters usually mean the same
// point; formats that know no left-handed axes turn them around, and then the closest point counts.
double distance(const TopoDS_Face& before, const TopoDS_Face& after, double near) {
  const auto a = basis(before), b = basis(after);
  ShapeAnalysis_Surface closest(b);
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0, largest = 0.0;
  BRepTools::UVBounds(before, u0, u1, v0, v1);
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      const double u = u0 + (u1 - u0) * i / kSamples, v = v0 + (v1 - v0) * j / kSamples;
      const gp_Pnt point = a->Value(u, v);
      const gp_Vec gap(b->Value(u, v), point);
      const double found = gap.Magnitude() <= near
                               ? across(*b, u, v, gap)
                               : closest.Value(closest.ValueOfUV(point, near)).Distance(point);
      largest = std::max(largest, found);
    }
  }
  return largest;
}

struct Scale {
  double diagonal = 0.0, ulp = 0.0;
  explicit Scale(const TopoDS_Shape& shape) {
    Bnd_Box box;
    BRepBndLib::Add(shape, box, Standard_False);
    if (box.IsVoid()) return;
    const gp_Pnt low = box.CornerMin(), high = box.CornerMax();
    diagonal = low.Distance(high);
    double largest = 0.0;
    for (const gp_Pnt& p : {low, high}) {
      largest = std::max({largest, std::abs(p.X()), std::abs(p.Y()), std::abs(p.Z())});
    }
    ulp = largest * std::numeric_limits<double>::epsilon();
  }
};

std::string handle_of(int face) { return "face:" + std::to_string(face + 1); }

class Comparer {
 public:
  Comparer(const Document& before, const Document& after)
      : before_(before), after_(after), scale_(before.shape) {}

  void edited(int k, const Surface& meant) {
    // The file's own numbers count; without them, what OpenCASCADE made of them.
    auto found = file_surface(after_, k);
    const auto plain = plain_bspline(after_.face(k));
    if (!found && !plain.IsNull()) found = from_occt(*plain);
    if (found && same_surface(*found, meant)) {
      ++result_.edited_exact;
      return;
    }
    const double moved = plain.IsNull() ? scale_.diagonal : pole_distance(*plain, meant);
    if (moved <= kMayMove * scale_.diagonal) {
      return note(k, "its poles differ by rounding from what was meant");
    }
    object(k, "its poles are not what was meant");
  }

  void untouched(int k) {
    const auto a = own_spline(before_.face(k)), b = own_spline(after_.face(k));
    const bool spline = !a.IsNull();
    if (spline) {
      ++result_.bspline_untouched;
      if (!b.IsNull() && (same_bits(*a, *b) || same_in_file(k))) {
        ++result_.identical;
        return;
      }
    }
    const double moved = distance(before_.face(k), after_.face(k), kMayMove * scale_.diagonal);
    const double ulps = scale_.ulp > 0.0 ? moved / scale_.ulp : 0.0;
    if (!(moved <= kMayMove * scale_.diagonal)) {
      return object(k, "is not where it was, although it was not edited (off by " +
                           number_text(moved) + " " + before_.unit.name + ")");
    }
    if (spline) return note(k, "is the same surface in a form with other poles");
    result_.analytic_ulps = std::max(result_.analytic_ulps, ulps);
  }

  FaceComparison take() {
    for (const auto& [text, faces] : notes_) {
      std::string list = faces.front();
      if (faces.size() > 1) list += " and " + std::to_string(faces.size() - 1) + " more";
      result_.notices.push_back(list + ": " + text);
    }
    if (result_.analytic_ulps > kExpectedUlps) {
      result_.notices.push_back("an analytic face moved by " +
                                std::to_string(static_cast<long>(result_.analytic_ulps)) +
                                " units in the last place");
    }
    return std::move(result_);
  }

 private:
  // A reader may make a closed surface periodic in memory although the file has the same numbers.
  bool same_in_file(int k) const {
    const auto found = file_surface(after_, k);
    if (!found) return false;
    auto meant = file_surface(before_, k);
    const auto plain = own_spline(before_.face(k));
    if (!meant && !plain->IsUPeriodic() && !plain->IsVPeriodic()) meant = from_occt(*plain);
    return meant && same_surface(*found, *meant);
  }

  void note(int k, const std::string& text) { notes_[text].push_back(handle_of(k)); }
  void object(int k, const std::string& text) {
    if (result_.objection.empty()) result_.objection = handle_of(k) + ": " + text;
  }

  // Largest distance of two surfaces with equal domains, by samples.
  double pole_distance(const Geom_BSplineSurface& found, const Surface& meant) const {
    const auto &u = meant.u_knots(), &v = meant.v_knots();
    double largest = 0.0;
    for (int i = 0; i <= 2 * kSamples; ++i) {
      for (int j = 0; j <= 2 * kSamples; ++j) {
        const double s = u.begin() + (u.end() - u.begin()) * i / (2 * kSamples);
        const double t = v.begin() + (v.end() - v.begin()) * j / (2 * kSamples);
        const gp_Pnt p = found.Value(s, t);
        largest = std::max(largest, (meant.point(s, t) - Vec3(p.X(), p.Y(), p.Z())).norm());
      }
    }
    return largest;
  }

  const Document& before_;
  const Document& after_;
  Scale scale_;
  FaceComparison result_;
  std::map<std::string, std::vector<std::string>> notes_;
};

}  // namespace

FaceComparison compare_faces(const Document& before, const Document& after,
                             const std::vector<EditedFace>& edited) {
  Comparer comparer(before, after);
  if (before.face_count() != after.face_count()) {
    FaceComparison result;
    result.objection = "the number of faces changed from " + std::to_string(before.face_count()) +
                       " to " + std::to_string(after.face_count());
    return result;
  }
  const FileSurfaces stated = changed_by_reader(before);
  std::map<int, const EditedFace*> edits;
  for (const auto& edit : edited) edits[edit.face] = &edit;
  for (int k = 0; k < before.face_count(); ++k) {
    const auto edit = edits.find(k);
    if (edit == edits.end()) {
      comparer.untouched(k);
    } else {
      comparer.edited(k, local_surface(edit->second->surface, before.face(k), k, stated));
    }
  }
  return comparer.take();
}

}  // namespace isochor::internal
