// An edit resolved on a model: names found, freedom and constraint rows built, ready to solve for
// any values of its moves. Internal to the edit layer; EditSession is its user.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isochor/edit/certificate.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/skin_change.h"
#include "isochor/edit/solve.h"

namespace isochor {

namespace internal {
// The reason of locks by "hold": {"edge": ...} is the hold's name and this.
inline constexpr const char* kKeepsTheEdge = " keeps the edge";
}  // namespace internal

// A place of the edit on this model.
struct ResolvedPlace {
  std::string text;  // for people
  int patch = 0;
  Uv uv;                         // surface places
  bool coefficient = false;      // a coefficient instead of a surface point
  Vec3 position = Vec3::Zero();  // where it is on the rest shape
  CoefficientRow row;
};

class PreparedEdit {
 public:
  // `rest` is the refined model on which the edit acts; `closing`, the planes that close it, hold
  // its free sides. With a mirror plane among them the freedom is that of the model and its mirror
  // image together (mirrored_model.h). Throws InputError.
  PreparedEdit(PatchModel rest, const Edit& edit, const std::vector<ClosingPlane>& closing = {});
  PreparedEdit(const PreparedEdit&) = delete;  // the solver points into this object
  PreparedEdit& operator=(const PreparedEdit&) = delete;

  const PatchModel& rest() const { return rest_; }
  const VolumeForm& volume_form() const { return volume_; }
  const std::vector<ResolvedPlace>& moves() const { return moves_; }
  const std::vector<ResolvedPlace>& holds() const { return holds_; }

  // The displacement that value `value` of move k asks for ("by" or "to").
  Vec3 displacement(size_t k, const Vec3& value) const;

  // Solves for the given values; `wanted_change` is that of the volume. The first call judges the
  // constraints and factors them, the next ones only solve.
  SolveResult solve_for(const std::vector<Vec3>& values, double wanted_change, double volume_scale);

  // The points of rest() displaced by F delta.
  std::vector<Vec3> displaced(const std::vector<Vec3>& delta) const;
  // The skin of other points of rest() against that of rest() itself.
  SkinMeasures measure_skin(const std::vector<Vec3>& points, const std::vector<bool>& moved);
  // Fills what does not depend on the values: freedom, locks, resolved edit.
  void describe(Certificate& certificate) const;

 private:
  ResolvedPlace resolve(const Place& place, const std::string& where) const;
  ResolvedPlace resolve_coefficient(const Place& place, const std::string& where) const;
  void resolve_holds();
  void lock_edge(const Hold& hold, const std::string& name);
  void hold_normal(const Place& place, const std::string& name);
  void hold_plane(const Hold& hold, const std::string& name);
  void hold_closing_plane(const ClosingPlane& plane);
  void make_solver();
  std::vector<std::string> holds_that_lock(const CoefficientRow& row) const;
  void select_coefficients();

  PatchModel rest_;
  std::vector<ClosingPlane> closing_;
  PatchModel whole_;  // rest_, or rest_ and its mirror image
  Edit edit_;
  VolumeForm volume_;        // of the rest
  VolumeForm whole_volume_;  // the same, on the points of the whole
  DisplacementSpace space_;
  double size_ = 1.0;
  std::vector<ResolvedPlace> moves_, holds_;
  std::vector<std::string> hold_names_;
  std::vector<LinearConstraint> kept_;  // by holds that ask for no value
  std::vector<LinearConstraint> normals_;
  std::vector<char> extent_, sink_;
  std::unique_ptr<EditSolver> solver_;
  std::optional<SkinGauge> gauge_;  // from the first solution on
};

}  // namespace isochor
