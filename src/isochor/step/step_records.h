// The records of a STEP file (ISO 10303-21) in the form in which OpenCASCADE's reader wants them:
// one record for each entity, each part of a complex entity and each list inside, with its
// arguments as text. Internal to `step`; no OpenCASCADE.
//
// OpenCASCADE's own scanner takes half of the time of reading; this one takes a tenth of that. It
// accepts only what both surely understand alike and declines everything else, which includes every
// file that breaks the grammar: those are for OpenCASCADE's scanner and its rules of recovery.
//
// Law: what is accepted becomes the same model as with OpenCASCADE's scanner (tests
// StepRecords.*; all real files).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/step/part21.h"

namespace isochor::internal {

struct StepArgument {
  Part21Kind kind = Part21Kind::kOmitted;  // lists are kList, typed values too
  TextSpan text;                           // empty for a list
  std::uint32_t list = 0;                  // the how many-th list of its record, from 1
};

struct StepRecord {
  TextSpan ident;           // "#12"; empty for lists, the header and further parts of one entity
  TextSpan type;            // the keyword; empty: a list without one
  std::uint32_t list = 0;   // not 0: a list inside a record, which follows
  std::uint32_t first = 0;  // its arguments
  std::uint32_t count = 0;
};

struct StepRecords {
  std::vector<StepRecord> records;  // those of the header first
  std::vector<StepArgument> arguments;
  std::uint32_t header = 0;  // records of the header
  std::uint32_t lists = 0;   // the most lists inside one record
};

// The records of the file whose ISO-10303-21 stands at `start`; nothing when it is declined.
// O(n) in the bytes; the stack does not grow with the input.
std::optional<StepRecords> scan_step(const std::string& text, size_t start);

}  // namespace isochor::internal
