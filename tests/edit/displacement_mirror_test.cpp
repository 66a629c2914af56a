// Mirror symmetry of a DisplacementSpace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/mirror.h"
#include "isochor/edit/solve.h"
#include "support/messages.h"

namespace isochor {
namespace {

using ::testing::AllOf;
using testing::centred_cube;
using ::testing::HasSubstr;
using testing::message_of;
using testing::mirrored;
using testing::prepared;
using testing::random_vectors;
using testing::value_of;

Vec3 reflected(Vec3 v, int axis) {
  v[axis] = -v[axis];
  return v;
}

// Random coefficients that respect the locks.
std::vector<Vec3> allowed(std::uint32_t seed, const DisplacementSpace& space) {
  std::vector<Vec3> delta = random_vectors(seed, static_cast<size_t>(space.size()));
  for (int c = 0; c < space.size(); ++c) {
    for (int a = 0; a < 3; ++a) {
      if (space.locked_axes(c) >> a & 1u) delta[static_cast<size_t>(c)][a] = 0.0;
    }
  }
  return delta;
}

TEST(DisplacementMirror, DisplacementsOfImagesAreImages) {
  for (int axis : {0, 1, 2}) {
    for (int k : {1, 2}) {
      const PatchModel model = centred_cube(3, 6);
      const DisplacementSpace space(model, mirrored(axis, k));
      const std::vector<Vec3> moved = space.expand(allowed(41, space));
      const std::vector<int> image = mirror_images(model.points, axis, 1e-9);
      for (size_t i = 0; i < moved.size(); ++i) {
        ASSERT_GE(image[i], 0);
        const Vec3 expected = reflected(moved[static_cast<size_t>(image[i])], axis);
        if (k == 1) {
          EXPECT_EQ(moved[i], expected) << "axis " << axis << ", point " << i;
        } else {
          EXPECT_LE((moved[i] - expected).norm(), 1e-14);
        }
      }
    }
  }
}

TEST(DisplacementMirror, OnlyTheAxisAcrossThePlaneIsLocked) {
  const PatchModel model = centred_cube(2, 5);  // an odd number of functions: some on the plane
  const DisplacementSpace space(model, mirrored(1));
  int on_plane = 0;
  for (int c = 0; c < space.size(); ++c) {
    const bool here = std::abs(space.place(c).y()) < 1e-12;
    EXPECT_EQ(space.locked_axes(c), here ? 2u : 0u);
    EXPECT_EQ(space.weight(c), here ? 1.0 : 2.0);
    EXPECT_EQ(space.lock_reason(c).empty(), !here) << "a lock has a reason";
    on_plane += here;
  }
  EXPECT_GT(on_plane, 0);
}

TEST(DisplacementMirror, LocksOfEitherImageHoldForBoth) {
  PatchModel model = centred_cube(3, 6);
  const int locked = model.patches[0].point(2, 3);
  const int image = mirror_images(model.points, 0, 1e-9)[static_cast<size_t>(locked)];
  for (int point : {locked, image}) {
    PatchModel one = model;
    one.lock(point, "a window is here", false);
    const DisplacementSpace space(one, mirrored(0));
    const std::vector<Vec3> moved = space.expand(allowed(42, space));
    EXPECT_EQ(moved[static_cast<size_t>(locked)], Vec3::Zero());
    EXPECT_EQ(moved[static_cast<size_t>(image)], Vec3::Zero());
    EXPECT_EQ(space.lock_reason(space.coefficient(0, 2, 3)), "a window is here");
  }
}

TEST(DisplacementMirror, SurfaceRowsPredictTheMovedSurface) {
  for (int k : {1, 2}) {
    const PatchModel model = centred_cube(3, 6);
    const DisplacementSpace space(model, mirrored(2, k));
    const auto delta = allowed(43, space);
    PatchModel moved = model;
    const auto displacement = space.expand(delta);
    for (size_t i = 0; i < moved.points.size(); ++i) moved.points[i] += displacement[i];
    for (int q = 0; q < 6; ++q) {
      for (const Uv uv : {Uv{0.31, 0.77}, Uv{0.5, 0.5}, Uv{0.0, 0.25}}) {
        const Vec3 got = moved.surface(q).point(uv.u, uv.v) - model.surface(q).point(uv.u, uv.v);
        const Vec3 predicted = value_of(space.surface_row(model, q, uv), delta);
        EXPECT_LE((got - predicted).norm(), 1e-13);
      }
    }
  }
}

TEST(DisplacementMirror, GridRowsCarryTheFlippedSign) {
  const PatchModel model = centred_cube(3, 6);
  const DisplacementSpace space(model, mirrored(0));
  const auto delta = allowed(44, space);
  const std::vector<Vec3> moved = space.expand(delta);
  const Patch& top = model.patches[0];
  for (int i = 0; i < top.u_size(); ++i) {
    for (int j = 0; j < top.v_size(); ++j) {
      EXPECT_EQ(value_of(space.grid_row(0, i, j), delta),
                moved[static_cast<size_t>(top.point(i, j))]);
    }
  }
}

TEST(DisplacementMirror, ATorusMirrorsAcrossItsSeam) {
  const PatchModel torus = prepared(testing::make_periodic_torus(3, 3, 12, 12));
  for (int axis : {0, 1, 2}) {
    const DisplacementSpace space(torus, mirrored(axis));
    const auto moved = space.expand(allowed(45, space));
    const auto image = mirror_images(torus.points, axis, 1e-9);
    for (size_t i = 0; i < moved.size(); ++i) {
      EXPECT_EQ(moved[i], reflected(moved[static_cast<size_t>(image[i])], axis));
    }
  }
}

TEST(DisplacementMirror, APointThatIsOffIsNamed) {
  PatchModel model = centred_cube(3, 4);
  const int point = model.patches[0].point(2, 2);
  model.points[static_cast<size_t>(point)].z() += 0.25;
  const auto message = [&](int axis) {
    return message_of<InputError>([&] { DisplacementSpace refused(model, mirrored(axis)); });
  };
  EXPECT_THAT(message(0), AllOf(HasSubstr("hold symmetry \"x\""), HasSubstr("of patch face:1"),
                                HasSubstr("no mirror image across the plane x = 0 within")));
  EXPECT_THAT(message(2), HasSubstr("hold symmetry \"z\""));
}

TEST(DisplacementMirror, KnotsThatAreNotMirroredAreNoticed) {
  // All places on the plane y = const are symmetric in x, the knots are not.
  const KnotVector even = KnotVector::uniform(2, 4);
  const KnotVector uneven = KnotVector::clamped(2, {0.0, 0.25, 0.5, 0.8, 1.0});
  PatchModel model = testing::make_box_model(uneven, even, even);
  testing::translate(model, Vec3::Constant(-0.5));
  EXPECT_THAT(
      message_of<InputError>([&] { DisplacementSpace refused(prepared(model), mirrored(0)); }),
      HasSubstr("has no mirror image across the plane x = 0"));
  EXPECT_NO_THROW(DisplacementSpace(prepared(model), mirrored(1)));
}

TEST(DisplacementMirror, SmallAsymmetriesStayBitForBit) {
  PatchModel model = centred_cube(3, 4);
  const int point = model.patches[0].point(2, 2);
  model.points[static_cast<size_t>(point)].z() += 1e-9;  // far below kCoincident
  const DisplacementSpace space(model, mirrored(0));
  const auto moved = space.expand(allowed(46, space));
  const auto image = mirror_images(model.points, 0, 1e-6);
  for (size_t i = 0; i < moved.size(); ++i) {
    EXPECT_EQ(moved[i], reflected(moved[static_cast<size_t>(image[i])], 0));
  }
}

TEST(DisplacementMirror, SymmetryOfARationalModelIncludesItsWeights) {
  PatchModel model = centred_cube(2, 4);
  for (Patch& patch : model.patches) {
    patch.weights.assign(patch.points.size(), 1.0);
    for (size_t k = 0; k < patch.points.size(); ++k) {
      const Vec3& p = model.points[static_cast<size_t>(patch.points[k])];
      patch.weights[k] = 2.0 + p.x();  // not symmetric in x, symmetric in y
    }
  }
  EXPECT_THAT(message_of<InputError>([&] { DisplacementSpace refused(model, mirrored(0)); }),
              HasSubstr("has no mirror image"));
  EXPECT_NO_THROW(DisplacementSpace(model, mirrored(1)));
}

TEST(DisplacementMirror, TwoPlanesLeaveAQuarter) {
  const PatchModel model = centred_cube(2, 4);
  DisplacementSpace::Options options = mirrored(0);
  options.symmetry_axes = {0, 1};
  const DisplacementSpace space(model, options);
  double weights = 0.0;
  for (int c = 0; c < space.size(); ++c) weights += space.weight(c);
  EXPECT_EQ(weights, DisplacementSpace(model, testing::at_scale(1)).size());
  const auto moved = space.expand(allowed(47, space));
  for (int axis : {0, 1}) {
    const auto image = mirror_images(model.points, axis, 1e-9);
    for (size_t i = 0; i < moved.size(); ++i) {
      EXPECT_EQ(moved[i], reflected(moved[static_cast<size_t>(image[i])], axis));
    }
  }
}

// A place on the plane cannot leave it; rounding of its row must not pretend otherwise.
TEST(DisplacementMirror, MovesOnThePlaneStayOnIt) {
  PatchModel model = testing::make_cube_model(3, 7);
  testing::translate(model, Vec3(-0.1, -0.5, -0.3));
  model = prepared(model);
  const DisplacementSpace space(model, mirrored(1));
  const VolumeForm volume(model);
  SolveProblem problem;
  problem.space = &space;
  problem.volume = &volume;
  problem.points = &model.points;
  problem.extent.assign(static_cast<size_t>(space.size()), 1);
  problem.sink = problem.extent;
  problem.size = diagonal(model);
  for (double u : {0.1, 0.37, 0.5, 0.913}) {
    problem.constraints = {
        {"move[0]", space.surface_row(model, 0, {u, 0.5}), Vec3(0.1, 1e-18, 0.2)}};
    const SolveResult along = solve(problem);
    EXPECT_EQ(along.outcome, Outcome::kDone) << u << ": " << along.reason;
    EXPECT_EQ(along.rank, 2) << "nothing can move across the plane";
    problem.constraints[0].value = Vec3(0.1, 1e-3, 0.2);
    const SolveResult across = solve(problem);
    EXPECT_EQ(across.outcome, Outcome::kInfeasible) << u;
    EXPECT_EQ(across.culprits, std::vector<std::string>{"move[0]"});
  }
}

}  // namespace
}  // namespace isochor
