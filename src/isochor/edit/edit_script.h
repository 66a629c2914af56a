// Edits as data: what a user asks for, independent of any model and of any file format.
//
// One Edit is one row of the "edits" list of CONTRACT's `isochor_edits` file; the field names and
// their defaults are the same there. An EditScript can be replayed on any model in which its names
// resolve.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/volume/flux_field.h"

namespace isochor {

// A place on a model, as users write it.
struct Place {
  enum class Kind {
    kSurface,      // patch and parameters
    kNear,         // the closest point of the surface
    kCoefficient,  // coefficient (i, j) of the chosen scale
  };
  Kind kind = Kind::kSurface;
  std::string patch;        // kSurface, kCoefficient
  Uv uv;                    // kSurface
  bool normalised = false;  // kSurface: uv in [0, 1] x [0, 1] ("uv01")
  Vec3 near = Vec3::Zero();
  int i = 0, j = 0;
};

// Move a place by a displacement, or to a position.
struct Move {
  Place place;
  bool relative = true;  // true: `vector` is a displacement ("by"); false: a position ("to")
  Vec3 vector = Vec3::Zero();
  std::vector<Vec3> drag;  // intermediate values of `vector`, for sessions that follow a path
};

struct Hold {
  enum class Kind {
    kPlace,     // the point stays
    kNormal,    // the tangent plane's direction at a surface point stays, the point may move
    kEdge,      // the curve that two patches share stays
    kSymmetry,  // mirror images stay mirror images
    kPlane,     // control points that lie in a plane stay in it
  };
  Kind kind = Kind::kPlace;
  Place place;                      // kPlace, kNormal
  std::array<std::string, 2> edge;  // the two patches that share it
  int axis = 0;                     // kSymmetry: the plane x = 0, y = 0 or z = 0
  Vec3 plane_point = Vec3::Zero();
  Vec3 plane_normal = Vec3::UnitZ();  // of any length but zero
};

// Which interior knots the displacement keeps: the coarser, the larger the details that survive.
struct Scale {
  enum class Kind { kFinest, kEvery, kKnots };
  Kind kind = Kind::kFinest;
  int every = 1;
  std::map<std::string, std::array<std::vector<double>, 2>> knots;  // by patch: kept in u, in v
};

// Exact knot insertion before the edit.
struct Refine {
  enum class Kind { kNone, kSpans, kLength, kAuto };  // kAuto: around the moved points
  Kind kind = Kind::kNone;
  std::array<int, 2> spans{};  // at least this many along u and v
  double length = 0.0;         // no span longer than this (length unit)
};

// Which coefficients may change.
struct Extent {
  enum class Kind { kRings, kRadius, kLoop, kPoints, kPoles, kBox, kFaces, kAll };
  Kind kind = Kind::kRings;
  int rings = 4;
  double radius = 0.0;
  std::string patch;                                              // kLoop, kBox
  std::vector<Uv> loop;                                           // kLoop
  std::vector<int> points;                                        // kPoints: ids of the point table
  std::map<std::string, std::vector<std::pair<int, int>>> poles;  // kPoles
  std::array<double, 2> u{}, v{};                                 // kBox
  std::vector<std::string> faces;                                 // kFaces
};

struct VolumeGoal {
  enum class Kind { kKeep, kFree, kTarget, kFactor, kChange };
  Kind kind = Kind::kKeep;
  double value = 0.0;
};

// Where the volume correction goes.
struct Sink {
  enum class Kind { kExtent, kOtherExtent, kDirection };
  Kind kind = Kind::kExtent;
  Extent extent;
  Vec3 direction = Vec3::Zero();
};

enum class Method { kIsotropic, kAxis, kTaylor };
enum class Continuity {
  kMeasured,  // what each join has, up to curvature
  kTangent,   // of that, tangents only
  kC0,        // positions only
};

// What to keep at the joins of two patches (or of one with itself), instead of the edit's default.
struct EdgeContinuity {
  std::array<std::string, 2> edge;
  Continuity keep = Continuity::kMeasured;
};

// Faces that follow where the edit moves a trimming curve that they share with other faces: they
// are refined and refitted along it.
struct Follow {
  std::vector<std::string> faces;  // empty: trimming curves do not move
  double tolerance = 0.0;          // how far the faces may part there (length unit)
  bool any() const { return !faces.empty(); }
};

struct Edit {
  std::string name;
  Scale scale;
  Refine refine;
  Extent extent;
  std::vector<Move> moves;
  std::vector<Hold> holds;
  Continuity continuity = Continuity::kMeasured;
  std::vector<EdgeContinuity> edge_continuity;
  Follow follow;
  VolumeGoal volume;
  Method method = Method::kIsotropic;
  std::array<int, 3> axis_order = {0, 1, 2};  // kAxis
  bool open = false;                // treat the integral of z dx dy of an open model as its volume
  std::vector<ClosingPlane> close;  // as the script's; all edits of a session share theirs
  Sink sink;
};

struct EditScript {
  std::vector<Edit> edits;
  std::vector<ClosingPlane> close = {};  // planes that close the model
};

// The planes that a script and its edits name. InputError when two edits name different ones: what
// "keep" means would change on the way.
std::vector<ClosingPlane> closing_planes(const EditScript& script);

// The words of CONTRACT: "isotropic", "axis", "taylor".
const char* name_of(Method method);
const char* name_of(Continuity continuity);  // "measured", "G1", "C0"

}  // namespace isochor
