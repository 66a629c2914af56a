#include "gauss_simd.h"

#include <immintrin.h>

#include <algorithm>
#include <cstring>

#include "isochor/base/error.h"
#include "isochor/volume/span_table.h"

namespace isochor::bench {
namespace {

using Four = __m256d;
constexpr int kLanes = 4;
constexpr int kStripSpans = 64;  // of one pass down the grid: its buffers stay in the caches

template <int D>
struct GaussSimd final : GradientMethod {
  static constexpr int kPoints = (3 * D + 1) / 2;
  static constexpr int kColumns = kStripSpans + 8;  // of a strip; D of overlap, whole vectors

  // One direction. Along u the functions of a span meet one scalar each; along v those of four
  // neighbouring spans are the lanes of a vector.
  struct Basis {
    // [block of spans][point][function][lane]; the slopes carry the weights of the rule.
    std::vector<double> values, slopes;
    int spans;
  };

  // What one strip needs of one row of elements.
  struct Buffers {
    alignas(32) double value[kPoints][3][kColumns];  // sum over u of B p
    alignas(32) double slope[kPoints][3][kColumns];  // weight * sum over u of B' p
    alignas(32) double normal[kPoints][kPoints][3][kLanes];
    // Contributions of span t to function t + b, at [D + t]; zeros before and after.
    alignas(32) double area[kPoints][3][D + 1][kColumns + D];
  };

  explicit GaussSimd(const PatchGrid& grid) : u_(basis(grid.u, 1)), v_(basis(grid.v, kLanes)) {}

  static Basis basis(const KnotVector& knots, int lanes) {
    const SpanTable table(knots, kPoints);
    Basis basis;
    basis.spans = table.spans();
    const size_t blocks = static_cast<size_t>((basis.spans + lanes - 1) / lanes);
    const size_t size = blocks * kPoints * (D + 1) * static_cast<size_t>(lanes);
    basis.values.assign(size, 0.0);
    basis.slopes.assign(size, 0.0);
    for (int s = 0; s < basis.spans; ++s) {
      ISOCHOR_REQUIRE(table.first(s) == s, s);
      for (int g = 0; g < kPoints; ++g) {
        for (int b = 0; b <= D; ++b) {
          const size_t at =
              (((static_cast<size_t>(s / lanes) * kPoints + g) * (D + 1)) + b) * lanes + s % lanes;
          basis.values[at] = table.values(s, b)[g];
          basis.slopes[at] = table.slopes(s, b)[g] * table.weights(s)[g];
        }
      }
    }
    return basis;
  }

  // One row of elements along u: D + 1 rows of poles, all Gauss points, columns [0, count).
  void contract_rows(const PatchGrid& grid, int span, int begin, int count, Buffers& to) const {
    const double* values = &u_.values[static_cast<size_t>(span) * kPoints * (D + 1)];
    const double* slopes = &u_.slopes[static_cast<size_t>(span) * kPoints * (D + 1)];
    const auto m = static_cast<size_t>(grid.columns());
    // The next row of elements needs one more row of poles, too far away for the hardware to guess.
    const size_t ahead = static_cast<size_t>(std::min(D + 1, grid.rows() - 1 - span)) * m;
    for (int axis = 0; axis < 3; ++axis) {
      const double* poles = &grid.poles[static_cast<size_t>(axis)][span * m + begin];
      for (int j = 0; j < count; j += kLanes) {
        Four p[D + 1];
        for (int a = 0; a <= D; ++a) p[a] = load_columns(poles + a * m + j, count - j);
        __builtin_prefetch(poles + ahead + j);
#pragma GCC unroll 8
        for (int g = 0; g < kPoints; ++g) {
          Four value = _mm256_mul_pd(_mm256_set1_pd(values[g * (D + 1)]), p[0]);
          Four slope = _mm256_mul_pd(_mm256_set1_pd(slopes[g * (D + 1)]), p[0]);
#pragma GCC unroll 8
          for (int a = 1; a <= D; ++a) {
            value = _mm256_fmadd_pd(_mm256_set1_pd(values[g * (D + 1) + a]), p[a], value);
            slope = _mm256_fmadd_pd(_mm256_set1_pd(slopes[g * (D + 1) + a]), p[a], slope);
          }
          _mm256_store_pd(&to.value[g][axis][j], value);
          _mm256_store_pd(&to.slope[g][axis][j], slope);
        }
      }
    }
  }

