#include "isochor/step/surgical.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

using ::testing::HasSubstr;

// Two bilinear faces side by side, x from 0 to 1 and from 1 to 2; the edge between them is a line
// with a parameter curve on each.
const char* const kData =
    "#1=CARTESIAN_POINT('a',(0.,0.,0.));\n#2=CARTESIAN_POINT('b',(0.,1.,0.));\n"
    "#3=CARTESIAN_POINT('c',(1.,0.,0.));\n#4=CARTESIAN_POINT('d',(1.,1.,0.));\n"
    "#5=CARTESIAN_POINT('e',(2.,0.,0.));\n#6=CARTESIAN_POINT('f',(2.,1.,0.));\n"
    "#11=B_SPLINE_SURFACE_WITH_KNOTS('left',1,1,((#1,#2),(#3,#4)),.PLANE_SURF.,.F.,.F.,.F.,\n"
    "(2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.); /* keep */\n"
    "#12=B_SPLINE_SURFACE_WITH_KNOTS('right',1,1,((#3,#4),(#5,#6)),.PLANE_SURF.,.F.,.F.,.F.,\n"
    "(2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.);\n"
    "#21=VERTEX_POINT('',#3);\n#22=VERTEX_POINT('',#4);\n"
    "#31=LINE('',#3,#40);\n#40=VECTOR('',#41,1.);\n#41=DIRECTION('',(0.,1.,0.));\n"
    "#32=PCURVE('',#11,#50);\n#33=PCURVE('',#12,#50);\n#50=DEFINITIONAL_REPRESENTATION('',(),$);\n"
    "#34=SURFACE_CURVE('',#31,(#32,#33),.CURVE_3D.);\n"
    "#35=EDGE_CURVE('',#21,#22,#34,.T.);\n"
    "#36=ORIENTED_EDGE('',*,*,#35,.T.);\n#37=ORIENTED_EDGE('',*,*,#35,.F.);\n"
    "#38=EDGE_LOOP('',(#36));\n#39=EDGE_LOOP('',(#37));\n"
    "#61=FACE_OUTER_BOUND('',#38,.T.);\n#62=FACE_OUTER_BOUND('',#39,.T.);\n"
    "#71=ADVANCED_FACE('',(#61),#11,.T.);\n#72=ADVANCED_FACE('',(#62),#12,.T.);\n"
    "#80=STYLED_ITEM('',(#81),#11);\n#81=STYLE();\n";

