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

// The volume of a model whose trimming curves have moved, by another integral than the edit's.
double volume_by_moments(const SolidModel& model) {
  return moments_from(*model.moments).volume.value;
}

// The followers of the canopy model: one trimmed along the curve as well, one closed whose side the
// curve is, with its seam at the curve's only vertex.
struct FollowCase {
  const char* name;
  const char* edits;
  int follower;    // patch and face
  int other;       // patch that stays
  Uv on_skin;      // a place of the curve that moves
  Uv on_follower;  // the same on the follower
};
class MovingTrims : public ::testing::TestWithParam<FollowCase> {};

TEST_P(MovingTrims, MoveWithBothFacesAndKeepTheVolume) {
  const FollowCase& c = GetParam();
  const std::string input = kData + "step/canopy.step";
  const std::string script = kData + "edits/" + c.edits;
  const Edit edit = parse_edits(testing::read_text(script), script).edits.at(0);
  ReadOptions options;
  options.shared_trims = options.moments = true;
  const SolidModel before = read_solid(input, options);
  ASSERT_EQ(before.patches.shared_trims.size(), 4u);
  const int face = std::string(c.name) == "Mast" ? 6 : 1;
  const auto faces_of = [&](const PatchModel& model) {
    return std::vector<EditedFace>{{0, model.surface(0)}, {face, model.surface(c.follower)}};
  };
  Surroundings surroundings;
  surroundings.outside_volume =
      before.facts.volume - VolumeForm(before.patches).value(before.patches.points);
  surroundings.measure = [&](const PatchModel& model, const std::vector<bool>&, double tolerance) {
    const EditedFacts edited = measure_edited(input, {}, faces_of(model), tolerance);
    return MeasuredVolume{{edited.facts.volume, edited.facts.volume_bound}, edited.refusal};
  };
  EditSession session(before.patches, surroundings);
  const Certificate certificate = session.apply(edit);
  ASSERT_EQ(certificate.outcome, Outcome::kDone) << certificate.reason;
  EXPECT_TRUE(certificate.volume.kept);

  const fs::path output =
      fs::temp_directory_path() / ("isochor-canopy-" + std::to_string(getpid()) + ".step");
  const WriteReport report =
      write_edited(input, {}, faces_of(session.model()), output.string(), edit.follow.tolerance);
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.written_by, "line by line");
  const SolidModel after = read_solid(output.string(), options);
  const WriteReport refused = write_edited(input, {}, faces_of(session.model()), output.string());
  fs::remove(output);
  EXPECT_FALSE(refused.written) << "trimming curves only move when the user says how far";
  EXPECT_NE(refused.refusal.find("moves an edge that is trimmed out of it"), std::string::npos)
      << refused.refusal;

  EXPECT_TRUE(after.facts.valid && after.facts.closed);
  EXPECT_NEAR(after.facts.volume, before.facts.volume, kVolumeKept * before.facts.volume);
  EXPECT_NEAR(volume_by_moments(after), volume_by_moments(before),
              1e-9 * before.facts.volume + edit.follow.tolerance);
  // The gap, measured at other places than the fit: both faces of the file at equal fractions.
  double gap = 0.0;
  ASSERT_EQ(after.patches.shared_trims.size(), 4u);
  for (const SharedTrim& now : after.patches.shared_trims) {
    for (size_t k = 0; k < now.along[0].size(); ++k) {
      const auto point = [k](const PatchModel& model, const SharedTrim& trim, size_t side) {
        const Uv& uv = trim.along[side][k];
        return Vec3(model.surface(trim.patches[side]).point(uv.u, uv.v));
      };
      gap = std::max(gap, (point(after.patches, now, 0) - point(after.patches, now, 1)).norm());
    }
  }
  EXPECT_LE(gap, edit.follow.tolerance);
  EXPECT_LE(report.reread.max_edge_gap, edit.follow.tolerance);
  const auto displacement = [&](int q, const Uv& uv) {
    return Vec3(after.patches.surface(q).point(uv.u, uv.v) -
                before.patches.surface(q).point(uv.u, uv.v));
  };
  EXPECT_GT(displacement(0, c.on_skin).norm(), 0.02);
  EXPECT_GT(displacement(c.follower, c.on_follower).norm(), 0.02);
  EXPECT_EQ(after.patches.surface(c.other).poles(), before.patches.surface(c.other).poles());
  for (const SmoothRelation& relation : after.patches.relations) {
    EXPECT_LE(relation.residual, 1e-9) << relation.text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Canopy, MovingTrims,
    ::testing::Values(FollowCase{"Canopy", "canopy_pull.json", 1, 2, {0.0, 0.5}, {0.0, 0.5}},
                      FollowCase{"Mast", "canopy_mast.json", 2, 1, {-3.0, 0.25}, {1.0, 0.0}}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace isochor
