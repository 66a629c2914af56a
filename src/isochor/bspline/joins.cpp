#include "isochor/bspline/joins.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/surface_derivatives.h"

namespace isochor {
namespace {

// Points per span of a side where a join is measured, as fractions of the span.
constexpr double kFractions[] = {0.0, 0.25, 0.5, 0.75, 1.0};

std::string number(double value) {
  std::ostringstream text;
  text.precision(8);
  text << value;
  return text.str();
}

const Patch& patch_of(const PatchModel& model, const SideRef& ref) {
  return model.patches[static_cast<size_t>(ref.patch)];
}

// A side of a surface as a curve with its surroundings.
class SideCurve {
 public:
  SideCurve(const Surface& surface, Side side, double sign)
      : surface_(surface), side_(side), sign_(sign), breaks_(knots().breaks()) {
    const KnotVector& across = knots_of(surface, across_direction(side));
    fixed_ = is_begin_side(side) ? internal::basis_at(across, across.begin(), 2, Limit::kFromAbove)
                                 : internal::basis_at(across, across.end(), 2, Limit::kFromBelow);
  }

  const KnotVector& knots() const { return knots_of(surface_, running_direction(side_)); }
  double length() const { return knots().end() - knots().begin(); }

  SurfaceDerivatives at(double t, int order, Limit limit) const {
    const BasisValues running = internal::basis_at(knots(), t, order, limit);
    return is_u_side(side_) ? internal::derivatives_from(surface_, fixed_, running, order)
                            : internal::derivatives_from(surface_, running, fixed_, order);
  }
  Vec3 point(double t) const { return at(t, 0, Limit::kFromAbove).s; }
  Vec3 tangent(const SurfaceDerivatives& d) const { return is_u_side(side_) ? d.sv : d.su; }

  CurveFrame frame(double t, Limit limit, double size) const {
    const KnotVector& u = surface_.u_knots();
    const KnotVector& v = surface_.v_knots();
    return curve_frame(at(t, 2, limit), !is_u_side(side_), sign_, size, u.end() - u.begin(),
                       v.end() - v.begin());
  }

  // The parameter for the share r in [0, 1] of the domain.
  double parameter(double r) const { return on_knot(knots().begin() + r * length()); }

  // The knot that is within rounding of t, so that one-sided limits pick the intended span; else t.
  double on_knot(double t) const {
    for (double knot : breaks_) {
      if (std::abs(t - knot) <= kSameSide * length()) return knot;
    }
    return t;
  }

 private:
  const Surface& surface_;
  Side side_;
  double sign_;
  std::vector<double> breaks_;
  BasisValues fixed_;  // across the side
};

// Finds the parameter of a curve's point nearest to a given one: samples, then descent inside the
// intervals between them. Every interval that may come nearer is looked at, because another part of
// the curve can have the nearest sample; an interval never holds a knot, because beyond a crease
// the tangent is another one.
class NearestOnCurve {
 public:
  explicit NearestOnCurve(const SideCurve& curve) : curve_(curve) {
    const KnotVector& knots = curve.knots();
    const int per_span = 2 * knots.degree() + 2;
    add(knots.begin());
    for (int k : knots.spans()) {
      for (int i = 1; i < per_span; ++i) add(knots[k] + (knots[k + 1] - knots[k]) * i / per_span);
      add(knots[k + 1]);
    }
  }

  // `hint`: a parameter worth trying, such as the same share of the domain.
  double parameter(const Vec3& p, double hint) const {
    std::vector<double> distance;
    for (const Vec3& point : points_) distance.push_back((point - p).norm());
    const auto nearest = std::min_element(distance.begin(), distance.end());
    Candidate best{at_[static_cast<size_t>(nearest - distance.begin())], *nearest};
    const Candidate hinted = at(hint, p);
    if (hinted.distance <= best.distance) best = hinted;
    // An arc between two samples is taken to be at most twice as long as its chord.
    std::vector<std::pair<double, size_t>> intervals;
    for (size_t i = 0; i + 1 < at_.size(); ++i) {
      const double reach = 2.0 * (points_[i + 1] - points_[i]).norm();
      const double at_least = std::max(distance[i], distance[i + 1]) - reach;
      if (at_least < best.distance) intervals.emplace_back(at_least, i);
    }
    std::sort(intervals.begin(), intervals.end());
    for (const auto& [at_least, i] : intervals) {
      if (at_least >= best.distance) break;
      const Candidate found = descend(p, at_[i], at_[i + 1]);
      if (found.distance < best.distance) best = found;
    }
    return curve_.on_knot(best.t);
  }

