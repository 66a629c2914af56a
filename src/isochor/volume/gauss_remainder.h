// How far Gauss quadrature on a patch with weights can be from the integral, whatever its poles.
//
// Symbols: on a cell with parameters (t, s) in [0, 1]^2, W = sum w_ij B_i(t) B_j(s) is the
// denominator in Bernstein form, all w_ij > 0, degree d in t ("rows") and e in s ("columns"). The
// coordinates are X / W, Y / W, Z / W, where |X_ij| <= r_x w_ij and so on: true as soon as all
// poles of the element are within r_x of the origin of x, since both nets arise by the same convex
// combinations. The integrand is f = Z det[X Y W; X_t Y_t W_t; X_s Y_s W_s] / W^4.
//
// Law (1), proven in docs/volume.md, "Bounds for patches with weights": for each fixed s the Gauss
//     rule with n >= 2 points in t misses the integral of f by at most bound(n) r_x r_y r_z.
// Law (2): the bound of a net holds on every part [s0, s1] of the columns' direction.
// Law (3): factors common to a column (w_ij = a_i b_j) or to all weights do not matter for the rate
//     of convergence.
#pragma once

#include <utility>
#include <vector>

#include "isochor/bspline/knots.h"

namespace isochor::internal {

// Bernstein coefficients of a positive polynomial, (rows) x (columns), row-major.
struct WeightNet {
  int rows = 0;
  int columns = 0;
  std::vector<double> at;
  bool equal_rows = false;     // exactly: W does not depend on t
  bool equal_columns = false;  // nor on s

  double operator()(int i, int j) const {
    return at[static_cast<size_t>(i) * static_cast<size_t>(columns) + static_cast<size_t>(j)];
  }
};

// The net of the weights (#u x #v) on the su-th and sv-th non-empty spans; rows run along u.
// Convex combinations only: relative error at most 6 (du + dv) unit roundoffs.
WeightNet net_of(const KnotVector& u, const KnotVector& v, const std::vector<double>& weights,
                 int su, int sv);
// The same for a curve: one column.
WeightNet net_of(const KnotVector& knots, const std::vector<double>& weights, int s);
WeightNet transposed(const WeightNet& net);
// How often a net may be halved before its rounding outgrows what the bounds allow for.
inline constexpr int kMaxHalvings = 20;
// The nets over t in [0, 1/2] and [1/2, 1]; du unit roundoffs more.
std::pair<WeightNet, WeightNet> halves(const WeightNet& net);
// The net over t in [begin, end], the ends of a Cell that came about by halving.
WeightNet part_of(const WeightNet& net, double begin, double end);

// kVolume: f as above. kArea: f = x y_t on a curve (one column); bounds are over r_x r_y.
enum class Integrand { kVolume, kArea };

class GaussRemainder {
 public:
  explicit GaussRemainder(const WeightNet& net, Integrand integrand = Integrand::kVolume);

  // Law (1). Infinite for n < 2, zero when f is a polynomial in t that n points integrate exactly.
  double bound(int n) const;
  // The fewest points (at least `least`, 2 or more) with bound(n) <= tolerance; most + 1 when there
  // are none.
  int points(double tolerance, int least, int most) const;

 private:
  // On the ellipse with half axes' sum rho: |f| C / (1 - rho^-2) <= exp(log_factor).
  struct Ellipse {
    double log_rho;
    double log_factor;
  };
  int exact_points_ = 0;  // not zero: f is a polynomial in t
  double on_the_cell_ = 0.0;
  std::vector<Ellipse> ellipses_;
};

}  // namespace isochor::internal
