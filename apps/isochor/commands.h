// The commands of the program. Each takes its parsed options and returns an exit code:
// 0 done; 1 an honest no; 2 usage; 3 bad input (thrown as InputError); 4 our bug; 130 cancelled.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isochor/base/progress.h"

namespace isochor::app {

enum ExitCode {
  kExitDone = 0,
  kExitNo = 1,
  kExitUsage = 2,
  kExitInput = 3,
  kExitBug = 4,
  kExitCancelled = 130
};

// Options that every command has.
struct Common {
  bool json = false;  // one JSON value on stdout, nothing else there
  bool quiet = false;
  bool verbose = false;
  int threads = 1;  // at most; no result depends on it
  std::string progress = "auto";
  double bridge_seconds = 300.0;  // limits of the child process that reads and writes CAD files
  double bridge_megabytes = 8192.0;
  CancelToken cancel;  // raised by Ctrl-C
};

struct InfoOptions {
  std::string model;
  std::vector<std::string> close;  // planes that close the model, as written
};
int run_info(const InfoOptions& options, const Common& common);

struct VolumeOptions {
  std::string model;
  bool exact = false;
  bool open = false;
  bool moments = false;
  std::vector<double> section;  // NX,NY,NZ,H, or empty
  std::string below;            // a plane as --close has them, or empty
  std::string gradient;         // file to write
  std::vector<std::string> close;
};
int run_volume(const VolumeOptions& options, const Common& common);

struct SuggestOptions {
  std::string model;
  std::string output;
  std::vector<std::string> close;
};
int run_suggest(const SuggestOptions& options, const Common& common);

struct EditOptions {
  std::string model, edits, output, report, picture, html;
  std::vector<std::string> close;
};
int run_edit(const EditOptions& options, const Common& common);

struct CheckOptions {
  std::string model, against, picture;
  bool self_intersections = false;
  std::vector<std::string> close;
};
int run_check(const CheckOptions& options, const Common& common);

struct ConvertOptions {
  std::string input, output;
  bool rewrite = false;  // STEP to STEP: written anew by OpenCASCADE instead of copied
};
int run_convert(const ConvertOptions& options, const Common& common);

struct RenderOptions {
  std::string model, output, compare;
};
int run_render(const RenderOptions& options, const Common& common);

struct SolveOptions {
  std::string problem, output;
};
int run_solve(const SolveOptions& options, const Common& common);

}  // namespace isochor::app
