#include "isochor/base/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace isochor {
namespace {

TEST(RunTasks, EveryTaskRunsOnce) {
  for (int threads : {0, 1, 2, 7}) {
    for (int count : {0, 1, 2, 1000}) {
      std::vector<int> runs(static_cast<size_t>(count), 0);
      run_tasks(count, threads, [&](int k) { ++runs[static_cast<size_t>(k)]; });
      EXPECT_EQ(runs, std::vector<int>(static_cast<size_t>(count), 1)) << threads;
    }
  }
}

TEST(RunTasks, TheLowestFailureComesBack) {
  for (int threads : {1, 3}) {
    try {
      run_tasks(100, threads, [](int k) {
        if (k % 10 == 7) throw std::runtime_error(std::to_string(k));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      // Tasks are handed out in order: the first that fails has been started whatever happens.
      EXPECT_STREQ(error.what(), "7");
    }
  }
}

TEST(RunTasks, NothingIsStartedAfterAFailure) {
  int started = 0;
  EXPECT_THROW(run_tasks(100, 1,
                         [&](int k) {
                           ++started;
                           if (k == 3) throw std::runtime_error("stop");
                         }),
               std::runtime_error);
  EXPECT_EQ(started, 4);
}

}  // namespace
}  // namespace isochor
