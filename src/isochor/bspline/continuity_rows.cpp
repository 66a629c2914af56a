#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/coarse_grids.h"
#include "isochor/bspline/common_rows.h"
#include "isochor/bspline/pole_rows.h"
#include "isochor/bspline/smooth_relations.h"

namespace isochor {
namespace {

using internal::other;
using Kind = SmoothRelation::Kind;

// The same degree and knots, mapped to [0, 1].
bool same_knots(const KnotVector& a, const KnotVector& b, bool flipped) {
  if (a.degree() != b.degree() || a.size() != b.size()) return false;
  const int count = static_cast<int>(a.knots().size());
  for (int i = 0; i < count; ++i) {
    const double first = (a[i] - a.begin()) / (a.end() - a.begin());
    const double second = (b[flipped ? count - 1 - i : i] - b.begin()) / (b.end() - b.begin());
    if (std::abs(first - (flipped ? 1.0 - second : second)) > kSameSide) return false;
  }
  return true;
}

// Equations across lines that are to be identical when they agree within noise, in either order.
class EquationPool {
 public:
  // Replaces `equation` by a stored one (its own strips and rows kept) or stores it.
  void share(LineEquation* equation, double noise) {
    std::vector<double> values;
    for (const LineTerm& term : *equation) values.push_back(term.value.to_double());
    for (const Known& known : known_) {
      if (agree(known.rounded, values, noise)) {
        return assign(known.exact.begin(), equation);
      }
      std::reverse(values.begin(), values.end());
      const bool reversed = agree(known.rounded, values, noise);
      std::reverse(values.begin(), values.end());
      if (reversed) return assign(known.exact.rbegin(), equation);
    }
    shorten(equation);
    Known known;
    for (const LineTerm& term : *equation) {
      known.exact.push_back(term.value);
      known.rounded.push_back(term.value.to_double());
    }
    known_.push_back(std::move(known));
  }

  // Long fractions (products of weights and knots) become whole multiples of 2^-64 of the largest
  // one, which takes up the difference: the sum stays exactly zero. Nothing is lost, because what
  // equations of crossing lines share is only that each has one set of values for the whole line.
  static void shorten(LineEquation* equation) {
    constexpr unsigned long kBits = 64;
    const auto largest = std::max_element(
        equation->begin(), equation->end(),
        [](const LineTerm& a, const LineTerm& b) { return a.value.abs() < b.value.abs(); });
    const Rational scale = largest->value;
    Integer common(1);
    for (LineTerm& term : *equation) {
      term.value /= scale;
      common = lcm(common, term.value.denominator());
    }
    if (common.bits() <= kBits) return;
    Rational rest;
    for (auto term = equation->begin(); term != equation->end(); ++term) {
      if (term == largest) continue;
      const Integer steps =
          term->value.numerator().shifted(kBits).divided_nearest(term->value.denominator());
      term->value = Rational(steps).scaled_by_power_of_two(-static_cast<long>(kBits));
      rest += term->value;
    }
    largest->value = -rest;
  }

 private:
  struct Known {
    std::vector<Rational> exact;
    std::vector<double> rounded;
  };

  // Whether b is a multiple of a, within `noise` of its largest value.
  static bool agree(const std::vector<double>& a, const std::vector<double>& b, double noise) {
    if (a.size() != b.size()) return false;
    const auto smaller = [](double x, double y) { return std::abs(x) < std::abs(y); };
    const auto largest =
        static_cast<size_t>(std::max_element(a.begin(), a.end(), smaller) - a.begin());
    const double scale = b[largest] / a[largest];
    const double size = std::abs(b[largest]);
    for (size_t k = 0; k < a.size(); ++k) {
      if (!(std::abs(scale * a[k] - b[k]) <= noise * size)) return false;
    }
    return true;
  }

  template <typename Values>
  static void assign(Values values, LineEquation* equation) {
    for (LineTerm& term : *equation) term.value = *values++;
  }

  std::vector<Known> known_;
};

class RowMaker {
 public:
  RowMaker(const PatchModel& model, const std::vector<CoarseKnots>& coarse)
      : model_(model), grids_(model, coarse) {}

