#include "published.h"

#include <algorithm>
#include <cstring>

#include "isochor/base/error.h"
#include "isochor/volume/theta.h"

namespace isochor::bench {
namespace {

template <int Lanes>
struct Vector {
  using Type __attribute__((vector_size(Lanes * sizeof(double)))) = double;
};
template <>
struct Vector<1> {
  using Type = double;
};

template <int D, int Lanes>
struct Published final : GradientMethod {
  static constexpr int kWidth = 2 * D + 1;
  using Number = typename Vector<Lanes>::Type;

  // theta in three orders for each function o of one direction, rows L, columns R, both counted
  // from o - D; `lanes` neighbouring functions side by side.
  struct Tables {
    std::vector<double> olr, orl, lro;  // theta_oLR, theta_oRL, theta_LRo
  };

  explicit Published(const PatchGrid& grid) : u_(tables(grid.u, 1)), v_(tables(grid.v, Lanes)) {}

  static Tables tables(const KnotVector& knots, int lanes) {
    const ThetaTensor theta(knots);
    const int n = theta.size();
    Tables all;
    const auto fill = [&](std::vector<double>& table, auto&& entry) {
      const int blocks = (n + lanes - 1) / lanes;
      table.assign(static_cast<size_t>(blocks) * kWidth * kWidth * lanes, 0.0);
      for (int o = 0; o < n; ++o) {
        for (int l = std::max(0, o - D); l <= std::min(n - 1, o + D); ++l) {
          for (int r = std::max(0, o - D); r <= std::min(n - 1, o + D); ++r) {
            const int place = (l - o + D) * kWidth + (r - o + D);
            table[static_cast<size_t>((o / lanes * kWidth * kWidth + place) * lanes + o % lanes)] =
                entry(o, l, r);
          }
        }
      }
    };
    fill(all.olr, [&](int o, int l, int r) { return theta(o, l, r); });
    fill(all.orl, [&](int o, int l, int r) { return theta(o, r, l); });
    fill(all.lro, [&](int o, int l, int r) { return theta(l, r, o); });
    return all;
  }

  static Number load(const double* from) {
    Number number;
    std::memcpy(&number, from, sizeof number);
    return number;
  }

  // The tables of function o along u and of one block of functions along v.
  struct Pair {
    const double* u;
    const double* v;
  };
  static Pair pair(const std::vector<double>& u, const std::vector<double>& v, int i, int block) {
    return {&u[static_cast<size_t>(i) * kWidth * kWidth],
            &v[static_cast<size_t>(block) * kWidth * kWidth * Lanes]};
  }

  // sum over L and R of (a^u_LR a^v_LR - c^u_LR c^v_LR) left_L right_R, L and R pairs of indices.
  // `left` and `right` point at the corner of the (first) neighbourhood.
  static Number contract(Pair a, Pair c, const double* left, const double* right, size_t stride) {
    Number sum{};
    for (int lu = 0; lu < kWidth; ++lu) {
      // Functions L and R meet only when they are at most D apart; the same in the inner loops.
      for (int ru = std::max(0, lu - D); ru < std::min(kWidth, lu + D + 1); ++ru) {
        const double a_u = a.u[lu * kWidth + ru], c_u = c.u[lu * kWidth + ru];
        const double* left_row = left + lu * stride;
        const double* right_row = right + ru * stride;
#pragma GCC unroll 11
        for (int lv = 0; lv < kWidth; ++lv) {
          Number inner{};
          for (int rv = std::max(0, lv - D); rv < std::min(kWidth, lv + D + 1); ++rv) {
            const int at = (lv * kWidth + rv) * Lanes;
            inner += (a_u * load(a.v + at) - c_u * load(c.v + at)) * load(right_row + rv);
          }
          sum += load(left_row + lv) * inner;
        }
      }
    }
    return sum;
  }

  double run(const PatchGrid& grid, Columns& areas) const override {
    const int n = grid.rows(), m = grid.columns();
    const auto stride = static_cast<size_t>(m) + 2 * D + Lanes;
    Columns halo;
    for (size_t axis = 0; axis < 3; ++axis) {
      halo[axis].assign((static_cast<size_t>(n) + 2 * D) * stride, 0.0);
      for (int i = 0; i < n; ++i) {
        std::copy_n(&grid.poles[axis][static_cast<size_t>(i) * m], m,
                    &halo[axis][static_cast<size_t>(i + D) * stride + D]);
      }
      areas[axis].resize(grid.count());
    }
    double volume = 0.0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; j += Lanes) {
        const size_t corner = static_cast<size_t>(i) * stride + j;
        const double* x = &halo[0][corner];
        const double* y = &halo[1][corner];
        const double* z = &halo[2][corner];
        const int block = j / Lanes;
        const Pair ab = pair(u_.orl, v_.olr, i, block), ba = pair(u_.olr, v_.orl, i, block);
        const Pair bc = pair(u_.lro, v_.orl, i, block), cb = pair(u_.orl, v_.lro, i, block);
        // The integral of z x_u y_v - z x_v y_u, differentiated by the pole's x, y and z.
        const Number sums[3] = {contract(bc, cb, y, z, stride), contract(cb, bc, x, z, stride),
                                contract(ab, ba, x, y, stride)};
        const size_t at = static_cast<size_t>(i) * m + j;
        const auto left = static_cast<size_t>(std::min(Lanes, m - j));
        for (size_t axis = 0; axis < 3; ++axis) {
          std::memcpy(&areas[axis][at], &sums[axis], left * sizeof(double));
        }
        for (size_t lane = 0; lane < left; ++lane) {
          volume += grid.poles[2][at + lane] * areas[2][at + lane];
        }
      }
    }
    return volume;
  }

  Tables u_, v_;
};

template <int Lanes>
std::unique_ptr<GradientMethod> make(const PatchGrid& grid) {
  const int degree = grid.u.degree();
  ISOCHOR_REQUIRE(degree == grid.v.degree() && degree <= 5, degree, grid.v.degree());
  switch (degree) {
    case 1:
      return std::make_unique<Published<1, Lanes>>(grid);
    case 2:
      return std::make_unique<Published<2, Lanes>>(grid);
    case 3:
      return std::make_unique<Published<3, Lanes>>(grid);
    case 4:
      return std::make_unique<Published<4, Lanes>>(grid);
    default:
      return std::make_unique<Published<5, Lanes>>(grid);
  }
}

}  // namespace

std::unique_ptr<GradientMethod> published_method(const PatchGrid& grid) { return make<1>(grid); }
std::unique_ptr<GradientMethod> published_method_simd(const PatchGrid& grid) {
  return make<4>(grid);
}

}  // namespace isochor::bench
