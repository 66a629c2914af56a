// Tensor-product B-spline surfaces, polynomial or rational.
//
// S(u,v) = sum_ij B_i(u) B_j(v) w_ij p_ij / sum_ij B_i(u) B_j(v) w_ij, all w_ij = 1 when no
// weights. Poles and weights are u-major: index i * #v + j, i along u, j along v.
#pragma once

#include <array>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/basis.h"
#include "isochor/bspline/knots.h"

namespace isochor {

// The four sides of a parameter rectangle.
enum class Side { kUBegin, kUEnd, kVBegin, kVEnd };
inline constexpr std::array<Side, 4> kSides = {Side::kUBegin, Side::kUEnd, Side::kVBegin,
                                               Side::kVEnd};
// True for the sides u = const, which run along v.
inline bool is_u_side(Side side) { return side == Side::kUBegin || side == Side::kUEnd; }
inline bool is_begin_side(Side side) { return side == Side::kUBegin || side == Side::kVBegin; }
// "u0", "u1", "v0", "v1".
const char* name_of(Side side);

// The two parameters.
enum class Direction { kU, kV };

// Position and partial derivatives at one parameter pair.
struct SurfaceDerivatives {
  Vec3 s = Vec3::Zero();
  Vec3 su = Vec3::Zero(), sv = Vec3::Zero();
  Vec3 suu = Vec3::Zero(), suv = Vec3::Zero(), svv = Vec3::Zero();
};

// Which one-sided limit to take at a knot.
enum class Limit { kFromAbove, kFromBelow };

// A value type; the sizes always fit together.
class Surface {
 public:
  // `poles`: #u x #v; `weights`: the same or empty, all positive.
  // Throws PreconditionError when sizes differ or a weight is not positive and finite.
  Surface(KnotVector u_knots, KnotVector v_knots, std::vector<Vec3> poles,
          std::vector<double> weights = {});

  const KnotVector& u_knots() const { return u_knots_; }
  const KnotVector& v_knots() const { return v_knots_; }
  int u_size() const { return u_knots_.size(); }
  int v_size() const { return v_knots_.size(); }
  const std::vector<Vec3>& poles() const { return poles_; }
  const std::vector<double>& weights() const { return weights_; }
  bool rational() const { return !weights_.empty(); }
  const Vec3& pole(int i, int j) const { return poles_[index(i, j)]; }
  size_t index(int i, int j) const { return static_cast<size_t>(i) * v_size() + j; }

  Vec3 point(double u, double v) const;
  // Derivatives up to `order` (0..2); at a knot, the limit taken in each direction.
  SurfaceDerivatives derivatives(double u, double v, int order, Limit u_limit = Limit::kFromAbove,
                                 Limit v_limit = Limit::kFromAbove) const;
  // The unit normal of S_u x S_v, or zero where the parametrisation is singular.
  Vec3 normal(double u, double v) const;

 private:
  KnotVector u_knots_, v_knots_;
  std::vector<Vec3> poles_;
  std::vector<double> weights_;
};

}  // namespace isochor
