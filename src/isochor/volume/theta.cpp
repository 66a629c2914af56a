#include "isochor/volume/theta.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/span_table.h"

namespace isochor {
namespace {

// Calls visit(index) for the functions that overlap function i.
template <typename Visit>
void for_each_neighbour(const ThetaTensor& theta, int i, const Visit& visit) {
  const int first = std::max(0, i - theta.degree());
  const int last = std::min(theta.size() - 1, i + theta.degree());
  for (int j = first; j <= last; ++j) visit(j);
}

// Calls visit(i, j, coefficient) with the double indices i = (iu, iv), j, and the integral of eq. 8
// for x_i y_j z_k: theta^u_{ju ku iu} theta^v_{iv kv jv} - theta^u_{iu ku ju} theta^v_{jv kv iv}.
template <typename Visit>
void contract_around(const Patch& patch, const ThetaTensor& u, const ThetaTensor& v, int ku, int kv,
                     const Visit& visit) {
  for_each_neighbour(u, ku, [&](int iu) {
    for_each_neighbour(u, ku, [&](int ju) {
      const double x_slope = u(ju, ku, iu);
      const double y_slope = u(iu, ku, ju);
      if (x_slope == 0.0 && y_slope == 0.0) return;
      for_each_neighbour(v, kv, [&](int iv) {
        for_each_neighbour(v, kv, [&](int jv) {
          const double c = x_slope * v(iv, kv, jv) - y_slope * v(jv, kv, iv);
          visit(patch.point(iu, iv), patch.point(ju, jv), c);
        });
      });
    });
  });
}

template <typename Visit>
void for_each_term(const PatchModel& model, const std::vector<Vec3>& points, const Visit& visit) {
  ISOCHOR_REQUIRE(points.size() == model.points.size(), points.size(), model.points.size());
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, points.size());
    ISOCHOR_REQUIRE(patch.weights.empty(), patch.handle);
    const ThetaTensor u(patch.u_knots);
    const ThetaTensor v(patch.v_knots);
    for (int ku = 0; ku < patch.u_size(); ++ku) {
      for (int kv = 0; kv < patch.v_size(); ++kv) {
        const int k = patch.point(ku, kv);
        contract_around(patch, u, v, ku, kv,
                        [&](int i, int j, double c) { visit(i, j, k, patch.sign() * c); });
      }
    }
  }
}

}  // namespace

ThetaTensor::ThetaTensor(const KnotVector& knots)
    : degree_(knots.degree()),
      size_(knots.size()),
      band_(static_cast<size_t>(size_) * (2 * degree_ + 1) * (2 * degree_ + 1)) {
  const SpanTable table(knots, exact_gauss_points(degree_));
  const auto width = static_cast<size_t>(2 * degree_ + 1);
  for (int s = 0; s < table.spans(); ++s) {
    for (int a = 0; a <= degree_; ++a) {
      for (int b = 0; b <= degree_; ++b) {
        for (int c = 0; c <= degree_; ++c) {
          double sum = 0.0;
          for (int g = 0; g < table.gauss_points(); ++g) {
            // The product of the two values first: then law (1) holds bit by bit.
            const double product = table.values(s, a)[g] * table.values(s, b)[g];
            sum += table.weights(s)[g] * product * table.slopes(s, c)[g];
          }
          const auto i = static_cast<size_t>(table.first(s) + a);
          band_[(i * width + static_cast<size_t>(b - a + degree_)) * width +
                static_cast<size_t>(c - a + degree_)] += sum;
        }
      }
    }
  }
}

double theta_volume(const PatchModel& model, const std::vector<Vec3>& points) {
  double sum = 0.0;
  for_each_term(model, points, [&](int i, int j, int k, double c) {
    sum += c * points[static_cast<size_t>(i)].x() * points[static_cast<size_t>(j)].y() *
           points[static_cast<size_t>(k)].z();
  });
  return sum;
}

std::vector<Vec3> theta_gradient(const PatchModel& model, const std::vector<Vec3>& points) {
  std::vector<Vec3> rows(points.size(), Vec3::Zero());
  for_each_term(model, points, [&](int i, int j, int k, double c) {
    const double x = points[static_cast<size_t>(i)].x();
    const double y = points[static_cast<size_t>(j)].y();
    const double z = points[static_cast<size_t>(k)].z();
    rows[static_cast<size_t>(i)].x() += c * y * z;
    rows[static_cast<size_t>(j)].y() += c * x * z;
    rows[static_cast<size_t>(k)].z() += c * x * y;
  });
  return rows;
}

}  // namespace isochor
