#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTools.hxx>
#include <TopExp_Explorer.hxx>

#include <fstream>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "isochor/step/checked_write.h"
#include "isochor/step/compare_faces.h"
#include "isochor/step/exchange.h"
#include "isochor/step/solid_model.h"
#include "step/pulls.h"
#include "step/shapes.h"
#include "step/temp_folder.h"

namespace isochor {
namespace {

using internal::Document;
using internal::load_document;
using shapes::pole_of;
using shapes::pull;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string write(Document document, const TempFolder& folder, const std::string& name) {
  write_document(document, folder.file(name));
  return folder.file(name);
}

// Pulls a pole of the file's own surfaces and writes; every promise is expected to hold.
void expect_written(const std::string& input, const std::string& output, int i, int j,
                    size_t faces) {
  const Document document = load_document(input);
  int f = 0;
  while (internal::plain_bspline(document.face(f)).IsNull()) ++f;
  const auto edits = pull(document, pole_of(document, f, i, j), {0.05, 0.02, -0.03});
  ASSERT_EQ(edits.size(), faces);
  const WriteReport report = write_edited(input, {}, edits, output);
  ASSERT_TRUE(report.written) << report.refusal;
  if (internal::format_of(input) == internal::FileFormat::kStep) {
    EXPECT_EQ(report.written_by, "line by line") << report.not_line_by_line;
  }
  EXPECT_TRUE(report.reread.valid);
  EXPECT_TRUE(report.reread.closed);
  EXPECT_LE(report.reread.max_tolerance, report.before.max_tolerance);
  EXPECT_LE(report.reread.max_edge_gap, report.before.max_edge_gap + 1e-12);
  EXPECT_EQ(report.edited_exact, static_cast<int>(faces));
  EXPECT_EQ(report.faces_identical, report.faces_bspline_untouched);
  EXPECT_LE(report.analytic_ulps, 4.0);
  EXPECT_THAT(report.reread.names, ::testing::IsSupersetOf(report.before.names));
  EXPECT_EQ(report.reread.coloured, report.before.coloured);
  EXPECT_NE(report.rebuilt.volume, report.before.volume);
  EXPECT_NEAR(report.reread.volume, report.rebuilt.volume, 1e-12 * report.rebuilt.volume);
}

class WriteEdited : public ::testing::TestWithParam<const char*> {};

TEST_P(WriteEdited, InteriorEdgeAndCornerMovesSurviveAFreshReader) {
  const TempFolder folder;
  const auto input =
      write(shapes::document_of(shapes::bicubic_cube(3.7), GetParam()), folder, "in.step");
  expect_written(input, folder.file("interior.step"), 2, 3, 1);
  expect_written(input, folder.file("edge.step"), 0, 2, 2);
  expect_written(input, folder.file("corner.step"), 5, 5, 3);
}
INSTANTIATE_TEST_SUITE_P(Units, WriteEdited, ::testing::Values("mm", "m", "inch", "foot"));

TEST(WriteEditedShapes, SeamsPolesAndHolesSurvive) {
  const TempFolder folder;
  const auto barrel = write(shapes::document_of(shapes::barrel(false)), folder, "barrel.step");
  expect_written(barrel, folder.file("seam.step"), 0, 2, 1);
  const auto dome = write(shapes::document_of(shapes::dome()), folder, "dome.step");
  expect_written(dome, folder.file("nose.step"), 3, 5, 1);
  const auto holed = write(shapes::document_of(shapes::holed_cube()), folder, "holed.step");
  expect_written(holed, folder.file("holed_out.step"), 1, 1, 1);
}

TEST(WriteEditedShapes, OtherFormatsWork) {
  const TempFolder folder;
  const auto brep = write(shapes::document_of(shapes::bicubic_cube()), folder, "in.brep");
  expect_written(brep, folder.file("out.brep"), 0, 2, 2);
  expect_written(brep, folder.file("out.step"), 0, 2, 2);
  const auto iges = write(shapes::document_of(shapes::bicubic_cube()), folder, "in.igs");
  expect_written(iges, folder.file("out.igs"), 0, 2, 2);
}

// Many IGES writers state the shell only. Written as loose surfaces it would fall apart.
TEST(WriteEditedShapes, ClosedIgesShellsWithoutASolidStayClosed) {
  const TempFolder folder;
  for (const auto& solid : {shapes::bicubic_cube(3.7), shapes::barrel(false)}) {
    const TopoDS_Shape shell = TopExp_Explorer(solid, TopAbs_SHELL).Current();
    const auto input = write(shapes::document_of(shell), folder, "shell.igs");
    ASSERT_FALSE(TopExp_Explorer(load_document(input).shape, TopAbs_SOLID).More());
    expect_written(input, folder.file("shell_out.igs"), 2, 3, 1);
  }
}

TEST(WriteEditedShapes, AssembliesKeepTheirLabels) {
  const TempFolder folder;
  const auto input = write(shapes::assembly("inch"), folder, "pair.step");
  expect_written(input, folder.file("pair_out.step"), 2, 2, 1);
  const Document after = load_document(folder.file("pair_out.step"));
  EXPECT_EQ(after.name_of(after.face(0)), "lid");
  EXPECT_EQ(after.unit.name, "inch");
}

// A reader makes closed faces periodic, with other poles; what is shown and written is the file's.
TEST(WriteEditedShapes, ClosedFacesKeepTheFilesOwnPoles) {
  const TempFolder folder;
  const auto input = write(shapes::document_of(shapes::barrel(true)), folder, "in.step");
  const Document document = load_document(input);
  const auto changed = internal::changed_by_reader(document);
  ASSERT_EQ(changed.size(), 1u);
  const auto& [face, stated] = *changed.begin();
  const SolidModel solid = read_solid(input);
  const int patch = solid.faces[static_cast<size_t>(face)].patch;
  ASSERT_GE(patch, 0);
  EXPECT_EQ(solid.patches.surface(patch).poles(), stated.poles());
  EXPECT_EQ(solid.patches.surface(patch).u_knots(), stated.u_knots());
  ASSERT_EQ(solid.patches.joins.size(), 1u) << "the seam";
  EXPECT_EQ(solid.patches.joins[0].a.patch, solid.patches.joins[0].b.patch);
  // A ring around moves, so that the seam stays smooth.
  std::vector<Vec3> poles = stated.poles();
  const Side side = solid.patches.joins[0].a.side;
  const bool around_u = side == Side::kUBegin || side == Side::kUEnd;
  const int around = around_u ? stated.u_size() : stated.v_size();
  for (int k = 0; k < around; ++k) {
    poles[around_u ? stated.index(k, 2) : stated.index(2, k)] += Vec3(0.02, 0.03, 0.01);
  }
  const Surface moved(stated.u_knots(), stated.v_knots(), poles, stated.weights());
  const auto report = write_edited(input, {}, {{face, moved}}, folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.written_by, "line by line") << report.not_line_by_line;
  EXPECT_EQ(report.edited_exact, 1);
  EXPECT_LE(report.lines_appended, around + 1) << "poles of the surface, one of the seam";
  const Document after = load_document(folder.file("out.step"));
  EXPECT_EQ(internal::file_surface(after, face)->poles(), poles);
}

// Everything through the patch model, as the editor does it.
TEST(WriteEditedShapes, ModelsThatWereReadCanBeWritten) {
  const TempFolder folder;
  const auto input = write(shapes::document_of(shapes::bicubic_cube(), "inch"), folder, "in.step");
  const SolidModel solid = read_solid(input);
  ASSERT_EQ(solid.patches.patches.size(), 6u);
  std::vector<Vec3> points = solid.patches.points;
  const Patch& patch = solid.patches.patches[2];
  points[static_cast<size_t>(patch.point(2, 3))] += Vec3(0.01, 0.1, 0.02);
  const auto report =
      write_edited(input, {}, {{2, solid.patches.surface(2, points)}}, folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.edited_exact, 1);
  EXPECT_EQ(report.faces_identical, 5);
  const SolidModel again = read_solid(folder.file("out.step"));
  EXPECT_EQ(again.patches.surface(2).poles(), solid.patches.surface(2, points).poles());
  EXPECT_EQ(again.unit, "inch");
}

// The surface of a converted face, refined, with one pole moved.
Surface dented(const SolidModel& solid, const Vec3& move) {
  Surface surface = solid.patches.surface(0);
  surface = refine(surface, refined_to_spans(surface.u_knots(), 8),
                   refined_to_spans(surface.v_knots(), 8));
  std::vector<Vec3> poles = surface.poles();
  poles[surface.index(5, 5)] += move;
  return Surface(surface.u_knots(), surface.v_knots(), poles);
}

TEST(WriteEditedShapes, AConvertedPlaneIsEdited) {
  const TempFolder folder;
  const auto box = shapes::document_of(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid());
  const auto input = write(box, folder, "box.step");
  ReadOptions options;
  options.convert = {5};
  const SolidModel solid = read_solid(input, options);
  ASSERT_EQ(solid.patches.patches.size(), 1u);
  const EditedFace edit{5, dented(solid, {0.0, 0.0, 0.2})};
  const auto report = write_edited(input, options, {edit}, folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.edited_exact, 1);
  EXPECT_TRUE(report.reread.closed);
  EXPECT_NE(report.reread.volume, report.before.volume);
  // Without the request the face is what the file says.
  EXPECT_THAT(write_edited(input, {}, {edit}, folder.file("no.step")).refusal,
              HasSubstr("not a B-spline"));
}

// A part that an assembly turns and shifts: the surface is stored in the part's own coordinates.
TEST(WriteEditedShapes, AConvertedPlaneOfAPlacedPartIsEditedWhereItStands) {
  const TempFolder folder;
  gp_Trsf turn, shift;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 2)), 0.7);
  shift.SetTranslation(gp_Vec(20.1, -3.3, 0.7));
  const auto box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  const auto input = write(shapes::placed(box, {turn * shift}), folder, "placed.step");
  ReadOptions options;
  options.convert = {5};
  const SolidModel solid = read_solid(input, options);
  ASSERT_EQ(solid.patches.patches.size(), 1u);
  const Vec3 corner = solid.patches.surface(0).pole(0, 0);
  EXPECT_GT(corner.norm(), 10.0) << "where the assembly shows it";
  const Vec3 move = 0.2 * solid.patches.surface(0).normal(0.5, 1.0);
  const EditedFace edit{5, dented(solid, move)};
  const auto report = write_edited(input, options, {edit}, folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.edited_exact, 1);
  EXPECT_LE(report.analytic_ulps, 4.0);
  EXPECT_LE(report.reread.max_tolerance, report.before.max_tolerance);
  const SolidModel again = read_solid(folder.file("out.step"));
  ASSERT_EQ(again.patches.patches.size(), 1u);
  const Surface& meant = edit.surface;
  const Surface found = again.patches.surface(0);
  ASSERT_EQ(found.poles().size(), meant.poles().size());
  for (size_t k = 0; k < meant.poles().size(); ++k) {
    EXPECT_LT((found.poles()[k] - meant.poles()[k]).norm(), 1e-13 * corner.norm());
  }
}