  ContinuityRows run(const std::vector<SmoothRelation>& relations) {
    // Lines first: what poles ask for has to agree with them. Well-measured lines before others,
    // which then take over their equations.
    std::vector<int> order(relations.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      const SmoothRelation& first = relations[static_cast<size_t>(a)];
      const SmoothRelation& second = relations[static_cast<size_t>(b)];
      if ((first.kind == Kind::kPole) != (second.kind == Kind::kPole)) {
        return second.kind == Kind::kPole;
      }
      return first.residual < second.residual;
    });
    for (int k : order) {
      const SmoothRelation& relation = relations[static_cast<size_t>(k)];
      const bool stated = relation.kind == Kind::kPole
                              ? internal::add_pole_rows(model_, relation, k, &grids_, &result_.rows)
                              : add_line(k, relation);
      if (!stated) result_.inexpressible.push_back(k);
    }
    std::sort(result_.inexpressible.begin(), result_.inexpressible.end());
    return std::move(result_);
  }

 private:
  // A strip of a line: patch, direction across, whether it runs against the first strip.
  struct Place {
    int patch = 0;
    Direction across = Direction::kU;
    bool flipped = false;
  };

  std::vector<Place> places(const SmoothRelation& relation) const {
    if (relation.kind != Kind::kJoin && relation.kind != Kind::kTie) {
      return {{relation.patch, relation.across, false}};
    }
    const Join& join = model_.joins[static_cast<size_t>(relation.join)];
    return {{join.a.patch, across_direction(join.a.side), false},
            {join.b.patch, across_direction(join.b.side), join.opposed}};
  }

  // g = k U, without what is noise; the sum stays exactly zero.
  LineEquation coarsened(const std::vector<Place>& places, const LineEquation& equation) {
    std::map<std::pair<int, int>, std::pair<Rational, Rational>> sums;  // with sizes
    for (const LineTerm& term : equation) {
      const Place& place = places[static_cast<size_t>(term.strip)];
      const ExactMapRow& row = grids_.map(place.patch, place.across)[static_cast<size_t>(term.row)];
      for (size_t k = 0; k < row.coefficients.size(); ++k) {
        const int column =
            grids_.wrapped(place.patch, place.across, row.first + static_cast<int>(k));
        auto& [sum, size] = sums[boundary_merged(places, term.strip, column)];
        const Rational value = term.value * row.coefficients[k];
        sum += value;
        size += value.abs();
      }
    }
    Rational largest_size;
    for (const auto& [at, sum] : sums) largest_size = std::max(largest_size, sum.second);
    const Rational noise = largest_size * Rational(kSameRow);
    LineEquation result;
    Rational dropped;
    for (const auto& [at, sum] : sums) {
      if (sum.first.abs() > noise) {
        result.push_back({at.first, at.second, sum.first});
      } else {
        dropped += sum.first;
      }
    }
    if (!result.empty() && !dropped.is_zero()) {
      std::max_element(result.begin(), result.end(), [](const LineTerm& a, const LineTerm& b) {
        return a.value.abs() < b.value.abs();
      })->value += dropped;
    }
    return result;
  }

  // The boundary rows of two joined strips are one.
  std::pair<int, int> boundary_merged(const std::vector<Place>& places, int strip, int column) {
    if (strip == 0 || join_ == nullptr) return {strip, column};
    const auto last = [&](const Place& place, const SideRef& ref) {
      return is_begin_side(ref.side) ? 0 : grids_.coarse(place.patch, place.across).size() - 1;
    };
    if (column != last(places[1], join_->b)) return {strip, column};
    return {0, last(places[0], join_->a)};
  }

  // From the depth of the first strip to the depth of the second, so that equal equations of
  // neighbouring lines read the same (or reversed).
  void order_across(LineEquation* equation) const {
    if (join_ == nullptr) return;
    const bool first_descends = is_begin_side(join_->a.side);
    const bool second_descends = !is_begin_side(join_->b.side);
    std::sort(equation->begin(), equation->end(), [&](const LineTerm& a, const LineTerm& b) {
      if (a.strip != b.strip) return a.strip < b.strip;
      return (a.strip == 0 ? first_descends : second_descends) ? a.row > b.row : a.row < b.row;
    });
  }

