// What the program prints: results to stdout, everything else to stderr.
#pragma once

#include <cstdarg>
#include <string>

#include "commands.h"
#include "isochor/io/value.h"

namespace isochor::app {

// A line of the result; nothing with --json or --quiet.
void print(const Common& common, const std::string& line);
// The result as JSON when --json asks for it.
void print_json(const Common& common, const Value& value);
// Why the answer is no, on stderr, also with --quiet.
void refuse(const std::string& line);
// A remark on stderr; nothing with --quiet.
void note(const Common& common, const std::string& line);
// A remark only for --verbose.
void detail(const Common& common, const std::string& line);

// printf into a string.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

}  // namespace isochor::app
