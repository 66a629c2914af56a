// PatchModel: what a closed shape is to Isochor.
//
// A table of control points and patches that index it. Two patches are joined where they use the
// same points (`.isochor.json`), or where `ties` say that two points move together (a B-rep, whose
// faces have poles of their own that agree only within a tolerance). Every edit is a displacement
// of the points; tied points get the same displacement, so existing gaps stay bit for bit.
//
// Grid indices are u-major: patch.points[i * #v + j], i along u, j along v.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/surface.h"
#include "isochor/exact/rational.h"

namespace isochor {

// A rectangle of parameters, closed.
struct UvBox {
  double u_min = 0.0, u_max = 0.0, v_min = 0.0, v_max = 0.0;
};

// The part of a patch that a trimmed face keeps. Empty: the whole patch.
struct TrimRegion {
  std::vector<UvBox> boundary;         // small boxes that together cover every trimming curve;
                                       // edges that run along a whole natural side are left out
  std::vector<std::vector<Uv>> loops;  // closed polylines of all loops, for the inside test:
                                       // inside = odd number of crossings
  bool empty() const { return loops.empty() && boundary.empty(); }
};

// One tensor-product patch of a model.
struct Patch {
  std::string name;    // as users write it; may be empty or shared by several patches
  std::string handle;  // "face:12", unique in the model
  KnotVector u_knots, v_knots;
  std::vector<int> points;           // #u x #v, indices into PatchModel::points
  std::vector<double> weights;       // #u x #v, or empty; constant during edits
  bool reversed = false;             // true: the outward normal is -(S_u x S_v)
  std::vector<std::string> aliases;  // further names: "#1234", "wing/face:3"
  TrimRegion trim;

  int u_size() const { return u_knots.size(); }
  int v_size() const { return v_knots.size(); }
  int point(int i, int j) const { return points[static_cast<size_t>(i) * v_size() + j]; }
  double sign() const { return reversed ? -1.0 : 1.0; }
};

// One side of one patch.
struct SideRef {
  int patch = 0;
  Side side = Side::kUBegin;
  friend bool operator==(const SideRef& a, const SideRef& b) {
    return a.patch == b.patch && a.side == b.side;
  }
};

// How smoothly two sides (or the two sides of a knot line) meet, as measured. Ordered.
enum class Smoothness {
  kSharp,      // positions only
  kAlmost,     // normals within kAlmostSmoothAngle: neither sharp nor smooth, kept as it is
  kTangent,    // normals within kSmoothAngle (G1)
  kCurvature,  // and normal curvatures agree (G2)
};
const char* name_of(Smoothness smoothness);  // "C0", "almost G1", "G1", "G2"

// A part of a side: the interval of its running parameter, from < to; equal: the whole side.
struct SidePart {
  double from = 0.0, to = 0.0;
  bool whole() const { return from == to; }
  friend bool operator==(const SidePart& a, const SidePart& b) {
    return a.from == b.from && a.to == b.to;
  }
};

// Two sides, or parts of them, that carry the same curve (both sides may belong to one patch: a
// seam).
struct Join {
  SideRef a, b;
  SidePart part_a = {}, part_b = {};
  bool opposed = false;   // the running parameters go in opposite directions
  bool matching = false;  // same degree, knots and weights along the curve: poles tie one to one
  std::string mismatch;   // when not matching: why, in words
  // Not matching, but the same curve once both are written in a common basis (common_basis.h): then
  // an equation for each coefficient there keeps the two together.
  bool common = false;
  double max_gap = 0.0;             // length unit
  double max_angle_rad = 0.0;       // between the normals
  double max_curvature_jump = 0.0;  // 1 / length unit
  Smoothness smoothness = Smoothness::kSharp;
};

// Smoothness that linear equations on displacements keep (smooth_relations.h, where the symbols
// are).
//
// One coefficient of an equation across a line: of pole row `row` (counted in the patch's across
// direction) of one of the two strips.
struct LineTerm {
  int strip = 0;  // 0: the first, 1: the second
  int row = 0;
  Rational value;
};
using LineEquation = std::vector<LineTerm>;

struct SmoothRelation {
  // kTie: not smoothness, but what it rests on: the sides of a join in different bases stay
  // together.
  enum class Kind { kJoin, kKnotLine, kWrap, kPole, kTie };
  Kind kind = Kind::kJoin;
  int join = -1;   // kJoin, kWrap, kTie: index into model.joins
  int patch = -1;  // kKnotLine, kWrap: the patch; the line is `across` = knot
  Direction across = Direction::kU;
  double knot = 0.0;
  std::vector<SideRef> sides;  // kJoin, kTie: its two sides; kPole: all collapsed sides at the pole
  int order = 1;  // 0: positions (kTie), 1: tangents, 2: curvature too (seams: as protected_order)
  Rational lambda = Rational(1), mu;
  double residual = 0.0;  // of the worse of the relations, as a part of its terms
  std::string text;       // "face:3 and face:4 meet smoothly (G1)"

