// Knot insertion against exact arithmetic, on every kind of knot vector.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "support/exact_splines.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::all_small_knots;
using ::isochor::testing::exact_basis;
using ::isochor::testing::exact_insertion;
using ::isochor::testing::ExactRow;
using ::isochor::testing::message_of;
using ::isochor::testing::roundoffs;
using ::testing::HasSubstr;

// Each share within a few roundings of its exact value for each degree, and exact zeros absent.
void expect_exact_rows(const BandedMap& map, const std::vector<ExactRow>& rows, int degree) {
  ASSERT_EQ(map.size_fine(), static_cast<int>(rows.size()));
  for (int i = 0; i < map.size_fine(); ++i) {
    const BandedMap::Row row = map.row(i);
    const ExactRow& exact = rows[static_cast<size_t>(i)];
    for (int j = 0; j < map.size_coarse(); ++j) {
      const Rational& share = exact[static_cast<size_t>(j)];
      const bool stored = row.first <= j && j < row.first + row.count;
      if (share.is_zero()) {
        EXPECT_TRUE(!stored || row.coefficients[j - row.first] == 0.0) << i << ' ' << j;
      } else {
        ASSERT_TRUE(stored) << i << ' ' << j;
        EXPECT_LE(roundoffs(row.coefficients[j - row.first], share, share), 5.0 * degree)
            << i << ' ' << j;
      }
    }
  }
}

TEST(RefinementExact, RowsOfAllDegrees) {
  std::mt19937 random(321);
  for (int degree = 1; degree <= kMaxDegree; degree += degree < 8 ? 1 : 4) {
    for (const KnotVector& coarse : {testing::random_clamped(random, degree, 2),
                                     testing::random_unclamped(random, degree, 3)}) {
      const auto inserted = testing::random_insertions(random, coarse, 2);
      expect_exact_rows(insertion_map(coarse, with_knots(coarse, inserted)),
                        exact_insertion(coarse, inserted), degree);
    }
  }
}

TEST(RefinementExact, RowsOfAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    for (const KnotVector& coarse : all_small_knots(degree, 2 * degree + 3)) {
      std::vector<double> inserted;
      for (double t = 0.5; t < 3.0; t += 0.5) {
        const bool fits = coarse.begin() < t && t < coarse.end() && coarse.multiplicity(t) < degree;
        if (fits) inserted.push_back(t);
      }
      if (inserted.empty()) continue;
      SCOPED_TRACE(::testing::PrintToString(coarse.knots()));
      expect_exact_rows(insertion_map(coarse, with_knots(coarse, inserted)),
                        exact_insertion(coarse, inserted), degree);
    }
  }
}

TEST(RefinementExact, SharesOfHalvedBezierSpansAreBinomials) {
  // A knot of full multiplicity in the middle: de Casteljau at 1/2, dyadic and so without rounding.
  for (int degree : {1, 2, 5, 12, kMaxDegree}) {
    const KnotVector coarse = KnotVector::uniform(degree, 1);
    const auto count = static_cast<size_t>(degree);
    const BandedMap map =
        insertion_map(coarse, with_knots(coarse, std::vector<double>(count, 0.5)));
    ASSERT_EQ(map.size_fine(), 2 * degree + 1);
    for (int i = 0; i <= degree; ++i) {
      const BandedMap::Row left = map.row(i);
      const BandedMap::Row right = map.row(2 * degree - i);
      ASSERT_EQ(left.count, i + 1);
      EXPECT_EQ(left.first, 0);
      EXPECT_EQ(right.first, degree - i);
      double binomial = 1.0;
      for (int k = 0; k <= i; ++k) {
        EXPECT_EQ(left.coefficients[k], std::ldexp(binomial, -i));
        EXPECT_EQ(right.coefficients[i - k], left.coefficients[k]);
        binomial = binomial * (i - k) / (k + 1);
      }
    }
  }
}

// Law (1) by the functions themselves: b_j = sum_i M(i, j) B_i at every parameter.
TEST(RefinementExact, CoarseFunctionsAreSumsOfFineOnes) {
  std::mt19937 random(322);
  for (int degree : {1, 2, 4}) {
    const KnotVector coarse = testing::random_unclamped(random, degree, 3);
    const auto inserted = testing::random_insertions(random, coarse, 3);
    const KnotVector fine = with_knots(coarse, inserted);
    const auto rows = exact_insertion(coarse, inserted);
    for (int span : fine.spans()) {
      const Rational u =
          (Rational(fine[span]) * Rational(2) + Rational(fine[span + 1])) / Rational(3);
      const auto many = exact_basis(fine, span, u);
      const int around = coarse.span_of(fine[span]);
      const auto few = exact_basis(coarse, around, u);
      for (size_t j = 0; j < few.size(); ++j) {
        Rational sum;
        for (size_t i = 0; i < many.size(); ++i) {
          sum += many[i] * rows[static_cast<size_t>(span - degree) + i]
                               [static_cast<size_t>(around - degree) + j];
        }
        EXPECT_EQ(sum, few[j]);
      }
    }
  }
}

