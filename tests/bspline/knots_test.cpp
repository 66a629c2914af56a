#include "isochor/bspline/knots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Knots, InvariantIsNamedWithNumbersWhereItBreaks) {
  struct Case {
    int degree;
    std::vector<double> knots;
    const char* text;
  };
  const std::vector<Case> cases = {
      {0, {0, 1}, "degree 0 is not between 1 and 25"},
      {-3, {0, 1}, "degree -3 is not between 1 and 25"},
      {26, std::vector<double>(54, 0.0), "degree 26 is not between 1 and 25"},
      {1, {0, 0, 1}, "3 knots are too few for degree 1 (at least 4)"},
      {2, {}, "0 knots are too few for degree 2 (at least 6)"},
      {1, {0, 0, std::nan(""), 1}, "knot 2 is not a finite number"},
      {1, {-kInfinity, 0, 1, 1}, "knot 0 is not a finite number"},
      {1, {0, 1, 0.5, 1}, "knot 2 decreases: 0.5 after 1"},
      {1, {0, 1, 1, 2}, "the domain [1, 1] is empty"},
      {2, {0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1}, "knot 0.5 has multiplicity 3, more than 2"},
      {2, {0, 0, 0, 0, 1, 1, 1}, "knot 0 has multiplicity 4, more than 3"},
      {2, {0, 0, 0, 1, 1, 1, 1}, "knot 1 has multiplicity 4, more than 3"},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(KnotVector::defect(c.degree, c.knots), c.text);
    EXPECT_THAT(message_of<PreconditionError>([&] { KnotVector(c.degree, c.knots); }),
                HasSubstr(c.text));
  }
  EXPECT_THAT(KnotVector::defect(2, {0, 0, 0, 0.5, 0.5, 1, 1, 1}), IsEmpty());
  EXPECT_THAT(KnotVector::defect(1, {-1, 0, 0, 1, 1, 2}), IsEmpty()) << "full ends, unclamped";
}

TEST(Knots, NegativeZeroIsZero) {
  const KnotVector knots(1, {-0.0, 0.0, 1.0, 1.0});
  EXPECT_TRUE(knots.clamped_begin());
  EXPECT_EQ(knots.multiplicity(0.0), 2);
  EXPECT_EQ(knots, KnotVector::uniform(1, 1));
}

// Law (1) written down a second time, over all knot vectors of small whole numbers.
TEST(Knots, InvariantOnAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    const auto d = static_cast<size_t>(degree);
    for (size_t count = 2 * d; count <= 8; ++count) {
      std::vector<double> knots(count);
      size_t valid = 0;
      for (int code = 0; code < std::pow(3.0, static_cast<double>(count)); ++code) {
        int rest = code;
        for (double& t : knots) {
          t = rest % 3;
          rest /= 3;
        }
        bool right = count >= 2 * d + 2 && std::is_sorted(knots.begin(), knots.end()) &&
                     knots[d] < knots[count - d - 1];
        for (double t : {0.0, 1.0, 2.0}) {
          const auto copies = static_cast<size_t>(std::count(knots.begin(), knots.end(), t));
          const bool at_end = right && (t <= knots[d] || t >= knots[count - d - 1]);
          if (copies > d + (at_end ? 1 : 0)) right = false;
        }
        valid += right;
        ASSERT_EQ(KnotVector::defect(degree, knots).empty(), right)
            << degree << ' ' << ::testing::PrintToString(knots);
      }
      if (count >= 2 * d + 2) {
        EXPECT_EQ(valid,
                  isochor::testing::all_small_knots(degree, static_cast<int>(count), 2).size());
      }
    }
  }
}

TEST(Knots, SpansAndBreaksOnAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    for (const KnotVector& knots : isochor::testing::all_small_knots(degree, 2 * degree + 4)) {
      SCOPED_TRACE(::testing::PrintToString(knots.knots()));
      EXPECT_EQ(knots.size(), degree + 3);
      EXPECT_EQ(knots.breaks().size(), knots.spans().size() + 1);
      EXPECT_TRUE(std::is_sorted(knots.spans().begin(), knots.spans().end()));
      for (double u = -0.75; u < 4.0; u += 0.25) {
        const int k = knots.span_of(u);
        ASSERT_TRUE(degree <= k && k < knots.size()) << u;
        EXPECT_LT(knots[k], knots[k + 1]);
        EXPECT_TRUE(std::count(knots.spans().begin(), knots.spans().end(), k) == 1);
        if (u < knots.begin()) {
          EXPECT_EQ(k, knots.spans().front());
        } else if (u >= knots.end()) {
          EXPECT_EQ(k, knots.spans().back());
        } else {
          EXPECT_LE(knots[k], u);
          EXPECT_LT(u, knots[k + 1]);
        }
      }
      size_t inside = 0;
      for (double value : knots.breaks()) {
        const auto copies = static_cast<size_t>(knots.multiplicity(value));
        EXPECT_EQ(copies, static_cast<size_t>(
                              std::count(knots.knots().begin(), knots.knots().end(), value)));
        if (value > knots.begin() && value < knots.end()) inside += copies;
      }
      EXPECT_EQ(knots.interior().size(), inside);
      EXPECT_EQ(knots.clamped_begin(), knots[0] == knots.begin());
      EXPECT_EQ(knots.clamped_end(), knots.knots().back() == knots.end());
      for (int i = 0; i < knots.size(); ++i) {
        EXPECT_GE(knots.greville(i), knots.begin());
        EXPECT_LE(knots.greville(i), knots.end());
      }
    }
  }
}