 private:
  struct Candidate {
    double t, distance;
  };

  void add(double t) {
    at_.push_back(t);
    points_.push_back(curve_.point(t));
  }

  Candidate at(double t, const Vec3& p) const { return {t, (curve_.point(t) - p).norm()}; }

  // Newton's method on the tangent, with steps halved until they bring the point nearer.
  Candidate descend(const Vec3& p, double low, double high) const {
    Candidate best = at(0.5 * (low + high), p);
    for (double end : {low, high}) {
      const Candidate other = at(end, p);
      if (other.distance < best.distance) best = other;
    }
    for (int round = 0; round < 30; ++round) {
      const SurfaceDerivatives d =
          curve_.at(best.t, 1, best.t < high ? Limit::kFromAbove : Limit::kFromBelow);
      const Vec3 tangent = curve_.tangent(d);
      const double speed2 = tangent.squaredNorm();
      if (!(speed2 > 0.0)) return best;
      double step = (p - d.s).dot(tangent) / speed2;
      Candidate next = at(std::clamp(best.t + step, low, high), p);
      for (int halving = 0; halving < 8 && !(next.distance < best.distance); ++halving) {
        step *= 0.5;
        next = at(std::clamp(best.t + step, low, high), p);
      }
      if (!(next.distance < best.distance)) return best;
      best = next;
    }
    return best;
  }

