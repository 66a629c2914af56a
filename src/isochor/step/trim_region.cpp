#include "isochor/step/trim_region.h"

#include <BndLib_Add2dCurve.hxx>
#include <Bnd_Box2d.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_Shape.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr int kSideSamples = 17;
constexpr int kBoxesPerCrossing = 4;
constexpr int kBoxesPerCurve = 32;
constexpr int kMaxBoxesPerPiece = 2048;

double width(const UvBox& box, bool u) { return u ? box.u_max - box.u_min : box.v_max - box.v_min; }

double side_value(const UvBox& box, Side side) {
  switch (side) {
    case Side::kUBegin:
      return box.u_min;
    case Side::kUEnd:
      return box.u_max;
    case Side::kVBegin:
      return box.v_min;
    default:
      return box.v_max;
  }
}

// Lengths of the partial derivatives at a place: what a step in u or v is worth in space.
struct Speeds {
  double u = 0.0, v = 0.0;
};

Speeds speeds_at(const Handle(Geom_Surface) & surface, const gp_Pnt2d& at) {
  gp_Pnt p;
  gp_Vec du, dv;
  surface->D1(at.X(), at.Y(), p, du, dv);
  return {du.Magnitude(), dv.Magnitude()};
}

// `length` as a step of a parameter, within the two limits of slack.
double as_parameter(double length, double speed, double range) {
  const double step = speed > 0.0 ? length / speed : range;
  return std::min(std::max(step, kSideNoise * range), kSideSlack * range);
}

struct Interval {
  double low, high;
};

// The part of a side that a pcurve covers, if it runs along it.
bool runs_along(const Handle(Geom_Surface) & surface, const EdgeUse& use, const UvBox& domain,
                Side side, double distance, Interval& covered) {
  const bool u_side = is_u_side(side);
  const double at_side = side_value(domain, side);
  const double range = width(domain, u_side);
  if (!(range < Precision::Infinite())) return false;
  const double length = std::max(distance, use.tolerance);
  covered = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (int k = 0; k < kSideSamples; ++k) {
    const double t = use.first + (use.last - use.first) * k / (kSideSamples - 1);
    const gp_Pnt2d p = use.curve->Value(t);
    const double off = std::abs((u_side ? p.X() : p.Y()) - at_side);
    if (off > kSideSlack * range) return false;
    if (off > kSideNoise * range) {  // else within every slack, whatever the speed
      const Speeds speed = speeds_at(surface, p);
      if (off > as_parameter(length, u_side ? speed.u : speed.v, range)) return false;
    }
    const double along = u_side ? p.Y() : p.X();
    covered.low = std::min(covered.low, along);
    covered.high = std::max(covered.high, along);
  }
  return covered.high - covered.low > kSideNoise * width(domain, !u_side);
}

// True when the intervals, together, reach from one end of the side to the other.
bool covers(std::vector<Interval> parts, double begin, double end, double slack) {
  std::sort(parts.begin(), parts.end(),
            [](const Interval& a, const Interval& b) { return a.low < b.low; });
  double reached = begin;
  for (const Interval& part : parts) {
    if (part.low > reached + slack) return false;
    reached = std::max(reached, part.high);
  }
  return !parts.empty() && reached >= end - slack;
}

bool is_collapsed(const Handle(Geom_Surface) & surface, const UvBox& domain, Side side,
                  double distance) {
  const bool u_side = is_u_side(side);
  const double at = side_value(domain, side);
  const double begin = u_side ? domain.v_min : domain.u_min;
  const double range = width(domain, !u_side);
  if (!(range < Precision::Infinite()) || !(std::abs(at) < Precision::Infinite())) return false;
  const auto point = [&](double s) {
    return u_side ? surface->Value(at, begin + s * range) : surface->Value(begin + s * range, at);
  };
  const gp_Pnt origin = point(0.0);
  for (int k = 1; k < kSideSamples; ++k) {
    if (point(static_cast<double>(k) / (kSideSamples - 1)).Distance(origin) > distance) {
      return false;
    }
  }
  return true;
}

