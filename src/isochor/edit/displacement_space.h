// The displacements an edit may make: points = p0 + F delta, with F sparse and fixed.
//
// Symbols: a *coefficient* delta_c is a 3-vector on the control grid of the chosen scale. Fine
// grids and coarse grids are tied in the same way: coefficients that must move together (joins,
// seams, collapsed sides, shared corners) are one coefficient; under mirror symmetry two mirror
// images are one coefficient, with the sign of one axis flipped for one of them.
//
// Laws:
//  (1) tied points get bit-identical displacements; mirror images get them up to the flipped sign;
//  (2) a locked point's displacement is exactly zero, whatever the coefficients;
//  (3) gather is the transpose of expand: <g, expand(delta)> = <gather(g), delta>.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smooth_relations.h"
#include "isochor/edit/edit_script.h"
#include "isochor/exact/rational.h"
#include "isochor/multires/model_scale.h"

namespace isochor {

// A linear form on the coefficients, axis by axis: sum_k value[k](a) * delta_{coefficient[k]}(a).
struct CoefficientRow {
  std::vector<int> coefficient;
  std::vector<Vec3> value;
  // The same without rounding, for exact verdicts; empty: the doubles are exact.
  std::vector<std::array<Rational, 3>> exact;
};

// Which form of a surface's displacement: itself, or its derivative along a parameter.
enum class SurfaceForm { kPoint, kAlongU, kAlongV };

// An equation that every displacement obeys: row(delta) = 0 on each axis.
struct KeptRow {
  CoefficientRow row;
  int relation = 0;  // index into DisplacementSpace::relations
};

class DisplacementSpace {
 public:
  // What to keep at the joins of two patches, instead of the default.
  struct EdgeRule {
    int a = 0, b = 0;
    Continuity keep = Continuity::kMeasured;
  };
  // What the space depends on besides the model.
  struct Options {
    Scale scale;
    Continuity continuity = Continuity::kMeasured;
    std::vector<int> symmetry_axes;  // mirror planes: 0 for x = 0, ...
    std::vector<EdgeRule> edges = {};
  };
  // The reason of a lock that symmetry brings.
  static constexpr const char* kOnSymmetry = "on the plane of symmetry";

  // Throws InputError for knots that are not in the model, and for models that are not symmetric
  // (naming the first point without a mirror image). Cost O(#points * (d+1)^2).
  DisplacementSpace(const PatchModel& model, const Options& options);

  int size() const { return static_cast<int>(places_.size()); }
  int point_count() const { return static_cast<int>(class_of_point_.size()); }

  // The coarse grid of patch q, and the coefficient at its index (i, j).
  const KnotVector& u_knots(int q) const { return grids_[static_cast<size_t>(q)].u.coarse; }
  const KnotVector& v_knots(int q) const { return grids_[static_cast<size_t>(q)].v.coarse; }
  int coefficient(int q, int i, int j) const;
  // +1 or -1 per axis: the displacement of grid index (i, j) is signs .* delta_coefficient.
  Vec3 signs(int q, int i, int j) const;

  // Where a coefficient "is": the surface point at its Greville abscissae (inside the domain, where
  // a direction wraps).
  const Vec3& place(int c) const { return places_[static_cast<size_t>(c)]; }
  // How many grid coefficients it stands for in the metric (2 for a mirrored pair, else 1).
  double weight(int c) const { return weights_[static_cast<size_t>(c)]; }
  // Coefficients next to c on the control net (including diagonal steps), across joins.
  const std::vector<int>& neighbours(int c) const { return neighbours_[static_cast<size_t>(c)]; }

  // Bit a is set when axis a of coefficient c must stay zero; 7: all of it.
  unsigned locked_axes(int c) const { return locked_axes_[static_cast<size_t>(c)]; }
  // Why, in words; empty when nothing is locked.
  const std::string& lock_reason(int c) const;
  // A patch that the coefficient belongs to.
  int patch_of(int c) const { return patch_of_[static_cast<size_t>(c)]; }
  // Locks every coefficient that moves one of these points.
  void lock_points(const std::vector<int>& points, const std::string& reason);

  // The displacement of the surface of patch q at (u, v), or its derivative there. Exact for
  // polynomial patches; for patches with weights exact for the map in doubles that is applied.
  CoefficientRow surface_row(const PatchModel& model, int q, Uv uv,
                             SurfaceForm form = SurfaceForm::kPoint) const;
  // The displacement of grid coefficient (i, j) of patch q.
  CoefficientRow grid_row(int q, int i, int j) const;

  // The displacement of one point of the model; empty for a point that no patch uses.
  CoefficientRow point_row(int point) const;

  // What holds the skin together besides ties and locks: equations on the coefficients, with the
  // relations of the model that they come from.
  const std::vector<KeptRow>& kept_rows() const { return kept_rows_; }
  const std::vector<SmoothRelation>& relations() const { return relations_; }
  const std::string& kept_name(const KeptRow& kept) const {
    return relations_[static_cast<size_t>(kept.relation)].text;
  }

  // Displacements of all points. delta: #coefficients. Cost O(nonzeros).
  std::vector<Vec3> expand(const std::vector<Vec3>& delta) const;
  // The gradient with respect to the coefficients of a function whose gradient per point is given.
  std::vector<Vec3> gather(const std::vector<Vec3>& point_gradient) const;
  // The points that move when only these coefficients change (mask of #coefficients).
  std::vector<int> moved_points(const std::vector<char>& coefficients) const;

 private:
  struct Grid {
    TwoScale u, v;
    int offset = 0;  // of its first entry among all grid entries
  };
  struct Entry {  // grid entry -> coefficient
    int coefficient = -1;
    unsigned flipped = 0;  // bit a: axis a changes sign
  };

  class EntrySets;
  class RowBuilder;
  int entry_index(int q, int i, int j) const;
  void tie_wrap(const SideRef& ref, EntrySets& sets);
  void make_grids(const PatchModel& model, const Scale& scale);
  void tie_entries(const PatchModel& model);
  void make_rows(const PatchModel& model);
  void check_ties(const PatchModel& model);
  void make_places(const PatchModel& model);
  void mirror(const PatchModel& model, int axis);
  int patch_of_row(size_t row) const;
  void check_mirror(const PatchModel& model, int axis, const std::vector<int>& image);
  void apply_locks(const PatchModel& model, const Options& options);
  void choose_relations(const PatchModel& model, const Options& options);
  std::vector<ContinuityRow> stated_relations(const PatchModel& model);
  void make_kept_rows(const std::vector<ContinuityRow>& rows, bool mirrored);
  void link_tied_curves();
  void drop_rows_implied_by_ties();
  CoefficientRow combination(const std::vector<GridTerm>& terms) const;
  void drop_mirrored_rows();
  void lock_coefficient(int c, unsigned axes, const std::string& reason);

  struct RowTerm {
    int entry;  // grid entry
    double value;
  };
  // The row of grid entries behind fine grid index (i, j) of patch q.
  std::vector<RowTerm> terms_of(int q, int i, int j) const;

  std::vector<Grid> grids_;
  std::vector<Entry> entries_;
  std::vector<int> class_of_point_;
  // Rows of F by point class, in terms of grid entries; empty rows for unused points.
  std::vector<std::vector<RowTerm>> rows_;
  std::vector<Vec3> places_;
  std::vector<double> weights_;
  std::vector<int> patch_of_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<unsigned> locked_axes_;
  std::vector<int> lock_reason_of_;
  std::vector<std::string> lock_reasons_;
  std::vector<SmoothRelation> relations_;
  std::vector<KeptRow> kept_rows_;
};

}  // namespace isochor