TEST(WriteEditedShapes, AConvertedPlaneOfAMirroredPartIsRefused) {
  const TempFolder folder;
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 5), gp_Dir(0, 0, 1)));
  TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  box.Location(TopLoc_Location(mirror), Standard_False);
  const std::string path = folder.file("mirrored.brep");
  BRepTools::Write(box, path.c_str());
  ReadOptions options;
  options.convert = {5};
  try {
    read_solid(path, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.reason(), HasSubstr("mirrored"));
  }
}

TEST(WriteEditedShapes, RefusalsLeaveAnOlderOutputAlone) {
  const TempFolder folder;
  const auto input = write(shapes::document_of(shapes::bicubic_cube()), folder, "in.step");
  folder.write("out.step", "old");
  const Document document = load_document(input);
  auto edits = pull(document, pole_of(document, 0, 0, 2), {0.05, 0.02, -0.03});
  edits.pop_back();
  const WriteReport report = write_edited(input, {}, edits, folder.file("out.step"));
  EXPECT_FALSE(report.written);
  EXPECT_THAT(report.refusal, HasSubstr("not edited"));
  EXPECT_EQ(text_of(folder.file("out.step")), "old");
  EXPECT_EQ(folder.file_count(), 2) << "no temporary file is left";
}

TEST(WriteEditedShapes, NumbersMustBeFinite) {
  const TempFolder folder;
  const auto input = write(shapes::document_of(shapes::bicubic_cube()), folder, "in.step");
  const Document document = load_document(input);
  const auto edits = pull(document, pole_of(document, 0, 0, 0), {std::nan(""), 0, 0});
  EXPECT_THROW(write_edited(input, {}, edits, folder.file("out.step")), PreconditionError);
  EXPECT_EQ(folder.file_count(), 1);
}

