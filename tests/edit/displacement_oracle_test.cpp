// DisplacementSpace against dense matrices that are built another way: the coarse displacement
// field is sampled and fitted in the fine basis, no knot insertion involved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "support/collocation.h"
#include "support/messages.h"

namespace isochor {
namespace {

using testing::at_scale;
using testing::bent_cube;
using testing::fitted_map;
using ::testing::HasSubstr;
using testing::message_of;
using testing::prepared;
using testing::random_vectors;

// The displacement of every point that patch q uses, axis by axis, from its own grid alone.
std::vector<Vec3> displacement_by_fit(const PatchModel& model, const DisplacementSpace& space,
                                      const std::vector<Vec3>& delta, int q) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const Eigen::MatrixXd u = fitted_map(space.u_knots(q), patch.u_knots);
  const Eigen::MatrixXd v = fitted_map(space.v_knots(q), patch.v_knots);
  std::vector<Vec3> moved(patch.points.size());
  for (int a = 0; a < 3; ++a) {
    Eigen::MatrixXd grid(space.u_knots(q).size(), space.v_knots(q).size());
    for (int i = 0; i < grid.rows(); ++i) {
      for (int j = 0; j < grid.cols(); ++j) {
        const auto c = static_cast<size_t>(space.coefficient(q, i, j));
        grid(i, j) = space.signs(q, i, j)[a] * delta[c][a];
      }
    }
    const Eigen::MatrixXd fine = u * grid * v.transpose();
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        moved[static_cast<size_t>(i) * static_cast<size_t>(patch.v_size()) + static_cast<size_t>(j)]
             [a] = fine(i, j);
      }
    }
  }
  return moved;
}

void expect_expands_like_the_fit(const PatchModel& model, const DisplacementSpace& space) {
  const auto delta = random_vectors(31, static_cast<size_t>(space.size()));
  const std::vector<Vec3> moved = space.expand(delta);
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    const std::vector<Vec3> expected = displacement_by_fit(model, space, delta, q);
    for (size_t k = 0; k < expected.size(); ++k) {
      EXPECT_LE((moved[static_cast<size_t>(patch.points[k])] - expected[k]).norm(), 1e-11)
          << "patch " << q << ", pole " << k;
    }
  }
}

Scale kept_knots(const std::string& patch, const std::vector<double>& u,
                 const std::vector<double>& v) {
  Scale scale;
  scale.kind = Scale::Kind::kKnots;
  scale.knots[patch] = {u, v};
  return scale;
}

TEST(DisplacementOracle, EveryScaleOfABentCubeWithRandomKnots) {
  testing::RandomModelOptions options;
  options.degrees[0] = 2;
  options.degrees[2] = 4;
  options.spans = 6;
  for (std::uint32_t seed : {1u, 2u}) {
    const PatchModel model = prepared(testing::random_closed_model(seed, options));
    for (int k : {1, 2, 3, 5, 100}) {
      const DisplacementSpace space(model, at_scale(k));
      expect_expands_like_the_fit(model, space);
    }
  }
}

TEST(DisplacementOracle, ListedKnots) {
  const PatchModel model = prepared(testing::make_box_model(
      KnotVector::clamped(3, {0, 0.1, 0.3, 0.4, 0.7, 1}), KnotVector::clamped(2, {0, 0.5, 0.6, 1}),
      KnotVector::clamped(3, {0, 0.2, 0.25, 0.8, 1})));
  DisplacementSpace::Options options = at_scale(1);
  options.scale = kept_knots("top", {0.3, 0.7}, {});
  const DisplacementSpace space(model, options);
  EXPECT_EQ(space.u_knots(0).interior(), (std::vector<double>{0.3, 0.7}));
  EXPECT_TRUE(space.v_knots(0).interior().empty());
  expect_expands_like_the_fit(model, space);
  options.scale = kept_knots("top", {0.31}, {});
  EXPECT_THAT(message_of<InputError>([&] { DisplacementSpace refused(model, options); }),
              HasSubstr("0.31 is not an interior knot"));
  options.scale = kept_knots("roof", {0.3}, {});
  EXPECT_THAT(message_of<InputError>([&] { DisplacementSpace refused(model, options); }),
              HasSubstr("\"roof\""));
}

