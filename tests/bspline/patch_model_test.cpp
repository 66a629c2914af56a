#include "isochor/bspline/patch_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "isochor/base/error.h"
#include "support/messages.h"
#include "support/models.h"

namespace isochor {
namespace {

using ::isochor::testing::make_cube_model;
using ::isochor::testing::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

// What validate says about a cube of bilinear faces that was changed.
std::string verdict_on(const std::function<void(PatchModel&)>& change) {
  PatchModel model = make_cube_model(1, 1);
  change(model);
  return message_of<InputError>([&] { validate(model); });
}

TEST(PatchModel, ValidModelsPass) {
  EXPECT_EQ(verdict_on([](PatchModel&) {}), "no error");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m = PatchModel{}; }), "no error");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.ties = {{0, 7}, {7, 0}, {3, 3}}; }), "no error");
  EXPECT_EQ(verdict_on([](PatchModel& m) {
              m.patches[2].weights = {1, 1e-300, 1e300, 2};
            }),
            "no error");
  // Two patches may share a name, not a handle.
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.patches[1].name = m.patches[0].name; }), "no error");
}

TEST(PatchModel, ValidateNamesThePatchAndTheNumber) {
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.points[6].y() = std::nan(""); }),
            "point 6: a coordinate is not a finite number");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.points[0].z() = -INFINITY; }),
            "point 0: a coordinate is not a finite number");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.patches[1].points.pop_back(); }),
            "patch face:2 (\"bottom\"): 3 poles do not fit 2 x 2");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.patches[1].points[2] = 8; }),
            "patch face:2 (\"bottom\"): pole index 8 is not in the table of 8 points");
  EXPECT_EQ(verdict_on([](PatchModel& m) {
              m.patches[0].points[0] = -1;
              m.patches[0].name.clear();
            }),
            "patch face:1: pole index -1 is not in the table of 8 points");
  EXPECT_EQ(verdict_on([](PatchModel& m) {
              m.patches[3].weights = {1, 2, 3, 4, 5};
            }),
            "patch face:4 (\"left\"): 5 weights do not fit the poles");
  EXPECT_EQ(verdict_on([](PatchModel& m) { m.patches[3].handle = "face:2"; }),
            "patch face:2 (\"left\"): the handle is used twice");
  EXPECT_EQ(verdict_on([](PatchModel& m) {
              m.ties = {{0, 1}, {2, 8}};
            }),
            "tie [2, 8]: not in the table of 8 points");
  EXPECT_EQ(verdict_on([](PatchModel& m) {
              m.ties = {{-1, 1}};
            }),
            "tie [-1, 1]: not in the table of 8 points");
}

TEST(PatchModel, WeightsThatAreNotPositiveAreQuoted) {
  const auto with_weight = [](double w) {
    return verdict_on([w](PatchModel& m) { m.patches[0].weights = {1, 1, w, 1}; });
  };
  EXPECT_EQ(with_weight(0.0), "patch face:1 (\"top\"): weight 0 is not positive");
  EXPECT_EQ(with_weight(-2.5), "patch face:1 (\"top\"): weight -2.5 is not positive");
  EXPECT_THAT(with_weight(-1e-9), HasSubstr("weight -1.0000000000000001e-09 is not positive"));
  EXPECT_THAT(with_weight(std::nan("")), HasSubstr("nan is not positive"));
  EXPECT_THAT(with_weight(INFINITY), HasSubstr("weight inf is not finite"));
}

TEST(PatchModel, ClassesAreNumberedByFirstOccurrence) {
  PatchModel model;
  model.points.assign(8, Vec3::Zero());
  model.ties = {{6, 4}, {1, 6}, {7, 3}, {3, 7}, {5, 5}};
  const PointClasses classes = point_classes(model);
  EXPECT_THAT(classes.class_of, ElementsAre(0, 1, 2, 3, 1, 4, 1, 3));
  EXPECT_THAT(classes.representative, ElementsAre(0, 1, 2, 3, 5));
  EXPECT_TRUE(point_classes(PatchModel{}).class_of.empty());
}

// Second method: a class is what breadth-first search reaches.
TEST(PatchModel, ClassesAreTheConnectedSetsOfTies) {
  std::mt19937 random(331);
  for (int round = 0; round < 20; ++round) {
    PatchModel model;
    model.points.assign(40, Vec3::Zero());
    std::uniform_int_distribution<int> point(0, 39);
    for (int k = 0; k < 4 + 2 * round; ++k) model.ties.emplace_back(point(random), point(random));
    std::vector<int> reached(40, -1);
    int count = 0;
    for (size_t start = 0; start < 40; ++start) {
      if (reached[start] >= 0) continue;
      reached[start] = count;
      for (bool grown = true; grown;) {
        grown = false;
        for (const auto& [a, b] : model.ties) {
          int& at_a = reached[static_cast<size_t>(a)];
          int& at_b = reached[static_cast<size_t>(b)];
          if ((at_a == count) == (at_b == count)) continue;
          at_a = at_b = count;
          grown = true;
        }
      }
      ++count;
    }
    EXPECT_EQ(point_classes(model).class_of, reached);
    EXPECT_EQ(point_classes(model).representative.size(), static_cast<size_t>(count));
  }
}

