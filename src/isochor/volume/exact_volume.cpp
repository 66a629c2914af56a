#include "isochor/volume/exact_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/span_polynomials.h"

namespace isochor {

using internal::SpanPolynomials;

namespace {

constexpr int kMantissaBits = std::numeric_limits<double>::digits;
constexpr int kNoExponent = std::numeric_limits<int>::max();

// A rectangular table of integers, row by row.
class Table {
 public:
  Table(size_t rows, size_t columns) : columns_(columns), entries_(rows * columns) {}
  Integer& operator()(size_t i, size_t j) { return entries_[i * columns_ + j]; }
  const Integer& operator()(size_t i, size_t j) const { return entries_[i * columns_ + j]; }

 private:
  size_t columns_;
  std::vector<Integer> entries_;
};

struct ExactPatch {
  std::shared_ptr<const SpanPolynomials> u, v;
  std::vector<int> points;
  int sign = 1;
  std::string handle;
  bool polynomial = true;

  int point(int su, int sv, size_t i, size_t j) const {
    const auto row = static_cast<size_t>(u->first(su)) + i;
    const auto column = static_cast<size_t>(v->first(sv)) + j;
    return points[row * static_cast<size_t>(v->knots().size()) + column];
  }
};

// x = mantissa 2^exponent with an odd mantissa; kNoExponent for zero.
struct Dyadic {
  long mantissa = 0;
  int exponent = kNoExponent;
};

Dyadic decompose(double x) {
  if (x == 0.0) return {};
  ISOCHOR_REQUIRE(std::isfinite(x), x);
  int exponent = 0;
  auto mantissa = static_cast<long>(std::ldexp(std::frexp(x, &exponent), kMantissaBits));
  exponent -= kMantissaBits;
  for (; mantissa % 2 == 0; mantissa /= 2) ++exponent;
  return {mantissa, exponent};
}

// One element of one patch on integers: coordinates in the power basis, scaled by `scale`.
class ExactElement {
 public:
  ExactElement(const ExactPatch& patch, int su, int sv, const std::vector<Vec3>& points)
      : patch_(patch),
        su_(su),
        sv_(sv),
        nu_(static_cast<size_t>(patch.u->degree()) + 1),
        nv_(static_cast<size_t>(patch.v->degree()) + 1),
        coordinates_(3, Table(nu_, nv_)) {
    read_points(points);
    u_common_ = common_multiple(3 * patch.u->degree());
    v_common_ = common_multiple(3 * patch.v->degree());
  }

  Rational value() const {
    const Table gradient = z_gradient();
    Integer sum;
    for (size_t a = 0; a < nu_; ++a) {
      for (size_t b = 0; b < nv_; ++b) sum.add_product(coordinates_[2](a, b), gradient(a, b));
    }
    return unscaled(sum, 3);
  }

  // Calls add(point, axis, d value / d coordinate) for every point of the element.
  template <typename Add>
  void gradient(const Add& add) const {
    const std::array<Table, 3> in_power_basis = {x_gradient(), y_gradient(), z_gradient()};
    for (size_t axis = 0; axis < 3; ++axis) {
      const Table rows = to_points(in_power_basis[axis]);
      for (size_t i = 0; i < nu_; ++i) {
        for (size_t j = 0; j < nv_; ++j) {
          add(patch_.point(su_, sv_, i, j), axis, unscaled(rows(i, j), 2));
        }
      }
    }
  }

 private:
  static Integer common_multiple(int up_to) {
    Integer result(1);
    for (long k = 2; k <= up_to; ++k) result = lcm(result, k);
    return result;
  }

  const Integer& u_coefficient(size_t j, size_t k) const {
    return patch_.u->coefficient(su_, static_cast<int>(j), static_cast<int>(k));
  }
  const Integer& v_coefficient(size_t j, size_t k) const {
    return patch_.v->coefficient(sv_, static_cast<int>(j), static_cast<int>(k));
  }

  void read_points(const std::vector<Vec3>& points) {
    std::vector<std::array<Dyadic, 3>> parts;
    exponent_ = kNoExponent;
    for (size_t i = 0; i < nu_; ++i) {
      for (size_t j = 0; j < nv_; ++j) {
        const Vec3& p = points[static_cast<size_t>(patch_.point(su_, sv_, i, j))];
        parts.push_back({decompose(p.x()), decompose(p.y()), decompose(p.z())});
        for (const Dyadic& part : parts.back()) exponent_ = std::min(exponent_, part.exponent);
      }
    }
    if (exponent_ == kNoExponent) exponent_ = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      Table scaled(nu_, nv_);
      for (size_t k = 0; k < parts.size(); ++k) {
        const Dyadic& part = parts[k][axis];
        if (part.mantissa == 0) continue;
        scaled(k / nv_, k % nv_) =
            Integer(part.mantissa).shifted(static_cast<unsigned long>(part.exponent - exponent_));
      }
      coordinates_[axis] = to_power_basis(scaled);
    }
  }