std::string with_data(const std::string& data) {
  return "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n" + data + "ENDSEC;\nEND-ISO-10303-21;\n";
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

Surface square(double x, int moved = -1, const Vec3& by = Vec3::Zero()) {
  const auto line = KnotVector::uniform(1, 1);
  std::vector<Vec3> poles = {{x, 0, 0}, {x, 1, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}};
  if (moved >= 0) poles[static_cast<size_t>(moved)] += by;
  return Surface(line, line, poles);
}

// The corner #4 = (1,1,0) rises by 0.5 on both faces.
SurgicalEdit corner_edit() {
  const Vec3 up(0, 0, 0.5);
  SurgicalEdit edit;
  edit.surfaces.push_back({"face:1", 71, false, square(0), square(0, 3, up)});
  edit.surfaces.push_back({"face:2", 72, false, square(1), square(1, 1, up)});
  MovedCurve curve;
  curve.edge = 35;
  curve.curve = {{KnotVector::uniform(1, 1)}, {{1, 0, 0}, {1, 1, 0.5}}, {}};
  edit.curves.push_back(curve);
  edit.points.push_back({22, {1, 1, 0}, {1, 1, 0.5}, 1e-7});
  edit.known_edges = {35};
  edit.known_vertices = {21, 22};
  return edit;
}

TEST(Surgical, MovesAPoleInPlaceAndLeavesEveryOtherByte) {
  const Part21File file("f.step", with_data(kData));
  const SurgicalText result = edit_text(file, corner_edit());
  ASSERT_EQ(result.refusal, "");
  std::string expected = kData;
  expected = changed(expected, "((#1,#2),(#3,#4))", "((#1,#2),(#3,#82))");
  expected = changed(expected, "((#3,#4),(#5,#6))", "((#3,#82),(#5,#6))");
  expected = changed(expected, "#34=SURFACE_CURVE('',#31,", "#34=SURFACE_CURVE('',#85,");
  expected = changed(expected, "VERTEX_POINT('',#4)", "VERTEX_POINT('',#82)");
  expected +=
      "#82=CARTESIAN_POINT('d',(1.,1.,0.5));\n#83=CARTESIAN_POINT('',(1.,0.,0.));\n"
      "#84=CARTESIAN_POINT('',(1.,1.,0.5));\n"
      "#85=B_SPLINE_CURVE_WITH_KNOTS('',1,(#83,#84),.UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),"
      ".UNSPECIFIED.);\n";
  EXPECT_EQ(result.text, with_data(expected));
  EXPECT_EQ(result.lines_appended, 4);
  EXPECT_EQ(result.lines_repointed, 4);
}

TEST(Surgical, MatchesEdgesAndVerticesByPlace) {
  const Part21File file("f.step", with_data(kData));
  const std::string expected = edit_text(file, corner_edit()).text;
  SurgicalEdit edit = corner_edit();
  edit.curves[0].edge = 0;
  edit.curves[0].ends = {Vec3(1, 1, 0), Vec3(1, 0, 0)};
  edit.curves[0].near = 1e-7;
  edit.points[0].vertex = 0;
  edit.known_edges = edit.known_vertices = {};
  EXPECT_EQ(edit_text(file, edit).text, expected);
  // An edge that the file leaves out (a seam that a reader adds) has nothing to change.
  edit.curves[0].ends = {Vec3(0, 1, 0), Vec3(1, 0, 0)};
  EXPECT_THAT(edit_text(file, edit).text, HasSubstr("#34=SURFACE_CURVE('',#31,(#32,#33)"));
}

TEST(Surgical, KeepsTheDirectionsOfSplineCurves) {
  std::string data = changed(kData, "#31=LINE('',#3,#40);",
                             "#31=B_SPLINE_CURVE_WITH_KNOTS('',1,(#3,#4),.POLYLINE_FORM.,.F.,.F.,"
                             "(2,2),(0.,1.),.UNSPECIFIED.);");
  const Part21File file("f.step", with_data(data));
  const SurgicalText result = edit_text(file, corner_edit());
  EXPECT_EQ(result.lines_appended, 1);
  EXPECT_THAT(result.text, HasSubstr("1,(#3,#82),.POLYLINE_FORM."));
  EXPECT_THAT(result.text, HasSubstr("#34=SURFACE_CURVE('',#31,"));
}

// The right face stays on the left one's surface: the left one leaves it.
TEST(Surgical, LeavesSurfacesToFacesThatAreNotEdited) {
  const std::string data = changed(kData, "(#62),#12", "(#62),#11");
  const Part21File file("f.step", with_data(data));
  SurgicalEdit edit;
  edit.surfaces.push_back({"face:1", 71, false, square(0), square(0, 0, {0, 0, 1})});
  const SurgicalText result = edit_text(file, edit);
  ASSERT_EQ(result.refusal, "");
  EXPECT_THAT(result.text, HasSubstr("#71=ADVANCED_FACE('',(#61),#83,.T.);"));
  EXPECT_THAT(result.text, HasSubstr("#72=ADVANCED_FACE('',(#62),#11,.T.);"));
  EXPECT_THAT(result.text, HasSubstr("'left',1,1,((#1,#2),(#3,#4))"));
  EXPECT_THAT(result.text, HasSubstr("#82=CARTESIAN_POINT('a',(0.,0.,1.));\n"));
  EXPECT_THAT(result.text, HasSubstr("'left',1,1,((#82,#2),(#3,#4)),.PLANE_SURF."));
  // Both need the only parameter curve on it, so the face that leaves gets a copy.
  EXPECT_THAT(result.text, HasSubstr("#34=SURFACE_CURVE('',#31,(#32,#33,#84),.CURVE_3D.);"));
  EXPECT_THAT(result.text, HasSubstr("#84=PCURVE('',#83,#50);"));
  const std::string two = changed(data, "#33=PCURVE('',#12", "#33=PCURVE('',#11");
  EXPECT_THAT(edit_text(Part21File("f.step", with_data(two)), edit).refusal,
              HasSubstr("which parameter curves of #35 belong to face:1"));
}

TEST(Surgical, RepointsEveryUserToASurfaceInANewBasis) {
  const Part21File file("f.step", with_data(kData));
  const auto line = KnotVector::uniform(1, 1);
  const auto fine = KnotVector::uniform(1, 2);
  const Surface after(fine, line,
                      {{0, 0, 0}, {0, 1, 0}, {0.5, 0, 0.25}, {0.5, 1, 0}, {1, 0, 0}, {1, 1, 0}});
  SurgicalEdit edit;
  edit.surfaces.push_back({"face:1", 71, false, square(0), after});
  const SurgicalText result = edit_text(file, edit);
  EXPECT_THAT(result.text, HasSubstr("#71=ADVANCED_FACE('',(#61),#84,.T.);"));
  EXPECT_THAT(result.text, HasSubstr("#32=PCURVE('',#84,#50);"));
  EXPECT_THAT(result.text, HasSubstr("#80=STYLED_ITEM('',(#81),#84);"));
  EXPECT_THAT(result.text,
              HasSubstr("#84=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#1,#2),(#82,#83),(#3,#4)),"
                        ".UNSPECIFIED.,.F.,.F.,.F.,(2,1,2),(2,2),(0.,0.5,1.),(0.,1.),"
                        ".UNSPECIFIED.);"));
}

TEST(Surgical, WritesRationalSurfacesAndCurves) {
  const auto line = KnotVector::uniform(1, 1);
  const Surface after(line, line, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0.5}}, {1, 1, 1, 2});
  EXPECT_EQ(spline_body(spline_value(after), {1, 2, 3, 4}),
            "(BOUNDED_SURFACE()B_SPLINE_SURFACE(1,1,((#1,#2),(#3,#4)),.UNSPECIFIED.,.F.,.F.,.F.)"
            "B_SPLINE_SURFACE_WITH_KNOTS((2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)"
            "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),(1.,2.)))"
            "REPRESENTATION_ITEM('')SURFACE())");
  EXPECT_EQ(spline_body({{line}, {{0, 0, 0}, {1, 0, 0}}, {1, 3}}, {1, 2}),
            "(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#1,#2),.UNSPECIFIED.,.F.,.F.)"
            "B_SPLINE_CURVE_WITH_KNOTS((2,2),(0.,1.),.UNSPECIFIED.)CURVE()"
            "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,3.))"
            "REPRESENTATION_ITEM(''))");
  // And reads them.
  const Part21File file("f.step",
                        with_data("#9=" + spline_body(spline_value(after), {1, 2, 3, 4}) + ";\n"));
  const auto text = spline_text(file, file.instances()[0]);
  ASSERT_TRUE(text);
  EXPECT_TRUE(same_basis(*text, spline_value(after)));
  EXPECT_FALSE(same_basis(*text, spline_value(square(0))));
}