TEST(PatchModel, ALongChainOfTiesIsOneClass) {
  PatchModel model;
  model.points.assign(100000, Vec3::Zero());
  for (int i = 99999; i > 0; --i) model.ties.emplace_back(i, i - 1);
  EXPECT_EQ(point_classes(model).representative.size(), 1u);
}

TEST(PatchModel, SideIndicesRunWithTheFreeParameter) {
  PatchModel model;
  Patch patch{"",
              "face:1",
              KnotVector::uniform(1, 1),
              KnotVector::uniform(2, 1),
              {0, 1, 2, 3, 4, 5},
              {},
              false,
              {},
              {}};
  EXPECT_THAT(side_indices(patch, Side::kUBegin), ElementsAre(Pair(0, 0), Pair(0, 1), Pair(0, 2)));
  EXPECT_THAT(side_indices(patch, Side::kUEnd), ElementsAre(Pair(1, 0), Pair(1, 1), Pair(1, 2)));
  EXPECT_THAT(side_indices(patch, Side::kUEnd, 1), ElementsAre(Pair(0, 0), Pair(0, 1), Pair(0, 2)));
  EXPECT_THAT(side_indices(patch, Side::kVBegin), ElementsAre(Pair(0, 0), Pair(1, 0)));
  EXPECT_THAT(side_indices(patch, Side::kVBegin, 2), ElementsAre(Pair(0, 2), Pair(1, 2)));
  EXPECT_THAT(side_indices(patch, Side::kVEnd), ElementsAre(Pair(0, 2), Pair(1, 2)));
  EXPECT_EQ(patch.point(1, 2), 5);
  EXPECT_EQ(patch.sign(), 1.0);
  patch.reversed = true;
  EXPECT_EQ(patch.sign(), -1.0);
  EXPECT_THROW(side_indices(patch, Side::kUBegin, 2), PreconditionError);
  EXPECT_THROW(side_indices(patch, Side::kVEnd, 3), PreconditionError);
  EXPECT_THROW(side_indices(patch, Side::kVEnd, -1), PreconditionError);
}

TEST(PatchModel, SurfacesTakeTheGivenPoints) {
  PatchModel model = make_cube_model(1, 1);
  model.patches[0].weights = {1, 2, 3, 4};
  EXPECT_EQ(model.surface(0).weights(), model.patches[0].weights);
  EXPECT_EQ(model.surface(0).point(0, 0), Vec3(0, 0, 1));
  std::vector<Vec3> lifted = model.points;
  for (Vec3& p : lifted) p.z() += 2.0;
  EXPECT_EQ(model.surface(0, lifted).point(0, 0), Vec3(0, 0, 3));
  EXPECT_EQ(model.surface(0).point(0, 0), Vec3(0, 0, 1)) << "the model itself is not changed";
}

TEST(PatchModel, DiagonalIsOfAllPoints) {
  EXPECT_EQ(diagonal(PatchModel{}), 0.0);
  PatchModel model;
  model.points = {{5, 5, 5}};
  EXPECT_EQ(diagonal(model), 0.0);
  model.points.push_back({4, 7, 3});
  EXPECT_EQ(diagonal(model), 3.0);
  model.points.push_back({4.5, 6, 4});
  EXPECT_EQ(diagonal(model), 3.0);
}

TEST(PatchModel, LocksShareTheirReasons) {
  PatchModel model;
  model.lock(4, "trimmed", false);
  model.lock(5, "trimmed", false);
  model.lock(4, "trimmed", true);  // the same words for another purpose
  model.lock(6, "other", true);
  ASSERT_EQ(model.lock_reasons.size(), 3u);
  EXPECT_TRUE(model.lock_reasons[1].continuity);
  std::vector<int> reasons;
  for (const Lock& lock : model.locks) reasons.push_back(lock.reason);
  EXPECT_THAT(reasons, ElementsAre(0, 0, 1, 2));
  EXPECT_EQ(model.locks[3].point, 6);
}

TEST(PatchModel, SmoothnessHasNamesAndAnOrder) {
  EXPECT_STREQ(name_of(Smoothness::kSharp), "C0");
  EXPECT_STREQ(name_of(Smoothness::kAlmost), "almost G1");
  EXPECT_STREQ(name_of(Smoothness::kTangent), "G1");
  EXPECT_STREQ(name_of(Smoothness::kCurvature), "G2");
  EXPECT_LT(Smoothness::kSharp, Smoothness::kAlmost);
  EXPECT_LT(Smoothness::kAlmost, Smoothness::kTangent);
  EXPECT_LT(Smoothness::kTangent, Smoothness::kCurvature);
}

}  // namespace
}  // namespace isochor
