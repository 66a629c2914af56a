#include "isochor/volume/contraction.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/span_table.h"

namespace isochor {
namespace {

// Rows of three coordinates, each with `halo` zeros on both sides, so that neighbours beyond the
// ends of a row need no special case.
class Rows {
 public:
  Rows(int count, int length, int halo)
      : halo_(halo),
        stride_(static_cast<size_t>(length) + 2 * halo),
        numbers_(3 * static_cast<size_t>(count) * stride_) {}

  // Entry 0 of a row; entries from -halo to length - 1 + halo exist.
  double* row(int index, int axis) {
    return &numbers_[(3 * static_cast<size_t>(index) + axis) * stride_ + halo_];
  }
  const double* row(int index, int axis) const {
    return &numbers_[(3 * static_cast<size_t>(index) + axis) * stride_ + halo_];
  }
  void clear() { std::fill(numbers_.begin(), numbers_.end(), 0.0); }

 private:
  int halo_;
  size_t stride_;
  std::vector<double> numbers_;
};

// The three inner loops. Nothing overlaps, which the compiler needs to know to vectorise them.
void add_product(double* __restrict out, const double* __restrict a, const double* __restrict b,
                 int count) {
  for (int i = 0; i < count; ++i) out[i] += a[i] * b[i];
}
void add_minor(double* __restrict out, const double* __restrict a, const double* __restrict d,
               const double* __restrict b, const double* __restrict c, int count) {
  for (int i = 0; i < count; ++i) out[i] += a[i] * d[i] - b[i] * c[i];
}
void add_multiple(double* __restrict out, double factor, const double* __restrict a, int count) {
  for (int i = 0; i < count; ++i) out[i] += factor * a[i];
}

// b_k, k = span - d .. span - 1, at the place of a knot span that divides it as x : 1 - x; by the
// Cox-de Boor recursion of degree d - 1 on knot differences.
std::vector<double> difference_basis(const KnotVector& knots, int span, double x, double rest) {
  const int d = knots.degree();
  const double length = knots[span + 1] - knots[span];
  std::vector<double> values(static_cast<size_t>(d), 0.0);
  values[0] = 1.0;
  const auto left = [&](int j) { return knots[span] - knots[span + 1 - j] + x * length; };
  const auto right = [&](int j) { return knots[span + j] - knots[span + 1] + rest * length; };
  for (int degree = 1; degree < d; ++degree) {
    double saved = 0.0;
    for (int r = 0; r < degree; ++r) {
      double& value = values[static_cast<size_t>(r)];
      const double part = value / (right(r + 1) + left(degree - r));
      value = saved + right(r + 1) * part;
      saved = left(degree - r) * part;
    }
    values[static_cast<size_t>(degree)] = saved;
  }
  for (int c = 0; c < d; ++c) {
    const int k = span - d + c;
    values[static_cast<size_t>(c)] *= d / (knots[k + d + 1] - knots[k + 1]);
  }
  return values;
}

// Contractions of one patch along v, for the rows that meet row k of the grid.
class Strip {
 public:
  Strip(const TauTensor& u, const TauTensor& v, const Rows& along_u)
      : u_(u),
        v_(v),
        along_u_(along_u),
        edge_(1, v.size(), v.degree()),
        pairs_(2 * v.degree() + 1, v.size(), 0),
        areas_(1, v.size(), 0) {}

  // D[o]_i = sum over j of tau^v_ikj (p_{k,j+1} - p_kj), k = i + o - d, for one row of poles.
  template <typename Pole>
  void enter_row(const Pole& pole) {
    const int m = v_.size(), d = v_.degree();
    for (int j = 0; j + 1 < m; ++j) {
      const Vec3 step = pole(j + 1) - pole(j);
      for (int axis = 0; axis < 3; ++axis) edge_.row(0, axis)[j] = step[axis];
    }
    pairs_.clear();
    for (int o = 0; o <= 2 * d; ++o) {
      // Functions i and i + o - d and the difference j meet only for these s.
      for (int s = std::max(0, o - d); s < std::min(2 * d, o + d); ++s) {
        for (int axis = 0; axis < 3; ++axis) {
          add_product(pairs_.row(o, axis), v_.band(o, s), edge_.row(0, axis) + s - d, m);
        }
      }
    }
  }

  // T_i = sum over k of (p_{j+1,k} - p_jk) x D[k]_i for the difference j of rows.
  const Rows& areas_with(int j) {
    const int m = v_.size(), d = v_.degree();
    areas_.clear();
    for (int o = 0; o <= 2 * d; ++o) {
      for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        add_minor(areas_.row(0, axis), along_u_.row(j, next) + o - d, pairs_.row(o, last),
                  along_u_.row(j, last) + o - d, pairs_.row(o, next), m);
      }
    }
    return areas_;
  }

