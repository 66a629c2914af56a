#include "isochor/multires/two_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/volume/gauss.h"
#include "support/messages.h"
#include "support/splines.h"
#include "support/worst.h"

namespace isochor {
namespace {

using ::isochor::testing::message_of;
using ::isochor::testing::random_clamped;
using ::isochor::testing::random_points;
using ::isochor::testing::random_unclamped;
using ::isochor::testing::random_wrapped;
using ::isochor::testing::Worst;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<KnotVector> many_knots(std::mt19937& random) {
  std::vector<KnotVector> all;
  for (int degree : {1, 2, 3, 4, 5, 7, 10, 13}) {
    all.push_back(random_clamped(random, degree, 7));
    all.push_back(random_clamped(random, degree, 6, 1));
    all.push_back(random_unclamped(random, degree, 8));
  }
  return all;
}

KnotVector without_some(std::mt19937& random, const KnotVector& fine) {
  std::vector<double> knots;
  for (double t : fine.knots()) {
    const bool interior = fine.begin() < t && t < fine.end();
    if (!interior || testing::uniform(random, 0, 1) < 0.4) knots.push_back(t);
  }
  return KnotVector(fine.degree(), knots);
}

// Integral of f B_i over the domain for each function, by Gauss on every span of `spans_of`.
template <typename F>
std::vector<double> moments(const KnotVector& knots, const KnotVector& spans_of, F f) {
  const GaussRule rule = gauss_legendre(knots.degree() + 6);
  std::vector<double> result(static_cast<size_t>(knots.size()), 0.0);
  for (int k : spans_of.spans()) {
    const double width = spans_of[k + 1] - spans_of[k];
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      const double u = spans_of[k] + width * rule.nodes[g];
      const BasisValues b = evaluate_basis(knots, u);
      for (int j = 0; j <= b.degree; ++j) {
        result[static_cast<size_t>(b.first + j)] += rule.weights[g] * width * f(u) * b.value(0, j);
      }
    }
  }
  return result;
}

// The differences of the entries, over `size`.
void expect_near(const std::vector<double>& a, const std::vector<double>& b, double size,
                 Worst& worst, const KnotVector& knots) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(worst.see(std::abs(a[i] - b[i]) / size))
        << "degree " << knots.degree() << ", entry " << i;
  }
}

TEST(TwoScale, CoarseGradientThreeWays) {
  std::mt19937 random(51);
  Worst published("published", 1e-14);
  Worst direct("direct", 1e-14);
  const auto density = [](double u) { return 1.0 + u * u - 0.3 * u * u * u; };
  for (const KnotVector& fine : many_knots(random)) {
    const KnotVector coarse = without_some(random, fine);
    const std::vector<double> gradient = moments(fine, fine, density);
    const std::vector<double> transposed = insertion_map(coarse, fine).apply_transposed(gradient);
    double size = 0.0;
    for (double g : gradient) size += std::abs(g);
    const std::vector<double> removed = remove_knots_published(fine, coarse, gradient);
    expect_near(transposed, removed, size, published, fine);
    expect_near(transposed, moments(coarse, fine, density), size, direct, fine);
  }
}

TEST(TwoScale, PublishedRemovalOfAllAndOfNone) {
  std::mt19937 random(52);
  Worst worst("all", 1e-13);
  for (const KnotVector& fine : many_knots(random)) {
    std::vector<double> gradient(static_cast<size_t>(fine.size()));
    for (double& g : gradient) g = testing::uniform(random, -1, 1);
    EXPECT_EQ(remove_knots_published(fine, fine, gradient), gradient);
    const KnotVector bare = keep_knots(fine, {}).coarse;
    EXPECT_EQ(bare.size(), fine.degree() + 1);
    expect_near(remove_knots_published(fine, bare, gradient),
                insertion_map(bare, fine).apply_transposed(gradient), 1.0, worst, fine);
  }
}

TEST(TwoScale, PublishedRemovalOfAPatchGradient) {
  std::mt19937 random(53);
  const KnotVector u = random_clamped(random, 3, 6);
  const KnotVector v = random_unclamped(random, 2, 6);
  const KnotVector coarse_u = without_some(random, u);
  const KnotVector coarse_v = without_some(random, v);
  const auto gradient =
      random_points(random, static_cast<size_t>(u.size()) * static_cast<size_t>(v.size()));
  const auto published = remove_knots_published(u, coarse_u, v, coarse_v, gradient);
  const auto transposed =
      apply_transposed_to_grid(insertion_map(coarse_u, u), insertion_map(coarse_v, v), gradient);
  Worst worst("patch", 1e-13);
  ASSERT_EQ(published.size(), transposed.size());
  for (size_t i = 0; i < published.size(); ++i) {
    EXPECT_TRUE(worst.see((published[i] - transposed[i]).norm()));
  }
}