  const SideCurve& curve_;
  std::vector<double> at_;
  std::vector<Vec3> points_;
};

struct SamplePair {
  double a, b;
  Limit limit_a, limit_b;
};

// Corresponding parameters along two sides: several for each span of `a`.
std::vector<SamplePair> sample_pairs(const SideCurve& a, const SideCurve& b, bool opposed,
                                     bool matching) {
  std::vector<SamplePair> pairs;
  std::optional<NearestOnCurve> nearest;
  if (!matching) nearest.emplace(b);
  const KnotVector& knots = a.knots();
  for (int k : knots.spans()) {
    for (double f : kFractions) {
      const double t = f == 1.0 ? knots[k + 1] : knots[k] + f * (knots[k + 1] - knots[k]);
      const Limit limit = f == 1.0 ? Limit::kFromBelow : Limit::kFromAbove;
      const Limit swapped = f == 1.0 ? Limit::kFromAbove : Limit::kFromBelow;
      const double share = (t - knots.begin()) / a.length();
      const double same_share = b.parameter(opposed ? 1.0 - share : share);
      const double there = matching ? same_share : nearest->parameter(a.point(t), same_share);
      pairs.push_back({t, there, limit, opposed ? swapped : limit});
    }
  }
  return pairs;
}

std::vector<int> row_classes(const Patch& patch, Side side, const PointClasses& classes,
                             int depth = 0) {
  std::vector<int> row;
  for (const auto& [i, j] : side_indices(patch, side, depth)) {
    row.push_back(classes.class_of[static_cast<size_t>(patch.point(i, j))]);
  }
  return row;
}

std::vector<double> row_weights(const Patch& patch, Side side) {
  std::vector<double> row;
  for (const auto& [i, j] : side_indices(patch, side)) {
    row.push_back(
        patch.weights.empty() ? 1.0 : patch.weights[static_cast<size_t>(i) * patch.v_size() + j]);
  }
  return row;
}

// Why two sides carry different bases, in words; empty when they carry the same one.
std::string basis_mismatch(const Patch& pa, Side a, const Patch& pb, Side b, bool opposed) {
  const KnotVector& ka = knots_of(pa, running_direction(a));
  const KnotVector& kb = knots_of(pb, running_direction(b));
  if (ka.degree() != kb.degree()) {
    return "degree " + std::to_string(ka.degree()) + " against " + std::to_string(kb.degree());
  }
  if (ka.size() != kb.size()) {
    return std::to_string(ka.size()) + " poles against " + std::to_string(kb.size());
  }
  const int count = static_cast<int>(ka.knots().size());
  for (int i = 0; i < count; ++i) {
    const double first = (ka[i] - ka.begin()) / (ka.end() - ka.begin());
    const double there = (kb[opposed ? count - 1 - i : i] - kb.begin()) / (kb.end() - kb.begin());
    const double second = opposed ? 1.0 - there : there;
    if (std::abs(first - second) > kSameSide) {
      return "knot " + number(first) + " against " + number(second) + " (mapped to [0, 1])";
    }
  }
  const std::vector<double> wa = row_weights(pa, a);
  std::vector<double> wb = row_weights(pb, b);
  if (opposed) std::reverse(wb.begin(), wb.end());
  const double ratio = wa.front() / wb.front();
  for (size_t i = 0; i < wa.size(); ++i) {
    if (std::abs(wa[i] - ratio * wb[i]) > kSameSide * wa[i]) {
      return "weight " + number(wa[i]) + " against " + number(ratio * wb[i]) +
             " (scaled to agree at the first pole)";
    }
  }
  return {};
}

bool clamped_at(const Patch& patch, Side side) {
  const KnotVector& across = knots_of(patch, across_direction(side));
  return is_begin_side(side) ? across.clamped_begin() : across.clamped_end();
}

// Why tying poles one to one is not right for this join; empty when it is.
std::string mismatch_of(const PatchModel& model, const std::vector<Vec3>& at,
                        const PointClasses& classes, const SideRef& a, const SideRef& b,
                        bool opposed, double size) {
  const Patch& pa = patch_of(model, a);
  const Patch& pb = patch_of(model, b);
  Join join;
  join.a = a;
  join.b = b;
  join.opposed = opposed;
  if (is_wrap(model, join, classes)) return {};
  for (const SideRef& ref : {a, b}) {
    if (!clamped_at(patch_of(model, ref), ref.side)) {
      return "the knots of " + label_of(model, ref) + " are not clamped";
    }
  }
  const std::string basis = basis_mismatch(pa, a.side, pb, b.side, opposed);
  if (!basis.empty()) return basis;
  std::vector<std::pair<int, int>> row_a = side_indices(pa, a.side);
  std::vector<std::pair<int, int>> row_b = side_indices(pb, b.side);
  if (opposed) std::reverse(row_b.begin(), row_b.end());
  double apart = 0.0;
  for (size_t i = 0; i < row_a.size(); ++i) {
    const auto p = static_cast<size_t>(pa.point(row_a[i].first, row_a[i].second));
    const auto q = static_cast<size_t>(pb.point(row_b[i].first, row_b[i].second));
    if (classes.class_of[p] != classes.class_of[q]) apart = std::max(apart, (at[p] - at[q]).norm());
  }
  if (apart > kCoincident * size) return "the poles lie up to " + number(apart) + " apart";
  return {};
}

Join measure(const PatchModel& model, const std::vector<Vec3>& at, const PointClasses& classes,
             double size, const SideRef& a, const SideRef& b, bool opposed) {
  const Surface surface_a = model.surface(a.patch, at);
  const Surface surface_b = model.surface(b.patch, at);
  const SideCurve curve_a(surface_a, a.side, patch_of(model, a).sign());
  const SideCurve curve_b(surface_b, b.side, patch_of(model, b).sign());
  Join join;
  join.a = a;
  join.b = b;
  join.opposed = opposed;
  join.mismatch = mismatch_of(model, at, classes, a, b, opposed, size);
  join.matching = join.mismatch.empty();
  bool any_regular = false;
  const auto take = [&](const SideCurve& first, const SideCurve& second, const SamplePair& pair) {
    join.max_gap = std::max(
        join.max_gap,
        (first.at(pair.a, 0, pair.limit_a).s - second.at(pair.b, 0, pair.limit_b).s).norm());
    const CurveFrame fa = first.frame(pair.a, pair.limit_a, size);
    const CurveFrame fb = second.frame(pair.b, pair.limit_b, size);
    if (!fa.regular || !fb.regular) return;
    any_regular = true;
    join.max_angle_rad = std::max(join.max_angle_rad, angle_between(fa.normal, fb.normal));
    join.max_curvature_jump =
        std::max(join.max_curvature_jump, std::abs(fa.curvature - fb.curvature));
  };
  for (const SamplePair& pair : sample_pairs(curve_a, curve_b, opposed, join.matching)) {
    take(curve_a, curve_b, pair);
  }
  if (!join.matching) {
    for (const SamplePair& pair : sample_pairs(curve_b, curve_a, opposed, false)) {
      take(curve_b, curve_a, pair);
    }
  }
  join.smoothness = any_regular
                        ? classify_smoothness(join.max_angle_rad, join.max_curvature_jump, size)
                        : Smoothness::kSharp;
  return join;
}

}  // namespace

std::string label_of(const Patch& patch) {
  return patch.handle + (patch.name.empty() ? "" : " (\"" + patch.name + "\")");
}

std::string label_of(const PatchModel& model, const SideRef& side) {
  return std::string("side ") + name_of(side.side) + " of " + label_of(patch_of(model, side));
}

int wrapped_rows(const Patch& patch, Direction direction, const PointClasses& classes) {
  const int wrapped = wrapped_poles(knots_of(patch, direction));
  const Side begin = direction == Direction::kU ? Side::kUBegin : Side::kVBegin;
  const Side end = direction == Direction::kU ? Side::kUEnd : Side::kVEnd;
  for (int row = 0; row < wrapped; ++row) {
    if (row_classes(patch, begin, classes, row) !=
        row_classes(patch, end, classes, wrapped - 1 - row)) {
      return 0;
    }
  }
  return wrapped;
}

bool is_collapsed(const Patch& patch, Side side, const PointClasses& classes) {
  const std::vector<int> row = row_classes(patch, side, classes);
  return std::all_of(row.begin(), row.end(), [&](int id) { return id == row.front(); });
}

bool is_wrap(const PatchModel& model, const Join& join, const PointClasses& classes) {
  return join.a.patch == join.b.patch && !join.opposed &&
         is_u_side(join.a.side) == is_u_side(join.b.side) && !(join.a == join.b) &&
         wrapped_rows(patch_of(model, join.a), across_direction(join.a.side), classes) > 0;
}

std::vector<Join> find_joins(const PatchModel& model) {
  const PointClasses classes = point_classes(model);
  const double size = diagonal(model);
  struct Used {
    SideRef ref;
    bool flipped;  // the stored row is the reverse of the side's own direction
  };
  std::map<std::vector<int>, std::vector<Used>> sides_on;
  std::vector<Join> joins;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    const bool wraps_u = wrapped_rows(patch, Direction::kU, classes) > 0;
    const bool wraps_v = wrapped_rows(patch, Direction::kV, classes) > 0;
    if (wraps_u) {
      joins.push_back(
          measure(model, model.points, classes, size, {q, Side::kUBegin}, {q, Side::kUEnd}, false));
    }
    if (wraps_v) {
      joins.push_back(
          measure(model, model.points, classes, size, {q, Side::kVBegin}, {q, Side::kVEnd}, false));
    }
    for (Side side : kSides) {
      if ((is_u_side(side) ? wraps_u : wraps_v) || is_collapsed(patch, side, classes)) continue;
      std::vector<int> row = row_classes(patch, side, classes);
      std::vector<int> reverse(row.rbegin(), row.rend());
      const bool flipped = reverse < row;
      auto& known = sides_on[flipped ? reverse : row];
      for (const Used& other : known) {
        joins.push_back(measure(model, model.points, classes, size, other.ref, {q, side},
                                other.flipped != flipped));
      }
      known.push_back({{q, side}, flipped});
    }
  }
  return joins;
}

