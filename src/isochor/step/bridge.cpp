#include "isochor/step/bridge.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <mutex>
#include <new>
#include <system_error>

#include "isochor/base/error.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/occt_wall.h"

namespace isochor {
namespace {

using internal::ByteReader;
using internal::ByteWriter;
using Clock = std::chrono::steady_clock;

// Elapsed seconds allowed per second of processor time, and on top of it: other programs share the
// machine, and a short limit must still leave time to start.
constexpr double kElapsedFactor = 4.0;
constexpr double kElapsedExtra = 5.0;
constexpr int kPollMilliseconds = 20;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;
#else
constexpr bool kLimitMemory = true;
#endif

// What the child says: progress, and one of the others before it ends; a child that does not, died.
enum class Message : unsigned char {
  kProgress,
  kResult,
  kInputError,
  kError,
  kOutOfMemory,
  kSignal
};

void set_limit(int resource, rlim_t soft, rlim_t hard) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
  limit.rlim_cur = std::min(soft, limit.rlim_max);
  limit.rlim_max = std::min(hard, limit.rlim_max);
  setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
}

void apply_limits(const BridgeLimits& limits) {
  set_limit(RLIMIT_CORE, 0, 0);
  const auto seconds = static_cast<rlim_t>(std::max(1.0, std::ceil(limits.seconds)));
  set_limit(RLIMIT_CPU, seconds, seconds + 2);
  if (kLimitMemory) {
    const auto bytes = static_cast<rlim_t>(limits.megabytes * 1024.0 * 1024.0);
    set_limit(RLIMIT_AS, bytes, bytes);
  }
}

void silence_streams() {
  const int nowhere = open("/dev/null", O_RDWR);
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  if (nowhere > STDERR_FILENO) close(nowhere);
}

void write_all(int descriptor, const std::string& bytes) {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // the parent is gone: nobody to tell
    done += static_cast<size_t>(n);
  }
}

std::string message(Message kind, const std::string& a, const std::string& b = {},
                    const std::string& c = {}) {
  ByteWriter out;
  out(kind, a, b, c);
  return out.take();
}

// Messages follow each other in the pipe, each after its size.
void send(int out, const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  write_all(out, std::string(reinterpret_cast<const char*>(&size), sizeof size));
  write_all(out, bytes);
}

// What a child says when memory runs out, made while there is some, and where.
struct LastWords {
  int out = -1;
  double megabytes = 0.0;
  std::string frame;
};
LastWords& last_words() {
  static LastWords of_this_process;
  return of_this_process;
}

// OpenCASCADE takes a failed allocation for many things: an abort, a file that cannot be parsed, a
// face less. So whatever goes wrong this close to the limit is put down to the limit.
constexpr double kNearLimit = 0.7;

// Safe in signal handlers: no allocation.
bool near_memory_limit() {
  if (!kLimitMemory) return false;
  char text[4096];
  const int status = open("/proc/self/status", O_RDONLY);
  if (status < 0) return false;
  const ssize_t size = read(status, text, sizeof text - 1);
  close(status);
  if (size <= 0) return false;
  text[size] = '\0';
  const char* peak = strstr(text, "VmPeak:");
  if (peak == nullptr) return false;
  double kilobytes = 0.0;
  for (const char* c = peak + 7; *c != '\0' && *c != '\n'; ++c) {
    if (*c >= '0' && *c <= '9') kilobytes = 10.0 * kilobytes + (*c - '0');
  }
  return kilobytes > kNearLimit * 1024.0 * last_words().megabytes;
}

[[noreturn]] void say_out_of_memory() {
  write_all(last_words().out, last_words().frame);
  _exit(0);
}

void on_abort(int /*signal*/) {
  if (near_memory_limit()) say_out_of_memory();
  std::signal(SIGABRT, SIG_DFL);
  std::raise(SIGABRT);
}

void prepare_last_words(int out, const BridgeLimits& limits) {
  const std::string text = message(Message::kOutOfMemory, "");
  const std::uint64_t size = text.size();
  last_words() = {out, limits.megabytes,
                  std::string(reinterpret_cast<const char*>(&size), sizeof size) + text};
  std::set_new_handler(say_out_of_memory);
  std::signal(SIGABRT, on_abort);
}