SideCover cover_of_side(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                        const UvBox& domain, Side side, double distance) {
  SideCover cover;
  const bool u_side = is_u_side(side);
  std::vector<Interval> parts;
  double slack = kSideNoise * width(domain, !u_side);
  for (size_t l = 0; l < loops.size(); ++l) {
    for (size_t k = 0; k < loops[l].uses.size(); ++k) {
      const EdgeUse& use = loops[l].uses[k];
      Interval part{};
      if (use.curve.IsNull() || !runs_along(surface, use, domain, side, distance, part)) continue;
      const Speeds speed = speeds_at(surface, use.curve->Value(0.5 * (use.first + use.last)));
      slack = std::max(slack, as_parameter(std::max(distance, use.tolerance),
                                           u_side ? speed.v : speed.u, width(domain, !u_side)));
      cover.uses.push_back({static_cast<int>(l), static_cast<int>(k)});
      parts.push_back(part);
    }
  }
  cover.collapsed = is_collapsed(surface, domain, side, distance);
  cover.covered = covers(std::move(parts), u_side ? domain.v_min : domain.u_min,
                         u_side ? domain.v_max : domain.u_max, slack);
  // A point needs no edge: files often leave the degenerated one out.
  if (cover.collapsed && cover.uses.empty()) cover.covered = true;
  return cover;
}

bool is_iso(const EdgeUse& use, const UvBox& domain) {
  if (use.curve.IsNull()) return false;
  const gp_Pnt2d a = use.curve->Value(use.first);
  double off_u = 0.0;
  double off_v = 0.0;
  for (int k = 1; k < kSideSamples; ++k) {
    const gp_Pnt2d p =
        use.curve->Value(use.first + (use.last - use.first) * k / (kSideSamples - 1));
    off_u = std::max(off_u, std::abs(p.X() - a.X()));
    off_v = std::max(off_v, std::abs(p.Y() - a.Y()));
  }
  // Infinite domains (planes, cylinders) compare with the extent of the curve itself.
  const double range_u = std::min(width(domain, true), off_u + off_v);
  const double range_v = std::min(width(domain, false), off_u + off_v);
  return off_u <= kSideNoise * range_u || off_v <= kSideNoise * range_v;
}

// A corner of a rectangle turns by a right angle; an L-shape of iso lines has more than four.
int corners(const FaceLoop& loop) {
  int count = 0;
  for (size_t k = 0; k < loop.uses.size(); ++k) {
    const auto direction = [](const EdgeUse& use) {
      const gp_Pnt2d a = use.start();
      const gp_Pnt2d b = use.finish();
      const double du = b.X() - a.X();
      const double dv = b.Y() - a.Y();
      return std::abs(du) > std::abs(dv) ? (du > 0 ? 0 : 2) : (dv > 0 ? 1 : 3);
    };
    count += direction(loop.uses[k]) != direction(loop.uses[(k + 1) % loop.uses.size()]) ? 1 : 0;
  }
  return count;
}

bool listed(const std::array<SideCover, 4>& sides, size_t loop, size_t use) {
  for (const SideCover& side : sides) {
    if (!side.covered) continue;
    for (const UseRef& ref : side.uses) {
      if (static_cast<size_t>(ref.loop) == loop && static_cast<size_t>(ref.use) == use) return true;
    }
  }
  return false;
}

TrimKind kind_of(const FaceTrim& trim, const std::vector<FaceLoop>& loops) {
  bool natural = true;
  for (const SideCover& side : trim.sides) natural = natural && side.covered;
  bool iso = true;
  for (size_t l = 0; l < loops.size(); ++l) {
    for (size_t k = 0; k < loops[l].uses.size(); ++k) {
      natural = natural && listed(trim.sides, l, k);
      iso = iso && is_iso(loops[l].uses[k], trim.domain);
    }
  }
  if (natural || loops.empty()) return TrimKind::kNatural;
  if (loops.size() > 1) return TrimKind::kTrimmedWithHoles;
  return iso && corners(loops.front()) == 4 ? TrimKind::kIsoBox : TrimKind::kTrimmed;
}

// How many boxes a smooth piece of a pcurve gets: a few per knot span it crosses, and its share of
// those for the whole curve.
int box_count(const EdgeUse& use, double low, double high, const SurfaceBreaks& breaks) {
  const gp_Pnt2d a = use.curve->Value(low);
  const gp_Pnt2d b = use.curve->Value(high);
  const auto crossed = [](const std::vector<double>& at, double from, double to) {
    const auto least = std::upper_bound(at.begin(), at.end(), std::min(from, to));
    const auto most = std::lower_bound(at.begin(), at.end(), std::max(from, to));
    return most > least ? static_cast<int>(most - least) : 0;
  };
  const int knots = crossed(breaks.u, a.X(), b.X()) + crossed(breaks.v, a.Y(), b.Y());
  const double share = std::abs((high - low) / (use.last - use.first));
  const int least = static_cast<int>(std::ceil(kBoxesPerCurve * share));
  return std::min(std::max(kBoxesPerCrossing * knots, least), kMaxBoxesPerPiece);
}

