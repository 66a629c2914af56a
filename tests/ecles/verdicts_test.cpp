#include "ecles/verdict_trial.h"

namespace isochor {
namespace {

TEST(Verdicts, RightOnRandomSystems) { testing::expect_all_right(800, 4); }

}  // namespace
}  // namespace isochor
