#include "isochor/bspline/line_strips.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/exact_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/exact/simplest_rational.h"

namespace isochor::internal {
namespace {

const Patch& patch_of(const PatchModel& model, int q) {
  return model.patches[static_cast<size_t>(q)];
}

// The strip that ends (below) or begins at `knot`; `backwards`: n runs against the parameter.
Strip make_strip(const PatchModel& model, int patch, Direction across, double knot, bool below,
                 bool backwards, KnownShares* known) {
  const KnotVector& knots = knots_of(patch_of(model, patch), across);
  int span = knots.spans().front();
  for (int k : knots.spans()) {
    if (below ? knots[k] < knot : knots[k] <= knot) span = k;
  }
  Strip strip;
  strip.patch = patch;
  strip.across = across;
  strip.first = span - knots.degree();
  strip.shares = known->at(knots, span, knot, backwards);
  return strip;
}

Strip side_strip(const PatchModel& model, const SideRef& ref, bool incoming, KnownShares* known) {
  const Direction across = across_direction(ref.side);
  const KnotVector& knots = knots_of(patch_of(model, ref.patch), across);
  const bool begin = is_begin_side(ref.side);
  return make_strip(model, ref.patch, across, begin ? knots.begin() : knots.end(), !begin,
                    begin == incoming, known);
}

double weight_at(const Patch& patch, const std::pair<int, int>& at) {
  return patch.weights.empty()
             ? 1.0
             : patch.weights[static_cast<size_t>(at.first) * static_cast<size_t>(patch.v_size()) +
                             static_cast<size_t>(at.second)];
}

double weight(const PatchModel& model, const Strip& strip, int i, int j) {
  const Patch& patch = patch_of(model, strip.patch);
  return weight_at(patch, grid_index(patch, strip, strip.first + i, j));
}

int rows_of(const Strip& strip) { return static_cast<int>(strip.derivative(0).size()); }

// The rows of a strip that have a share in derivatives up to `order`.
bool matters(const Strip& strip, int i, int order) {
  for (int r = 0; r <= order; ++r) {
    if (!strip.derivative(r)[static_cast<size_t>(i)].is_zero()) return true;
  }
  return false;
}

bool weighted(const PatchModel& model, const Line& line) {
  return !patch_of(model, line.strips[0].patch).weights.empty() ||
         !patch_of(model, line.strips[1].patch).weights.empty();
}

// Whether w_ij = a_i b_j for the rows that matter, to rounding; b from the curve's own weights.
bool weights_separate(const PatchModel& model, const Line& line, int order) {
  if (!weighted(model, line)) return true;
  std::vector<double> along;
  for (const Strip& strip : line.strips) {
    for (int i = 0; i < rows_of(strip); ++i) {
      if (!matters(strip, i, order)) continue;
      for (int j = 0; j < line.count; ++j) {
        const double ratio = weight(model, strip, i, j) / weight(model, strip, i, 0);
        if (static_cast<int>(along.size()) < line.count) {
          along.push_back(ratio);
          continue;
        }
        const double reference = along[static_cast<size_t>(j)];
        if (std::abs(ratio - reference) > kSeparateWeights * reference) return false;
      }
    }
  }
  return true;
}

// Derivatives of the pole rows at one j, with the curve's own point taken off: V_r, order 1 and 2.
struct Derivatives {
  Vec3 value[2] = {Vec3::Zero(), Vec3::Zero()};
  double size[2] = {0.0, 0.0};  // of their terms
};

Derivatives derivatives_at(const PatchModel& model, const Strip& strip, int j, double scale) {
  const Patch& patch = patch_of(model, strip.patch);
  std::array<Vec3, kMaxDegree + 1> poles;
  poles[0].setZero();
  std::array<double, kMaxDegree + 1> weights;
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  const auto rows = static_cast<size_t>(rows_of(strip));
  for (size_t i = 0; i < rows; ++i) {
    const auto at = grid_index(patch, strip, strip.first + static_cast<int>(i), j);
    poles[i] = model.points[static_cast<size_t>(patch.point(at.first, at.second))];
    weights[i] = weight_at(patch, at) * scale;
    const double share = strip.rounded(0)[i] * weights[i];
    sum += share * (poles[i] - poles[0]);
    total += share;
  }
  const Vec3 point = poles[0] + sum / total;
  Derivatives result;
  for (int r = 0; r < 2; ++r) {
    for (size_t i = 0; i < rows; ++i) {
      const Vec3 term = strip.rounded(r + 1)[i] * weights[i] * (poles[i] - point);
      result.value[r] += term;
      result.size[r] += term.norm();
    }
  }
  return result;
}

// Least squares of above = factor * below, over all poles along the line.
double fitted_factor(const std::vector<Vec3>& above, const std::vector<Vec3>& below) {
  double both = 0.0;
  double square = 0.0;
  for (size_t j = 0; j < above.size(); ++j) {
    both += above[j].dot(below[j]);
    square += below[j].squaredNorm();
  }
  return square > 0.0 ? both / square : 0.0;
}

// The simplest rational within `noise` of a measured value, a known one first.
Rational simplest_near(double value, double noise, const KnownFactors& known) {
  const Rational* factor = known.find(value, noise);
  if (factor != nullptr) return *factor;
  return simplest_between(Rational(value) - Rational(noise), Rational(value) + Rational(noise));
}

// A simple rational near a measured value that does not make the residual (relative, in units of
// `unit` for the value) noticeably worse. The wider the search, the simpler it is.
template <typename Residual>
Rational settled(double value, double unit, Residual residual, KnownFactors* known) {
  const double measured = residual(value);
  Rational found;
  for (double share : {4.0, 1.0, 0.25, 0.0}) {
    const double noise = unit * std::max(kFactorNoise, share * measured);
    found = simplest_near(value, noise, *known);
    if (residual(found.to_double()) <= 1.25 * measured + kFactorNoise) break;
  }
  known->add(found);
  return found;
}

// Largest |above - factor * below| and largest size.
struct Misfit {
  double absolute = 0.0;
  double size = 0.0;
  double relative() const { return size > 0.0 ? absolute / size : 0.0; }
};

class Fit {
 public:
  Fit(const PatchModel& model, const Line& line) {
    // The second strip's weights may have another common factor.
    const double scale =
        boundary_weight(model, line.strips[0]) / boundary_weight(model, line.strips[1]);
    for (int j = 0; j < line.count; ++j) {
      below_.push_back(derivatives_at(model, line.strips[0], j, 1.0));
      above_.push_back(derivatives_at(model, line.strips[1], j, scale));
    }
  }

