// Linear forms on a DisplacementSpace, exact.
#include <map>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/exact_basis.h"
#include "isochor/edit/displacement_space.h"

namespace isochor {
namespace {

// The functions of one direction and the numbers they enter a form with.
struct Factor {
  int first = 0;
  std::vector<Rational> values;
};

Factor factor_of(const KnotVector& knots, double at, bool slope) {
  ExactBasisValues basis = evaluate_exact_basis(knots, at);
  return {basis.first, std::move(slope ? basis.slopes : basis.values)};
}

}  // namespace

// Adds up grid entries by coefficient and axis.
class DisplacementSpace::RowBuilder {
 public:
  explicit RowBuilder(const DisplacementSpace& space) : space_(space) {}

  void add(int entry_index, const Rational& value) {
    if (value.is_zero()) return;
    const Entry& entry = space_.entries_[static_cast<size_t>(entry_index)];
    Sum& sum = sums_[entry.coefficient];
    for (size_t a = 0; a < 3; ++a) {
      if (entry.flipped >> a & 1u) {
        sum.value[a] -= value;
        sum.mirrored = true;
      } else {
        sum.value[a] += value;
      }
    }
    sum.size += value.abs();
  }

  // Mirrored halves cancel across the plane: what rounding of the mirror images leaves of them
  // (knots that are symmetric only to the last digit) is no equation.
  CoefficientRow take() {
    const Rational same(kSameRow);
    CoefficientRow row;
    for (auto& [coefficient, sum] : sums_) {
      Vec3 value;
      for (size_t a = 0; a < 3; ++a) {
        if (sum.mirrored && sum.value[a].abs() <= same * sum.size) sum.value[a] = Rational();
        value[static_cast<int>(a)] = sum.value[a].to_double();
      }
      row.coefficient.push_back(coefficient);
      row.value.push_back(value);
      row.exact.push_back(std::move(sum.value));
    }
    return row;
  }

 private:
  struct Sum {
    std::array<Rational, 3> value;
    Rational size;
    bool mirrored = false;
  };
  const DisplacementSpace& space_;
  std::map<int, Sum> sums_;
};

CoefficientRow DisplacementSpace::surface_row(const PatchModel& model, int q, Uv uv,
                                              SurfaceForm form) const {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const Grid& grid = grids_[static_cast<size_t>(q)];
  const bool along_u = form == SurfaceForm::kAlongU;
  const bool along_v = form == SurfaceForm::kAlongV;
  RowBuilder row(*this);
  if (patch.weights.empty()) {
    const Factor u = factor_of(grid.u.coarse, uv.u, along_u);
    const Factor v = factor_of(grid.v.coarse, uv.v, along_v);
    for (size_t i = 0; i < u.values.size(); ++i) {
      for (size_t j = 0; j < v.values.size(); ++j) {
        row.add(entry_index(q, u.first + static_cast<int>(i), v.first + static_cast<int>(j)),
                u.values[i] * v.values[j]);
      }
    }
    return row.take();
  }
  // delta = N / W with N = sum w B delta: its derivative is (N' - (W' / W) N) / W.
  const ExactBasisValues u = evaluate_exact_basis(patch.u_knots, uv.u);
  const ExactBasisValues v = evaluate_exact_basis(patch.v_knots, uv.v);
  const std::vector<Rational>& du = along_u ? u.slopes : u.values;
  const std::vector<Rational>& dv = along_v ? v.slopes : v.values;
  const bool derivative = along_u || along_v;
  const auto weight = [&](size_t i, size_t j) {
    return Rational(patch.weights[(static_cast<size_t>(u.first) + i) * patch.v_size() +
                                  static_cast<size_t>(v.first) + j]);
  };
  Rational denominator, slope;
  for (size_t i = 0; i < u.values.size(); ++i) {
    for (size_t j = 0; j < v.values.size(); ++j) {
      denominator += weight(i, j) * u.values[i] * v.values[j];
      if (derivative) slope += weight(i, j) * du[i] * dv[j];
    }
  }
  for (size_t i = 0; i < u.values.size(); ++i) {
    for (size_t j = 0; j < v.values.size(); ++j) {
      Rational share = du[i] * dv[j];
      if (derivative) share -= slope / denominator * u.values[i] * v.values[j];
      share *= weight(i, j) / denominator;
      if (share.is_zero()) continue;
      const int point = patch.point(u.first + static_cast<int>(i), v.first + static_cast<int>(j));
      const auto c = static_cast<size_t>(class_of_point_[static_cast<size_t>(point)]);
      for (const RowTerm& term : rows_[c]) row.add(term.entry, share * Rational(term.value));
    }
  }
  return row.take();
}

CoefficientRow DisplacementSpace::point_row(int point) const {
  RowBuilder row(*this);
  const auto c = static_cast<size_t>(class_of_point_[static_cast<size_t>(point)]);
  for (const RowTerm& term : rows_[c]) row.add(term.entry, Rational(term.value));
  return row.take();
}

CoefficientRow DisplacementSpace::combination(const std::vector<GridTerm>& terms) const {
  RowBuilder row(*this);
  for (const GridTerm& term : terms) row.add(entry_index(term.patch, term.i, term.j), term.value);
  return row.take();
}

}  // namespace isochor
