#include "isochor/step/brep_joins.h"

#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "isochor/exact/simplest_rational.h"
#include "isochor/step/shared_trim.h"

namespace isochor::internal {
namespace {

constexpr std::array<std::pair<bool, bool>, 4> kCorners = {
    {{false, false}, {true, false}, {false, true}, {true, true}}};  // (at the end of u, of v)

std::string list(const std::vector<std::string>& items) {
  std::string text;
  for (size_t k = 0; k < items.size(); ++k) {
    text += (k == 0 ? "" : k + 1 == items.size() ? " and " : ", ") + items[k];
  }
  return text;
}

// How many pole rows, from the side inwards, the boundary curve depends on.
int support(const Patch& patch, Side side) {
  const KnotVector& knots = knots_of(patch, across_direction(side));
  const bool clamped = is_begin_side(side) ? knots.clamped_begin() : knots.clamped_end();
  if (clamped) return 1;
  const int multiplicity = knots.multiplicity(is_begin_side(side) ? knots.begin() : knots.end());
  return std::max(1, knots.degree() + 1 - multiplicity);
}

class Builder {
 public:
  Builder(BrepTable& table, const std::vector<EdgeFacts>& edges, bool shared_trims)
      : table_(table), facts_(edges), wants_trims_(shared_trims) {}

  PatchModel build();

 private:
  // A patch side that an edge runs along, or none (a trimming edge).
  struct SiteSide {
    bool found = false;
    bool whole = false;
    SideRef ref;
    SidePart part;  // of the side, where the edge runs; the default when it is whole
  };

  FaceRecord& record(int face) { return table_.faces[static_cast<size_t>(face)]; }
  const Patch& patch(int q) const { return model_.patches[static_cast<size_t>(q)]; }
  void add_patches();
  void tie_collapsed_sides();
  SiteSide side_at(const EdgeSite& site);
  void relate_edge(size_t edge);
  void relate_two(size_t edge, const EdgeSite& a, const EdgeSite& b);
  // The lock of one of two sites, caused by the other one.
  void lock_towards(size_t edge, const EdgeSite& at, const EdgeSite& other);
  void join(const SideRef& a, const SideRef& b, bool opposed);
  bool join_in_common(const SiteSide& a, const SiteSide& b, bool opposed, const std::string& bases);
  void tie_ends(const Join& join);
  SidePart part_of(const EdgeSite& site, const SideRef& ref);
  void lock_side(const SiteSide& side, const std::string& reason, Smoothness smoothness);
  void lock_side(const SideRef& side, const std::string& reason, Smoothness smoothness);
  void tie_wrapped_rows(int q, Direction direction);
  bool runs_up(const EdgeSite& site, Side side);
  void relate_corners();
  bool on_side(int face, const EdgeUse& use) const;
  void collect_corners(int face, TopTools_IndexedMapOfShape& vertices);
  void add_corner(size_t vertex, int q, bool u_end, bool v_end);
  void judge_corner(int vertex, const PointClasses& classes);
  void share_trim(size_t edge, const EdgeSite& a, const EdgeSite& b);
  void add_corners_to_trims(const TopTools_IndexedMapOfShape& vertices);