  // Coefficients of functions to coefficients of powers, and the transposed map.
  Table to_power_basis(const Table& block) const {
    Table half(nu_, nv_);
    Table result(nu_, nv_);
    for (size_t i = 0; i < nu_; ++i) {
      for (size_t l = 0; l < nv_; ++l) {
        for (size_t j = 0; j < nv_; ++j) half(i, l).add_product(block(i, j), v_coefficient(j, l));
      }
    }
    for (size_t k = 0; k < nu_; ++k) {
      for (size_t l = 0; l < nv_; ++l) {
        for (size_t i = 0; i < nu_; ++i) result(k, l).add_product(half(i, l), u_coefficient(i, k));
      }
    }
    return result;
  }
  Table to_points(const Table& powers) const {
    Table half(nu_, nv_);
    Table result(nu_, nv_);
    for (size_t k = 0; k < nu_; ++k) {
      for (size_t j = 0; j < nv_; ++j) {
        for (size_t l = 0; l < nv_; ++l) half(k, j).add_product(powers(k, l), v_coefficient(j, l));
      }
    }
    for (size_t i = 0; i < nu_; ++i) {
      for (size_t j = 0; j < nv_; ++j) {
        for (size_t k = 0; k < nu_; ++k) result(i, j).add_product(half(k, j), u_coefficient(i, k));
      }
    }
    return result;
  }

  // out(a + c, b + d) += factor(a, b, c, d) f(a, b) g(c, d) over all pairs of powers.
  template <typename Factor>
  void convolve(const Table& f, const Table& g, const Factor& factor, Table& out) const {
    for (size_t a = 0; a < nu_; ++a) {
      for (size_t b = 0; b < nv_; ++b) {
        if (f(a, b).is_zero()) continue;
        for (size_t c = 0; c < nu_; ++c) {
          for (size_t d = 0; d < nv_; ++d) {
            const long times = factor(static_cast<long>(a), static_cast<long>(b),
                                      static_cast<long>(c), static_cast<long>(d));
            if (times == 0 || g(c, d).is_zero()) continue;
            out(a + c, b + d).add_product(f(a, b) * g(c, d), times);
          }
        }
      }
    }
  }

  // result(k, l) = sum over (s, r) of product(s, r) / ((s + k) (r + l)), times both common
  // multiples; terms with a vanishing denominator are absent (their coefficient is zero).
  Table moments(const Table& product) const {
    const size_t su = 2 * nu_ - 1;
    const size_t sv = 2 * nv_ - 1;
    Table half(su, nv_);
    Table result(nu_, nv_);
    for (size_t l = 0; l < nv_; ++l) {
      for (size_t r = l == 0 ? 1 : 0; r < sv; ++r) {
        const Integer factor = v_common_.divided_exactly(static_cast<long>(r + l));
        for (size_t s = 0; s < su; ++s) half(s, l).add_product(product(s, r), factor);
      }
    }
    for (size_t k = 0; k < nu_; ++k) {
      for (size_t s = k == 0 ? 1 : 0; s < su; ++s) {
        const Integer factor = u_common_.divided_exactly(static_cast<long>(s + k));
        for (size_t l = 0; l < nv_; ++l) result(k, l).add_product(half(s, l), factor);
      }
    }
    return result;
  }

  Table z_gradient() const {
    Table jacobian(2 * nu_ - 1, 2 * nv_ - 1);
    convolve(
        coordinates_[0], coordinates_[1],
        [](long e, long f, long c, long d) { return e * d - c * f; }, jacobian);
    return moments(jacobian);
  }

  // x_ef is multiplied by sum z_ab y_cd (e d - c f) / (...): the parts with d and with c apart.
  Table x_gradient() const { return side_gradient(coordinates_[1], 1); }
  Table y_gradient() const { return side_gradient(coordinates_[0], -1); }

  Table side_gradient(const Table& other, long sense) const {
    Table with_v(2 * nu_ - 1, 2 * nv_ - 1);
    Table with_u(2 * nu_ - 1, 2 * nv_ - 1);
    convolve(
        coordinates_[2], other, [](long, long, long, long d) { return d; }, with_v);
    convolve(
        coordinates_[2], other, [](long, long, long c, long) { return c; }, with_u);
    const Table first = moments(with_v);
    const Table second = moments(with_u);
    Table result(nu_, nv_);
    for (size_t e = 0; e < nu_; ++e) {
      for (size_t f = 0; f < nv_; ++f) {
        result(e, f).add_product(first(e, f), sense * static_cast<long>(e));
        result(e, f).add_product(second(e, f), -sense * static_cast<long>(f));
      }
    }
    return result;
  }

