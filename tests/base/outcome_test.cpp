#include "isochor/base/outcome.h"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace isochor {
namespace {

TEST(Outcome, NamesAreThoseOfTheReport) {
  EXPECT_EQ(name_of(Outcome::kDone), "done");
  EXPECT_EQ(name_of(Outcome::kInfeasible), "infeasible");
  EXPECT_EQ(name_of(Outcome::kUndecided), "undecided");
  EXPECT_EQ(name_of(Outcome::kConflicting), "conflicting");
  EXPECT_EQ(name_of(Outcome::kRefused), "refused");
  EXPECT_EQ(name_of(Outcome::kCancelled), "cancelled");
}

TEST(Outcome, NoTwoShareAName) {
  std::set<std::string_view> names;
  for (Outcome outcome : {Outcome::kDone, Outcome::kInfeasible, Outcome::kUndecided,
                          Outcome::kConflicting, Outcome::kRefused, Outcome::kCancelled}) {
    EXPECT_TRUE(names.insert(name_of(outcome)).second) << name_of(outcome);
  }
}

TEST(Outcome, NamesAreKnownWhileCompiling) {
  static_assert(name_of(Outcome::kRefused) == "refused");
  static_assert(name_of(static_cast<Outcome>(99)) == "unknown");
}

}  // namespace
}  // namespace isochor
