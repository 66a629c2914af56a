// What became of a file on its way in: what it states, what OpenCASCADE made of that, and what it
// repaired. No OpenCASCADE types here.
//
// OpenCASCADE leaves out what it cannot read, and repairs without asking; the shape it returns is
// valid all the same. So the text of a STEP file is read a second time, by our own reader, and the
// faces that it states are looked for, one by one, among those that came back.
//
// Laws:
//  (1) a file is complete only when its text keeps the rules of the format, each reference leads
//      somewhere, and every face that its shapes state came back;
//  (2) the same file gives the same account.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace isochor {

struct ShapeCounts {
  int solids = 0, shells = 0, faces = 0;  // each once, however often an assembly uses it
};

// What sewing made of loose faces and open shells. Faces by their numbers before it: "face:7".
struct SewingAccount {
  bool done = false;       // false: the file's own shape stayed
  std::string declined;    // why, in words, where edges run together and were not joined
  double tolerance = 0.0;  // in the file's unit
  int faces = 0, shells = 0, solids = 0;  // afterwards
  int free_edges_before = 0, free_edges_after = 0;
  std::vector<std::string> dropped;  // without area
  std::vector<std::string> turned;   // turned round

  // What happened, a line each; empty when there was nothing to sew.
  std::vector<std::string> lines() const;
};

struct ImportAccount {
  bool has_text = false;  // the rest of the text's account is known: STEP files only
  int entities = 0;
  int error_entities = 0;  // those that OpenCASCADE thinks break the rules; common in good files
  int roots = 0;           // separate shapes
  int junk_bytes = 0;      // before the header
  ShapeCounts stated, read;
  std::vector<std::string> broken;  // where the text breaks the rules: "line 12: ..."
  std::vector<std::string> lost;  // "#123 (line 45, ADVANCED_FACE)": stated faces that are missing
  std::vector<std::string> unused;   // faces in the text that no shape uses, named alike
  int added_faces = 0;               // faces that no entity of the text states
  std::vector<std::string> no_area;  // faces without area: "face:7"
  std::vector<std::pair<std::string, int>> repairs;   // messages of OpenCASCADE, with their number
  std::vector<std::pair<std::string, int>> failures;  // what it says it could not read
  SewingAccount sewing;

  bool complete() const { return broken.empty() && lost.empty(); }
  // Why a file is not complete, in words, or empty.
  std::string objection() const;
};

}  // namespace isochor
