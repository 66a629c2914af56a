// What the rest of Isochor knows about a STEP, IGES or BREP file. No OpenCASCADE types here.
//
// The file is read in a child process; everything below crosses back as plain data. Faces are
// numbered in file order from 1 ("face:12"); the same file always gives the same numbers.
// All lengths are in the file's own unit, and coordinates are the file's own doubles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/base/progress.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/step/crossings_account.h"
#include "isochor/step/import_account.h"
#include "isochor/volume/below.h"
#include "isochor/volume/closing.h"
#include "isochor/volume/moments.h"
#include "isochor/volume/section.h"

namespace isochor {

// How a face uses its surface.
enum class TrimKind { kNatural, kIsoBox, kTrimmed, kTrimmedWithHoles };

struct FaceFacts {
  std::string handle;  // "face:12"
  std::string name;    // label in the file; may be empty
  std::vector<std::string> aliases;
  std::string surface;  // "B-spline 3x3", "rational B-spline 2x2", "plane", "cylinder", ...
  TrimKind trim = TrimKind::kTrimmed;
  bool bspline = false;  // the file's own geometry is B-spline or Bezier
  bool rational = false;
  bool convertible = false;  // can be turned into a B-spline face exactly, on request
  int patch = -1;            // index into SolidModel::patches, or -1
  std::string not_editable;  // when patch < 0: why, in words a designer understands
  double area = 0.0;
  double flux = 0.0;        // of z dx dy, or of the closing planes' field, over the oriented face
  double flux_bound = 0.0;  // estimated error of `flux`
  double tolerance = 0.0;
};

struct EdgeFacts {
  std::vector<int> faces;  // 0-based; one entry: free edge; the same twice: seam
  bool degenerated = false;
  double length = 0.0;
  double tolerance = 0.0;
  double max_gap = 0.0;        // between the 3D curve and its curves on the surfaces
  double max_angle_rad = 0.0;  // between the outward normals along the edge
  Smoothness smoothness = Smoothness::kSharp;
  std::vector<Vec3> points;  // along it, both ends included; empty without a curve in space
  // Of its EDGE_CURVE in the STEP file, 12 for #12, when asked for; 0 when not known.
  std::uint64_t entity = 0;
};

// Validity and measures of a whole shape, taken before and after an edit with the same ruler.
struct ShapeFacts {
  bool valid = false;  // BRepCheck_Analyzer
  std::vector<std::string> defects;
  int solids = 0, shells = 0, closed_shells = 0;
  int free_edges = 0, multiple_edges = 0;  // edges used by one face, by more than two
  bool closed = false;  // every shell closed, each edge used twice in opposite senses
  double max_tolerance = 0.0;
  double max_edge_gap = 0.0;    // largest curve-to-surface distance, own measure
  double max_vertex_gap = 0.0;  // largest vertex-to-curve distance, own measure
  double area = 0.0;
  double volume = 0.0;  // sum of the face fluxes
  double volume_bound = 0.0;
  double diagonal = 0.0;
  std::vector<std::string> names;  // all labels of shapes in file order
  int coloured = 0;                // sub-shapes with a colour

  // Faces that meet only within t enclose a volume that is defined only up to about t times the
  // area, however well it is computed; t is the largest of tolerances and measured gaps.
  double gap_tolerance() const { return std::max({max_tolerance, max_edge_gap, max_vertex_gap}); }
  double undefined_by_gaps() const { return gap_tolerance() * area; }
};

struct SolidModel {
  std::string path;
  std::string format;  // "STEP", "IGES", "BREP"
  std::string unit;    // "mm", "m", "inch", ...
  std::string schema;  // of a STEP file
  PatchModel patches;  // the editable faces, in file order
  std::vector<FaceFacts> faces;
  std::vector<EdgeFacts> edges;
  ShapeFacts facts;
  std::vector<OpenEdge> open_edges;           // edges of one face only
  std::optional<MomentIntegrals> moments;     // when asked for and the shape is closed
  std::optional<Section> section;             // the same
  std::optional<PartBelow> below;             // the same, or when planes close it
  std::optional<CrossingsAccount> crossings;  // when asked for
  ImportAccount import;
  std::vector<std::string> notices;  // repairs and warnings of the reader, in words
};

// What a child process may use.
struct BridgeLimits {
  double seconds = 300.0;     // of processor time
  double megabytes = 8192.0;  // of address space
};

struct ReadOptions {
  std::vector<int> convert;     // 0-based faces to turn into B-spline patches although they are not
  bool shared_trims = false;    // also the edges that patches share as trimming curves
  bool moments = false;         // also the moment integrals, which cost several times the volume
  bool entities = false;        // also the numbers of edges in a STEP file
  bool crossings = false;       // also which faces cut through each other
  std::vector<double> section;  // also the section by this plane, NX, NY, NZ, H; or empty
  std::optional<ClosingPlane> below;  // also what lies below this plane
  // Planes that close the shape: fluxes, volume and moments are taken with a field that has no flux
  // through them. Whether they close it is for the caller to judge (open_edges).
  std::vector<ClosingPlane> close;
  BridgeLimits limits;
  Watch watch;
};

// Reads a file. Throws InputError (missing, unreadable, no shape, reader died), LimitError and
// CancelledError.
SolidModel read_solid(const std::string& path, const ReadOptions& options = {});

// New geometry for one face.
struct EditedFace {
  int face = 0;  // 0-based
  Surface surface;
};

// The result of writing an edited shape: checked before writing and after re-reading.
struct WriteReport {
  bool written = false;
  std::string refusal;  // when not written: why, in words
  ShapeFacts before;    // the input
  ShapeFacts rebuilt;   // the edited shape in memory, before it was written
  ShapeFacts reread;    // what a fresh process read back from the output
  int faces_identical =
      0;  // untouched B-spline faces whose poles, knots, weights are the same bits
  int faces_bspline_untouched = 0;
  double analytic_ulps = 0.0;  // largest deviation of an analytic face, in units in the last place
  int edited_exact = 0;        // edited faces that came back bit for bit
  // "line by line": the lines of the input, of which `lines_repointed` were changed, and
  // `lines_appended` new ones; or "OpenCASCADE": everything written anew.
  std::string written_by;
  int lines_appended = 0, lines_repointed = 0;
  std::string not_line_by_line;  // STEP to STEP only: why it was written anew; else empty
  std::vector<std::string> notices;
};

// Applies edited faces to `input` and writes `output` (format by extension), atomically.
// Refuses (written == false) when the rebuilt shape is not valid, a tolerance or gap grew, or the
// re-read file differs from what was meant. Throws InputError when files cannot be read or written.
// `trim_tolerance`: trimming edges whose faces are all edited may move, and open by this much.
WriteReport write_edited(const std::string& input, const ReadOptions& options,
                         const std::vector<EditedFace>& faces, const std::string& output,
                         double trim_tolerance = 0.0);

// What the edited shape would be, without writing it: its facts, or why it cannot be built.
struct EditedFacts {
  ShapeFacts facts;
  std::string refusal;
};
EditedFacts measure_edited(const std::string& input, const ReadOptions& options,
                           const std::vector<EditedFace>& faces, double trim_tolerance = 0.0);

}  // namespace isochor
