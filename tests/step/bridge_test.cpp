#include "isochor/step/bridge.h"

#include <dirent.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <thread>

#include "isochor/base/error.h"
#include "isochor/step/child_progress.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

BridgeLimits seconds(double s) {
  BridgeLimits limits;
  limits.seconds = s;
  return limits;
}

int open_descriptors() {
  DIR* folder = opendir("/proc/self/fd");
  if (folder == nullptr) throw std::runtime_error("/proc is not mounted: descriptors are unknown");
  int count = 0;
  while (readdir(folder) != nullptr) ++count;
  closedir(folder);
  return count;
}

bool has_children() { return waitpid(-1, nullptr, WNOHANG) == 0 || errno != ECHILD; }

template <typename Function>
InputError input_error_of(Function&& function) {
  try {
    function();
  } catch (const InputError& e) {
    return e;
  }
  ADD_FAILURE() << "no InputError";
  return InputError("", "", "");
}

void burn() {
  for (volatile unsigned k = 0;; k = k + 1) {
  }
}

std::string eat_memory() {
  std::vector<std::unique_ptr<char[]>> eaten;
  for (;;) eaten.emplace_back(new char[size_t{64} << 20]);  // untouched: quick
}

TEST(Bridge, ResultsComeBack) {
  EXPECT_EQ(run_in_child("f", [] { return std::string("ok\0ok", 5); }), std::string("ok\0ok", 5));
  EXPECT_EQ(run_in_child("f", [] { return std::string(); }), "");
  const std::string big(20 << 20, 'b');
  EXPECT_TRUE(run_in_child("f", [&] { return big; }) == big);
  const std::function<std::vector<double>()> work = [] { return std::vector<double>{0.1, 0.2}; };
  EXPECT_EQ(call_in_child("f", work), (std::vector<double>{0.1, 0.2}));
}

TEST(Bridge, ChangesOfTheChildStayThere) {
  int value = 1;
  run_in_child("f", [&] {
    value = 2;
    return std::string();
  });
  EXPECT_EQ(value, 1);
}

TEST(Bridge, InputErrorsArriveUnchanged) {
  const auto work = []() -> std::string { throw InputError("a.step", "face:3", "is odd"); };
  const auto e = input_error_of([&] { run_in_child("b.step", work); });
  EXPECT_EQ(e.file(), "a.step");
  EXPECT_EQ(e.entity(), "face:3");
  EXPECT_EQ(e.reason(), "is odd");
  const auto nameless = []() -> std::string { throw InputError("", "x", "y"); };
  EXPECT_EQ(input_error_of([&] { run_in_child("b.step", nameless); }).file(), "b.step");
}

TEST(Bridge, OtherExceptionsAreReasons) {
  const auto standard = []() -> std::string { throw std::out_of_range("index 7"); };
  EXPECT_EQ(input_error_of([&] { run_in_child("b", standard); }).reason(), "index 7");
  const auto odd = []() -> std::string { throw 42; };
  EXPECT_THAT(input_error_of([&] { run_in_child("b", odd); }).reason(), HasSubstr("unknown type"));
}

TEST(Bridge, CrashesAreReported) {
  for (int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL}) {
    const auto result = run_child([signal]() -> std::string {
      std::raise(signal);
      return "alive";
    });
    EXPECT_NE(result.end, ChildEnd::kFinished) << signal;
    EXPECT_FALSE(result.reason.empty()) << signal;
  }
  const auto segv = run_child([]() -> std::string {
    std::raise(SIGSEGV);
    return "alive";
  });
  EXPECT_EQ(segv.end, ChildEnd::kDied);
  EXPECT_THAT(segv.reason, HasSubstr("crashed"));
  const auto exits = run_child([]() -> std::string { _exit(3); });
  EXPECT_EQ(exits.end, ChildEnd::kDied);
  EXPECT_FALSE(has_children());
}

