#include "isochor/bspline/smooth_relations.h"

#include <algorithm>
#include <set>
#include <utility>

#include "isochor/bspline/common_basis.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/line_strips.h"
#include "isochor/bspline/measured_lines.h"
#include "isochor/bspline/pole_rows.h"

namespace isochor {
namespace {

using internal::Line;

const Patch& patch_of(const PatchModel& model, int q) {
  return model.patches[static_cast<size_t>(q)];
}

// "smoothly (G1)".
std::string smoothly(int order) { return order == 2 ? "smoothly (G2)" : "smoothly (G1)"; }

// Collects the relations that fit, with the factors they share.
class RelationFinder {
 public:
  RelationFinder(const PatchModel& model, const internal::MeasuredLines& lines)
      : model_(model), lines_(lines), classes_(point_classes(model)) {}

  std::vector<SmoothRelation> run() {
    for (size_t k = 0; k < model_.joins.size(); ++k) {
      if (is_wrap(model_, model_.joins[k], classes_)) {
        add_wrap(static_cast<int>(k));
      } else {
        add_join(static_cast<int>(k));
      }
    }
    for (int q = 0; q < static_cast<int>(model_.patches.size()); ++q) {
      add_knot_lines(q, Direction::kU);
      add_knot_lines(q, Direction::kV);
    }
    for (SmoothRelation& pole : internal::pole_relations(model_)) {
      relations_.push_back(std::move(pole));
    }
    return std::move(relations_);
  }

 private:
  void add(SmoothRelation relation, const Line& line) {
    if (internal::fit_relation(model_, line, &relation, &factors_)) {
      relations_.push_back(std::move(relation));
    }
  }

  // The two sides of a join in different bases move as one curve.
  void add_tie(int k) {
    const Join& join = model_.joins[static_cast<size_t>(k)];
    SmoothRelation relation;
    relation.kind = SmoothRelation::Kind::kTie;
    relation.join = k;
    relation.sides = {join.a, join.b};
    relation.order = 0;
    relation.lambda = Rational();
    relation.text = label_of(patch_of(model_, join.a.patch)) + " and " +
                    label_of(patch_of(model_, join.b.patch)) +
                    " share an edge in different bases, tied in a common one";
    const auto boundary = [&](const SideRef& ref) {
      return is_begin_side(ref.side)
                 ? 0
                 : knots_of(patch_of(model_, ref.patch), across_direction(ref.side)).size() - 1;
    };
    relation.equations = {
        {{{0, boundary(join.a), Rational(1)}, {1, boundary(join.b), Rational(-1)}}}};
    relations_.push_back(std::move(relation));
  }

  void add_join(int k) {
    const Join& join = model_.joins[static_cast<size_t>(k)];
    if (!join.matching && !join.common) return;
    if (join.common) add_tie(k);
    if (join.smoothness < Smoothness::kTangent) return;
    SmoothRelation relation;
    relation.kind = SmoothRelation::Kind::kJoin;
    relation.join = k;
    relation.sides = {join.a, join.b};
    // A join has no more right to curvature than the knot lines of its rougher patch.
    const auto order = [&](const SideRef& ref) {
      return protected_order(
          join.smoothness,
          knots_of(patch_of(model_, ref.patch), across_direction(ref.side)).degree());
    };
    relation.order = std::min(order(join.a), order(join.b));
    const std::string a = label_of(patch_of(model_, join.a.patch));
    relation.text = join.a.patch == join.b.patch
                        ? a + " meets itself " + smoothly(relation.order) + " at its seam"
                        : a + " and " + label_of(patch_of(model_, join.b.patch)) + " meet " +
                              smoothly(relation.order);
    if (join.common) {
      add_common(std::move(relation), join);
    } else {
      add(std::move(relation), internal::join_line(model_, join, &shares_));
    }
  }

  // Measured on the strips refined to the common basis. Nothing across the line changes by that, so
  // the equations are those of the model's own rows; they have to be the same all along.
  void add_common(SmoothRelation relation, const Join& join) {
    const std::optional<CommonPair> pair = common_pair(model_, model_.points, join);
    if (!pair) return;
    Join refined;
    refined.a = pair->a;
    refined.b = pair->b;
    const size_t known = factors_.size();
    if (!internal::fit_relation(pair->model, internal::join_line(pair->model, refined, &shares_),
                                &relation, &factors_)) {
      return;
    }
    for (const auto& equations : relation.equations) {
      if (equations.size() == 1) continue;
      factors_.shrink_to(known);
      return;
    }
    relations_.push_back(std::move(relation));
  }

