#include "isochor/step/face_cells.h"

#include <BndLib_Add2dCurve.hxx>
#include <Bnd_Box2d.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_Shape.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <GeomConvert.hxx>
#include <GeomConvert_BSplineSurfaceToBezierSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "isochor/base/tolerance.h"
#include "isochor/step/conversion.h"

namespace isochor::internal {
namespace {

constexpr int kPiecesPerCurve = 32;  // boxes of each smooth part of a trimming curve
constexpr int kRefinements = 12;     // halvings of such a part, to tell the sides of a near point
constexpr size_t kMostBytes = size_t{192} << 20;  // of the cells of one face
constexpr int kMostSpans = 16000;
constexpr double kDomainSlack = 1e-6;  // of a domain, by which trims may leave it
constexpr int kBendSamples = 17;
constexpr double kMissSafety = 8.0;  // on what the division into Bezier pieces misses
constexpr double kBendSafety = 2.0;  // on second derivatives that were sampled

Vec3 vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

bool contains(const UvBox& box, const Uv& p) {
  return box.u_min <= p.u && p.u <= box.u_max && box.v_min <= p.v && p.v <= box.v_max;
}

bool meets(const UvBox& a, const UvBox& b) {
  return a.u_min <= b.u_max && b.u_min <= a.u_max && a.v_min <= b.v_max && b.v_min <= a.v_max;
}

TrimPiece piece_of(const Handle(Geom2d_Curve) & curve, double first, double last) {
  TrimPiece piece;
  piece.curve = curve;
  piece.first = first;
  piece.last = last;
  const gp_Pnt2d a = curve->Value(first), b = curve->Value(last);
  piece.begin = {a.X(), a.Y()};
  piece.end = {b.X(), b.Y()};
  Bnd_Box2d box;
  BndLib_Add2dCurve::Add(Geom2dAdaptor_Curve(curve), first, last, 0.0, box);
  box.Add(a);
  box.Add(b);
  box.Get(piece.box.u_min, piece.box.v_min, piece.box.u_max, piece.box.v_max);
  const double pad =
      kSideNoise * (1e-3 + piece.box.u_max - piece.box.u_min + piece.box.v_max - piece.box.v_min);
  piece.box = {piece.box.u_min - pad, piece.box.u_max + pad, piece.box.v_min - pad,
               piece.box.v_max + pad};
  return piece;
}

// How often a ray from p along u crosses the piece, which stays inside its box; -1: p lies on it.
int crossings(const TrimPiece& piece, const Uv& p, int refinements) {
  const UvBox& box = piece.box;
  if (p.v < box.v_min || p.v > box.v_max || p.u > box.u_max) return 0;
  if (p.u < box.u_min) return (piece.begin.v > p.v) != (piece.end.v > p.v) ? 1 : 0;
  if (refinements == 0 || piece.curve.IsNull()) return -1;
  const double middle = 0.5 * (piece.first + piece.last);
  const int a = crossings(piece_of(piece.curve, piece.first, middle), p, refinements - 1);
  if (a < 0) return a;
  const int b = crossings(piece_of(piece.curve, middle, piece.last), p, refinements - 1);
  return b < 0 ? b : a + b;
}

void set_box(Cell& cell) {
  cell.low = cell.high = cell.hull.front();
  for (const Vec3& p : cell.hull) {
    cell.low = cell.low.cwiseMin(p);
    cell.high = cell.high.cwiseMax(p);
  }
  cell.low.array() -= cell.radius;
  cell.high.array() += cell.radius;
}

void set_hull(Cell& cell, double noise) {
  cell.hull.clear();
  for (const Vec4& p : cell.bezier.at) cell.hull.push_back(p.head<3>() / p.w());
  cell.radius = noise;
  set_box(cell);
}

BezierCell bezier_of(const Geom_BezierSurface& piece) {
  BezierCell cell;
  cell.u_degree = piece.UDegree();
  cell.v_degree = piece.VDegree();
  cell.rational = piece.IsURational() || piece.IsVRational();
  for (int i = 1; i <= piece.NbUPoles(); ++i) {
    for (int j = 1; j <= piece.NbVPoles(); ++j) {
      const double w = piece.Weight(i, j);
      const Vec3 p = vec(piece.Pole(i, j)) * w;
      cell.at.push_back({p.x(), p.y(), p.z(), w});
    }
  }
  return cell;
}

// The largest distance of a piece from its surface, at nine points.
double deviation(const Geom_Surface& piece, const Geom_Surface& surface, const UvBox& uv) {
  double most = 0.0;
  for (double s : {0.0, 0.5, 1.0}) {
    for (double t : {0.0, 0.5, 1.0}) {
      const double u = (1.0 - s) * uv.u_min + s * uv.u_max, v = (1.0 - t) * uv.v_min + t * uv.v_max;
      most = std::max(most, piece.Value(s, t).Distance(surface.Value(u, v)));
    }
  }
  return most;
}

}  // namespace

FaceCells::FaceCells(const FaceRecord& face, double diagonal)
    : diagonal_(diagonal), noise_(kSameSurface * diagonal) {
  surface_ = face.surface.geometry;
  if (surface_.IsNull()) return;
  collect_trims(face);
  if (!(bounds_.u_min < bounds_.u_max && bounds_.v_min < bounds_.v_max)) return;
  std::vector<int> all(trims_.size());
  std::iota(all.begin(), all.end(), 0);
  const GeomAbs_SurfaceType type = GeomAdaptor_Surface(surface_).GetType();
  if (type > GeomAbs_Torus) {
    Handle(Geom_BSplineSurface) spline = Handle(Geom_BSplineSurface)::DownCast(surface_);
    if (spline.IsNull() && type == GeomAbs_BezierSurface) {
      spline = GeomConvert::SurfaceToBSplineSurface(surface_);
    }
    if (spline.IsNull()) spline = convert_face(face, diagonal).surface;
    if (!spline.IsNull()) {
      surface_ = spline;
      if (add_spans()) return;
      cells_.clear();
    }
    proven_ = false;
  }
  measure_bends();
  cells_.push_back(analytic_cell(bounds_));
  finish(cells_.front(), all);
}

void FaceCells::collect_trims(const FaceRecord& face) {
  for (const FaceLoop& loop : face.loops) {
    for (const EdgeUse& use : loop.uses) {
      if (use.curve.IsNull() || !loop.ordered) {
        bounds_ = {};
        return;
      }
    }
    const size_t count = loop.uses.size();
    for (size_t k = 0; k < count; ++k) {
      add_trim(loop.uses[k]);
      const gp_Pnt2d a = loop.uses[k].finish(), b = loop.uses[(k + 1) % count].start();
      add_gap({a.X(), a.Y()}, {b.X(), b.Y()});
    }
  }
  if (trims_.empty()) {
    surface_->Bounds(bounds_.u_min, bounds_.u_max, bounds_.v_min, bounds_.v_max);
    constexpr double kInfinite = 1e99;
    if (!(bounds_.u_max - bounds_.u_min < kInfinite && bounds_.v_max - bounds_.v_min < kInfinite)) {
      bounds_ = {};
    }
    return;
  }
  bounds_ = trims_.front().box;
  for (const TrimPiece& trim : trims_) {
    bounds_ = {std::min(bounds_.u_min, trim.box.u_min), std::max(bounds_.u_max, trim.box.u_max),
               std::min(bounds_.v_min, trim.box.v_min), std::max(bounds_.v_max, trim.box.v_max)};
  }
}

void FaceCells::add_trim(const EdgeUse& use) {
  const Geom2dAdaptor_Curve curve(use.curve, use.first, use.last);
  TColStd_Array1OfReal at(1, curve.NbIntervals(GeomAbs_CN) + 1);
  curve.Intervals(at, GeomAbs_CN);
  for (int p = 1; p < at.Length(); ++p) {
    for (int k = 0; k < kPiecesPerCurve; ++k) {
      const double step = (at(p + 1) - at(p)) / kPiecesPerCurve;
      const double end = k + 1 == kPiecesPerCurve ? at(p + 1) : at(p) + (k + 1) * step;
      trims_.push_back(piece_of(use.curve, at(p) + k * step, end));
    }
  }
}

// Loops are closed by straight lines; which side of them the face is on is not known.
void FaceCells::add_gap(const Uv& from, const Uv& to) {
  if (from == to) return;
  TrimPiece piece;
  piece.begin = from;
  piece.end = to;
  piece.box = {std::min(from.u, to.u), std::max(from.u, to.u), std::min(from.v, to.v),
               std::max(from.v, to.v)};
  trims_.push_back(std::move(piece));
}

// Bounds of the second derivatives; of unusual surfaces estimates by samples.
void FaceCells::measure_bends() {
  const GeomAdaptor_Surface adaptor(surface_);
  switch (adaptor.GetType()) {
    case GeomAbs_Plane:
      return;
    case GeomAbs_Cylinder:
      bend_u_ = adaptor.Cylinder().Radius();
      return;
    case GeomAbs_Cone: {
      const double slope = std::sin(adaptor.Cone().SemiAngle());
      bend_u_ = std::max(std::abs(adaptor.Cone().RefRadius() + bounds_.v_min * slope),
                         std::abs(adaptor.Cone().RefRadius() + bounds_.v_max * slope));
      return;
    }
    case GeomAbs_Sphere:
      bend_u_ = bend_v_ = adaptor.Sphere().Radius();
      return;
    case GeomAbs_Torus:
      bend_u_ = adaptor.Torus().MajorRadius() + adaptor.Torus().MinorRadius();
      bend_v_ = adaptor.Torus().MinorRadius();
      return;
    default:
      break;
  }
  for (int i = 0; i < kBendSamples; ++i) {
    for (int j = 0; j < kBendSamples; ++j) {
      const double s = static_cast<double>(i) / (kBendSamples - 1);
      const double t = static_cast<double>(j) / (kBendSamples - 1);
      gp_Pnt p;
      gp_Vec du, dv, duu, dvv, duv;
      surface_->D2((1 - s) * bounds_.u_min + s * bounds_.u_max,
                   (1 - t) * bounds_.v_min + t * bounds_.v_max, p, du, dv, duu, dvv, duv);
      bend_u_ = std::max(bend_u_, kBendSafety * duu.Magnitude());
      bend_v_ = std::max(bend_v_, kBendSafety * dvv.Magnitude());
    }
  }
}

Cell FaceCells::analytic_cell(const UvBox& uv) const {
  Cell cell;
  cell.uv = uv;
  for (double u : {uv.u_min, uv.u_max}) {
    for (double v : {uv.v_min, uv.v_max}) cell.hull.push_back(vec(surface_->Value(u, v)));
  }
  const double du = uv.u_max - uv.u_min, dv = uv.v_max - uv.v_min;
  cell.radius = noise_ + (du * du * bend_u_ + dv * dv * bend_v_) / 8.0;
  set_box(cell);
  return cell;
}

// Faces that reach beyond the surface's own parameters have points that no piece holds: false. But
// boxes of curves may be larger than the curves.
bool FaceCells::clip_bounds(const UvBox& domain) {
  const double du = kDomainSlack * (domain.u_max - domain.u_min);
  const double dv = kDomainSlack * (domain.v_max - domain.v_min);
  const UvBox wider{domain.u_min - du, domain.u_max + du, domain.v_min - dv, domain.v_max + dv};
  for (const TrimPiece& trim : trims_) {
    if (!contains(wider, trim.begin) || !contains(wider, trim.end)) return false;
  }
  bounds_ = {std::max(bounds_.u_min, domain.u_min), std::min(bounds_.u_max, domain.u_max),
             std::max(bounds_.v_min, domain.v_min), std::min(bounds_.v_max, domain.v_max)};
  return true;
}

// One cell a knot span; false when the pieces are too many or not those of the surface.
bool FaceCells::add_spans() {
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface_);
  if (spline->IsUPeriodic() || spline->IsVPeriodic()) return false;
  GeomConvert_BSplineSurfaceToBezierSurface pieces(spline);
  const int nu = pieces.NbUPatches(), nv = pieces.NbVPatches();
  if (nu < 1 || nv < 1 || nu * nv > kMostSpans) return false;
  TColStd_Array1OfReal u(1, nu + 1), v(1, nv + 1);
  pieces.UKnots(u);
  pieces.VKnots(v);
  if (!clip_bounds({u(1), u(nu + 1), v(1), v(nv + 1)})) return false;
  std::vector<std::vector<Cell>> spans(static_cast<size_t>(nu));
  for (int i = 1; i <= nu; ++i) {
    for (int j = 1; j <= nv; ++j) {
      const Handle(Geom_BezierSurface) piece = pieces.Patch(i, j);
      Cell cell;
      cell.uv = {u(i), u(i + 1), v(j), v(j + 1)};
      cell.bezier = bezier_of(*piece);
      const double miss = deviation(*piece, *surface_, cell.uv);
      if (miss > kCoincident * diagonal_) return false;
      set_hull(cell, noise_ + kMissSafety * miss);
      spans[static_cast<size_t>(i) - 1].push_back(std::move(cell));
    }
  }
  cells_.emplace_back();
  build(spans, 0, 0, nu, 0, nv);
  return true;
}

