#include "isochor/edit/mirror.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace isochor {
namespace {

TEST(MirrorImages, PairsAreMutual) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Vec3> places;
  for (int k = 0; k < 200; ++k) {
    const Vec3 p(value(random), value(random) + 1.5, value(random));
    places.push_back(p);
    places.emplace_back(p.x(), -p.y(), p.z());
  }
  places.emplace_back(0.3, 0.0, 0.1);  // on the plane
  std::shuffle(places.begin(), places.end(), random);
  const std::vector<int> image = mirror_images(places, 1, 1e-9);
  for (size_t i = 0; i < places.size(); ++i) {
    ASSERT_GE(image[i], 0);
    EXPECT_EQ(image[static_cast<size_t>(image[i])], static_cast<int>(i));
    const Vec3 q = places[static_cast<size_t>(image[i])];
    EXPECT_LE((Vec3(q.x(), -q.y(), q.z()) - places[i]).norm(), 1e-9);
  }
}

TEST(MirrorImages, LonelyPlacesHaveNone) {
  const std::vector<Vec3> places = {{1, 2, 3}, {1, -2, 3.1}, {0, 0, 0}};
  const std::vector<int> image = mirror_images(places, 1, 0.05);
  EXPECT_EQ(image, (std::vector<int>{-1, -1, 2}));
  EXPECT_EQ(mirror_images(places, 1, 0.2)[0], 1);
}

TEST(MirrorImages, CrowdedPlacesAreUsedOnce) {
  const std::vector<Vec3> places = {{0, 1, 0}, {0, -1, 0}, {0, 1, 1e-7}, {0, -1, 1e-7}};
  const std::vector<int> image = mirror_images(places, 1, 1e-3);
  EXPECT_EQ(image, (std::vector<int>{1, 0, 3, 2}));
}

// Faces cut from one surface lie on each other: each must be mirrored onto itself where it can.
TEST(MirrorImages, AreSoughtInTheOwnGroupFirst) {
  const std::vector<Vec3> places = {{1, 2, 0},  {1, 2, 0}, {1, -2, 0},
                                    {1, -2, 0}, {3, 1, 0}, {3, -1, 0}};
  const std::vector<int> image = mirror_images(places, 1, 1e-6, {7, 8, 8, 7, 1, 2});
  EXPECT_EQ(image, (std::vector<int>{3, 2, 1, 0, 5, 4})) << "else in any";
}

}  // namespace
}  // namespace isochor
