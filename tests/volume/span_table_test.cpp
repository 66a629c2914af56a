#include "isochor/volume/span_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/basis.h"
#include "isochor/exact/rational.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/span_polynomials.h"
#include "support/models.h"

namespace isochor {
namespace {

using internal::SpanPolynomials;

Rational power(const Rational& t, int exponent) {
  Rational result(1);
  for (int k = 0; k < exponent; ++k) result *= t;
  return result;
}

// Two doubles carry all bits of a long double.
Rational exactly(long double x) {
  const auto high = static_cast<double>(x);
  return Rational(high) + Rational(static_cast<double>(x - static_cast<long double>(high)));
}

// |computed - exact| in unit roundoffs of `size`.
double roundoffs(double computed, const Rational& exact, double size) {
  return (Rational(computed) - exact).abs().to_double() / (kUnitRoundoff * size);
}

TEST(SpanTable, AccuracyAgainstExactPolynomials) {
  for (int degree : {1, 2, 3, 5, 8, 14}) {
    std::vector<double> far = testing::random_clamped_knots(71, degree, 3).knots();
    for (double& t : far) t += 1000.0;
    for (const KnotVector& knots :
         {testing::random_clamped_knots(72, degree, 3), KnotVector(degree, far)}) {
      const SpanTable table(knots, exact_gauss_points(degree));
      const SpanPolynomials exact(knots);
      const LongGaussRule rule = long_gauss_legendre(table.gauss_points());
      for (int s = 0; s < table.spans(); ++s) {
        ASSERT_EQ(table.first(s), exact.first(s));
        const int span = knots.spans()[static_cast<size_t>(s)];
        const Rational width = Rational(knots[span + 1]) - Rational(knots[span]);
        for (int g = 0; g < table.gauss_points(); g += 2) {
          // The node that both rounded distances stand for: the smaller one decides.
          const long double ahead = rule.from_end[static_cast<size_t>(g)];
          const long double behind = rule.nodes[static_cast<size_t>(g)];
          const Rational t = behind < ahead ? exactly(behind) : Rational(1) - exactly(ahead);
          for (int j = 0; j <= degree; ++j) {
            Rational value;
            Rational slope;
            for (int k = 0; k <= degree; ++k) {
              const Rational c(exact.coefficient(s, j, k), exact.denominator(s));
              value += c * power(t, k);
              if (k > 0) slope += Rational(k) * c * power(t, k - 1) / width;
            }
            const double allowed = table_roundoffs(degree);
            const double size = table.slope_sizes(s, j)[g];
            EXPECT_LE(roundoffs(table.values(s, j)[g], value, table.values(s, j)[g]), allowed);
            EXPECT_LE(roundoffs(table.slopes(s, j)[g], slope, size), allowed);
            EXPECT_LE(std::abs(table.slopes(s, j)[g]), size);
            // A slope is the step before it less its own.
            const Rational before(j > 0 ? table.steps(s, j - 1)[g] : 0.0);
            const Rational own(j < degree ? table.steps(s, j)[g] : 0.0);
            EXPECT_LE((before - own - slope).abs().to_double(), allowed * kUnitRoundoff * size);
          }
        }
      }
    }
  }
}

// Cells: the same functions at other points, whose weights measure each cell.
TEST(SpanTable, CellsCoverTheirSpan) {
  const KnotVector knots(2, {0.0, 0.0, 0.0, 1.0, 3.0, 3.0, 3.0});
  const std::vector<SpanCells> cells = {{{0.0, 1.0, 3}},
                                        {{0.0, 0.25, 2}, {0.25, 0.5, 4}, {0.5, 1.0, 3}}};
  const SpanTable table(knots, cells);
  EXPECT_EQ(table.gauss_points(0), 3);
  EXPECT_EQ(table.gauss_points(1), 9);
  EXPECT_EQ(table.gauss_points(), 9);
  EXPECT_EQ(table.first(1), 1);
  EXPECT_EQ(table.cells(), cells);
  size_t g = 0;
  for (const Cell& cell : cells[1]) {
    const GaussRule rule = gauss_legendre(cell.gauss_points);
    double length = 0.0;
    for (double node : rule.nodes) {
      const double u = 1.0 + 2.0 * (cell.begin + (cell.end - cell.begin) * node);
      const BasisValues b = evaluate_basis_on_span(knots, knots.spans()[1], u, 1);
      for (int j = 0; j <= 2; ++j) {
        EXPECT_NEAR(table.values(1, j)[g], b.value(0, j), 1e-15);
        EXPECT_NEAR(table.slopes(1, j)[g], b.value(1, j), 1e-14);
      }
      length += table.weights(1)[g++];
    }
    EXPECT_NEAR(length, 2.0 * (cell.end - cell.begin), 1e-15);
  }
}

TEST(SpanTable, CellsThatDoNotFitAreTheCallersBug) {
  const KnotVector knots = KnotVector::uniform(1, 1);
  const auto refused = [&](const std::vector<SpanCells>& cells) {
    EXPECT_THROW(SpanTable(knots, cells), PreconditionError);
  };
  refused({});
  refused({{}});
  refused({{{0.0, 0.5, 2}}});
  refused({{{0.0, 0.5, 2}, {0.75, 1.0, 2}}});
  refused({{{0.0, 1.0, 0}}});
  refused({{{0.0, 1.0, 2}}, {{0.0, 1.0, 2}}});
}

TEST(SpanTable, AgreesWithTheRecursionOfBspline) {
  const KnotVector knots(3, {-2.0, -1.0, -0.5, 0.0, 0.3, 0.3, 1.0, 1.5, 2.0, 4.0});
  const SpanTable table(knots, 5);
  const GaussRule rule = gauss_legendre(5);
  for (int s = 0; s < table.spans(); ++s) {
    const int span = knots.spans()[static_cast<size_t>(s)];
    double length = 0.0;
    for (int g = 0; g < 5; ++g) {
      const double width = knots[span + 1] - knots[span];
      const double u = knots[span] + width * rule.nodes[static_cast<size_t>(g)];
      const BasisValues b = evaluate_basis_on_span(knots, span, u, 1);
      for (int j = 0; j <= 3; ++j) {
        EXPECT_NEAR(table.values(s, j)[g], b.value(0, j), 1e-15);
        EXPECT_NEAR(table.slopes(s, j)[g], b.value(1, j), 1e-14);
      }
      length += table.weights(s)[g];
    }
    EXPECT_NEAR(length, knots[span + 1] - knots[span], 1e-15);
  }
}

TEST(SpanTable, ExactPointsAreEnoughAndOneLessIsNot) {
  // Integral of B_0^2 B_0' over one span of degree d is (0 - 1) / 3.
  for (int degree = 1; degree <= 6; ++degree) {
    const auto integral = [&](int points) {
      const SpanTable table(KnotVector::uniform(degree, 1), points);
      double sum = 0.0;
      for (int g = 0; g < points; ++g) {
        sum += table.weights(0)[g] * std::pow(table.values(0, 0)[g], 2) * table.slopes(0, 0)[g];
      }
      return sum;
    };
    EXPECT_NEAR(integral(exact_gauss_points(degree)), -1.0 / 3, 1e-15);
    if (degree > 1) {
      EXPECT_GT(std::abs(integral(exact_gauss_points(degree) - 1) + 1.0 / 3), 1e-12);
    }
  }
}

TEST(SpanPolynomials, SumToOneExactly) {
  const SpanPolynomials polynomials(testing::random_clamped_knots(73, 4, 5));
  for (int s = 0; s < polynomials.spans(); ++s) {
    for (int k = 0; k <= 4; ++k) {
      Integer sum;
      for (int j = 0; j <= 4; ++j) sum += polynomials.coefficient(s, j, k);
      EXPECT_EQ(sum, k == 0 ? polynomials.denominator(s) : Integer(0));
    }
  }
}

TEST(CompensatedSum, SurvivesCancellation) {
  internal::CompensatedSum sum;
  for (double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
  EXPECT_EQ(sum.total(), 2.0);
}

}  // namespace
}  // namespace isochor