TEST(Surgical, GivesUpWithAReason) {
  const Part21File file("f.step", with_data(kData));
  const auto refusal = [](const Part21File& f, const SurgicalEdit& e) {
    try {
      return edit_text(f, e).refusal;
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  SurgicalEdit edit = corner_edit();
  edit.surfaces[1].entity = 0;
  EXPECT_EQ(refusal(file, edit), "face:2 is not found in the text of the file");
  edit = corner_edit();
  edit.surfaces[0].before = square(0, 3, {0, 0, 1e-9});
  EXPECT_THAT(refusal(file, edit), HasSubstr("the poles of face:1 are not those in the file"));
  edit = corner_edit();
  edit.curves[0].edge = 36;
  EXPECT_EQ(refusal(file, edit), "#36 is no edge of the edited faces");
  const Part21File bent("f.step", with_data(changed(kData, "(#61),#11", "(#61),#41")));
  EXPECT_THAT(refusal(bent, corner_edit()), HasSubstr("is no B-spline surface in the file"));
  const Part21File cut("f.step", with_data(changed(kData, "('',#38,", "('',#99,")));
  EXPECT_EQ(refusal(cut, corner_edit()),
            "f.step: line 29: #61 refers to #99, which is not in the file");
}

// Stated measures of the part with the faces, and of another part.
const char* const kMeasures =
    "#90=SHAPE_DEFINITION_REPRESENTATION(#91,#92);\n#91=PRODUCT_DEFINITION_SHAPE('',$,#93);\n"
    "#92=SHAPE_REPRESENTATION('',(#94),$);\n#93=PRODUCT_DEFINITION('',$);\n"
    "#94=OPEN_SHELL('',(#71,#72));\n"
    "#101=PROPERTY_DEFINITION('geometric validation property','volume',#91);\n"
    "#102=PROPERTY_DEFINITION_REPRESENTATION(#101,#103);\n#103=REPRESENTATION('volume',(#104),$);\n"
    "#104=MEASURE_REPRESENTATION_ITEM('volume measure',VOLUME_MEASURE(2.),$);\n"
    "#105=PROPERTY_DEFINITION('geometric validation property','centroid',#91);\n"
    "#106=PROPERTY_DEFINITION_REPRESENTATION(#105,#107);\n#107=REPRESENTATION('c',(#108),$);\n"
    "#108=CARTESIAN_POINT('centre point',(1.,0.5,0.));\n"
    "#111=PRODUCT_DEFINITION_SHAPE('',$,#112);\n#112=PRODUCT_DEFINITION('',$);\n"
    "#113=PROPERTY_DEFINITION('geometric validation property','volume',#111);\n"
    "#114=PROPERTY_DEFINITION_REPRESENTATION(#113,#103);\n";

TEST(Surgical, RecomputesStatedMeasuresOfTheOnlySolid) {
  const Part21File file("f.step", with_data(std::string(kData) + kMeasures));
  SurgicalEdit edit = corner_edit();
  edit.measures = {true, 1.25, 1.0, {0, 0, 0.125}};
  const SurgicalText result = edit_text(file, edit);
  EXPECT_THAT(result.text, HasSubstr("VOLUME_MEASURE(2.5)"));
  EXPECT_THAT(result.text, HasSubstr("'centre point',(1.,0.5,0.125)"));
  EXPECT_THAT(result.notices, ::testing::ElementsAre(HasSubstr("3 stated volumes")));
}

TEST(Surgical, DropsStatedMeasuresOfEditedPartsOnly) {
  const Part21File file("f.step", with_data(std::string(kData) + kMeasures));
  const SurgicalText result = edit_text(file, corner_edit());
  const auto has = [&](const std::string& text) {
    return result.text.find(text) != std::string::npos;
  };
  EXPECT_FALSE(has("#102=")) << result.text;
  EXPECT_FALSE(has("#106="));
  EXPECT_TRUE(has("\n#114=PROPERTY_DEFINITION_REPRESENTATION(#113,#103);\n"));
  EXPECT_TRUE(has("VOLUME_MEASURE(2.)"));
  EXPECT_THAT(result.notices,
              ::testing::ElementsAre(HasSubstr("2 stated volumes, areas or centroids")));
}

TEST(Surgical, SaysThatTrianglesStay) {
  const Part21File file(
      "f.step", with_data(std::string(kData) + "#99=TESSELLATED_SOLID('',(#98),$);\n#98=X();\n"));
  EXPECT_THAT(edit_text(file, corner_edit()).notices,
              ::testing::ElementsAre(HasSubstr("the file also has triangles (1 ")));
}

TEST(Surgical, NothingMovedIsTheFile) {
  const Part21File file("f.step", with_data(kData));
  EXPECT_EQ(edit_text(file, {}).text, file.text());
}

}  // namespace
}  // namespace isochor::internal