  // The rows of the gradient that the difference j and the row k of poles act on.
  std::pair<int, int> reach(int k, int j) const {
    const int d = u_.degree();
    return {std::max({0, k - d, j - d + 1}), std::min({u_.size() - 1, k + d, j + d})};
  }

 private:
  const TauTensor& u_;
  const TauTensor& v_;
  const Rows& along_u_;
  Rows edge_, pairs_, areas_;
};

}  // namespace

TauTensor::TauTensor(const KnotVector& knots)
    : degree_(knots.degree()),
      size_(knots.size()),
      band_(static_cast<size_t>(size_) * 2 * degree_ * (2 * degree_ + 1)) {
  const GaussRule rule = gauss_legendre(exact_gauss_points(degree_));
  const SpanTable table(knots, static_cast<int>(rule.nodes.size()));
  for (int span = 0; span < table.spans(); ++span) {
    for (int g = 0; g < table.gauss_points(); ++g) {
      const auto at = static_cast<size_t>(g);
      const std::vector<double> slopes = difference_basis(
          knots, knots.spans()[static_cast<size_t>(span)], rule.nodes[at], rule.from_end[at]);
      for (int c = 0; c < degree_; ++c) {
        const double weight = table.weights(span)[g] * slopes[static_cast<size_t>(c)];
        add_products(table, span, g, c, weight);
      }
    }
  }
}

void TauTensor::add_products(const SpanTable& table, int span, int g, int c, double weight) {
  for (int a = 0; a <= degree_; ++a) {
    for (int b = 0; b <= degree_; ++b) {
      const int o = b - a + degree_, s = c - a + degree_;
      const size_t band = (static_cast<size_t>(o) * 2 * degree_ + s) * static_cast<size_t>(size_);
      // The product of the two values first: then law (3) holds bit by bit.
      band_[band + static_cast<size_t>(table.first(span) + a)] +=
          weight * (table.values(span, a)[g] * table.values(span, b)[g]);
    }
  }
}

VolumeContraction::VolumeContraction(const PatchModel& model) : point_count_(model.points.size()) {
  ISOCHOR_REQUIRE(closure(model).closed, model.patches.size());
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, point_count_);
    ISOCHOR_REQUIRE(patch.weights.empty(), patch.handle);
    patches_.push_back(
        {TauTensor(patch.u_knots), TauTensor(patch.v_knots), patch.points, patch.sign()});
  }
}

void VolumeContraction::add_patch(const PatchTensors& patch, const std::vector<Vec3>& points,
                                  std::vector<Vec3>& rows) const {
  const int n = patch.u.size(), m = patch.v.size(), d = patch.u.degree();
  const auto place = [&](int i, int j) {
    return static_cast<size_t>(patch.points[static_cast<size_t>(i) * m + j]);
  };
  Rows along_u(n - 1, m, patch.v.degree());
  for (int i = 0; i + 1 < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Vec3 step = points[place(i + 1, j)] - points[place(i, j)];
      for (int axis = 0; axis < 3; ++axis) along_u.row(i, axis)[j] = step[axis];
    }
  }
  Rows area(n, m, 0);
  Strip strip(patch.u, patch.v, along_u);
  for (int k = 0; k < n; ++k) {
    strip.enter_row([&](int j) -> const Vec3& { return points[place(k, j)]; });
    for (int j = std::max(0, k - d); j <= std::min(n - 2, k + d - 1); ++j) {
      const Rows& met = strip.areas_with(j);
      const auto [low, high] = strip.reach(k, j);
      for (int i = low; i <= high; ++i) {
        const double factor = patch.u(i, k, j);
        for (int axis = 0; axis < 3; ++axis) {
          add_multiple(area.row(i, axis), factor, met.row(0, axis), m);
        }
      }
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Vec3 a(area.row(i, 0)[j], area.row(i, 1)[j], area.row(i, 2)[j]);
      rows[place(i, j)] += patch.sign * a;
    }
  }
}

ValueAndGradient VolumeContraction::value_and_gradient(const std::vector<Vec3>& points) const {
  ISOCHOR_REQUIRE(points.size() == point_count_, points.size(), point_count_);
  ValueAndGradient result;
  result.gradient.assign(points.size(), Vec3::Zero());
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const PatchTensors& patch : patches_) {
    add_patch(patch, points, result.gradient);
    for (int id : patch.points) {
      low = std::min(low, points[static_cast<size_t>(id)].z());
      high = std::max(high, points[static_cast<size_t>(id)].z());
    }
  }
  // The third components sum to zero on a closed model: heights may be measured from anywhere.
  const double middle = 0.5 * (low + high);
  internal::CompensatedSum sum;
  for (size_t i = 0; i < points.size(); ++i) {
    sum.add((points[i].z() - middle) * result.gradient[i].z());
  }
  result.value = sum.total();
  return result;
}

}  // namespace isochor