// Puts the spans [i0, i1) x [j0, j1) into the cell `at`.
int FaceCells::build(const std::vector<std::vector<Cell>>& spans, int at, int i0, int i1, int j0,
                     int j1) {
  Cell cell;
  if (i1 - i0 == 1 && j1 - j0 == 1) {
    cell = spans[static_cast<size_t>(i0)][static_cast<size_t>(j0)];
    std::vector<int> all(trims_.size());
    std::iota(all.begin(), all.end(), 0);
    finish(cell, all);
    cells_[static_cast<size_t>(at)] = std::move(cell);
    return at;
  }
  const int first = static_cast<int>(cells_.size());
  cells_.resize(cells_.size() + 2);
  if (i1 - i0 >= j1 - j0) {
    const int middle = (i0 + i1) / 2;
    build(spans, first, i0, middle, j0, j1);
    build(spans, first + 1, middle, i1, j0, j1);
  } else {
    const int middle = (j0 + j1) / 2;
    build(spans, first, i0, i1, j0, middle);
    build(spans, first + 1, i0, i1, middle, j1);
  }
  const Cell& a = cells_[static_cast<size_t>(first)];
  const Cell& b = cells_[static_cast<size_t>(first) + 1];
  cell.uv = {a.uv.u_min, b.uv.u_max, a.uv.v_min, b.uv.v_max};
  cell.children = first;
  cell.outside = a.outside && b.outside;
  const Vec3 low = a.outside ? b.low : b.outside ? a.low : Vec3(a.low.cwiseMin(b.low));
  const Vec3 high = a.outside ? b.high : b.outside ? a.high : Vec3(a.high.cwiseMax(b.high));
  for (int corner = 0; corner < 8; ++corner) {
    cell.hull.emplace_back(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(),
                           corner & 4 ? low.z() : high.z());
  }
  set_box(cell);
  cells_[static_cast<size_t>(at)] = std::move(cell);
  return at;
}