TEST(DisplacementOracle, ATorusWrapsAtEveryScale) {
  const PatchModel model = prepared(testing::make_periodic_torus(3, 2, 8, 9));
  for (int k : {1, 2, 3}) {
    const DisplacementSpace space(model, at_scale(k));
    expect_expands_like_the_fit(model, space);
    const int rows = space.u_knots(0).size();
    const int columns = space.v_knots(0).size();
    EXPECT_EQ(space.size(), (rows - 3) * (columns - 2)) << k;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < columns; ++j) {
        EXPECT_EQ(space.coefficient(0, i, j), space.coefficient(0, rows - 3 + i, j));
      }
    }
  }
}

TEST(DisplacementOracle, ASphereKeepsItsSeamAndPolesTogether) {
  const PatchModel model = prepared(testing::make_sphere(1.0));
  for (int k : {1, 2}) {
    const DisplacementSpace space(model, at_scale(k));
    const auto moved = space.expand(random_vectors(32, static_cast<size_t>(space.size())));
    const int rows = space.u_knots(0).size();
    const int columns = space.v_knots(0).size();
    for (int j = 0; j < columns; ++j) {
      EXPECT_EQ(space.coefficient(0, 0, j), space.coefficient(0, rows - 1, j));
    }
    for (int i = 0; i < rows; ++i) {
      EXPECT_EQ(space.coefficient(0, i, 0), space.coefficient(0, 0, 0));
      EXPECT_EQ(space.coefficient(0, i, columns - 1), space.coefficient(0, 0, columns - 1));
    }
    expect_expands_like_the_fit(model, space);
  }
}

// Coefficients count once, however many patches or grid entries they belong to.
TEST(DisplacementOracle, GatherAndMovedPointsAgreeWithTheDenseMatrix) {
  for (int k : {1, 2}) {
    const PatchModel model = bent_cube(7);
    const DisplacementSpace space(model, at_scale(k));
    const auto gradient = random_vectors(33, model.points.size());
    const std::vector<Vec3> gathered = space.gather(gradient);
    for (int c = 0; c < space.size(); ++c) {
      const auto at = static_cast<size_t>(c);
      std::vector<Vec3> unit(static_cast<size_t>(space.size()), Vec3::Zero());
      unit[at] = Vec3::Ones();
      const std::vector<Vec3> column = space.expand(unit);
      Vec3 sum = Vec3::Zero();
      std::vector<int> touched;
      for (size_t i = 0; i < column.size(); ++i) {
        sum += column[i].cwiseProduct(gradient[i]);
        if (column[i] != Vec3::Zero()) touched.push_back(static_cast<int>(i));
      }
      EXPECT_LE((gathered[at] - sum).norm(), 1e-13 * (1.0 + sum.norm()));
      std::vector<char> mask(static_cast<size_t>(space.size()), 0);
      mask[at] = 1;
      EXPECT_EQ(space.moved_points(mask), touched) << c;
    }
    EXPECT_TRUE(
        space.moved_points(std::vector<char>(static_cast<size_t>(space.size()), 0)).empty());
  }
}

TEST(DisplacementOracle, ConstantDisplacementsAreInEverySpace) {
  for (const PatchModel& model :
       {bent_cube(8), prepared(testing::make_periodic_torus(3, 3, 7, 6)),
        prepared(testing::make_sphere(2.0)), prepared(testing::make_cylinder(1.0, 3.0))}) {
    for (int k : {1, 2, 50}) {
      const DisplacementSpace space(model, at_scale(k));
      const Vec3 t(0.3, -0.2, 0.7);
      const auto moved = space.expand(std::vector<Vec3>(static_cast<size_t>(space.size()), t));
      for (const Vec3& d : moved) EXPECT_LE((d - t).norm(), 1e-14);
    }
  }
}

TEST(DisplacementOracle, PlacesLieOnTheSurface) {
  for (int k : {1, 2}) {
    const PatchModel torus = prepared(testing::make_periodic_torus(3, 3, 12, 12));
    const DisplacementSpace space(torus, at_scale(k));
    for (int c = 0; c < space.size(); ++c) {
      // A control torus of radii 2 and 1/2 with twelve points a turn bounds its spline from
      // outside.
      const Vec3& p = space.place(c);
      const double tube = std::hypot(std::hypot(p.x(), p.y()) - 2.0, p.z());
      EXPECT_LE(tube, 0.55) << c << " at " << p.transpose();
      EXPECT_GE(tube, 0.25) << c << " at " << p.transpose();
    }
  }
}

