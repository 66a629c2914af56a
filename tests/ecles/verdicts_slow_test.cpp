#include "ecles/verdict_trial.h"

namespace isochor {
namespace {

TEST(Verdicts, RightOnTwentyThousandRandomSystems) { testing::expect_all_right(20000, 2017); }

}  // namespace
}  // namespace isochor
