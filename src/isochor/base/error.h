// The three error channels.
//
//  (1) The caller's bug: ISOCHOR_REQUIRE throws PreconditionError. Always on, never an abort.
//  (2) Bad outside data: InputError names the file, the entity, the value and the reason.
//  (3) Mathematical outcomes (infeasible, refused, ...) are values, see outcome.h, not exceptions.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace isochor {

// A broken promise of the calling code.
class PreconditionError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

// Data from outside that cannot be used. what() reads "file: entity: reason"; parts may be empty.
// Inner layers, which do not know the file, leave it empty; readers add it with `in_file`.
class InputError : public std::runtime_error {
 public:
  // `entity` says where in the file (a JSON path, a face, an entity number);
  // `reason` says what is wrong and contains the offending value.
  InputError(std::string file, std::string entity, std::string reason);

  const std::string& file() const { return file_; }
  const std::string& entity() const { return entity_; }
  const std::string& reason() const { return reason_; }

  // The same error with the file name filled in where it was empty.
  InputError in_file(const std::string& file) const;

 private:
  std::string file_;
  std::string entity_;
  std::string reason_;
};

// Outside data that would take more time or memory than the caller allows: not wrong in itself, and
// a larger limit may do.
class LimitError : public InputError {
 public:
  enum class Limit { kTime, kMemory };
  LimitError(Limit limit, const std::string& file, const std::string& reason)
      : InputError(file, "", reason), limit_(limit) {}
  Limit limit() const { return limit_; }

 private:
  Limit limit_;
};

// Work that the user ended before it had a result. Whoever started it asked for that, so this is no
// error; functions that can report it as an outcome do so instead.
class CancelledError : public std::runtime_error {
 public:
  CancelledError() : std::runtime_error("cancelled") {}
};

namespace internal {

[[noreturn]] void throw_precondition(const char* condition, const char* file, int line,
                                     const std::string& values);

template <typename... Values>
std::string join_values(const Values&... values) {
  std::ostringstream out;
  out.precision(17);
  ((out << values << ' '), ...);
  return out.str();
}

}  // namespace internal
}  // namespace isochor

// ISOCHOR_REQUIRE(condition, values...): throws PreconditionError with the printed values.
#define ISOCHOR_REQUIRE(condition, ...)                                                       \
  do {                                                                                        \
    if (!(condition)) {                                                                       \
      ::isochor::internal::throw_precondition(#condition, __FILE__, __LINE__,                 \
                                              ::isochor::internal::join_values(__VA_ARGS__)); \
    }                                                                                         \
  } while (false)
