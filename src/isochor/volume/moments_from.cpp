// From the ten integrals to centroid, tensors and principal axes, with their bounds.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/moments.h"

namespace isochor {
namespace {

// The backward error of the eigenvalue iteration is taken as this many roundings of the tensor.
constexpr double kEigenRoundings = 32.0;
// Roundings of the few products and sums of one entry.
constexpr double kEntryRoundings = 4.0;

// Where entry (i, j) of the symmetric tensor is among the ten integrals.
constexpr size_t kSecondAt[3][3] = {{4, 5, 6}, {5, 7, 8}, {6, 8, 9}};

std::string digits(double x) {
  std::ostringstream out;
  out.precision(6);
  out << x;
  return out.str();
}

// C_ij = M_ij - M_i M_j / V, entry by entry with its bound.
void set_second(const MomentIntegrals& m, Moments& result) {
  const double volume = m.value[0];
  const double least = std::abs(volume) - m.bound[0];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto a = static_cast<size_t>(i) + 1;
      const auto b = static_cast<size_t>(j) + 1;
      const size_t k = kSecondAt[i][j];
      const double shift = m.value[a] * m.value[b] / volume;
      result.second(i, j) = m.value[k] - shift;
      const double uncertain = std::abs(m.value[a]) * m.bound[b] +
                               std::abs(m.value[b]) * m.bound[a] + m.bound[a] * m.bound[b] +
                               std::abs(shift) * m.bound[0];
      const double rounding =
          kEntryRoundings * kUnitRoundoff * (std::abs(m.value[k]) + std::abs(shift));
      result.second_bound(i, j) = m.bound[k] + 1.01 * uncertain / least + rounding;
    }
  }
}

// J = trace(C) I - C without the cancelling terms: J_xx = C_yy + C_zz.
void set_inertia(Moments& result) {
  result.inertia = -result.second;
  result.inertia_bound = result.second_bound;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    result.inertia(i, i) = result.second(j, j) + result.second(k, k);
    result.inertia_bound(i, i) = result.second_bound(j, j) + result.second_bound(k, k) +
                                 kUnitRoundoff * std::abs(result.inertia(i, i));
  }
}

Vec3 pointing_forward(const Vec3& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0.0 ? Vec3(-axis) : axis;
}

void set_principal(Moments& result) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(result.inertia);
  result.principal = solver.eigenvalues();
  const Vec3 first = pointing_forward(solver.eigenvectors().col(0));
  const Vec3 second = pointing_forward(solver.eigenvectors().col(1));
  result.axes << first, second, first.cross(second);
  result.axes.array() += 0.0;  // no negative zeros in print
  result.principal_bound =
      result.inertia_bound.norm() + kEigenRoundings * kUnitRoundoff * result.inertia.norm();
  // Davis and Kahan: sin(angle) <= error / (gap - error).
  const double quarter_turn = std::acos(0.0);
  for (int k = 0; k < 3; ++k) {
    double gap = std::numeric_limits<double>::infinity();
    for (int other = 0; other < 3; ++other) {
      if (other == k) continue;
      gap = std::min(gap, std::abs(result.principal[other] - result.principal[k]));
    }
    const double room = gap - 2.0 * result.principal_bound;
    const double sine = room > 0.0 ? result.principal_bound / room : 1.0;
    result.axis_bound[k] =
        sine < 1.0 ? std::asin(sine) + kEigenRoundings * kUnitRoundoff : quarter_turn;
  }
}

}  // namespace

Moments moments_from(const MomentIntegrals& m) {
  if (std::isinf(m.bound[0])) {
    throw InputError("", "", "the outline of a face does not close, so its moments are not known");
  }
  const double least = std::abs(m.value[0]) - m.bound[0];
  if (!(least > 0.0) || !std::isfinite(m.value[0])) {
    throw InputError("", "",
                     "the volume " + digits(m.value[0]) +
                         " is not different from zero (error at most " + digits(m.bound[0]) +
                         "), so there is no centroid");
  }
  Moments result;
  result.volume = {m.value[0], m.bound[0]};
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<size_t>(i) + 1;
    const double shift = m.value[a] / m.value[0];
    result.centroid[i] = m.origin[i] + shift;
    result.centroid_bound[i] =
        1.01 * (m.bound[a] + std::abs(shift) * m.bound[0]) / least +
        kUnitRoundoff * (std::abs(result.centroid[i]) + 2.0 * std::abs(shift));
  }
  set_second(m, result);
  set_inertia(result);
  set_principal(result);
  return result;
}

}  // namespace isochor
