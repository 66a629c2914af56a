// The pictures that commands write: an edit, a model, a comparison.
//
// Sizes are in pixels; a height of 0 takes what the content needs. Meshes may come from patches
// (tessellate.h) and from elsewhere (analytic faces); append them before. The same input always
// gives the same picture, bit for bit.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isochor/io/image.h"
#include "isochor/io/mesh.h"

namespace isochor {

struct PictureSize {
  int width = 1800;
  int height = 0;
};

// Where to look, beside the three-quarter view that is used otherwise.
struct Focus {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // outward
};

struct PictureInput {
  Mesh before, after;  // the same triangles
  std::vector<LineSet> before_lines, after_lines;
  std::vector<std::pair<Vec3, Vec3>> moves;  // what the user pulled: from, to
  std::optional<Focus> focus;
  std::string title;
  std::vector<std::string> caption;  // "volume before 12.5 m³", ...
  std::string unit;
  Vec3 up = Vec3::UnitZ();
};

// Before | after | displacement along the normal before, all seen alike; a close-up of each is
// added where the moved part is small. Views of long models stand one above the other.
// Throws PreconditionError when the meshes do not correspond or the size is too small.
Image edit_picture(const PictureInput& input, const PictureSize& size = {});

struct ModelPictureInput {
  Mesh mesh;
  std::vector<LineSet> lines;
  std::optional<Focus> focus;
  std::string title;
  std::vector<std::string> caption;
  Vec3 up = Vec3::UnitZ();
};

// One shaded view.
Image model_picture(const ModelPictureInput& input, const PictureSize& size = {1200, 0});

struct DeviationPictureInput {
  Mesh mesh;  // scalars: the signed distance to the other model, outward positive
  std::vector<LineSet> lines;
  std::optional<Focus> focus;
  std::string title;
  std::vector<std::string> caption;
  std::string unit;
  Vec3 up = Vec3::UnitZ();
};

// The heat map of the scalars from the front and from behind.
Image deviation_picture(const DeviationPictureInput& input, const PictureSize& size = {});

// (after - before) . normal before, one a position. The meshes have the same positions in the same
// order, and `before` has normals.
std::vector<double> normal_displacement(const Mesh& before, const Mesh& after);

}  // namespace isochor