Join measure_join(const PatchModel& model, const SideRef& a, const SideRef& b, bool opposed) {
  return measure(model, model.points, point_classes(model), diagonal(model), a, b, opposed);
}

Join measure_join(const PatchModel& model, const std::vector<Vec3>& at, const SideRef& a,
                  const SideRef& b, bool opposed) {
  return measure(model, at, point_classes(model), diagonal(model), a, b, opposed);
}

Join measure_join(const PatchModel& model, double size, const SideRef& a, const SideRef& b,
                  bool opposed) {
  return measure(model, model.points, point_classes(model), size, a, b, opposed);
}

double join_gap(const PatchModel& model, const std::vector<Vec3>& at, const Join& join) {
  if (join.common) return measure_join(model, at, join).max_gap;
  const Surface surface_a = model.surface(join.a.patch, at);
  const Surface surface_b = model.surface(join.b.patch, at);
  const SideCurve a(surface_a, join.a.side, 1.0);
  const SideCurve b(surface_b, join.b.side, 1.0);
  double gap = 0.0;
  for (const SamplePair& pair : sample_pairs(a, b, join.opposed, join.matching)) {
    gap = std::max(gap, (a.at(pair.a, 0, pair.limit_a).s - b.at(pair.b, 0, pair.limit_b).s).norm());
  }
  return gap;
}

