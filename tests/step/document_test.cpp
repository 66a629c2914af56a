#include "isochor/step/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "isochor/step/file_surface.h"
#include "step/shapes.h"
#include "step/temp_folder.h"

namespace isochor {
namespace {

using internal::Document;
using internal::load_document;
using internal::write_document;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// All poles, knots and weights of the B-spline faces, in face order, as doubles.
std::vector<double> spline_numbers(const Document& document) {
  std::vector<double> numbers;
  for (int f = 0; f < document.face_count(); ++f) {
    const auto face = document.face(f);
    TopLoc_Location where;
    auto spline = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(face, where));
    if (spline.IsNull()) continue;
    spline = Handle(Geom_BSplineSurface)::DownCast(spline->Copy());
    if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
    for (int i = 1; i <= spline->NbUPoles(); ++i) {
      for (int j = 1; j <= spline->NbVPoles(); ++j) {
        const gp_Pnt p = spline->Pole(i, j);
        numbers.insert(numbers.end(), {p.X(), p.Y(), p.Z(), spline->Weight(i, j)});
      }
    }
    for (int i = 1; i <= spline->NbUKnots(); ++i) numbers.push_back(spline->UKnot(i));
    for (int j = 1; j <= spline->NbVKnots(); ++j) numbers.push_back(spline->VKnot(j));
  }
  return numbers;
}

std::string error_of(const std::string& path) {
  try {
    load_document(path);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

class StepUnits : public ::testing::TestWithParam<const char*> {};

TEST_P(StepUnits, RoundTripsKeepEveryBitOfBSplineFaces) {
  const TempFolder folder;
  for (const auto& shape :
       {TopoDS_Shape(shapes::bicubic_cube(3.7)), TopoDS_Shape(shapes::holed_cube())}) {
    auto before = shapes::document_of(shape, GetParam());
    const std::string path = folder.file("part.step");
    write_document(before, path);
    const Document after = load_document(path);
    EXPECT_EQ(after.unit.name, GetParam());
    EXPECT_EQ(after.face_count(), before.face_count());
    EXPECT_EQ(spline_numbers(after), spline_numbers(before));
    EXPECT_TRUE(BRepCheck_Analyzer(after.shape).IsValid());
  }
}
INSTANTIATE_TEST_SUITE_P(All, StepUnits, ::testing::Values("mm", "cm", "m", "inch", "foot", "um"));

class IgesUnits : public ::testing::TestWithParam<const char*> {};

TEST_P(IgesUnits, RoundTripsKeepEveryBitOfBSplineFaces) {
  const TempFolder folder;
  auto before = shapes::document_of(shapes::bicubic_cube(3.7), GetParam());
  const std::string path = folder.file("part.igs");
  write_document(before, path);
  const Document after = load_document(path);
  EXPECT_EQ(after.unit.name, GetParam());
  EXPECT_EQ(spline_numbers(after), spline_numbers(before));
  EXPECT_TRUE(BRepCheck_Analyzer(after.shape).IsValid());
}
INSTANTIATE_TEST_SUITE_P(All, IgesUnits, ::testing::Values("mm", "m", "inch"));

TEST(Document, BrepRoundTripsKeepEveryBit) {
  const TempFolder folder;
  auto before = shapes::document_of(shapes::barrel(true));
  write_document(before, folder.file("part.brep"));
  const Document after = load_document(folder.file("part.brep"));
  EXPECT_EQ(spline_numbers(after), spline_numbers(before));
  EXPECT_FALSE(after.unit.stated);
  EXPECT_TRUE(after.xde.IsNull());
}

TEST(Document, ShapesOfTheTestsAreValid) {
  for (const auto& shape : {TopoDS_Shape(shapes::bicubic_cube()), shapes::holed_cube(),
                            TopoDS_Shape(shapes::barrel(true)), TopoDS_Shape(shapes::barrel(false)),
                            TopoDS_Shape(shapes::dome()), TopoDS_Shape(shapes::cylinder())}) {
    EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
    EXPECT_TRUE(BRep_Tool::IsClosed(shape) || shape.ShapeType() != TopAbs_SHELL);
  }
}

TEST(FileSurface, TheFilesOwnNumbersAreFoundAndGivenBack) {
  const TempFolder folder;
  auto barrel = shapes::document_of(shapes::barrel(true));
  write_document(barrel, folder.file("in.step"));
  Document document = load_document(folder.file("in.step"));
  auto changed = internal::changed_by_reader(document);
  ASSERT_EQ(changed.size(), 1u) << "the reader makes the closed face periodic";
  auto& [face, surface] = *changed.begin();
  std::vector<Vec3> poles = surface.poles();
  for (auto& p : poles) p.x() = std::nextafter(p.x(), 10.0);
  surface = Surface(surface.u_knots(), surface.v_knots(), poles);
  internal::WriteSettings settings;
  settings.surfaces = changed;
  write_document(document, folder.file("out.step"), settings);
  const Document after = load_document(folder.file("out.step"));
  const auto found = internal::file_surface(after, face);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->poles(), poles);
  EXPECT_TRUE(BRepCheck_Analyzer(after.shape).IsValid());
}

TEST(FileSurface, OtherSizesAndOtherFacesStay) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube());
  internal::WriteSettings settings;
  const auto line = KnotVector::uniform(1, 1);
  settings.surfaces.emplace(0, Surface(line, line, std::vector<Vec3>(4, Vec3(7, 7, 7))));
  write_document(cube, folder.file("out.step"), settings);
  const Document after = load_document(folder.file("out.step"));
  EXPECT_EQ(spline_numbers(after), spline_numbers(cube));
  EXPECT_TRUE(internal::changed_by_reader(after).empty());
  EXPECT_FALSE(internal::file_surface(cube, 0).has_value()) << "not read from a file";
}