  static Four load_columns(const double* from, int left) {
    if (left >= kLanes) return _mm256_loadu_pd(from);
    alignas(32) double part[kLanes] = {};
    std::memcpy(part, from, static_cast<size_t>(left) * sizeof(double));
    return _mm256_load_pd(part);
  }

  // S_u x S_v at all Gauss points of the four elements whose first columns are t .. t + 3.
  void normals(int block, int t, Buffers& at) const {
    const size_t table = static_cast<size_t>(block) * kPoints * (D + 1) * kLanes;
    for (int gv = 0; gv < kPoints; ++gv) {
      Four values[D + 1], slopes[D + 1];
#pragma GCC unroll 8
      for (int b = 0; b <= D; ++b) {
        const size_t entry = table + static_cast<size_t>(gv * (D + 1) + b) * kLanes;
        values[b] = _mm256_loadu_pd(&v_.values[entry]);
        slopes[b] = _mm256_loadu_pd(&v_.slopes[entry]);
      }
      for (int gu = 0; gu < kPoints; ++gu) {
        Four su[3], sv[3];
#pragma GCC unroll 3
        for (int axis = 0; axis < 3; ++axis) {
          const double* slope = &at.slope[gu][axis][t];
          const double* value = &at.value[gu][axis][t];
          su[axis] = _mm256_mul_pd(values[0], _mm256_loadu_pd(slope));
          sv[axis] = _mm256_mul_pd(slopes[0], _mm256_loadu_pd(value));
#pragma GCC unroll 8
          for (int b = 1; b <= D; ++b) {
            su[axis] = _mm256_fmadd_pd(values[b], _mm256_loadu_pd(slope + b), su[axis]);
            sv[axis] = _mm256_fmadd_pd(slopes[b], _mm256_loadu_pd(value + b), sv[axis]);
          }
        }
#pragma GCC unroll 3
        for (int axis = 0; axis < 3; ++axis) {
          const int next = (axis + 1) % 3, last = (axis + 2) % 3;
          const Four minus = _mm256_mul_pd(su[last], sv[next]);
          _mm256_store_pd(at.normal[gu][gv][axis], _mm256_fmsub_pd(su[next], sv[last], minus));
        }
      }
    }
  }

  // Contracts the normals of one block with the functions of v.
  void contract_normals(int block, int t, Buffers& at) const {
    const double* values = &v_.values[static_cast<size_t>(block) * kPoints * (D + 1) * kLanes];
    for (int gu = 0; gu < kPoints; ++gu) {
      Four area[3][D + 1];
#pragma GCC unroll 8
      for (int gv = 0; gv < kPoints; ++gv) {
        const Four x = _mm256_load_pd(at.normal[gu][gv][0]);
        const Four y = _mm256_load_pd(at.normal[gu][gv][1]);
        const Four z = _mm256_load_pd(at.normal[gu][gv][2]);
#pragma GCC unroll 8
        for (int b = 0; b <= D; ++b) {
          const Four value = _mm256_loadu_pd(values + (gv * (D + 1) + b) * kLanes);
          area[0][b] = gv == 0 ? _mm256_mul_pd(value, x) : _mm256_fmadd_pd(value, x, area[0][b]);
          area[1][b] = gv == 0 ? _mm256_mul_pd(value, y) : _mm256_fmadd_pd(value, y, area[1][b]);
          area[2][b] = gv == 0 ? _mm256_mul_pd(value, z) : _mm256_fmadd_pd(value, z, area[2][b]);
        }
      }
#pragma GCC unroll 3
      for (int axis = 0; axis < 3; ++axis) {
#pragma GCC unroll 8
        for (int b = 0; b <= D; ++b) {
          _mm256_storeu_pd(&at.area[gu][axis][b][D + t], area[axis][b]);
        }
      }
    }
  }

