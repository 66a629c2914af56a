// The committed edits of data/edits on the committed models: solved, written, read back.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/edit/edit_session.h"
#include "isochor/io/edits_json.h"
#include "isochor/step/solid_model.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "scenario/step_entities.h"

namespace isochor {
namespace {

namespace fs = std::filesystem;

const std::string kData = std::string(ISOCHOR_SOURCE_DIR) + "/data/";

struct EditRun {
  SolidModel before, after;
  PatchModel edited;  // of the session
  Certificate certificate;
  WriteReport report;
};

EditRun run_edit(const std::string& model, const std::string& edits) {
  EditRun r;
  const std::string input = kData + "step/" + model;
  r.before = read_solid(input);
  derive_locks(r.before.patches);
  Surroundings surroundings;
  surroundings.closed = r.before.facts.closed;
  surroundings.outside_volume =
      r.before.facts.volume - VolumeForm(r.before.patches).value(r.before.patches.points);
  EditSession session(r.before.patches, surroundings);
  const std::string script = kData + "edits/" + edits;
  r.certificate = session.apply(parse_edits(testing::read_text(script), script).edits.at(0));
  r.edited = session.model();

  std::vector<EditedFace> faces;
  for (size_t f = 0; f < r.before.faces.size(); ++f) {
    const int patch = r.before.faces[f].patch;
    if (patch < 0 || !session.moved_patches()[static_cast<size_t>(patch)]) continue;
    faces.push_back({static_cast<int>(f), session.model().surface(patch)});
  }
  const fs::path output =
      fs::temp_directory_path() / ("isochor-edits-" + std::to_string(getpid()) + ".step");
  r.report = write_edited(input, {}, faces, output.string());
  if (r.report.written) r.after = read_solid(output.string());
  fs::remove(output);
  return r;
}

void expect_done_and_valid(const EditRun& r) {
  ASSERT_EQ(r.certificate.outcome, Outcome::kDone) << r.certificate.reason;
  EXPECT_LE(std::abs(r.certificate.volume.relative_change), kVolumeKept);
  for (const MoveRecord& move : r.certificate.moves) {
    EXPECT_LE(move.error, kReached * r.before.facts.diagonal);
  }
  ASSERT_TRUE(r.report.written) << r.report.refusal;
  EXPECT_TRUE(r.report.rebuilt.valid);
  EXPECT_TRUE(r.after.facts.valid && r.after.facts.closed);
  EXPECT_LE(r.after.facts.max_tolerance, r.before.facts.max_tolerance);
  EXPECT_LE(r.report.rebuilt.max_edge_gap,
            r.report.before.max_edge_gap + 4 * kUnitRoundoff * r.before.facts.diagonal);
  EXPECT_EQ(r.after.facts.names, r.before.facts.names);
  EXPECT_EQ(r.after.facts.coloured, r.before.facts.coloured);
}

// The change of volume on what was read back, face by face: exactly, unless the face was refined.
void expect_volume_kept(const EditRun& r, int changed_faces) {
  double change = 0.0;
  int changed = 0;
  ASSERT_EQ(r.after.patches.patches.size(), r.before.patches.patches.size());
  for (int q = 0; q < static_cast<int>(r.before.patches.patches.size()); ++q) {
    PatchModel before = r.before.patches, after = r.after.patches;
    if (after.surface(q).poles() == before.surface(q).poles()) continue;
    ++changed;
    before.patches = {before.patches[static_cast<size_t>(q)]};
    after.patches = {after.patches[static_cast<size_t>(q)]};
    change += before.points.size() == after.points.size()
                  ? ExactVolume(before).change(before.points, after.points).to_double()
                  : VolumeForm(after).value(after.points) - VolumeForm(before).value(before.points);
  }
  EXPECT_EQ(changed, changed_faces);
  EXPECT_LE(std::abs(change), kVolumeKept * r.before.facts.volume);
}

struct Case {
  const char* name;
  const char* model;
  const char* edits;
  int changed_faces;
};

class BundledEdits : public ::testing::TestWithParam<Case> {};

TEST_P(BundledEdits, ReachThePointKeepTheVolumeAndWriteAValidSolid) {
  const EditRun r = run_edit(GetParam().model, GetParam().edits);
  ASSERT_NO_FATAL_FAILURE(expect_done_and_valid(r));
  expect_volume_kept(r, GetParam().changed_faces);
}

INSTANTIATE_TEST_SUITE_P(
    All, BundledEdits,
    ::testing::Values(Case{"FuselagePull", "fuselage.step", "fuselage_pull.json", 1},
                      Case{"Fuselage12Pull", "fuselage12.step", "fuselage12_pull.json", 4},
                      Case{"HullPull", "hull.step", "hull_pull.json", 2},
                      Case{"PatchworkPull", "patchwork.step", "patchwork_pull.json", 7},
                      Case{"CubeFigure4", "cube.step", "cube_figure4.json", 3}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(FuselageWindowEdit, ReachesTheWindowWithoutMovingItsEdges) {
  const EditRun r = run_edit("fuselage.step", "fuselage_window.json");
  ASSERT_NO_FATAL_FAILURE(expect_done_and_valid(r));
  expect_volume_kept(r, 1);
  EXPECT_EQ(r.report.faces_identical, r.report.faces_bspline_untouched);
  const Surface before = r.before.patches.surface(0), after = r.after.patches.surface(0);
  ASSERT_GT(after.v_size(), before.v_size());
  // The window spans v = 8.34 to 9.66; the refined spans are a third of the old ones.
  const std::vector<double> breaks = after.v_knots().breaks();
  const double edge = 9.66;
  const auto first = std::upper_bound(breaks.begin(), breaks.end(), edge);
  const double two_spans_on = *(first + 1);
  EXPECT_NEAR(two_spans_on, 10.0, 1e-12);
  const auto displacement = [&](double u, double v) {
    return (after.point(u, v) - before.point(u, v)).norm();
  };
  EXPECT_GT(displacement(23.5, two_spans_on), 1e-3);
  for (double u = 23.14; u <= 23.86; u += 0.09) {
    for (double v = 8.34; v <= edge; v += 0.11) EXPECT_LT(displacement(u, v), 1e-13);
  }
}

}  // namespace
}  // namespace isochor
