#include "isochor/bspline/exact_basis.h"

#include <utility>

namespace isochor {
namespace {

// The functions of one degree more on the same span: B_{i}^{k} from B^{k-1}, both listed from the
// first that may be nonzero there (span - degree).
std::vector<Rational> raised(const KnotVector& knots, int span, int degree, const Rational& u,
                             const std::vector<Rational>& lower) {
  std::vector<Rational> values(static_cast<size_t>(degree) + 1);
  for (int j = 0; j < degree; ++j) {
    const int i = span - degree + 1 + j;  // the lower function that starts at knot i
    const Rational begin(knots[i]);
    const Rational end(knots[i + degree]);
    const Rational share = lower[static_cast<size_t>(j)] / (end - begin);
    values[static_cast<size_t>(j)] += (end - u) * share;
    values[static_cast<size_t>(j) + 1] += (u - begin) * share;
  }
  return values;
}

}  // namespace

ExactBasisValues evaluate_exact_basis(const KnotVector& knots, double u) {
  const int d = knots.degree();
  const int span = knots.span_of(u);
  const Rational at(u);
  std::vector<Rational> lower{Rational(1)};
  for (int degree = 1; degree < d; ++degree) lower = raised(knots, span, degree, at, lower);
  ExactBasisValues basis;
  basis.first = span - d;
  basis.values = raised(knots, span, d, at, lower);
  basis.slopes.resize(static_cast<size_t>(d) + 1);
  for (int j = 0; j < d; ++j) {
    const int i = span - d + 1 + j;
    const Rational slope =
        Rational(d) * lower[static_cast<size_t>(j)] / (Rational(knots[i + d]) - Rational(knots[i]));
    basis.slopes[static_cast<size_t>(j)] -= slope;
    basis.slopes[static_cast<size_t>(j) + 1] += slope;
  }
  return basis;
}

}  // namespace isochor
