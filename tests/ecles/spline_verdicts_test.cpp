// Verdicts on smooth triangular splines, whose rank and redundancies theory knows.
#include <gtest/gtest.h>

#include <algorithm>

#include "ecles/verdict_trial.h"
#include "isochor/ecles/proof.h"
#include "support/triangle_spline.h"

namespace isochor {
namespace {

using testing::TriangleSpline;
using testing::TriangleSplineOptions;

TriangleSplineOptions grid(int columns, int rows, unsigned seed) {
  TriangleSplineOptions options;
  options.columns = columns;
  options.rows = rows;
  options.seed = seed;
  return options;
}

Analysis analyse_all(const TriangleSpline& spline, const ConstraintMatrix& matrix) {
  Selection all;
  for (int j = 0; j < spline.points(); ++j) all.derived.push_back(j);
  Analysis analysis = analyse(matrix, all);
  EXPECT_TRUE(verify(analysis, matrix, all));
  return analysis;
}

// Schumaker's dimension of C1 splines, seen from the constraints: d E_s - 2 V_int - singular.
int expected_rank(const TriangleSpline& spline, int degree) {
  return degree * spline.shared_edges() - 2 * spline.interior_vertices() -
         spline.singular_vertices();
}

TEST(SplineVerdicts, RankIsThatOfTheTheory) {
  for (int degree = 5; degree <= 7; ++degree) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
      TriangleSplineOptions options =
          grid(1 + static_cast<int>(seed) % 5, 2 + static_cast<int>(seed) % 4, seed);
      options.degree = degree;
      options.bits = seed % 3 == 0 ? 53 : 12;
      const TriangleSpline spline(options);
      const ConstraintMatrix matrix = spline.matrix();
      EXPECT_EQ(analyse_all(spline, matrix).rank(), expected_rank(spline, degree))
          << "degree " << degree << ", seed " << seed;
    }
  }
}

TEST(SplineVerdicts, SingularVerticesAreSeen) {
  int singular = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    TriangleSplineOptions options = grid(6, 6, seed);
    options.jitter = 0.0;
    const TriangleSpline spline(options);
    singular += spline.singular_vertices();
    EXPECT_EQ(analyse_all(spline, spline.matrix()).rank(), expected_rank(spline, 5)) << seed;
  }
  EXPECT_GT(singular, 0);
}

// Four edges leave the origin, almost on two straight lines; the conditions on its disc.
ConstraintMatrix four_edges(long aside) {
  const long far = 1l << 50;
  const long x[5] = {far, aside, -far, 0, 0}, y[5] = {0, far, 0, -far, 0};
  const auto area = [&](int a, int b, int c) {
    return Rational(Integer(x[b] - x[a]) * Integer(y[c] - y[a]) -
                    Integer(y[b] - y[a]) * Integer(x[c] - x[a]));
  };
  const int centre = 0, ring = 1, between = 5, second = 9;
  std::vector<RationalTerms> rows;
  for (int e = 0; e < 4; ++e) {
    const int before = (e + 3) % 4, after = (e + 1) % 4, origin = 4;
    const Rational whole = area(before, origin, e), one = area(after, origin, e),
                   two = area(before, after, e), three = area(before, origin, after);
    rows.push_back(
        {{ring + after, whole}, {ring + before, -one}, {centre, -two}, {ring + e, -three}});
    rows.push_back(
        {{between + e, whole}, {between + before, -one}, {ring + e, -two}, {second + e, -three}});
  }
  return ConstraintMatrix(13, rows);
}

// 2^-50 of an edge's length aside, the third redundancy is gone.
TEST(SplineVerdicts, AVertexAlmostSingularIsNotSingular) {
  Selection all;
  for (int j = 0; j < 13; ++j) all.derived.push_back(j);
  for (const long aside : {0l, 1l}) {
    const ConstraintMatrix matrix = four_edges(aside);
    const Analysis analysis = analyse(matrix, all);
    EXPECT_TRUE(verify(analysis, matrix, all));
    EXPECT_EQ(analysis.rank(), aside == 0 ? 5 : 6);
    EXPECT_EQ(testing::floating_rank(matrix, analysis.relevance.rows, all.derived), 5);
  }
}

TEST(SplineVerdicts, NeighbourhoodsFollowTheirCentre) {
  const TriangleSpline spline(grid(12, 12, 3));
  const ConstraintMatrix matrix = spline.matrix();
  for (const int radius : {0, 3, 8}) {
    const Selection selection = spline.neighbourhood(spline.vertex(6, 6), radius);
    const Analysis analysis = analyse(matrix, selection);
    EXPECT_TRUE(analysis.strongly_solvable()) << radius;
    EXPECT_TRUE(verify(analysis, matrix, selection));
    EXPECT_FALSE(analysis.dependent.empty());
    std::vector<int> both = selection.derived;
    both.push_back(selection.anchors[0]);
    if (radius < 8) {
      EXPECT_EQ(testing::rational_rank(matrix, analysis.relevance.rows, both), analysis.rank());
    }
  }
}

// One edit is the same work in a small model and a large one: counted, not timed.
TEST(SplineVerdicts, WorkOfALocalEditDoesNotGrowWithTheModel) {
  const auto touched = [](int columns, int rows) {
    TriangleSplineOptions options = grid(columns, rows, 5);
    options.cell = (1 << 12) / 25;
    const TriangleSpline spline(options);
    const ConstraintMatrix matrix = spline.matrix();
    const Analysis analysis = analyse(matrix, spline.neighbourhood(spline.vertex(10, 12), 8));
    EXPECT_GT(analysis.work.pivots, 100u);
    return std::vector<size_t>{analysis.work.rows, analysis.work.nonzeros, analysis.work.pivots};
  };
  const std::vector<size_t> small = touched(20, 25), large = touched(200, 250);  // triangles / 2
  EXPECT_EQ(small, large);
  std::cout << "1,000 and 100,000 triangles: " << small[0] << " rows, " << small[1] << " nonzeros, "
            << small[2] << " pivots\n";
}

}  // namespace
}  // namespace isochor