TEST(Knots, FactoriesMakeClampedVectors) {
  const KnotVector knots = KnotVector::clamped(2, {-1.0, 0.25, 0.25, 3.0});
  EXPECT_THAT(knots.knots(), ElementsAre(-1, -1, -1, 0.25, 0.25, 3, 3, 3));
  EXPECT_THAT(knots.interior(), ElementsAre(0.25, 0.25));
  EXPECT_THAT(knots.breaks(), ElementsAre(-1, 0.25, 3));
  EXPECT_EQ(knots.multiplicity(0.5), 0);
  EXPECT_THAT(KnotVector::uniform(1, 4, 2.0, 3.0).knots(),
              ElementsAre(2, 2, 2.25, 2.5, 2.75, 3, 3));
  // The end is the end, whatever the rounding of the steps.
  for (int spans : {3, 7, 49}) {
    const KnotVector steps = KnotVector::uniform(3, spans, 0.1, 0.7);
    EXPECT_EQ(steps.end(), 0.7);
    EXPECT_EQ(steps.spans().size(), static_cast<size_t>(spans));
  }
}

TEST(Knots, FactoriesRefuseWhatMakesNoVector) {
  EXPECT_THROW(KnotVector::clamped(2, {1.0}), PreconditionError);
  EXPECT_THROW(KnotVector::clamped(2, {}), PreconditionError);
  EXPECT_THROW(KnotVector::clamped(2, {1.0, 1.0}), PreconditionError);
  EXPECT_THROW(KnotVector::clamped(1, {0.0, 0.5, 0.5, 1.0}), PreconditionError);
  EXPECT_THROW(KnotVector::uniform(3, 0), PreconditionError);
  EXPECT_THROW(KnotVector::uniform(3, 2, 1.0, 1.0), PreconditionError);
  for (int degree : {-1, 0, kMaxDegree + 1}) {
    EXPECT_THAT(message_of<PreconditionError>([&] {
                  KnotVector::clamped(degree, {0.0, 1.0});
                }),
                HasSubstr("degree " + std::to_string(degree) + " is not between 1 and 25"));
  }
}

TEST(Knots, GrevillePointsOfACubic) {
  const KnotVector knots = KnotVector::clamped(3, {0.0, 3.0, 6.0});
  const std::vector<double> expected = {0.0, 1.0, 3.0, 5.0, 6.0};
  for (int i = 0; i < knots.size(); ++i) {
    EXPECT_EQ(knots.greville(i), expected[static_cast<size_t>(i)]);
  }
  EXPECT_THROW(static_cast<void>(knots.greville(-1)), PreconditionError);
  EXPECT_THROW(static_cast<void>(knots.greville(5)), PreconditionError);
  // Unclamped: the mean may lie outside the domain, where no coefficient "is".
  const KnotVector open(2, {0, 1, 2, 3, 4, 5});
  EXPECT_EQ(open.greville(0), 2.0);
  EXPECT_EQ(open.greville(2), 3.0);
}

TEST(Knots, ComparisonIsExact) {
  const KnotVector a = KnotVector::uniform(2, 3);
  const KnotVector copy = a;
  EXPECT_EQ(a, copy);
  EXPECT_EQ(&a.knots(), &copy.knots()) << "copies share their data";
  EXPECT_EQ(a, KnotVector(2, a.knots()));
  std::vector<double> next = a.knots();
  next[3] = std::nextafter(next[3], 1.0);
  EXPECT_NE(a, KnotVector(2, next));
  // The same numbers, another degree.
  const std::vector<double> shared = {0, 0, 0, 1, 1, 1};
  EXPECT_NE(KnotVector(1, {0, 0, 1, 1}), KnotVector(2, shared));
  const std::vector<double> simple = {0, 1, 2, 3, 4, 5};
  EXPECT_NE(KnotVector(1, simple), KnotVector(2, simple));
}

}  // namespace
}  // namespace isochor
