#include "isochor/bspline/common_basis.h"

#include <algorithm>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {
namespace {

// The parameter x of a side's running parameter.
class Along {
 public:
  explicit Along(const CommonSide& side) : flipped_(side.flipped) {
    from_ = Rational(side.part.whole() ? side.fine.begin() : side.part.from);
    to_ = Rational(side.part.whole() ? side.fine.end() : side.part.to);
    ISOCHOR_REQUIRE(from_ < to_, side.part.from, side.part.to);
  }
  Rational at(double t) const {
    const Rational share = (Rational(t) - from_) / (to_ - from_);
    return flipped_ ? Rational(1) - share : share;
  }

 private:
  bool flipped_;
  Rational from_, to_;
};

// Knots as numbers x; what lies within kSameSide of a known number is that number.
class SharedKnots {
 public:
  SharedKnots() : known_{Rational(0), Rational(1)} {}

  // All knots of a side; later sides snap to it.
  std::map<double, Rational> add(const CommonSide& side) {
    const Along along(side);
    std::map<double, Rational> values;
    for (double t : side.fine.knots()) {
      if (values.count(t) == 0) values.emplace(t, snapped(along.at(t)));
    }
    for (const auto& [t, x] : values) known_.push_back(x);
    std::sort(known_.begin(), known_.end());
    return values;
  }

 private:
  Rational snapped(const Rational& x) const {
    const Rational* nearest = &known_.front();
    for (const Rational& other : known_) {
      if ((other - x).abs() < (*nearest - x).abs()) nearest = &other;
    }
    return (*nearest - x).abs() <= Rational(kSameSide) ? *nearest : x;
  }

  std::vector<Rational> known_;
};

int count_of(const std::vector<Rational>& knots, const Rational& x) {
  const auto range = std::equal_range(knots.begin(), knots.end(), x);
  return static_cast<int>(range.second - range.first);
}

void add_patch(const PatchModel& model, const std::vector<Vec3>& at, int q, Direction along,
               const ExactMap& map, const KnotVector& knots, bool flipped, PatchModel* pair) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const Surface surface = refined_along(model.surface(q, at), along, map, knots);
  Patch refined = patch;
  refined.u_knots = surface.u_knots();
  refined.v_knots = surface.v_knots();
  refined.weights = surface.weights();
  refined.trim = {};
  refined.reversed = patch.reversed != flipped;
  refined.points.clear();
  for (const Vec3& pole : surface.poles()) {
    refined.points.push_back(static_cast<int>(pair->points.size()));
    pair->points.push_back(pole);
  }
  pair->patches.push_back(std::move(refined));
}

}  // namespace

CommonBasis::CommonBasis(const CommonSide& first, const CommonSide& second) {
  SharedKnots shared;
  const CommonSide* sides[2] = {&first, &second};
  for (size_t s = 0; s < 2; ++s) {
    const std::map<double, Rational> known = shared.add(*sides[s]);
    const Along along(*sides[s]);
    Curve& curve = curves_[s];
    curve.degree = sides[s]->knots.degree();
    curve.flipped = sides[s]->flipped;
    for (double t : sides[s]->knots.knots()) {
      const auto found = known.find(t);
      curve.knots.push_back(found != known.end() ? found->second : along.at(t));
    }
    if (curve.flipped) std::reverse(curve.knots.begin(), curve.knots.end());
    degree_ = std::max(degree_, curve.degree);
  }
  std::map<Rational, int> inside;
  const Rational zero(0), one(1);
  for (const Curve& curve : curves_) {
    for (const Rational& x : curve.knots) {
      if (!(zero < x && x < one)) continue;
      int& multiplicity = inside[x];
      multiplicity = std::max(multiplicity, count_of(curve.knots, x) + degree_ - curve.degree);
    }
  }
  knots_.assign(static_cast<size_t>(degree_) + 1, zero);
  for (const auto& [x, multiplicity] : inside) {
    knots_.insert(knots_.end(), static_cast<size_t>(multiplicity), x);
  }
  knots_.insert(knots_.end(), static_cast<size_t>(degree_) + 1, one);
}

ExactMap CommonBasis::map(int s) const {
  ISOCHOR_REQUIRE(s == 0 || s == 1, s);
  ExactMap rows;
  for (int i = 0; i < size(); ++i) rows.push_back(row_of(curves_[s], i));
  return rows;
}

