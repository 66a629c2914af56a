// The account of an import: the text alone, and what OpenCASCADE returned beside it.
#include "isochor/step/import_account.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/step/convert.h"
#include "isochor/step/import_text.h"
#include "isochor/step/solid_model.h"
#include "temp_folder.h"

namespace isochor {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kHead =
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n";
constexpr const char* kTail = "ENDSEC;\nEND-ISO-10303-21;\n";

internal::StatedShapes stated(const std::string& data) {
  return internal::stated_shapes(internal::Part21File("f.step", kHead + data + kTail));
}

std::string cube() {
  std::ifstream in(std::string(ISOCHOR_SOURCE_DIR) + "/data/step/cube.step", std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

// Without the instance that starts with `head`.
std::string dropped(std::string text, const std::string& head) {
  const size_t at = text.find("\n" + head);
  EXPECT_NE(at, std::string::npos) << head;
  return text.erase(at, text.find(";\n", at) + 1 - at);
}

TEST(ImportText, CountsFacesThatShapesLeadTo) {
  const auto shapes = stated(
      "#1=SHAPE_REPRESENTATION('',(#2),#9);\n#2=MANIFOLD_SOLID_BREP('',#3);\n"
      "#3=CLOSED_SHELL('',(#4,#5));\n#4=ADVANCED_FACE('',(),#7,.T.);\n"
      "#5=FACE_SURFACE('',(),#7,.T.);\n#6=ADVANCED_FACE('',(),#7,.T.);\n#7=PLANE('',$);\n"
      "#8=STYLED_ITEM('',(),#6);\n#9=CONTEXT();\n");
  EXPECT_EQ(shapes.entities, 9);
  EXPECT_EQ(shapes.counts.solids, 1);
  EXPECT_EQ(shapes.counts.shells, 1);
  EXPECT_EQ(shapes.counts.faces, 2);
  ASSERT_EQ(shapes.faces.size(), 2u);
  EXPECT_EQ(shapes.faces[0].number, 4u);
  EXPECT_EQ(shapes.faces[0].text, "#4 (line 11, ADVANCED_FACE)");
  EXPECT_THAT(shapes.unused, ElementsAre("#6 (line 13, ADVANCED_FACE)"));
  EXPECT_THAT(shapes.broken, IsEmpty());
}

TEST(ImportText, SurfacesOfGeometricSetsAreFaces) {
  const auto shapes = stated(
      "#1=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#2),#9);\n"
      "#2=GEOMETRIC_SET('',(#3,#4,#5));\n#3=RECTANGULAR_TRIMMED_SURFACE('',#6,0.,1.,0.,1.,.T.,.T.);"
      "\n"
      "#4=(BOUNDED_SURFACE()B_SPLINE_SURFACE()GEOMETRIC_REPRESENTATION_ITEM()SURFACE());\n"
      "#5=LINE('',$,$);\n#6=PLANE('',$);\n#9=CONTEXT();\n");
  EXPECT_EQ(shapes.counts.faces, 2);
  EXPECT_EQ(shapes.counts.solids, 0);
}

TEST(ImportText, WhatBreaksTheRulesIsNamedWithItsLine) {
  EXPECT_THAT(stated("#1=VERTEX_POINT('',#99);\n").broken,
              ElementsAre("#1 (line 8, VERTEX_POINT): refers to #99, which does not exist"));
  EXPECT_THAT(stated("#1=CARTESIAN_POINT('',('1','2'));\n").broken,
              ElementsAre(HasSubstr("#1 (line 8, CARTESIAN_POINT): has no one to three numbers")));
  EXPECT_THAT(stated("#1=CARTESIAN_POINT('',(1.E999,0.,0.));\n").broken,
              ElementsAre("line 8: the number 1.E999 is too large"));
  EXPECT_THAT(stated("#1=CARTESIAN_POINT('',(0.,NaN,0.));\n").broken,
              ElementsAre(HasSubstr("line 8")));
  EXPECT_THAT(
      stated("#1=B_SPLINE_CURVE_WITH_KNOTS('',1,(#1,#1),.U.,.F.,.F.,(2,2),(0.,$),.U.);\n").broken,
      ElementsAre(HasSubstr("mixes numbers with what is none")));
  EXPECT_THAT(stated("#1=TRIMMED_CURVE('',#1,(#1,PARAMETER_VALUE(0.)),(#1),.T.,.U.);\n").broken,
              IsEmpty());
  std::string many;
  for (int k = 1; k <= 30; ++k) many += "#" + std::to_string(k) + "=VERTEX_POINT('',#99);\n";
  const auto broken = stated(many).broken;
  ASSERT_EQ(broken.size(), 21u);
  EXPECT_EQ(broken.back(), "10 more");
}

TEST(ImportText, CirclesOfReferencesEnd) {
  EXPECT_EQ(stated("#1=SHAPE_REPRESENTATION('',(#1,#2),$);\n#2=ADVANCED_FACE('',(#1),#2,.T.);\n")
                .counts.faces,
            1);
}

TEST(Import, AWholeFileIsComplete) {
  const TempFolder folder;
  const auto account = read_solid(folder.write("cube.step", cube())).import;
  EXPECT_TRUE(account.complete());
  EXPECT_EQ(account.objection(), "");
  EXPECT_TRUE(account.has_text);
  EXPECT_EQ(account.stated.faces, 6);
  EXPECT_EQ(account.read.faces, 6);
  EXPECT_EQ(account.stated.solids, 1);
  EXPECT_EQ(account.read.solids, 1);
  EXPECT_EQ(account.added_faces, 0);
  EXPECT_EQ(account.roots, 1);
  EXPECT_EQ(account.junk_bytes, 0);
  EXPECT_THAT(account.no_area, IsEmpty());
}

TEST(Import, JunkBeforeTheHeaderIsCounted) {
  const TempFolder folder;
  const auto account = read_solid(folder.write("junk.step", "junk\n" + cube())).import;
  EXPECT_EQ(account.junk_bytes, 5);
  EXPECT_TRUE(account.complete());
}

TEST(Import, AFaceThatNoShapeUsesIsNamed) {
  const TempFolder folder;
  const auto path = folder.write("five.step", replaced(cube(), "(#1295,#1302,", "(#1302,"));
  const auto account = read_solid(path).import;
  EXPECT_EQ(account.stated.faces, 5);
  EXPECT_EQ(account.read.faces, 5);
  EXPECT_THAT(account.lost, IsEmpty());
  EXPECT_THAT(account.unused, ElementsAre("#1295 (line 1392, ADVANCED_FACE)"));
}

// A surface that is missing: OpenCASCADE leaves its face out and says nothing but a warning.
TEST(Import, ALostFaceIsNamedAndNeverWritten) {
  const TempFolder folder;
  const auto path = folder.write("lost.step", dropped(cube(), "#226="));
  const SolidModel model = read_solid(path);
  EXPECT_FALSE(model.import.complete());
  EXPECT_THAT(model.import.lost, ElementsAre(HasSubstr("#1295 (line ")));
  EXPECT_THAT(model.import.broken, Each(HasSubstr("refers to #226, which does not exist")));
  EXPECT_THAT(model.import.objection(), HasSubstr("1 of the 6 faces that the file states"));
  const WriteReport report = convert_file(path, folder.file("out.brep"));
  EXPECT_FALSE(report.written);
  EXPECT_THAT(report.refusal, HasSubstr("1 of the 6 faces"));
  EXPECT_EQ(folder.file_count(), 1) << "only the input";
}

// Why the second face cannot be written again; nothing but the input may be left.
std::string refusal_of_an_edit(const TempFolder& folder, const std::string& path,
                               const SolidModel& model) {
  const std::vector<EditedFace> edits = {{1, model.patches.surface(model.faces[1].patch)}};
  const WriteReport report = write_edited(path, {}, edits, folder.file("out.step"));
  EXPECT_FALSE(report.written);
  EXPECT_EQ(folder.file_count(), 1) << "only the input";
  return report.refusal;
}

// OpenCASCADE reads a coordinate that is no number as zero.
TEST(Import, ABrokenRuleKeepsEditsAway) {
  const TempFolder folder;
  const auto path =
      folder.write("text.step", replaced(cube(), "#5=CARTESIAN_POINT('',(0.,0.25,1.));",
                                         "#5=CARTESIAN_POINT('',(0.,'x',1.));"));
  const SolidModel model = read_solid(path);
  ASSERT_FALSE(model.import.complete());
  EXPECT_THAT(model.import.objection(), HasSubstr("breaks the rules of STEP"));
  EXPECT_THAT(refusal_of_an_edit(folder, path, model), HasSubstr("breaks the rules of STEP"));
}

// A vertex at 1e30 leaves the volume to its error bound; a comparison within it proves nothing.
TEST(Import, AnUndeterminedVolumeKeepsEditsAway) {
  const TempFolder folder;
  const auto path =
      folder.write("huge.step", replaced(cube(), "#5=CARTESIAN_POINT('',(0.,0.25,1.));",
                                         "#5=CARTESIAN_POINT('',(0.,0.25,1.E30));"));
  const SolidModel model = read_solid(path);
  ASSERT_TRUE(model.facts.closed);
  ASSERT_FALSE(model.facts.volume_bound < std::abs(model.facts.volume));
  EXPECT_THAT(refusal_of_an_edit(folder, path, model), HasSubstr("is not determined"));
}

TEST(Import, FacesOfTextThatCannotBeReadAreCounted) {
  const TempFolder folder;
  const auto path = folder.write("half.step", replaced(cube(), "#226=B_SPLINE", "#226=) B_SPLINE"));
  const auto account = read_solid(path).import;
  EXPECT_EQ(account.stated.faces, 6);
  EXPECT_THAT(account.broken, ElementsAre(HasSubstr("line 233")));
  EXPECT_THAT(account.lost, ElementsAre("one of unknown number"));
  EXPECT_FALSE(convert_file(path, folder.file("out.brep")).written);
}

TEST(Import, OtherFormatsHaveNoText) {
  const TempFolder folder;
  const auto path = folder.write("cube.step", cube());
  ASSERT_TRUE(convert_file(path, folder.file("cube.brep")).written);
  const auto account = read_solid(folder.file("cube.brep")).import;
  EXPECT_FALSE(account.has_text);
  EXPECT_EQ(account.read.faces, 6);
  EXPECT_TRUE(account.complete());
}

}  // namespace
}  // namespace isochor