// Every wrapped vector of small whole numbers, refined anywhere: the shape stays and the poles wrap
// to the last bit.
TEST(RefinementExact, WrappedPolesWrapBitForBit) {
  std::mt19937 random(323);
  int wrapped_vectors = 0;
  for (int degree : {1, 2, 3}) {
    for (int count = 2 * degree + 2; count <= 3 * degree + 3; ++count) {
      for (const KnotVector& coarse : all_small_knots(degree, count)) {
        const int wrapped = wrapped_poles(coarse);
        if (wrapped == 0) continue;
        SCOPED_TRACE(::testing::PrintToString(coarse.knots()) + std::to_string(degree));
        ++wrapped_vectors;
        const int period = coarse.size() - wrapped;
        for (int i = 0; i + period < static_cast<int>(coarse.knots().size()); ++i) {
          ASSERT_EQ(coarse[i + period] - coarse[i], coarse.end() - coarse.begin());
        }
        auto poles = testing::random_points(random, static_cast<size_t>(period));
        for (int i = 0; i < wrapped; ++i) poles.push_back(poles[static_cast<size_t>(i)]);
        const double length = coarse.end() - coarse.begin();
        for (double share : {0.03, 0.37, 0.5, 0.99}) {
          const double at = coarse.begin() + share * length;
          if (coarse.multiplicity(at) >= degree) continue;
          const KnotVector fine = wrapped_with_knots(coarse, {at});
          ASSERT_EQ(wrapped_poles(fine), wrapped);
          ASSERT_EQ(fine.size(), coarse.size() + 1);
          const auto refined = wrapped_insertion_map(coarse, fine).apply(poles);
          for (size_t i = 0; i < static_cast<size_t>(wrapped); ++i) {
            EXPECT_EQ(refined[i], refined[i + static_cast<size_t>(period) + 1]);
          }
          for (double u : testing::sample_parameters(fine, 2)) {
            const auto value = [&](const KnotVector& knots, const std::vector<Vec3>& of) {
              const BasisValues b = evaluate_basis(knots, u);
              Vec3 sum = Vec3::Zero();
              for (int j = 0; j <= degree; ++j) {
                sum += b.value(0, j) * of[static_cast<size_t>(b.first + j)];
              }
              return sum;
            };
            EXPECT_LT((value(fine, refined) - value(coarse, poles)).norm(), 1e-14) << u;
          }
        }
      }
    }
  }
  EXPECT_GT(wrapped_vectors, 20);
}

TEST(RefinementExact, WrappedVectorsFarFromZeroAndUneven) {
  std::mt19937 random(324);
  for (int degree : {2, 3, 5}) {
    for (double shift : {0.0, -7.3, 1e4}) {
      KnotVector coarse = testing::random_wrapped(random, degree, 4);
      std::vector<double> moved = coarse.knots();
      for (double& t : moved) t += shift;
      coarse = KnotVector(degree, moved);
      if (wrapped_poles(coarse) == 0) continue;  // the shift's rounding was too coarse
      const auto inserted = testing::random_insertions(random, coarse, 5);
      const KnotVector fine = wrapped_with_knots(coarse, inserted);
      const BandedMap map = wrapped_insertion_map(coarse, fine);
      const int period = coarse.size() - degree + static_cast<int>(inserted.size());
      std::vector<double> x(static_cast<size_t>(coarse.size()));
      for (int i = 0; i < coarse.size(); ++i) {
        const int rest = i % (coarse.size() - degree);
        x[static_cast<size_t>(i)] = std::sin(1.0 + rest);
      }
      const auto refined = map.apply(x);
      for (size_t i = 0; i < static_cast<size_t>(degree); ++i) {
        EXPECT_EQ(refined[i], refined[i + static_cast<size_t>(period)]);
      }
      // Old knots keep the bits that the file gave them.
      for (double old : coarse.interior()) EXPECT_GT(fine.multiplicity(old), 0);
      EXPECT_EQ(inserted_knots(coarse, fine).size(), inserted.size());
    }
  }
}

TEST(RefinementExact, CommonKnotsAreTheSmallestThatRefineBoth) {
  std::mt19937 random(325);
  for (int degree : {1, 2, 3, 6}) {
    for (const KnotVector& base :
         {KnotVector::uniform(degree, 3), testing::random_unclamped(random, degree, 3)}) {
      const KnotVector a = with_knots(base, testing::random_insertions(random, base, 3));
      const KnotVector b = with_knots(base, testing::random_insertions(random, base, 4));
      const KnotVector common = common_knots(a, b);
      EXPECT_EQ(common, common_knots(b, a));
      EXPECT_EQ(common_knots(a, base), a);
      EXPECT_EQ(common_knots(common, a), common);
      for (double t : common.breaks()) {
        EXPECT_EQ(common.multiplicity(t), std::max(a.multiplicity(t), b.multiplicity(t)));
      }
      EXPECT_EQ(with_knots(a, inserted_knots(a, common)), common);
      EXPECT_EQ(with_knots(b, inserted_knots(b, common)), common);
    }
  }
}