TEST(Document, NamesColoursAndStructureSurvive) {
  const TempFolder folder;
  for (const char* unit : {"mm", "inch"}) {
    auto before = shapes::assembly(unit);
    write_document(before, folder.file("pair.step"));
    const Document after = load_document(folder.file("pair.step"));
    EXPECT_EQ(after.face_count(), 6 + 2 * 3);
    EXPECT_EQ(after.name_of(after.face(0)), "lid");
    std::vector<std::string> names;
    for (const auto& entry : after.names) names.push_back(entry.second);
    EXPECT_THAT(names, AllOf(Contains("pair"), Contains("box"), Contains("pin"), Contains("lid")));
    EXPECT_EQ(spline_numbers(after), spline_numbers(before));
  }
}

TEST(Document, MissingEmptyAndForeignFilesAreNamed) {
  const TempFolder folder;
  EXPECT_THAT(error_of(folder.file("no.step")), AllOf(HasSubstr("no.step"), HasSubstr("no such")));
  EXPECT_THAT(error_of(folder.file("a.docx")), HasSubstr("names no CAD format"));
  EXPECT_THAT(error_of(folder.write("e.step", "")), AllOf(HasSubstr("e.step"), HasSubstr("empty")));
  std::filesystem::create_directory(folder.file("d.step"));
  EXPECT_THAT(error_of(folder.file("d.step")), HasSubstr("folder"));
  for (const char* name : {"g.step", "g.igs", "g.brep"}) {
    EXPECT_THAT(error_of(folder.write(name, "garbage\n1 2 3\n")), HasSubstr(name));
  }
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Document, TruncatedFilesAreRefused) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube());
  write_document(cube, folder.file("whole.step"));
  const std::string text = text_of(folder.file("whole.step"));
  for (double part : {0.05, 0.3, 0.9}) {
    const auto size = static_cast<size_t>(part * static_cast<double>(text.size()));
    EXPECT_THAT(error_of(folder.write("cut.step", text.substr(0, size))), HasSubstr("cut.step"))
        << part;
  }
}

TEST(Document, FilesWithoutShapesAreRefused) {
  const TempFolder folder;
  const std::string path = folder.write("none.step",
                                        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
                                        "FILE_NAME('','',(''),(''),'','','');\n"
                                        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
                                        "#1=CARTESIAN_POINT('',(0.,0.,0.));\nENDSEC;\n"
                                        "END-ISO-10303-21;\n");
  EXPECT_THAT(error_of(path), AllOf(HasSubstr("none.step"), HasSubstr("no shape")));
}

TEST(Document, JunkBeforeTheStartIsSkippedAndMentioned) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube(), "inch");
  write_document(cube, folder.file("whole.step"));
  const std::string text = text_of(folder.file("whole.step"));
  const Document junk = load_document(folder.write("junk.step", "\x01 x" + text));
  EXPECT_EQ(spline_numbers(junk), spline_numbers(cube));
  EXPECT_EQ(junk.unit.name, "inch");
  EXPECT_THAT(junk.notices, Contains(HasSubstr("skipped 3 bytes")));
  const Document mark = load_document(folder.write("mark.step", "\xEF\xBB\xBF" + text));
  EXPECT_THAT(mark.notices, ::testing::Not(Contains(HasSubstr("skipped"))));
}

// A unit that is a multiple of another by a number of its own.
TEST(Document, UnitsWithoutANameAreReadUnscaled) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube(), "inch");
  write_document(cube, folder.file("inch.step"));
  std::string text = text_of(folder.file("inch.step"));
  const std::string factor = "LENGTH_MEASURE_WITH_UNIT(2.5399999999999999E+01";
  const size_t at = text.find(factor);
  ASSERT_NE(at, std::string::npos) << "the conversion factor of the inch";
  text.replace(at, factor.size(), "LENGTH_MEASURE_WITH_UNIT(7.5E+00");
  Document odd = load_document(folder.write("odd.step", text));
  EXPECT_EQ(odd.unit.name, "7.5 mm");
  EXPECT_EQ(spline_numbers(odd), spline_numbers(cube));
}

TEST(Document, SchemaAndFormatAreKnown) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube());
  write_document(cube, folder.file("a.STP"));
  const Document after = load_document(folder.file("a.STP"));
  EXPECT_THAT(after.schema, HasSubstr("AP242"));
  EXPECT_STREQ(name_of(after.format), "STEP");
}

}  // namespace
}  // namespace isochor