// Runs the work behind OpenCASCADE's wall and turns every end into a message.
std::string ended(const std::function<std::string()>& work) {
  try {
    const auto fault = internal::behind_occt_wall(work);
    switch (fault.kind) {
      case internal::OcctFault::kNone:
        return message(Message::kResult, fault.text);
      case internal::OcctFault::kOutOfMemory:
        return message(Message::kOutOfMemory, fault.text);
      case internal::OcctFault::kSignal:
        return message(Message::kSignal, fault.text);
      case internal::OcctFault::kFailure:
        return message(Message::kError, fault.text);
    }
    return message(Message::kError, "unknown end");
  } catch (const InputError& e) {
    return message(Message::kInputError, e.file(), e.entity(), e.reason());
  } catch (const std::bad_alloc&) {
    return message(Message::kOutOfMemory, "");
  } catch (const std::exception& e) {
    return message(Message::kError, e.what());
  } catch (...) {
    return message(Message::kError, "an exception of unknown type");
  }
}

// Keys pressed at a terminal reach the whole group; the parent decides what they mean. Blocked, not
// ignored, because OpenCASCADE sets handlers of its own.
void leave_cancelling_to_parent() {
  sigset_t signals;
  sigemptyset(&signals);
  for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
}

std::string guarded(const std::function<std::string()>& work) {
  std::string end = ended(work);
  const auto kind = static_cast<Message>(end.front());
  if (kind != Message::kResult && near_memory_limit()) return message(Message::kOutOfMemory, "");
  return end;
}

[[noreturn]] void be_child(int out, const std::function<std::string()>& work,
                           const BridgeLimits& limits, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent died before the line above
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXCPU, SIG_DFL);
  leave_cancelling_to_parent();
  silence_streams();
  prepare_last_words(out, limits);
  apply_limits(limits);
  internal::set_progress_sink([out](double fraction, std::string_view step) {
    ByteWriter message;
    message(Message::kProgress, fraction, std::string(step));
    send(out, message.take());
  });
  send(out, guarded(work));
  // No exit handlers and no flushing: buffered output belongs to the parent.
  _exit(0);
}

// The running child and the reading end of its pipe; killed and reaped when it goes out of scope.
class Child {
 public:
  Child(const std::function<std::string()>& work, const BridgeLimits& limits) {
    // Other threads must not fork while the writing end is open here, or their children would hold
    // it and this pipe would never end.
    static std::mutex starting;
    std::unique_lock<std::mutex> lock(starting);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw std::system_error(errno, std::generic_category(), "pipe");
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) {
      lock.unlock();
      close(ends[0]);
      be_child(ends[1], work, limits, parent);
    }
    const int fault = errno;
    close(ends[1]);
    in_ = ends[0];
    if (pid_ < 0) {
      close(in_);
      throw std::system_error(fault, std::generic_category(), "fork");
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) {
      kill();
      reap();
    }
    close(in_);
  }

  void kill() const { ::kill(pid_, SIGKILL); }

  // Waits up to `milliseconds` for bytes; false at the end of the pipe.
  bool receive(std::string& bytes, int milliseconds) const {
    pollfd waiting{in_, POLLIN, 0};
    const int ready = poll(&waiting, 1, milliseconds);
    if (ready <= 0) return true;
    char buffer[1 << 16];
    const ssize_t n = read(in_, buffer, sizeof buffer);
    if (n < 0) return errno == EINTR || errno == EAGAIN;
    bytes.append(buffer, static_cast<size_t>(n));
    return n > 0;
  }

  // The wait status; fills the processor time used.
  int reap(double* seconds = nullptr) {
    int status = 0;
    rusage usage{};
    while (wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    const auto value = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    if (seconds) *seconds = value(usage.ru_utime) + value(usage.ru_stime);
    return status;
  }

 private:
  pid_t pid_ = -1;
  int in_ = -1;
};

// Takes the first whole message off `bytes`; false when there is none yet.
bool take_message(std::string& bytes, std::string& message) {
  std::uint64_t size = 0;
  if (bytes.size() < sizeof size) return false;
  std::memcpy(&size, bytes.data(), sizeof size);
  if (bytes.size() - sizeof size < size) return false;
  message = bytes.substr(sizeof size, size);
  bytes.erase(0, sizeof size + size);
  return true;
}