TEST(TwoScale, KeepEveryNumbersDistinctKnots) {
  const KnotVector fine(2, {0, 0, 0, 1, 2, 2, 3, 4, 4, 5, 6, 6, 6});
  EXPECT_THAT(interior_breaks(fine), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(keep_every(fine, 1).coarse, fine);
  EXPECT_THAT(keep_every(fine, 2).coarse.interior(), ElementsAre(2, 2, 4, 4));
  EXPECT_THAT(keep_every(fine, 3).coarse.interior(), ElementsAre(3));
  EXPECT_THAT(keep_every(fine, 6).coarse.interior(), IsEmpty());
  const BandedMap identity = keep_every(fine, 1).map;
  for (int i = 0; i < fine.size(); ++i) EXPECT_TRUE(identity.row(i).unit());
  EXPECT_EQ(keep_knots(fine, {4, 2, 4}).coarse, keep_every(fine, 2).coarse);
  EXPECT_EQ(keep_flagged(fine, {false, true, false, true, false}).coarse,
            keep_every(fine, 2).coarse);
}

TEST(TwoScale, WrappedScalesStayPeriodic) {
  std::mt19937 random(54);
  for (int degree : {1, 2, 3, 5}) {
    const KnotVector fine = random_wrapped(random, degree, 9);
    for (int k : {1, 2, 4, 100}) {
      const TwoScale scale = keep_every(fine, k, Wrap::kYes);
      ASSERT_EQ(wrapped_poles(scale.coarse), degree) << k;
      EXPECT_EQ(scale.coarse.interior().size(), static_cast<size_t>(8 / k));
      const int period = scale.coarse.size() - degree;
      std::vector<double> poles;
      for (int i = 0; i < period; ++i) poles.push_back(testing::uniform(random, -1, 1));
      for (int i = 0; i < degree; ++i) poles.push_back(poles[static_cast<size_t>(i)]);
      const std::vector<double> refined = scale.map.apply(poles);
      for (int i = 0; i < degree; ++i) {
        EXPECT_NEAR(refined[static_cast<size_t>(i)], refined[static_cast<size_t>(i) + 9], 1e-15);
      }
      for (double u : testing::sample_parameters(fine)) {
        double coarse_value = 0.0;
        double fine_value = 0.0;
        const BasisValues bc = evaluate_basis(scale.coarse, u);
        const BasisValues bf = evaluate_basis(fine, u);
        for (int j = 0; j <= degree; ++j) {
          coarse_value += bc.value(0, j) * poles[static_cast<size_t>(bc.first + j)];
          fine_value += bf.value(0, j) * refined[static_cast<size_t>(bf.first + j)];
        }
        EXPECT_NEAR(coarse_value, fine_value, 1e-13) << degree << ' ' << k << ' ' << u;
      }
    }
  }
}

TEST(TwoScale, WrappedWithMultipleEndKnots) {
  const KnotVector trimmed(3, {-0.25, -0.25, 0, 0, 0.5, 0.75, 0.75, 1, 1, 1.5, 1.75});
  const TwoScale scale = keep_knots(trimmed, {0.75}, Wrap::kYes);
  EXPECT_EQ(wrapped_poles(scale.coarse), 2);
  EXPECT_THAT(scale.coarse.interior(), ElementsAre(0.75, 0.75));
  EXPECT_EQ(keep_every(trimmed, 5, Wrap::kYes).coarse.size(), 4);
}

TEST(TwoScale, ErrorsNameTheKnot) {
  const KnotVector fine = KnotVector::uniform(3, 4);
  EXPECT_THAT(message_of<InputError>([&] {
                (void)keep_knots(fine, {0.5, 0.3});
              }),
              HasSubstr("0.29999999999999999 is not an interior knot; the next lower one is 0.25; "
                        "the next higher one is 0.5"));
  EXPECT_THAT(message_of<InputError>([&] { (void)keep_knots(fine, {1.0}); }),
              HasSubstr("1 is not an interior knot; the next lower one is 0.75"));
  EXPECT_THAT(message_of<InputError>([&] { (void)keep_every(fine, 0); }),
              HasSubstr("0 is not at least 1"));
  EXPECT_THROW((void)keep_every(fine, 2, Wrap::kYes), PreconditionError);
  EXPECT_THROW(remove_knots_published(fine, fine, std::vector<double>(3)), PreconditionError);
  EXPECT_THROW(remove_knots_published(fine, KnotVector::uniform(3, 3), std::vector<double>(7)),
               PreconditionError);
}

}  // namespace
}  // namespace isochor