TEST(RefinementExact, VectorsThatDoNotBelongTogetherAreTheCallersBug) {
  const KnotVector knots = KnotVector::uniform(2, 4);
  const KnotVector open(2, {-2, -1, 0, 0.5, 1, 2, 3});
  const KnotVector other(2, {-2, -1.5, 0, 0.5, 1, 2, 3});
  const char* outside = "knots outside the domain differ between the two vectors";
  EXPECT_THAT(message_of<PreconditionError>([&] { common_knots(open, other); }),
              HasSubstr(outside));
  EXPECT_THAT(message_of<PreconditionError>([&] { insertion_map(open, other); }),
              HasSubstr(outside));
  EXPECT_THAT(
      message_of<PreconditionError>([&] { insertion_map(with_knots(knots, {0.1}), knots); }),
      HasSubstr("the finer vector lacks the knot 0.1"));
  EXPECT_THROW(inserted_knots(knots, KnotVector::uniform(2, 4, 0, 2)), PreconditionError);
  EXPECT_THROW(wrapped_insertion_map(knots, with_knots(knots, {0.1})), PreconditionError);
  std::mt19937 random(326);
  const KnotVector wrapped = testing::random_wrapped(random, 2, 4);
  // with_knots leaves the knots beyond the ends alone, so the result does not wrap any more.
  EXPECT_THROW(wrapped_insertion_map(wrapped, with_knots(wrapped, {wrapped.begin() + 0.01})),
               PreconditionError);
  EXPECT_EQ(wrapped_insertion_map(wrapped, wrapped).row(0).unit(), true);
}

TEST(RefinementExact, MapsRefuseWhatDoesNotFit) {
  EXPECT_THROW(BandedMap(2, {{0, {0.0, 0.0}}}), PreconditionError) << "an empty row";
  EXPECT_THROW(BandedMap(2, {{1, {1.0, 1.0}}}), PreconditionError) << "beyond the last column";
  EXPECT_THROW(BandedMap(2, {{-1, {1.0}}}), PreconditionError);
  const BandedMap kept(3, {{0, {0.0, 0.25, 0.0}}});
  EXPECT_EQ(kept.row(0).first, 1) << "zeros at both ends are dropped";
  EXPECT_EQ(kept.row(0).count, 1);
  EXPECT_FALSE(kept.row(0).unit());
  EXPECT_THROW(static_cast<void>(kept.row(-1)), PreconditionError);
  EXPECT_THROW(kept.apply(std::vector<Vec3>(2)), PreconditionError);
  EXPECT_THROW(kept.apply_transposed(std::vector<double>(2)), PreconditionError);
  EXPECT_THROW(kept.apply_transposed(std::vector<Vec3>(3)), PreconditionError);
  const BandedMap identity = BandedMap::identity(3);
  EXPECT_THROW(apply_to_grid(identity, kept, std::vector<Vec3>(8)), PreconditionError);
  EXPECT_THROW(apply_transposed_to_grid(identity, kept, std::vector<Vec3>(9)), PreconditionError);
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface flat(line, line, std::vector<Vec3>(4, Vec3::Zero()));
  EXPECT_THROW(refine(flat, line, identity, line, BandedMap::identity(2)), PreconditionError);
  EXPECT_THROW(refine(flat, line, BandedMap::identity(2), line, identity), PreconditionError);
}

TEST(RefinementExact, DensitiesHaveLimits) {
  const KnotVector knots = KnotVector::uniform(1, 1);
  const auto spans = [&](int count) {
    return message_of<InputError>([&] { refined_to_spans(knots, count); });
  };
  EXPECT_THAT(spans(-4), HasSubstr("spans: -4 is not between 1 and 100000"));
  EXPECT_THAT(spans(kMaxSpans + 1), HasSubstr("100001 is not between"));
  const auto length = [&](double most) {
    return message_of<InputError>([&] { refined_to_length(knots, most); });
  };
  EXPECT_THAT(length(0.0), HasSubstr("length: 0 does not divide a domain of length 1"));
  EXPECT_THAT(length(std::nan("")), HasSubstr("nan does not divide"));
  EXPECT_THAT(length(1e-6), HasSubstr("into at most 100000 spans"));
  EXPECT_EQ(refined_to_length(knots, INFINITY), knots);
  // A span of two neighbouring doubles cannot be divided: said, not looped over.
  const KnotVector narrow = KnotVector::clamped(1, {1.0, std::nextafter(1.0, 2.0)});
  EXPECT_THAT(message_of<InputError>([&] { refined_to_spans(narrow, 3); }), HasSubstr("knots"));
}

}  // namespace
}  // namespace isochor
