#include "isochor/bspline/refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "isochor/base/error.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::message_of;
using ::isochor::testing::random_clamped;
using ::isochor::testing::random_insertions;
using ::isochor::testing::random_points;
using ::isochor::testing::random_surface;
using ::isochor::testing::random_unclamped;
using ::isochor::testing::random_wrapped;
using ::isochor::testing::sample_parameters;
using ::testing::HasSubstr;

Vec3 curve_point(const KnotVector& knots, const std::vector<Vec3>& poles, double u) {
  const BasisValues b = evaluate_basis(knots, u);
  Vec3 sum = Vec3::Zero();
  for (int j = 0; j <= b.degree; ++j)
    sum += b.value(0, j) * poles[static_cast<size_t>(b.first + j)];
  return sum;
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 3) == 0;
}

// Second method: Boehm's formula, one knot at a time.
std::vector<Vec3> boehm(KnotVector knots, std::vector<Vec3> poles, std::vector<double> inserted) {
  for (double x : inserted) {
    const int d = knots.degree();
    int k = 0;
    while (knots[k + 1] <= x) ++k;
    std::vector<Vec3> next;
    for (int i = 0; i <= knots.size(); ++i) {
      if (i <= k - d) {
        next.push_back(poles[static_cast<size_t>(i)]);
      } else if (i > k) {
        next.push_back(poles[static_cast<size_t>(i) - 1]);
      } else {
        const double share = (x - knots[i]) / (knots[i + d] - knots[i]);
        next.push_back((1.0 - share) * poles[static_cast<size_t>(i) - 1] +
                       share * (i < knots.size() ? poles[static_cast<size_t>(i)] : Vec3::Zero()));
      }
    }
    poles = next;
    std::vector<double> merged = knots.knots();
    merged.insert(std::upper_bound(merged.begin(), merged.end(), x), x);
    knots = KnotVector(d, merged);
  }
  return poles;
}

std::vector<KnotVector> many_knots(std::mt19937& random) {
  std::vector<KnotVector> all;
  for (int degree : {1, 2, 3, 4, 5, 7, 10, 13}) {
    all.push_back(random_clamped(random, degree));
    all.push_back(random_clamped(random, degree, 0));
    all.push_back(random_unclamped(random, degree));
  }
  return all;
}