TEST(WriteEditedShapes, UnreadableFilesAreErrors) {
  const TempFolder folder;
  const auto input = write(shapes::document_of(shapes::bicubic_cube()), folder, "in.step");
  EXPECT_THROW(write_edited(folder.file("no.step"), {}, {}, folder.file("out.step")), InputError);
  EXPECT_THROW(write_edited(input, {}, {}, folder.file("out.docx")), InputError);
  EXPECT_THROW(write_edited(input, {}, {}, folder.file("no/such/out.step")), InputError);
  std::filesystem::create_directory(folder.file("folder.step"));
  EXPECT_THROW(write_edited(input, {}, {}, folder.file("folder.step")), InputError);
}

TEST(WriteEditedShapes, LimitsApply) {
  const TempFolder folder;
  internal::WriteJob job;
  job.input = "in.step";
  job.source = []() -> Document {
    for (volatile unsigned k = 0;; k = k + 1) {
    }
  };
  job.output = folder.file("out.step");
  job.limits.seconds = 1;
  try {
    internal::write_checked(job);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.file(), "in.step");
    EXPECT_THAT(e.reason(), HasSubstr("longer"));
  }
  EXPECT_EQ(folder.file_count(), 0);
}

TEST(CheckedWrite, AFileThatReadsBackDifferentlyIsRefused) {
  const TempFolder folder;
  internal::WriteJob job;
  job.input = "in.step";
  job.output = folder.file("out.step");
  // The second call, by the process that reads back, sees another shape: as if the writer had
  // changed it.
  const std::string mark = folder.file("mark");
  job.source = [mark] {
    const bool second = std::filesystem::remove(mark);
    if (!second) std::ofstream(mark) << "x";
    return shapes::document_of(shapes::bicubic_cube(second ? 1.01 : 1.0));
  };
  const WriteReport report = internal::write_checked(job);
  EXPECT_FALSE(report.written);
  EXPECT_THAT(report.refusal, HasSubstr("not where it was"));
  EXPECT_FALSE(std::filesystem::exists(job.output));
}

TEST(CompareFaces, SmallMovesAreNamedWithTheirSizeAndUnit) {
  const auto before = shapes::document_of(shapes::bicubic_cube(1.0), "inch");
  const auto after = shapes::document_of(shapes::bicubic_cube(1.0 + 4e-10), "inch");
  EXPECT_EQ(internal::compare_faces(before, before, {}).objection, "");
  const std::string objection = internal::compare_faces(before, after, {}).objection;
  EXPECT_THAT(objection, ::testing::MatchesRegex(".*not where it was.*off by .*e-1[01] inch.*"));
}

}  // namespace
}  // namespace isochor