TEST(Bridge, EndlessLoopsAreStopped) {
  const auto result = run_child(
      []() -> std::string {
        burn();
        return "";
      },
      seconds(1));
  EXPECT_EQ(result.end, ChildEnd::kTimedOut);
  EXPECT_THAT(result.reason, HasSubstr("took longer than the 1 s allowed"));
}

TEST(Bridge, MemoryIsLimited) {
  if (kSanitized) GTEST_SKIP() << "sanitizers reserve terabytes of address space";
  BridgeLimits limits;
  limits.megabytes = 2000;
  const auto result = run_child(eat_memory, limits);
  EXPECT_EQ(result.end, ChildEnd::kOutOfMemory);
  EXPECT_THAT(result.reason, HasSubstr("2000 MB"));
}

TEST(Bridge, LimitsHaveAnErrorOfTheirOwn) {
  const auto endless = []() -> std::string {
    burn();
    return "";
  };
  try {
    run_in_child("slow.step", endless, seconds(1));
    FAIL() << "no LimitError";
  } catch (const LimitError& e) {
    EXPECT_EQ(e.limit(), LimitError::Limit::kTime);
    EXPECT_EQ(e.file(), "slow.step");
    EXPECT_THAT(e.reason(), HasSubstr("1 s"));
  }
  if (kSanitized) return;
  BridgeLimits limits;
  limits.megabytes = 2000;
  try {
    run_in_child("big.step", eat_memory, limits);
    FAIL() << "no LimitError";
  } catch (const LimitError& e) {
    EXPECT_EQ(e.limit(), LimitError::Limit::kMemory);
    EXPECT_EQ(e.file(), "big.step");
  }
}

TEST(Bridge, ProgressArrivesInOrderAndNeverGoesBack) {
  std::vector<double> fractions;
  std::vector<std::string> steps;
  Watch watch;
  watch.progress = [&](double fraction, std::string_view step) {
    fractions.push_back(fraction);
    steps.emplace_back(step);
  };
  const auto work = [] {
    {
      const internal::ProgressPart part(0.0, 0.5);
      internal::tell_progress(0.0, "reading");
      for (int k = 0; k <= 100; ++k) internal::tell_progress(0.01 * k, "reading");
      internal::tell_progress(0.2, "reading again");  // a stage that starts over
      const internal::ProgressPart inner(0.5, 1.0);
      internal::tell_progress(7.0, "beyond");
    }
    internal::tell_progress(0.5, "measuring");
    internal::tell_progress(1.0, "measuring");
    return std::string("done");
  };
  EXPECT_EQ(run_in_child("f", work, {}, watch), "done");
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.front(), 0.0);
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_EQ(steps.front(), "reading");
  EXPECT_EQ(steps.back(), "measuring");
  EXPECT_EQ(std::count(fractions.begin(), fractions.end(), 1.0), 1);
  EXPECT_NE(std::find(steps.begin(), steps.end(), "reading again"), steps.end());
}

TEST(Bridge, OnlyProgressThatSomebodyCouldSeeIsWorthAMessage) {
  int heard = 0;
  internal::set_progress_sink([&](double, std::string_view) { ++heard; });
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < 100000; ++k) internal::tell_progress(1e-5 * k, "reading");
  const auto time = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(heard, 1 + time / std::chrono::milliseconds(10));
  heard = 0;
  for (int k = 0; k < 5; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(12));
    internal::tell_progress(0.999, "reading");
    internal::tell_progress(0.9991 + 1e-5 * k, "reading");
  }
  EXPECT_LE(heard, 1) << "less than half a percent is nothing, however long it takes";
  internal::set_progress_sink([&](double, std::string_view) { ++heard; });
  heard = 0;
  for (int k = 0; k < 5; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(12));
    internal::tell_progress(0.1 * k, "reading");
  }
  EXPECT_EQ(heard, 5);
  internal::set_progress_sink({});
}

