// Laws of both scales on random knots, wrapped ones included, against a fit on samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "isochor/multires/model_scale.h"
#include "support/collocation.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;
using testing::message_of;
using testing::random_clamped;
using testing::random_unclamped;
using testing::random_wrapped;
using testing::uniform;

std::vector<bool> random_flags(std::mt19937& random, size_t count) {
  std::vector<bool> flags(count);
  for (size_t i = 0; i < count; ++i) flags[i] = uniform(random, 0.0, 1.0) < 0.5;
  return flags;
}

double spline(const KnotVector& knots, const std::vector<double>& poles, double u) {
  const BasisValues b = evaluate_basis(knots, u);
  double sum = 0.0;
  for (int j = 0; j <= b.degree; ++j)
    sum += b.value(0, j) * poles[static_cast<size_t>(b.first + j)];
  return sum;
}

Eigen::MatrixXd dense(const BandedMap& map) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(map.size_fine(), map.size_coarse());
  for (int i = 0; i < map.size_fine(); ++i) {
    const BandedMap::Row row = map.row(i);
    for (int k = 0; k < row.count; ++k) matrix(i, row.first + k) = row.coefficients[k];
  }
  return matrix;
}

TEST(ScaleLaws, TheMapIsTheFitOfCoarseFunctions) {
  std::mt19937 random(61);
  for (int degree : {1, 2, 3, 5}) {
    for (const KnotVector& fine :
         {random_clamped(random, degree, 7), random_unclamped(random, degree, 7)}) {
      const TwoScale scale = keep_flagged(fine, random_flags(random, interior_breaks(fine).size()));
      const Eigen::MatrixXd fit = testing::fitted_map(scale.coarse, fine);
      EXPECT_LE((dense(scale.map) - fit).cwiseAbs().maxCoeff(), 1e-11) << "degree " << degree;
    }
  }
}

// Two steps of coarsening are one; rows are convex combinations.
TEST(ScaleLaws, ScalesComposeAndRowsAreConvex) {
  std::mt19937 random(62);
  for (int degree : {1, 3, 4}) {
    for (Wrap wrap : {Wrap::kNo, Wrap::kYes}) {
      const KnotVector fine = wrap == Wrap::kYes
                                  ? random_wrapped(random, degree, 10)
                                  : random_clamped(random, degree, 9, std::min(degree, 2));
      const TwoScale first = keep_every(fine, 2, wrap);
      const TwoScale second = keep_every(first.coarse, 2, wrap);
      const TwoScale both = keep_every(fine, 4, wrap);
      ASSERT_EQ(second.coarse, both.coarse);
      std::vector<double> poles;
      const int wrapped = wrap == Wrap::kYes ? degree : 0;
      for (int i = 0; i < both.coarse.size() - wrapped; ++i)
        poles.push_back(uniform(random, -1, 1));
      for (int i = 0; i < wrapped; ++i) poles.push_back(poles[static_cast<size_t>(i)]);
      const auto in_two = first.map.apply(second.map.apply(poles));
      const auto at_once = both.map.apply(poles);
      for (size_t i = 0; i < at_once.size(); ++i) EXPECT_NEAR(in_two[i], at_once[i], 1e-13);
      for (double u : testing::sample_parameters(fine)) {
        EXPECT_NEAR(spline(fine, at_once, u), spline(both.coarse, poles, u), 1e-13);
      }
      for (int i = 0; i < both.map.size_fine(); ++i) {
        const BandedMap::Row row = both.map.row(i);
        double sum = 0.0;
        for (int k = 0; k < row.count; ++k) {
          EXPECT_GE(row.coefficients[k], 0.0);
          sum += row.coefficients[k];
        }
        EXPECT_NEAR(sum, 1.0, 1e-14);
        EXPECT_LE(row.count, degree + 1);
      }
    }
  }
}