// The trims that meet the cell, of those that may; and whether it is trimmed off.
void FaceCells::finish(Cell& cell, const std::vector<int>& trims) const {
  if (trims_.empty()) return;
  for (int k : trims) {
    if (meets(trims_[static_cast<size_t>(k)].box, cell.uv)) cell.trims.push_back(k);
  }
  if (!cell.trims.empty()) return;
  const Uv middle{0.5 * (cell.uv.u_min + cell.uv.u_max), 0.5 * (cell.uv.v_min + cell.uv.v_max)};
  cell.outside = where(middle) == Where::kOutside;
}

int FaceCells::divide(int k) {
  if (cell(k).children >= 0) return cell(k).children;
  if (bytes_ > kMostBytes) return -1;
  if (first_cells_ == 0) first_cells_ = cells_.size();
  const Cell parent = cell(k);
  const UvBox& uv = parent.uv;
  const double u = 0.5 * (uv.u_min + uv.u_max), v = 0.5 * (uv.v_min + uv.v_max);
  // Across the longer way in space.
  const auto length = [&](const Uv& a, const Uv& b) {
    return surface_->Value(a.u, a.v).Distance(surface_->Value(b.u, b.v));
  };
  const double along_u = length({uv.u_min, v}, {u, v}) + length({u, v}, {uv.u_max, v});
  const double along_v = length({u, uv.v_min}, {u, v}) + length({u, v}, {u, uv.v_max});
  const bool in_u = along_u >= along_v;
  if (in_u ? !(uv.u_min < u && u < uv.u_max) : !(uv.v_min < v && v < uv.v_max)) return -1;
  UvBox halves[2] = {uv, uv};
  (in_u ? halves[0].u_max : halves[0].v_max) = in_u ? u : v;
  (in_u ? halves[1].u_min : halves[1].v_min) = in_u ? u : v;
  std::array<BezierCell, 2> pieces;
  if (!parent.bezier.at.empty()) {
    pieces = (in_u ? parent.bezier : parent.bezier.transposed()).halves_in_u();
  }
  const int first = static_cast<int>(cells_.size());
  for (size_t side = 0; side < 2; ++side) {
    Cell child;
    if (parent.bezier.at.empty()) {
      child = analytic_cell(halves[side]);
    } else {
      child.uv = halves[side];
      child.bezier = in_u ? std::move(pieces[side]) : pieces[side].transposed();
      set_hull(child, parent.radius);
    }
    child.outside = parent.outside;
    if (!parent.trims.empty()) finish(child, parent.trims);
    bytes_ += sizeof(Cell) + child.hull.size() * (sizeof(Vec3) + sizeof(Vec4)) +
              child.trims.size() * sizeof(int);
    cells_.push_back(std::move(child));
  }
  cells_[static_cast<size_t>(k)].children = first;
  return first;
}

void FaceCells::forget() {
  if (first_cells_ == 0) return;
  cells_.resize(first_cells_);
  for (Cell& cell : cells_) {
    if (cell.children >= static_cast<int>(first_cells_)) cell.children = -1;
  }
  bytes_ = 0;
}

Where FaceCells::where(const Uv& at) const {
  if (trims_.empty()) return contains(bounds_, at) ? Where::kInside : Where::kOutside;
  int count = 0;
  for (const TrimPiece& trim : trims_) {
    const int more = crossings(trim, at, kRefinements);
    if (more < 0) return Where::kOnTrim;
    count += more;
  }
  return count % 2 == 1 ? Where::kInside : Where::kOutside;
}

}  // namespace isochor::internal
