// The volume of a cube of six bicubic patches and its gradient, by the number of spans a side.
//
// Baseline: a copy of the points, the least that any method must move. Read ratios of one run.
#include <benchmark/benchmark.h>

#include <vector>

#include "isochor/volume/contraction.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/theta.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"

namespace isochor {
namespace {

PatchModel cube(const benchmark::State& state) {
  return testing::make_cube_model(3, static_cast<int>(state.range(0)));
}

void count_points(benchmark::State& state, const PatchModel& model) {
  state.counters["points"] = static_cast<double>(model.points.size());
  state.SetItemsProcessed(state.iterations() * static_cast<long>(model.points.size()));
}

void copy_of_points(benchmark::State& state) {
  const PatchModel model = cube(state);
  std::vector<Vec3> copy(model.points.size());
  for (auto _ : state) {
    copy = model.points;
    benchmark::DoNotOptimize(copy.data());
    benchmark::ClobberMemory();
  }
  count_points(state, model);
}
BENCHMARK(copy_of_points)->Arg(12)->Arg(29)->Arg(61);

void value(benchmark::State& state) {
  const PatchModel model = cube(state);
  const VolumeForm form(model);
  for (auto _ : state) benchmark::DoNotOptimize(form.value(model.points));
  count_points(state, model);
}
BENCHMARK(value)->Arg(12)->Arg(29)->Arg(61)->Unit(benchmark::kMicrosecond);

void value_and_gradient(benchmark::State& state) {
  const PatchModel model = cube(state);
  const VolumeForm form(model);
  for (auto _ : state) benchmark::DoNotOptimize(form.value_and_gradient(model.points));
  count_points(state, model);
}
BENCHMARK(value_and_gradient)->Arg(12)->Arg(29)->Arg(61)->Unit(benchmark::kMicrosecond);

void value_and_gradient_by_contraction(benchmark::State& state) {
  const PatchModel model = cube(state);
  const VolumeContraction contraction(model);
  for (auto _ : state) benchmark::DoNotOptimize(contraction.value_and_gradient(model.points));
  count_points(state, model);
}
BENCHMARK(value_and_gradient_by_contraction)
    ->Arg(12)
    ->Arg(29)
    ->Arg(61)
    ->Unit(benchmark::kMicrosecond);

// As published: theta tensors in both directions (Sauvage et al. 2008, eq. 13).
void gradient_as_published(benchmark::State& state) {
  const PatchModel model = cube(state);
  for (auto _ : state) benchmark::DoNotOptimize(theta_gradient(model, model.points));
  count_points(state, model);
}
BENCHMARK(gradient_as_published)->Arg(12)->Unit(benchmark::kMicrosecond);

void gradient_around_one_pole(benchmark::State& state) {
  const PatchModel model = cube(state);
  const VolumeForm form(model);
  const int middle = model.patches[0].u_size() / 2;
  const auto support = form.support_of({model.patches[0].point(middle, middle)});
  for (auto _ : state) benchmark::DoNotOptimize(form.gradient(model.points, support));
  count_points(state, model);
}
BENCHMARK(gradient_around_one_pole)->Arg(12)->Arg(29)->Arg(61)->Unit(benchmark::kMicrosecond);

void rational_value(benchmark::State& state) {
  const PatchModel model = cube(state);
  const ExactVolume exact(model);
  for (auto _ : state) benchmark::DoNotOptimize(exact.value(model.points));
  count_points(state, model);
}
BENCHMARK(rational_value)->Arg(12)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isochor