  // For each order that the basis does not keep by itself, ascending: one equation for all j when
  // the weights separate into a product near the line (always without weights), else one for each j
  // along the first strip. Empty for poles.
  std::vector<std::vector<LineEquation>> equations;
};

// A side whose neighbour is not part of the model (a face that is not edited).
struct LockedSide {
  SideRef side;
  std::string reason;  // "shares an edge with face:5 (plane), which is not edited"
  Smoothness smoothness = Smoothness::kSharp;  // towards that neighbour
  SidePart part = {};                          // where; the rest of the side stays free
};

// An edge between two patches that is a trimming curve of one of them or of both. Either locks what
// shapes it, unless the trim is released for that patch: then an edit may move it, and must make
// the other patch follow (edit/follow.h). Readers fill these when asked.
struct SharedTrim {
  std::array<int, 2> patches{};              // not the same
  std::array<std::vector<Uv>, 2> along;      // pairs of places of one point of the edge
  std::array<std::pair<int, int>, 2> boxes;  // of trim.boundary of each, [first, second)
  std::array<int, 2> locked_sides{-1, -1};   // where it runs along a side: index, or -1
  std::vector<int> corners;                  // indices of the fixed points at its ends, where no
                                             // other patch ends
  Smoothness smoothness = Smoothness::kSharp;
  std::array<bool, 2> released{};
};

// A point that must not move (all axes), and why, in words a designer understands.
struct Lock {
  int point = 0;
  int reason = 0;  // index into PatchModel::lock_reasons
};

struct LockReason {
  std::string text;
  // True: only there to keep tangents or curvature ("continuity": "C0" lifts it).
  bool continuity = false;
  int join = -1;  // the join that it keeps so; -1: a knot line, a pole, a neighbour
};

struct PatchModel {
  std::string unit = "m";
  std::vector<Vec3> points;
  std::vector<Patch> patches;
  std::vector<std::pair<int, int>> ties;  // pairs of points that share one displacement
  std::vector<Join> joins;
  std::vector<LockedSide> locked_sides;
  // Points that the reader knows must not move, with the reason; derived locks come on top.
  std::vector<std::pair<int, std::string>> fixed_points;
  std::vector<SharedTrim> shared_trims;
  std::vector<LockReason> lock_reasons;
  std::vector<Lock> locks;
  // Smoothness that displacements keep by equations instead; derive_locks fills them.
  std::vector<SmoothRelation> relations;

  // The surface of patch q, with the poles of `points` (default: the model's own).
  Surface surface(int q) const { return surface(q, points); }
  Surface surface(int q, const std::vector<Vec3>& at) const;

  // Records that `point` must not move because of `reason`.
  void lock(int point, const std::string& reason, bool continuity);
};

// Throws InputError naming the patch and the number when indices, sizes, weights or coordinates are
// not usable (index out of range, NaN, weights not positive, duplicate handles).
void validate(const PatchModel& model);

// The length of the diagonal of the box of all points; the scale of all relative tolerances.
double diagonal(const PatchModel& model);

// Point classes: points that always move together. class_of[i] is the class of point i, classes are
// numbered by first occurrence. Cost O(#points + #ties).
struct PointClasses {
  std::vector<int> class_of;
  std::vector<int> representative;  // the first point of each class
};
PointClasses point_classes(const PatchModel& model);

// The grid indices (i, j) along a side, in the direction of the running parameter.
// `depth` counts rows inwards: 0 is the boundary row.
std::vector<std::pair<int, int>> side_indices(const Patch& patch, Side side, int depth = 0);

}  // namespace isochor
