#include "isochor/step/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "step/shapes.h"
#include "step/temp_folder.h"
#include "support/models.h"
#include "support/revolved.h"

namespace isochor {
namespace {

using internal::load_document;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string write(internal::Document document, const TempFolder& folder, const std::string& name) {
  write_document(document, folder.file(name));
  return folder.file(name);
}

TEST(Convert, EveryPairOfFormatsKeepsTheShape) {
  const TempFolder folder;
  write(shapes::document_of(shapes::bicubic_cube(3.7), "inch"), folder, "a.step");
  const char* names[] = {"a.step", "b.igs", "c.brep", "d.igs", "e.step"};
  for (size_t k = 1; k < std::size(names); ++k) {
    const auto report = convert_file(folder.file(names[k - 1]), folder.file(names[k]));
    ASSERT_TRUE(report.written) << names[k] << ": " << report.refusal;
    EXPECT_EQ(report.faces_identical, 6) << names[k];
    EXPECT_EQ(report.faces_bspline_untouched, 6) << names[k];
    EXPECT_TRUE(report.reread.valid && report.reread.closed) << names[k];
  }
  EXPECT_EQ(load_document(folder.file("b.igs")).unit.name, "inch");
}

TEST(Convert, LinesAreCopiedUnlessTheFileIsToBeWrittenAnew) {
  const TempFolder folder;
  const std::string file = write(shapes::assembly("foot"), folder, "pair.step");
  const auto copied = convert_file(file, folder.file("copy.step"));
  ASSERT_TRUE(copied.written) << copied.refusal;
  EXPECT_EQ(copied.written_by, "line by line");
  const auto anew = convert_file(file, folder.file("anew.step"), {}, {}, true);
  ASSERT_TRUE(anew.written) << anew.refusal;
  EXPECT_EQ(anew.written_by, "OpenCASCADE");
  EXPECT_EQ(anew.reread.names, anew.before.names);
  EXPECT_EQ(anew.faces_identical, anew.faces_bspline_untouched);
}

TEST(Convert, CylindersAndAssembliesStayWhereTheyWere) {
  const TempFolder folder;
  write(shapes::assembly("foot"), folder, "pair.step");
  const auto report = convert_file(folder.file("pair.step"), folder.file("again.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.reread.names, report.before.names);
  EXPECT_EQ(report.reread.coloured, report.before.coloured);
  EXPECT_LE(report.analytic_ulps, 4.0);
  EXPECT_EQ(load_document(folder.file("again.step")).unit.name, "foot");
}

TEST(Convert, WhatAFormatCannotCarryIsSaid) {
  const TempFolder folder;
  write(shapes::assembly("inch"), folder, "pair.step");
  const auto brep = convert_file(folder.file("pair.step"), folder.file("pair.brep"));
  ASSERT_TRUE(brep.written) << brep.refusal;
  EXPECT_THAT(brep.notices, Contains(HasSubstr("no names")));
  EXPECT_THAT(brep.notices, Contains(HasSubstr("numbers are in inch")));
  const auto step = convert_file(folder.file("pair.brep"), folder.file("again.step"));
  ASSERT_TRUE(step.written) << step.refusal;
  EXPECT_THAT(step.notices, Contains(HasSubstr("states no length unit")));
}

TEST(Convert, UnitsThatCannotBeWrittenAreRefused) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube(), "inch");
  write_document(cube, folder.file("inch.step"));
  std::ifstream in(folder.file("inch.step"));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const size_t at = text.find("2.5399999999999999E+01");
  ASSERT_NE(at, std::string::npos);
  folder.write("odd.step", text.replace(at, 22, "7.5E+00"));
  const auto iges = convert_file(folder.file("odd.step"), folder.file("out.igs"));
  EXPECT_THAT(iges.refusal, HasSubstr("length unit of 7.5 mm"));
  const auto brep = convert_file(folder.file("odd.step"), folder.file("out.brep"));
  EXPECT_TRUE(brep.written) << brep.refusal;
  EXPECT_EQ(brep.faces_identical, 6);
}

TEST(Convert, StepToStepCopiesEveryByte) {
  const TempFolder folder;
  auto cube = shapes::document_of(shapes::bicubic_cube(), "foot");
  write_document(cube, folder.file("in.step"));
  const auto text_of = [&](const std::string& name) {
    std::ifstream in(folder.file(name), std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  const auto report = convert_file(folder.file("in.step"), folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_EQ(report.written_by, "line by line");
  EXPECT_EQ(report.lines_appended + report.lines_repointed, 0);
  EXPECT_EQ(text_of("in.step"), text_of("out.step"));
}

TEST(Convert, ErrorsNameTheFile) {
  const TempFolder folder;
  EXPECT_THROW(convert_file(folder.file("no.step"), folder.file("out.brep")), InputError);
  EXPECT_THROW(convert_file(folder.write("bad.step", "x"), folder.file("out.brep")), InputError);
  EXPECT_EQ(folder.file_count(), 1);
}

// A cube of six bilinear patches over eight shared points.
PatchModel cube_model() {
  PatchModel model;
  model.unit = "inch";
  for (int k = 0; k < 8; ++k) model.points.emplace_back(0.1 * (k & 1), (k >> 1) & 1, (k >> 2) & 1);
  const auto line = KnotVector::uniform(1, 1);
  const int sides[6][4] = {{0, 4, 2, 6}, {1, 3, 5, 7}, {0, 1, 4, 5},
                           {2, 6, 3, 7}, {0, 2, 1, 3}, {4, 5, 6, 7}};
  for (int q = 0; q < 6; ++q) {
    Patch patch{"side " + std::to_string(q),
                "face:" + std::to_string(q + 1),
                line,
                line,
                {sides[q], sides[q] + 4},
                {},
                q % 2 == 1,
                {},
                {}};
    model.patches.push_back(patch);
  }
  return model;
}

TEST(Convert, PatchModelsBecomeSolids) {
  const TempFolder folder;
  const auto report = write_patch_model(cube_model(), "cube", folder.file("cube.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_TRUE(report.reread.valid && report.reread.closed);
  EXPECT_EQ(report.reread.solids, 1);
  EXPECT_NEAR(report.reread.volume, 0.1, 1e-15);
  EXPECT_EQ(report.faces_identical, 6);
  const auto document = load_document(folder.file("cube.step"));
  EXPECT_EQ(document.unit.name, "inch");
  EXPECT_THAT(report.reread.names, ::testing::IsSupersetOf({"side 0", "side 5"}));
}

// A patch that meets nothing but itself is a solid too.
TEST(Convert, OnePatchThatClosesOnItselfBecomesASolid) {
  const TempFolder folder;
  const double pi = std::acos(-1.0);
  const std::vector<std::pair<PatchModel, double>> bodies = {
      {testing::make_rational_torus(3.0, 1.0), 6.0 * pi * pi},
      {testing::make_sphere(1.0), 4.0 / 3.0 * pi}};
  for (const auto& [body, volume] : bodies) {
    const auto report = write_patch_model(body, "body", folder.file("body.step"));
    ASSERT_TRUE(report.written) << report.refusal;
    EXPECT_TRUE(report.reread.valid && report.reread.closed);
    EXPECT_EQ(report.reread.solids, 1);
    EXPECT_NEAR(report.reread.volume, volume, 1e-12 * volume);
  }
}

TEST(Convert, OpenPatchModelsStayOpen) {
  const TempFolder folder;
  auto model = cube_model();
  model.patches.pop_back();
  const auto report = write_patch_model(model, "box", folder.file("box.brep"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_FALSE(report.reread.closed);
  EXPECT_EQ(report.reread.free_edges, 4);
}

TEST(Convert, UnusablePatchModelsAreNamed) {
  const TempFolder folder;
  auto model = cube_model();
  model.unit = "furlong";
  EXPECT_THROW(write_patch_model(model, "m", folder.file("o.step")), InputError);
  model = cube_model();
  for (auto& p : model.points) p = Vec3(1, 1, 1);
  EXPECT_THROW(write_patch_model(model, "m", folder.file("o.step")), InputError);
  EXPECT_THROW(write_patch_model({}, "m", folder.file("o.step")), InputError);
  EXPECT_EQ(folder.file_count(), 0);
}

TEST(Convert, OnlyWholeBSplineFacesBecomePatches) {
  SolidModel solid;
  solid.path = "part.step";
  solid.unit = "foot";
  solid.patches = cube_model();
  solid.patches.lock(0, "why", false);
  for (int f = 0; f < 6; ++f) {
    FaceFacts face;
    face.handle = "face:" + std::to_string(f + 1);
    face.trim = TrimKind::kNatural;
    face.patch = f;
    solid.faces.push_back(face);
  }
  const PatchModel model = whole_patches(solid);
  EXPECT_EQ(model.unit, "foot");
  EXPECT_EQ(model.patches.size(), 6u);
  EXPECT_TRUE(model.locks.empty());
  solid.faces[2].trim = TrimKind::kTrimmed;
  try {
    whole_patches(solid);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("part.step: face:3"));
    EXPECT_THAT(e.what(), HasSubstr("trimmed"));
  }
  solid.faces[2].patch = -1;
  solid.faces[2].surface = "plane";
  EXPECT_THROW(whole_patches(solid), InputError);
}

}  // namespace
}  // namespace isochor
