#include "isochor/picture/edit_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/picture/tessellate.h"
#include "support/models.h"

namespace isochor {
namespace {

// A cube whose top is pulled up around `at` within `radius`.
PictureInput pulled_cube(const Vec3& at, double radius, double height, double stretch = 1.0) {
  PatchModel cube = testing::make_cube_model(2, 12);
  for (Vec3& p : cube.points) p.x() *= stretch;
  std::vector<Vec3> after = cube.points;
  for (Vec3& p : after) {
    const double d = (p - at).norm() / radius;
    if (d < 1.0) p.z() += height * (1.0 - d * d) * (1.0 - d * d);
  }
  const Tessellator cut(cube, {}, {after});
  PictureInput input;
  input.before = cut.mesh();
  input.after = cut.mesh(after);
  input.before_lines = cut.borders();
  input.after_lines = cut.borders(after);
  input.focus = Focus{at, Vec3::UnitZ()};
  input.moves = {{at, at + Vec3(0, 0, height)}};
  input.title = "pulled cube";
  input.caption = {"volume before 1 m³", "volume after 1.02 m³"};
  input.unit = "m";
  return input;
}

int count_reddish(const Image& image, int x0, int x1, int y0, int y1) {
  int count = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      // The arrows are orange: their green is well above their blue.
      count += p[0] > p[2] + 50 && p[1] < p[2] + 15;
    }
  }
  return count;
}

TEST(NormalDisplacement, IsPositiveOutwards) {
  const PictureInput input = pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25);
  const std::vector<double> values = normal_displacement(input.before, input.after);
  double largest = -1.0, least = 1.0;
  for (double v : values) largest = std::max(largest, v), least = std::min(least, v);
  EXPECT_NEAR(largest, 0.25, 0.03);
  EXPECT_GE(least, -1e-12);
  const std::vector<double> back = normal_displacement(input.after, input.before);
  EXPECT_LT(*std::min_element(back.begin(), back.end()), -0.2);
  Mesh shorter = input.after;
  shorter.positions.pop_back();
  EXPECT_THROW(normal_displacement(input.before, shorter), PreconditionError);
}

TEST(EditPicture, TheHeatMapStandsInTheThirdColumn) {
  const Image image = edit_picture(pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25), {900, 0});
  EXPECT_EQ(image.width, 900);
  const int panels = image.height - 100;  // the legend is below
  EXPECT_LT(count_reddish(image, 0, 600, 50, panels), 20);
  EXPECT_GT(count_reddish(image, 600, 900, 50, panels), 1000);
}

TEST(EditPicture, IsDeterministicToTheBit) {
  const PictureInput input = pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25);
  EXPECT_EQ(edit_picture(input, {500, 0}), edit_picture(input, {500, 0}));
}

TEST(EditPicture, SmallRegionsGetACloseUp) {
  const Image large = edit_picture(pulled_cube(Vec3(0.5, 0.5, 1.0), 0.9, 0.25), {600, 0});
  const Image small = edit_picture(pulled_cube(Vec3(0.5, 0.5, 1.0), 0.2, 0.05), {600, 0});
  EXPECT_GT(small.height, large.height + 100);
}

TEST(EditPicture, LongModelsAreStacked) {
  const Image longer = edit_picture(pulled_cube(Vec3(4.0, 0.5, 1.0), 2.5, 0.4, 8.0), {900, 0});
  const int third = (longer.height - 150) / 3;
  EXPECT_LT(count_reddish(longer, 0, 900, 50, 50 + third), 20);
  EXPECT_GT(count_reddish(longer, 0, 900, longer.height - 100 - third, longer.height - 100), 500);
}

TEST(EditPicture, AskedHeightIsGiven) {
  const PictureInput input = pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25);
  EXPECT_EQ(edit_picture(input, {800, 500}).height, 500);
  EXPECT_EQ(edit_picture(input, {800, 700}).height, 700);
}

TEST(EditPicture, NothingMovedIsStillAPicture) {
  PictureInput input = pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.0);
  input.focus.reset();
  input.moves.clear();
  const Image image = edit_picture(input, {500, 0});
  EXPECT_LT(count_reddish(image, 333, 500, 50, image.height - 100), 20);
}

TEST(EditPicture, MeshesThatDoNotCorrespondAreRefused) {
  PictureInput input = pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25);
  std::swap(input.after.triangles.front()[0], input.after.triangles.front()[1]);
  EXPECT_THROW(edit_picture(input), PreconditionError);
  EXPECT_THROW(edit_picture(PictureInput()), PreconditionError);
  EXPECT_THROW(edit_picture(pulled_cube(Vec3(0.5, 0.5, 1.0), 0.6, 0.25), {50, 0}),
               PreconditionError);
}

TEST(ModelPicture, ShowsTheModelInTheMiddle) {
  ModelPictureInput input;
  input.mesh = tessellate(testing::make_sphere(1.0));
  const Image image = model_picture(input, {400, 0});
  const std::uint8_t* middle = image.pixel(200, image.height / 2 - 10);
  EXPECT_LT(middle[0], 215) << "the sphere is darker than the background";
  EXPECT_EQ(image, model_picture(input, {400, 0}));
}

TEST(DeviationPicture, NeedsScalarsAndShowsThem) {
  DeviationPictureInput input;
  input.mesh = tessellate(testing::make_sphere(1.0));
  EXPECT_THROW(deviation_picture(input, {400, 0}), PreconditionError);
  for (const Vec3& p : input.mesh.positions) input.mesh.scalars.push_back(p.x());
  const Image image = deviation_picture(input, {500, 0});
  EXPECT_GT(count_reddish(image, 0, 500, 40, image.height - 100), 1000);
}

}  // namespace
}  // namespace isochor