namespace {

// +1 when the side's running direction is the counter-clockwise sense of the patch's boundary, seen
// from outside.
int sense_of(const Patch& patch, Side side) {
  const bool along = side == Side::kVBegin || side == Side::kUEnd;
  return (along ? 1 : -1) * (patch.reversed ? -1 : 1);
}

// True when the side is glued to itself end against end (a zip), point class by point class.
bool folded_onto_itself(const Patch& patch, Side side, const PointClasses& classes) {
  const std::vector<int> row = row_classes(patch, side, classes);
  return std::equal(row.begin(), row.end(), row.rbegin()) &&
         basis_mismatch(patch, side, patch, side, true).empty();
}

// Twice the vector area under a side, by chords; both sides of a matching join give the same
// chords.
Vec3 chord_area(const SideCurve& curve) {
  constexpr int kChords = 16;
  Vec3 sum = Vec3::Zero();
  Vec3 last = curve.point(curve.knots().begin());
  for (int k : curve.knots().spans()) {
    const double low = curve.knots()[k];
    const double high = curve.knots()[k + 1];
    for (int i = 1; i <= kChords; ++i) {
      const Vec3 next = curve.point(i == kChords ? high : low + (high - low) * i / kChords);
      sum += last.cross(next);
      last = next;
    }
  }
  return sum;
}

double relative_vector_area(const PatchModel& model) {
  const double size = diagonal(model);
  if (!(size > 0.0)) return 0.0;
  Vec3 sum = Vec3::Zero();
  // Close to the origin, so that the cross products do not lose the digits of a far-off model.
  std::vector<Vec3> at = model.points;
  const Vec3 shift = model.points.front();
  for (Vec3& p : at) p = (p - shift) / size;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Surface surface = model.surface(q, at);
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    for (Side side : kSides) {
      sum += 0.5 * sense_of(patch, side) * chord_area(SideCurve(surface, side, 1.0));
    }
  }
  return sum.norm();
}

}  // namespace

Closure closure(const PatchModel& model) {
  const PointClasses classes = point_classes(model);
  const std::vector<Join> joins = model.joins.empty() ? find_joins(model) : model.joins;
  std::map<std::pair<int, Side>, int> uses;
  Closure result;
  for (const Join& join : joins) {
    for (const auto& [ref, part] : {std::pair(join.a, join.part_a), {join.b, join.part_b}}) {
      int& count = uses[{ref.patch, ref.side}];
      count = part.whole() ? count + 1 : std::max(count, 1);
    }
    const int senses = sense_of(patch_of(model, join.a), join.a.side) *
                       sense_of(patch_of(model, join.b), join.b.side) * (join.opposed ? -1 : 1);
    if (senses > 0) {
      result.misoriented_sides.push_back(label_of(model, join.a) + " and " +
                                         label_of(model, join.b) + " run the same way");
    }
  }
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    for (Side side : kSides) {
      const int count = uses[{q, side}];
      if (count > 1) result.overused_sides.push_back(label_of(model, {q, side}));
      if (count == 0 && !is_collapsed(patch, side, classes) &&
          !folded_onto_itself(patch, side, classes)) {
        result.open_sides.push_back(label_of(model, {q, side}));
        result.open.push_back({q, side});
      }
    }
  }
  result.closed = !model.patches.empty() && result.open_sides.empty() &&
                  result.overused_sides.empty() && result.misoriented_sides.empty();
  result.vector_area = relative_vector_area(model);
  return result;
}

}  // namespace isochor
