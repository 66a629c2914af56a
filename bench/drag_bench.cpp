// One step of a drag on a cube of six bicubic patches, the volume kept, by the number of spans a
// side; and what comes before the first step.
#include <benchmark/benchmark.h>

#include "isochor/bspline/joins.h"
#include "isochor/edit/edit_session.h"
#include "support/models.h"

namespace isochor {
namespace {

PatchModel cube(const benchmark::State& state) {
  PatchModel model = testing::make_cube_model(3, static_cast<int>(state.range(0)));
  model.joins = find_joins(model);
  return model;
}

// The pull of the paper's figure 4 (Sauvage et al. 2008).
Edit pull() {
  Move move;
  move.place.patch = "top";
  move.place.uv = {0.7, 0.8};
  move.vector = Vec3(0.2, 0.2, 0.9);
  Edit edit;
  edit.moves = {move};
  edit.extent.kind = Extent::Kind::kRadius;
  edit.extent.radius = 0.5;
  return edit;
}

void begin(benchmark::State& state) {
  const PatchModel model = cube(state);
  for (auto _ : state) {
    EditSession session(model);
    benchmark::DoNotOptimize(session.begin(pull()));
  }
}
BENCHMARK(begin)->Arg(12)->Arg(29)->Unit(benchmark::kMillisecond);

void drag(benchmark::State& state) {
  EditSession session(cube(state));
  const Certificate first = session.begin(pull());
  if (first.outcome != Outcome::kDone) state.SkipWithError(first.reason.c_str());
  double height = 0.5;
  for (auto _ : state) {
    height = height > 0.9 ? 0.5 : height + 0.01;
    benchmark::DoNotOptimize(session.drag({Vec3(0.2, 0.2, height)}));
  }
}
BENCHMARK(drag)->Arg(12)->Arg(29)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isochor