TEST(Refinement, SameShapeAndConvexRows) {
  std::mt19937 random(11);
  for (const KnotVector& coarse : many_knots(random)) {
    const KnotVector fine = with_knots(coarse, random_insertions(random, coarse, 5));
    const BandedMap map = insertion_map(coarse, fine);
    for (int i = 0; i < map.size_fine(); ++i) {
      const BandedMap::Row row = map.row(i);
      EXPECT_LE(row.count, coarse.degree() + 1);
      double sum = 0.0;
      for (int k = 0; k < row.count; ++k) {
        EXPECT_GE(row.coefficients[k], 0.0);
        sum += row.coefficients[k];
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
    }
    const auto poles = random_points(random, static_cast<size_t>(coarse.size()));
    const auto refined = map.apply(poles);
    for (double u : sample_parameters(fine)) {
      EXPECT_LT((curve_point(fine, refined, u) - curve_point(coarse, poles, u)).norm(), 1e-13)
          << "degree " << coarse.degree() << " at " << u;
    }
  }
}

TEST(Refinement, AgreesWithSingleInsertions) {
  std::mt19937 random(12);
  for (const KnotVector& coarse : many_knots(random)) {
    const auto inserted = random_insertions(random, coarse, 4);
    const auto poles = random_points(random, static_cast<size_t>(coarse.size()));
    const auto expected = boehm(coarse, poles, inserted);
    const auto got = insertion_map(coarse, with_knots(coarse, inserted)).apply(poles);
    ASSERT_EQ(got.size(), expected.size());
    for (size_t i = 0; i < got.size(); ++i) {
      EXPECT_LT((got[i] - expected[i]).norm(), 1e-13) << coarse.degree() << ' ' << i;
    }
  }
}

TEST(Refinement, UntouchedPolesKeepTheirBits) {
  std::mt19937 random(13);
  for (const KnotVector& coarse : many_knots(random)) {
    const KnotVector fine = with_knots(coarse, random_insertions(random, coarse, 1));
    const BandedMap map = insertion_map(coarse, fine);
    auto poles = random_points(random, static_cast<size_t>(coarse.size()));
    poles[0] = Vec3(-0.0, 1e300, 5e-324);
    const auto refined = map.apply(poles);
    int checked = 0;
    for (int i = 0; i < fine.size(); ++i) {
      for (int j = 0; j < coarse.size(); ++j) {
        const auto d = coarse.degree();
        const bool agree = std::equal(fine.knots().begin() + i, fine.knots().begin() + i + d + 2,
                                      coarse.knots().begin() + j);
        if (!agree) continue;
        ++checked;
        ASSERT_TRUE(map.row(i).unit()) << d << ' ' << i;
        EXPECT_EQ(map.row(i).first, j);
        EXPECT_TRUE(same_bits(refined[static_cast<size_t>(i)], poles[static_cast<size_t>(j)]));
      }
    }
    if (coarse.size() > 2 * coarse.degree() + 2) {
      EXPECT_GT(checked, 0);
    }
  }
}

TEST(Refinement, TwoStepsEqualOne) {
  std::mt19937 random(14);
  const KnotVector coarse = random_clamped(random, 5);
  const KnotVector middle = with_knots(coarse, random_insertions(random, coarse, 3));
  const KnotVector fine = with_knots(middle, random_insertions(random, middle, 3));
  const auto poles = random_points(random, static_cast<size_t>(coarse.size()));
  const auto once = insertion_map(coarse, fine).apply(poles);
  const auto twice = insertion_map(middle, fine).apply(insertion_map(coarse, middle).apply(poles));
  for (size_t i = 0; i < once.size(); ++i) EXPECT_LT((once[i] - twice[i]).norm(), 1e-14);
}

TEST(Refinement, TransposeIsAdjoint) {
  std::mt19937 random(15);
  const KnotVector u = random_clamped(random, 3);
  const KnotVector v = random_unclamped(random, 4);
  const BandedMap mu = insertion_map(u, with_knots(u, random_insertions(random, u, 4)));
  const BandedMap mv = insertion_map(v, with_knots(v, random_insertions(random, v, 4)));
  const auto coarse = random_points(
      random, static_cast<size_t>(mu.size_coarse()) * static_cast<size_t>(mv.size_coarse()));
  const auto fine = random_points(
      random, static_cast<size_t>(mu.size_fine()) * static_cast<size_t>(mv.size_fine()));
  const auto up = apply_to_grid(mu, mv, coarse);
  const auto down = apply_transposed_to_grid(mu, mv, fine);
  double left = 0.0;
  double right = 0.0;
  for (size_t i = 0; i < fine.size(); ++i) left += fine[i].dot(up[i]);
  for (size_t i = 0; i < coarse.size(); ++i) right += coarse[i].dot(down[i]);
  EXPECT_NEAR(left, right, 1e-12);

  std::vector<double> x(static_cast<size_t>(mu.size_coarse()));
  for (size_t i = 0; i < x.size(); ++i) x[i] = coarse[i].x();
  const auto fine_x = mu.apply(x);
  std::vector<double> y(fine_x.size(), 1.0);
  y[0] = 3.0;
  const auto back = mu.apply_transposed(y);
  double first = 0.0;
  double second = 0.0;
  for (size_t i = 0; i < y.size(); ++i) first += y[i] * fine_x[i];
  for (size_t i = 0; i < x.size(); ++i) second += x[i] * back[i];
  EXPECT_NEAR(first, second, 1e-13);
}

TEST(Refinement, SurfaceKeepsItsShapePolynomialAndRational) {
  std::mt19937 random(16);
  for (bool rational : {false, true}) {
    for (double scale : {1.0, 1e9, 1e-9}) {
      const KnotVector u = random_clamped(random, 3, 3, 2);
      const KnotVector v = random_unclamped(random, 2, 3);
      Surface base = random_surface(random, u, v, rational);
      std::vector<Vec3> poles = base.poles();
      for (Vec3& p : poles) p *= scale;
      const Surface surface(u, v, poles, base.weights());
      const KnotVector fine_u = with_knots(u, random_insertions(random, u, 3));
      const KnotVector fine_v = with_knots(v, random_insertions(random, v, 3));
      const Surface fine = refine(surface, fine_u, fine_v);
      EXPECT_EQ(fine.rational(), rational);
      for (double a : sample_parameters(fine_u, 2)) {
        for (double b : sample_parameters(fine_v, 2)) {
          EXPECT_LT((fine.point(a, b) - surface.point(a, b)).norm(), 1e-13 * scale);
        }
      }
      const Surface same = refine(surface, u, v);
      for (size_t i = 0; i < poles.size(); ++i) EXPECT_TRUE(same_bits(same.poles()[i], poles[i]));
    }
  }
}

TEST(Refinement, WrappedVectorsStayPeriodic) {
  std::mt19937 random(17);
  for (int degree : {1, 2, 3, 5, 8}) {
    for (int period : {2, 3, 7}) {
      const KnotVector coarse = random_wrapped(random, degree, period);
      ASSERT_EQ(wrapped_poles(coarse), degree);
      const double step = (coarse.end() - coarse.begin()) / 50;
      const KnotVector fine =
          wrapped_with_knots(coarse, {coarse.begin() + step, coarse.end() - 2 * step});
      ASSERT_EQ(wrapped_poles(fine), degree);
      ASSERT_EQ(fine.size(), coarse.size() + 2);
      EXPECT_EQ(fine.begin(), coarse.begin());
      EXPECT_EQ(fine.end(), coarse.end());
      auto poles = random_points(random, static_cast<size_t>(period));
      for (int i = 0; i < degree; ++i) poles.push_back(poles[static_cast<size_t>(i)]);
      const BandedMap map = wrapped_insertion_map(coarse, fine);
      const auto refined = map.apply(poles);
      for (int i = 0; i < degree; ++i) {
        const auto at = static_cast<size_t>(i);
        EXPECT_LT((refined[at] - refined[at + static_cast<size_t>(period) + 2]).norm(), 1e-14);
      }
      for (double u : sample_parameters(fine)) {
        EXPECT_LT((curve_point(fine, refined, u) - curve_point(coarse, poles, u)).norm(), 1e-13)
            << degree << ' ' << period << ' ' << u;
      }
      for (int i = 0; i < map.size_fine(); ++i) {
        for (int k = 0; k < map.row(i).count; ++k) EXPECT_GE(map.row(i).coefficients[k], 0.0);
      }
    }
  }
}

TEST(Refinement, WrappedMultipleEndKnots) {
  // Cubic with a double knot at the ends: two poles wrap.
  const KnotVector knots(3, {-0.25, -0.25, 0, 0, 0.5, 0.75, 0.75, 1, 1, 1.5, 1.75, 1.75});
  // Two copies of 0 and of 1: domain [t_3, t_n] with n = 8.
  EXPECT_EQ(knots.size(), 8);
  EXPECT_EQ(wrapped_poles(knots), 3);
  const KnotVector trimmed(3, {-0.25, -0.25, 0, 0, 0.5, 0.75, 0.75, 1, 1, 1.5, 1.75});
  EXPECT_EQ(wrapped_poles(trimmed), 2);
  const KnotVector fine = wrapped_with_knots(trimmed, {0.9});
  EXPECT_EQ(wrapped_poles(fine), 2);
  std::mt19937 random(18);
  auto poles = random_points(random, 5);
  poles.push_back(poles[0]);
  poles.push_back(poles[1]);
  const auto refined = wrapped_insertion_map(trimmed, fine).apply(poles);
  for (double u : sample_parameters(fine)) {
    EXPECT_LT((curve_point(fine, refined, u) - curve_point(trimmed, poles, u)).norm(), 1e-14) << u;
  }
}

TEST(Refinement, ClampedAndIrregularVectorsDoNotWrap) {
  std::mt19937 random(19);
  EXPECT_EQ(wrapped_poles(KnotVector::uniform(3, 4)), 0);
  EXPECT_EQ(wrapped_poles(random_unclamped(random, 3)), 0);
  EXPECT_THROW(wrapped_with_knots(KnotVector::uniform(3, 4), {0.3}), PreconditionError);
}

TEST(Refinement, CommonKnotsTakeTheLargerMultiplicity) {
  const KnotVector base = KnotVector::uniform(3, 1);
  const KnotVector a = with_knots(base, {0.25, 0.5, 0.5});
  const KnotVector b = with_knots(base, {0.5, 0.75});
  const KnotVector common = common_knots(a, b);
  EXPECT_EQ(common.interior(), (std::vector<double>{0.25, 0.5, 0.5, 0.75}));
  EXPECT_EQ(common, common_knots(b, a));
  EXPECT_THROW(common_knots(a, KnotVector::uniform(3, 1, 0.0, 2.0)), PreconditionError);
  EXPECT_THROW(common_knots(a, KnotVector::uniform(2, 1)), PreconditionError);
}

TEST(Refinement, SpansAreDividedEvenlyAndOldKnotsStay) {
  const KnotVector knots = KnotVector::clamped(3, {0.0, 1.0, 1.5, 4.0});
  const KnotVector refined = refined_to_spans(knots, 9);
  EXPECT_GE(refined.spans().size(), 9u);
  EXPECT_NO_THROW(insertion_map(knots, refined));
  double longest = 0.0;
  double shortest = 1e9;
  for (int k : refined.spans()) {
    longest = std::max(longest, refined[k + 1] - refined[k]);
    shortest = std::min(shortest, refined[k + 1] - refined[k]);
  }
  EXPECT_LE(longest, 2.0 * shortest);
  // Equal spans are divided together, so symmetric knots stay symmetric.
  EXPECT_EQ(refined_to_spans(KnotVector::uniform(2, 4), 5).spans().size(), 8u);
  EXPECT_EQ(refined_to_spans(knots, 2), knots);
  const KnotVector fine = refined_to_length(knots, 0.4);
  for (int k : fine.spans()) {
    EXPECT_LE(fine[k + 1] - fine[k], 0.4 * (1 + 1e-12));
  }
  EXPECT_EQ(refined_to_length(KnotVector::uniform(1, 10), 0.1).spans().size(), 10u);
  std::mt19937 random(20);
  const KnotVector wrapped = random_wrapped(random, 3, 4);
  const auto more = inserted_knots(wrapped, refined_to_spans(wrapped, 20));
  EXPECT_GE(more.size(), 16u);
  EXPECT_EQ(wrapped_poles(wrapped_with_knots(wrapped, more)), 3);
}

TEST(Refinement, ErrorsNameTheValue) {
  const KnotVector knots = KnotVector::uniform(2, 4);
  EXPECT_THAT(message_of<InputError>([&] { with_knots(knots, {1.5}); }), HasSubstr("1.5"));
  EXPECT_THAT(message_of<InputError>([&] {
                with_knots(knots, {0.5, 0.5});
              }),
              HasSubstr("knot 0.5 has multiplicity 3"));
  EXPECT_THAT(message_of<InputError>([&] { with_knots(knots, {std::nan("")}); }), HasSubstr("nan"));
  EXPECT_THAT(message_of<InputError>([&] { refined_to_spans(knots, 0); }), HasSubstr("0 is not"));
  EXPECT_THAT(message_of<InputError>([&] { refined_to_length(knots, -1.0); }), HasSubstr("-1"));
  EXPECT_THAT(message_of<PreconditionError>(
                  [&] { insertion_map(with_knots(knots, {0.3}), with_knots(knots, {0.4})); }),
              HasSubstr("0.29999999999999999"));
  EXPECT_THROW(insertion_map(knots, KnotVector::uniform(3, 4)), PreconditionError);
  const BandedMap map = BandedMap::identity(3);
  EXPECT_THROW(map.apply(std::vector<double>(2)), PreconditionError);
  EXPECT_THROW(map.row(3), PreconditionError);
}

}  // namespace
}  // namespace isochor
