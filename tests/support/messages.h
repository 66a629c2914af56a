// What an action says when it fails, so that tests can look at the words.
#pragma once

#include <string>

namespace isochor::testing {

// The message of the `Error` that the action throws, "no error" when it throws nothing.
template <typename Error, typename Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace isochor::testing
