#include <algorithm>

#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/image.h"
#include "isochor/io/mesh_obj.h"
#include "isochor/picture/deviation.h"
#include "isochor/picture/edit_picture.h"
#include "isochor/picture/tessellate.h"
#include "model_picture.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// When the two models have the same patches the vertices correspond, and the deviation is that of
// corresponding points along the normal: exact, and no search.
bool correspond(const PatchModel& a, const PatchModel& b) {
  if (a.patches.empty() || a.patches.size() != b.patches.size()) return false;
  for (size_t q = 0; q < a.patches.size(); ++q) {
    const Patch& p = a.patches[q];
    const Patch& r = b.patches[q];
    if (p.handle != r.handle || p.u_knots.begin() != r.u_knots.begin() ||
        p.u_knots.end() != r.u_knots.end() || p.v_knots.begin() != r.v_knots.begin() ||
        p.v_knots.end() != r.v_knots.end()) {
      return false;
    }
  }
  return true;
}

Image compare(const LoadedModel& model, const LoadedModel& other, const Common& common) {
  DeviationPictureInput input;
  input.title = model.path + " against " + other.path;
  input.unit = model.patches.unit;
  if (correspond(model.patches, other.patches)) {
    const Tessellator tessellator(other.patches);
    std::vector<Surface> surfaces;
    for (size_t q = 0; q < model.patches.patches.size(); ++q) {
      surfaces.push_back(model.patches.surface(static_cast<int>(q)));
    }
    input.mesh = tessellator.mesh(surfaces);
    input.mesh.scalars = normal_displacement(tessellator.mesh(), input.mesh);
    input.lines = tessellator.borders();
  } else {
    ModelMesh content = mesh_of(model, common);
    input.mesh = std::move(content.mesh);
    input.mesh.scalars = signed_deviation(input.mesh, mesh_of(other, common).mesh);
    input.lines = std::move(content.lines);
  }
  const auto& values = input.mesh.scalars;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  input.caption = {format("deviation from %.4g to %.4g %s", *low, *high, input.unit.c_str())};
  print(common, input.caption.front());
  return deviation_picture(input);
}

int finish(const Image& image, const RenderOptions& options, const Common& common) {
  write_png(options.output, image);
  print(common, "picture: " + options.output);
  print_json(common, Value::object().set("outcome", "done").set("picture", options.output));
  return kExitDone;
}

}  // namespace

int run_render(const RenderOptions& options, const Common& common) {
  require_picture(options.output);
  const bool mesh_only = extension_of(options.model) == "obj";
  if (mesh_only && !options.compare.empty()) {
    throw InputError(options.model, "", "a mesh cannot be compared; give two models");
  }
  if (mesh_only) {
    ModelPictureInput input;
    input.mesh = parse_obj(read_file(options.model), options.model);
    complete_normals(input.mesh);
    input.title = options.model;
    return finish(model_picture(input), options, common);
  }
  const LoadedModel model = load_model(options.model, common);
  Image image;
  if (options.compare.empty()) {
    ModelPictureInput input;
    ModelMesh content = mesh_of(model, common);
    input.mesh = std::move(content.mesh);
    input.lines = std::move(content.lines);
    input.title = options.model;
    image = model_picture(input);
  } else {
    image = compare(model, load_model(options.compare, common), common);
  }
  return finish(image, options, common);
}

}  // namespace isochor::app