// Passes progress on; true when `message` is the last word of the child instead.
bool is_last_word(const std::string& message, const Watch& watch) {
  ByteReader in(message);
  auto kind = Message::kError;
  in(kind);
  if (kind != Message::kProgress) return true;
  double fraction = 0.0;
  std::string step;
  in(fraction, step);
  if (watch.progress) watch.progress(fraction, step);
  return false;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

ChildResult out_of_memory(const BridgeLimits& limits) {
  ChildResult result;
  result.end = ChildEnd::kOutOfMemory;
  result.reason = "needs more memory than the " + number(limits.megabytes) + " MB allowed";
  return result;
}

ChildResult timed_out(const BridgeLimits& limits) {
  ChildResult result;
  result.end = ChildEnd::kTimedOut;
  result.reason = "took longer than the " + number(limits.seconds) + " s allowed";
  return result;
}

ChildResult died(int signal, const std::string& how) {
  ChildResult result;
  result.end = ChildEnd::kDied;
  result.signal = signal;
  result.reason = "the CAD library crashed on it (" + how + "); the file is probably damaged";
  return result;
}

ChildResult cancelled() {
  ChildResult result;
  result.end = ChildEnd::kCancelled;
  result.reason = "cancelled";
  return result;
}

ChildResult interpret(std::string bytes, const BridgeLimits& limits) {
  ByteReader in(std::move(bytes));
  auto kind = Message::kError;
  std::string a, b, c;
  in(kind, a, b, c);
  ChildResult result;
  switch (kind) {
    case Message::kResult:
      result.end = ChildEnd::kFinished;
      result.bytes = std::move(a);
      return result;
    case Message::kInputError:
      result.file = std::move(a);
      result.entity = std::move(b);
      result.reason = std::move(c);
      return result;
    case Message::kOutOfMemory:
      return out_of_memory(limits);
    case Message::kSignal:
      return died(SIGSEGV, a);
    case Message::kError:
    case Message::kProgress:  // is no last word
      break;
  }
  result.reason = std::move(a);
  return result;
}

}  // namespace

ChildResult run_child(const std::function<std::string()>& work, const BridgeLimits& limits,
                      const Watch& watch) {
  ISOCHOR_REQUIRE(limits.seconds > 0.0 && limits.megabytes > 0.0, limits.seconds, limits.megabytes);
  if (watch.cancel.cancelled()) return cancelled();
  const auto start = Clock::now();
  const double elapsed_limit = kElapsedFactor * limits.seconds + kElapsedExtra;
  Child child(work, limits);
  std::string bytes, message;
  try {
    for (bool open = true; open;) {
      open = child.receive(bytes, kPollMilliseconds);
      while (take_message(bytes, message)) {
        if (is_last_word(message, watch)) return interpret(std::move(message), limits);
      }
      if (watch.cancel.cancelled()) return cancelled();
      const std::chrono::duration<double> elapsed = Clock::now() - start;
      if (elapsed.count() > elapsed_limit) return timed_out(limits);
    }
  } catch (const internal::BytesError&) {
    return died(0, "what it said makes no sense");
  }

  double seconds = 0.0;
  const int status = child.reap(&seconds);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || (signal == SIGKILL && seconds >= limits.seconds)) {
    return timed_out(limits);
  }
  if (signal == SIGKILL) return out_of_memory(limits);  // the kernel's last resort
  if (signal != 0) return died(signal, strsignal(signal));
  return died(0, "it ended without a result");
}

std::string run_in_child(const std::string& file, const std::function<std::string()>& work,
                         const BridgeLimits& limits, const Watch& watch) {
  auto result = run_child(work, limits, watch);
  switch (result.end) {
    case ChildEnd::kFinished:
      return std::move(result.bytes);
    case ChildEnd::kCancelled:
      throw CancelledError();
    case ChildEnd::kTimedOut:
      throw LimitError(LimitError::Limit::kTime, file, result.reason);
    case ChildEnd::kOutOfMemory:
      throw LimitError(LimitError::Limit::kMemory, file, result.reason);
    case ChildEnd::kDied:
    case ChildEnd::kFailed:
      break;
  }
  throw InputError(result.file.empty() ? file : result.file, result.entity, result.reason);
}

}  // namespace isochor
