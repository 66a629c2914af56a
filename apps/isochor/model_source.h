// Models from files of any format, and back.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "busy_line.h"
#include "commands.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/edit/edit_session.h"
#ifdef ISOCHOR_WITH_OCCT
#include "isochor/step/solid_model.h"
#endif

namespace isochor::app {

// A model as read: always patches and what surrounds them; for CAD files also the solid's facts.
struct LoadedModel {
  std::string path;
  PatchModel patches;
  Surroundings surroundings;
  std::string opening;  // where it is open and what closes it, in words; empty when it is closed
  double volume = 0.0;  // total, signed
  double volume_bound = 0.0;
  // What gaps between faces leave open in the volume: their tolerance times the area. Patches that
  // share their points have none.
  double gap_tolerance = 0.0;
  double undefined_by_gaps = 0.0;
#ifdef ISOCHOR_WITH_OCCT
  std::optional<SolidModel> solid;
  std::vector<int> converted;  // 0-based faces that were turned into B-splines for this edit
#endif
};

// "gaps of up to 1e-07 m leave 2e-05 m^3 of the volume undefined (tolerance times area)"; empty
// when there are none.
std::string gaps_text(const LoadedModel& loaded);

// True for STEP, IGES and BREP by extension.
bool is_cad_file(const std::string& path);

// What is measured on the shape of a CAD file, beside its volume.
struct ShapeMeasures {
  bool moments = false;
  std::vector<double> section;      // NX, NY, NZ, H, or empty
  std::vector<ClosingPlane> close;  // planes that close the model
  std::optional<ClosingPlane> below = {};
  bool entities = false;      // the numbers of edges in STEP files
  bool crossings = false;     // faces that cut through each other
  bool shared_trims = false;  // for edits that move trimming curves
};

// The planes that --close names. InputError for what is no plane.
std::vector<ClosingPlane> parse_close(const std::vector<std::string>& options);
// "closed by the plane y = 0"; empty when no planes close it.
std::string closing_text(const LoadedModel& loaded);
// ["y = 0"], for the key "closed_by".
std::vector<std::string> closing_names(const LoadedModel& loaded);

// Reads a model. `convert`: names of faces to turn into B-spline patches when they are not.
// Throws InputError for anything that cannot be used, also for an unknown extension.
LoadedModel load_model(const std::string& path, const Common& common,
                       const std::vector<std::string>& convert = {},
                       const ShapeMeasures& measures = {});

#ifdef ISOCHOR_WITH_OCCT
// Limits as the user set them; progress to `busy`, which must outlive the reading.
ReadOptions read_options(const Common& common, BusyLine& busy);
// New geometry for the faces whose patches have moved.
std::vector<EditedFace> edited_faces(const SolidModel& solid, const PatchModel& model,
                                     const std::vector<bool>& moved);
// 0-based index of the face called `name`. Throws InputError (unknown, ambiguous).
int find_face(const SolidModel& solid, const std::string& name);
#endif

}  // namespace isochor::app