  // Sends the areas of a row of elements back to its rows of poles.
  void spread_rows(const Buffers& from, int span, int begin, int count, const PatchGrid& grid,
                   Columns& areas) const {
    const auto m = static_cast<size_t>(grid.columns());
    const size_t ahead = static_cast<size_t>(std::min(D + 1, grid.rows() - 1 - span)) * m;
    const double* values = &u_.values[static_cast<size_t>(span) * kPoints * (D + 1)];
    for (int axis = 0; axis < 3; ++axis) {
      double* out = &areas[static_cast<size_t>(axis)][span * m + begin];
      for (int j = 0; j < count; j += kLanes) {
        __builtin_prefetch(out + ahead + j, 1);
        Four sums[D + 1] = {};
#pragma GCC unroll 8
        for (int g = 0; g < kPoints; ++g) {
          Four area = _mm256_loadu_pd(&from.area[g][axis][0][D + j]);
#pragma GCC unroll 8
          for (int b = 1; b <= D; ++b) {
            area = _mm256_add_pd(area, _mm256_loadu_pd(&from.area[g][axis][b][D + j - b]));
          }
#pragma GCC unroll 8
          for (int a = 0; a <= D; ++a) {
            sums[a] = _mm256_fmadd_pd(_mm256_set1_pd(values[g * (D + 1) + a]), area, sums[a]);
          }
        }
        for (int a = 0; a <= D; ++a) add_columns(out + a * m + j, sums[a], count - j);
      }
    }
  }

  static void add_columns(double* to, Four sum, int left) {
    if (left >= kLanes) {
      _mm256_storeu_pd(to, _mm256_add_pd(_mm256_loadu_pd(to), sum));
      return;
    }
    for (int lane = 0; lane < left; ++lane) to[lane] += sum[lane];
  }

  double run(const PatchGrid& grid, Columns& areas) const override {
    for (std::vector<double>& column : areas) column.assign(grid.count(), 0.0);
    const auto buffers = std::make_unique<Buffers>();
    for (int begin = 0; begin < v_.spans; begin += kStripSpans) {
      std::memset(buffers.get(), 0, sizeof(Buffers));
      const int spans = std::min(kStripSpans, v_.spans - begin);
      const int columns = spans + D;
      for (int span = 0; span < u_.spans; ++span) {
        contract_rows(grid, span, begin, columns, *buffers);
        for (int t = 0; t < spans; t += kLanes) {
          normals((begin + t) / kLanes, t, *buffers);
          contract_normals((begin + t) / kLanes, t, *buffers);
        }
        spread_rows(*buffers, span, begin, columns, grid, areas);
      }
    }
    double volume = 0.0;
    for (size_t i = 0; i < grid.count(); ++i) volume += grid.poles[2][i] * areas[2][i];
    return volume;
  }

  Basis u_, v_;
};

}  // namespace

std::unique_ptr<GradientMethod> gauss_method(const PatchGrid& grid) {
  const int degree = grid.u.degree();
  ISOCHOR_REQUIRE(degree == grid.v.degree() && degree <= 5, degree, grid.v.degree());
  switch (degree) {
    case 1:
      return std::make_unique<GaussSimd<1>>(grid);
    case 2:
      return std::make_unique<GaussSimd<2>>(grid);
    case 3:
      return std::make_unique<GaussSimd<3>>(grid);
    case 4:
      return std::make_unique<GaussSimd<4>>(grid);
    default:
      return std::make_unique<GaussSimd<5>>(grid);
  }
}

}  // namespace isochor::bench