TEST(Bridge, ProgressOutsideAChildGoesNowhere) {
  internal::tell_progress(0.5, "nobody listens");
  std::vector<double> heard;
  internal::set_progress_sink(
      [&](double fraction, std::string_view) { heard.push_back(fraction); });
  {
    const internal::ProgressPart half(0.5, 1.0);
    internal::tell_progress(0.5, "here");
  }
  internal::set_progress_sink({});
  internal::tell_progress(1.0, "nobody again");
  EXPECT_EQ(heard, std::vector<double>{0.75});
}

TEST(Bridge, AnErrorAfterProgressIsStillTheError) {
  const auto work = []() -> std::string {
    internal::tell_progress(0.3, "reading");
    throw InputError("a.step", "#7", "is odd");
  };
  EXPECT_EQ(input_error_of([&] { run_in_child("a.step", work); }).entity(), "#7");
  const auto dies = []() -> std::string {
    internal::tell_progress(0.3, "reading");
    _exit(1);
  };
  EXPECT_EQ(run_child(dies).end, ChildEnd::kDied);
}

TEST(Bridge, KeysForTheParentDoNotEndTheChild) {
  const auto result = run_child([]() -> std::string {
    std::raise(SIGINT);
    std::raise(SIGTERM);
    return "alive";
  });
  EXPECT_EQ(result.end, ChildEnd::kFinished);
  EXPECT_EQ(result.bytes, "alive");
}

TEST(Bridge, CancelledBeforeTheStartIsCancelled) {
  Watch watch;
  watch.cancel.cancel();
  const auto work = [] { return std::string("ran"); };
  EXPECT_EQ(run_child(work, {}, watch).end, ChildEnd::kCancelled);
  EXPECT_THROW(run_in_child("f", work, {}, watch), CancelledError);
}

TEST(Bridge, CancellingStopsTheChild) {
  const Watch watch;
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    watch.cancel.cancel();
  });
  const auto start = std::chrono::steady_clock::now();
  const auto result = run_child(
      []() -> std::string {
        burn();
        return "";
      },
      {}, watch);
  later.join();
  EXPECT_EQ(result.end, ChildEnd::kCancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_FALSE(has_children());
}

TEST(Bridge, TheChildIsSilent) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  run_in_child("f", [] {
    std::cout << "noise" << std::endl;
    std::fprintf(stderr, "noise");
    std::fflush(nullptr);
    return std::string();
  });
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Bridge, NothingIsLeftBehind) {
  const int before = open_descriptors();
  for (int k = 0; k < 20; ++k) {
    run_child([] { return std::string("x"); });
    run_child([]() -> std::string { _exit(1); });
  }
  EXPECT_EQ(open_descriptors(), before);
  EXPECT_FALSE(has_children());
}

TEST(Bridge, ManyThreadsMayStartChildren) {
  if (kSanitized) GTEST_SKIP() << "sanitizers do not release their own locks in a forked child";
  std::atomic<int> good{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&good, t] {
      for (int k = 0; k < 5; ++k) {
        const std::string text(static_cast<size_t>(100000 + t), static_cast<char>('a' + k));
        if (run_in_child("f", [&] { return text; }) == text) ++good;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(good, 20);
}

TEST(Bridge, InterruptedWaitsGoOn) {
  struct sigaction action {};
  struct sigaction old {};
  action.sa_handler = [](int) {};
  sigaction(SIGUSR1, &action, &old);
  const pthread_t self = pthread_self();
  std::atomic<bool> stop{false};
  std::thread pest([&] {
    while (!stop) {
      pthread_kill(self, SIGUSR1);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const auto result = run_child([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return std::string(1 << 20, 'x');
  });
  stop = true;
  pest.join();
  sigaction(SIGUSR1, &old, nullptr);
  EXPECT_EQ(result.end, ChildEnd::kFinished);
  EXPECT_EQ(result.bytes.size(), size_t{1} << 20);
}

TEST(Bridge, LimitsMustBePositive) {
  EXPECT_THROW(run_child([] { return std::string(); }, seconds(0)), PreconditionError);
}

}  // namespace
}  // namespace isochor