  // A line whose strips have different bases along it. The boundary rows of its strips are not one,
  // but one curve.
  bool add_common(int k, const SmoothRelation& relation) {
    join_ = &model_.joins[static_cast<size_t>(relation.join)];
    const std::vector<Place> at = places(relation);
    internal::CommonRows common(model_, *join_, &grids_);
    const double noise = std::max(kSameRow, 2.0 * relation.residual);
    for (const std::vector<LineEquation>& equations : relation.equations) {
      LineEquation shared = equations.front();
      if (relation.kind == Kind::kTie) {
        for (LineTerm& term : shared) {
          const Place& place = at[static_cast<size_t>(term.strip)];
          const int last = grids_.coarse(place.patch, place.across).size() - 1;
          term.row = std::min(term.row, last);
        }
      } else {
        shared = coarsened(at, shared);
        order_across(&shared);
        if (!shared.empty()) pool_.share(&shared, noise);
      }
      for (int c = 0; c < common.size(); ++c) {
        ContinuityRow row;
        row.relation = k;
        row.terms = common.row(shared, c);
        if (!row.terms.empty()) result_.rows.push_back(std::move(row));
      }
    }
    return true;
  }

  bool add_line(int k, const SmoothRelation& relation) {
    if (relation.join >= 0 && model_.joins[static_cast<size_t>(relation.join)].common) {
      return add_common(k, relation);
    }
    join_ =
        relation.kind == Kind::kJoin ? &model_.joins[static_cast<size_t>(relation.join)] : nullptr;
    const std::vector<Place> at = places(relation);
    const KnotVector& along = grids_.coarse(at[0].patch, other(at[0].across));
    if (at.size() == 2 &&
        !same_knots(along, grids_.coarse(at[1].patch, other(at[1].across)), at[1].flipped)) {
      return false;
    }
    const int wrap = grids_.period(at[0].patch, other(at[0].across));
    const int count = wrap > 0 ? wrap : along.size();
    const double noise = std::max(kSameRow, 2.0 * relation.residual);
    std::vector<ContinuityRow> rows;
    for (const std::vector<LineEquation>& equations : relation.equations) {
      if (equations.size() > 1 && !same_along(at)) return false;
      std::vector<LineEquation> coarse_equations;
      for (const LineEquation& equation : equations) {
        LineEquation shared = coarsened(at, equation);
        order_across(&shared);
        if (equations.size() == 1 && !shared.empty()) pool_.share(&shared, noise);
        if (equations.size() > 1 && !shared.empty()) EquationPool::shorten(&shared);
        coarse_equations.push_back(std::move(shared));
      }
      for (int b = 0; b < count; ++b) {
        const auto which = coarse_equations.size() > 1 ? static_cast<size_t>(b) : 0;
        ContinuityRow row = row_at(k, at, coarse_equations[which], b);
        if (!row.terms.empty()) rows.push_back(std::move(row));
      }
    }
    result_.rows.insert(result_.rows.end(), rows.begin(), rows.end());
    return true;
  }

  // No strip is coarsened along the line.
  bool same_along(const std::vector<Place>& at) const {
    return std::all_of(at.begin(), at.end(), [&](const Place& place) {
      return grids_.coarse(place.patch, other(place.across)) ==
             grids_.fine(place.patch, other(place.across));
    });
  }

  ContinuityRow row_at(int k, const std::vector<Place>& at, const LineEquation& equation,
                       int b) const {
    ContinuityRow row;
    row.relation = k;
    for (const LineTerm& term : equation) {
      const Place& place = at[static_cast<size_t>(term.strip)];
      const int along =
          place.flipped ? grids_.coarse(place.patch, other(place.across)).size() - 1 - b : b;
      const bool across_u = place.across == Direction::kU;
      row.terms.push_back(
          {place.patch, across_u ? term.row : along, across_u ? along : term.row, term.value});
    }
    return row;
  }

  const PatchModel& model_;
  internal::CoarseGrids grids_;
  EquationPool pool_;
  const Join* join_ = nullptr;  // of the relation at hand, for joins
  ContinuityRows result_;
};

}  // namespace

ContinuityRows continuity_rows(const PatchModel& model,
                               const std::vector<SmoothRelation>& relations,
                               const std::vector<CoarseKnots>& coarse) {
  return RowMaker(model, coarse).run(relations);
}

}  // namespace isochor
