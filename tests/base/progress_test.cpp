#include "isochor/base/progress.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

namespace isochor {
namespace {

TEST(Progress, ATokenStartsDown) { EXPECT_FALSE(CancelToken().cancelled()); }

TEST(Progress, CopiesShareTheFlag) {
  const CancelToken token;
  const CancelToken before = token;
  token.cancel();
  const CancelToken after = token;
  EXPECT_TRUE(before.cancelled());
  EXPECT_TRUE(after.cancelled());
}

TEST(Progress, TokensMadeApartAreIndependent) {
  const CancelToken one;
  const CancelToken other;
  one.cancel();
  EXPECT_FALSE(other.cancelled());
}

TEST(Progress, AnotherThreadMayCancel) {
  const CancelToken token;
  std::thread thread([token] { token.cancel(); });
  thread.join();
  EXPECT_TRUE(token.cancelled());
}

TEST(Progress, CancellingTwiceIsLikeOnce) {
  const CancelToken token;
  token.cancel();
  token.cancel();
  EXPECT_TRUE(token.cancelled());
}

TEST(Progress, APartOfTheWorkHasItsShareOfTheFractions) {
  std::string seen;
  Watch whole;
  whole.progress = [&](double fraction, std::string_view step) {
    seen += std::string(step) + ' ' + std::to_string(fraction) + '\n';
  };
  const Watch second = whole.part(0.5, 1.0);
  second.progress(0.0, "a");
  second.part(0.5, 1.0).progress(1.0, "b");
  EXPECT_EQ(seen, "a 0.500000\nb 1.000000\n");
  second.cancel.cancel();
  EXPECT_TRUE(whole.cancel.cancelled());
}

TEST(Progress, APartOfSilentWorkIsSilent) { EXPECT_FALSE(Watch().part(0.0, 0.5).progress); }

TEST(Progress, ACallbackMayBeEmpty) {
  EXPECT_FALSE(ProgressCallback());
  std::string seen;
  const ProgressCallback callback = [&](double fraction, std::string_view step) {
    seen = std::string(step) + ' ' + std::to_string(fraction);
  };
  callback(0.5, "factorise");
  EXPECT_EQ(seen, "factorise 0.500000");
}

}  // namespace
}  // namespace isochor
