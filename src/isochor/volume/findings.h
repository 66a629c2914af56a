// What is wrong, or worth a look, with a model: a list that people and programs can work off.
//
// A *subject* says what was measured, whatever file it came from: edges with points along them,
// faces, tolerances, volume. Findings are judged from it with limits that are stated beside the
// numbers. Lengths are in the model's unit, angles in degrees, because designers think in them.
//
// Laws (tests of those names in tests/volume/findings_test.cpp):
//  (1) a sound model has no fault;
//  (2) every finding of a measured quantity has value and limit, and the value is beyond the limit;
//  (3) the histogram counts each edge between two faces once.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

inline constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

struct CheckedEdge {
  std::string label;         // "the edge of face:3 and face:7"
  std::vector<Vec3> points;  // along it; may be empty
  int uses = 2;              // by how many faces; a seam counts twice
  bool measured = false;     // angle and smoothness are known
  double length = 0.0, gap = 0.0, tolerance = 0.0;
  double angle_deg = 0.0;  // largest between the normals along it
  Smoothness smoothness = Smoothness::kSharp;
  std::string entity;      // "#123", its number in a STEP file; may be empty
  std::vector<int> faces;  // indices into CheckedModel::faces; may be empty
};

struct CheckedFace {
  std::string label;  // "face:3 (\"top\")"
  double area = 0.0, perimeter = 0.0, tolerance = 0.0;
  std::string entity;  // as for edges
};

// Two faces that cut through each other; the same twice: one that cuts through itself.
struct CheckedCrossing {
  int face_a = 0, face_b = 0;  // indices into CheckedModel::faces
  Vec3 at = Vec3::Zero();
  double depth = 0.0, limit = 0.0;  // they reach through each other by more than `limit`
  bool one_body = true;             // false: of two solids, which may be meant to overlap
};

struct CheckedModel {
  std::string unit;
  std::vector<CheckedEdge> edges;
  std::vector<CheckedFace> faces;
  std::vector<std::string> defects;  // of topology, in words
  bool closed = false;               // also by planes
  std::string why_open;
  double volume = 0.0;  // meaningful when closed
  double volume_bound = 0.0;
  std::vector<std::string> import_faults;    // what the reader lost or could not understand
  std::vector<std::string> import_warnings;  // what it joined, or could have
  double diagonal = 0.0;
  std::vector<CheckedCrossing> crossings;
};

// A model of patches alone; its joins are the edges between them.
CheckedModel checked(const PatchModel& model);

enum class Severity {
  kNote,     // as designed, perhaps: an almost smooth edge
  kWarning,  // other programs may stumble over it
  kFault,    // not a usable body
};
const char* name_of(Severity severity);  // "note", "warning", "fault"

struct Finding {
  std::string kind;  // "free edge", "gap", ...; the words of docs/check.md
  Severity severity = Severity::kFault;
  std::string place;                   // "the edge of face:3", or empty: the whole model
  std::optional<Vec3> at;              // a point there
  std::optional<double> value, limit;  // what was measured, and what it should not pass
  std::string text;                    // one line for people
  int edge = -1;                       // index into CheckedModel::edges
  // Numbers in the STEP file, "#123": of the edge or face itself, and of the faces of an edge.
  std::string entity;
  std::vector<std::string> face_entities;
};

// Faults first, then by how far values are beyond their limits.
std::vector<Finding> findings_of(const CheckedModel& model);

// Edges between two faces by the angle between their normals, in degrees.
struct AngleBin {
  double from = 0.0, to = 0.0;  // from <= angle < to
  int edges = 0;
};
std::vector<AngleBin> angle_histogram(const CheckedModel& model);

}  // namespace isochor