// The pieces on which a pcurve is smooth.
std::vector<double> curve_breaks(const EdgeUse& use) {
  const Geom2dAdaptor_Curve curve(use.curve, use.first, use.last);
  TColStd_Array1OfReal at(1, curve.NbIntervals(GeomAbs_CN) + 1);
  curve.Intervals(at, GeomAbs_CN);
  return {at.begin(), at.end()};
}

void add_boxes(const Handle(Geom_Surface) & surface, const EdgeUse& use, const UvBox& domain,
               const SurfaceBreaks& breaks, std::vector<UvBox>& boxes) {
  const Geom2dAdaptor_Curve curve(use.curve);
  const std::vector<double> pieces = curve_breaks(use);
  for (size_t p = 0; p + 1 < pieces.size(); ++p) {
    const int count = box_count(use, pieces[p], pieces[p + 1], breaks);
    for (int k = 0; k < count; ++k) {
      const double step = (pieces[p + 1] - pieces[p]) / count;
      const double t0 = pieces[p] + k * step;
      const double t1 = k + 1 == count ? pieces[p + 1] : t0 + step;
      Bnd_Box2d bounds;
      BndLib_Add2dCurve::Add(curve, t0, t1, 0.0, bounds);
      UvBox box;
      bounds.Get(box.u_min, box.v_min, box.u_max, box.v_max);
      const Speeds speed = speeds_at(surface, use.curve->Value(0.5 * (t0 + t1)));
      const double du = as_parameter(use.tolerance, speed.u, width(domain, true));
      const double dv = as_parameter(use.tolerance, speed.v, width(domain, false));
      boxes.push_back({box.u_min - du, box.u_max + du, box.v_min - dv, box.v_max + dv});
    }
  }
}

std::vector<Uv> polyline(const FaceLoop& loop, const SurfaceBreaks& breaks) {
  std::vector<Uv> points;
  for (const EdgeUse& use : loop.uses) {
    if (use.curve.IsNull()) continue;
    const bool line = Geom2dAdaptor_Curve(use.curve).GetType() == GeomAbs_Line;
    std::vector<double> pieces = curve_breaks(use);
    if (use.reversed) std::reverse(pieces.begin(), pieces.end());
    for (size_t p = 0; p + 1 < pieces.size(); ++p) {
      const int count = line ? 1 : box_count(use, pieces[p], pieces[p + 1], breaks);
      for (int k = 0; k < count; ++k) {
        const gp_Pnt2d at = use.curve->Value(pieces[p] + (pieces[p + 1] - pieces[p]) * k / count);
        points.push_back({at.X(), at.Y()});
      }
    }
  }
  return points;
}

}  // namespace

SurfaceBreaks surface_breaks(const Handle(Geom_Surface) & surface) {
  const GeomAdaptor_Surface adaptor(surface);
  TColStd_Array1OfReal u(1, adaptor.NbUIntervals(GeomAbs_CN) + 1);
  TColStd_Array1OfReal v(1, adaptor.NbVIntervals(GeomAbs_CN) + 1);
  adaptor.UIntervals(u, GeomAbs_CN);
  adaptor.VIntervals(v, GeomAbs_CN);
  return {{u.begin(), u.end()}, {v.begin(), v.end()}};
}

FaceTrim classify_sides(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                        double distance) {
  FaceTrim trim;
  surface->Bounds(trim.domain.u_min, trim.domain.u_max, trim.domain.v_min, trim.domain.v_max);
  for (size_t s = 0; s < kSides.size(); ++s) {
    trim.sides[s] = cover_of_side(surface, loops, trim.domain, kSides[s], distance);
  }
  trim.kind = kind_of(trim, loops);
  return trim;
}

FaceTrim classify_trim(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                       double distance) {
  FaceTrim trim = classify_sides(surface, loops, distance);
  if (trim.kind == TrimKind::kNatural) return trim;
  const SurfaceBreaks breaks = surface_breaks(surface);
  const auto boxes_so_far = [&] { return static_cast<int>(trim.region.boundary.size()); };
  for (size_t l = 0; l < loops.size(); ++l) {
    trim.boxes.emplace_back();
    for (size_t k = 0; k < loops[l].uses.size(); ++k) {
      const EdgeUse& use = loops[l].uses[k];
      const int first = boxes_so_far();
      if (!use.curve.IsNull() && !listed(trim.sides, l, k)) {
        add_boxes(surface, use, trim.domain, breaks, trim.region.boundary);
      }
      trim.boxes.back().emplace_back(first, boxes_so_far());
    }
    trim.region.loops.push_back(polyline(loops[l], breaks));
  }
  return trim;
}

}  // namespace isochor::internal
