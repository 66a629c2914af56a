#include <string>
#include <vector>

#include "busy_line.h"
#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/mesh_glb.h"
#include "isochor/io/mesh_obj.h"
#include "isochor/io/mesh_stl.h"
#include "isochor/io/model_json.h"
#include "model_picture.h"
#include "model_source.h"
#include "terminal.h"
#ifdef ISOCHOR_WITH_OCCT
#include "isochor/step/convert.h"
#endif

namespace isochor::app {
namespace {

int finish(const ConvertOptions& options, const Common& common,
           const std::vector<std::string>& notices) {
  for (const std::string& notice : notices) note(common, options.output + ": " + notice);
  print(common, "model: " + options.output);
  print_json(
      common,
      Value::object().set("outcome", "done").set("output", options.output).set("notices", notices));
  return kExitDone;
}

#ifdef ISOCHOR_WITH_OCCT
template <typename Write>
WriteReport write_busily(const ConvertOptions& options, const Common& common, Write write) {
  BusyLine busy(common, "writing and checking " + options.output);
  return write(read_options(common, busy));
}

template <typename Write>
int finish_checked(const ConvertOptions& options, const Common& common, Write write) {
  const WriteReport report = write_busily(options, common, write);
  if (report.written) return finish(options, common, report.notices);
  refuse(options.input + ": refused: " + report.refusal);
  print_json(common, Value::object().set("outcome", "refused").set("reason", report.refusal));
  return kExitNo;
}
#endif

}  // namespace

int run_convert(const ConvertOptions& options, const Common& common) {
  const bool from_json = extension_of(options.input) == "isochor.json";
  const bool to_json = extension_of(options.output) == "isochor.json";
  const std::string extension = extension_of(options.output);
  if (extension == "obj" || extension == "stl" || extension == "glb") {
    const LoadedModel loaded = load_model(options.input, common);
    const Mesh mesh = mesh_of(loaded, common).mesh;
    if (extension == "obj") write_obj(options.output, mesh);
    if (extension == "stl") write_stl(options.output, mesh);
    if (extension == "glb") {
      GlbOptions glb;
      glb.metres_per_unit = metres_per_unit(loaded.patches.unit).value_or(1.0);
      write_glb(options.output, mesh, {}, glb);
    }
    return finish(options, common, {"triangles approximate the surfaces; they are not exact"});
  }
  if (from_json && to_json) {
    write_file(options.output, format_model(load_model(options.input, common).patches));
    return finish(options, common, std::vector<std::string>());
  }
#ifdef ISOCHOR_WITH_OCCT
  if (is_cad_file(options.input) && is_cad_file(options.output)) {
    return finish_checked(options, common, [&](const ReadOptions& read) {
      return convert_file(options.input, options.output, read.limits, read.watch, options.rewrite);
    });
  }
  if (from_json && is_cad_file(options.output)) {
    const LoadedModel loaded = load_model(options.input, common);
    return finish_checked(options, common, [&](const ReadOptions& read) {
      return write_patch_model(loaded.patches, options.input, options.output, read.limits,
                               read.watch);
    });
  }
  if (is_cad_file(options.input) && to_json) {
    const LoadedModel loaded = load_model(options.input, common);
    write_file(options.output, format_model(whole_patches(*loaded.solid)));
    return finish(options, common,
                  {"names of edges, colours and assembly structure have no place in this format"});
  }
#endif
  load_model(options.input, common);  // what is wrong with the input is the better message
  throw InputError(options.output, "",
                   "cannot be written from this input; known are .step .iges .brep .isochor.json "
                   "(and .obj .stl .glb from any model)");
}

}  // namespace isochor::app