TEST(DisplacementOracle, AnUnclampedSheetHasItsPlacesOnItself) {
  const PatchModel sheet = prepared(testing::random_open_patch(3, 3, 2, 5, true));
  const DisplacementSpace space(sheet, at_scale(1));
  const Surface surface = sheet.surface(0);
  const auto inside = [](const KnotVector& knots, int i) {
    return std::clamp(knots.greville(i), knots.begin(), knots.end());
  };
  for (int i = 0; i < surface.u_size(); ++i) {
    for (int j = 0; j < surface.v_size(); ++j) {
      const Vec3 expected =
          surface.point(inside(surface.u_knots(), i), inside(surface.v_knots(), j));
      EXPECT_LE((space.place(space.coefficient(0, i, j)) - expected).norm(), 1e-14);
    }
  }
}

TEST(DisplacementOracle, NeighboursAreMutualAndOneStepAway) {
  for (const PatchModel& model :
       {testing::small_cube(), prepared(testing::make_periodic_torus(2, 2, 6, 5))}) {
    const DisplacementSpace space(model, at_scale(1));
    std::vector<std::set<int>> expected(static_cast<size_t>(space.size()));
    for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
      const int nu = space.u_knots(q).size();
      const int nv = space.v_knots(q).size();
      for (int i = 0; i + 1 < nu; ++i) {
        for (int j = 0; j + 1 < nv; ++j) {  // the four corners of a cell know each other
          const int corner[4] = {space.coefficient(q, i, j), space.coefficient(q, i + 1, j),
                                 space.coefficient(q, i, j + 1),
                                 space.coefficient(q, i + 1, j + 1)};
          for (int a : corner) {
            for (int b : corner) {
              if (a != b) expected[static_cast<size_t>(a)].insert(b);
            }
          }
        }
      }
    }
    for (int c = 0; c < space.size(); ++c) {
      const auto& set = expected[static_cast<size_t>(c)];
      EXPECT_EQ(space.neighbours(c), std::vector<int>(set.begin(), set.end()));
    }
  }
}

// Refinement first, then a scale that keeps the old knots: the same space as without refinement.
TEST(DisplacementOracle, RefinementIsUndoneByKeepingTheOldKnots) {
  const PatchModel coarse = bent_cube(9);
  PatchModel fine = refine(coarse, 0, refined_to_spans(coarse.patches[0].u_knots, 9),
                           refined_to_spans(coarse.patches[0].v_knots, 8));
  derive_locks(fine);
  DisplacementSpace::Options options = at_scale(1);
  options.scale =
      kept_knots("top", coarse.patches[0].u_knots.interior(), coarse.patches[0].v_knots.interior());
  const DisplacementSpace before(coarse, at_scale(1));
  const DisplacementSpace after(fine, options);
  EXPECT_EQ(after.size(), before.size());
  const auto delta = random_vectors(34, static_cast<size_t>(before.size()));
  PatchModel moved_before = coarse;
  PatchModel moved_after = fine;
  const auto d_before = before.expand(delta);
  const auto d_after = after.expand(delta);
  for (size_t i = 0; i < coarse.points.size(); ++i) moved_before.points[i] += d_before[i];
  for (size_t i = 0; i < fine.points.size(); ++i) moved_after.points[i] += d_after[i];
  for (int q = 0; q < 6; ++q) {
    for (double u : {0.0, 0.21, 0.77, 1.0}) {
      for (double v : {0.1, 0.5, 1.0}) {
        EXPECT_LE((moved_before.surface(q).point(u, v) - moved_after.surface(q).point(u, v)).norm(),
                  1e-13);
      }
    }
  }
}

TEST(DisplacementOracle, SizesThatDoNotFitAreTheCallersBug) {
  const PatchModel model = testing::small_cube();
  const DisplacementSpace space(model, at_scale(1));
  EXPECT_THROW(space.expand(std::vector<Vec3>(3)), PreconditionError);
  EXPECT_THROW(space.gather(std::vector<Vec3>(3)), PreconditionError);
  EXPECT_THROW(space.coefficient(0, -1, 0), PreconditionError);
  EXPECT_THROW(space.coefficient(0, 0, space.v_knots(0).size()), PreconditionError);
}

}  // namespace
}  // namespace isochor