  static double boundary_weight(const PatchModel& model, const Strip& strip) {
    double total = 0.0;
    for (int i = 0; i < rows_of(strip); ++i) {
      total += strip.rounded(0)[static_cast<size_t>(i)] * weight(model, strip, i, 0);
    }
    return total;
  }

  bool run(SmoothRelation* relation, KnownFactors* known) const {
    const std::vector<Vec3> below = values(below_, 0);
    const double raw = fitted_factor(values(above_, 0), below);
    if (!(raw > 0.0) || !std::isfinite(raw)) return false;
    const auto residual = [&](double factor) { return misfit(0, factor, 0.0).relative(); };
    if (!(residual(raw) <= kSmoothResidual)) return false;
    const Rational lambda = settled(raw, raw, residual, known);
    relation->residual = residual(lambda.to_double());
    relation->lambda = lambda;
    relation->mu = Rational();
    return relation->order < 2 || run_second(relation, known, below);
  }

 private:
  bool run_second(SmoothRelation* relation, KnownFactors* known,
                  const std::vector<Vec3>& below) const {
    const double lambda = relation->lambda.to_double();
    std::vector<Vec3> rest;
    for (size_t j = 0; j < above_.size(); ++j) {
      rest.push_back(above_[j].value[1] - lambda * lambda * below_[j].value[1]);
    }
    const double raw = fitted_factor(rest, below);
    if (!std::isfinite(raw)) return false;
    const auto residual = [&](double mu) { return misfit(1, lambda * lambda, mu).relative(); };
    if (!(residual(raw) <= kSmoothResidual)) return false;
    double speed = 0.0;
    for (const Vec3& v : below) speed = std::max(speed, v.norm());
    relation->mu = settled(raw, misfit(1, lambda * lambda, raw).size / speed, residual, known);
    relation->residual = std::max(relation->residual, residual(relation->mu.to_double()));
    return true;
  }

  static std::vector<Vec3> values(const std::vector<Derivatives>& all, size_t r) {
    std::vector<Vec3> result;
    for (const Derivatives& d : all) result.push_back(d.value[r]);
    return result;
  }

