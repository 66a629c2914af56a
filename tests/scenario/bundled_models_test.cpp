// The committed files of data/step: reproduced by their generator, smooth where they say so, and
// with the volumes that their README gives. No CAD kernel takes part.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "isochor/bspline/patch_model.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "scenario/step_entities.h"

namespace isochor {
namespace {

namespace fs = std::filesystem;
using testing::entities_named;
using testing::read_text;
using testing::step_curve;
using testing::step_entities;
using testing::step_surface;

const std::string kFolder = std::string(ISOCHOR_SOURCE_DIR) + "/data/step/";
const char* const kStepFiles[] = {"fuselage.step", "fuselage12.step", "hull.step", "cube.step",
                                  "patchwork.step"};

using Entities = std::map<int, std::string>;

Entities entities_of(const std::string& file) { return step_entities(read_text(kFolder + file)); }

// All B-spline surfaces of a file as patches of one model. A surface that several faces share
// counts once: together those faces cover all of it. `turned` permutes (x, y, z) to (z, x, y).
PatchModel surfaces_of(const Entities& entities, bool turned) {
  PatchModel model;
  for (int number : entities_named(entities, "B_SPLINE_SURFACE_WITH_KNOTS")) {
    const Surface surface = step_surface(entities, number);
    Patch patch{
        "", "#" + std::to_string(number), surface.u_knots(), surface.v_knots(), {}, {}, false, {},
        {}};
    for (const auto& [face, text] : entities) {
      const std::string used = ",#" + std::to_string(number) + ",.F.)";
      if (text.rfind("ADVANCED_FACE(", 0) == 0 && text.find(used) != std::string::npos) {
        patch.reversed = true;
      }
    }
    for (const Vec3& p : surface.poles()) {
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.push_back(turned ? Vec3(p.z(), p.x(), p.y()) : p);
    }
    model.patches.push_back(patch);
  }
  return model;
}

// The integral of y dz dx over the skins is the whole volume: on the flat faces of all these solids
// dx is zero, or dz is a multiple of dx.
Rational exact_volume(const std::string& file) {
  const PatchModel model = surfaces_of(entities_of(file), true);
  return ExactVolume(model).value(model.points);
}

// The volume of `file` in the README's table, as the decimal number that stands there.
Rational documented_volume(const std::string& file) {
  const std::string readme = read_text(kFolder + "README.md");
  const size_t row = readme.find("| `" + file + "` |");
  EXPECT_NE(row, std::string::npos) << file;
  std::string cell = readme.substr(row, readme.find('\n', row) - row);
  // The volume is the second cell from the right.
  cell = cell.substr(0, cell.rfind('|', cell.rfind('|') - 1));
  cell = cell.substr(cell.rfind('|') + 1);
  cell.erase(std::remove(cell.begin(), cell.end(), ' '), cell.end());
  return Rational::parse(cell);
}

TEST(BundledModels, AreWhatTheirGeneratorWrites) {
  const fs::path folder =
      fs::temp_directory_path() / ("isochor-make-data-" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string command =
      std::string("\"") + ISOCHOR_MAKE_DATA + "\" \"" + folder.string() + "\" > /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(read_text(entry.path().string()) == read_text(kFolder + name)) << name;
    ++files;
  }
  EXPECT_EQ(files, 11);
  fs::remove_all(folder);
}

TEST(BundledModels, HaveTheDocumentedVolumes) {
  for (const char* file : kStepFiles) {
    const Rational error = exact_volume(file) - documented_volume(file);
    // Half a unit of the twentieth decimal, the last one that is given.
    EXPECT_TRUE(error.abs() <= Rational::parse("0.000000000000000000005"))
        << file << ": " << exact_volume(file).to_string();
  }
  EXPECT_EQ(exact_volume("cube.step").to_string(), "1");
  EXPECT_EQ(exact_volume("patchwork.step").to_string(), "1");
}

TEST(BundledModels, HalfAHullIsHalfOfTheHull) {
  const Rational half = exact_volume("half_hull.step");
  EXPECT_EQ((half + half).to_string(), exact_volume("hull.step").to_string());
}

// Second method: z dx dy by Gauss over the skins, and over the flat faces by Green's theorem.
TEST(BundledModels, HaveTheSameVolumeByQuadratureAlongAnotherAxis) {
  for (const char* file : kStepFiles) {
    const Entities entities = entities_of(file);
    const PatchModel model = surfaces_of(entities, false);
    double volume = VolumeForm(model).value(model.points);
    if (std::string(file) == "hull.step") {
      // The deck z = a + b x over the area between the two deck edges y = +-y(x): the inner
      // integral over x of a + b x is a x + b x^2 / 2, and y runs along the edges.
      const Surface skin =
          step_surface(entities, entities_named(entities, "B_SPLINE_SURFACE_WITH_KNOTS").front());
      const int last = skin.v_size() - 1;
      const double a = skin.pole(0, last).z();
      const double b = (skin.pole(skin.u_size() - 1, last).z() - a) /
                       (skin.pole(skin.u_size() - 1, last).x() - skin.pole(0, last).x());
      // Simpson's rule, 400 steps a span: its error is far below that of rounding.
      double half = 0.0;
      const int steps = 400 * 24;
      const double end = skin.u_knots().end(), step = end / steps;
      for (int k = 0; k <= 2 * steps; ++k) {
        const double weight = k % 2 == 1 ? 4.0 : k == 0 || k == 2 * steps ? 1.0 : 2.0;
        const auto d = skin.derivatives(0.5 * k * step, skin.v_knots().end(), 1);
        half += weight / 6.0 * step * (a + b * d.s.x()) * -d.s.y() * d.su.x();
      }
      volume += 2.0 * half;
    }
    EXPECT_NEAR(volume, exact_volume(file).to_double(), 1e-13 * volume) << file;
  }
}

// Two graphs over x and y: the block under the skin, and what the canopy adds between the parabolas
// where they meet.
TEST(BundledModels, CanopyHasTheDocumentedVolume) {
  const Entities entities = entities_of("canopy.step");
  const auto numbers = entities_named(entities, "B_SPLINE_SURFACE_WITH_KNOTS");
  ASSERT_EQ(numbers.size(), 4u);
  const Surface skin = step_surface(entities, numbers[0]);
  const Surface canopy = step_surface(entities, numbers[1]);
  PatchModel block = surfaces_of(entities, false);
  block.patches.erase(block.patches.begin() + 1, block.patches.end());
  const double under_skin = VolumeForm(block).value(block.points) + 8.0 * 3.0;  // floor z = -1
  // Simpson's rule is exact in y (degree 2); in x the integrand has degree 6.
  double added = 0.0;
  constexpr int kSteps = 4000;
  for (int k = 0; k <= 2 * kSteps; ++k) {
    const double x = -2.0 + 4.0 * k / (2 * kSteps), half = (4.0 - x * x) / 8.0;
    const auto height = [&](double y) {
      const Vec3 above = canopy.point(x, y), below = skin.point(x, y);
      EXPECT_NEAR(above.x(), below.x(), 1e-14);
      EXPECT_NEAR(above.y(), below.y(), 1e-14);
      return above.z() - below.z();
    };
    EXPECT_NEAR(height(half), 0.0, 1e-14);
    EXPECT_NEAR(height(-half), 0.0, 1e-14);
    const double weight = k % 2 == 1 ? 4.0 : k == 0 || k == 2 * kSteps ? 1.0 : 2.0;
    added += weight * height(0.0) * half * 4.0 / 3.0;
  }
  added *= 4.0 / kSteps / 6.0;
  EXPECT_NEAR(added, 64.0 / 105.0, 1e-11);
  // The mast: the area of its curve times its height. Each parabola cuts off two thirds of its
  // triangle beyond the square of the arcs' ends.
  const double mast = 0.75 * (10.0 / 3.0) * 0.25 * 0.25;
  EXPECT_NEAR(under_skin + added + mast, documented_volume("canopy.step").to_double(), 1e-11);
}

TEST(BundledModels, CubeJsonHasThePointsOfTheStepFile) {
  std::set<std::array<double, 3>> in_step;
  for (const Vec3& p : surfaces_of(entities_of("cube.step"), false).points) {
    in_step.insert({p.x(), p.y(), p.z()});
  }
  EXPECT_EQ(in_step.size(), 15u * 15u * 15u - 13u * 13u * 13u);
  std::string json = read_text(kFolder + "cube.isochor.json");
  size_t at = json.find("\"points\"");
  std::set<std::array<double, 3>> in_json;
  const size_t end = json.find("\"patches\"");
  for (at = json.find("  [", at); at < end; at = json.find("  [", at + 1)) {
    std::array<double, 3> p;
    const char* text = json.c_str() + at + 3;
    for (double& value : p) {
      char* next = nullptr;
      value = std::strtod(text, &next);
      text = next + 1;
    }
    in_json.insert(p);
  }
  EXPECT_TRUE(in_json == in_step);
}

// Twelve surfaces, part by part, each part left, top, right, bottom.
std::vector<Surface> twelve_patches() {
  const Entities entities = entities_of("fuselage12.step");
  std::vector<Surface> patches;
  for (int number : entities_named(entities, "B_SPLINE_SURFACE_WITH_KNOTS")) {
    patches.push_back(step_surface(entities, number));
  }
  return patches;
}

TEST(BundledModels, TwelvePatchesMeetWithProportionalDerivativesExactly) {
  const auto patches = twelve_patches();
  ASSERT_EQ(patches.size(), 12u);
  for (int part = 0; part < 3; ++part) {
    for (int q = 0; q < 4; ++q) {
      const Surface &a = patches[4 * part + q], &b = patches[4 * part + (q + 1) % 4];
      const int last = a.v_size() - 1;
      ASSERT_EQ(a.u_knots(), b.u_knots());
      for (int i = 0; i < a.u_size(); ++i) {
        EXPECT_EQ(a.pole(i, last), b.pole(i, 0));
        EXPECT_EQ(a.pole(i, last) - a.pole(i, last - 1), b.pole(i, 1) - b.pole(i, 0));
      }
      if (part == 2) continue;
      const Surface& rear = patches[4 * (part + 1) + q];
      const int end = a.u_size() - 1;
      const double ratio = part == 0 ? 0.75 : 1.0;
      for (int j = 0; j < a.v_size(); ++j) {
        EXPECT_EQ(a.pole(end, j), rear.pole(0, j));
        EXPECT_EQ(a.pole(end, j) - a.pole(end - 1, j), ratio * (rear.pole(1, j) - rear.pole(0, j)));
      }
    }
  }
}

TEST(BundledModels, TwelvePatchesAreNotCurvatureContinuous) {
  const auto patches = twelve_patches();
  const Surface &a = patches[4], &b = patches[5];
  const auto before = a.derivatives(3.0, a.v_knots().end(), 2);
  const auto after = b.derivatives(3.0, 0.0, 2);
  EXPECT_GT((before.svv - after.svv).norm(), 1e-6);
}

TEST(BundledModels, WindowEdgesLieOnTheSkin) {
  const Entities entities = entities_of("fuselage.step");
  const auto surfaces = entities_named(entities, "B_SPLINE_SURFACE_WITH_KNOTS");
  ASSERT_EQ(surfaces.size(), 1u) << "windows and skin share one surface";
  const Surface skin = step_surface(entities, surfaces[0]);
  int corners = 0;
  for (int number : entities_named(entities, "SURFACE_CURVE")) {
    const std::string& text = entities.at(number);
    const int curve_number = std::stoi(text.substr(text.find('#') + 1));
    const auto curve = step_curve(entities, curve_number);
    if (curve.knots.degree() != 12) continue;
    ++corners;
    // SURFACE_CURVE -> PCURVE -> DEFINITIONAL_REPRESENTATION -> parabola.
    const auto last_reference = [&](int from, const char* mark) {
      const std::string& body = entities.at(from);
      return std::stoi(body.substr(body.find(mark) + std::string(mark).size()));
    };
    const int pcurve = last_reference(number, "(#");
    const int representation =
        std::stoi(entities.at(pcurve).substr(entities.at(pcurve).rfind('#') + 1));
    const auto flat = step_curve(entities, last_reference(representation, "(#"));
    ASSERT_EQ(flat.poles.size(), 3u);
    for (double t : {0.0, 0.1, 0.37, 0.5, 0.81, 1.0}) {
      Vec3 on_curve = Vec3::Zero(), at = Vec3::Zero();
      const BasisValues b = evaluate_basis(curve.knots, t), c = evaluate_basis(flat.knots, t);
      for (int k = 0; k <= 12; ++k) on_curve += b.value(0, k) * curve.poles[k];
      for (int k = 0; k <= 2; ++k) at += c.value(0, k) * flat.poles[k];
      EXPECT_LT((skin.point(at.x(), at.y()) - on_curve).norm(), 1e-13);
    }
  }
  EXPECT_EQ(corners, 24 * 4);
}

}  // namespace
}  // namespace isochor
