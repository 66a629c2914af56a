#include <algorithm>
#include <cstdio>

#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/edit/suggestion.h"
#include "isochor/io/edits_json.h"
#include "isochor/io/file.h"
#include "model_source.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// When nothing is editable as it is: the faces that can be converted, from the largest.
std::vector<std::string> convertible_faces(const LoadedModel& loaded) {
  std::vector<std::string> handles;
#ifdef ISOCHOR_WITH_OCCT
  if (!loaded.solid) return handles;
  std::vector<const FaceFacts*> faces;
  for (const FaceFacts& face : loaded.solid->faces) {
    if (face.patch < 0 && face.convertible) faces.push_back(&face);
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const FaceFacts* a, const FaceFacts* b) { return a->area > b->area; });
  for (const FaceFacts* face : faces) handles.push_back(face->handle);
#else
  (void)loaded;
#endif
  return handles;
}

// Where no face can be edited at all, the largest says why.
std::string why_nothing_is_free(const LoadedModel& loaded,
                                const std::vector<std::string>& convertible) {
  const std::string hint = "; isochor info lists what holds each face";
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid && loaded.patches.patches.empty() && convertible.empty()) {
    const auto& faces = loaded.solid->faces;
    const auto largest =
        std::max_element(faces.begin(), faces.end(),
                         [](const FaceFacts& a, const FaceFacts& b) { return a.area < b.area; });
    if (largest != faces.end()) {
      return "no face can be edited; the largest is " + largest->handle + ": " +
             largest->not_editable + hint;
    }
  }
#else
  (void)loaded;
  (void)convertible;
#endif
  return "no face has a place that is free enough, even refined" + hint;
}

// Shapes of coordinates like 1e300 have no measures: an error about the model.
std::optional<Edit> suggested(const LoadedModel& loaded, const std::string& path,
                              Continuity continuity = Continuity::kMeasured) {
  if (loaded.patches.patches.empty()) return std::nullopt;
  SuggestionOptions options;
  options.continuity = continuity;
  try {
    return suggest_edit(loaded.patches, loaded.surroundings, options);
  } catch (const InputError& error) {
    throw error.in_file(path);
  }
}

}  // namespace

int run_suggest(const SuggestOptions& options, const Common& common) {
  ShapeMeasures measures;
  measures.close = parse_close(options.close);
  LoadedModel loaded = load_model(options.model, common, {}, measures);
  std::optional<Edit> edit = suggested(loaded, options.model);
  constexpr size_t kMostConversions = 4;
  const std::vector<std::string> candidates = convertible_faces(loaded);
  for (size_t k = 0; !edit && k < candidates.size() && k < kMostConversions; ++k) {
    const LoadedModel converted = load_model(options.model, common, {candidates[k]}, measures);
    edit = suggested(converted, options.model);
  }
  // Faces of degree 1 bend at knot lines only.
  if (!edit) edit = suggested(loaded, options.model, Continuity::kC0);
  if (!edit) {
    const std::string why = why_nothing_is_free(loaded, candidates);
    refuse(options.model + ": refused: " + why);
    print_json(common, Value::object().set("outcome", "refused").set("reason", why));
    return kExitNo;
  }
  const std::string text = format_edits({{*edit}, measures.close});
  if (options.output.empty()) {
    std::fputs(text.c_str(), stdout);
    return kExitDone;
  }
  write_file(options.output, text);
  print(common, "edits: " + options.output);
  if (edit->continuity == Continuity::kC0) {
    print(common, "keeps positions only (\"continuity\": \"C0\"): nothing is free without creases");
  }
  print_json(common, Value::object().set("outcome", "done").set("edits", options.output));
  return kExitDone;
}

}  // namespace isochor::app
