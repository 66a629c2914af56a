// An editing job on one model: begin, drag, commit or cancel; undo and redo.
//
// `begin` does what does not depend on the mouse: refinement, freedom, constraint rows. `drag`
// solves for new values of the moves from the *rest shape*, which is the last commit (not the last
// drag). A failed or cancelled edit leaves the model as it was, bit for bit.
//
// Laws:
//  (1) cancel restores the model of before begin; undo that of before commit; redo the other way;
//  (2) drag(x); drag(y) leaves the same candidate as drag(y) alone;
//  (3) the open sides of a model closed by planes stay in their planes; beyond a mirror plane the
//      model goes on as its mirror image, and stays as smooth across as it is;
//  (4) trimming curves stay where they are, unless the edit names faces that follow: then the
//  volume
//      is measured anew with those, and the edit makes up for the change away from the curves;
//  (5) in a list of edits "keep" means the volume at the start of the session, or the last target:
//      what one edit misses by rounding, the next one makes up for.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isochor/base/progress.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/edit/certificate.h"
#include "isochor/edit/edit_script.h"
#include "isochor/volume/bounded.h"

namespace isochor {

// The volume of a whole solid, trimmed faces included.
struct MeasuredVolume {
  Bounded volume;
  std::string refusal;  // when there is none: why
};

// What surrounds the editable patches: the rest of a solid contributes a fixed volume.
struct Surroundings {
  bool closed = true;           // also when planes close it
  std::string why_open;         // when not closed: in words ("12 free edges")
  double outside_volume = 0.0;  // total minus the integral over the whole (untrimmed) patches
  double outside_bound = 0.0;   // error bound of outside_volume
  // The planes that close it; volumes are measured with their field.
  std::vector<ClosingPlane> closing = {};
  // Measures the solid with other patches (those with moved[q]) when trimming curves have moved by
  // up to what `tolerance` leaves open: then the outside is no longer fixed. Null: they cannot.
  std::function<MeasuredVolume(const PatchModel& model, const std::vector<bool>& moved,
                               double tolerance)>
      measure = {};
};

class EditSession {
 public:
  explicit EditSession(PatchModel model, Surroundings surroundings = {});
  ~EditSession();
  EditSession(EditSession&&) noexcept;
  EditSession& operator=(EditSession&&) noexcept;

  // The last commit.
  const PatchModel& model() const;
  // While an edit is under way: the model it would commit; else the same as model().
  const PatchModel& candidate() const;
  // By patch: some pole has moved since the session began, up to the last commit. A patch that was
  // only refined has not moved.
  const std::vector<bool>& moved_patches() const;
  // The total volume of the last commit.
  double volume() const;

  // Starts an edit. The certificate says whether it can be done at the values in `edit`.
  // Throws InputError for names, indices and parameters that do not exist, PreconditionError when
  // an edit is under way.
  Certificate begin(const Edit& edit);
  // New values of the moves, one per move of the edit ("by" or "to" as there).
  Certificate drag(const std::vector<Vec3>& values);
  // Takes the candidate; allowed when the last begin or drag was done.
  Certificate commit();
  void cancel();

  bool undo();  // false when there is nothing to undo
  bool redo();

  // begin, the drag steps of the edit, commit when done, else cancel.
  Certificate apply(const Edit& edit, const CancelToken& token = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isochor