  BrepTable& table_;
  const std::vector<EdgeFacts>& facts_;
  PatchModel model_;
  std::vector<int> face_of_;                                  // of each patch
  std::map<std::pair<int, Side>, std::vector<double>> ends_;  // of parts of sides, met so far
  // Per vertex: the points the corners there depend on, those of them that are the corner, and the
  // faces that touch the vertex elsewhere.
  std::vector<std::vector<int>> corner_support_, corner_points_;
  std::vector<std::set<int>> corner_faces_, other_faces_;
  bool wants_trims_ = false;
  std::vector<size_t> trim_edges_;  // of model_.shared_trims
  std::map<int, std::vector<int>> fixed_by_vertex_;
};

void Builder::add_patches() {
  for (size_t f = 0; f < table_.faces.size(); ++f) {
    FaceRecord& face = table_.faces[f];
    if (!face.surface.surface) continue;
    const Surface& surface = *face.surface.surface;
    const auto base = static_cast<int>(model_.points.size());
    model_.points.insert(model_.points.end(), surface.poles().begin(), surface.poles().end());
    std::vector<int> points(surface.poles().size());
    std::iota(points.begin(), points.end(), base);
    face.patch = static_cast<int>(model_.patches.size());
    face_of_.push_back(static_cast<int>(f));
    model_.patches.push_back({"",
                              "face:" + std::to_string(f + 1),
                              surface.u_knots(),
                              surface.v_knots(),
                              std::move(points),
                              surface.weights(),
                              face.reversed(),
                              {},
                              face.trim.region});
  }
}

// The first and the last row of a collapsed side are one point of the B-rep.
void Builder::tie_collapsed_sides() {
  for (int q = 0; q < static_cast<int>(model_.patches.size()); ++q) {
    const FaceTrim& trim = record(face_of_[static_cast<size_t>(q)]).trim;
    for (size_t s = 0; s < kSides.size(); ++s) {
      if (!trim.sides[s].collapsed) continue;
      const auto row = side_indices(patch(q), kSides[s]);
      const int first = patch(q).point(row[0].first, row[0].second);
      for (const auto& [i, j] : row) {
        if (patch(q).point(i, j) != first) model_.ties.emplace_back(first, patch(q).point(i, j));
      }
    }
  }
}

Builder::SiteSide Builder::side_at(const EdgeSite& site) {
  const FaceRecord& face = record(site.face);
  SiteSide result;
  if (face.patch < 0) return result;
  for (size_t s = 0; s < kSides.size(); ++s) {
    const SideCover& cover = face.trim.sides[s];
    if (!cover.covered || cover.collapsed) continue;
    for (const UseRef& use : cover.uses) {
      if (use.loop != site.loop || use.use != site.use) continue;
      result = {true, cover.whole(), {face.patch, kSides[s]}, {}};
      if (!result.whole) result.part = part_of(site, result.ref);
      return result;
    }
  }
  return result;
}

// The running parameters of an edge's ends. Ends of edges that follow each other must be the same
// number: they snap to knots, else to the simplest fraction of the domain within rounding.
SidePart Builder::part_of(const EdgeSite& site, const SideRef& ref) {
  const EdgeUse& use = table_.use(site);
  const KnotVector& knots = knots_of(patch(ref.patch), running_direction(ref.side));
  const double length = knots.end() - knots.begin();
  const auto snapped = [&](const gp_Pnt2d& at) {
    const double t = is_u_side(ref.side) ? at.Y() : at.X();
    for (double knot : knots.breaks()) {
      if (std::abs(t - knot) <= kSideNoise * length) return knot;
    }
    std::vector<double>& known = ends_[{ref.patch, ref.side}];
    for (double end : known) {
      if (std::abs(t - end) <= kSideNoise * length) return end;
    }
    const Rational share((t - knots.begin()) / length);
    const Rational noise(kSameKnot);
    const Rational simple = simplest_between(share - noise, share + noise);
    known.push_back((Rational(knots.begin()) + simple * Rational(length)).to_double());
    return known.back();
  };
  const double a = snapped(use.curve->Value(use.first));
  const double b = snapped(use.curve->Value(use.last));
  return {std::min(a, b), std::max(a, b)};
}

void Builder::lock_side(const SiteSide& side, const std::string& reason, Smoothness smoothness) {
  model_.locked_sides.push_back({side.ref, reason, smoothness, side.part});
}

void Builder::lock_side(const SideRef& side, const std::string& reason, Smoothness smoothness) {
  model_.locked_sides.push_back({side, reason, smoothness, {}});
}

// The seam of a periodic direction: pole rows i and i + N are the same rows.
void Builder::tie_wrapped_rows(int q, Direction direction) {
  const int wrapped = wrapped_poles(knots_of(patch(q), direction));
  const Side begin = direction == Direction::kU ? Side::kUBegin : Side::kVBegin;
  const Side end = direction == Direction::kU ? Side::kUEnd : Side::kVEnd;
  std::vector<std::pair<int, int>> ties;
  for (int row = 0; row < wrapped; ++row) {
    const auto first = side_indices(patch(q), begin, row);
    const auto last = side_indices(patch(q), end, wrapped - 1 - row);
    for (size_t k = 0; k < first.size(); ++k) {
      const int a = patch(q).point(first[k].first, first[k].second);
      const int b = patch(q).point(last[k].first, last[k].second);
      const Vec3 gap =
          model_.points[static_cast<size_t>(a)] - model_.points[static_cast<size_t>(b)];
      if (gap.norm() > kCoincident * table_.diagonal) return;  // unclamped, but not periodic
      ties.emplace_back(a, b);
    }
  }
  model_.ties.insert(model_.ties.end(), ties.begin(), ties.end());
}

// True when the running parameter of the side grows with the parameter of the edge.
bool Builder::runs_up(const EdgeSite& site, Side side) {
  const EdgeUse& use = table_.use(site);
  const gp_Pnt2d a = use.curve->Value(use.first);
  const gp_Pnt2d b = use.curve->Value(use.last);
  return is_u_side(side) ? b.Y() > a.Y() : b.X() > a.X();
}

void Builder::join(const SideRef& a, const SideRef& b, bool opposed) {
  const bool seam = a.patch == b.patch && is_u_side(a.side) == is_u_side(b.side) && !opposed;
  if (seam) tie_wrapped_rows(a.patch, across_direction(a.side));
  Join join = measure_join(model_, a, b, opposed);
  const bool wraps = support(patch(a.patch), a.side) > 1 || support(patch(b.patch), b.side) > 1;
  if (join.matching && !wraps) {
    const auto row_a = side_indices(patch(a.patch), a.side);
    auto row_b = side_indices(patch(b.patch), b.side);
    if (opposed) std::reverse(row_b.begin(), row_b.end());
    for (size_t k = 0; k < row_a.size(); ++k) {
      const int p = patch(a.patch).point(row_a[k].first, row_a[k].second);
      const int q = patch(b.patch).point(row_b[k].first, row_b[k].second);
      if (p != q) model_.ties.emplace_back(p, q);
    }
  }
  if (!join.matching && !wraps &&
      join_in_common({true, true, a, {}}, {true, true, b, {}}, opposed, join.mismatch)) {
    return;
  }
  if (!join.matching) {
    const auto reason = [&](const SideRef& other) {
      return "does not match side " + std::string(name_of(other.side)) + " of " +
             patch(other.patch).handle + ": " + join.mismatch;
    };
    lock_side(a, reason(b), join.smoothness);
    lock_side(b, reason(a), join.smoothness);
  }
  model_.joins.push_back(std::move(join));
}

// Ties the poles at both ends of a join, where those are ends of both sides.
void Builder::tie_ends(const Join& join) {
  const auto end_point = [&](const SideRef& ref, const SidePart& part, bool last) {
    const KnotVector& knots = knots_of(patch(ref.patch), running_direction(ref.side));
    const bool at_end =
        part.whole() || (last ? part.to == knots.end() : part.from == knots.begin());
    const bool clamped = last ? knots.clamped_end() : knots.clamped_begin();
    if (!at_end || !clamped) return -1;
    const auto row = side_indices(patch(ref.patch), ref.side);
    const auto& [i, j] = last ? row.back() : row.front();
    return patch(ref.patch).point(i, j);
  };
  for (bool last : {false, true}) {
    const int p = end_point(join.a, join.part_a, last);
    const int q = end_point(join.b, join.part_b, last != join.opposed);
    if (p >= 0 && q >= 0 && p != q) model_.ties.emplace_back(p, q);
  }
}

// `bases`: how the two sides differ, in words. False when they do not carry one curve.
bool Builder::join_in_common(const SiteSide& a, const SiteSide& b, bool opposed,
                             const std::string& bases) {
  if (a.ref == b.ref) return false;
  Join join = measure_common_join(model_, model_.points, a.ref, a.part, b.ref, b.part, opposed);
  if (!join.common) return false;
  join.mismatch = bases;
  tie_ends(join);
  model_.joins.push_back(std::move(join));
  return true;
}

void Builder::lock_towards(size_t edge, const EdgeSite& at, const EdgeSite& other) {
  const SiteSide side = side_at(at);
  if (!side.found) return;  // a trimming edge: the trim locks what it touches
  const SiteSide theirs = side_at(other);
  const std::string name = table_.label(other.face);
  const Smoothness smoothness = facts_[edge].smoothness;
  if (record(other.face).patch < 0) {
    lock_side(side, "shares an edge with " + name + ", which is not edited", smoothness);
  } else if (!theirs.found) {
    lock_side(side, "meets the trimmed edge of " + name, smoothness);
  } else if (!theirs.whole) {
    lock_side(side, "meets only a part of a side of " + name + ", which runs otherwise",
              smoothness);
  } else {
    lock_side(side, "is shared by several faces, among them " + name, smoothness);
  }
}

void Builder::relate_two(size_t edge, const EdgeSite& a, const EdgeSite& b) {
  const SiteSide side_a = side_at(a);
  const SiteSide side_b = side_at(b);
  if (side_a.whole && side_b.whole) {
    if (side_a.ref == side_b.ref) {
      lock_side(side_a.ref, "is folded onto itself", facts_[edge].smoothness);
    } else {
      join(side_a.ref, side_b.ref, runs_up(a, side_a.ref.side) != runs_up(b, side_b.ref.side));
    }
    return;
  }
  if (side_a.found && side_b.found) {
    const bool opposed = runs_up(a, side_a.ref.side) != runs_up(b, side_b.ref.side);
    if (join_in_common(side_a, side_b, opposed, "a part of a side")) return;
  }
  const bool trims = !side_a.found || !side_b.found;
  if (wants_trims_ && trims) {
    share_trim(edge, a, b);
  } else {
    lock_towards(edge, a, b);
    lock_towards(edge, b, a);
  }
}

// Locks both sides of a trimming edge. Of two patches, remembers what an edit may release.
void Builder::share_trim(size_t edge, const EdgeSite& a, const EdgeSite& b) {
  const std::array<EdgeSite, 2> sites{a, b};
  SharedTrim trim;
  for (size_t k = 0; k < 2; ++k) {
    const auto known = static_cast<int>(model_.locked_sides.size());
    lock_towards(edge, sites[k], sites[1 - k]);
    if (static_cast<int>(model_.locked_sides.size()) > known) trim.locked_sides[k] = known;
    trim.patches[k] = record(sites[k].face).patch;
  }
  if (trim.patches[0] < 0 || trim.patches[1] < 0 || trim.patches[0] == trim.patches[1]) return;
  trim.smoothness = facts_[edge].smoothness;
  trace_shared_trim(table_, sites, trim);
  if (trim.along[0].empty() || trim.along[1].empty()) return;  // a face without its curve
  model_.shared_trims.push_back(std::move(trim));
  trim_edges_.push_back(edge);
}

// A corner that no patch but the two of a trim touches moves with the trim.
void Builder::add_corners_to_trims(const TopTools_IndexedMapOfShape& vertices) {
  for (size_t t = 0; t < model_.shared_trims.size(); ++t) {
    SharedTrim& trim = model_.shared_trims[t];
    TopoDS_Vertex ends[2];
    TopExp::Vertices(table_.edges[trim_edges_[t]].edge, ends[0], ends[1]);
    for (const TopoDS_Vertex& end : ends) {
      const int vertex = end.IsNull() ? -1 : vertices.FindIndex(end) - 1;
      if (fixed_by_vertex_.count(vertex) == 0) continue;
      std::set<int> faces = corner_faces_[static_cast<size_t>(vertex)];
      faces.merge(std::set<int>(other_faces_[static_cast<size_t>(vertex)]));
      const bool only_these = std::all_of(faces.begin(), faces.end(), [&](int face) {
        const int q = record(face).patch;
        return q >= 0 && (q == trim.patches[0] || q == trim.patches[1]);
      });
      const auto& points = fixed_by_vertex_[vertex];
      if (only_these) trim.corners.insert(trim.corners.end(), points.begin(), points.end());
    }
  }
}

void Builder::relate_edge(size_t edge) {
  const EdgeRecord& entry = table_.edges[edge];
  if (facts_[edge].degenerated) return;
  if (entry.sites.size() == 2) {
    relate_two(edge, entry.sites[0], entry.sites[1]);
    return;
  }
  for (const EdgeSite& site : entry.sites) {
    const SiteSide side = side_at(site);
    if (!side.found) continue;
    if (entry.sites.size() > 2) {
      std::vector<std::string> names;
      for (const EdgeSite& other : entry.sites) names.push_back(table_.label(other.face));
      lock_side(side, "is an edge of more than two faces: " + list(names), Smoothness::kSharp);
    } else if (!side.whole) {
      lock_side(side, "is cut into several edges", Smoothness::kSharp);
    }
  }
}

// Whether a use starts on a side of a patch: the edges before and after it, parts of that side, are
// tied or locked then, and with them the vertex.
bool Builder::on_side(int face, const EdgeUse& use) const {
  const FaceRecord& entry = table_.faces[static_cast<size_t>(face)];
  if (entry.patch < 0) return false;
  for (const SideCover& cover : entry.trim.sides) {
    if (!cover.covered || cover.collapsed) continue;
    for (const UseRef& ref : cover.uses) {
      if (&entry.loops[static_cast<size_t>(ref.loop)].uses[static_cast<size_t>(ref.use)] == &use) {
        return true;
      }
    }
  }
  return false;
}

// Finds out, for each vertex of a face, whether it is a corner of the patch.
void Builder::collect_corners(int face, TopTools_IndexedMapOfShape& vertices) {
  const FaceRecord& entry = record(face);
  const UvBox& box = entry.trim.domain;
  for (const FaceLoop& loop : entry.loops) {
    for (const EdgeUse& use : loop.uses) {
      const TopoDS_Vertex vertex = TopExp::FirstVertex(use.edge, Standard_True);
      if (vertex.IsNull()) continue;
      const auto index = static_cast<size_t>(vertices.Add(vertex)) - 1;
      if (index >= corner_points_.size()) {
        corner_points_.resize(index + 1);
        corner_support_.resize(index + 1);
        corner_faces_.resize(index + 1);
        other_faces_.resize(index + 1);
      }
      bool at_corner = false;
      for (const auto& [u_end, v_end] : kCorners) {
        if (entry.patch < 0 || use.curve.IsNull()) break;
        const gp_Pnt2d at = use.start();
        const double u = u_end ? box.u_max : box.u_min;
        const double v = v_end ? box.v_max : box.v_min;
        if (std::abs(at.X() - u) > kSideSlack * (box.u_max - box.u_min) ||
            std::abs(at.Y() - v) > kSideSlack * (box.v_max - box.v_min)) {
          continue;
        }
        const double limit =
            std::max(2.0 * BRep_Tool::Tolerance(vertex), kSideDistance * table_.diagonal);
        const gp_Pnt here = entry.surface.geometry->Value(at.X(), at.Y());
        if (here.Distance(entry.surface.geometry->Value(u, v)) > limit) continue;
        add_corner(index, entry.patch, u_end, v_end);
        at_corner = true;
      }
      if (at_corner) {
        corner_faces_[index].insert(face);
      } else if (!on_side(face, use)) {
        other_faces_[index].insert(face);
      }
    }
  }
}

void Builder::add_corner(size_t vertex, int q, bool u_end, bool v_end) {
  const Patch& p = patch(q);
  const int rows = support(p, u_end ? Side::kUEnd : Side::kUBegin);
  const int columns = support(p, v_end ? Side::kVEnd : Side::kVBegin);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int point = p.point(u_end ? p.u_size() - 1 - i : i, v_end ? p.v_size() - 1 - j : j);
      corner_support_[vertex].push_back(point);
      if (rows == 1 && columns == 1) corner_points_[vertex].push_back(point);
    }
  }
}