  Misfit misfit(size_t r, double factor, double mu) const {
    Misfit result;
    for (size_t j = 0; j < above_.size(); ++j) {
      const Vec3 rest = above_[j].value[r] - factor * below_[j].value[r] - mu * below_[j].value[0];
      result.absolute = std::max(result.absolute, rest.norm());
      result.size = std::max({result.size, above_[j].size[r], factor * below_[j].size[r]});
    }
    return result;
  }

  std::vector<Derivatives> below_, above_;
};

// Collects sum value * delta of (strip, row), rows that are one and the same added up.
class EquationTerms {
 public:
  explicit EquationTerms(const Line& line) : line_(line) {}

  void add(int strip, int row, const Rational& value) {
    if (value.is_zero()) return;
    if (line_.boundary[0] < 0) strip = 0;
    if (strip == 1 && row == line_.boundary[1]) {
      strip = 0;
      row = line_.boundary[0];
    }
    if (line_.period > 0 && row >= line_.period) row -= line_.period;
    terms_[{strip, row}] += value;
  }

  LineEquation take() const {
    LineEquation equation;
    for (const auto& [at, value] : terms_) {
      if (!value.is_zero()) equation.push_back({at.first, at.second, value});
    }
    return equation;
  }

 private:
  const Line& line_;
  std::map<std::pair<int, int>, Rational> terms_;
};

// The equation of order r at j, and the factor of H itself that makes its sum zero.
struct Balanced {
  LineEquation equation;
  double own_factor = 0.0;  // rho or sigma
  double size = 0.0;        // of the terms that it balances
};

Balanced balanced_equation(const PatchModel& model, const Line& line, int r, int j,
                           const Rational& lambda, const Rational& mu) {
  EquationTerms terms(line);
  std::vector<Rational> weights[2];  // none: all are one
  Rational own[2] = {Rational(1), Rational(1)};
  for (size_t s = 0; s < 2; ++s) {
    const Strip& strip = line.strips[s];
    if (patch_of(model, strip.patch).weights.empty()) continue;
    own[s] = Rational();
    for (int i = 0; i < rows_of(strip); ++i) {
      weights[s].emplace_back(weight(model, strip, i, j));
      own[s] += strip.derivative(0)[static_cast<size_t>(i)] * weights[s].back();
    }
  }
  const Rational scale = own[0] / own[1];
  Rational sum;
  Rational size;
  const auto add = [&](size_t s, int order, const Rational& factor) {
    const Strip& strip = line.strips[s];
    const std::vector<Rational>& shares = strip.derivative(order);
    for (size_t i = 0; i < shares.size(); ++i) {
      if (shares[i].is_zero()) continue;
      Rational value = factor * shares[i];
      if (!weights[s].empty()) value *= weights[s][i];
      terms.add(static_cast<int>(s), strip.first + static_cast<int>(i), value);
      sum += value;
      size += value.abs();
    }
  };
  add(1, r, scale);
  add(0, r, r == 1 ? -lambda : -(lambda * lambda));
  if (r == 2) add(0, 1, -mu);
  const Rational factor = sum / own[0];
  Balanced result;
  result.size = (size / own[0]).to_double();
  result.own_factor = factor.to_double();
  if (!factor.is_zero()) add(0, 0, -factor);
  result.equation = terms.take();
  return result;
}

// Without a common b_j the relation of W must hold with one rho for all j, else it is not smooth.
bool add_equations(const PatchModel& model, const Line& line, bool separate,
                   SmoothRelation* relation) {
  for (int r = 1; r <= relation->order; ++r) {
    std::vector<LineEquation> equations;
    double low = 0.0;
    double high = 0.0;
    double size = 0.0;
    bool any = false;
    for (int j = 0; j < (separate ? 1 : line.count); ++j) {
      Balanced at = balanced_equation(model, line, r, j, relation->lambda, relation->mu);
      low = j == 0 ? at.own_factor : std::min(low, at.own_factor);
      high = j == 0 ? at.own_factor : std::max(high, at.own_factor);
      size = std::max(size, at.size);
      any = any || !at.equation.empty();
      equations.push_back(std::move(at.equation));
    }
    if (high - low > kSmoothResidual * size) return false;
    if (any) relation->equations.push_back(std::move(equations));
  }
  return true;
}

}  // namespace

std::pair<int, int> grid_index(const Patch& patch, const Strip& strip, int row, int j) {
  if (strip.across == Direction::kU) {
    return {row, strip.flipped ? patch.v_size() - 1 - j : j};
  }
  return {strip.flipped ? patch.u_size() - 1 - j : j, row};
}

Line join_line(const PatchModel& model, const Join& join, KnownShares* known) {
  Line line;
  line.strips[0] = side_strip(model, join.a, true, known);
  line.strips[1] = side_strip(model, join.b, false, known);
  line.strips[1].flipped = join.opposed;
  line.count = knots_of(patch_of(model, join.a.patch), running_direction(join.a.side)).size();
  const SideRef* sides[2] = {&join.a, &join.b};
  for (size_t s = 0; s < 2; ++s) {
    const int rows =
        knots_of(patch_of(model, sides[s]->patch), across_direction(sides[s]->side)).size();
    line.boundary[s] = is_begin_side(sides[s]->side) ? 0 : rows - 1;
  }
  return line;
}

Line wrap_line(const PatchModel& model, const Join& join, KnownShares* known) {
  const Direction across = across_direction(join.a.side);
  const KnotVector& knots = knots_of(patch_of(model, join.a.patch), across);
  Line line;
  line.strips[0] = make_strip(model, join.a.patch, across, knots.end(), true, false, known);
  line.strips[1] = make_strip(model, join.a.patch, across, knots.begin(), false, false, known);
  line.count = knots_of(patch_of(model, join.a.patch), running_direction(join.a.side)).size();
  line.period = knots.size() - wrapped_poles(knots);
  return line;
}

Line knot_line(const PatchModel& model, int patch, Direction across, double knot, int period,
               KnownShares* known) {
  Line line;
  line.strips[0] = make_strip(model, patch, across, knot, true, false, known);
  line.strips[1] = make_strip(model, patch, across, knot, false, false, known);
  line.count =
      knots_of(patch_of(model, patch), across == Direction::kU ? Direction::kV : Direction::kU)
          .size();
  line.period = period;
  return line;
}

std::shared_ptr<const RowShares> KnownShares::at(const KnotVector& knots, int span, double knot,
                                                 bool backwards) {
  // All that exact_derivatives reads.
  std::vector<double> key(knots.knots().begin() + span - knots.degree() + 1,
                          knots.knots().begin() + span + knots.degree() + 1);
  key.push_back(knot);
  key.push_back(backwards ? 1.0 : 0.0);
  std::shared_ptr<const RowShares>& known = shares_[std::move(key)];
  if (known) return known;
  RowShares fresh;
  for (int r = 0; r < 3; ++r) {
    auto& shares = fresh.derivatives[static_cast<size_t>(r)];
    shares = exact_derivatives(knots, span, knot, r);
    if (backwards && r == 1) {
      for (Rational& share : shares) share = -share;
    }
    for (const Rational& share : shares) {
      fresh.rounded[static_cast<size_t>(r)].push_back(share.to_double());
    }
  }
  known = std::make_shared<const RowShares>(std::move(fresh));
  return known;
}

const Rational* KnownFactors::find(double value, double noise) const {
  // The ends, each rounded once. Rounding keeps the order: what lies outside rounded lies outside,
  // and what lies strictly inside rounded lies inside.
  const double least = value - noise;
  const double most = value + noise;
  for (size_t k = 0; k < factors_.size(); ++k) {
    if (rounded_[k] < least || rounded_[k] > most) continue;
    if (least < rounded_[k] && rounded_[k] < most) return &factors_[k];
    if (Rational(value) - Rational(noise) <= factors_[k] &&
        factors_[k] <= Rational(value) + Rational(noise)) {
      return &factors_[k];
    }
  }
  return nullptr;
}

void KnownFactors::add(const Rational& factor) {
  const double rounded = factor.to_double();
  for (size_t k = 0; k < factors_.size(); ++k) {
    if (rounded_[k] == rounded && factors_[k] == factor) return;
  }
  factors_.push_back(factor);
  rounded_.push_back(rounded);
}

void KnownFactors::shrink_to(size_t size) {
  factors_.resize(std::min(size, factors_.size()));
  rounded_.resize(factors_.size());
}

bool fit_relation(const PatchModel& model, const Line& line, SmoothRelation* relation,
                  KnownFactors* known_factors) {
  SmoothRelation fitted = *relation;
  const size_t known = known_factors->size();
  const bool fits =
      Fit(model, line).run(&fitted, known_factors) &&
      add_equations(model, line, weights_separate(model, line, fitted.order), &fitted);
  if (fits) {
    *relation = std::move(fitted);
  } else {
    known_factors->shrink_to(known);
  }
  return fits;
}

}  // namespace isochor::internal