  void add_wrap(int k) {
    const Join& join = model_.joins[static_cast<size_t>(k)];
    if (join.smoothness < Smoothness::kTangent) return;
    const Patch& patch = patch_of(model_, join.a.patch);
    SmoothRelation relation;
    relation.kind = SmoothRelation::Kind::kWrap;
    relation.join = k;
    relation.patch = join.a.patch;
    relation.across = across_direction(join.a.side);
    const KnotVector& knots = knots_of(patch, relation.across);
    relation.knot = knots.begin();
    relation.order = protected_order(join.smoothness, knots.degree());
    if (relation.order <= knots.degree() - knots.multiplicity(knots.begin())) return;
    relation.text = label_of(patch) + " closes on itself " + smoothly(relation.order);
    add(std::move(relation), internal::wrap_line(model_, join, &shares_));
  }

  void add_knot_lines(int q, Direction across) {
    const Patch& patch = patch_of(model_, q);
    const KnotVector& knots = knots_of(patch, across);
    const int wrapped = wrapped_rows(patch, across, classes_);
    for (const KnotLine& found : internal::lines_of(lines_, q, across)) {
      if (found.measured <= found.guaranteed || found.measured < Smoothness::kTangent) continue;
      SmoothRelation relation;
      relation.kind = SmoothRelation::Kind::kKnotLine;
      relation.patch = q;
      relation.across = across;
      relation.knot = found.knot;
      relation.order = protected_order(found.measured, knots.degree());
      if (relation.order <= knots.degree() - found.multiplicity) continue;
      relation.text = label_of(patch) + " is smooth (" + (relation.order == 2 ? "G2" : "G1") +
                      ") across an inner knot line of " + (across == Direction::kU ? "u" : "v");
      add(std::move(relation),
          internal::knot_line(model_, q, across, found.knot,
                              wrapped > 0 ? knots.size() - wrapped : 0, &shares_));
    }
  }

  const PatchModel& model_;
  const internal::MeasuredLines& lines_;
  PointClasses classes_;
  internal::KnownFactors factors_;
  internal::KnownShares shares_;
  std::vector<SmoothRelation> relations_;
};

}  // namespace

std::vector<SmoothRelation> smooth_relations(const PatchModel& model) {
  return internal::smooth_relations(model, internal::measured_lines(model));
}

internal::MeasuredLines internal::measured_lines(const PatchModel& model) {
  const double size = diagonal(model);
  MeasuredLines lines;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Surface surface = model.surface(q);
    lines.push_back({interior_smoothness(surface, Direction::kU, size),
                     interior_smoothness(surface, Direction::kV, size)});
  }
  return lines;
}

std::vector<SmoothRelation> internal::smooth_relations(const PatchModel& model,
                                                       const MeasuredLines& lines) {
  return RelationFinder(model, lines).run();
}

std::vector<int> points_locking(const PatchModel& model, const SmoothRelation& relation) {
  std::set<int> points;
  for (const SideRef& ref : relation.sides) {
    const Patch& patch = patch_of(model, ref.patch);
    const KnotVector& across = knots_of(patch, across_direction(ref.side));
    const int rows =
        std::min(across.size(), boundary_rows(across, is_begin_side(ref.side), relation.order));
    for (int row = 0; row < rows; ++row) {
      for (const auto& [i, j] : side_indices(patch, ref.side, row))
        points.insert(patch.point(i, j));
    }
  }
  if (relation.patch >= 0) {
    const Patch& patch = patch_of(model, relation.patch);
    const KnotVector& knots = knots_of(patch, relation.across);
    std::vector<double> lines = {relation.knot};
    if (relation.kind == SmoothRelation::Kind::kWrap) lines = {knots.begin(), knots.end()};
    const Side first = relation.across == Direction::kU ? Side::kUBegin : Side::kVBegin;
    for (double line : lines) {
      for (int row : functions_rough_at(knots, line, relation.order)) {
        for (const auto& [i, j] : side_indices(patch, first, row)) points.insert(patch.point(i, j));
      }
    }
  }
  return {points.begin(), points.end()};
}

}  // namespace isochor