  // Undoes the scaling of a sum of products of three basis functions and `factors` coordinates.
  Rational unscaled(const Integer& number, int factors) const {
    const Integer one = patch_.u->denominator(su_) * patch_.v->denominator(sv_);
    const Rational result(patch_.sign > 0 ? number : -number,
                          one * one * one * u_common_ * v_common_);
    return result.scaled_by_power_of_two(static_cast<long>(exponent_) * factors);
  }

  const ExactPatch& patch_;
  int su_, sv_;
  size_t nu_, nv_;
  std::vector<Table> coordinates_;
  int exponent_ = 0;  // coordinates are integers times 2^exponent_
  Integer u_common_, v_common_;
};

}  // namespace

struct ExactVolume::Data {
  std::vector<ExactPatch> patches;
  size_t point_count = 0;

  // Calls visit(patch, su, sv) for all elements; `wanted` chooses, and refuses weights.
  template <typename Wanted, typename Visit>
  void for_each_element(const Wanted& wanted, const Visit& visit) const {
    for (const ExactPatch& patch : patches) {
      for (int su = 0; su < patch.u->spans(); ++su) {
        for (int sv = 0; sv < patch.v->spans(); ++sv) {
          if (!wanted(patch, su, sv)) continue;
          if (!patch.polynomial) {
            throw InputError("", "patch " + patch.handle,
                             "has weights, so its volume is not known as an exact rational number");
          }
          visit(patch, su, sv);
        }
      }
    }
  }
};

ExactVolume::ExactVolume(const PatchModel& model) {
  auto data = std::make_shared<Data>();
  data->point_count = model.points.size();
  std::vector<std::shared_ptr<const SpanPolynomials>> tables;
  const auto table_for = [&](const KnotVector& knots) {
    for (const auto& known : tables) {
      if (known->knots() == knots) return known;
    }
    tables.push_back(std::make_shared<const SpanPolynomials>(knots));
    return tables.back();
  };
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, model.points.size());
    ExactPatch entry;
    const auto& w = patch.weights;
    entry.polynomial = std::all_of(w.begin(), w.end(), [&](double each) { return each == w[0]; });
    entry.u = table_for(patch.u_knots);
    entry.v = table_for(patch.v_knots);
    entry.points = patch.points;
    entry.sign = patch.reversed ? -1 : 1;
    entry.handle = patch.handle;
    data->patches.push_back(std::move(entry));
  }
  data_ = std::move(data);
}

bool ExactVolume::polynomial() const {
  return std::all_of(data_->patches.begin(), data_->patches.end(),
                     [](const ExactPatch& patch) { return patch.polynomial; });
}

Rational ExactVolume::value(const std::vector<Vec3>& points) const {
  ISOCHOR_REQUIRE(points.size() == data_->point_count, points.size(), data_->point_count);
  Rational sum;
  data_->for_each_element([](const ExactPatch&, int, int) { return true; },
                          [&](const ExactPatch& patch, int su, int sv) {
                            sum += ExactElement(patch, su, sv, points).value();
                          });
  return sum;
}

std::vector<ExactVec3> ExactVolume::gradient(const std::vector<Vec3>& points) const {
  ISOCHOR_REQUIRE(points.size() == data_->point_count, points.size(), data_->point_count);
  std::vector<ExactVec3> rows(points.size());
  data_->for_each_element([](const ExactPatch&, int, int) { return true; },
                          [&](const ExactPatch& patch, int su, int sv) {
                            ExactElement(patch, su, sv, points)
                                .gradient([&](int point, size_t axis, const Rational& term) {
                                  rows[static_cast<size_t>(point)][axis] += term;
                                });
                          });
  return rows;
}

Rational ExactVolume::change(const std::vector<Vec3>& before,
                             const std::vector<Vec3>& after) const {
  ISOCHOR_REQUIRE(before.size() == data_->point_count, before.size(), data_->point_count);
  ISOCHOR_REQUIRE(after.size() == data_->point_count, after.size(), data_->point_count);
  const auto touched = [&](const ExactPatch& patch, int su, int sv) {
    for (size_t i = 0; i <= static_cast<size_t>(patch.u->degree()); ++i) {
      for (size_t j = 0; j <= static_cast<size_t>(patch.v->degree()); ++j) {
        const auto id = static_cast<size_t>(patch.point(su, sv, i, j));
        if (before[id] != after[id]) return true;
      }
    }
    return false;
  };
  Rational sum;
  data_->for_each_element(touched, [&](const ExactPatch& patch, int su, int sv) {
    sum += ExactElement(patch, su, sv, after).value();
    sum -= ExactElement(patch, su, sv, before).value();
  });
  return sum;
}

}  // namespace isochor