ExactMapRow CommonBasis::row_of(const Curve& curve, int i) const {
  // A span of the common knots where C_i lives, and the curve's span around it.
  int m = i;
  while (!(knots_[static_cast<size_t>(m)] < knots_[static_cast<size_t>(m) + 1])) ++m;
  const std::vector<Rational>& t = curve.knots;
  const int p = curve.degree;
  const int functions = static_cast<int>(t.size()) - p - 1;
  int mu = static_cast<int>(std::upper_bound(t.begin(), t.end(), knots_[static_cast<size_t>(m)]) -
                            t.begin()) -
           1;
  mu = std::min(std::max(mu, p), functions - 1);
  // blossom[k]: the sum over all choices of k of the arguments so far, on functions of degree k.
  std::vector<std::vector<Rational>> blossom(static_cast<size_t>(p) + 1);
  blossom[0] = {Rational(1)};
  Rational choices(1);
  for (int a = 1; a <= degree_; ++a) {
    const Rational& x = knots_[static_cast<size_t>(i + a)];
    for (int k = std::min(a, p); k >= std::max(1, a - (degree_ - p)); --k) {
      std::vector<Rational>& target = blossom[static_cast<size_t>(k)];
      const std::vector<Rational>& source = blossom[static_cast<size_t>(k) - 1];
      if (target.empty()) target.resize(static_cast<size_t>(k) + 1);
      for (int j = 0; j < k; ++j) {
        const Rational& value = source[static_cast<size_t>(j)];
        if (value.is_zero()) continue;
        const Rational& left = t[static_cast<size_t>(mu - k + 1 + j)];
        const Rational& right = t[static_cast<size_t>(mu + 1 + j)];
        const Rational moved = value * ((x - left) / (right - left));
        target[static_cast<size_t>(j)] += value - moved;
        target[static_cast<size_t>(j) + 1] += moved;
      }
    }
  }
  for (int k = 1; k <= p; ++k) choices *= Rational(degree_ - p + k) / Rational(k);
  std::vector<Rational> row = blossom[static_cast<size_t>(p)];
  for (Rational& value : row) value /= choices;
  int first = mu - p;
  if (curve.flipped) {
    std::reverse(row.begin(), row.end());
    first = functions - 1 - mu;
  }
  while (row.back().is_zero()) row.pop_back();
  const auto begin =
      std::find_if(row.begin(), row.end(), [](const Rational& value) { return !value.is_zero(); });
  first += static_cast<int>(begin - row.begin());
  return {first, std::vector<Rational>(begin, row.end())};
}

Surface refined_along(const Surface& surface, Direction along, const ExactMap& map,
                      const KnotVector& knots) {
  const bool along_u = along == Direction::kU;
  const int lines = along_u ? surface.v_size() : surface.u_size();
  const int count = knots.size();
  const auto total = static_cast<size_t>(lines) * static_cast<size_t>(count);
  std::vector<Vec3> poles(total, Vec3::Zero());
  std::vector<double> weights(surface.rational() ? total : 0);
  for (int i = 0; i < count; ++i) {
    const ExactMapRow& row = map[static_cast<size_t>(i)];
    std::vector<double> shares;
    for (const Rational& share : row.coefficients) shares.push_back(share.to_double());
    for (int line = 0; line < lines; ++line) {
      Vec3 sum = Vec3::Zero();
      double weight = 0.0;
      for (size_t k = 0; k < shares.size(); ++k) {
        const int j = row.first + static_cast<int>(k);
        const size_t from = along_u ? surface.index(j, line) : surface.index(line, j);
        const double w = shares[k] * (surface.rational() ? surface.weights()[from] : 1.0);
        sum += w * surface.poles()[from];
        weight += w;
      }
      const auto to = static_cast<size_t>(along_u ? i * lines + line : line * count + i);
      poles[to] = surface.rational() ? Vec3(sum / weight) : sum;
      if (surface.rational()) weights[to] = weight;
    }
  }
  return along_u ? Surface(knots, surface.v_knots(), std::move(poles), std::move(weights))
                 : Surface(surface.u_knots(), knots, std::move(poles), std::move(weights));
}

CommonBasis common_basis(const PatchModel& model, const Join& join, const KnotVector& first,
                         const KnotVector& second) {
  const auto fine = [&](const SideRef& ref) {
    return knots_of(model.patches[static_cast<size_t>(ref.patch)], running_direction(ref.side));
  };
  return CommonBasis({first, fine(join.a), join.part_a, false},
                     {second, fine(join.b), join.part_b, join.opposed});
}

std::optional<CommonPair> common_pair(const PatchModel& model, const std::vector<Vec3>& at,
                                      const Join& join) {
  const Direction along_a = running_direction(join.a.side);
  const Direction along_b = running_direction(join.b.side);
  const CommonBasis basis =
      common_basis(model, join, knots_of(model.patches[static_cast<size_t>(join.a.patch)], along_a),
                   knots_of(model.patches[static_cast<size_t>(join.b.patch)], along_b));
  std::vector<double> rounded;
  for (const Rational& x : basis.knots()) rounded.push_back(x.to_double());
  if (!KnotVector::defect(basis.degree(), rounded).empty()) return std::nullopt;
  const KnotVector knots(basis.degree(), rounded);
  CommonPair pair;
  pair.model.unit = model.unit;
  add_patch(model, at, join.a.patch, along_a, basis.map(0), knots, false, &pair.model);
  add_patch(model, at, join.b.patch, along_b, basis.map(1), knots, join.opposed, &pair.model);
  if (join.a.patch == join.b.patch) pair.model.patches[1].handle += " (other side)";
  pair.a = {0, join.a.side};
  pair.b = {1, join.b.side};
  return pair;
}

}  // namespace isochor