void Builder::judge_corner(int vertex, const PointClasses& classes) {
  const auto& points = corner_points_[static_cast<size_t>(vertex)];
  const auto& support = corner_support_[static_cast<size_t>(vertex)];
  if (support.empty()) return;
  std::vector<std::string> fixed, passing;
  for (int face : other_faces_[static_cast<size_t>(vertex)]) {
    (record(face).patch < 0 ? fixed : passing).push_back(table_.label(face));
  }
  std::string reason;
  if (!fixed.empty()) {
    reason = "a corner shared with " + list(fixed) + ", which " +
             (fixed.size() == 1 ? "is" : "are") + " not edited";
  } else if (!passing.empty()) {
    reason = "a corner on the boundary of " + list(passing);
  } else {
    const auto one_class = [&](int point) {
      return classes.class_of[static_cast<size_t>(point)] ==
             classes.class_of[static_cast<size_t>(points.front())];
    };
    if (std::all_of(points.begin(), points.end(), one_class)) return;
    reason = "a corner where faces meet that do not move together";
  }
  for (int point : std::set<int>(support.begin(), support.end())) {
    fixed_by_vertex_[vertex].push_back(static_cast<int>(model_.fixed_points.size()));
    model_.fixed_points.emplace_back(point, reason);
  }
}

void Builder::relate_corners() {
  TopTools_IndexedMapOfShape vertices;
  for (size_t f = 0; f < table_.faces.size(); ++f) collect_corners(static_cast<int>(f), vertices);
  const PointClasses classes = point_classes(model_);
  for (size_t v = 0; v < corner_points_.size(); ++v) judge_corner(static_cast<int>(v), classes);
  add_corners_to_trims(vertices);
}

PatchModel Builder::build() {
  add_patches();
  tie_collapsed_sides();
  for (size_t e = 0; e < table_.edges.size(); ++e) relate_edge(e);
  relate_corners();
  derive_locks(model_);
  return std::move(model_);
}

}  // namespace

PatchModel patch_model(BrepTable& table, const std::vector<EdgeFacts>& edges, bool shared_trims) {
  return Builder(table, edges, shared_trims).build();
}

}  // namespace isochor::internal