TEST(ScaleLaws, FlagsKnotsAndEveryAreThreeWordsForOneThing) {
  std::mt19937 random(63);
  for (int round = 0; round < 10; ++round) {
    const KnotVector fine = random_clamped(random, 1 + round % 4, 8);
    const std::vector<double> breaks = interior_breaks(fine);
    const std::vector<bool> flags = random_flags(random, breaks.size());
    std::vector<double> kept;
    for (size_t i = 0; i < breaks.size(); ++i) {
      if (flags[i]) kept.push_back(breaks[i]);
    }
    std::shuffle(kept.begin(), kept.end(), random);
    const TwoScale scale = keep_flagged(fine, flags);
    EXPECT_EQ(scale.coarse, keep_knots(fine, kept).coarse);
    // Knots go or stay with their whole multiplicity.
    for (size_t i = 0; i < breaks.size(); ++i) {
      EXPECT_EQ(scale.coarse.multiplicity(breaks[i]), flags[i] ? fine.multiplicity(breaks[i]) : 0);
    }
    EXPECT_EQ(scale.coarse.begin(), fine.begin());
    EXPECT_EQ(scale.coarse.end(), fine.end());
  }
  EXPECT_THROW((void)keep_flagged(KnotVector::uniform(2, 4), {true}), PreconditionError);
}

TEST(ScaleLaws, AWrappedScaleIsIndependentOfWhereThePeriodIsCut) {
  // Removing every knot of the period leaves one span whose extension is uniform.
  std::mt19937 random(64);
  for (int degree : {1, 2, 3}) {
    const KnotVector fine = random_wrapped(random, degree, 7);
    const TwoScale bare = keep_knots(fine, {}, Wrap::kYes);
    const double period = fine.end() - fine.begin();
    for (int i = 0; i + 1 < static_cast<int>(bare.coarse.knots().size()); ++i) {
      EXPECT_NEAR(bare.coarse[i + 1] - bare.coarse[i], period, 1e-14 * period);
    }
    EXPECT_EQ(bare.coarse.size(), degree + 1);
  }
}

TEST(ScaleLaws, ModelScalesDoNotDependOnTheOrderOfJoins) {
  testing::RandomModelOptions options;
  options.spans = 6;
  PatchModel model = testing::random_closed_model(65, options);
  model.joins = find_joins(model);
  const auto reference = keep_every(model, 2);
  std::mt19937 random(66);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(model.joins.begin(), model.joins.end(), random);
    const auto other = keep_every(model, 2);
    for (size_t q = 0; q < reference.size(); ++q) {
      EXPECT_EQ(other[q].u.coarse, reference[q].u.coarse);
      EXPECT_EQ(other[q].v.coarse, reference[q].v.coarse);
    }
  }
}

TEST(ScaleLaws, JoinsThatDoNotMatchCarryNothing) {
  PatchModel model = testing::make_cube_model(2, 6);
  model.joins = find_joins(model);
  for (Join& join : model.joins) join.matching = false;
  const auto scales = keep_knots(model, {{0, {0.5}, {0.5}}});
  EXPECT_EQ(interior_breaks(scales[0].u.coarse).size(), 1u);
  for (size_t q = 1; q < 6; ++q) {
    EXPECT_EQ(scales[q].u.coarse, model.patches[q].u_knots);
    EXPECT_EQ(scales[q].v.coarse, model.patches[q].v_knots);
  }
}

TEST(ScaleLaws, ListsOfJoinedPatchesMayAgree) {
  const PatchModel model = testing::make_cube_model(2, 4);
  const auto one = keep_knots(model, {{0, {0.5}, {0.25}}});
  const auto two = keep_knots(model, {{0, {0.5}, {0.25}}, {1, {0.25}, {0.5}}});
  for (size_t q = 0; q < 6; ++q) {
    EXPECT_EQ(one[q].u.coarse, two[q].u.coarse);
    EXPECT_EQ(one[q].v.coarse, two[q].v.coarse);
  }
  EXPECT_THROW(keep_knots(model, {{6, {}, {}}}), PreconditionError);
  EXPECT_THROW(keep_knots(model, {{-1, {}, {}}}), PreconditionError);
}

TEST(ScaleLaws, ValuesThatAreNoKnotsAreNamedWithTheirPatch) {
  const PatchModel model = testing::make_cube_model(2, 4);
  for (double bad : {0.0, 1.0, 0.3, -5.0, std::nan("")}) {
    EXPECT_THAT(message_of<InputError>([&] {
                  (void)keep_knots(model, {{1, {bad}, {}}});
                }),
                HasSubstr("scale.knots of face:2 (\"bottom\"): "))
        << bad;
  }
  EXPECT_THAT(message_of<InputError>([&] {
                (void)keep_knots(model, {{1, {std::nan("")}, {}}});
              }),
              HasSubstr("nan is not an interior knot"));
}

}  // namespace
}  // namespace isochor
